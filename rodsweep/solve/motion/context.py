"""The record that every callback of a TS receives: the rod, its mesh, the motion so far, and how Newton's
method fares.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...arrays import Array
from ...discretization.beam import Beam
from ...discretization.elements.mesh import NodeMatrices
from ...discretization.nodal_rod import NodalRod
from ...model.compiled.compilation import compiled
from ..backend.c_functions import floats, floats_in, integers

MOST_STAGES, MOST_POINTS = 16, 8
"""Stages of a step that are remembered, and points through which the next is extrapolated."""

REAL, WHOLE = "<f8", "<i8"
ROD = (*(name for name in NodalRod._fields if name != "kept"), "roots")
"""Addresses of the rod that moves, and of the square roots of its compliances."""
ARRAYS = ("jacobian", "base", "times", "states", "points", "constant", "rates")
"""Addresses of what a `Workspace` holds: the last Jacobian; the state at which a step's matrix is made;
times, (2 MOST_STAGES,), and states, (2 MOST_STAGES, unknowns), of the stages of this step and the last; the
points through which each is extrapolated, (MOST_STAGES, MOST_POINTS); a stage's equation and its rates."""
HANDLES = ("ts", "matrix", "ksp", "residual", "correction")
"""PETSc's objects."""
CONTEXT = np.dtype(
    [
        *((name, WHOLE) for name in (*NodeMatrices._fields, *ROD, *ARRAYS, *HANDLES)),
        ("nodes", WHOLE),  # the tip included
        ("components", WHOLE),  # of a stress
        ("unknowns", WHOLE),
        ("matrix_due", WHOLE),  # UP_TO_DATE, AT_BASE or AT_ITERATE
        ("shift", REAL),  # with which the matrix was made
        ("made", WHOLE),  # the matrix that was last made here
        ("content", WHOLE),  # PETSc's number of its content, which rises with every change, PETSc's included
        ("factorisations", WHOLE),  # how many, which tests ask
        ("contraction", REAL),  # rate at which the steps of Newton's method shrink
        ("measured", WHOLE),  # whether it is that of the present matrix
        ("growing", WHOLE),  # how many of them in a row have grown
        ("last_step", REAL),  # the size of the last one: 2-norm, as are the two below
        ("small_error", REAL),  # error that is small enough
        ("rounding", REAL),  # the largest step that rounding leaves
        ("most_iterations", WHOLE),
        ("without_rate", WHOLE),  # whether the residual leaves f out
        ("time", REAL),  # at which the residual was last asked for
        ("current", WHOLE),  # 0 or 1: which half of `times` and `states` is that of this step
        ("stages", WHOLE),  # how many of them are known
        ("steps", WHOLE),  # how many are known before this one: 0, or 1 for one or more
        ("length", REAL),  # of this step, in tau2
        ("middle", REAL),  # where in it the matrix is made, in units of it
        (
            "rows",
            WHOLE,
        ),  # address of the steps so far, a row (time, state) each, which compiled code allocates
        ("kept", WHOLE),  # how many
        ("room", WHOLE),  # for how many there is memory
        ("crushed", REAL),  # z1 at which h1 = 0
        ("left", WHOLE),  # whether the rod has left the model
        ("error", WHOLE),  # PETSc's, inside a stage
        ("taken", WHOLE, (3,)),  # where PETSc puts what it is asked for
    ]
)
"""What every callback receives."""
PLACES: Mapping[str, Any] = CONTEXT.fields or {}
TAKEN, CONTENT = (PLACES[name][1] for name in ("taken", "content"))
"""Places in bytes of what PETSc writes."""

UP_TO_DATE, AT_BASE, AT_ITERATE = range(3)
"""Whether a new matrix is due, and where it is to be made."""


def arrays_of(beam: Beam) -> dict[str, Array]:
    """What `ROD` is the addresses of, arrays of any shapes."""
    own = beam.nodal._asdict() | {"roots": beam.roots}
    return {name: own[name] for name in ROD}


@compiled
def rod_of(c: Any) -> NodalRod:
    d, m = c.components, c.nodes
    rest, compliance = floats_in(c.rest, (d, m)), floats_in(c.compliance, (d, m))
    drag, mobility = floats_in(c.drag, (d, m)), floats_in(c.mobility, (d, m))
    second, none = floats_in(c.second, (d, m, m)), integers(c.rest, 0)
    return NodalRod(floats(c.tip_stress, d), rest, compliance, drag, mobility, second, none)


@compiled
def matrices_of(c: Any) -> NodeMatrices:
    all_nodes = (c.nodes, c.nodes)
    D, D_transposed = floats_in(c.D, all_nodes), floats_in(c.D_transposed, all_nodes)
    return NodeMatrices(D, D_transposed, floats_in(c.weak, all_nodes), floats(c.weights, c.nodes))


@compiled
def roots_of(c: Any) -> Any:
    return floats_in(c.roots, (c.components, c.nodes))


@compiled
def times_of(c: Any) -> Any:
    return floats(c.times, 2 * MOST_STAGES)


@compiled
def states_of(c: Any) -> Any:
    return floats_in(c.states, (2 * MOST_STAGES, c.unknowns))
