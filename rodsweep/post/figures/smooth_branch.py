"""Smooth curve through the stored cycles of a branch of cycles, except at corners of the branch."""

from itertools import pairwise

import numpy as np
import scipy  # loads a subpackage at its first use: scipy.interpolate takes a quarter of a second
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from ...arrays import Array, list_of
from ..stored_branches import StoredBranch

MIRRORED_CYCLE_COUNT = 3
"""Number of cycles next to a Hopf point whose mirror images (y to -y) continue the branch beyond the Hopf
point."""
MIRROR_FACTORS = np.array([1.0, -1.0, 1.0])
"""Factors of (parameter, y, log period) that turn a cycle into its mirror image."""
CHORD_LENGTH_WEIGHTS = np.array([0.5, 1.0, 1.0])
"""Weights of parameter, y and log period in the length of a chord; the three coordinates are divided by their
ranges on the branch."""
CHORD_LENGTH_WEIGHTS_WITHOUT_Y = np.array([1.0, 0.0, 1.0])
"""Weights of parameter, y and log period in the length of a chord that ignores y."""
INTERPOLATION_VARIABLE_CANDIDATES = (
    (CHORD_LENGTH_WEIGHTS, 1.0),
    (CHORD_LENGTH_WEIGHTS, 0.5),
    (np.array([0.1, 1.0, 0.1]), 1.0),
)
"""(weights, power) of the candidates for the variable of the interpolation: sums of the chord lengths to this
power. The arc length (power 1) is best on most branches, the sum of square roots where steps grow at a bend.
A length close to y is best on a branch that ends near its Hopf point, where parameter and period are
quadratic in y."""
CYCLES_ON_EACH_SIDE_OF_CORNER = 4
"""Number of cycles on each side of a corner in the polynomials that locate the corner; fewer near an end of
the branch."""
MIN_RELATIVE_SLOPE_JUMP = 0.25
"""A jump of the slope is drawn as a corner if the jump exceeds this fraction of the steepest chord near the
corner. A smaller jump changes the curve by at most a few per cent of the chord."""
MIN_Y_SLOPE_JUMP_OVER_OTHER_JUMPS = 3.0
"""At a corner, the jump of the slope of y exceeds this multiple of the jumps of the slopes of parameter and
log period, which are smooth there. At a sharp bend that the cycles do not resolve, all three jumps are
similar."""
BRANCH_ROUNDING_TOLERANCE = 1e-9
"""Rounding tolerance for distances divided by the range of the branch, and, in the search for corners, for
the imaginary part of the place between two cycles, from 0 to 1, where two polynomials intersect."""
SEGMENTS_BETWEEN_CYCLES = 12
"""Number of straight segments that are drawn between two cycles."""


def smooth_curve_of_branch(curve: StoredBranch) -> tuple[Array, Array, Array, NDArray[np.integer]]:
    """Returns (parameter, y, period, stability) of the smooth curve through the cycles of a branch:
    parameter, y and period at the vertices, (n,) each, and stability between vertices, (n - 1,).

    The branch has a corner where a different maximum of y(t) becomes the largest maximum; the curve is smooth
    between corners.
    """
    vertices = np.column_stack([curve.parameter, curve.tip_y_max, np.log(curve.period)])
    extent = np.ptp(vertices, axis=0)
    extent[extent == 0] = 1.0
    # The end of the range is stored as a cycle and as a special point.
    is_distinct = (np.abs(np.diff(vertices, axis=0)) > BRANCH_ROUNDING_TOLERANCE * extent).any(axis=1)
    cycles = vertices[np.append(True, is_distinct)]
    stable = curve.stability[is_distinct]
    if len(cycles) <= MIRRORED_CYCLE_COUNT:
        return curve.parameter, curve.tip_y_max, curve.period, curve.stability
    corners = corners_by_previous_cycle(cycles, extent)
    for i in sorted(corners, reverse=True):
        cycles = np.insert(cycles, i + 1, corners[i], axis=0)
        stable = np.insert(stable, i, stable[i])
    corner_indices = [i + 1 + k for k, i in enumerate(sorted(corners))]
    ends = pairwise([0, *corner_indices, len(cycles) - 1])
    parts = [_vertices_of_smooth_curve(cycles[low : high + 1], extent) for low, high in ends]
    values, y, log_period = np.concatenate([*(part[:-1] for part in parts), parts[-1][-1:]]).T
    return values, y, np.exp(log_period), np.repeat(stable, SEGMENTS_BETWEEN_CYCLES)


