"""Special points of a branch: kinds, stored quantities, and settings for their location."""

from dataclasses import dataclass, field
from enum import IntEnum
from math import nan

from ...orbit.orbit import Orbit


@dataclass(frozen=True, slots=True, kw_only=True)
class SpecialPointSettings:
    """Settings for locating a special point on a branch: tolerances, meshes, and numbers of steps."""

    real_multiplier: float = 1e-7
    """Largest imaginary part of a multiplier that counts as real, relative to its modulus."""
    accuracy: float = 1e-9
    """Relative accuracy of the parameter at a special point; the accuracy of the branch applies if
    smaller."""
    first_mesh_share: float = 0.2
    """Accuracy for which the first of the two meshes is planned, in units of `accuracy`."""
    cycle_tolerance: float = 1e-12
    """Relative tolerance of the cycles solved during the search; corrections with one matrix reach about this
    error."""
    function_tolerance: float = 1e-10
    """Largest change of a test function in its last correction. A correction gains two digits, and the
    parameter at a fold has an error of second order in the test function."""
    max_secants: int = 12
    """Maximum number of secant steps."""
    max_stalled_step: float = 1e-6
    """Length of a secant step, in units of the step of the branch, below which a step that did not halve is
    rounding error; the secant method stops there."""
    max_linear_step: float = 1e-6
    """Longest last secant step, in units of the step of the branch. The cycle is then only moved along its
    tangent; the slope, with a relative error of 1e-3, leaves an error of `secant_error`."""
    max_linear_step_at_fold: float = 1e-5
    """Longest last secant step at a fold, where the parameter is quadratic in arc length; in units of the
    step of the branch."""
    secant_error: float = 1e-9
    """Arc length error of a located special point, from its last secant step, in units of the step of the
    branch."""
    secant_error_at_fold: float = 1e-5
    """Arc length error of a located fold, in units of the step of the branch: the slope may come from a
    coarser mesh, with a relative error of 0.1."""
    matrix_distance: float = 1e-3
    """Largest relative distance between a cycle and the orbit whose matrix factors correct the test function:
    each correction then gains at least two digits."""
    bracket_tolerance: float = 1e-3
    """Relative tolerance of the bracketing: of the test function in units of its values at the ends, and of
    the arc length in units of the step."""
    max_mesh_pairs: int = 4
    """Maximum number of comparisons of two meshes."""
    min_more_orders: int = 2
    """Smallest increase of the order of the elements on the next finer mesh."""
    max_more_orders: int = 8
    """Largest increase of the order of the elements on the next finer mesh."""
    space_decay: float = 0.8
    """Decrease of the natural logarithm of the error in space per order of the elements, measured at a torus
    point."""
    min_interval_ratio: float = 1.2
    """Smallest ratio of the numbers of time intervals on the next finer mesh and on the present mesh."""
    max_interval_ratio: float = 2.0
    """Largest ratio of the numbers of time intervals on the next finer mesh and on the present mesh."""
    time_order_by_stages: float = 1.5
    """Assumed order in time of the error of a special point, in units of the number of stages; measured
    orders are larger."""
    error_factor: float = 3.0
    """Safety factor on the difference between two meshes, which gives the error estimate."""
    rounding_error: float = 1e-13
    """Relative rounding error of the parameter, the period and the largest tip y of a special point."""
    unit_multiplier_distance: float = 3e-3
    """Distance of a multiplier from 1 below which errors may move it across the unit circle. Near a fold, two
    multipliers are close to 1."""
    max_halvings: int = 7
    """Maximum number of halvings of a step with several special points, or with a point that is not
    located."""


SPECIAL_POINT = SpecialPointSettings()


class SpecialKind(IntEnum):
    """Kind of a special point of a branch; the result file stores the value."""

    hopf = 1
    fold = 2
    torus = 3
    symmetry_breaking = 4
    left_the_model = 5
    end = 6
    period_doubling = 7


class EndReason(IntEnum):
    """Reason for the end of a branch. range_end and crushed are true ends; no_cycle_found and list_full are
    failures."""

    range_end = 1
    crushed = 2
    no_cycle_found = 3
    list_full = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class SpecialPoint:
    """A special point of a branch. at: value of the continuation parameter. period: in tau2. tip_y_max:
    largest tip y of the cycle, in L."""

    kind: SpecialKind
    at: float
    period: float
    tip_y_max: float
    error: float
    """Absolute error of the parameter value `at`."""
    period_error: float = nan
    """Relative error of the period, relative to the exact special point."""
    size_error: float = nan
    """Relative error of the largest tip y, relative to the exact special point."""
    after: int = -1
    """Index of the last cycle of the branch before the special point, -1 for none."""
    reason: EndReason | None = None
    """Reason for the end of the branch at this point; None unless the branch ends here."""
    message: str = ""
    """Reason for a failure: why no cycle was found, or why the point was not located."""
    orbit: Orbit | None = field(default=None, repr=False, compare=False)
    """The cycle at a located special point; None if the point was not located."""
    amplitude_coefficient: float = nan
    """At a Hopf point, ratio of the largest tip y, in L, to the square root of the relative distance of the
    parameter, as in `HopfBirth`; NaN at other points."""
    coefficient_error: float = nan
    """Relative error of `amplitude_coefficient`."""
