"""Rows of a phase diagram: the class of the rod at each value along one axis, and all thresholds along the
row.

All thresholds along a row are found first (`thresholds_along_path`). The thresholds determine the class of
every point without a solve at the point, and each threshold is as accurate as Newton's method.
"""

import math
from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....model.rod import Rod
from ...point_outcome import outcome_or_failure
from ..search_range import CRUSHING_END_SETTINGS
from ..status import ThresholdStatus
from ..thresholds import Thresholds, empty_thresholds, thresholds_with_status
from ..thresholds_along_path import ThresholdSearchResult
from .solvable_part import thresholds_of_solvable_part


class StabilityClass(IntEnum):
    """Behaviour of a small deflection of the straight rod.

    monotone, oscillatory: stable; the slowest mode decays without or with oscillations. flutter: at least one
    mode grows. undecided: within the error of a threshold, or unknown. crushed: F is at least the crushing
    force of the rod, which is k1 for a uniform rod of linear material.
    """

    monotone = 0
    oscillatory = 1
    flutter = 2
    undecided = 3
    crushed = 4


@dataclass(frozen=True, slots=True)
class RowRequest:
    """Request for the rows of a phase diagram, the same for each row: parameter that varies along the row,
    and its increasing values, (values,). certify: whether the list of thresholds must be proved complete."""

    parameter_name: str
    """Name of the parameter that varies along a row."""
    parameter_values: Array
    accuracy: float
    """Relative accuracy of the thresholds."""
    certify: bool
    max_thresholds: int
    """Maximum number of stored thresholds."""
    cycle_accuracy: float = 1e-6
    """Relative accuracy of the period and of the largest tip y of each cycle, if cycles are requested."""
    max_special_points: int = 0
    """Maximum number of special points of branches of cycles that are stored for a row, if cycles are
    requested."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DiagramRow:
    """Result for one row of a phase diagram, whose rods differ in one parameter only: stability class and
    number of unstable modes at each value of this parameter, (values,) each, and all thresholds along the
    row. unstable_count: -1 where unknown or crushed. seconds: computing time of the row, in s."""

    stability_class: NDArray[np.int8]
    """Value of `StabilityClass` at each value of the row's parameter, (values,)."""
    unstable_count: NDArray[np.int32]
    thresholds: Thresholds
    seconds: float = 0.0

    @property
    def status(self) -> ThresholdStatus:
        return self.thresholds.status

    @property
    def message(self) -> str:
        return self.thresholds.message


def solve_row(rod: Rod, request: RowRequest) -> DiagramRow:
    """The row of rods that differ from `rod` in the requested parameter; a failure is returned as a status,
    never raised."""

    def failed(cause: str) -> DiagramRow:
        return _row_of_one_class(
            ThresholdStatus.failed, request.parameter_values, StabilityClass.undecided, cause
        )

    # ValueError: the search needs a rod whose parameters are outside the allowed range.
    return outcome_or_failure(lambda: _search_row(rod, request), failed, more_failures=(ValueError,))


def crushed_row(values: Array) -> DiagramRow:
    """A row in which the force crushes the rod at all `values`, (values,), of the parameter."""
    return _row_of_one_class(ThresholdStatus.ok, values, StabilityClass.crushed)


