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
from ....model.compiled.compilation import compiled
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


@compiled
def averaged_regions(u: Array, coefficients: Array, F: float, only_smallest: bool) -> Array:
    """Constants (a, c) of the region of each trial weight, (trials, 2); inf if a trial gives no bound. u:
    points of an arm from clamp to tip, (points,), two at a jump. coefficients: `LocalCoefficients` at the
    points, (6, points), with c2 > 0 and g > 0. F: force. only_smallest: whether a trial may end, with inf, as
    soon as its a exceeds the smallest a of a region with c = 0."""
    regions = np.full((AVERAGED_WEIGHT_SETTINGS.trial_count, 2), math.inf)
    row = 0
    max_a2 = math.inf
    for h in AVERAGED_WEIGHT_SETTINGS.half_widths:
        points = _with_points_where_window_ends_jump(u, h)
        positions = _grid_positions(points, u)
        coefficients_at_points = np.empty((6, len(points)))
        for k in range(6):
            coefficients_at_points[k] = _interpolate_at_positions(positions, coefficients[k])
        _, c2, c3, gamma2, gamma3, _ = coefficients_at_points
        loads = abs(F) * np.sqrt(c2 * c3 * gamma3 / gamma2)
        window = (_grid_positions(points - h, points), _grid_positions(points + h, points))
        for f in AVERAGED_WEIGHT_SETTINGS.load_term_factors:
            arm = (points, coefficients_at_points, f * loads)
            _write_regions_of_trial(regions[row : row + 2], arm, window, (F, h, max_a2))
            if only_smallest:
                max_a2 = min(max_a2, regions[row + 1, 0] ** 2)
            row += 2
    return regions


@compiled
def _with_points_where_window_ends_jump(u: Array, h: float) -> Array:
    """The points u of an arm, (points,), and two more near each u at the distance h from a jump; sorted."""
    # Each jump adds at most four points: two window ends, with a point on either side of each.
    points = np.empty(5 * len(u))
    count = len(u)
    points[:count] = u
    for i in range(len(u) - 1):
        if u[i + 1] - u[i] < AVERAGED_WEIGHT_SETTINGS.max_distance_across_jump:
            for window_end in (-h, h):
                for offset in (
                    -AVERAGED_WEIGHT_SETTINGS.added_point_distance,
                    AVERAGED_WEIGHT_SETTINGS.added_point_distance,
                ):
                    position = (u[i + 1] + u[i]) / 2 + window_end + offset
                    if u[0] < position < u[-1]:
                        points[count] = position
                        count += 1
    return np.sort(points[:count])


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


@compiled
def _interpolate_at_positions(positions: GridPositions, values: Array) -> Array:
    """Values at positions in a grid, (n,), interpolated linearly from `values` at the grid points."""
    out = np.empty(len(positions.fraction))
    for n in range(len(out)):
        i = positions.interval_index[n]
        out[n] = values[i] + positions.fraction[n] * (values[i + 1] - values[i])
    return out


@compiled
def _write_regions_of_trial(
    regions: Array,
    arm: tuple[Array, Array, Array],
    window: tuple[GridPositions, GridPositions],
    trial: tuple[float, float, float],
) -> None:
    """Writes the two regions (a, c) of a trial weight into `regions`, (2, 2). In the first region (t - alpha)
    nu is bounded by theta(0) = 0, in the second by the rotational drag.

    arm: points u, (points,); `LocalCoefficients` there, (6, points); l there, (points,). window: positions
    of u - h and of u + h in u. trial: force F, half-width h, and the a^2 above which both regions are left
    unchanged.
    """
    u, coefficients, loads = arm
    F, h, max_a2 = trial
    t, alpha, slopes = _trial_weights(arm, window, h)
    a2_clamp = 0.0
    a2_drag = 0.0
    bending = 0.0
    c2_clamp = 0.0
    previous = 0.0
    for i in range(len(u)):
        nu, c2, c3, gamma2, gamma3, g = coefficients[:, i]
        A2 = slopes[i] ** 2 / (gamma2 * c2)
        B2 = F * F * alpha[i] * c3 / gamma2
        drag = gamma3 * alpha[i] * c2
        # Without a load t nu equals g; the rounded difference must not be divided by a drag near 0.
        a2_clamp = max(a2_clamp, squared_block_norm(A2, B2, g - t[i] * nu if loads[i] > 0 else 0.0, drag))
        a2_drag = max(a2_drag, squared_block_norm(A2, B2, g - alpha[i] * nu, drag))
        if min(a2_clamp, a2_drag) > max_a2:
            return
        if i > 0:
            # As theta(0) = 0, |theta(u)|^2 is at most int_0^u c3 du times int c3 |m|^2 du.
            bending += (u[i] - u[i - 1]) * (c3 + coefficients[2, i - 1]) / 2
        density = ((t[i] - alpha[i]) * nu) ** 2 / (alpha[i] * c2) * bending
        if i > 0:
            c2_clamp += (u[i] - u[i - 1]) * (density + previous) / 2
        previous = density
    regions[0] = math.sqrt(a2_clamp), math.sqrt(c2_clamp) / 2
    regions[1] = math.sqrt(a2_drag), 0.0


@compiled
def _trial_weights(
    arm: tuple[Array, Array, Array], window: tuple[GridPositions, GridPositions], h: float
) -> tuple[Array, Array, Array]:
    """Returns (t, alpha, derivative of log alpha) at all points of an arm, (points,) each. Arguments: as for
    `_write_regions_of_trial`. h: half-width of the window."""
    u, coefficients, loads = arm
    t = coefficients[5] / (coefficients[0] + loads)
    log_t = np.log(t)
    integral = np.zeros(len(u))
    for i in range(1, len(u)):
        integral[i] = integral[i - 1] + (u[i] - u[i - 1]) * (log_t[i] + log_t[i - 1]) / 2
    log_t_left, log_t_right, log_t_integrals = _log_weight_ends_and_integral(u, log_t, integral, window, h)
    return t, np.exp(log_t_integrals / (2 * h)), (log_t_right - log_t_left) / (2 * h)


@compiled
def _log_weight_ends_and_integral(
    u: Array, log_t: Array, integral: Array, window: tuple[GridPositions, GridPositions], h: float
) -> tuple[Array, Array, Array]:
    """Returns (log t at u - h, log t at u + h, integral of log t over [u - h, u + h]), all (points,). u:
    points of the arm. log_t: log t at u. integral: integral of log t from the first point to every point. All
    (points,). window: positions of u - h and of u + h in u."""
    log_t_left = _interpolate_at_positions(window[0], log_t)
    log_t_right = _interpolate_at_positions(window[1], log_t)
    # Beyond its ends the arm continues with its end values, so that every window has the same width.
    integrals = _interpolate_at_positions(window[1], integral) + np.maximum(u + h - u[-1], 0.0) * log_t[-1]
    integrals -= _interpolate_at_positions(window[0], integral) - np.maximum(u[0] - (u - h), 0.0) * log_t[0]
    return log_t_left, log_t_right, integrals


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
