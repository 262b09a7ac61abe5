"""Prediction of eigenvalues at the next point of a path, from values and slopes at the last two points.

A cubic Hermite polynomial extrapolates each single real eigenvalue. Two real eigenvalues that meet and become
a complex pair are not smooth functions of the path variable p. Half their sum and the square of half their
difference are smooth, before and after the meeting, and are extrapolated instead. Near the meeting, the
quadratic Taylor polynomial of the determinant D about half the sum shows whether the two eigenvalues are real
or complex.
"""

import cmath
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array, Complex
from ....model.compiled.compilation import compiled
from ....model.compiled.kernel_constants import KernelConstants


@dataclass(frozen=True, slots=True, kw_only=True)
class EigenvaluePredictionSettings(KernelConstants):
    """Settings for the prediction of two eigenvalues that meet."""

    max_steps_to_meeting: float = 4.0
    """Two real eigenvalues are extrapolated as a pair if, by their slopes, they meet within this many steps
    of the path, ahead or behind."""
    undecided_squared_difference_ratio: float = 0.25
    """If the predicted square of half the difference of two eigenvalues changes sign, or its magnitude is
    below this fraction of the magnitude at the last point, the determinant D is evaluated to find whether the
    two eigenvalues are real or complex."""


EIGENVALUE_PREDICTION_SETTINGS = EigenvaluePredictionSettings()


class FollowedEigenvalues(NamedTuple):
    """Track of m eigenvalues along the points of a path: eigenvalues w, their slopes dw/dp and absolute
    errors, (points, m) each. descending_order: indices of the eigenvalues at each point by descending real
    part, then descending frequency, (points, m)."""

    w: Complex
    slope: Complex
    """Derivatives dw/dp of the eigenvalues with respect to the path variable, (points, m)."""
    error: Array
    """Absolute errors of the eigenvalues, (points, m), in 1/tau2."""
    descending_order: NDArray[np.int64]


class KnownRoots(NamedTuple):
    """Known roots w of the determinant D of one rod, (k,), in any order, and their absolute errors, (k,)."""

    w: Complex
    error: Array
    """Absolute errors of the roots, (k,), in 1/tau2."""


def new_track(first_eigenvalues: Complex, point_count: int) -> FollowedEigenvalues:
    """A track of `point_count` points; only the first point is filled, with `first_eigenvalues`, (m,), by
    descending real part, then frequency."""
    shape = (point_count, len(first_eigenvalues))
    order = np.zeros(shape, np.int64)
    order[0] = np.arange(len(first_eigenvalues))
    track = FollowedEigenvalues(np.empty(shape, complex), np.empty(shape, complex), np.empty(shape), order)
    track.w[0] = first_eigenvalues
    return track


def slice_track(track: FollowedEigenvalues, start: int, stop: int) -> FollowedEigenvalues:
    """The points of a track with indices from `start` to `stop` - 1."""
    indices = slice(start, stop)
    return FollowedEigenvalues(
        track.w[indices], track.slope[indices], track.error[indices], track.descending_order[indices]
    )


@compiled
def find_conjugates(w: Complex, conjugate: NDArray) -> None:
    """Writes the index of the conjugate of each eigenvalue w into `conjugate`, (m,); -1 for a real
    eigenvalue."""
    for k in range(len(w)):
        conjugate[k] = -1
        if w[k].imag != 0:
            for j in range(len(w)):
                # The comparison is exact, because one of two conjugates is always made from the other.
                if w[j] == w[k].conjugate():
                    conjugate[k] = j


@compiled
def _pair_meeting_eigenvalues(w: Complex, slope: Complex, step: float, partner: NDArray) -> None:
    """Pairs real eigenvalues that are about to meet, the earliest meeting first: writes the index of each
    eigenvalue's partner into `partner`, (m,), whose entries are -1 for eigenvalues without a partner. w,
    slope: eigenvalues and dw/dp, (m,). step: change of p."""
    while True:
        min_steps = EIGENVALUE_PREDICTION_SETTINGS.max_steps_to_meeting
        a = -1
        b = -1
        for k in range(len(w)):
            for j in range(k + 1, len(w)):
                if partner[k] < 0 and partner[j] < 0 and w[k].imag == 0 and w[j].imag == 0:
                    approach = abs((slope[k] - slope[j]).real * step)
                    gap = abs(w[k] - w[j])
                    if gap < min_steps * approach:
                        min_steps = gap / approach
                        a = k
                        b = j
        if a < 0:
            return
        partner[a] = b
        partner[b] = a


