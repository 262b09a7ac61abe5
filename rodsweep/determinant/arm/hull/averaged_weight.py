"""Hulls of an arm whose coefficients jump, from weights alpha averaged over a window of u.

The identity of `rodsweep.determinant.arm.hull.hull` needs a continuous weight alpha. The best weight would be
t = g/(nu + l) with l = f |F| sqrt(c2 c3 gamma3/gamma2), which jumps with the material. With log alpha as the
mean of log t over [u - h, u + h], the slope of log alpha is (log t(u + h) - log t(u - h))/(2 h), and the
remaining factor of the term with theta is a sum,

    g - alpha nu = (g - t nu) + (t - alpha) nu.

The first term is bounded by the rotational drag. The second term differs from 0 only near the jumps and is
bounded by theta(0) = 0. A second trial bounds the sum of the two terms by the rotational drag.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....model.compiled.compilation import compiled, compiled_for_vectors
from ....model.compiled.kernel_constants import KernelConstants


@dataclass(frozen=True, slots=True, kw_only=True)
class AveragedWeightSettings(KernelConstants):
    """Settings for the averaged weights alpha that are tried."""

    load_term_factors: tuple[float, ...] = (0.0, 0.5, 1.0)
    """Values of f in l = f |F| sqrt(c2 c3 gamma3/gamma2), the term with the load in the trial weight t."""
    half_widths: tuple[float, ...] = (0.01, 0.02, 0.04, 0.08, 0.16, 0.32)
    """Values of the half-width h of the window, in L."""
    max_distance_across_jump: float = 1e-6
    """Two successive points closer than this distance, in L, lie on the two sides of a jump."""
    added_point_distance: float = 1e-12
    """Distance, in L, between the points added on both sides of u at which the slope of alpha jumps."""

    @property
    def trial_count(self) -> int:
        """Number of trial regions: two for each pair of f and h."""
        return 2 * len(self.load_term_factors) * len(self.half_widths)


AVERAGED_WEIGHT_SETTINGS = AveragedWeightSettings()


class GridPositions(NamedTuple):
    """Positions of n points in a grid: index of the grid interval, (n,), and fraction of its length, (n,)."""

    interval_index: NDArray[np.int64]
    fraction: Array


class TrialPoints(NamedTuple):
    """Points of an arm at which the weights of one half-width h are evaluated. u: from clamp to tip, (n,).
    sources: index of each point among the points of the arm, -1 for an added point, (n,). coefficients:
    `LocalCoefficients`, (6, n). loads: |F| sqrt(c2 c3 gamma3/gamma2), (n,). window_starts, window_ends:
    positions of u - h and of u + h in u."""

    u: Array
    sources: NDArray[np.int64]
    coefficients: Array
    loads: Array
    window_starts: GridPositions
    window_ends: GridPositions


class TrialWeight(NamedTuple):
    """Logarithm of the weight t at n points of an arm, and the integral of this logarithm from the first
    point to every point, (n,) each."""

    log_t: Array
    log_integral: Array


@compiled
def averaged_regions_of_arms(F: Array, u: Array, coefficients: Array) -> Array:
    """Constants (a, c) of the region of all eigenvalues for each arm and each trial weight of
    `averaged_regions`, (n, trials, 2); inf for an arm without c2 > 0 and g > 0 everywhere. F: forces, (n,).
    u: points of the arms, (points,). coefficients: `LocalCoefficients` at these points, (6, n, points)."""
    regions = np.full((len(F), AVERAGED_WEIGHT_SETTINGS.trial_count, 2), math.inf)
    for arm in range(len(F)):
        if (coefficients[1, arm] > 0).all() and (coefficients[5, arm] > 0).all():
            # The smallest region of several arms need not have the smallest region of any of them.
            regions[arm] = averaged_regions(
                u, np.ascontiguousarray(coefficients[:, arm]), F[arm], len(F) == 1
            )
    return regions


@compiled
def averaged_regions(u: Array, coefficients: Array, F: float, only_smallest: bool) -> Array:
    """Constants (a, c) of the region of each trial weight, (trials, 2); inf if a trial gives no bound. u:
    points of an arm from clamp to tip, (points,), two at a jump. coefficients: `LocalCoefficients` at the
    points, (6, points), with c2 > 0 and g > 0. F: force. only_smallest: whether a trial may end, with inf, as
    soon as its a exceeds the smallest a of a region with c = 0."""
    regions = np.full((AVERAGED_WEIGHT_SETTINGS.trial_count, 2), math.inf)
    _, c2, c3, gamma2, gamma3, _ = coefficients
    loads = abs(F) * np.sqrt(c2 * c3 * gamma3 / gamma2)
    factors = AVERAGED_WEIGHT_SETTINGS.load_term_factors
    # Logarithms take most of the time, and all half-widths share most points.
    log_t = np.empty((len(factors), len(u)))
    for m in range(len(factors)):
        log_t[m] = np.log(coefficients[5] / (coefficients[0] + factors[m] * loads))
    row = 0
    max_a2 = math.inf
    limiting_source = 0
    for h in AVERAGED_WEIGHT_SETTINGS.half_widths:
        points = _trial_points(u, coefficients, loads, F, h)
        for m in range(len(factors)):
            weight = _trial_weight(points, factors[m], log_t[m])
            limiting_source = _write_regions_of_trial(
                regions[row : row + 2], points, weight, (F, factors[m], h, max_a2), limiting_source
            )
            if only_smallest:
                max_a2 = min(max_a2, regions[row + 1, 0] ** 2)
            row += 2
    return regions


@compiled
def _trial_points(u: Array, coefficients: Array, loads: Array, F: float, h: float) -> TrialPoints:
    """The points for the half-width h of an arm under the force F with the points u, (points,), where the arm
    has the `LocalCoefficients` `coefficients`, (6, points), and the `loads` of `TrialPoints`, (points,)."""
    points, sources = _with_points_where_window_ends_jump(u, h)
    coefficients_at_points = np.empty((6, len(points)))
    loads_at_points = np.empty(len(points))
    i = 0  # the last point of the arm at or before the added point
    for n in range(len(points)):
        if sources[n] >= 0:
            i = sources[n]
            for k in range(6):
                coefficients_at_points[k, n] = coefficients[k, i]
            loads_at_points[n] = loads[i]
        else:
            fraction = (points[n] - u[i]) / (u[i + 1] - u[i])
            for k in range(6):
                change = coefficients[k, i + 1] - coefficients[k, i]
                coefficients_at_points[k, n] = coefficients[k, i] + fraction * change
            _, c2, c3, gamma2, gamma3, _ = coefficients_at_points[:, n]
            loads_at_points[n] = abs(F) * math.sqrt(c2 * c3 * gamma3 / gamma2)
    window_starts, window_ends = _grid_positions(points - h, points), _grid_positions(points + h, points)
    return TrialPoints(points, sources, coefficients_at_points, loads_at_points, window_starts, window_ends)


@compiled
def _with_points_where_window_ends_jump(u: Array, h: float) -> tuple[Array, NDArray[np.int64]]:
    """Returns (points, sources): the points u of an arm, (points,), and two more near each u at the distance
    h from a jump, sorted; index of each point in u, -1 for the others."""
    # Each jump adds at most four points: two window ends, with a point on either side of each.
    added = np.empty(4 * len(u))
    count = 0
    for i in range(len(u) - 1):
        if u[i + 1] - u[i] < AVERAGED_WEIGHT_SETTINGS.max_distance_across_jump:
            for window_end in (-h, h):
                for offset in (
                    -AVERAGED_WEIGHT_SETTINGS.added_point_distance,
                    AVERAGED_WEIGHT_SETTINGS.added_point_distance,
                ):
                    position = (u[i + 1] + u[i]) / 2 + window_end + offset
                    if u[0] < position < u[-1]:
                        added[count] = position
                        count += 1
    added = np.sort(added[:count])
    points = np.empty(len(u) + count)
    sources = np.empty(len(points), np.int64)
    used = 0
    for i in range(len(u)):
        while used < count and added[used] < u[i]:
            points[i + used] = added[used]
            sources[i + used] = -1
            used += 1
        points[i + used] = u[i]
        sources[i + used] = i
    return points, sources


@compiled
def _grid_positions(x: Array, grid: Array) -> GridPositions:
    """Positions of x, (n,), increasing, in the intervals of `grid`; x outside is moved to the nearer end."""
    interval = np.empty(len(x), np.int64)
    fraction = np.empty(len(x))
    i = 0
    for n in range(len(x)):
        # x increases, so the search continues where the last one ended.
        while i < len(grid) - 2 and grid[i + 1] < x[n]:
            i += 1
        width = grid[i + 1] - grid[i]
        interval[n] = i
        # The two points at a jump may coincide.
        fraction[n] = min(max((x[n] - grid[i]) / width, 0.0), 1.0) if width > 0 else 0.0
    return GridPositions(interval, fraction)


@compiled_for_vectors
def _interpolate_at_position(positions: GridPositions, n: int, values: Array) -> float:
    """Value at position number n in a grid, interpolated linearly from `values` at the grid points."""
    i = positions.interval_index[n]
    return values[i] + positions.fraction[n] * (values[i + 1] - values[i])


@compiled
def _trial_weight(points: TrialPoints, factor: float, log_t_of_arm: Array) -> TrialWeight:
    """Logarithms of the weight t at the points of one half-width. factor: f. log_t_of_arm: log t at the
    points of the arm."""
    u = points.u
    log_t = np.empty(len(u))
    integral = np.zeros(len(u))
    for i in range(len(u)):
        if points.sources[i] >= 0:
            log_t[i] = log_t_of_arm[points.sources[i]]
        else:
            log_t[i] = math.log(_weight_before_averaging(points, i, factor))
        if i > 0:
            integral[i] = integral[i - 1] + (u[i] - u[i - 1]) * (log_t[i] + log_t[i - 1]) / 2
    return TrialWeight(log_t, integral)


@compiled_for_vectors
def _weight_before_averaging(points: TrialPoints, i: int, factor: float) -> float:
    """The weight t = g/(nu + f l) at point number i. factor: f."""
    return points.coefficients[5, i] / (points.coefficients[0, i] + factor * points.loads[i])


@compiled
def _write_regions_of_trial(
    regions: Array,
    points: TrialPoints,
    weight: TrialWeight,
    trial: tuple[float, float, float, float],
    limiting_source: int,
) -> int:
    """Writes the two regions (a, c) of a trial weight into `regions`, (2, 2). In the first region (t - alpha)
    nu is bounded by theta(0) = 0, in the second by the rotational drag. Returns the index of the arm's point
    that limits a.

    trial: force F, factor f, half-width h, and the a^2 above which both regions are left unchanged.
    limiting_source: index of the arm's point that limited a in an earlier trial. It mostly limits a again,
    and is tested first.
    """
    u = points.u
    i = limiting_source
    while points.sources[i] != limiting_source:  # added points shift the points of the arm
        i += 1
    if min(*_squared_norms(points, weight, i, trial)[1:]) > trial[3]:
        return limiting_source
    a2_clamp = 0.0
    a2_drag = 0.0
    largest_norm = 0.0
    bending = 0.0
    c2_clamp = 0.0
    previous = 0.0
    source = 0
    for i in range(len(u)):
        alpha, clamp, drag = _squared_norms(points, weight, i, trial)
        a2_clamp = max(a2_clamp, clamp)
        a2_drag = max(a2_drag, drag)
        source = max(source, points.sources[i])
        if min(clamp, drag) > largest_norm:
            largest_norm = min(clamp, drag)
            limiting_source = source
        if min(a2_clamp, a2_drag) > trial[3]:
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


@compiled_for_vectors
def _squared_norms(
    points: TrialPoints, weight: TrialWeight, i: int, trial: tuple[float, float, float, float]
) -> tuple[float, float, float]:
    """Returns (alpha, clamp, drag) at point number i: the averaged weight, and a^2 of the two regions of
    `_write_regions_of_trial`, whose arguments these are."""
    nu, c2, c3, gamma2, gamma3, g = points.coefficients[:, i]
    F, factor, h, _ = trial
    alpha, slope = _alpha_and_log_slope(points, weight, i, h)
    A2 = slope**2 / (gamma2 * c2)
    B2 = F * F * alpha * c3 / gamma2
    drag = gamma3 * alpha * c2
    # Without a load t nu equals g; the rounded difference must not be divided by a drag near 0.
    t = _weight_before_averaging(points, i, factor)
    e = g - t * nu if factor * points.loads[i] > 0 else 0.0
    return alpha, squared_block_norm(A2, B2, e, drag), squared_block_norm(A2, B2, g - alpha * nu, drag)


@compiled_for_vectors
def _alpha_and_log_slope(points: TrialPoints, weight: TrialWeight, i: int, h: float) -> tuple[float, float]:
    """Returns (alpha, derivative of log alpha) at point number i. h: half-width of the window."""
    u = points.u
    start = _interpolate_at_position(points.window_starts, i, weight.log_t)
    end = _interpolate_at_position(points.window_ends, i, weight.log_t)
    # Beyond its ends the arm continues with its end values, so that every window has the same width.
    integral_to_end = _interpolate_at_position(points.window_ends, i, weight.log_integral)
    integral_to_end += max(u[i] + h - u[-1], 0.0) * weight.log_t[-1]
    integral_to_start = _interpolate_at_position(points.window_starts, i, weight.log_integral)
    integral_to_start -= max(u[0] - (u[i] - h), 0.0) * weight.log_t[0]
    return math.exp((integral_to_end - integral_to_start) / (2 * h)), (end - start) / (2 * h)


@compiled
def squared_block_norm(A2: float, B2: float, e: float, drag: float) -> float:
    """Squared norm of the matrix [[A, B], [e/sqrt(drag), 0]]; A2 = A^2, B2 = B^2; inf if drag = 0 != e."""
    if e == 0:
        return A2 + B2
    if drag == 0:
        return math.inf
    C2 = e * e / drag
    total = A2 + B2 + C2
    return (total + math.sqrt(max(total * total - 4 * B2 * C2, 0.0))) / 2
