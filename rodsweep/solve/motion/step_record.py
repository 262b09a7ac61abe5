"""Storage of the time steps of a run in compiled code: Python calls would take 1/7 of the computing time."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants
from ..backend.petsc import PETSc
from ..backend.petsc_c_functions import ADDRESS_TYPE, doubles_at, integers_at, petsc_callback, record_at
from .callback_context import CONTEXT_DTYPE, OUTPUTS_OFFSET
from .petsc_calls import (
    context_of_ts,
    free_memory,
    get_array_for_reading,
    reallocate_memory,
    restore_array_after_reading,
    set_ts_converged_reason,
    solution_of,
    time_of,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class StepRecordSettings(KernelConstants):
    """Settings for the memory in which the time steps of a run are stored."""

    first_capacity: int = 256
    """Number of time steps for which memory is allocated first; the memory is doubled whenever it is full."""


STEP_RECORD_SETTINGS = StepRecordSettings()

OUT_OF_MEMORY = 55
"""PETSc's error code for failed memory allocation, PETSC_ERR_MEM."""
CONVERGED_USER = int(PETSc.TS.ConvergedReason.CONVERGED_USER)
"""PETSc's TSConvergedReason for a run that is stopped before its end."""


@compiled
def store_step(c: Any, scratch: int, ts: int) -> int:
    """Stores time and state of `ts` as a row of the record, and returns PETSc's error code; ends the run if
    the stretch h1 is <= 0 at a node. c: context record (`CONTEXT_DTYPE`). scratch: address of scratch memory,
    into which PETSc writes."""
    n = c.unknowns
    outputs = integers_at(scratch, 3)
    if c.stored == c.capacity:
        # Doubling keeps the cost of copying proportional to the number of steps.
        c.capacity = max(2 * c.capacity, STEP_RECORD_SETTINGS.first_capacity)
        rows = reallocate_memory(c.rows, 8 * c.capacity * (n + 1))
        if rows == 0:
            return OUT_OF_MEMORY
        c.rows = rows
    time_of(ts, scratch)
    solution_of(ts, scratch + 8)
    get_array_for_reading(outputs[1], scratch + 16)
    row = doubles_at(c.rows + 8 * c.stored * (n + 1), n + 1)
    z = doubles_at(outputs[2], n)
    row[0] = doubles_at(scratch, 1)[0]
    row[1:] = z
    restore_array_after_reading(outputs[1], scratch + 16)
    # A state that has left the model is stored too: the message states its h1.
    c.stored += 1
    # z1 is the first of three fields; h1 = 0 where z1 equals `crushed`.
    nodes = n // 3
    crushed = doubles_at(c.crushed, nodes)
    for i in range(nodes):
        if row[1 + i] <= crushed[i] and not c.left:
            c.left = 1
            set_ts_converged_reason(ts, CONVERGED_USER)
    return 0


@petsc_callback(ADDRESS_TYPE)
def end_step(ts: int) -> int:
    """PETSc's post-step function: stores the finished time step."""
    address = np.empty(1, np.int64)
    context_of_ts(ts, address.ctypes.data)
    context = address[0]
    return store_step(record_at(context, CONTEXT_DTYPE), context + OUTPUTS_OFFSET, ts)


@compiled
def _copied_rows(address: int, rows: int, columns: int) -> Array:
    return doubles_at(address, rows * columns).reshape(rows, columns).copy()


@compiled
def _free_address(address: int) -> None:
    free_memory(address)


def pop_stored_steps(context: Any) -> Array:
    """Rows (time, state) of the steps stored in `context`, (steps, 1 + unknowns); frees their memory."""
    address = int(context["rows"])
    row_count = int(context["stored"])
    column_count = int(context["unknowns"]) + 1
    rows = _copied_rows(address, row_count, column_count) if row_count else np.empty((0, column_count))
    # Freeing the address 0, of a run without steps, does nothing.
    _free_address(address)
    context["rows"] = context["stored"] = context["capacity"] = 0
    return rows
