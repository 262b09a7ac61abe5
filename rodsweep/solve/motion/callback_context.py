"""Context record that PETSc passes to every callback of a TS: rod, mesh, steps, Newton's method."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...arrays import Array
from ...discretization.elements.mesh import NodeMatrices
from ...discretization.explicit_system import ExplicitSystem
from ...discretization.nodal_rod import NodalRod
from ...model.compiled.compilation import compiled
from ...model.material.jump import JUMP_SIDE_COLUMNS
from ..backend.petsc_c_functions import double_array_at, doubles_at, integers_at
from .time_scheme import EXTRAPOLATION_POINTS

MATERIAL_CONSTANTS_PER_JUMP_SIDE = len(JUMP_SIDE_COLUMNS)
"""Number of material constants that are stored for each side of a jump of the material."""
MAX_STORED_STAGES = 1 + max(max(stages) for stages in EXTRAPOLATION_POINTS.values())
"""Maximum number of stages of a time step stored for extrapolation, including the state at the start."""
MAX_EXTRAPOLATION_POINTS = max(
    len(this) + len(last) for stages in EXTRAPOLATION_POINTS.values() for this, last in stages.values()
)
"""Maximum number of stored stages through which the prediction of a stage is extrapolated."""
FLOAT = "<f8"
INTEGER = "<i8"
ROD_ARRAY_FIELDS = (
    *(name for name in NodalRod._fields if name not in ("unknown_velocity_components", "law_number")),
    "roots",
    "crushed",
)
"""Fields of `CONTEXT_DTYPE` with the addresses of the integrated rod's arrays. `roots`: square roots of the
compliances. `crushed`: value, at each node but the tip, of the integrated variable z1 at which the axial
stretch h1 is 0, (nodes,)."""
WORKSPACE_ARRAY_FIELDS = ("jacobian", "base", "times", "states", "points", "constant", "rates")
"""Fields of `CONTEXT_DTYPE` with the addresses of a `CallbackWorkspace`'s arrays: the last Jacobian,
(unknowns, unknowns); the state at which a step's matrix is evaluated, (unknowns,); times, (2
MAX_STORED_STAGES,), and states, (2 MAX_STORED_STAGES, unknowns), of the stages of this step and of the last
step; extrapolation points of each stage, (MAX_STORED_STAGES, MAX_EXTRAPOLATION_POINTS); the constant of a
stage's equation and the rates f, (unknowns,) each."""
PETSC_HANDLE_FIELDS = ("ts", "matrix", "ksp", "residual", "correction")
"""Fields of `CONTEXT_DTYPE` with the handles of PETSc objects."""
CONTEXT_DTYPE = np.dtype(
    [
        *(
            (name, INTEGER)
            for name in (
                *NodeMatrices._fields,
                *ROD_ARRAY_FIELDS,
                *WORKSPACE_ARRAY_FIELDS,
                *PETSC_HANDLE_FIELDS,
            )
        ),
        ("nodes", INTEGER),  # including the tip
        ("components", INTEGER),  # of a stress
        ("unknowns", INTEGER),
        ("matrix_due", INTEGER),  # UP_TO_DATE, AT_BASE or AT_ITERATE
        ("shift", FLOAT),  # shift of the last matrix
        ("last_matrix", INTEGER),  # handle of the last matrix
        ("matrix_state", INTEGER),  # PETSc's state number of this matrix, which increases with every change
        ("factorisations", INTEGER),  # number of LU factorisations so far, for tests
        ("contraction", FLOAT),  # ratio of successive steps of Newton's method
        ("measured", INTEGER),  # whether the contraction was measured with the current matrix
        ("growing", INTEGER),  # number of successive growing Newton steps
        ("last_step", FLOAT),  # 2-norm of the last Newton step
        ("small_error", FLOAT),  # 2-norm of an acceptable error
        ("rounding", FLOAT),  # 2-norm of the largest Newton step that rounding errors cause
        ("most_iterations", INTEGER),
        ("without_rate", INTEGER),  # whether the residual omits f
        ("time", FLOAT),  # time of the last residual
        ("current", INTEGER),  # 0 or 1: half of `times` and `states` for this step
        ("stages", INTEGER),  # number of known stages of this step
        ("steps", INTEGER),  # number of known steps before this one, at most 1
        ("length", FLOAT),  # length of this step, in tau2
        ("middle", FLOAT),  # time at which the matrix is evaluated, as a fraction of the step
        (
            "rows",
            INTEGER,
        ),  # address of the stored steps, a row (time, state) each, allocated by compiled code
        ("stored", INTEGER),  # number of stored steps
        ("capacity", INTEGER),  # number of steps for which memory is allocated
        ("law", INTEGER),  # number of the constitutive law
        ("jump_count", INTEGER),  # number of nodes at which the material jumps
        ("left", INTEGER),  # whether the rod has left the model
        ("error", INTEGER),  # PETSc's error code inside a stage
        ("outputs", INTEGER, (3,)),  # output arguments of PETSc's functions
    ]
)
"""Record type of the argument `context` of every callback."""
CONTEXT_FIELDS: Mapping[str, Any] = CONTEXT_DTYPE.fields or {}
OUTPUTS_OFFSET, MATRIX_STATE_OFFSET = (CONTEXT_FIELDS[name][1] for name in ("outputs", "matrix_state"))
"""Offsets, in bytes, of the fields of `CONTEXT_DTYPE` into which PETSc's functions write."""

