"""Reasons why points failed, each with one example, for the last lines of a run and for the result file."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...results.file.provenance import MAX_FAILURE_REASONS, reason_of
from ...sweep.loop import Indices
from ...sweep.points.stretches import StretchResult


def parameters_in_words(values: Mapping[str, float]) -> str:
    """Text with the parameters of a point: `F=40.0, k1=200.0`."""
    return ", ".join(f"{name}={value!r}" for name, value in values.items())


@dataclass(frozen=True, slots=True)
class FailureReasons:
    """Distinct reasons why points failed, each with the first point that failed for this reason.

    where: function from the flat index of a point to a text with its parameters. examples: text with
    parameters, status and message, by the reason with all numbers replaced.
    """

    where: Callable[[int], str]
    examples: dict[str, str] = field(default_factory=dict)

    def add(self, index: Indices, result: Any) -> list[str]:
        """Adds the reasons of failed points; returns the examples of reasons that are new.

        index, result: flat index and outcome of one point, or flat indices, (n,), and result of a stretch.
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
    """Yields (flat index, text with status and message) of each failed point of a result."""
    if isinstance(result, StretchResult):
        for i in np.flatnonzero(~result.succeeded):
            yield int(np.asarray(index)[i]), result.message(int(i))
    elif not result.status.succeeded:
        yield int(index), f"{result.status.name} {result.message}"
