"""Refinement of a mesh's eigenvalues to roots of D, for arms without a closed form of D.

The algorithm equals the algorithm of `rodsweep.determinant.roots.roots`, with D from propagators.
"""

import cmath
import math
from collections.abc import Callable
from contextlib import suppress
from itertools import combinations
from typing import NamedTuple, TypeVar

import numpy as np

from ...arrays import Array, Complex
from ..exponents import EXPONENT_SETTINGS
from ..roots.roots import Roots
from ..roots.settings import ROOT_NEWTON_SETTINGS, ROOT_SETTINGS
from .determinant import ArmDeterminant
from .hull.region import EigenvalueHull
from .local_waves import mean_wave_numbers_and_w_scales
from .newton import (
    ARM_ROOT_SETTINGS,
    refine_eigenvalue_and_error,
    root_error,
    second_derivative,
    taylor_parabola_roots,
)

T = TypeVar("T")


def refine_mesh_eigenvalues(
    raw: Complex, determinant: ArmDeterminant, hull: EigenvalueHull, max_q: float, largest: float = 0.0
) -> Roots:
    """Roots of an arm's D refined from those eigenvalues `raw` of a mesh, (n,), that approximate a root of D.

    max_q: largest wave number |q| that the mesh resolves. largest: |w| at which D will be needed
    afterwards. Infinite eigenvalues, which rounding makes finite, are dropped: they lie outside the hull,
    have too large a |q|, or are far from every root.
    """
    first = [
        w.real + 0j if abs(w.imag) <= ROOT_NEWTON_SETTINGS.real_tolerance * abs(w) else w
        for w in raw.tolist()
    ]
    inside = [i for i, w in enumerate(first) if _is_in_eigenvalue_box(w, hull)]
    waves, w_scales = mean_wave_numbers_and_w_scales(
        np.array([first[i] for i in inside], complex), determinant.samples
    )
    scale = dict(zip(inside, w_scales.tolist(), strict=True))
    resolved = [i for i, number in zip(inside, waves.tolist(), strict=True) if number <= max_q]
    start = [first[i] for i in resolved]
    _prepare_elements(determinant, max(map(abs, start), default=0.0), largest)
    errors = dict(zip(resolved, _values_at_roots(start, lambda w: root_error(w, determinant)), strict=True))
    chosen = [i for i in resolved if errors[i] <= ROOT_SETTINGS.max_pair_correction * scale[i]]
    close = [errors[i] for i in chosen]
    # From two close guesses Newton's method may find one root twice, so these are moved apart first.
    moved, reach = _separate_close_roots([first[i] for i in chosen], close, determinant)
    stands = [
        k
        for k, i in enumerate(chosen)
        if reach[k] < math.inf or close[k] <= ROOT_SETTINGS.max_correction * scale[i]
    ]
    found = _refine_guesses([(moved[k], reach[k]) for k in stands], determinant)
    found.sort(key=lambda root: (-root.w.real, -root.w.imag))
    kept = np.array([chosen[stands[root.guess_index]] for root in found], np.int64)
    w: Complex = np.array([root.w for root in found], complex)
    wave = mean_wave_numbers_and_w_scales(w, determinant.samples)[0]
    error = _errors_of_located_roots(found, determinant)
    length: Array = np.array([scale[i] for i in kept.tolist()], float)
    displacement = np.abs(w - np.array(first, complex)[kept]) / np.maximum(np.abs(w), length)
    axis = np.abs(w.real) <= np.maximum(
        ROOT_SETTINGS.axis_tolerance_in_errors * error, ROOT_SETTINGS.axis_tolerance * np.abs(w)
    )
    leader = w[0].real if len(w) else -math.inf
    # An eigenvalue inside the hull that approximates no root is spurious, or hides one that leads.
    ahead = sum(raw[i].real > leader for i in inside if i not in chosen)
    return Roots(kept, w, error, displacement, wave, axis, ahead)


def _values_at_roots(w: list[complex], function: Callable[[complex], T]) -> list[T]:
    """The values of `function` at all w. Two successive conjugates have equal values, computed once."""
    values: list[T] = []
    for k, value in enumerate(w):
        pair = k > 0 and value == w[k - 1].conjugate()
        values.append(values[-1] if pair else function(value))
    return values


