"""The maximum of the norm |exp(L t)| over a time interval, and an upper bound of the norm in the interval.

L is the operator of the rod. Let a >= 0 be an upper bound of the numerical abscissa, N(t) = |exp(L t)|, and
c(t0) a bound of curvature: f'' >= -c(t0) at t0 for f = |exp(L t) v|^2 with any |v| = 1. For t = t0 + r in an
interval [t0, t1] of width h,

    N(t) <= N(t0) exp(a r),
    N(t)^2 <= max(N(t0)^2, N(t1)^2) + (h^2/8) c(t0) exp(2 a h).

The second bound holds because N^2 is the largest f over all v, and f'' >= -c(t0) exp(2 a r) at t: exp(L t) v
= exp(L t0) v' with |v'| <= exp(a r). Intervals are halved until the bound is within the tolerance of the
largest value found.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from .propagator import Propagator


@dataclass(frozen=True, slots=True, kw_only=True)
class NormMaximumSettings:
    """Settings for the search for the maximum over time of |exp(L t)|, L: operator of the rod."""

    first_grid_ratio: float = 2**0.25
    """Largest ratio of neighbouring times of the first grid."""
    max_halvings: int = 40
    """Maximum number of halvings of a time interval; after that the bound is not improved further."""
    max_open_intervals: int = 4000
    """Maximum number of intervals in which a larger norm is possible; with more intervals, the bound is not
    improved further."""
    times_per_batch: int = 128
    """Largest number of times at which the propagator is evaluated in one call; limits the memory."""
    max_exponent: float = 300.0
    """Larger arguments of exp are replaced by this value, at which exp does not overflow."""
    max_regula_falsi_steps: int = 40
    """Maximum number of regula falsi steps to a maximum of the norm."""
    max_relative_rise_in_bracket: float = 1e-14
    """Tolerance of the search for a maximum: largest possible relative increase of the norm within the final
    bracket. The relative error of the time is about the square root of this tolerance."""


NORM_MAXIMUM_SETTINGS = NormMaximumSettings()


class NormMaximum(NamedTuple):
    """Maximum of the norm |exp(L t)| in a range of times, its time in tau2, and an upper bound of the
    norm."""

    norm: float
    time: float
    upper_bound: float
    """Upper bound of the norm at all times in the range."""


def maximum_propagator_norm(
    propagator: Propagator,
    time_range: tuple[float, float],
    abscissa: float,
    min_norm: float,
    tolerance: float,
) -> NormMaximum:
    """The maximum of |exp(L t)| for times from time_range[0] to time_range[1], in tau2. tolerance: relative
    tolerance of the bound. min_norm: maxima below this norm are not searched for. abscissa: upper bound, at
    least 0, of the numerical abscissa."""
    settings = NORM_MAXIMUM_SETTINGS
    low, high = time_range
    time_count = max(2, int(np.ceil(np.log(high / low) / np.log(settings.first_grid_ratio))) + 1)
    times: Array = np.geomspace(low, high, time_count, dtype=np.float64)
    # The ends are set exactly, since `geomspace` rounds them.
    times[[0, -1]] = time_range
    squared_norms, curvatures = _squared_norms_and_curvature_bounds(propagator, times)
    i = int(squared_norms.argmax())
    maximum = _local_maximum_and_time(propagator, times[max(i - 1, 0)], times[min(i + 1, time_count - 1)])
    t = times[:-1]
    h = np.diff(times)
    left = squared_norms[:-1]
    right = squared_norms[1:]
    curvature = curvatures[:-1]
    upper_bound = maximum[0]
    for halving in range(settings.max_halvings + 1):
        bound = np.sqrt(_squared_norm_bound(h, left, right, curvature, abscissa))
        sufficient_bound = max(maximum[0], min_norm) * (1 + tolerance)
        is_open = bound > sufficient_bound
        # Intervals that are given up still bound the norm from above, if loosely.
        is_abandoned = halving == settings.max_halvings or int(is_open.sum()) > settings.max_open_intervals
        upper_bound = max(upper_bound, bound[~is_open | is_abandoned].max(initial=0.0))
        if is_abandoned or not is_open.any():
            break
        # Only intervals in which a larger norm is possible are halved.
        t, h, left, right, curvature = (x[is_open] for x in (t, h / 2, left, right, curvature))
        middle, middle_curvatures = _squared_norms_and_curvature_bounds(propagator, t + h)
        i = int(middle.argmax())
        if middle[i] > maximum[0] ** 2:
            maximum = max(maximum, _local_maximum_and_time(propagator, t[i], t[i] + 2 * h[i]))
        t = np.concatenate([t, t + h])
        h = np.concatenate([h, h])
        left = np.concatenate([left, middle])
        right = np.concatenate([middle, right])
        curvature = np.concatenate([curvature, middle_curvatures])
    return NormMaximum(*maximum, max(upper_bound, maximum[0]))


def _squared_norms_and_curvature_bounds(propagator: Propagator, times: Array) -> tuple[Array, Array]:
    """Returns (|exp(L t)|^2, c) at `times`, in tau2, (times,) each, computed in batches. c: bound of the
    curvature, f'' >= -c for f = |exp(L t) v|^2 with any |v| = 1."""
    parts = [
        propagator.squared_norms_and_curvature_bounds(part)
        for part in np.array_split(times, len(times) // NORM_MAXIMUM_SETTINGS.times_per_batch + 1)
    ]
    return np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])


def _squared_norm_bound(h: Array, left: Array, right: Array, curvature: Array, abscissa: float) -> Array:
    """Upper bound of N^2, N = |exp(L t)|, in intervals of time, (intervals,). h: widths of the intervals.
    left, right: N^2 at both ends. curvature: bound c of the module docstring at the left ends; all
    (intervals,). abscissa: upper bound, at least 0, of the numerical abscissa."""
    growth = np.exp(np.minimum(2 * abscissa * h, NORM_MAXIMUM_SETTINGS.max_exponent))
    # Two bounds: growth at the rate of the abscissa, and the chord plus the largest curvature below it.
    return np.minimum(left * growth, np.maximum(left, right) + h**2 / 8 * curvature * growth)


def _local_maximum_and_time(propagator: Propagator, low: float, high: float) -> tuple[float, float]:
    """Returns (|exp(L t)|, t) at a maximum between the times `low` and `high`: the zero of the derivative, by
    the Illinois regula falsi; the end with the larger norm if the derivatives show no maximum between the two
    times."""
    low_norm, rate_low = propagator.norm_and_log_slope(low)
    high_norm, rate_high = propagator.norm_and_log_slope(high)
    if rate_low <= 0 or rate_high >= 0:
        return max((low_norm, low), (high_norm, high))
    maximum = (0.0, low)
    for _ in range(NORM_MAXIMUM_SETTINGS.max_regula_falsi_steps):
        t = (low * rate_high - high * rate_low) / (rate_high - rate_low)
        norm, rate = propagator.norm_and_log_slope(t)
        maximum = max(maximum, (norm, t))
        if abs(rate) * (high - low) <= NORM_MAXIMUM_SETTINGS.max_relative_rise_in_bracket:
            break
        if rate > 0:
            low = t
            rate_low = rate
            # Illinois: the weight of an end that stays is halved; otherwise the bracket would shrink from one
            # side only.
            rate_high = rate_high / 2
        else:
            high = t
            rate_high = rate
            rate_low = rate_low / 2
    return maximum
