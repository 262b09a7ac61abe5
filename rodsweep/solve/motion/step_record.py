"""The steps of a run, kept by compiled code: a call of Python after each would take a seventh of the time."""

from typing import Any

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ..backend.c_functions import POINTER, c_function, floats, integers, record_at
from ..backend.petsc import PETSc
from .context import CONTEXT, TAKEN
from .petsc_calls import (
    context_of_ts,
    free_memory,
    read_array,
    resized_memory,
    set_ts_reason,
    solution_of,
    time_of,
    unread_array,
)

FIRST_ROOM = 256
"""Steps for which there is memory at first; twice as many when it is full."""
OUT_OF_MEMORY = 55
"""PETSc's error code."""
STOPPED = int(PETSc.TS.ConvergedReason.CONVERGED_USER)


@compiled
def keep_step(c: Any, at: int, ts: int) -> int:
    """Adds a row (time, state); where the rod has left the model, it is the last."""
    n, taken = c.unknowns, integers(at, 3)
    if c.kept == c.room:
        c.room = max(2 * c.room, FIRST_ROOM)
        rows = resized_memory(c.rows, 8 * c.room * (n + 1))
        if rows == 0:
            return OUT_OF_MEMORY
        c.rows = rows
    time_of(ts, at)
    solution_of(ts, at + 8)
    read_array(taken[1], at + 16)
    row, z = floats(c.rows + 8 * c.kept * (n + 1), n + 1), floats(taken[2], n)
    row[0] = floats(at, 1)[0]
    row[1:] = z
    unread_array(taken[1], at + 16)
    c.kept += 1
    if row[1 : 1 + n // 3].min() <= c.crushed:
        c.left = 1
        set_ts_reason(ts, STOPPED)
    return 0


@c_function(POINTER)
def end_step(ts: int) -> int:
    """PETSc's post-step."""
    handed = np.empty(1, np.int64)
    context_of_ts(ts, handed.ctypes.data)
    context = handed[0]
    return keep_step(record_at(context, CONTEXT), context + TAKEN, ts)


@compiled
def _kept_rows(address: int, rows: int, columns: int) -> Array:
    return floats(address, rows * columns).reshape(rows, columns).copy()


@compiled
def _freed(address: int) -> None:
    free_memory(address)


def take_steps(context: Any) -> Array:
    """The rows (time, state) of the steps so far, (steps, 1 + unknowns); the record forgets them."""
    address, kept, columns = int(context["rows"]), int(context["kept"]), int(context["unknowns"]) + 1
    rows = _kept_rows(address, kept, columns) if kept else np.empty((0, columns))
    _freed(address)
    context["rows"] = context["kept"] = context["room"] = 0
    return rows
