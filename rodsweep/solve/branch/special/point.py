"""Special points of a branch: kinds and stored numbers."""

from dataclasses import dataclass, field
from enum import IntEnum
from math import nan

from ...orbit.orbit import Orbit


@dataclass(frozen=True, slots=True, kw_only=True)
class LocatingSettings:
    """Settings for the location of a special point on a branch."""

    real_multiplier: float = 1e-7
    """Largest imaginary part of a real multiplier, relative to its modulus."""
    accuracy: float = 1e-9
    """Relative accuracy of the parameter at a special point; the accuracy of the branch if that is
    smaller."""
    first_mesh_share: float = 0.2
    """Accuracy for which the first of the two meshes is planned, in units of `accuracy`."""
    cycle_tolerance: float = 1e-12
    """Relative tolerance of a cycle on the way; corrections with one matrix leave an error of this size."""
    function_tolerance: float = 1e-10
    """Change of a test function by its last correction; folds are quadratic in it, and corrections gain two
    digits each."""
    max_secants: int = 12
    """Maximum number of secant steps."""
    stalled_secant: float = 1e-6
    """A secant step this small, in units of the step of the branch, that did not halve is rounding error."""
    linear_step: float = 1e-6
    """Longest last secant step, in units of the step of the branch: the cycle is moved along its tangent, and
    the slope, known to a thousandth, leaves an error of `secant_end`."""
    linear_step_at_fold: float = 1e-5
    """`linear_step` at a fold, where the parameter is quadratic in arc length."""
    secant_end: float = 1e-9
    """Error of the place that the last secant step leaves, in units of the step of the branch."""
    secant_end_at_fold: float = 1e-5
    """`secant_end` at a fold, whose slope may come from a coarser mesh and is known to a tenth."""
    matrix_distance: float = 1e-3
    """Largest relative distance of a matrix from the cycle whose test function is corrected with its factors:
    each correction then gains two digits or more."""
    enclosure_share: float = 1e-3
    """Tolerance of the bracketing: test function in units of its values at the ends, bracket in units of the
    step."""
    max_mesh_pairs: int = 4
    """Maximum number of pairs of meshes that are compared."""
    more_orders: int = 2
    """Smallest increase of the order on the next finer mesh."""
    max_more_orders: int = 8
    """Largest increase of the order on the next finer mesh."""
    fall: float = 0.8
    """Decay of the error in space per order, natural logarithm, as measured at a torus point."""
    more_intervals: float = 1.2
    """Smallest factor on the number of intervals on the next finer mesh."""
    max_interval_ratio: float = 2.0
    """Largest factor on the number of intervals on the next finer mesh."""
    power_by_stages: float = 1.5
    """Order in time of the special point, in units of the stages; known orders are larger."""
    error_factor: float = 3.0
    """Safety factor on the difference of two meshes."""
    rounding: float = 1e-13
    """Relative rounding error of the parameter, the period and the size."""
    near_one: float = 3e-3
    """A multiplier this close to 1 may be rounded to either side of 1. Beside a fold, two multipliers are
    close to 1."""
    max_halvings: int = 7
    """Maximum number of halvings of a step with several special points, or with a point that is not
    located."""


LOCATING = LocatingSettings()


class SpecialKind(IntEnum):
    """Kind of a special point of a branch."""

    hopf = 1
    fold = 2
    torus = 3
    symmetry_breaking = 4
    left_the_model = 5
    end = 6
    period_doubling = 7


class EndReason(IntEnum):
    """Reason for the end of a branch: the first two are true ends, the others are failures."""

    range_end = 1
    crushed = 2
    no_cycle_found = 3
    list_full = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class SpecialPoint:
    """A special point: value of the parameter, period in tau2 and largest tip y in L of its cycle."""

    kind: SpecialKind
    at: float
    period: float
    tip_y_max: float
    error: float
    """Absolute error of the parameter."""
    period_error: float = nan
    """Relative error of the period at the special point itself."""
    size_error: float = nan
    """Relative error of the largest tip y at the special point itself."""
    after: int = -1
    """Index of the last cycle of the branch before the special point, -1 for none."""
    reason: EndReason | None = None
    """Why the branch ends here; None unless the point is an end."""
    message: str = ""
    """Why no cycle was found, or why the error is large."""
    orbit: Orbit | None = field(default=None, repr=False, compare=False)
    """The cycle of a located point."""
    amplitude_coefficient: float = nan
    """Largest tip y in L over the square root of the relative distance of the parameter from a Hopf point, as
    in `HopfBirth`."""
    coefficient_error: float = nan
    """Relative error of amplitude_coefficient."""
