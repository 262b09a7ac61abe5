"""A branch as it is drawn: a curve through its stored cycles that is smooth between its corners."""

from itertools import pairwise

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, barycentric_interpolate

from ...arrays import Array
from ..branch_curves import CurveOfCycles

MIRRORED, IMAGE = 3, np.array([1.0, -1.0, 1.0])
"""Cycles that are mirrored at a Hopf point, more than a slope depends on; their image."""
SHARES = np.array([0.5, 1.0, 1.0])
"""Of the parameter, of y and of the logarithm of the period in the length along a branch, in units of their
extents: next to a Hopf point the parameter goes with the square of y, and a length that is y is smoothest."""
POWERS = (1.0, 0.5)
"""Powers of the chords of which the smoother one is taken: where steps grow at a bend their root is."""
OF_SLOPE = 5
"""Cycles through which the polynomial goes whose slope the curve has, so that few cycles suffice."""
NO_Y = np.array([1.0, 0.0, 1.0])
"""The parameter and the period of a place, without y."""
OF_CORNER = 4
"""Cycles on each side of a corner from which it is found, by a cubic; fewer at an end of the branch."""
LEAST_ANGLE = 0.25
"""Difference of the slopes at a corner over the steepest chord beside it; errors of 1 % make half of it."""
BEND = 3.0
"""Least ratio of the angle in y to those in parameter and period: at a smooth sharp bend they are alike."""
COINCIDENT = 1e-9
"""Distance of two cycles, in units of the branch's extent, and imaginary part of a root that are rounding."""
BETWEEN = 12
"""Places at which the curve between two cycles is drawn."""


def through_cycles(curve: CurveOfCycles) -> tuple[Array, Array, Array, NDArray[np.integer]]:
    """(at, y, period, stable) of a branch as it is drawn, (n,), the last (n - 1,): smooth between corners.

    A branch has a corner where another maximum of y(t) becomes the largest.
    """
    places = np.column_stack([curve.at, curve.y, np.log(curve.period)])
    extent = np.ptp(places, axis=0)
    extent[extent == 0] = 1.0
    # The end of the range is stored as a cycle and as a special point.
    moves = (np.abs(np.diff(places, axis=0)) > COINCIDENT * extent).any(axis=1)
    own, stable = places[np.append(True, moves)], curve.stable[moves]
    if len(own) <= MIRRORED:
        return curve.at, curve.y, curve.period, curve.stable
    corners = corners_of(own, extent)
    for i in sorted(corners, reverse=True):
        own = np.insert(own, i + 1, corners[i], axis=0)
        stable = np.insert(stable, i, stable[i])
    inner = [i + 1 + k for k, i in enumerate(sorted(corners))]
    parts = [_smooth(own[low : high + 1], extent) for low, high in pairwise([0, *inner, len(own) - 1])]
    at, y, log_period = np.concatenate([*(part[:-1] for part in parts), parts[-1][-1:]]).T
    return at, y, np.exp(log_period), np.repeat(stable, BETWEEN)


def _smooth(own: Array, extent: Array) -> Array:
    """Places on a smooth curve through cycles, both (n, 3): BETWEEN pieces from each cycle to the next.

    At a Hopf point a branch is its own mirror image, y to -y: beyond it the cycles are mirrored, so that the
    curve has the square root there.
    """
    before, behind = (some * IMAGE for some in (own[MIRRORED:0:-1], own[-2 : -MIRRORED - 2 : -1]))
    first = len(before) if own[0, 1] == 0 else 0
    last = len(behind) if own[-1, 1] == 0 else 0
    whole = np.concatenate([before[:first], own, behind[:last]])
    s = min((_lengths(whole, extent, power) for power in POWERS), key=lambda s: _roughness(s, whole / extent))
    ends = s[first : first + len(own)]
    finer = np.append(np.linspace(ends[:-1], ends[1:], BETWEEN, endpoint=False, axis=1).ravel(), ends[-1])
    places: Array = CubicHermiteSpline(s, whole, slopes_at_cycles(s, whole))(finer)
    return places


def corners_of(own: Array, extent: Array) -> dict[int, Array]:
    """The corners of a branch through cycles, (n, 3): at, y and log period, (3,), by the cycle before.

    At a corner the polynomials for y through the cycles before and behind meet, and the latter rises more
    steeply, because y is the larger of two maxima of y(t). Their variable is the length along the curve of
    period and parameter, which has no corner. Polynomials that reach beyond a corner meet elsewhere at a
    smaller angle: among neighbouring places the one with the largest angle is the corner.
    """
    lengths = _lengths(own * NO_Y, extent)
    found: dict[int, tuple[float, Array]] = {}
    for i in range(1, len(own) - 2):
        window = slice(max(0, i + 1 - OF_CORNER), i + 1 + OF_CORNER)
        x = (lengths[window] - lengths[i]) / (lengths[i + 1] - lengths[i])
        rises = [_rise(x, column) for column in own[window].T]
        for root in rises[1].roots():
            angles = [float(rise.deriv()(root.real)) for rise in rises]
            is_between = abs(root.imag) < COINCIDENT and 0 < root.real < 1
            if is_between and angles[1] > LEAST_ANGLE and angles[1] > BEND * max(map(abs, angles[::2])):
                place = barycentric_interpolate(x, own[window], root.real)
                place[1] = barycentric_interpolate(x[x < 0.5], own[window][x < 0.5, 1], root.real)
                found[i] = angles[1], place
    return {
        i: place
        for i, (angle, place) in found.items()
        if angle == max(found[k][0] for k in found if abs(k - i) < OF_CORNER)
    }


def _rise(x: Array, values: Array) -> Polynomial:
    """The polynomial through the values at x > 0.5 less that through the others, over the steepest chord."""
    before, behind = (
        Polynomial.fit(x[side], values[side], side.sum() - 1).convert() for side in (x < 0.5, x > 0.5)
    )
    return (behind - before) / (np.abs(np.diff(values) / np.diff(x)).max() or 1.0)


def _lengths(places: Array, extent: Array, power: float = 1.0) -> Array:
    """Sums of the powers of the chords from the first of some places, (n, 3), to each, (n,)."""
    chords = np.linalg.norm(np.diff(places / extent * SHARES, axis=0), axis=1)
    return np.append(0.0, np.cumsum(chords**power))


def _roughness(s: Array, places: Array) -> float:
    """The largest distance of a place, (n, columns), from the cubic in s through the two on each side."""
    beside = (-2, -1, 1, 2)
    off = [
        places[i] - barycentric_interpolate(s[[i + k for k in beside]], places[[i + k for k in beside]], s[i])
        for i in range(2, len(s) - 2)
    ]
    return float(np.abs(off).max()) if off else 0.0


def slopes_at_cycles(s: Array, places: Array) -> Array:
    """The derivatives of places by s, both (n, columns): of the polynomial through OF_SLOPE cycles beside."""
    count = min(OF_SLOPE, len(s))
    slopes = np.empty_like(places)
    for i, start in enumerate(np.clip(np.arange(len(s)) - count // 2, 0, len(s) - count)):
        beside = s[start : start + count] - s[i]
        size = np.abs(beside).max()
        powers = np.vander(beside / size, increasing=True)
        slopes[i] = np.linalg.solve(powers, places[start : start + count])[1] / size
    return slopes