def _vertices_of_smooth_curve(cycles: Array, extent: Array) -> Array:
    """Vertices, (m, 3), of a smooth curve through the cycles `cycles`, (n, 3), with SEGMENTS_BETWEEN_CYCLES
    segments between two cycles. Columns: parameter, y, log period. extent: range of each column over the
    branch, (3,). At a Hopf point the branch is symmetric under y to -y. Mirror images of cycles, beyond the
    Hopf point, therefore give the curve a square-root shape."""
    cycles_before = cycles[MIRRORED_CYCLE_COUNT:0:-1] * MIRROR_FACTORS
    cycles_after = cycles[-2 : -MIRRORED_CYCLE_COUNT - 2 : -1] * MIRROR_FACTORS
    first_index = len(cycles_before) if cycles[0, 1] == 0 else 0
    last_count = len(cycles_after) if cycles[-1, 1] == 0 else 0
    extended = np.concatenate([cycles_before[:first_index], cycles, cycles_after[:last_count]])
    variables = [
        _cumulative_chord_lengths(extended, extent, *choice) for choice in INTERPOLATION_VARIABLE_CANDIDATES
    ]
    abscissa = min(variables, key=lambda variable: _largest_cubic_deviation(variable, extended / extent))
    ends = abscissa[first_index : first_index + len(cycles)]
    drawn = np.linspace(ends[:-1], ends[1:], SEGMENTS_BETWEEN_CYCLES, endpoint=False, axis=1).ravel()
    spline = scipy.interpolate.CubicSpline(abscissa, extended)
    return np.asarray(spline(np.append(drawn, ends[-1])))


def corners_by_previous_cycle(cycles: Array, extent: Array) -> dict[int, Array]:
    """Corners of a branch through the cycles `cycles`, (n, 3), as {index of the previous cycle: (parameter,
    y, log period), (3,)}. extent: range of each coordinate over the branch, (3,).

    At a corner, a different maximum of y(t) becomes the largest maximum, so y is continuous and its slope
    increases. On each interval between cycles, one polynomial for y passes through the cycles before the
    interval, and one through the cycles after it; their intersection is a candidate. The variable of the
    polynomials is the arc length of (parameter, log period), which is smooth. Of candidates on neighbouring
    intervals, the candidate with the largest change of slope is the corner.
    """
    lengths = _cumulative_chord_lengths(cycles * CHORD_LENGTH_WEIGHTS_WITHOUT_Y, extent)
    candidates: dict[int, tuple[float, Array]] = {}
    for i in range(1, len(cycles) - 2):
        window = slice(max(0, i + 1 - CYCLES_ON_EACH_SIDE_OF_CORNER), i + 1 + CYCLES_ON_EACH_SIDE_OF_CORNER)
        if (np.diff(lengths[window]) == 0).any():
            continue  # y alone changes, which a jump between two maxima does not do
        x = (lengths[window] - lengths[i]) / (lengths[i + 1] - lengths[i])
        differences = [_difference_of_one_sided_polynomials(x, column) for column in cycles[window].T]
        for root in list_of(differences[1].roots()):
            slope_jumps = [float(difference.deriv()(root.real)) for difference in differences]
            is_between = abs(root.imag) < BRANCH_ROUNDING_TOLERANCE and 0 < root.real < 1
            if (
                is_between
                and slope_jumps[1] > MIN_RELATIVE_SLOPE_JUMP
                and slope_jumps[1] > MIN_Y_SLOPE_JUMP_OVER_OTHER_JUMPS * max(map(abs, slope_jumps[::2]))
            ):
                interpolate = scipy.interpolate.barycentric_interpolate
                corner = interpolate(x, cycles[window], root.real)
                corner[1] = interpolate(x[x < 0.5], cycles[window][x < 0.5, 1], root.real)
                candidates[i] = slope_jumps[1], corner
    return {
        i: corner
        for i, (slope_jump, corner) in candidates.items()
        if slope_jump
        == max(
            candidates[corner_index][0]
            for corner_index in candidates
            if abs(corner_index - i) < CYCLES_ON_EACH_SIDE_OF_CORNER
        )
    }


def _difference_of_one_sided_polynomials(x: Array, values: Array) -> Polynomial:
    """Polynomial through the values at x > 0.5 minus the polynomial through the values at x < 0.5, divided by
    the slope of the steepest chord. x, values: (m,) each."""
    sides = (x < 0.5, x > 0.5)
    left, right = (Polynomial.fit(x[side], values[side], side.sum() - 1).convert() for side in sides)
    return (right - left) / (np.abs(np.diff(values) / np.diff(x)).max() or 1.0)


def _cumulative_chord_lengths(
    points: Array, extent: Array, weights: Array = CHORD_LENGTH_WEIGHTS, power: float = 1.0
) -> Array:
    """Sum of the chord lengths to the power `power`, from the first point to each point, (n,). points:
    points, (n, 3). extent: range of each coordinate over the branch, by which the points are divided, (3,).
    weights: weights of the coordinates, (3,)."""
    chords = np.linalg.norm(np.diff(points / extent * weights, axis=0), axis=1)
    return np.append(0.0, np.cumsum(chords**power))


def _largest_cubic_deviation(s: Array, points: Array) -> float:
    """Largest deviation, among all points and coordinates, of a point from the cubic polynomial through two
    neighbours on each side of the point. s: variable, (n,). points: points, (n, columns)."""
    deviations = []
    for i in range(2, len(s) - 2):
        neighbours = [i - 2, i - 1, i + 1, i + 2]
        cubic = scipy.interpolate.barycentric_interpolate(s[neighbours], points[neighbours], s[i])
        deviations.append(points[i] - cubic)
    return float(np.abs(deviations).max()) if deviations else 0.0
