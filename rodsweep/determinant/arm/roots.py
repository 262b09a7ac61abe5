"""Refinement of a mesh's eigenvalues to roots of D, for arms without a closed form of D.

The algorithm is that of `rodsweep.determinant.roots`, with D from propagators.
"""

import cmath
import math
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ..newton import MAX_REFINEMENTS, REAL_BELOW
from ..roots import (
    A_ROOT,
    BLURRED,
    CLOSE_ROOTS,
    EXPANSIONS,
    ON_THE_AXIS,
    REFINED_TOGETHER,
    SAME_ROOT,
    Roots,
    sort_descending,
)
from ..value import ROUND_OFF, SECOND_STEP
from .determinant import ArmDeterminant
from .region import Hull
from .value import ROOT_NOISE, ROOT_RESIDUAL

Mask = NDArray[np.bool_]
ROUNDING_OF_CHAIN = 16 * ROUND_OFF
"""Relative error of an eigenvalue from the products of propagators, where minors in the middle of an arm are
large against those at its tip; of 1000 eigenvalues of stepped arms against 19 digits it was 4e-15 at most."""

MOST_ABOVE = 16.0
"""Largest ratio of |w| later to |w| of the roots for which elements are shared: they are at most four times
as many as the roots need, and errors from rounding grow with their number."""


def second_derivative(w: complex, S: float, determinant: ArmDeterminant) -> complex:
    """D'' exp(-S) at w, by a central difference of D'; real for real w."""
    h = SECOND_STEP * abs(w)
    after = determinant.value(w + h)
    before = determinant.value(w - h)
    second = (after.D_w * math.exp(after.S - S) - before.D_w * math.exp(before.S - S)) / (2 * h)
    return complex(second.real, 0.0) if w.imag == 0 else second


def root_error(w: complex, determinant: ArmDeterminant) -> float:
    """Estimated distance from w to the nearest root of D, in 1/tau2, valid near a double root too."""
    D, D_w, S, noise = determinant.value(w)
    e = ROOT_RESIDUAL * abs(D) + ROOT_NOISE * noise
    error = e / max(abs(D_w), 1e-300)
    if error > BLURRED * abs(w):
        # Near a double root e/|D'| is unbounded, but a root of the second-order polynomial is near.
        second = abs(second_derivative(w, S, determinant))
        if abs(D_w) ** 2 < 16 * e * second:
            spread = math.sqrt(2 * e / second)
            error = min(max(error, spread), abs(D_w) / second + spread)
    return error + ROUNDING_OF_CHAIN * abs(w)


def refined(w: complex, determinant: ArmDeterminant, farthest: float = math.inf) -> complex:
    """The eigenvalue near w, by Newton's method until rounding error stops the convergence.

    A real guess gives a real eigenvalue. farthest: length of a first step that is not taken.
    """
    real = w.imag == 0
    # Only steps that at least halve are taken, the first one included.
    last = 2 * farthest
    for _ in range(MAX_REFINEMENTS):
        value = determinant.value(w)
        if value.D_w == 0:
            break
        step = value.D / value.D_w
        if real:
            step = complex(step.real, 0.0)
        if not abs(step) < last / 2:
            break
        last = abs(step)
        w -= step
        if abs(w.imag) <= REAL_BELOW * abs(w):
            w = complex(w.real, 0.0)
    return w


def two_roots(middle: complex, determinant: ArmDeterminant) -> tuple[complex, complex]:
    """The two roots of the Taylor polynomial of D of second order about `middle`.

    For a real `middle` both roots are real or complex conjugates.
    """
    D, D_w, S, _ = determinant.value(middle)
    if middle.imag == 0:
        D = complex(D.real, 0.0)
        D_w = complex(D_w.real, 0.0)
    second = second_derivative(middle, S, determinant)
    if second == 0:
        return middle, middle
    root = cmath.sqrt(D_w * D_w - 2 * D * second)
    return middle + (root - D_w) / second, middle - (root + D_w) / second


