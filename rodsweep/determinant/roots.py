"""From the eigenvalues of a mesh to roots of D: a coarse mesh finds them, Newton's method on D refines them.

A mesh has to be only as fine as Newton's method needs, so that the accuracy of an eigenvalue is that of D
and costs some evaluations of it. Two eigenvalues that a mesh leaves closer to each other than its errors
are refined together first, by the quadratic that D is about their middle: it knows whether they are real
or a pair, which Newton's method from the wrong kind would never find out.
"""

import cmath
import math

import numpy as np
from numpy.typing import NDArray

from ..model.compilation import compiled
from ..model.rod import Coefficients
from .box import box_of
from .value import TYPICAL_NOISE, newton_correction, scaled_determinant

A_ROOT = 1e-2
"""Newton correction, in units of the length over which D changes, that still stands for a root of D."""
CLOSE_ROOTS = 0.1
"""The same for one of two that are refined together."""
CLOSE = 4.0
"""Distance of two eigenvalues, in units of their corrections, within which they are refined together."""
REAL_BELOW = 1e-14
"""Relative imaginary part below which an eigenvalue is real: what rounding leaves of zero."""
ON_THE_AXIS = 1e-13
"""Relative real part below which an eigenvalue is on the imaginary axis whatever its error estimate."""
MOST_STEPS = 12
DIFFERENCE = 1e-4
"""Relative step of the difference that gives D''."""
BLURRED = 1e-11
"""Relative Newton correction beyond which a double root may be the reason."""
SAME = 4.0
"""Distance of two roots, in units of their errors, within which they may be the same."""


@compiled
def _second(w: complex, S: float, coefficients: Coefficients) -> complex:
    """D'' exp(-S) at w by a difference of D'."""
    h = DIFFERENCE * abs(w)
    _, after, S_after, _ = scaled_determinant(w + h, coefficients)
    _, before, S_before, _ = scaled_determinant(w - h, coefficients)
    second = (after * math.exp(S_after - S) - before * math.exp(S_before - S)) / (2 * h)
    return complex(second.real, 0.0) if w.imag == 0 else second


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
        e, second = max(abs(D), TYPICAL_NOISE * noise), abs(_second(w, S, coefficients))
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
    D2 = _second(middle, S, coefficients)
    if D2 == 0:
        return middle, middle
    root = cmath.sqrt(D1 * D1 - 2 * D * D2)
    return middle + (root - D1) / D2, middle - (root + D1) / D2


@compiled
def refined(w: complex, coefficients: Coefficients) -> complex:
    """The root of D near w by Newton's method, until rounding keeps the steps from getting smaller."""
    real = w.imag == 0
    last = math.inf
    for _ in range(MOST_STEPS):
        D, D1, _, _ = scaled_determinant(w, coefficients)
        if D1 == 0:
            break
        step = D / D1
        if real:
            step = complex(step.real, 0.0)
        if not abs(step) < last / 2:
            break
        last = abs(step)
        w -= step
        if abs(w.imag) <= REAL_BELOW * abs(w):
            w = complex(w.real, 0.0)
    return w


@compiled
def _separate(w: NDArray[np.complex128], error: NDArray[np.float64], coefficients: Coefficients) -> NDArray:
    """Moves those that are closer than their errors to the two roots near them; says which it moved."""
    moved = np.zeros(len(w), dtype=np.bool_)
    for i in range(len(w)):
        if moved[i]:
            continue
        partner, least = -1, math.inf
        for j in range(len(w)):
            if j != i and not moved[j] and abs(w[j] - w[i]) < least:
                partner, least = j, abs(w[j] - w[i])
        if partner >= 0 and least <= CLOSE * (error[i] + error[partner]):
            middle = (w[i] + w[partner]) / 2
            if w[partner] == w[i].conjugate() or (w[i].imag == 0 and w[partner].imag == 0):
                middle = complex(middle.real, 0.0)
            w[i], w[partner] = two_roots(middle, coefficients)
            moved[i] = moved[partner] = True
    return moved


