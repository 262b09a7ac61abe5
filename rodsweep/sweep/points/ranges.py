"""Ranges (first, end) of flat indices of points or chains, and sets of such indices."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

IndexRange = tuple[int, int]
"""(first index, index after the last)."""


def total(ranges: Iterable[IndexRange]) -> int:
    """Number of indices in the ranges."""
    return sum(end - first for first, end in ranges)


def joined(ranges: Iterable[IndexRange]) -> list[IndexRange]:
    """Sorted ranges with adjacent ranges merged."""
    result: list[IndexRange] = []
    for first, end in ranges:
        touches = bool(result) and result[-1][1] == first
        result.append((result.pop()[0] if touches else first, end))
    return result


class IndexSet:
    """Set of the indices in sorted ranges; takes no memory for the indices themselves."""

    def __init__(self, ranges: Sequence[IndexRange]):
        # An empty first range, so that an index before all ranges also has a range on its left.
        self.firsts, self.ends = np.array([(-1, -1), *ranges]).T

    def __getitem__(self, indices: Any) -> Any:
        """Whether an index is in the set; for an array of indices, a boolean array."""
        place = np.searchsorted(self.firsts, indices, side="right") - 1
        return indices < self.ends[place]
