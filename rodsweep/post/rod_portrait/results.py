"""What a portrait is drawn from: the results of one rod, and the reasons where a result is missing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ...results.file.view import View


@dataclass(frozen=True, slots=True, kw_only=True)
class RodResults:
    """Results of one rod, each a view of a single point.

    parameters: the rod's parameters, by name. F_max: largest requested force. views: thresholds, and
    criticality and branch unless missing. modes: (force, modes there) at the first thresholds, by kind.
    cycles: (force, limit cycle there), increasing. missing: for every task without a result, the reason in a
    sentence.
    """

    parameters: Mapping[str, float]
    F_max: float
    views: Mapping[str, View]
    modes: Mapping[str, tuple[float, View]]
    cycles: Sequence[tuple[float, View]]
    missing: Mapping[str, str]

    @property
    def branch(self) -> View | None:
        """Branches of cycles; None if they are missing."""
        return self.views.get("branch")