@compiled
def _descending(w: NDArray[np.complex128]) -> NDArray:
    """Indices that sort by descending real part, then descending frequency."""
    order = np.arange(len(w))
    for m in range(1, len(w)):
        i, at = order[m], m
        while at > 0:
            j = order[at - 1]
            if w[j].real > w[i].real or (w[j].real == w[i].real and w[j].imag >= w[i].imag):
                break
            order[at] = j
            at -= 1
        order[at] = i
    return order


@compiled
def roots(
    raw: NDArray[np.complex128], coefficients: Coefficients, amplification: float, most_waves: float
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray, NDArray, int]:
    """(indices, w, error, displacement, wave number, on the axis) of what stands for a root of D, sorted.

    And the number of those that do not, although they lie in the box and right of all that do.

    raw: eigenvalues of a mesh, complex, shape (n,). amplification: the root of
    `rodsweep.determinant.box.squared_amplification`; most_waves: |q| that the mesh can stand for.
    displacement: in units of |w| or of the length over which D changes, whichever is larger. Rounding
    makes infinite eigenvalues finite: they lie outside the box or beyond the mesh, or have no root near.
    """
    index: NDArray[np.int64] = np.empty(len(raw), dtype=np.int64)
    first: NDArray[np.complex128] = np.empty(len(raw), dtype=np.complex128)
    error: NDArray[np.float64] = np.empty(len(raw))
    length: NDArray[np.float64] = np.empty(len(raw))
    wave: NDArray[np.float64] = np.empty(len(raw))
    n, doubtful = 0, []
    for i in range(len(raw)):
        w = raw[i]
        if not (math.isfinite(w.real) and math.isfinite(w.imag)):
            continue
        if abs(w.imag) <= REAL_BELOW * abs(w):
            w = complex(w.real, 0.0)
        error[n], length[n], wave[n] = root_error(w, coefficients)
        real, imag = box_of(amplification, max(-w.real, 0.0))
        inside = w.real <= real and abs(w.imag) <= imag
        if inside and wave[n] <= most_waves and error[n] <= CLOSE_ROOTS * length[n]:
            index[n], first[n] = i, w
            n += 1
        elif inside:
            doubtful.append(w.real)
    index, first, error, length, wave = index[:n], first[:n], error[:n], length[:n], wave[:n]
    w = first.copy()
    moved = _separate(w, error, coefficients)
    stands = moved | (error <= A_ROOT * length)
    for i in range(n):
        if not stands[i]:
            continue
        single = i > 0 and w[i].imag != 0 and not moved[i - 1] and not moved[i]
        if single and w[i] == first[i - 1].conjugate():
            w[i], error[i], wave[i] = w[i - 1].conjugate(), error[i - 1], wave[i - 1]
        else:
            w[i] = refined(w[i], coefficients)
            error[i], _, wave[i] = root_error(w[i], coefficients)
    order = np.flatnonzero(stands)
    order = order[_descending(w[order])]
    displacement = np.abs(w[order] - first[order]) / np.maximum(np.abs(w[order]), length[order])
    index, w, error, wave = index[order], w[order], error[order], wave[order]
    _tell_apart(w, error, coefficients)
    axis = np.abs(w.real) <= np.maximum(4 * error, ON_THE_AXIS * np.abs(w))
    first_real = w[0].real if len(w) else -math.inf
    ahead = 0
    for real_part in doubtful:
        ahead += real_part > first_real
    return index, w, error, displacement, wave, axis, ahead


@compiled
def _tell_apart(w: NDArray[np.complex128], error: NDArray[np.float64], coefficients: Coefficients) -> None:
    """Raises the errors of two that are the same root to the distance of the next one, 2 |D'/D''|."""
    for i in range(len(w)):
        for j in range(i + 1, len(w)):
            apart = abs(w[i] - w[j])
            if apart <= SAME * (error[i] + error[j]):
                _, D1, S, _ = scaled_determinant(w[i], coefficients)
                next_root = 2 * abs(D1) / max(abs(_second(w[i], S, coefficients)), 1e-300)
                if apart < next_root / 4:
                    error[i] = max(error[i], next_root)
                    error[j] = max(error[j], next_root)


@compiled
def largest(part: NDArray[np.float64], whole: NDArray[np.complex128], modes: int) -> float:
    """The largest part/|whole| over the first modes."""
    worst = 0.0
    for i in range(modes):
        worst = max(worst, part[i] / abs(whole[i]))
    return worst
