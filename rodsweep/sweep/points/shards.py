"""A shard: the part of a sweep that one of several separate runs does, each into a file of its own."""

from collections.abc import Sequence
from dataclasses import dataclass

from ...errors import InputError
from .ranges import IndexRange

BLOCKS_A_SHARD = 64
"""Blocks of neighbouring units that a shard consists of: many, so that shards cost alike, but no more, so
that neighbours stay together in its file."""


@dataclass(frozen=True, slots=True)
class Shard:
    """The number-th of `of` parts; the only one where a sweep is not divided."""

    number: int = 1
    of: int = 1

    def __str__(self) -> str:
        return f"{self.number}/{self.of}"

    def part(self, todo: Sequence[IndexRange], units: int) -> list[IndexRange]:
        """What of the ranges `todo` among all `units` is this shard's: blocks dealt out in turn."""
        if self.of == 1:
            return list(todo)
        block = max(1, units // (self.of * BLOCKS_A_SHARD))
        mine: list[IndexRange] = []
        for start, stop in todo:
            turn = start // block
            turn += (self.number - 1 - turn) % self.of
            while turn * block < stop:
                mine.append((max(start, turn * block), min(stop, (turn + 1) * block)))
                turn += self.of
        return mine


def shard_of(text: str) -> Shard:
    """The shard that "2/8" names; InputError for anything else."""
    number, _, of = text.partition("/")
    if number.isdecimal() and of.isdecimal() and len(text) < 20 and 1 <= int(number) <= int(of):
        return Shard(int(number), int(of))
    raise InputError(f"--shard {text[:40]} is not of the form i/n with 1 <= i <= n")
