"""Hulls of an arm whose coefficients jump, from weights alpha averaged over a window of u.

The identity of `rodsweep.determinant.arm.hull.hull`, whose notation is used here, needs a continuous weight
alpha(u), u: position on the arm. The best weight would be t = g/(nu + l) with l = f |F| sqrt(c2 c3
gamma3/gamma2) and a factor f, of which several are tried; but t jumps with the material. With log alpha as
the mean of log t over a window [u - h, u + h], the slope of log alpha is (log t(u + h) - log t(u - h))/(2 h),
and the remaining factor of the term with theta is a sum,

    g - alpha nu = (g - t nu) + (t - alpha) nu.

The first term is bounded by the rotational drag. The second term differs from 0 only near the jumps and is
bounded by theta(0) = 0. A second trial bounds the sum of the two terms by the rotational drag.
"""

import math
from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled, compiled_with_reordered_sums
from .trial_points import (
    AVERAGED_WEIGHT_SETTINGS,
    TrialPoints,
    interpolate_at_position,
    trial_points_for_half_width,
)


class TrialWeight(NamedTuple):
    """Logarithm of the weight t at n points of an arm, and the integral of this logarithm from the first
    point to every point, (n,) each."""

    log_weight: Array
    """Logarithm of the weight t at each point, (n,)."""
    integral_of_log_weight: Array
    """Integral of log t over u from the first point to each point, (n,)."""


@compiled
def regions_from_averaged_weights_of_arms(F: Array, u: Array, coefficients: Array) -> Array:
    """`regions_from_averaged_weights` of n arms: constants (a, c) of a region that contains all eigenvalues,
    Re w <= a n - (1 - c) n^2, |Im w| <= a n + c n^2 for some n >= 0, for each arm and each trial weight, (n,
    trials, 2); inf for an arm without c2 > 0 and g > 0 everywhere. F: forces, (n,). u: points of the arms,
    (points,). coefficients: `LocalCoefficients` at these points, (6, n, points)."""
    regions = np.full((len(F), AVERAGED_WEIGHT_SETTINGS.trial_region_count, 2), math.inf)
    for arm in range(len(F)):
        if (coefficients[1, arm] > 0).all() and (coefficients[5, arm] > 0).all():
            # The best trial for several arms together need not be the best trial for any of them.
            regions[arm] = regions_from_averaged_weights(
                u, np.ascontiguousarray(coefficients[:, arm]), F[arm], len(F) == 1
            )
    return regions


@compiled
def regions_from_averaged_weights(u: Array, coefficients: Array, F: float, only_smallest: bool) -> Array:
    """Constants (a, c) of a region that contains all eigenvalues, Re w <= a n - (1 - c) n^2, |Im w| <= a n +
    c n^2 for some n >= 0, for each trial weight, (trials, 2); inf if a trial gives no bound. u: points of an
    arm from clamp to tip, (points,), two at a jump. coefficients: `LocalCoefficients` at the points, (6,
    points), with c2 > 0 and g > 0. F: force. only_smallest: whether a trial may stop, with the result inf,
    once its a is not below the smallest a of an earlier trial with c = 0."""
    regions = np.full((AVERAGED_WEIGHT_SETTINGS.trial_region_count, 2), math.inf)
    _, c2, c3, gamma2, gamma3, _ = coefficients
    loads = abs(F) * np.sqrt(c2 * c3 * gamma3 / gamma2)
    factors = AVERAGED_WEIGHT_SETTINGS.load_term_factors
    # Logarithms take most of the time, and all half-widths share most points.
    log_weight = np.empty((len(factors), len(u)))
    for m in range(len(factors)):
        log_weight[m] = np.log(coefficients[5] / (coefficients[0] + factors[m] * loads))
    row = 0
    max_a2 = math.inf
    limiting_source = 0
    for h in AVERAGED_WEIGHT_SETTINGS.window_half_widths:
        points = trial_points_for_half_width(u, coefficients, loads, F, h)
        for m in range(len(factors)):
            weight = _trial_weight(points, factors[m], log_weight[m])
            trial = (F, factors[m], h, max_a2)
            # The point that limited a in an earlier trial mostly limits a again.
            if not _reaches_a_squared_limit_at(limiting_source, points, weight, trial):
                limiting_source = _write_regions_of_trial(regions[row : row + 2], points, weight, trial)
            if only_smallest:
                max_a2 = min(max_a2, regions[row + 1, 0] ** 2)
            row += 2
    return regions


@compiled
def _trial_weight(points: TrialPoints, factor: float, log_t_of_arm: Array) -> TrialWeight:
    """The weight t at `points`: the points of the arm, and the points added for one half-width h of the
    window. factor: the factor f in t = g/(nu + f |F| sqrt(c2 c3 gamma3/gamma2)). log_t_of_arm: log t at the
    points of the arm, which is known already."""
    u = points.u
    log_weight = np.empty(len(u))
    integral = np.zeros(len(u))
    for i in range(len(u)):
        if points.arm_point_indices[i] >= 0:
            log_weight[i] = log_t_of_arm[points.arm_point_indices[i]]
        else:
            log_weight[i] = math.log(_weight_before_averaging(points, i, factor))
        if i > 0:
            integral[i] = integral[i - 1] + (u[i] - u[i - 1]) * (log_weight[i] + log_weight[i - 1]) / 2
    return TrialWeight(log_weight, integral)


@compiled_with_reordered_sums
def _weight_before_averaging(points: TrialPoints, i: int, factor: float) -> float:
    """The weight t = g/(nu + l) of the module docstring at point number i, l = f `points.load_terms`. factor:
    f."""
    return points.coefficients[5, i] / (points.coefficients[0, i] + factor * points.load_terms[i])


