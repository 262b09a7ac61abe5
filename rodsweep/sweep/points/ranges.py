"""Ranges (first, end) of indices (flat indices of points, numbers of work items), index sets, and shards."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import InputError

BLOCKS_PER_SHARD = 64
"""Number of blocks of consecutive items in a shard. Many blocks give shards of equal cost, but separate
neighbouring points in the result file of the shard."""
IndexRange = tuple[int, int]
"""Range of flat indices of points, or of numbers of items: (first index, index after the last)."""


def index_count(ranges: Iterable[IndexRange]) -> int:
    """Total number of indices in disjoint ranges."""
    return sum(end - start for start, end in ranges)


def merged_ranges(ranges: Iterable[IndexRange]) -> list[IndexRange]:
    """The sorted disjoint ranges `ranges`, with adjacent ranges merged."""
    result: list[IndexRange] = []
    for start, end in ranges:
        is_adjacent = bool(result) and result[-1][1] == start
        result.append((result.pop()[0] if is_adjacent else start, end))
    return result


def indices_along(shape: tuple[int, ...], axis: int, line: Any, position: Any) -> Any:
    """Flat indices of the grid points at position `position` on axis number `axis`, on the grid line number
    `line`. Lines along the axis are numbered in row-major order of the remaining axes. line, position:
    integers or arrays, which broadcast to the shape of the result, (...,)."""
    stride = math.prod(shape[axis + 1 :])
    block, offset = np.divmod(line, stride)
    return (block * shape[axis] + position) * stride + offset


class IndexSet:
    """Set of all indices in sorted disjoint ranges; needs memory for the ranges only."""

    def __init__(self, ranges: Sequence[IndexRange]):
        # An empty first range, so that an index before all ranges also has a range on its left.
        self.firsts, self.ends = np.array([(-1, -1), *ranges]).T

    def __getitem__(self, indices: Any) -> Any:
        """Whether each of `indices` is in the set: a boolean, or a boolean array of the same shape."""
        range_index = np.searchsorted(self.firsts, indices, side="right") - 1
        return indices < self.ends[range_index]


@dataclass(frozen=True, slots=True)
class Shard:
    """Shard `number`, from 1, of the `shard_count` shards of a sweep, each solved by a separate run."""

    number: int = 1
    shard_count: int = 1

    def __str__(self) -> str:
        return f"{self.number}/{self.shard_count}"

    def ranges_of_shard(self, ranges: Sequence[IndexRange], item_count: int) -> list[IndexRange]:
        """Ranges of the items in `ranges` that belong to this shard. Blocks of the sweep's `item_count` items
        are assigned to the shards in turn."""
        if self.shard_count == 1:
            return list(ranges)
        block_size = max(1, item_count // (self.shard_count * BLOCKS_PER_SHARD))
        own_ranges: list[IndexRange] = []
        for start, end in ranges:
            block_number = start // block_size
            # The first block at or after `start` that belongs to this shard.
            block_number += (self.number - 1 - block_number) % self.shard_count
            while block_number * block_size < end:
                own_ranges.append(
                    (max(start, block_number * block_size), min(end, (block_number + 1) * block_size))
                )
                block_number += self.shard_count
        return own_ranges


def parsed_shard(text: str) -> Shard:
    """The `Shard` from a text like "2/8"; raises InputError for any other text."""
    number, _, count = text.partition("/")
    if number.isdecimal() and count.isdecimal() and len(text) < 20 and 1 <= int(number) <= int(count):
        return Shard(int(number), int(count))
    raise InputError(f"--shard {text[:40]} is not of the form I/N with 1 <= I <= N, such as 2/8")
