"""Context record that PETSc passes to every callback of a TS: rod, mesh, steps, and state of Newton's
method."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...arrays import Array
from ...discretization.beam import Beam
from ...discretization.elements.mesh import NodeMatrices
from ...discretization.nodal_rod import NodalRod
from ...model.compiled.compilation import compiled
from ...model.material.jump import SIDE_COLUMNS
from ..backend.c_functions import double_array_at, floats, integers
from .time_scheme import EXTRAPOLATION_POINTS

CONSTANTS_PER_JUMP_SIDE = len(SIDE_COLUMNS)
"""Number of material constants that are stored for each side of a jump of the material."""
MAX_STAGES = 1 + max(max(stages) for stages in EXTRAPOLATION_POINTS.values())
"""Maximum number of stages of a time step that are stored for extrapolation, including the state at the
start."""
MAX_STAGE_POINTS = max(
    len(this) + len(last) for stages in EXTRAPOLATION_POINTS.values() for this, last in stages.values()
)
"""Maximum number of stored stages through which the prediction of a stage is extrapolated."""
FLOAT = "<f8"
WHOLE = "<i8"
ROD = (*(name for name in NodalRod._fields if name not in ("unknown_velocities", "law")), "roots", "crushed")
"""Fields of `CONTEXT` with the addresses of the integrated rod's arrays. `roots`: square roots of the
compliances. `crushed`: value of z1 with h1 = 0 at each node but the tip, (nodes,)."""
ARRAYS = ("jacobian", "base", "times", "states", "points", "constant", "rates")
"""Fields of `CONTEXT` with the addresses of a `Workspace`'s arrays: the last Jacobian, (unknowns, unknowns);
the state at which a step's matrix is evaluated, (unknowns,); times, (2 MAX_STAGES,), and states, (2
MAX_STAGES, unknowns), of the stages of this step and of the last step; extrapolation points of each stage,
(MAX_STAGES, MAX_STAGE_POINTS); the constant of a stage's equation and the rates f, (unknowns,) each."""
HANDLES = ("ts", "matrix", "ksp", "residual", "correction")
"""Fields of `CONTEXT` with the handles of PETSc objects."""
CONTEXT = np.dtype(
    [
        *((name, WHOLE) for name in (*NodeMatrices._fields, *ROD, *ARRAYS, *HANDLES)),
        ("nodes", WHOLE),  # including the tip
        ("components", WHOLE),  # of a stress
        ("unknowns", WHOLE),
        ("matrix_due", WHOLE),  # UP_TO_DATE, AT_BASE or AT_ITERATE
        ("shift", FLOAT),  # shift of the last matrix
        ("last_matrix", WHOLE),  # handle of the last matrix
        ("matrix_state", WHOLE),  # PETSc's state number of this matrix, which increases with every change
        ("factorisations", WHOLE),  # number of LU factorisations so far, for tests
        ("contraction", FLOAT),  # ratio of successive steps of Newton's method
        ("measured", WHOLE),  # whether the contraction was measured with the present matrix
        ("growing", WHOLE),  # number of successive growing Newton steps
        ("last_step", FLOAT),  # 2-norm of the last Newton step
        ("small_error", FLOAT),  # 2-norm of an acceptable error
        ("rounding", FLOAT),  # 2-norm of the largest Newton step that rounding errors cause
        ("most_iterations", WHOLE),
        ("without_rate", WHOLE),  # whether the residual omits f
        ("time", FLOAT),  # time of the last residual
        ("current", WHOLE),  # 0 or 1: half of `times` and `states` for this step
        ("stages", WHOLE),  # number of known stages of this step
        ("steps", WHOLE),  # number of known steps before this one, at most 1
        ("length", FLOAT),  # length of this step, in tau2
        ("middle", FLOAT),  # time at which the matrix is evaluated, as a fraction of the step
        ("rows", WHOLE),  # address of the stored steps, a row (time, state) each, allocated by compiled code
        ("stored", WHOLE),  # number of stored steps
        ("capacity", WHOLE),  # number of steps for which memory is allocated
        ("law", WHOLE),  # number of the constitutive law
        ("jump_count", WHOLE),  # number of nodes at which the material jumps
        ("left", WHOLE),  # whether the rod has left the model
        ("error", WHOLE),  # PETSc's error code inside a stage
        ("outputs", WHOLE, (3,)),  # output arguments of PETSc's functions
    ]
)
"""Record type of the argument `context` of every callback."""
CONTEXT_FIELDS: Mapping[str, Any] = CONTEXT.fields or {}
OUTPUTS, MATRIX_STATE = (CONTEXT_FIELDS[name][1] for name in ("outputs", "matrix_state"))
"""Offsets, in bytes, of the fields of `CONTEXT` into which PETSc's functions write."""

UP_TO_DATE, AT_BASE, AT_ITERATE = range(3)
"""Values of `matrix_due`: no new matrix is due, or a new matrix is due at the state `base` or at the present
iterate of Newton's method."""


def arrays_of(beam: Beam) -> dict[str, Array]:
    """Arrays of the rod `beam` by the names in `ROD`; the shapes differ."""
    own = beam.nodal._asdict() | {"roots": beam.sqrt_compliance, "crushed": beam.crushing_z1}
    return {name: own[name] for name in ROD}


@compiled
def rod_of(c: Any) -> NodalRod:
    d = c.components
    m = c.nodes
    rest = double_array_at(c.rest, (d, m))
    compliance = double_array_at(c.compliance, (d, m))
    drag = double_array_at(c.drag, (d, m))
    mobility = double_array_at(c.mobility, (d, m))
    second = double_array_at(c.second, (d, m, m))
    none = integers(c.rest, 0)
    jumps = integers(c.jumps, c.jump_count)
    sides = double_array_at(c.sides, (c.jump_count, 2, CONSTANTS_PER_JUMP_SIDE))
    tip_stress = floats(c.tip_stress, d)
    return NodalRod(tip_stress, rest, compliance, drag, mobility, second, none, c.law, jumps, sides)


@compiled
def matrices_of(c: Any) -> NodeMatrices:
    all_nodes = (c.nodes, c.nodes)
    D = double_array_at(c.D, all_nodes)
    D_transposed = double_array_at(c.D_transposed, all_nodes)
    return NodeMatrices(D, D_transposed, double_array_at(c.weak, all_nodes), floats(c.weights, c.nodes))


@compiled
def roots_of(c: Any) -> Any:
    return double_array_at(c.roots, (c.components, c.nodes))


@compiled
def times_of(c: Any) -> Any:
    return floats(c.times, 2 * MAX_STAGES)


@compiled
def states_of(c: Any) -> Any:
    return double_array_at(c.states, (2 * MAX_STAGES, c.unknowns))
