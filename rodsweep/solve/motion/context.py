"""The record that every callback of a TS receives: the rod, its mesh, and how Newton's method fares."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...discretization.body_frame import BeamParameters, Element

REAL, WHOLE = "<f8", "<i8"
CONTEXT = np.dtype(
    [
        *((name, REAL) for name in BeamParameters._fields),
        *((name, WHOLE) for name in Element._fields),  # addresses, as are the next two
        ("jacobian", WHOLE),
        ("base", WHOLE),  # the state at which a step's matrix is made
        ("order", WHOLE),
        ("unknowns", WHOLE),
        ("matrix_due", WHOLE),  # UP_TO_DATE, AT_BASE or AT_ITERATE
        ("shift", REAL),  # with which the matrix was made
        ("matrix", WHOLE),  # the one that was last made here
        ("content", WHOLE),  # PETSc's number of its content, which rises with every change, PETSc's included
        ("factorisations", WHOLE),  # how many, which tests ask
        ("contraction", REAL),  # rate at which the steps of Newton's method shrink
        ("growing", WHOLE),  # how many of them in a row have grown
        ("last_step", REAL),  # the size of the last one: 2-norm, as are the two below
        ("small_error", REAL),  # error that is small enough
        ("rounding", REAL),  # the largest step that rounding leaves
        ("taken", WHOLE, (3,)),  # where PETSc puts what it is asked for
    ]
)
"""What every callback receives."""
PLACES: Mapping[str, Any] = CONTEXT.fields or {}
TAKEN, CONTENT = (PLACES[name][1] for name in ("taken", "content"))
"""Places in bytes of what PETSc writes."""

UP_TO_DATE, AT_BASE, AT_ITERATE = range(3)
"""Whether a new matrix is due, and where it is to be made."""
