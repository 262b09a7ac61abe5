"""From the eigenvalues of a mesh to roots of D: a coarse mesh finds them, Newton's method on D refines them.

A mesh has to be only as fine as Newton's method needs, so that the accuracy of an eigenvalue is that of D
and costs some evaluations of it. Two eigenvalues that a mesh leaves closer to each other than its errors
are refined together first, by the quadratic that D is about their middle: it knows whether they are real
or a pair, which Newton's method from the wrong kind would never find out.
"""

import cmath
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Complex
from ..model.compiled.compilation import compiled
from ..model.rod import Coefficients
from .certificate.box import box_of
from .newton import REAL_BELOW, refined
from .value import TYPICAL_NOISE, distance_to_next, newton_correction, scaled_determinant, second_derivative

A_ROOT = 1e-2
"""Newton correction, in units of the length over which D changes, that still stands for a root of D."""
CLOSE_ROOTS = 0.1
"""Newton correction, in the same unit, for eigenvalues that are refined in pairs."""
REFINED_TOGETHER = 4.0
"""Distance of two eigenvalues, in units of their corrections, within which they are refined together."""
ON_THE_AXIS = 1e-13
"""Relative real part below which an eigenvalue is on the imaginary axis whatever its error estimate."""
BLURRED = 1e-11
"""Relative Newton correction beyond which a double root may be the reason."""
SAME_ROOT = 4.0
"""Distance of two roots, in units of their errors, below which both may be one root."""


class Roots(NamedTuple):
    """Eigenvalues of a mesh refined to roots of D, sorted by descending real part, then frequency.

    chosen: index of each in what the mesh gave; w: complex; error: how far the root may lie; displacement:
    how far off the mesh was, in units of |w| or of the length over which D changes, whichever is larger;
    wave: largest |q|; on_the_axis: whether it lies on the imaginary axis within its error; all of shape (k,).
    ahead: eigenvalues of the mesh right of all these that stand for no root, though they lie where one may.
    """

    chosen: NDArray[np.int64]
    w: Complex
    error: Array
    displacement: Array
    wave: Array
    on_the_axis: NDArray[np.bool_]
    ahead: int


@compiled
def root_error(w: complex, coefficients: Coefficients) -> tuple[float, float, float]:
    """(how far a root of D lies, length, wave number) at w: `newton_correction`, also next to a double root.

    With e the larger of |D| and its rounding, Newton's e/|D'| holds while |D'|^2 is large against e |D''|.
    Nearer to a double root the two cannot be told apart within sqrt(2 e/|D''|) of their middle, which is
    |D'/D''| away.
    """
    error, length, wave = newton_correction(w, coefficients)
    if error > BLURRED * abs(w):
        D, D1, S, noise = scaled_determinant(w, coefficients)
        e, second = max(abs(D), TYPICAL_NOISE * noise), abs(second_derivative(w, S, coefficients))
        if abs(D1) ** 2 < 16 * e * second:
            spread = math.sqrt(2 * e / second)
            error = min(max(error, spread), abs(D1) / second + spread)
    return error, length, wave


@compiled
def two_roots(middle: complex, coefficients: Coefficients) -> tuple[complex, complex]:
    """The two roots near `middle` by the quadratic that D is about it; near a real one two real or a pair."""
    D, D1, S, _ = scaled_determinant(middle, coefficients)
    if middle.imag == 0:
        D, D1 = complex(D.real, 0.0), complex(D1.real, 0.0)
    D2 = second_derivative(middle, S, coefficients)
    if D2 == 0:
        return middle, middle
    root = cmath.sqrt(D1 * D1 - 2 * D * D2)
    return middle + (root - D1) / D2, middle - (root + D1) / D2


@compiled
def _separate(w: Complex, error: Array, coefficients: Coefficients) -> NDArray:
    """Moves pairs closer than their errors to the two roots near them; returns a mask of moved roots."""
    moved = np.zeros(len(w), dtype=np.bool_)
    for i in range(len(w)):
        if moved[i]:
            continue
        partner, least = -1, math.inf
        for j in range(len(w)):
            if j != i and not moved[j] and abs(w[j] - w[i]) < least:
                partner, least = j, abs(w[j] - w[i])
        if partner >= 0 and least <= REFINED_TOGETHER * (error[i] + error[partner]):
            middle = (w[i] + w[partner]) / 2
            if w[partner] == w[i].conjugate() or (w[i].imag == 0 and w[partner].imag == 0):
                middle = complex(middle.real, 0.0)
            w[i], w[partner] = two_roots(middle, coefficients)
            moved[i] = moved[partner] = True
    return moved


