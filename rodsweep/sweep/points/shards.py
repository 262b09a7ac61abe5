"""Shards: parts of a sweep, each solved by a separate run into a separate file."""

from collections.abc import Sequence
from dataclasses import dataclass

from ...errors import InputError
from .ranges import IndexRange

BLOCKS_A_SHARD = 64
"""Number of blocks of neighbouring units in a shard. Many blocks make shards equal in cost; more blocks would
separate neighbours in the file of the shard."""


@dataclass(frozen=True, slots=True)
class Shard:
    """Part `number` of `of` parts; 1/1 is the whole sweep."""

    number: int = 1
    of: int = 1

    def __str__(self) -> str:
        return f"{self.number}/{self.of}"

    def part(self, todo: Sequence[IndexRange], units: int) -> list[IndexRange]:
        """Ranges of this shard within the ranges `todo`.

        Blocks of all `units` are dealt out to the shards in turn.
        """
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
    """Shard of a text such as "2/8"; raises InputError for any wrong form."""
    number, _, of = text.partition("/")
    if number.isdecimal() and of.isdecimal() and len(text) < 20 and 1 <= int(number) <= int(of):
        return Shard(int(number), int(of))
    raise InputError(f"--shard {text[:40]} is not of the form i/n with 1 <= i <= n")
