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


def is_accurate_at_range_end(end: BranchEnd | None, accuracy: float) -> bool:
    """Whether the branch has an end at the end of the range and the errors of its period and largest tip y
    there meet the relative accuracy."""
    if end is None:
        return False
    return max(end.special_point.period_error, end.special_point.tip_y_max_error) <= accuracy


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
        error=BRANCH_END_SETTINGS.range_end_error * abs(value),
        period_error=fraction * abs(start_period / measures.period - 1) + hopf.period_error,
        tip_y_max_error=fraction * abs(start_amplitude / measures.tip_y_max - 1)
        + hopf.coefficient_error
        + displacement,
        reason=limits.end_reasons[index],
    )
