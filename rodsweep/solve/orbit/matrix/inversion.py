"""Inverse of a small dense matrix in place, compiled; most of the computing time is spent in products of
panels."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled_with_reordered_sums
from ....model.compiled.kernel_constants import KernelConstants
from ...backend.products import matrix_product


@dataclass(frozen=True, slots=True, kw_only=True)
class InversionSettings(KernelConstants):
    """Settings for inverses and products of blocks."""

    panel_width: int = 12
    """Number of columns of a panel: `invert_matrix` eliminates these columns one by one, then one product
    updates all other columns."""
    min_pivot_ratio_without_exchange: float = 0.1
    """A pivot is exchanged for the largest entry of its column if |pivot| is less than this number times this
    entry."""
    rows_in_cache: int = 8
    """Number of rows of all blocks that are updated together, so that these rows fit into the first-level
    cache."""
    field_ranges: ClassVar = {"min_pivot_ratio_without_exchange": (0.0, 1.0)}
    """Exclusive bounds (lower, upper) of settings by name, as in `KernelConstants`."""


INVERSION_SETTINGS = InversionSettings()


@compiled_with_reordered_sums
def invert_matrix(A: Array, pivots: Any, rows: Array) -> None:
    """Replaces A by A^-1 with Gauss-Jordan elimination and partial pivoting, a panel of columns at a time.

    A: (n, n). pivots, rows: work arrays, (n,) integers and (n, panel). The inverse of the transpose is the
    transpose of the inverse; therefore the rows of A, which are contiguous in memory, are treated as columns.
    """
    n = len(A)
    ones = np.ones(2)
    extents = np.empty(6, np.int32)
    for first in range(0, n, INVERSION_SETTINGS.panel_width):
        last = min(n, first + INVERSION_SETTINGS.panel_width)
        _sweep_panel(A, first, last, pivots)
        for j in range(n):
            if j < first or j >= last:
                # The panel's columns move to `rows`, so that the product below writes their update in place.
                for i in range(last - first):
                    rows[j, i] = A[j, first + i]
                    A[j, first + i] = 0.0
        extents[:] = first, n, last - first, INVERSION_SETTINGS.panel_width, n, n
        panel = A.ctypes.data + 8 * n * first
        row = 8 * n * last
        matrix_product(rows.ctypes.data, panel, A.ctypes.data, extents, ones)
        extents[0] = n - last
        matrix_product(
            rows.ctypes.data + 8 * INVERSION_SETTINGS.panel_width * last,
            panel,
            A.ctypes.data + row,
            extents,
            ones,
        )
    # Exchanges of columns of A are undone as exchanges of rows of the inverse, in reverse order.
    for k in range(n - 1, -1, -1):
        if pivots[k] != k:
            p = pivots[k]
            for i in range(n):
                A[k, i], A[p, i] = A[p, i], A[k, i]


@compiled_with_reordered_sums
def _sweep_panel(A: Array, first: int, last: int, pivots: Any) -> None:
    """Gauss-Jordan steps on A, (n, n), with the pivot columns `first` to `last` - 1, applied in place to
    these columns only. pivots: output, index of the column exchanged with each column, (n,)."""
    n = len(A)
    for k in range(first, last):
        row = A[k]
        max_entry = 0.0
        p = k
        for i in range(k, n):
            max_entry = max(max_entry, abs(row[i]))
        # Threshold pivoting: an exchange costs a pass over A, and a pivot ten times smaller loses one digit
        # at most.
        if abs(row[k]) < INVERSION_SETTINGS.min_pivot_ratio_without_exchange * max_entry:
            for i in range(k, n):
                if abs(row[i]) == max_entry:
                    p = i
        pivots[k] = p
        if p != k:
            for j in range(n):
                A[j, k], A[j, p] = A[j, p], A[j, k]
        inverse = 1.0 / row[k]
        for i in range(n):
            # With the minus sign all updates are additions; the pivot itself is set below.
            row[i] *= -inverse
        for j in range(first, last):
            if j != k:
                factor = A[j, k]
                for i in range(n):
                    A[j, i] += factor * row[i]
                A[j, k] = factor * inverse
        row[k] = inverse
