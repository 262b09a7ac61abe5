"""Prediction of eigenvalues at the next point of a path, from values and slopes at the last two points.

Cubic Hermite polynomials extrapolate single real eigenvalues. Two real eigenvalues that meet, or have just
met, are not smooth functions of the rod, but half their sum and the square of half their difference are
smooth, as for a pair; these are extrapolated. Near the meeting point, the quadratic approximation of D about
their mean has to decide between two real eigenvalues and a pair.
"""

import cmath
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array, Complex
from ....model.compiled.compilation import compiled
from ....model.compiled.settings import CompiledSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class EigenvaluePredictionSettings(CompiledSettings):
    """Settings for predicted eigenvalues that meet."""

    closing: float = 4.0
    """Two real eigenvalues are extrapolated together if their present rates give a meeting within this many
    steps, before or after."""
    meeting: float = 0.25
    """If the squared difference shrinks below this fraction of its last value, D decides on real or
    complex."""


EIGENVALUE_PREDICTION = EigenvaluePredictionSettings()


class Track(NamedTuple):
    """Followed eigenvalues w, their slopes dw/dp and errors, (points, m) each.

    order: indices of the eigenvalues by descending real part, then frequency, (points, m).
    """

    w: Complex
    slope: Complex
    error: Array
    order: NDArray[np.int64]


class KnownRoots(NamedTuple):
    """Some roots of D of one rod, (k,), in any order, with the error of each, (k,)."""

    w: Complex
    error: Array


def track_from(first: Complex, points: int) -> Track:
    """A track with the eigenvalues of its first point, (m,), the leading ones first."""
    shape = (points, len(first))
    order = np.zeros(shape, np.int64)
    order[0] = np.arange(len(first))
    track = Track(np.empty(shape, complex), np.empty(shape, complex), np.empty(shape), order)
    track.w[0] = first
    return track


def part_of_track(track: Track, start: int, stop: int) -> Track:
    """The track from point start up to point stop."""
    here = slice(start, stop)
    return Track(track.w[here], track.slope[here], track.error[here], track.order[here])


@compiled
def mates_of(w: Complex, mate: NDArray) -> None:
    """Index of the complex conjugate of each eigenvalue, into `mate`, (m,); -1 for real eigenvalues."""
    for k in range(len(w)):
        mate[k] = -1
        if w[k].imag != 0:
            for j in range(len(w)):
                if w[j] == w[k].conjugate():
                    mate[k] = j


@compiled
def _pair_up(w: Complex, slope: Complex, step: float, mate: NDArray) -> None:
    """Also makes mates of real eigenvalues that meet within some steps, the earliest meeting first."""
    while True:
        soonest = EIGENVALUE_PREDICTION.closing
        a = -1
        b = -1
        for k in range(len(w)):
            for j in range(k + 1, len(w)):
                if mate[k] < 0 and mate[j] < 0 and w[k].imag == 0 and w[j].imag == 0:
                    closing = abs((slope[k] - slope[j]).real * step)
                    gap = abs(w[k] - w[j])
                    if gap < soonest * closing:
                        soonest = gap / closing
                        a = k
                        b = j
        if a < 0:
            return
        mate[a] = b
        mate[b] = a


@compiled
def extrapolated(
    values: tuple[float, float], slopes: tuple[float, float], steps: tuple[float, float]
) -> float:
    """Cubic Hermite extrapolation from two points, by values and slopes there, to a third point.

    steps: from the first to the second point, and from there to the third.
    """
    h, ahead = steps
    t = ahead / h
    difference = values[1] - values[0]
    cube = (slopes[0] + slopes[1]) * h - 2 * difference
    square = (slopes[0] + 2 * slopes[1]) * h - 3 * difference
    return values[1] + t * (slopes[1] * h + t * (square + t * cube))


@compiled
def _sum_and_square(w: Complex, slope: Complex, k: int, j: int) -> tuple[float, float, float, float]:
    """(half the sum of two eigenvalues, squared half of the difference, slopes of these two numbers)."""
    half = (w[k] - w[j]) / 2
    slope_of_half = (slope[k] - slope[j]) / 2
    middle = (w[k] + w[j]).real / 2
    slope_of_middle = (slope[k] + slope[j]).real / 2
    return middle, (half * half).real, slope_of_middle, (2 * half * slope_of_half).real


@compiled
def _two_ahead(
    track: Track, i: int, two: tuple[int, int], steps: tuple[float, float]
) -> tuple[complex, complex, bool]:
    """Guesses for two eigenvalues extrapolated together; the larger real part or frequency comes first.

    If D has to decide between a real and a complex pair, both guesses are the middle and the last value is
    True.
    """
    k, j = two
    # Where two real eigenvalues meet and become a pair, each has a square root in p; middle and squared half
    # difference are smooth.
    middle, square, m1, s1 = _sum_and_square(track.w[i - 1], track.slope[i - 1], k, j)
    before = square
    if i >= 2:
        middle_0, square_0, m0, s0 = _sum_and_square(track.w[i - 2], track.slope[i - 2], k, j)
        middle = extrapolated((middle_0, middle), (m0, m1), steps)
        square = extrapolated((square_0, square), (s0, s1), steps)
    else:
        middle = middle + m1 * steps[1]
        square = square + s1 * steps[1]
    if square * before <= 0 or abs(square) < EIGENVALUE_PREDICTION.meeting * abs(before):
        return complex(middle, 0.0), complex(middle, 0.0), True
    root = cmath.sqrt(complex(square, 0.0))
    return middle + root, middle - root, False


@compiled
def guess_two(w: Complex, two: tuple[int, int], roots: tuple[complex, complex], guess: Complex) -> None:
    """Sets the guesses for two of the eigenvalues w, both (m,), in their order: real part, then frequency."""
    k, j = two
    one, other = roots
    if (one - other).real < 0 or (one - other).imag < 0:
        one, other = other, one
    first = (w[k] - w[j]).real > 0 or (w[k] - w[j]).imag > 0
    guess[k], guess[j] = (one, other) if first else (other, one)


@compiled
def guess_at(track: Track, i: int, p: Array, guess: Complex, decided: NDArray) -> None:
    """Guesses for point i >= 1, a rod with the coefficients, into `guess`, (m,); p: (points,).

    decided: shape (m,), filled with -1; for two eigenvalues of which D has to decide whether they are real,
    the index of the partner, and both guesses are the middle.
    """
    w = track.w[i - 1]
    slope = track.slope[i - 1]
    mate = np.empty(len(w), np.int64)
    mates_of(w, mate)
    ahead = p[i] - p[i - 1]
    _pair_up(w, slope, ahead, mate)
    steps = (p[i - 1] - p[i - 2] if i >= 2 else ahead, ahead)
    decided[:] = -1
    for k in range(len(w)):
        j = mate[k]
        if j < 0 and i >= 2:
            values = (track.w[i - 2, k].real, w[k].real)
            slopes = (track.slope[i - 2, k].real, slope[k].real)
            guess[k] = complex(extrapolated(values, slopes, steps), 0.0)
        elif j < 0:
            guess[k] = complex(w[k].real + slope[k].real * ahead, 0.0)
        elif j > k:
            one, other, undecided = _two_ahead(track, i, (k, j), steps)
            guess_two(w, (k, j), (one, other), guess)
            if undecided:
                decided[k] = j