def _prepare_elements(determinant: ArmDeterminant, size: float, largest: float) -> None:
    """Makes elements for all |w| up to `largest` if `largest` is at most `max_w_ratio` times `size`, else for
    all |w| up to `size`."""
    if size < largest <= ARM_ROOT_SETTINGS.max_w_ratio * size:
        with suppress(FloatingPointError):  # too many elements: they are needed later, if at all
            determinant.propagators_for(largest)
    determinant.propagators_for(size)


def _is_in_eigenvalue_box(w: complex, hull: EigenvalueHull) -> bool:
    """Whether w is finite and lies in the box that contains all eigenvalues with real parts >= Re w."""
    if not cmath.isfinite(w):
        return False
    real, imag = hull.box(max(-w.real, 0.0))
    return w.real <= real and abs(w.imag) <= imag


def _separate_close_roots(
    w: list[complex], error: list[float], determinant: ArmDeterminant
) -> tuple[list[complex], list[float]]:
    """Returns (w, reach), with every two eigenvalues closer than their errors moved to two roots of D.

    error: errors of w. reach: half the distance of an eigenvalue from its partner; inf if it was not moved.
    """
    w = w.copy()
    reach = [math.inf] * len(w)
    each = zip(w, error, strict=True)
    if not any(
        abs(a - b) <= ROOT_SETTINGS.pair_distance * (e + f) for (a, e), (b, f) in combinations(each, 2)
    ):
        return w, reach
    for i in range(len(w)):
        others = [j for j in range(len(w)) if j != i and reach[j] == math.inf]
        if reach[i] < math.inf or not others:
            continue
        partner = min(others, key=lambda j: abs(w[j] - w[i]))
        if abs(w[partner] - w[i]) <= ROOT_SETTINGS.pair_distance * (error[i] + error[partner]):
            for _ in range(ROOT_SETTINGS.parabolas_per_pair):
                middle = (w[i] + w[partner]) / 2
                if w[partner] == w[i].conjugate() or (w[i].imag == 0 and w[partner].imag == 0):
                    middle = complex(middle.real, 0.0)
                w[i], w[partner] = taylor_parabola_roots(middle, determinant)
            reach[i] = reach[partner] = abs(w[i] - w[partner]) / 2
    return w, reach


class _LocatedRoot(NamedTuple):
    """A root w of D with its error; guess_index: index of the guess from which it was refined."""

    w: complex
    error: float
    guess_index: int


def _refine_guesses(guesses: list[tuple[complex, float]], determinant: ArmDeterminant) -> list[_LocatedRoot]:
    """The root of D near each guess (w, reach), a pair of results of `_separate_close_roots`. For conjugate
    guesses only the first is refined.
    """
    found: list[_LocatedRoot] = []
    for place, (w, reach) in enumerate(guesses):
        if place > 0 and w.imag != 0 and w == guesses[place - 1][0].conjugate():
            found.append(_LocatedRoot(found[-1].w.conjugate(), found[-1].error, place))
        else:
            found.append(_LocatedRoot(*refine_eigenvalue_and_error(w, determinant, reach), place))
    return found


def _errors_of_located_roots(found: list[_LocatedRoot], determinant: ArmDeterminant) -> Array:
    """Errors of the roots `found`, (n,). For two entries that are the same root of D, the error is at least
    the distance 2 |D'/D''| of the next root."""
    error = [root.error for root in found]
    for i, one in enumerate(found):
        for j in range(i + 1, len(found)):
            apart = abs(one.w - found[j].w)
            if apart <= ROOT_SETTINGS.same_root_distance * (error[i] + error[j]):
                value = determinant.value(one.w)
                second = abs(second_derivative(one.w, value.S, determinant))
                next_root = 2 * abs(value.D_w) / max(second, EXPONENT_SETTINGS.least_divisor)
                if apart < ROOT_SETTINGS.same_root_fraction * next_root:
                    error[i] = max(error[i], next_root)
                    error[j] = max(error[j], next_root)
    return np.array(error, float)
