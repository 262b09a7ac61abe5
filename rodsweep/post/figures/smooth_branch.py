"""A branch as it is drawn: a curve through its stored cycles that is smooth between its corners."""

from itertools import pairwise

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator, CubicHermiteSpline, barycentric_interpolate

from ...arrays import Array
from ..branch_curves import CurveOfCycles

MIRRORED, IMAGE = 3, np.array([1.0, -1.0, 1.0])
"""Cycles that are mirrored at a Hopf point, as many as a slope of Akima's cubic depends on; their image."""
SHARES = np.array([0.5, 1.0, 1.0])
"""Of the parameter, of y and of the logarithm of the period in the length along a branch, in units of their
extents: next to a Hopf point the parameter goes with the square of y, and a length that is y is smoothest."""
OF_SLOPE = 5
"""Cycles through which the polynomial goes whose slope the curve has, so that few cycles suffice."""
CORNER = 0.15
"""Difference of that slope from Akima's, in units of the steeper chord, that only a corner makes."""
NO_Y = np.array([1.0, 0.0, 1.0])
"""The parameter and the period of a place, without y."""
OF_CORNER = 4
"""Cycles on each side of a corner from which it is found, by a cubic."""
LEAST_ANGLE = 0.25
"""Difference of the slopes at a corner over the steepest chord beside it; errors of 1 % make half of it."""
SAME = 1e-9
"""Imaginary part of a root, in units of the distance of two cycles, that is rounding."""
BETWEEN = 12
"""Places at which the curve between two cycles is drawn."""


def through_cycles(curve: CurveOfCycles) -> tuple[Array, Array, Array, NDArray[np.integer]]:
    """(at, y, period, stable) of a branch as it is drawn, (n,), the last (n - 1,): smooth between corners.

    A branch has a corner where another maximum of y(t) becomes the largest.
    """
    places = np.column_stack([curve.at, curve.y, np.log(curve.period)])
    moves = (np.diff(places, axis=0) != 0).any(axis=1)  # the end of the range is a cycle too
    own, stable = places[np.append(True, moves)], curve.stable[moves]
    if len(own) <= MIRRORED:
        return curve.at, curve.y, curve.period, curve.stable
    extent = np.ptp(places, axis=0)
    extent[extent == 0] = 1.0
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
    first, last = (int(vertex[1] == 0) * MIRRORED for vertex in (own[0], own[-1]))
    whole = np.concatenate([before[:first], own, behind[:last]])
    s = _lengths(whole, extent)
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
    for i in range(OF_CORNER - 1, len(own) - OF_CORNER):
        window = slice(i + 1 - OF_CORNER, i + 1 + OF_CORNER)
        x, y = (lengths[window] - lengths[i]) / (lengths[i + 1] - lengths[i]), own[window, 1]
        before = Polynomial.fit(x[:OF_CORNER], y[:OF_CORNER], OF_CORNER - 1).convert()
        behind = Polynomial.fit(x[OF_CORNER:], y[OF_CORNER:], OF_CORNER - 1).convert()
        angle = (behind - before).deriv() / np.abs(np.diff(y) / np.diff(x)).max()
        meet = [x.real for x in (behind - before).roots() if abs(x.imag) < SAME and 0 < x.real < 1]
        if meet and angle(meet[0]) > LEAST_ANGLE:
            at, _, log_period = barycentric_interpolate(x, own[window], meet[0])
            found[i] = float(angle(meet[0])), np.array([at, before(meet[0]), log_period])
    return {
        i: place
        for i, (angle, place) in found.items()
        if angle == max(found[k][0] for k in found if abs(k - i) < OF_CORNER)
    }


def _lengths(places: Array, extent: Array) -> Array:
    """Lengths along the chords from the first of some places, (n, 3), to each, (n,)."""
    return np.append(0.0, np.cumsum(np.linalg.norm(np.diff(places / extent * SHARES, axis=0), axis=1)))


def slopes_at_cycles(s: Array, places: Array) -> Array:
    """The derivatives of places by s, both (n, columns): of the polynomial through OF_SLOPE cycles beside.

    Akima's where the two differ much: beside a corner, where another maximum of y(t) becomes the largest, his
    cubic makes no waves.
    """
    akima = Akima1DInterpolator(s, places)(s, 1)
    count = min(OF_SLOPE, len(s))
    smooth = np.empty_like(places)
    for i, start in enumerate(np.clip(np.arange(len(s)) - count // 2, 0, len(s) - count)):
        beside = s[start : start + count] - s[i]
        size = np.abs(beside).max()
        powers = np.vander(beside / size, increasing=True)
        smooth[i] = np.linalg.solve(powers, places[start : start + count])[1] / size
    chords = np.abs(np.diff(places, axis=0) / np.diff(s)[:, None])
    steepest = np.maximum(np.vstack([chords[:1], chords]), np.vstack([chords, chords[-1:]]))
    return np.where(np.abs(smooth - akima) <= CORNER * steepest, smooth, akima)
