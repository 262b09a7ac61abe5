"""Special points of a branch: kinds, stored quantities, and settings for their location."""

from dataclasses import dataclass, field
from enum import IntEnum
from math import nan

from ...orbit.orbit import Orbit
from ..status import BranchEndReason


@dataclass(frozen=True, slots=True, kw_only=True)
class SpecialPointSettings:
    """Settings for locating a special point on a branch: tolerances, meshes, and numbers of steps."""

    real_multiplier_tolerance: float = 1e-7
    """A multiplier m is treated as real if |Im m| is at most this number times |m|."""
    accuracy: float = 1e-9
    """Relative accuracy of the parameter at a special point; the accuracy of the branch if that is a smaller
    number."""
    first_mesh_accuracy_ratio: float = 0.2
    """Ratio of the accuracy for which the first mesh is chosen to the required accuracy."""
    relative_cycle_tolerance: float = 1e-12
    """Relative tolerance of the cycles solved during the search, about the smallest error that corrections
    with one matrix reach."""
    test_function_correction_tolerance: float = 1e-10
    """The correction of a test function stops when its value changes by at most this number. A correction
    gains two digits, and at a fold the error of the parameter is of second order in the test function.
    Rounding errors of the test function, which differ between meshes, are of this size: up to 2e-10."""
    tip_y_of_doubled_fold_error: float = 0.02
    """Largest tip y, in L, at which the error of the test function of a fold is twice
    `test_function_correction_tolerance`; at smaller amplitudes the error grows in inverse proportion to the
    amplitude, because the whole state has the relative tolerance of the cycles. Without this growth folds at
    a relative distance of 2e-6 from a generalised Hopf point had errors of 8 times their estimates."""
    test_function_rounding_error: float = 1e-11
    """Error of the multiplier at a symmetry breaking or period doubling, and of the stretch h1 where the
    model ends (h1 = 0): ten times the relative tolerance of the cycles."""
    max_secant_steps: int = 12
    """Maximum number of secant steps."""
    min_stagnant_step_ratio: float = 0.5
    """If a small secant step, or a small change of a test function, is more than this number times the
    previous step or change, it is rounding error."""
    max_stalled_step_per_branch_step: float = 1e-6
    """The secant method stops if its step, divided by the step of the branch, is at most this number and more
    than `min_stagnant_step_ratio` times the previous step."""
    max_last_secant_step_per_branch_step: float = 1e-6
    """Longest last secant step, divided by the step of the branch. After the last step the cycle is moved
    along its tangent, not solved again."""
    max_last_secant_step_per_branch_step_at_fold: float = 1e-5
    """Longest last secant step at a fold, divided by the step of the branch; longer than elsewhere, because
    the parameter is quadratic in arc length."""
    relative_slope_error: float = 0.01
    """Relative error of the slope of the test function, and thus of the last secant step. The slope may come
    from the prediction or from a coarser mesh; at 91 special points of random rods it had errors of up to
    0.0025."""
    max_distance_from_matrix_orbit: float = 1e-3
    """Largest relative distance between a cycle and the orbit whose matrix factors correct the test function
    of the cycle; at this distance each correction gains at least two digits."""
    bracket_tolerance: float = 1e-3
    """Tolerances of the bracketing: for the test function, as a fraction of the smaller of its moduli at the
    two ends of the step; for the arc length, as a fraction of the step."""
    max_mesh_comparisons: int = 4
    """Maximum number of comparisons of a special point on two successive meshes."""
    min_element_order_increase: int = 2
    """Smallest increase of the order of the elements on the next finer mesh."""
    max_element_order_increase: int = 8
    """Largest increase of the order of the elements on the next finer mesh."""
    log_space_error_decay_per_order: float = 0.8
    """Assumed decrease of the natural logarithm of the error in space when the order of the elements grows by
    1, measured at a torus point."""
    min_time_interval_count_ratio: float = 1.2
    """Smallest ratio of the number of time intervals of the next finer mesh to the number of the current
    mesh."""
    max_time_interval_count_ratio: float = 2.0
    """Largest ratio of the number of time intervals of the next finer mesh to that of the current mesh."""
    time_order_per_stage: float = 1.5
    """Order in time assumed for the error of a special point, divided by the number of stages; the orders
    measured are larger than assumed."""
    time_order_per_stage_of_remaining_error: float = 2.0
    """Order in time assumed for the error that is left on the finer of two meshes, divided by the number of
    stages. With this number, and with the measured decay in space of at least
    `log_space_error_decay_per_order`, the errors of 90 special points of random rods were at most 1.1 times
    the assumed errors, and 0.4 times in the median."""
    min_mesh_difference_per_accuracy: float = 0.02
    """Smallest difference between special points on two meshes from which errors are estimated, divided by
    the accuracy: a tenth of `first_mesh_accuracy_ratio`. Where errors change their sign, a smaller difference
    is a coincidence."""
    error_safety_factor: float = 3.0
    """Safety factor of the error estimate, on the difference between the special points on two meshes and on
    the error that is assumed to be left on the finer mesh."""
    relative_rounding_error: float = 1e-13
    """Relative rounding error of the parameter, the period and the largest tip y of a special point."""
    max_undecided_multiplier_minus_one: float = 3e-3
    """A multiplier m with |m - 1| below this number may lie on either side of the unit circle, because of
    errors. Near a fold two multipliers are close to 1."""
    max_prediction_error_without_fold: float = 1e-4
    """Near a cycle with a nontrivial multiplier of 1 within its error, it is uncertain whether two successive
    cycles lie on one branch, if between them the parameter turns back or the number of real multipliers above
    1 changes by an odd number. The two cycles are then taken as cycles of one branch only if the prediction
    error of the second cycle is at most this number: a fifth of the usual target of this error, so that one
    halving of the step suffices. Between small cycles of two Hopf points close together, errors of 8e-3 were
    seen."""
    max_parameter_change_if_located_twice: float = 1e-6
    """Two special points of a rod are the same point only if the relative difference of their parameters,
    minus the sum of their errors, is at most this number; a point on a curve over two parameters has an error
    of 1e-7."""
    max_period_change_if_located_twice: float = 1e-4
    """Largest relative difference between the periods of the same special point located twice."""
    max_step_halvings: int = 7
    """Maximum number of halvings of a step that has several special points, or a special point that cannot be
    located."""