@compiled
def extrapolate_hermite(
    values: tuple[float, float], slopes: tuple[float, float], steps: tuple[float, float]
) -> float:
    """Cubic Hermite extrapolation to a third point, from the values and slopes at two points. steps: distance
    from the first to the second point, and from the second to the third point."""
    h, next_step = steps
    t = next_step / h
    difference = values[1] - values[0]
    cubic_term = (slopes[0] + slopes[1]) * h - 2 * difference
    square = (slopes[0] + 2 * slopes[1]) * h - 3 * difference
    return values[1] + t * (slopes[1] * h + t * (square + t * cubic_term))


@compiled
def _half_sum_and_squared_half_difference(
    w: Complex, slope: Complex, k: int, j: int
) -> tuple[float, float, float, float]:
    """Returns (half the sum of w[k] and w[j], squared half difference, slope of the half sum, slope of the
    squared half difference). w, slope: eigenvalues and dw/dp, (m,)."""
    half = (w[k] - w[j]) / 2
    slope_of_half = (slope[k] - slope[j]) / 2
    middle = (w[k] + w[j]).real / 2
    slope_of_middle = (slope[k] + slope[j]).real / 2
    return middle, (half * half).real, slope_of_middle, (2 * half * slope_of_half).real


@compiled
def _predict_pair(
    track: FollowedEigenvalues, i: int, pair: tuple[int, int], steps: tuple[float, float]
) -> tuple[complex, complex, bool]:
    """Returns (first guess, second guess, undecided) for the eigenvalues with the two indices `pair` at point
    i of a path; the guess with the larger real part or frequency comes first.

    undecided: whether D must show if the two eigenvalues are real or a complex pair. Both guesses are then
    half the predicted sum of the two. steps: distances in p from point i - 2 to point i - 1, and from point i
    - 1 to point i.
    """
    k, j = pair
    # Where two real eigenvalues meet and become a pair, each has a square root in p; middle and squared half
    # difference are smooth.
    middle, square, m1, s1 = _half_sum_and_squared_half_difference(track.w[i - 1], track.slope[i - 1], k, j)
    previous_square = square
    if i >= 2:
        middle_0, square_0, m0, s0 = _half_sum_and_squared_half_difference(
            track.w[i - 2], track.slope[i - 2], k, j
        )
        middle = extrapolate_hermite((middle_0, middle), (m0, m1), steps)
        square = extrapolate_hermite((square_0, square), (s0, s1), steps)
    else:
        middle = middle + m1 * steps[1]
        square = square + s1 * steps[1]
    if square * previous_square <= 0 or abs(
        square
    ) < EIGENVALUE_PREDICTION_SETTINGS.undecided_squared_difference_ratio * abs(previous_square):
        return complex(middle, 0.0), complex(middle, 0.0), True
    root = cmath.sqrt(complex(square, 0.0))
    return middle + root, middle - root, False


@compiled
def set_two_guesses(
    w: Complex, pair: tuple[int, int], roots: tuple[complex, complex], guess: Complex
) -> None:
    """Writes `roots` as the guesses for two eigenvalues, so that the guesses are ordered, by real part and
    then by frequency, as the eigenvalues in w are. pair: indices of the two eigenvalues in w and `guess`,
    (m,) each."""
    k, j = pair
    first_root, second_root = roots
    if (first_root - second_root).real < 0 or (first_root - second_root).imag < 0:
        first_root, second_root = second_root, first_root
    first = (w[k] - w[j]).real > 0 or (w[k] - w[j]).imag > 0
    guess[k], guess[j] = (first_root, second_root) if first else (second_root, first_root)


@compiled
def predict_eigenvalues(
    track: FollowedEigenvalues, i: int, p: Array, guess: Complex, partner: NDArray
) -> None:
    """Writes the predicted eigenvalues of point i >= 1 into `guess`, (m,). p: path variable of every point,
    (points,). partner: (m,), filled with -1. If D must show whether eigenvalues k and j > k are real,
    partner[k] = j, and both guesses are half the sum."""
    w = track.w[i - 1]
    slope = track.slope[i - 1]
    conjugate = np.empty(len(w), np.int64)
    find_conjugates(w, conjugate)
    next_step = p[i] - p[i - 1]
    _pair_meeting_eigenvalues(w, slope, next_step, conjugate)
    steps = (p[i - 1] - p[i - 2] if i >= 2 else next_step, next_step)
    partner[:] = -1
    for k in range(len(w)):
        j = conjugate[k]
        if j < 0 and i >= 2:
            values = (track.w[i - 2, k].real, w[k].real)
            slopes = (track.slope[i - 2, k].real, slope[k].real)
            guess[k] = complex(extrapolate_hermite(values, slopes, steps), 0.0)
        elif j < 0:
            guess[k] = complex(w[k].real + slope[k].real * next_step, 0.0)
        elif j > k:
            first_guess, second_guess, undecided = _predict_pair(track, i, (k, j), steps)
            set_two_guesses(w, (k, j), (first_guess, second_guess), guess)
            if undecided:
                partner[k] = j
