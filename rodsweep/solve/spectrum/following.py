"""Eigenvalues followed from point to point of a path: predicted, then corrected by Newton's method on D.

Nothing here proves that they are all, or that one has not become another: that is for the count. What is
promised is that each is a root of D within its error, and that no two are the same.
"""

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Array, Complex
from ...determinant.newton import REAL_BELOW
from ...determinant.parameter_path import determinant_along
from ...determinant.roots import SAME_ROOT, sort_descending, two_roots
from ...determinant.value import ROUND_OFF, TYPICAL_NOISE
from ...model.compiled.compilation import compiled
from ...model.rod import Coefficients
from .prediction import Track, guess_at, mates_of, place_two

MOST_CORRECTIONS = 8
ROUGH = 1e-9
"""Relative error allowed of those that do not lead: they only show where to count."""
SAFE_CURVATURE = 4.0
"""Factor on |D''/(2 D')|, the modulus of the sum of 1/(w - w_j) over the other roots, from the known."""
LAST_STEP = 4.0
"""A step, in units of the rounding error, that ends the corrections."""


class Corrected(NamedTuple):
    """An eigenvalue after a step of Newton's method, dw/dp, the length of the step, the rounding error."""

    w: complex
    slope: complex
    step: float
    blur: float


@compiled
def corrected(w: complex, coefficients: Coefficients, direction: Coefficients) -> Corrected:
    """One step of Newton's method; what is real stays real."""
    D, D_w, D_p, _, noise = determinant_along(w, coefficients, direction)
    size = abs(D_w)
    if not size > 0:
        return Corrected(w, 0j, math.inf, math.inf)
    step, slope = D / D_w, -D_p / D_w
    if w.imag == 0:
        step, slope = complex(step.real, 0.0), complex(slope.real, 0.0)
    return Corrected(w - step, slope, abs(step), TYPICAL_NOISE * noise / size)


@compiled
def crowding_of(w: Complex, k: int) -> float:
    """A generous |D''/(2 D')| at the k-th of the known roots, (m,)."""
    total = 1 / abs(w[k])
    for j in range(len(w)):
        if j != k:
            total += 1 / abs(w[k] - w[j])
    return SAFE_CURVATURE * total


@compiled
def _settled(
    first: Corrected, crowding: float, exact: bool, rod: Coefficients, direction: Coefficients
) -> tuple[Corrected, float]:
    """(the last correction, error): Newton's method until what is left of it, crowding step^2, is small."""
    here = first
    for _ in range(MOST_CORRECTIONS):
        left = crowding * here.step * here.step
        allowed = max(here.blur, ROUND_OFF * abs(here.w)) if exact else ROUGH * abs(here.w)
        if left <= allowed or here.step <= LAST_STEP * here.blur:
            return here, max(here.blur, min(left, here.step))
        here = corrected(here.w, rod, direction)
    return here, math.inf


@compiled
def distinct_roots(w: Complex, error: Array) -> bool:
    """Whether all, (m,), are finite numbers, each with its error, and no two may be the same root."""
    for k in range(len(w)):
        if not (abs(w[k]) < math.inf and error[k] < math.inf):
            return False
        for j in range(k):
            if not abs(w[k] - w[j]) > SAME_ROOT * (error[k] + error[j]):
                return False
    return True


@compiled
def _correct_all(
    track: Track, i: int, guess: Complex, modes: int, rod: Coefficients, direction: Coefficients
) -> bool:
    """Makes roots of the guesses for point i, into the track; whether all became roots, and pairs pairs."""
    w, slope, error, order = track.w[i], track.slope[i], track.error[i], track.order[i]
    m = len(w)
    mate = np.empty(m, np.int64)
    mates_of(guess, mate)
    first = [Corrected(0j, 0j, math.inf, math.inf) for _ in range(m)]
    for k in range(m):
        if guess[k].imag != 0 and mate[k] < 0:
            return False
        if guess[k].imag >= 0:
            first[k] = corrected(guess[k], rod, direction)
            w[k] = first[k].w
            if mate[k] >= 0:
                w[mate[k]] = w[k].conjugate()
    sort_descending(w, order)
    for rank in range(m):
        k = order[rank]
        if guess[k].imag >= 0:
            last, error[k] = _settled(first[k], crowding_of(w, k), rank <= modes, rod, direction)
            w[k], slope[k] = last.w, last.slope
            if mate[k] >= 0:
                if not w[k].imag > REAL_BELOW * abs(w[k]):
                    return False
                j = mate[k]
                w[j], slope[j], error[j] = w[k].conjugate(), slope[k].conjugate(), error[k]
    sort_descending(w, order)
    return distinct_roots(w, error)


@compiled
def follow(track: Track, coefficients: Array, p: Array, direction: Coefficients, modes: int) -> int:
    """How many points, from the first, the eigenvalues can be followed to; fills the track as far.

    track: with w and order of the first point; coefficients, shape (points, 4), and p, (points,): the points'
    rods and path variables; direction: d(F, nu, c2, gamma3)/dp. The leading `modes` get all digits.
    """
    guess = track.w[0].copy()
    decided = np.empty(len(guess), np.int64)
    for i in range(len(p)):
        F, nu, c2, gamma3 = coefficients[i]
        rod = Coefficients(F, nu, c2, gamma3)
        if i > 0:
            guess_at(track, i, p, guess, decided)
            for k in range(len(guess)):
                if decided[k] >= 0:
                    two = (k, decided[k])
                    place_two(track.w[i - 1], two, two_roots(guess[k], rod), guess)
            track.order[i] = track.order[i - 1]
        if not _correct_all(track, i, guess, modes, rod, direction):
            return i
    return len(p)