def _search_row(rod: Rod, request: RowRequest) -> DiagramRow:
    """The row of `request`, searched for thresholds between the first and the last value at which the rod is
    not crushed; along F or k1 up to the value at which the force crushes the rod. A row of crushed rods only
    is not searched."""
    name = request.parameter_name
    values = request.parameter_values
    F = values if name == "F" else np.full(len(values), rod.F)
    k1 = values if name == "k1" else np.full(len(values), rod.k1)
    crushing_force_over_k1 = rod.material.crushing_force_over_k1(rod.taper)
    crushing_force = k1 * crushing_force_over_k1
    is_uncrushed = crushing_force * (1 - CRUSHING_END_SETTINGS.relative_crushing_margin) > F
    is_crushed = crushing_force * (1 - CRUSHING_END_SETTINGS.relative_crushing_tolerance) <= F
    is_nearly_crushed = ~is_uncrushed & ~is_crushed
    if not is_uncrushed.any():
        row = crushed_row(values)
        return replace(
            row,
            stability_class=np.where(is_crushed, StabilityClass.crushed, StabilityClass.undecided).astype(
                np.int8
            ),
        )
    start = float(values[is_uncrushed][0])
    stop = float(values[is_uncrushed][-1])
    # Thresholds may lie between the last value that is not crushed and the crushing force.
    if name == "F" and not is_uncrushed.all():
        stop = rod.crushing_force * (1 - CRUSHING_END_SETTINGS.relative_crushing_margin)
    if name == "k1" and not is_uncrushed.all():
        start = (
            rod.F / (crushing_force_over_k1 * (1 - CRUSHING_END_SETTINGS.relative_crushing_margin))
            if rod.F > 0
            else start
        )
    result = thresholds_of_solvable_part(
        rod, name, values[(values > start) & (values < stop)], (start, stop), request.certify
    )
    classes, unstable_counts = classes_and_unstable_counts(result, values)
    # Nearly crushed rods lie outside the searched range.
    classes[is_crushed] = StabilityClass.crushed
    unstable_counts[is_crushed] = -1
    classes[is_nearly_crushed] = StabilityClass.undecided
    unstable_counts[is_nearly_crushed] = -1
    thresholds = thresholds_with_status(
        name, result, request.accuracy, request.certify, request.max_thresholds
    )
    return DiagramRow(stability_class=classes, unstable_count=unstable_counts, thresholds=thresholds)


def _row_of_one_class(
    status: ThresholdStatus, values: Array, rod_class: StabilityClass, message: str = ""
) -> DiagramRow:
    """A row without thresholds, with the class `rod_class` at all values. status, message: outcome of the
    search."""
    return DiagramRow(
        stability_class=np.full(len(values), rod_class, dtype=np.int8),
        unstable_count=np.full(len(values), -1, dtype=np.int32),
        thresholds=empty_thresholds(status, float(values[-1]), message),
    )


def classes_and_unstable_counts(
    result: ThresholdSearchResult, values: Array
) -> tuple[NDArray[np.int8], NDArray[np.int32]]:
    """Returns (class, number of unstable modes) at each of the parameter values `values`, (values,) each,
    from the thresholds in `result`. The class is undecided and the number is -1 within the error of a
    threshold, within `range_of_further_crossings`, outside the searched interval, and where the number is
    unknown."""
    oscillates = np.full(len(values), result.oscillates_at_start)
    unstable_counts = np.full(len(values), result.unstable_at_start, dtype=np.int32)
    is_undecided = np.zeros(len(values), dtype=bool)
    for crossing in result.thresholds:
        is_beyond = values > crossing.value
        if crossing.kind.switches_real_and_complex:
            oscillates[is_beyond] = crossing.kind.pair_leads_after
        else:
            unstable_counts[is_beyond] = crossing.unstable_after
        is_undecided |= np.abs(values - crossing.value) <= crossing.error
    if result.ended_early:
        is_undecided |= (values < result.searched_interval[0]) | (values > result.searched_interval[1])
    low, high = result.range_of_further_crossings
    if not math.isnan(low):
        is_undecided |= (values >= low) & (values <= high)
        # Crossings in the open range are unknown; behind this range the count at the end applies.
        unstable_counts[values > max([high, *(c.value for c in result.thresholds)])] = result.unstable_at_end
    classes = np.where(oscillates, StabilityClass.oscillatory, StabilityClass.monotone).astype(np.int8)
    classes[unstable_counts > 0] = StabilityClass.flutter
    is_undecided |= unstable_counts < 0
    classes[is_undecided] = StabilityClass.undecided
    unstable_counts[is_undecided] = -1
    return classes, unstable_counts