@compiled
def _descending(w: Complex) -> NDArray:
    """Indices that sort by descending real part, then descending frequency."""
    order = np.arange(len(w))
    sort_descending(w, order)
    return order


@compiled
def sort_descending(w: Complex, order: NDArray) -> None:
    """Sorts indices, shape (n,), by descending real part, then frequency; sorted ones cost least."""
    for m in range(1, len(order)):
        i, at = order[m], m
        while at > 0:
            j = order[at - 1]
            if w[j].real > w[i].real or (w[j].real == w[i].real and w[j].imag >= w[i].imag):
                break
            order[at] = j
            at -= 1
        order[at] = i


@compiled
def roots(raw: Complex, coefficients: Coefficients, amplification: float, most_waves: float) -> Roots:
    """Eigenvalues of a mesh that approximate roots of D, refined to these roots.

    raw: eigenvalues of a mesh, complex, shape (n,). amplification: the root of
    `rodsweep.determinant.certificate.box.squared_amplification`; most_waves: |q| that the mesh can stand for.
    Rounding makes infinite eigenvalues finite: they lie outside the box or beyond the mesh, or have no root
    near.
    """
    error: Array = np.empty(len(raw))
    length: Array = np.empty(len(raw))
    wave: Array = np.empty(len(raw))
    near, inside = np.zeros(len(raw), dtype=np.bool_), np.zeros(len(raw), dtype=np.bool_)
    first = raw.copy()
    for i in range(len(raw)):
        if not (math.isfinite(raw[i].real) and math.isfinite(raw[i].imag)):
            continue
        if abs(raw[i].imag) <= REAL_BELOW * abs(raw[i]):
            first[i] = complex(raw[i].real, 0.0)
        error[i], length[i], wave[i] = root_error(first[i], coefficients)
        real, imag = box_of(amplification, max(-first[i].real, 0.0))
        inside[i] = first[i].real <= real and abs(first[i].imag) <= imag
        near[i] = inside[i] and wave[i] <= most_waves and error[i] <= CLOSE_ROOTS * length[i]
    chosen = np.flatnonzero(near)
    first, error, length, wave = first[chosen], error[chosen], length[chosen], wave[chosen]
    w, stands = _refined_all(first, error, wave, error <= A_ROOT * length, coefficients)
    order = np.flatnonzero(stands)
    order = order[_descending(w[order])]
    displacement = np.abs(w[order] - first[order]) / np.maximum(np.abs(w[order]), length[order])
    chosen, w, error, wave = chosen[order], w[order], error[order], wave[order]
    _tell_apart(w, error, coefficients)
    axis = np.abs(w.real) <= np.maximum(4 * error, ON_THE_AXIS * np.abs(w))
    ahead = (inside & ~near & (raw.real > (w[0].real if len(w) else -math.inf))).sum()
    return Roots(chosen, w, error, displacement, wave, axis, ahead)


@compiled
def _refined_all(
    first: Complex, error: Array, wave: Array, near: NDArray[np.bool_], coefficients: Coefficients
) -> tuple[Complex, NDArray[np.bool_]]:
    """(roots near the first guesses, mask of true roots); sets error and wave at the roots."""
    w = first.copy()
    moved = _separate(w, error, coefficients)
    stands = moved | near
    for i in range(len(w)):
        if not stands[i]:
            continue
        single = i > 0 and w[i].imag != 0 and not moved[i - 1] and not moved[i]
        if single and w[i] == first[i - 1].conjugate():
            w[i], error[i], wave[i] = w[i - 1].conjugate(), error[i - 1], wave[i - 1]
        else:
            w[i] = refined(w[i], coefficients)
            error[i], _, wave[i] = root_error(w[i], coefficients)
    return w, stands


@compiled
def _tell_apart(w: Complex, error: Array, coefficients: Coefficients) -> None:
    """Raises the errors of two that are the same root to the distance of the next one, 2 |D'/D''|."""
    for i in range(len(w)):
        for j in range(i + 1, len(w)):
            apart = abs(w[i] - w[j])
            if apart <= SAME_ROOT * (error[i] + error[j]):
                next_root = distance_to_next(w[i], coefficients)
                if apart < next_root / 4:
                    error[i] = max(error[i], next_root)
                    error[j] = max(error[j], next_root)