SPECIAL_POINT_SETTINGS = SpecialPointSettings()


class SpecialPointKind(IntEnum):
    """Kind of a special point of a branch; the result file stores the value. left_the_model: the stretch h1
    is 0 at a position on the rod, where the cross-section is crushed. end: end of the branch."""

    hopf = 1
    fold = 2
    torus = 3
    symmetry_breaking = 4
    left_the_model = 5
    end = 6
    period_doubling = 7


@dataclass(frozen=True, slots=True, kw_only=True)
class SpecialPoint:
    """A special point of a branch. parameter_value: value of the continuation parameter. period: period of
    the cycle, in tau2. tip_y_max: largest tip y of the cycle, in L."""

    kind: SpecialPointKind
    """Kind of the special point, such as a fold or a Hopf point."""
    parameter_value: float
    period: float
    tip_y_max: float
    error: float
    """Absolute error of the parameter value `parameter_value`."""
    period_error: float = nan
    """Relative difference of the period from the period at the exact special point."""
    tip_y_max_error: float = nan
    """Relative difference of the largest tip y from its value at the exact special point."""
    index_of_cycle_before: int = -1
    """Index of the last cycle of the branch before the special point; -1 if no cycle precedes the point."""
    end_reason: BranchEndReason | None = None
    """Reason for the end of the branch at this point; None if the branch does not end here."""
    message: str = ""
    """Reason for a failure: why no cycle was found, or why the point was not located."""
    orbit: Orbit | None = field(default=None, repr=False, compare=False)
    """The cycle at a located special point; None if the point was not located."""
    amplitude_coefficient: float = nan
    """At a Hopf point the coefficient a of the branch, in L: the tip reaches y = |a| sqrt(|p/p_H - 1|) at
    parameter values p near the Hopf point p_H; a < 0 if the cycles exist at p < p_H; NaN at other points."""
    relative_amplitude_coefficient_error: float = nan
    """Relative error of `amplitude_coefficient`."""

    @property
    def is_unlocated(self) -> bool:
        """Whether the point was not located; its values are then those of a cycle beside it."""
        return bool(self.message) and self.kind not in (SpecialPointKind.hopf, SpecialPointKind.end)

    def is_same_as(self, other: "SpecialPoint") -> bool:
        """Whether this point and `other` are the same special point of a rod, or mirror images, located
        twice: kind, parameter and period agree."""
        return _agree_within_error(self, other, self.error + other.error)


@dataclass(frozen=True, slots=True, kw_only=True)
class RowSpecialPoint:
    """A special point as the result file stores it. row_index: index of the row. row_parameter_value: value
    of the row parameter. kind: kind of the point. parameter_value: value of the parameter along the row.
    period: in tau2. tip_y_max: in L."""

    row_index: int
    row_parameter_value: float
    kind: SpecialPointKind
    parameter_value: float
    period: float
    tip_y_max: float

    def is_same_as(self, other: "RowSpecialPoint | SpecialPoint") -> bool:
        """Whether this point and `other`, of the same row, are the same special point located twice."""
        return _agree_within_error(self, other, 0.0)


def _agree_within_error(
    first: SpecialPoint | RowSpecialPoint, second: SpecialPoint | RowSpecialPoint, error: float
) -> bool:
    """Whether two special points have equal kinds, parameters that differ by at most `error` plus a relative
    tolerance, and periods that agree within a relative tolerance. error: sum of the absolute errors of both
    parameters."""
    # The largest y differs between mirror images, so it is not compared.
    excess_distance = abs(first.parameter_value - second.parameter_value) - error
    return (
        first.kind == second.kind
        and excess_distance
        <= SPECIAL_POINT_SETTINGS.max_parameter_change_if_located_twice * abs(first.parameter_value)
        and abs(first.period / second.period - 1) <= SPECIAL_POINT_SETTINGS.max_period_change_if_located_twice
    )
