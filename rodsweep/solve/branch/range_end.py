"""The last cycle of a branch, at an end of the parameter range."""

from collections.abc import Callable
from dataclasses import replace

from numpy.polynomial import Polynomial

from ...arrays import list_of
from ...model.parameters import PARAMETERS
from ..continuation.curve import step_length_to_zero
from ..cycle.accuracy.newton_tolerances import allowed_distance_from_matrix_orbit
from ..orbit.orbit import Orbit
from ..unsolvable import Unsolvable, WorkLimitReached
from .arc_length_step import (
    ARC_STEP_CONTROL,
    BranchCycle,
    arc_length_between,
    branch_cycle_with_calibrated_errors,
    cycle_at_length,
    tangent_at,
)
from .bordered.border_condition import BorderCondition, moved_orbit
from .bordered.corrected_linearisation import linearisation_of
from .bordered.scale import PARAMETER_DIRECTION
from .branch_errors import branch_newton_tolerance
from .settings import BRANCH_END_SETTINGS
from .special.branch_segment import BranchSegment


def range_end_condition(start: BranchCycle, limit: float) -> BorderCondition:
    """The condition that the branch parameter of a cycle has the coordinate `limit` (1/k for a stiffness k,
    otherwise the value), scaled with the units of the cycle `start`."""
    return BorderCondition(start.scale, PARAMETER_DIRECTION, limit / start.scale.coordinate_unit)


def index_of_passed_range_end(point: BranchCycle, range_ends: tuple[float, float]) -> int:
    """Index of the end of the range beyond which the cycle `point` lies: 0 below the range, 1 above, -1
    within the range. range_ends: smallest and largest coordinate of the range; the coordinate of a parameter
    is 1/k for a stiffness k, otherwise the value."""
    low, high = range_ends
    if point.parameter_coordinate < low:
        return 0
    return 1 if point.parameter_coordinate > high else -1


def cycle_at_range_end(
    start: BranchCycle, end: BranchCycle, range_end: BorderCondition, accuracy: float
) -> BranchCycle:
    """The cycle at an end of the parameter range, between the cycles `start` and `end`, to a relative
    accuracy; raises Unsolvable. range_end: condition that the cycle lies at this end of the range."""
    segment = BranchSegment(start, end)

    def beyond(length: float) -> float:
        # Evaluated on the predicted cubic; only the final cycle is solved, below.
        return -range_end.residual(segment.predicted_orbit(length))

    tolerance = BRANCH_END_SETTINGS.range_end_step_tolerance
    end_distances = beyond(0.0), beyond(segment.length)
    inner_length = 0.0
    # The step begins at the end of the range, so the first zero is not the zero that is sought.
    if abs(end_distances[0]) <= tolerance * abs(end_distances[1]):
        inner_length = _step_length_into_range(beyond, segment.length)
        end_distances = beyond(inner_length), end_distances[1]
    length = inner_length + step_length_to_zero(
        lambda part: beyond(inner_length + part), end_distances, segment.length - inner_length, 0.0, tolerance
    )
    return _solved_at_range_end(start, segment.predicted_orbit(length), length, range_end, accuracy)


def _step_length_into_range(beyond: Callable[[float], float], step: float) -> float:
    """A length along a step at which the branch lies within the range, although the step begins and ends at
    or beyond an end of the range: the branch enters the range and leaves it again behind a fold. 0 if the
    step leads out of the range at once.

    beyond: function from a length along the step to the signed distance of the branch parameter from the end
    of the range. step: length of the step.
    """
    length = step / 2
    while length > BRANCH_END_SETTINGS.range_end_step_tolerance * step:
        if beyond(length) * beyond(step) < 0:
            return length
        length /= 2
    return 0.0


def cycle_at_range_end_beside_zero(start: BranchCycle, low: float, accuracy: float) -> BranchCycle | None:
    """The cycle at the smallest coordinate `low` of the range (1/k for a stiffness k, else the value), for a
    parameter that cannot be negative, if the next step could pass the coordinate 0, beyond which no rod
    exists. None unless the tangent at `start` reaches 0 within the next step; also None if no cycle is found,
    as when the branch folds before `low`. accuracy: relative accuracy. Raises WorkLimitReached."""
    rate = float(start.tangent[-1])
    coordinate = start.parameter_coordinate
    name = start.scale.parameter_name
    # -1 stands for all negative values, which a parameter allows or forbids together.
    may_be_negative = PARAMETERS[name].allowed_range.contains(-1.0)
    if may_be_negative or low < 0 or rate >= 0 or -coordinate / rate > start.next_step_length:
        return None
    length = (low - coordinate) / rate
    change = length * start.tangent
    change[-1] = low - coordinate
    try:
        predicted = moved_orbit(start.orbit, name, change)
        predicted = replace(predicted, form=predicted.form.with_coordinate(name, low))  # without rounding
        return _solved_at_range_end(start, predicted, length, range_end_condition(start, low), accuracy)
    except WorkLimitReached:
        raise
    except Unsolvable:
        return None