@compiled
def _reaches_a_squared_limit_at(
    source: int, points: TrialPoints, weight: TrialWeight, trial: tuple[float, float, float, float]
) -> bool:
    """Whether the constants a of both regions of `_write_regions_of_trial` reach their limit already at the
    point number `source` of the arm. Other arguments: as in `_write_regions_of_trial`."""
    i = source
    while points.arm_point_indices[i] != source:  # added points shift the points of the arm
        i += 1
    _, clamp, drag = _weight_and_squared_norms(points, weight, i, trial)
    return min(clamp, drag) >= trial[3]


@compiled
def _write_regions_of_trial(
    regions: Array,
    points: TrialPoints,
    weight: TrialWeight,
    trial: tuple[float, float, float, float],
) -> int:
    """Writes two regions that contain all eigenvalues, each by its constants (a, c) of `hull.hull`, from a
    trial weight t and its average alpha into `regions`, (2, 2). In the first region (t - alpha) nu is bounded
    by theta(0) = 0, in the second by the rotational drag. Returns the index of the point of the arm that
    determines a.

    trial: (force F, factor f, half-width h of the window, limit of a^2). If a^2 of both regions reaches the
    limit, `regions` is left unchanged.
    """
    u = points.u
    a2_clamp = 0.0
    a2_drag = 0.0
    largest_norm = 0.0
    bending = 0.0
    c2_clamp = 0.0
    previous = 0.0
    source = 0
    limiting_source = 0
    for i in range(len(u)):
        alpha, clamp, drag = _weight_and_squared_norms(points, weight, i, trial)
        a2_clamp = max(a2_clamp, clamp)
        a2_drag = max(a2_drag, drag)
        source = max(source, points.arm_point_indices[i])
        if min(clamp, drag) > largest_norm:
            largest_norm = min(clamp, drag)
            limiting_source = source
        if min(a2_clamp, a2_drag) >= trial[3]:
            return limiting_source
        nu, c2, c3 = points.coefficients[:3, i]
        if i > 0:
            # As theta(0) = 0, |theta(u)|^2 is at most int_0^u c3 du times int c3 |m|^2 du.
            bending += (u[i] - u[i - 1]) * (c3 + points.coefficients[2, i - 1]) / 2
        t = _weight_before_averaging(points, i, trial[1])
        density = ((t - alpha) * nu) ** 2 / (alpha * c2) * bending
        if i > 0:
            c2_clamp += (u[i] - u[i - 1]) * (density + previous) / 2
        previous = density
    regions[0] = math.sqrt(a2_clamp), math.sqrt(c2_clamp) / 2
    regions[1] = math.sqrt(a2_drag), 0.0
    return limiting_source


@compiled_with_reordered_sums
def _weight_and_squared_norms(
    points: TrialPoints, weight: TrialWeight, i: int, trial: tuple[float, float, float, float]
) -> tuple[float, float, float]:
    """Returns (alpha, clamp, drag) at point number i: alpha is the averaged weight; clamp and drag are the
    values of a^2 that this point needs for the two regions of `_write_regions_of_trial`, in which theta is
    bounded by theta(0) = 0 or by the rotational drag. Other arguments: as in `_write_regions_of_trial`."""
    nu, c2, c3, gamma2, gamma3, g = points.coefficients[:, i]
    F, factor, h, _ = trial
    alpha, slope = _averaged_weight_and_log_slope(points, weight, i, h)
    A2 = slope**2 / (gamma2 * c2)
    B2 = F * F * alpha * c3 / gamma2
    drag = gamma3 * alpha * c2
    # Without a load t nu equals g; the rounded difference must not be divided by a drag near 0.
    t = _weight_before_averaging(points, i, factor)
    e = g - t * nu if factor * points.load_terms[i] > 0 else 0.0
    return alpha, squared_block_norm(A2, B2, e, drag), squared_block_norm(A2, B2, g - alpha * nu, drag)


@compiled_with_reordered_sums
def _averaged_weight_and_log_slope(
    points: TrialPoints, weight: TrialWeight, i: int, h: float
) -> tuple[float, float]:
    """Returns (averaged weight alpha, d(log alpha)/du) at point number i. h: half-width of the window."""
    u = points.u
    start = interpolate_at_position(points.window_starts, i, weight.log_weight)
    end = interpolate_at_position(points.window_ends, i, weight.log_weight)
    # Beyond its ends the arm continues with its end values, so that every window has the same width.
    integral_to_end = interpolate_at_position(points.window_ends, i, weight.integral_of_log_weight)
    integral_to_end += max(u[i] + h - u[-1], 0.0) * weight.log_weight[-1]
    integral_to_start = interpolate_at_position(points.window_starts, i, weight.integral_of_log_weight)
    integral_to_start -= max(u[0] - (u[i] - h), 0.0) * weight.log_weight[0]
    return math.exp((integral_to_end - integral_to_start) / (2 * h)), (end - start) / (2 * h)


@compiled
def squared_block_norm(A2: float, B2: float, e: float, drag: float) -> float:
    """Squared 2-norm of [[A, B], [e/sqrt(drag), 0]]; inf if drag = 0 and e is not 0. A2 = A^2, B2 = B^2."""
    if e == 0:
        return A2 + B2
    if drag == 0:
        return math.inf
    C2 = e * e / drag
    total = A2 + B2 + C2
    return (total + math.sqrt(max(total * total - 4 * B2 * C2, 0.0))) / 2
