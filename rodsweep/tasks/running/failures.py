"""Reasons why points failed, each with one example, for the last lines of a run and for the result file."""

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
    """Distinct reasons why points failed, each with the first point that failed for this reason.

    where: function from the index of a point to its parameters in words. examples: point, status and message
    in words, by the reason with all numbers removed.
    """

    where: Callable[[int], str]
    examples: dict[str, str] = field(default_factory=dict)

    def add(self, index: Indices, result: Any) -> list[str]:
        """Adds the reasons of failed points; returns the examples of reasons that are new.

        index: of one point with its outcome, or of the n points of a stretch, (n,), with their result.
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
    """Yields (index, status and message in words) of the failed points of a result."""
    if isinstance(result, StretchResult):
        for i in np.flatnonzero(~result.succeeded):
            yield int(np.asarray(index)[i]), result.message(int(i))
    elif not result.status.succeeded:
        yield int(index), f"{result.status.name} {result.message}"
