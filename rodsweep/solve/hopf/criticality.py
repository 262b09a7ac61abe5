"""Task `criticality` for one rod: all Hopf points, with the criticality of the branch of cycles at each.

Hopf points are found and proved complete as in `task: thresholds`. Hopf points are independent of gamma1:
rods that differ only in gamma1 share one search.
"""

import math
from dataclasses import dataclass, replace
from functools import cache, lru_cache

from ...determinant.parameter_path import ParameterPath
from ...model.rod import Rod
from ..changes.search_range import search_end_below_crushing
from ..changes.threshold_kinds import Threshold
from ..changes.thresholds import ThresholdsRequest, missed_accuracy_text
from ..changes.thresholds_along_path import ThresholdSearchResult, find_imaginary_axis_crossings
from ..point_outcome import FAILURE_EXCEPTIONS, cause_of, outcome_or_failure
from .hopf_coefficients import HOPF_COEFFICIENT_SETTINGS, HopfCoefficients, hopf_coefficients
from .status import CriticalityStatus


@dataclass(frozen=True, slots=True, kw_only=True)
class Criticality:
    """Result for one rod: all Hopf points from the force 0 to the force `end`, where the search ended.
    search_result: all Hopf points, with or without coefficients, by increasing force. coefficients: normal
    form coefficients of the first Hopf points, at most as many as requested. seconds: computing time."""

    status: CriticalityStatus
    """Most serious problem of the search or of a coefficient, or ok."""
    search_result: ThresholdSearchResult
    coefficients: tuple[HopfCoefficients, ...]
    end: float
    seconds: float = 0.0
    message: str = ""
    """Causes of failures, and why the list is not proved; empty otherwise."""


def solve_criticality(rod: Rod, request: ThresholdsRequest) -> Criticality:
    """All Hopf points of `rod` for forces from 0 to `request.F_max`, or to just below a smaller crushing
    force, with the coefficients of the first `request.max_thresholds` Hopf points. The force of `rod` is
    ignored; a failure is returned as a status, never raised."""
    end = search_end_below_crushing(rod, request.F_max)

    def search() -> Criticality:
        # Without gamma1 and the force: rods that differ only in these two share the search.
        path = ParameterPath(replace(rod.without_nonlinear_parameters, F=0.0), "F")
        hopf_points = _hopf_points(path, end, request.certify, request.max_thresholds)
        # The file has no room for further normal forms.
        coefficients = tuple(
            _coefficients_or_nan(rod, hopf, request)
            for hopf in hopf_points.thresholds[: request.max_thresholds]
        )
        status, message = _status_and_message(hopf_points, coefficients, request)
        return Criticality(
            status=status,
            search_result=hopf_points,
            coefficients=coefficients,
            end=hopf_points.searched_interval[1],
            message=message,
        )

    def failed(cause: str) -> Criticality:
        return Criticality(
            status=CriticalityStatus.failed,
            search_result=ThresholdSearchResult(is_proved=False),
            coefficients=(),
            end=math.nan,
            message=cause,
        )

    return outcome_or_failure(search, failed)


@cache
def warm_up() -> None:
    """Solves one rod to load compiled code and to fill caches before a time is measured."""
    solve_criticality(Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4), ThresholdsRequest(40.0, 1e-8, True, 4))


@lru_cache(maxsize=HOPF_COEFFICIENT_SETTINGS.max_cached_searches)
def _hopf_points(path: ParameterPath, end: float, certify: bool, max_crossings: int) -> ThresholdSearchResult:
    return find_imaginary_axis_crossings(path, 0.0, end, certify, max_crossings)


def _coefficients_or_nan(rod: Rod, hopf: Threshold, request: ThresholdsRequest) -> HopfCoefficients:
    """Coefficients of the Hopf point `hopf`; NaN after a failure, with the cause as message."""
    try:
        return hopf_coefficients(replace(rod, F=hopf.value), hopf, request.accuracy)
    except FAILURE_EXCEPTIONS as error:
        return HopfCoefficients(message=f"Hopf point at F = {hopf.value:.12g}: {cause_of(error)}")


def _status_and_message(
    hopf_points: ThresholdSearchResult,
    coefficients: tuple[HopfCoefficients, ...],
    request: ThresholdsRequest,
) -> tuple[CriticalityStatus, str]:
    """Returns (status, message) from the Hopf points `hopf_points` and their coefficients. status: the most
    serious problem, or ok. message: causes of failures, and why the list is not proved."""
    failures = "; ".join(filter(None, (c.message for c in coefficients)))
    known_coefficients = [c for c in coefficients if c.are_known]
    stored_points = hopf_points.thresholds[: request.max_thresholds]
    inaccurate_forces = ", ".join(
        f"{hopf.value:.9g}"
        for hopf, c in zip(stored_points, coefficients, strict=True)
        if max(c.landau_error, c.growth_slope_error) > request.accuracy
    )
    accuracy_texts = (
        missed_accuracy_text("F", stored_points, request.accuracy),
        inaccurate_forces
        and f"the requested accuracy is missed by the coefficients at F = {inaccurate_forces}",
    )
    # From the most to the least serious.
    applies_by_status = {
        CriticalityStatus.ended_early: hopf_points.ended_early,
        CriticalityStatus.coefficients_failed: bool(failures),
        CriticalityStatus.window_open: not math.isnan(hopf_points.range_of_further_crossings[0]),
        CriticalityStatus.list_full: len(hopf_points.thresholds) > request.max_thresholds,
        CriticalityStatus.sign_undecided: any(c.criticality == 0 for c in known_coefficients),
        CriticalityStatus.accuracy_not_reached: any(accuracy_texts),
        CriticalityStatus.not_certified: request.certify and not hopf_points.is_proved,
    }
    status = next((status for status, applies in applies_by_status.items() if applies), CriticalityStatus.ok)
    # A more serious status does not say that a result is inaccurate, so the message says it.
    hidden_texts = accuracy_texts if status != CriticalityStatus.accuracy_not_reached else ()
    return status, "; ".join(filter(None, (failures, hopf_points.doubt_text, *hidden_texts)))
