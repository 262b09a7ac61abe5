"""Points of an arm at which averaged weights are evaluated: the points of the arm, and points on both sides
of each u at which the slope of a weight jumps (`rodsweep.determinant.arm.hull.averaged_weight`)."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....model.compiled.compilation import compiled, compiled_with_reordered_sums
from ....model.compiled.kernel_constants import KernelConstants


@dataclass(frozen=True, slots=True, kw_only=True)
class AveragedWeightSettings(KernelConstants):
    """Settings for the averaged weights alpha that are tried."""

    load_term_factors: tuple[float, ...] = (1.0, 0.5, 0.0)
    """Values of f in the trial weight t = g/(nu + l), l = f |F| sqrt(c2 c3 gamma3/gamma2). f = 1 is mostly
    the best and comes first: its region then ends the other trials early."""
    window_half_widths: tuple[float, ...] = (0.01, 0.02, 0.04, 0.08, 0.16, 0.32)
    """Values of the half-width h of the window, in L."""
    max_distance_across_jump: float = 1e-6
    """Two successive points closer than this distance, in L, lie on the two sides of a jump."""
    distance_between_added_points: float = 1e-12
    """Distance, in L, between the points added on both sides of u at which the slope of alpha jumps."""

    @property
    def trial_region_count(self) -> int:
        """Number of trial regions: two for each pair of f and h."""
        return 2 * len(self.load_term_factors) * len(self.window_half_widths)


AVERAGED_WEIGHT_SETTINGS = AveragedWeightSettings()


class GridPositions(NamedTuple):
    """Positions of n points in a grid: index of the grid interval, (n,), and distance from the start of the
    interval, as a fraction of its length, (n,)."""

    interval_index: NDArray[np.int64]
    """Index of the grid interval that contains each point, (n,)."""
    interval_fraction: Array


class TrialPoints(NamedTuple):
    """Points of an arm at which the weights with one half-width h of the averaging window are evaluated. u:
    positions of the points from clamp to tip, (n,). arm_point_indices: index of each point among the points
    of the arm, -1 for an added point, (n,). coefficients: `LocalCoefficients`, (6, n). load_terms: |F|
    sqrt(c2 c3 gamma3/gamma2), (n,). window_starts, window_ends: between which of these n points u - h and u +
    h lie."""

    u: Array
    arm_point_indices: NDArray[np.int64]
    coefficients: Array
    load_terms: Array
    window_starts: GridPositions
    window_ends: GridPositions


@compiled
def trial_points_for_half_width(
    u: Array, coefficients: Array, loads: Array, F: float, h: float
) -> TrialPoints:
    """The `TrialPoints` of an arm for the half-width h. u: points of the arm, (points,). coefficients:
    `LocalCoefficients` at these points, (6, points). loads: `load_terms` of `TrialPoints` at these points,
    (points,). F: force."""
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
    """Returns (points, sources). points: the points u of an arm, (points,), and the added points, sorted. At
    each place at the distance h from a jump, where the averaging window of half-width h ends at the jump, one
    point is added on either side. sources: index of each point in u, -1 for an added point."""
    # Each jump adds at most four points: two window ends, with a point on either side of each.
    added: Array = np.empty(4 * len(u))
    count = 0
    for i in range(len(u) - 1):
        if u[i + 1] - u[i] < AVERAGED_WEIGHT_SETTINGS.max_distance_across_jump:
            for window_end in (-h, h):
                for offset in (
                    -AVERAGED_WEIGHT_SETTINGS.distance_between_added_points,
                    AVERAGED_WEIGHT_SETTINGS.distance_between_added_points,
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


@compiled_with_reordered_sums
def interpolate_at_position(positions: GridPositions, n: int, values: Array) -> float:
    """Value at position number n in a grid, interpolated linearly from `values` at the grid points,
    (points,)."""
    i = positions.interval_index[n]
    return values[i] + positions.interval_fraction[n] * (values[i + 1] - values[i])
