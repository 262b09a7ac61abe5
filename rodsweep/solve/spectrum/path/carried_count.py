"""A count of eigenvalues carried along a path, as far as a proof on a moving line reaches.

At one point the first `known` followed eigenvalues are proved to be all right of a line. If no eigenvalue
crosses a line that moves in an open gap to another point (`rodsweep.determinant.moving_line`), the
eigenvalues right of the line are all at every point between.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array, Complex
from ....determinant.moving_line import IntervalEnd, none_crosses
from ....determinant.roots.settings import ROOTS
from ....model.compiled.compilation import compiled
from ....model.compiled.settings import CompiledSettings
from ....model.rod import Coefficients
from .prediction import Track


@dataclass(frozen=True, slots=True, kw_only=True)
class CarriedCountSettings(CompiledSettings):
    """Settings for counts carried from point to point."""

    rectangles: int = 60
    """Number of rectangles after which a proof is given up, besides `rectangles_per_point`."""
    rectangles_per_point: int = 20
    """Further rectangles for each point: a count at a point costs as much as twenty."""
    wide_enough: float = 0.2
    """Relative half width above which all gaps are equally good; the last wide gap is taken."""
    narrowest_gap: float = 1e-6
    """Relative half width below which a gap is not used."""


CARRIED_COUNT = CarriedCountSettings()


@compiled
def line_in(track: Track, i: int, gap: int) -> tuple[float, float]:
    """(middle of the gap behind the first `gap` eigenvalues of point i, half its relative width)."""
    right = track.w[i, track.order[i, gap - 1]].real
    left = track.w[i, track.order[i, gap]].real
    line = (right + left) / 2
    if not line < 0:
        return line, 0.0
    return line, min((right - line) / -line, CARRIED_COUNT.wide_enough)


@compiled
def best_gap(track: Track, i: int, modes: int) -> int:
    """The gap for a count at point i, behind at least `modes` eigenvalues and left of the axis; 0 if none."""
    best = 0
    widest = CARRIED_COUNT.narrowest_gap
    for gap in range(modes, track.w.shape[1]):
        width = line_in(track, i, gap)[1]
        if width >= widest:
            best = gap
            widest = width
    return best


@compiled
def _stays_open(track: Track, ends: tuple[int, int], gap: int, lines: tuple[float, float], p: Array) -> bool:
    """Whether at every point between the ends exactly the first `gap` eigenvalues lie clearly right of the
    line.
    """
    i, j = ends
    for s in range(i, j + 1):
        share = (p[s] - p[i]) / (p[j] - p[i])
        line = (1 - share) * lines[0] + share * lines[1]
        for rank in range(track.w.shape[1]):
            k = track.order[s, rank]
            away = track.w[s, k].real - line
            if not (away if rank < gap else -away) > 2 * track.error[s, k]:
                return False
    return True


@compiled
def _gap_between(track: Track, ends: tuple[int, int], modes: int, known: int, p: Array) -> int:
    """The widest gap among the first `known` that stays open between two points; 0 without an open gap."""
    best = 0
    widest = CARRIED_COUNT.narrowest_gap
    for gap in range(modes, min(known, track.w.shape[1] - 1) + 1):
        here, wide = line_in(track, ends[0], gap)
        there, wide_there = line_in(track, ends[1], gap)
        if min(wide, wide_there) >= widest and _stays_open(track, ends, gap, (here, there), p):
            best = gap
            widest = min(wide, wide_there)
    return best


@compiled
def _end(track: Track, i: int, gap: int, p: Array, coefficients: Array) -> IntervalEnd:
    F, nu, c2, gamma3 = coefficients[i]
    return IntervalEnd(p[i], Coefficients(F, nu, c2, gamma3), line_in(track, i, gap)[0])


@compiled
def carry_count(
    track: Track, coefficients: Array, p: Array, direction: Coefficients, modes: int, known: NDArray
) -> int:
    """Index of the last point to which the count of the first point can be carried.

    coefficients: (points, 4). p: (points,). known: number of leading eigenvalues that are all right of a
    line, (points,); given at the first point, filled here.
    """
    i = 0
    last = len(p) - 1
    ahead = last
    while i < last:
        j = min(i + ahead, last)
        gap = _gap_between(track, (i, j), modes, known[i], p)
        proved = False
        if gap > 0:
            first = _end(track, i, gap, p, coefficients)
            end = _end(track, j, gap, p, coefficients)
            most = CARRIED_COUNT.rectangles + CARRIED_COUNT.rectangles_per_point * (j - i)
            proved, _ = none_crosses(first, end, direction, most)
        if proved:
            # The proof holds for the gap of the line, though more eigenvalues may have been known.
            known[i + 1 : j + 1] = gap
            i = j
            # Where one proof succeeds, a proof over twice the way often does, too.
            ahead = 2 * ahead
        elif j == i + 1:
            return i
        else:
            ahead = (j - i) // 2
    return last


@compiled
def judge_points(track: Track, known: NDArray, modes: int, accuracy: float) -> tuple[NDArray, NDArray]:
    """(whether each point is certified with accurate leading modes, number of unstable modes), (points,)
    each.

    A point fails if an eigenvalue may lie on the imaginary axis, or if digits are lost beside a double
    eigenvalue.
    """
    n = len(known)
    good = np.empty(n, np.bool_)
    unstable = np.zeros(n, np.int64)
    for s in range(n):
        good[s] = known[s] >= modes
        for rank in range(known[s]):
            k = track.order[s, rank]
            w = track.w[s, k]
            error = track.error[s, k]
            if abs(w.real) <= max(ROOTS.axis_errors * error, ROOTS.on_the_axis * abs(w)):
                good[s] = False
            if rank < modes and not error <= min(ROOTS.blurred, accuracy / 2) * abs(w):
                good[s] = False
            unstable[s] += w.real > 0
    return good, unstable


@compiled
def leading(track: Track, modes: int) -> tuple[Complex, Array]:
    """The leading `modes` eigenvalues and their errors, (points, modes) each."""
    n = track.w.shape[0]
    w = np.empty((n, modes), np.complex128)
    error = np.empty((n, modes))
    for s in range(n):
        for rank in range(modes):
            k = track.order[s, rank]
            w[s, rank] = track.w[s, k]
            error[s, rank] = track.error[s, k]
    return w, error
