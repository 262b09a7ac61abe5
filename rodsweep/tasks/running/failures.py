"""Reasons why points failed, each with its first point, for the last lines of a run and for the file."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...results.file.provenance import MAX_FAILURE_REASONS, reason_of
from ...sweep.loop import Indices
from ...sweep.points.stretches import StretchResult


def parameters_in_words(values: Mapping[str, float]) -> str:
    """A point's parameters in words: `F=40.0, k1=200.0`."""
    return ", ".join(f"{name}={value!r}" for name, value in values.items())


@dataclass(frozen=True, slots=True)
class FailureReasons:
    """The first point of each distinct reason, in words, by the reason without numbers.

    where: a point's parameters in words, from the point's index.
    """

    where: Callable[[int], str]
    examples: dict[str, str] = field(default_factory=dict)

    def add(self, index: Indices, result: Any) -> list[str]:
        """Notes the reasons of failed points: of one outcome, or of a stretch with n indices, (n,).

        Returns the new ones, a line each.
        """
        new = []
        for at, outcome in _failed(index, result):
            if len(self.examples) >= MAX_FAILURE_REASONS:
                break
            line = " ".join(f"{self.where(at)}: {outcome}".split())
            if reason_of(line) not in self.examples:
                self.examples[reason_of(line)] = line
                new.append(line)
        return new


def _failed(index: Indices, result: Any) -> Iterable[tuple[int, str]]:
    """Yields (index, status and message) of failed points."""
    if isinstance(result, StretchResult):
        for i in np.flatnonzero(~result.succeeded):
            yield int(np.asarray(index)[i]), result.message(int(i))
    elif not result.status.succeeded:
        yield int(index), f"{result.status.name} {result.message}"