UP_TO_DATE, AT_BASE, AT_ITERATE = range(3)
"""Values of `matrix_due`: no new matrix; a new matrix at the state `base`; one at the current Newton
iterate."""


def rod_arrays_by_field(system: ExplicitSystem) -> dict[str, Array]:
    """Arrays of the rod `system` by the names in `ROD_ARRAY_FIELDS`; the shapes differ."""
    arrays = system.nodal_rod._asdict() | {"roots": system.sqrt_compliance, "crushed": system.crushing_z1}
    return {name: arrays[name] for name in ROD_ARRAY_FIELDS}


@compiled
def rod_of(c: Any) -> NodalRod:
    """The integrated rod, as views of the arrays whose addresses are in the context record `c`."""
    d = c.components
    m = c.nodes
    rest_strain = double_array_at(c.straight_state_strain, (d, m))
    compliance = double_array_at(c.compliance, (d, m))
    drag = double_array_at(c.drag, (d, m))
    mobility = double_array_at(c.mobility, (d, m))
    laplacian = double_array_at(c.mobility_laplacian, (d, m, m))
    # A view of length 0, because an empty array would be allocated at every call.
    empty = integers_at(c.straight_state_strain, 0)
    jumps = integers_at(c.jump_nodes, c.jump_count)
    sides = double_array_at(c.jump_side_coefficients, (c.jump_count, 2, MATERIAL_CONSTANTS_PER_JUMP_SIDE))
    tip_stress = doubles_at(c.tip_stress, d)
    return NodalRod(
        tip_stress, rest_strain, compliance, drag, mobility, laplacian, empty, c.law, jumps, sides
    )


@compiled
def matrices_of(c: Any) -> NodeMatrices:
    """The matrices of the mesh, as views of the arrays whose addresses are in the context record `c`."""
    all_nodes = (c.nodes, c.nodes)
    D = double_array_at(c.differentiation_matrix, all_nodes)
    transposed_differentiation_matrix = double_array_at(c.transposed_differentiation_matrix, all_nodes)
    return NodeMatrices(
        D,
        transposed_differentiation_matrix,
        double_array_at(c.weak_derivative_matrix, all_nodes),
        doubles_at(c.quadrature_weights, c.nodes),
    )


@compiled
def sqrt_compliance_of(c: Any) -> Any:
    """Square roots of the compliances, (components, nodes); c: context record."""
    return double_array_at(c.roots, (c.components, c.nodes))


@compiled
def stage_times_of(c: Any) -> Any:
    """Times of the stages of this step and of the last step, (2 MAX_STORED_STAGES,); c: context record."""
    return doubles_at(c.times, 2 * MAX_STORED_STAGES)


@compiled
def stage_states_of(c: Any) -> Any:
    """The stages of this step and of the last step, (2 MAX_STORED_STAGES, unknowns); c: context record."""
    return double_array_at(c.states, (2 * MAX_STORED_STAGES, c.unknowns))
