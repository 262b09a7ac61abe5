"""Location of special points on a branch: zeros of test functions of arc length.

Each value of a test function requires a cycle. The zero is bracketed on the mesh of the branch, or predicted
at a fold, then found by the secant method on finer meshes. The difference between the zeros on the last two
meshes gives the error. A cycle needs one matrix only: the factors of the last matrix correct its test
function (`augmented`), and serve for the next cycle if it is near.
"""

import numpy as np

from ....arrays import Array, Complex
from ...continuation.curve import step_length_to_zero
from ...orbit.least_stretch import least_stretch
from ...orbit.measures import CycleMotion
from ...orbit.newton import ConvergedOrbit
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import mesh_limit_error
from ...unsolvable import Unsolvable, WorkLimitReached
from ..arc_length_step import BranchCycle
from ..bordered.border_condition import moved_orbit
from ..bordered.corrected_linearisation import nearby_bordered_matrix
from ..bordered.scale import ArcLengthScale
from .augmented.fold_and_torus_test_functions import TorusTestFunction, correct_until_converged
from .branch_segment import BranchSegment
from .special_point import SPECIAL_POINT_SETTINGS, SpecialPoint, SpecialPointKind
from .special_point_errors import (
    TestFunctionZero,
    first_mesh_for_special_point,
    next_finer_mesh,
    parameter_error_from_meshes,
    special_point_at,
    unlocated_point,
    with_mesh_errors,
)


def kind_at_multiplier_minus_one(orbit: Orbit) -> SpecialPointKind:
    """Kind of the special point at which a multiplier of `orbit` over the solved part of the period passes
    -1."""
    return SpecialPointKind.symmetry_breaking if orbit.is_symmetric else SpecialPointKind.period_doubling


def test_function_value(kind: SpecialPointKind, segment: BranchSegment, solved: ConvergedOrbit) -> float:
    """Value of the test function of special points of a kind at the cycle `solved`, the last cycle that
    `segment` solved; raises Unsolvable."""
    if kind == SpecialPointKind.fold:
        return segment.parameter_per_arc_length()
    if kind == SpecialPointKind.left_the_model:
        return least_stretch(CycleMotion(solved.orbit))
    if kind == SpecialPointKind.torus:
        function = TorusTestFunction(nearby_bordered_matrix(solved))
        correct_until_converged(function, solved.orbit)
        return function.value(solved.orbit)
    matrix = segment.matrix_at(solved.orbit)
    return multiplier_test_function(kind, matrix.multipliers_over_solved_time_interval)


def multiplier_test_function(kind: SpecialPointKind, h: Complex) -> float:
    """Value of the test function of torus points, symmetry breakings or period doublings, by `kind`. h:
    multipliers over the solved part of the period, (multipliers,). Torus point: |m| - 1 for the complex
    multiplier m nearest to the unit circle; raises Unsolvable if all multipliers are real. Otherwise: the
    smallest |m + 1|, negative if an odd number of real multipliers is less than -1."""
    is_real = np.abs(h.imag) <= SPECIAL_POINT_SETTINGS.real_multiplier_tolerance * np.abs(h)
    if kind != SpecialPointKind.torus:
        # The product of h + 1 changes sign only where a real multiplier crosses -1.
        return float((-1) ** (h[is_real].real < -1).sum() * np.abs(h + 1).min())
    # Without a complex pair the test function is not defined.
    if is_real.all():
        raise Unsolvable("all multipliers are real, so no complex pair crosses the unit circle")
    modulus_excess = np.abs(h[~is_real]) - 1
    return float(modulus_excess[np.argmin(np.abs(modulus_excess))])


def _test_value_at_end(
    kind: SpecialPointKind, scale: ArcLengthScale, tangent: Array, point: BranchCycle
) -> float:
    """Value of the test function of special points of the kind `kind` at `point`, an end of a segment; raises
    Unsolvable. scale: units of the arc length. tangent: unit tangent of the branch at the start of the
    segment, (3,)."""
    if kind == SpecialPointKind.fold:
        # The variable of the search is the arc length along `tangent`.
        rate = float(scale.directional_derivative(point.orbit, point.tangent) @ tangent)
        return float(point.tangent[-1]) / scale.coordinate_unit / rate
    if kind == SpecialPointKind.left_the_model:
        return least_stretch(point.cycle.motion)
    return multiplier_test_function(kind, point.multipliers_over_solved_time_interval)


def special_point_between(
    kind: SpecialPointKind, start: BranchCycle, end: BranchCycle, accuracy: float
) -> SpecialPoint:
    """The special point of a kind between the cycles `start` and `end`, to the smaller of the relative
    accuracies `accuracy` and `SPECIAL_POINT_SETTINGS.accuracy`, or with a larger error if no allowed mesh
    suffices or the limit of the work is reached. A point that is not located has a message, and the parameter
    difference of the two cycles as error."""
    required_accuracy = min(accuracy, SPECIAL_POINT_SETTINGS.accuracy)
    try:
        if kind == SpecialPointKind.fold:
            try:
                segment = BranchSegment(start, end)
                point, length = _special_point_near(
                    kind, segment, segment.predicted_fold_length_and_slope(), required_accuracy
                )
                # Nothing encloses the prediction, which may have led to another fold.
                if not 0 <= length <= segment.length:
                    raise Unsolvable("the predicted fold does not lie between the two cycles")
                return point
            except WorkLimitReached:
                raise
            except Unsolvable:
                pass  # the fold is bracketed instead
        segment = BranchSegment(start, end)
        return _special_point_near(
            kind, segment, _bracketed_zero_and_slope(kind, segment), required_accuracy
        )[0]
    except Unsolvable as reason:
        return unlocated_point(kind, start, end, f"the special point ({kind.name}) is not located: {reason}")


