"""Task `thresholds` for one rod: all thresholds (`threshold_kinds`) as the force grows from 0 (paper, Sec.
VI)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from ...determinant.parameter_path import ParameterPath
from ...model.rod import Rod
from ..point_outcome import outcome_or_failure
from .search_range import search_end_below_crushing
from .status import ThresholdStatus
from .threshold_kinds import Threshold, ThresholdKind
from .thresholds_along_path import ThresholdSearchResult, find_thresholds


@dataclass(frozen=True, slots=True)
class ThresholdsRequest:
    """Request of the tasks thresholds and criticality, the same for each rod. F_max: largest force, in
    k3/L^2. accuracy: relative accuracy of each threshold, or of the coefficients of each Hopf point. certify:
    whether the list must be proved complete."""

    F_max: float
    accuracy: float
    certify: bool
    max_thresholds: int
    """Maximum number of thresholds in the list, or of Hopf points with coefficients."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Thresholds:
    """Result of a search: all thresholds along a path up to the parameter value `end`, with a status."""

    status: ThresholdStatus
    search_result: ThresholdSearchResult
    """Thresholds and unstable modes found by the search, with the searched interval and the reasons for
    doubts."""
    end: float
    seconds: float = 0.0
    """Wall-clock time of the search, in s."""
    message: str = ""
    """Cause of a failure or of doubts about the list; empty otherwise."""

    @property
    def thresholds(self) -> tuple[Threshold, ...]:
        """All thresholds, in increasing order of the parameter."""
        return self.search_result.thresholds


def solve_thresholds(rod: Rod, request: ThresholdsRequest) -> Thresholds:
    """All thresholds of `rod` for forces from 0 to `request.F_max`, or to just below the crushing force if
    smaller; a failure is returned as a status, never raised."""
    # At the crushing force the axial stretch is 0 and the equations are singular.
    end = search_end_below_crushing(rod, request.F_max)

    def search() -> Thresholds:
        result = find_thresholds(ParameterPath(rod, "F"), 0.0, end, request.certify, request.max_thresholds)
        return thresholds_with_status("F", result, request.accuracy, request.certify, request.max_thresholds)

    return outcome_or_failure(search, lambda cause: empty_thresholds(ThresholdStatus.failed, math.nan, cause))


def empty_thresholds(status: ThresholdStatus, end: float, message: str = "") -> Thresholds:
    """A result without thresholds, for a rod that needs no search or whose search failed. end: parameter
    value at the end of the search, NaN after a failure. message: reason for a failure."""
    result = ThresholdSearchResult(is_proved=status == ThresholdStatus.ok)
    return Thresholds(status=status, search_result=result, end=end, message=message)


def thresholds_with_status(
    name: str, result: ThresholdSearchResult, accuracy: float, certify: bool, max_thresholds: int
) -> Thresholds:
    """The result of a search along the parameter `name`, with its status: the most serious problem of the
    search, or ok. accuracy: requested relative accuracy. certify: whether a proof of completeness is
    requested. max_thresholds: maximum number of thresholds in the stored list."""
    status = ThresholdStatus.ok
    accuracy_text = missed_accuracy_text(name, result.thresholds[:max_thresholds], accuracy)
    # A part of the range that was not searched hides more than any other doubt, so it comes first.
    if result.ended_early:
        status = ThresholdStatus.ended_early
    elif not math.isnan(result.range_of_further_crossings[0]):
        status = ThresholdStatus.window_open
    # A list that is exactly full lacks no threshold.
    elif len(result.thresholds) > max_thresholds:
        status = ThresholdStatus.list_full
    # A proof is checked last: an inaccurate list is worse than an unproved one.
    elif accuracy_text:
        status = ThresholdStatus.accuracy_not_reached
    elif certify and not result.is_proved:
        status = ThresholdStatus.not_certified
    # A more serious status does not say that a stored threshold is inaccurate, so the message says it.
    hidden_text = accuracy_text if status != ThresholdStatus.accuracy_not_reached else ""
    message = "; ".join(filter(None, (result.doubt_text, hidden_text)))
    return Thresholds(status=status, search_result=result, end=result.searched_interval[1], message=message)


def missed_accuracy_text(name: str, thresholds: Sequence[Threshold], accuracy: float) -> str:
    """Text with the values of the parameter `name` at those `thresholds` whose relative error exceeds
    `accuracy`; empty if there are none."""
    values = ", ".join(f"{c.value:.9g}" for c in thresholds if c.error > accuracy * abs(c.value))
    return f"the requested accuracy is missed at {name} = {values}" if values else ""


@cache
def warm_up() -> None:
    """Solves one rod to load compiled code and to create the pooled solvers before a time is measured."""
    solve_thresholds(Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4), ThresholdsRequest(40.0, 1e-8, True, 4))


def filament_flutter_force() -> float:
    """Force, in k3/L^2, at which the filament (k1 = k2 = inf, gamma3 = 0) flutters (De Canio et al. 2017)."""
    result = find_thresholds(ParameterPath(Rod(F=0.0, k1=math.inf, k2=math.inf, gamma3=0.0), "F"), 0.0, 60.0)
    # The onset of oscillation comes before flutter, so the first threshold is not the onset of flutter.
    return next(c.value for c in result.thresholds if c.kind == ThresholdKind.hopf)
