"""The end of a branch at an end of the range just before a Hopf point, by the normal form of this Hopf point.

The cycles there are so small that a mesh may not hold them: it displaces the Hopf point by more than the
distance between this point and the end of the range.
"""

from math import inf

from ...model.parameters import PARAMETERS
from .arc_length_step import BranchCycle
from .branch_curve import BranchEnd, RangePassage
from .branch_end_settings import BRANCH_END_SETTINGS
from .branch_limits import BranchLimits
from .special.special_point import SpecialKind, SpecialPoint
from .start.hopf_point import HopfBranchStart


def end_at_range_end_near_hopf(
    start: BranchCycle, hopf: HopfBranchStart, limits: BranchLimits
) -> BranchEnd | None:
    """The end of a branch at the end of the range between its last cycle `start`, within the range, and the
    Hopf point `hopf` beyond the range; None if the cycles of the normal form do not lie between both."""
    low, high = limits.coordinate_range
    index = 0 if hopf.parameter_coordinate < low else 1
    distance = limits.coordinate_range[index] - hopf.parameter_coordinate
    start_distance = start.parameter_coordinate - hopf.parameter_coordinate
    fraction = distance / start_distance if start_distance else inf
    if not 0 <= fraction < 1 or hopf.direction * distance < 0:
        return None
    special = _point_at_range_end(start, hopf, limits, index)
    passage = RangePassage(start, index, limits.accuracy, hopf, special)
    return BranchEnd(special, complete=True, range_passage=passage)


def has_accurate_range_end(
    end: BranchEnd | None, start: BranchCycle, hopf: HopfBranchStart, limits: BranchLimits
) -> bool:
    """Whether the branch has the end `end` of `end_at_range_end_near_hopf`, and its errors of period and
    largest tip y meet the accuracy or are at most the errors of a cycle that is solved at the end of the
    range.

    A mesh displaces the Hopf point, so the errors of its cycles grow with 1/distance from this point. The
    errors of the normal form decrease with the distance, but not if `start` is closer.
    """
    if end is None or end.range_passage is None:
        return False
    end_distance = abs(limits.coordinate_range[end.range_passage.index] - hopf.parameter_coordinate)
    start_distance = abs(start.parameter_coordinate - hopf.parameter_coordinate)
    growth = start_distance / end_distance if end_distance else inf
    errors = start.cycle.errors
    max_period_error = max(limits.accuracy, growth * errors.period_error)
    max_tip_y_error = max(limits.accuracy, growth * errors.amplitude_error)
    special = end.special_point
    return special.period_error <= max_period_error and special.tip_y_max_error <= max_tip_y_error


def _point_at_range_end(
    start: BranchCycle, hopf: HopfBranchStart, limits: BranchLimits, index: int
) -> SpecialPoint:
    """The special point at the end `index` of the range. The normal form errs at this point and at `start` in
    proportion to the distances from the Hopf point; the errors of its coefficients are added."""
    coordinate = limits.coordinate_range[index]
    distance = abs(coordinate - hopf.parameter_coordinate)
    fraction = distance / abs(start.parameter_coordinate - hopf.parameter_coordinate)
    start_period, start_amplitude = hopf.period_and_amplitude_at(start.parameter_coordinate)
    measures = start.cycle.measures
    period, amplitude = hopf.period_and_amplitude_at(coordinate)
    # The amplitude is the square root of the distance, which is uncertain by the error of the Hopf point.
    hopf_error = abs(hopf.crossing.error / hopf.crossing.value * hopf.parameter_coordinate)
    displacement = hopf_error / (2 * distance) if distance else inf
    value = float(PARAMETERS[hopf.parameter_name].value(coordinate))
    return SpecialPoint(
        kind=SpecialKind.end,
        parameter_value=value,
        period=period,
        tip_y_max=amplitude,
        error=BRANCH_END_SETTINGS.relative_parameter_error_at_range_end * abs(value),
        period_error=fraction * abs(start_period / measures.period - 1) + hopf.period_error,
        tip_y_max_error=fraction * abs(start_amplitude / measures.tip_y_max - 1)
        + hopf.relative_coefficient_error
        + displacement,
        reason=limits.end_reasons[index],
    )
