"""Reasons why points failed, each with one example, for the last lines of a run and for the result file."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

from ...results.file.provenance import MAX_FAILURE_REASONS, failure_kind
from ...results.layouts.variables import STATUS_VARIABLE
from ...solve.status import PointStatus
from ...sweep.loop import PointIndexOrIndices
from ...sweep.points.groups import GroupResult
from ..protocol import SweepWideResult


@dataclass(frozen=True, slots=True)
class FailureReasons:
    """Distinct reasons why points failed, each with the first point that failed for this reason; at most
    MAX_FAILURE_REASONS.

    point_text: function from the flat index of a point to a text with its parameters. examples: text with
    parameters, status and message, by the reason with all numbers replaced.
    """

    point_text: Callable[[int], str]
    examples: dict[str, str] = field(default_factory=dict)

    def add(self, index: PointIndexOrIndices, result: Any) -> list[str]:
        """Adds the reason why a point failed; returns a list with this example, or an empty list if the
        reason is known, the list of reasons is full, or no point failed.

        index, result: flat index and outcome of one point, or flat indices, (n,), and result of a group, of
        which no point failed.
        """
        if isinstance(result, GroupResult) or result.status.succeeded:
            return []
        if len(self.examples) >= MAX_FAILURE_REASONS:
            return []
        point = self.point_text(int(index))
        line = " ".join(f"{point}: {result.status.name} {result.message}".split())
        if failure_kind(line) in self.examples:
            return []
        self.examples[failure_kind(line)] = line
        return [line]


def failure_reasons_of_changed_points(
    result: SweepWideResult, statuses: Sequence[PointStatus], point_text: Callable[[int], str]
) -> list[str]:
    """Distinct reasons why points that have changed since they were solved failed. point_text: function from
    the flat index of a point to a text with its parameters."""
    status_by_value = {int(status): status for status in statuses}
    reasons = FailureReasons(point_text)
    for index, values in result.changed_points.items():
        status = status_by_value[int(values[STATUS_VARIABLE.name])]
        reasons.add(index, SimpleNamespace(status=status, message=result.messages[index]))
    return [*reasons.examples.values()]