def cycle_with_step_into_range(
    start: BranchCycle, range_ends: tuple[float, float], index: int, accuracy: float
) -> BranchCycle | None:
    """The cycle `start`, at the range end `range_ends[index]`, with the length of the next step halved until
    the step ends within the range or beyond its other end: a longer step may lead over a fold back out of the
    range. None if even the shortest step does not end there. accuracy: relative accuracy."""
    length = start.next_step_length
    while length >= ARC_STEP_CONTROL.min_length:
        try:
            end = cycle_at_length(start, length, accuracy)
            if index_of_passed_range_end(end, range_ends) != index:
                return replace(start, next_step_length=length)
        except WorkLimitReached:
            return None
        except Unsolvable:
            pass  # the step is too long for the prediction
        length /= 2
    return None


def cycle_within_range_and_end_index(
    start: BranchCycle, end: BranchCycle, range_ends: tuple[float, float], accuracy: float
) -> tuple[BranchCycle, int]:
    """Returns (cycle, index). cycle: `end`, or the cycle where the branch first leaves the parameter range
    between `start` and `end`. index: index in `range_ends` of the range end at this cycle; -1 if the cycle is
    within the range. Raises Unsolvable.

    range_ends: smallest and largest coordinate of the range. accuracy: relative accuracy of the cycle.
    Between two cycles within the range the branch may leave the range and return, if a fold lies beyond an
    end. A step over such a fold would continue on another part of the branch.
    """
    coordinate = end.parameter_coordinate
    for index, is_beyond in ((0, coordinate <= range_ends[0]), (1, coordinate >= range_ends[1])):
        if is_beyond:
            range_end = range_end_condition(start, range_ends[index])
            return cycle_at_range_end(start, end, range_end, accuracy), index
    index, length = _range_end_passed_before_fold(start, end, range_ends)
    if index >= 0:
        range_end = range_end_condition(start, range_ends[index])
        try:
            orbit = cycle_at_length(start, length, accuracy).orbit
            return _solved_at_range_end(start, orbit, length, range_end, accuracy), index
        except WorkLimitReached:
            raise
        except Unsolvable:
            pass  # the fold is within the range: the branch does not reach the range end
    return end, -1


def _range_end_passed_before_fold(
    start: BranchCycle, end: BranchCycle, range_ends: tuple[float, float]
) -> tuple[int, float]:
    """Returns (index, length): index in `range_ends` of the range end that the branch is expected to pass
    between `start` and `end` by the cubic through both cycles, and the arc length from `start` at which it
    passes; (-1, 0.0) if the cubic passes no range end or if no fold lies between the two cycles."""
    if start.parameter_per_arc_length * end.parameter_per_arc_length >= 0:
        return -1, 0.0
    index = 1 if start.parameter_per_arc_length > 0 else 0
    length = arc_length_between(start, end)
    rate = float(start.scale.directional_derivative(end.orbit, end.tangent) @ start.unit_tangent)
    slopes = length * start.tangent[-1], length * end.tangent[-1] / rate
    increment = end.parameter_coordinate - start.parameter_coordinate
    # The cubic minus the range end, a polynomial in the fraction of the arc length.
    cubic = Polynomial(
        (
            start.parameter_coordinate - range_ends[index],
            slopes[0],
            3 * increment - 2 * slopes[0] - slopes[1],
            slopes[0] + slopes[1] - 2 * increment,
        )
    )
    # A real root of a real polynomial has an imaginary part of exactly 0 in NumPy.
    fractions = [root.real for root in list_of(cubic.roots()) if root.imag == 0 and 0 < root.real < 1]
    return (index, length * min(fractions)) if fractions else (-1, 0.0)


def _solved_at_range_end(
    start: BranchCycle, predicted: Orbit, length: float, range_end: BorderCondition, accuracy: float
) -> BranchCycle:
    """The cycle near the orbit `predicted`, at about the arc length `length` from `start`, that fulfils the
    condition `range_end`; raises Unsolvable."""
    solved_orbit = range_end.solve_cycle(
        predicted,
        branch_newton_tolerance(accuracy),
        start.workspace,
        allowed_distance_from_matrix_orbit(accuracy),
    )
    tangent = tangent_at(solved_orbit.orbit, start.scale, start.unit_tangent, linearisation_of(solved_orbit))
    return branch_cycle_with_calibrated_errors(start, solved_orbit, tangent, length, length, accuracy)