def roots(
    raw: Complex, determinant: ArmDeterminant, hull: Hull, most_waves: float, largest: float = 0.0
) -> Roots:
    """Roots of D, refined from those eigenvalues of a mesh that approximate a root.

    raw: eigenvalues of a mesh, complex, shape (n,). most_waves: largest |q| that the mesh resolves. largest:
    |w| at which D will be needed afterwards. Rounding makes infinite eigenvalues finite; these lie outside
    the hull, beyond the mesh or far from every root.
    """
    first = np.where(np.abs(raw.imag) <= REAL_BELOW * np.abs(raw), raw.real + 0j, raw)
    first[~np.isfinite(raw)] = np.inf
    inside = np.array([_inside(w, hull) for w in first.tolist()], dtype=bool)
    wave: Array = np.full(len(raw), math.inf)
    for i in np.flatnonzero(inside).tolist():
        wave[i] = determinant.wave_number(complex(first[i]))
    resolved = inside & (wave <= most_waves)
    _make_elements(determinant, max(map(abs, first[resolved].tolist()), default=0.0), largest)
    error: Array = np.full(len(raw), math.inf)
    length: Array = np.ones(len(raw))
    for i in np.flatnonzero(resolved).tolist():
        error[i] = root_error(complex(first[i]), determinant)
        length[i] = determinant.length(complex(first[i]))
    near = resolved & (error <= CLOSE_ROOTS * length)
    chosen = np.flatnonzero(near)
    start = first[chosen]
    error = error[chosen]
    length = length[chosen]
    # From two close guesses Newton's method may find one root twice, so these are moved apart first.
    w, reach = _separated(start, error, determinant)
    stands = np.isfinite(reach) | (error <= A_ROOT * length)
    _refine(w, start, reach, stands, determinant)
    kept = np.flatnonzero(stands)
    order = np.arange(len(kept))
    sort_descending(w[kept], order)
    kept = kept[order]
    w = w[kept]
    error = np.array([root_error(value, determinant) for value in w.tolist()])
    wave = np.array([determinant.wave_number(value) for value in w.tolist()])
    displacement = np.abs(w - start[kept]) / np.maximum(np.abs(w), length[kept])
    _raise_errors_of_equal_roots(w, error, determinant)
    axis = np.abs(w.real) <= np.maximum(4 * error, ON_THE_AXIS * np.abs(w))
    # An eigenvalue inside the hull that approximates no root is spurious, or hides one that leads.
    ahead = (inside & ~near & (raw.real > (w[0].real if len(w) else -math.inf))).sum()
    return Roots(chosen[kept], w, error, displacement, wave, axis, int(ahead))


def _make_elements(determinant: ArmDeterminant, size: float, largest: float) -> None:
    """Makes elements that serve all |w| up to `size`: the elements for `largest` if it is little more, else
    new ones."""
    if size < largest <= MOST_ABOVE * size:
        with suppress(FloatingPointError):  # too many elements: they are needed later, if at all
            determinant.level(largest)
    determinant.level(size)


def _inside(w: complex, hull: Hull) -> bool:
    """Whether w lies in the box of all eigenvalues with Re >= Re w."""
    if not cmath.isfinite(w):
        return False
    real, imag = hull.box(max(-w.real, 0.0))
    return w.real <= real and abs(w.imag) <= imag


def _separated(w: Complex, error: Array, determinant: ArmDeterminant) -> tuple[Complex, Array]:
    """(w, reach) after moving each pair of eigenvalues closer than its errors to the two roots near it.

    w: (n,). error: (n,). reach: half the distance from the other one of the pair, (n,), inf where an
    eigenvalue is not moved.
    """
    w = w.copy()
    reach = np.full(len(w), math.inf)
    for i in range(len(w)):
        others = [j for j in range(len(w)) if j != i and reach[j] == math.inf]
        if reach[i] < math.inf or not others:
            continue
        partner = min(others, key=lambda j: abs(w[j] - w[i]))
        if abs(w[partner] - w[i]) <= REFINED_TOGETHER * (error[i] + error[partner]):
            for _ in range(EXPANSIONS):
                middle = complex(w[i] + w[partner]) / 2
                if w[partner] == w[i].conjugate() or (w[i].imag == 0 and w[partner].imag == 0):
                    middle = complex(middle.real, 0.0)
                w[i], w[partner] = two_roots(middle, determinant)
            reach[i] = reach[partner] = abs(w[i] - w[partner]) / 2
    return w, reach


def _refine(w: Complex, start: Complex, reach: Array, stands: Mask, determinant: ArmDeterminant) -> None:
    """Refines in place each w that approximates a root; conjugates of refined roots are copied.

    w, start: refined and original eigenvalues, (n,). reach: that of `_separated`, (n,). stands: mask of
    eigenvalues that approximate a root, (n,).
    """
    moved = np.isfinite(reach)
    for i in np.flatnonzero(stands).tolist():
        pair = i > 0 and stands[i - 1] and w[i].imag != 0 and not moved[i - 1] and not moved[i]
        if pair and start[i] == start[i - 1].conjugate():
            w[i] = w[i - 1].conjugate()
        else:
            w[i] = refined(complex(w[i]), determinant, float(reach[i]))


def _raise_errors_of_equal_roots(w: Complex, error: Array, determinant: ArmDeterminant) -> None:
    """Raises the errors of two eigenvalues at the same root to the distance of the next root, 2 |D'/D''|.

    w, error: (n,).
    """
    for i in range(len(w)):
        for j in range(i + 1, len(w)):
            apart = abs(w[i] - w[j])
            if apart <= SAME_ROOT * (error[i] + error[j]):
                value = determinant.value(complex(w[i]))
                second = abs(second_derivative(complex(w[i]), value.S, determinant))
                next_root = 2 * abs(value.D_w) / max(second, 1e-300)
                if apart < next_root / 4:
                    error[i] = max(error[i], next_root)
                    error[j] = max(error[j], next_root)