def _special_point_near(
    kind: SpecialPointKind, segment: BranchSegment, guess: tuple[float, float], required_accuracy: float
) -> tuple[SpecialPoint, float]:
    """Returns (special point of a kind, its arc length on `segment`), to the relative accuracy
    `required_accuracy`, or with a larger error if no allowed mesh suffices or the limit of the work is
    reached; raises Unsolvable. guess: (arc length near the point, slope of the test function there)."""
    length, slope = guess
    name = segment.start.scale.parameter_name
    mesh = first_mesh_for_special_point(segment.end.calibration, required_accuracy)
    point: SpecialPoint | None = None
    zero: TestFunctionZero | None = None
    for comparison_index in range(SPECIAL_POINT_SETTINGS.max_mesh_comparisons + 1):
        segment.mesh = mesh
        coarser_point, coarser_zero = point, zero
        try:
            zero = _zero_by_secants(kind, segment, length, slope)
        except WorkLimitReached:
            if point is None or np.isnan(point.error):
                raise
            break  # the point on coarser meshes, with its measured error
        length, slope = zero.arc_length, zero.test_function_slope
        point = special_point_at(kind, zero, name)
        difference_ratio = 1.0
        if coarser_point is not None and coarser_zero is not None:
            difference_ratio = parameter_error_from_meshes(point, coarser_point) / (
                required_accuracy * abs(point.parameter_value)
            )
            point = with_mesh_errors(point, coarser_point, (coarser_zero, zero), segment, required_accuracy)
            if difference_ratio <= 1:
                break
        # Every second mesh is chosen from the measured error; the mesh after it is only slightly finer.
        mesh = next_finer_mesh(mesh, difference_ratio if comparison_index % 2 else 1.0)
        if not mesh.is_allowed:
            break
    if point is None or np.isnan(point.error):
        raise mesh_limit_error()
    return point, length


def _bracketed_zero_and_slope(kind: SpecialPointKind, segment: BranchSegment) -> tuple[float, float]:
    """Returns (arc length of an approximate zero of the test function of `kind` on `segment`, slope of this
    function there), by bracketing; raises Unsolvable."""
    start = segment.start
    ends_of_segment = ((0.0, start), (segment.length, segment.end))
    values = {
        zero_length: _test_value_at_end(kind, start.scale, start.unit_tangent, point)
        for zero_length, point in ends_of_segment
    }

    def kept(length: float) -> float:
        values[length] = test_function_value(kind, segment, segment.cycle_at(length))
        return values[length]

    ends = values[0.0], values[segment.length]
    tolerance = SPECIAL_POINT_SETTINGS.bracket_tolerance * min(map(abs, ends))
    zero_length = step_length_to_zero(
        kept, ends, segment.length, tolerance, SPECIAL_POINT_SETTINGS.bracket_tolerance
    )
    other_length = min((x for x in values if x != zero_length), key=lambda x: abs(x - zero_length))
    slope = (values[zero_length] - values[other_length]) / (zero_length - other_length)
    return zero_length - values[zero_length] / slope, slope


def _zero_by_secants(
    kind: SpecialPointKind, segment: BranchSegment, guess: float, slope: float
) -> TestFunctionZero:
    """The zero of the test function near the arc length `guess`, by the secant method on `segment`; raises
    Unsolvable. slope: approximate slope, for the first step."""
    max_step_ratio = (
        SPECIAL_POINT_SETTINGS.max_last_secant_step_per_branch_step_at_fold
        if kind == SpecialPointKind.fold
        else SPECIAL_POINT_SETTINGS.max_last_secant_step_per_branch_step
    )
    tolerance = segment.length * max_step_ratio
    length = guess
    step = np.inf
    previous_point = None
    for _ in range(SPECIAL_POINT_SETTINGS.max_secant_steps):
        test_value = test_function_value(kind, segment, segment.cycle_at(length))
        if previous_point is not None and test_value != previous_point[1]:
            slope = (test_value - previous_point[1]) / (length - previous_point[0])
        last_step_length = abs(step)
        step = -test_value / slope
        if not abs(step) < segment.length:
            raise Unsolvable("the secant method leaves the interval between the two cycles")
        # A short step that hardly decreased is rounding error.
        if (
            abs(step) <= tolerance
            or SPECIAL_POINT_SETTINGS.min_stagnant_step_ratio * last_step_length
            < abs(step)
            <= SPECIAL_POINT_SETTINGS.max_stalled_step_per_branch_step * segment.length
        ):
            _, orbit, tangent = segment.last_arc_length_cycle_and_tangent
            change = step * tangent
            if kind == SpecialPointKind.fold:
                change[-1] /= 2  # the derivative of the parameter decreases linearly to 0 along the step
            moved = moved_orbit(orbit, segment.start.scale.parameter_name, change)
            return TestFunctionZero(length + step, moved, slope, step)
        previous_point = length, test_value
        length += step
    raise Unsolvable("the secant method for the special point does not converge")
