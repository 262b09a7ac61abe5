"""Ranges of flat indices, of points or of chains, each as (first, end): what is left to do."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

IndexRange = tuple[int, int]


def total(ranges: Iterable[IndexRange]) -> int:
    """How many indices the ranges hold."""
    return sum(end - first for first, end in ranges)


def joined(ranges: Iterable[IndexRange]) -> list[IndexRange]:
    """Sorted ranges as few as possible: those that touch become one."""
    result: list[IndexRange] = []
    for first, end in ranges:
        touches = bool(result) and result[-1][1] == first
        result.append((result.pop()[0] if touches else first, end))
    return result


class IndexSet:
    """The indices in some ranges, which are sorted; takes no memory for the indices themselves."""

    def __init__(self, ranges: Sequence[IndexRange]):
        # The first one is empty: an index before all others has a range to be compared with.
        self.firsts, self.ends = np.array([(-1, -1), *ranges]).T

    def __getitem__(self, indices: Any) -> Any:
        """Whether an index is in the set, or an array of it for an array of indices."""
        place = np.searchsorted(self.firsts, indices, side="right") - 1
        return indices < self.ends[place]
