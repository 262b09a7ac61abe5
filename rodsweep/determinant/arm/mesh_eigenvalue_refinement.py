"""Refinement of a mesh's eigenvalues to roots of D, for arms without a closed form of D.

The algorithm equals the algorithm of `rodsweep.determinant.roots.roots`, with D from propagators.
"""

import cmath
import math
from contextlib import suppress
from itertools import combinations
from typing import NamedTuple

import numpy as np

from ...arrays import Array, Complex, list_of
from ...model.dispersion import local_coefficients_at_ends, local_wave_numbers
from ..exponents import EXPONENT_SETTINGS
from ..roots.roots import RootsOfD
from ..roots.settings import ROOT_NEWTON_SETTINGS, ROOT_SETTINGS
from .determinant import ArmDeterminant
from .hull.region import EigenvalueHull
from .local_waves import mean_wave_numbers_and_w_scales
from .newton import (
    ARM_ROOT_SETTINGS,
    refine_eigenvalues_and_errors,
    root_errors,
    second_derivative,
    taylor_parabola_roots,
)

UNRESOLVED_END_WAVE_NUMBERS: Array = np.full(2, -math.inf)
"""Default of `max_end_q`, (2,): no wave number is resolved at an end of the arm beyond what `max_q`, the
bound of the mean wave number, allows."""


def refine_mesh_eigenvalues(
    mesh_w: Complex,
    determinant: ArmDeterminant,
    hull: EigenvalueHull,
    max_q: float,
    largest_w: float = 0.0,
    max_end_q: Array = UNRESOLVED_END_WAVE_NUMBERS,
) -> RootsOfD:
    """Roots of an arm's D, refined from the eigenvalues in `mesh_w`, (n,), that approximate a root
    of D.

    mesh_w: eigenvalues of a mesh. max_q: largest wave number |q|, averaged along the arm, that the mesh
    resolves. largest_w: |w| at which D will be needed afterwards. max_end_q: largest |q| that the elements at
    the clamp and at the tip resolve, (2,); by default none. Infinite eigenvalues, which rounding makes
    finite, are dropped: they lie outside the hull, have too large a |q|, or are far from every root.
    """
    guesses = _guesses_in_box(mesh_w, determinant, hull)
    resolved = _resolved_guesses(guesses, determinant, max_q, max_end_q)
    _prepare_elements(determinant, max((abs(guess.w) for guess in resolved), default=0.0), largest_w)
    errors = list_of(root_errors([guess.w for guess in resolved], determinant))
    max_ratio = ROOT_SETTINGS.max_pair_correction_over_w_scale
    near = [(guess, e) for guess, e in zip(resolved, errors, strict=True) if e <= max_ratio * guess.w_scale]
    # From two close guesses Newton's method may find one root twice, so these are moved apart first.
    near_w, half_distances = _separated_close_roots(
        [guess.w for guess, _ in near], [error for _, error in near], determinant
    )
    refined = [
        k
        for k, (guess, error) in enumerate(near)
        if half_distances[k] < math.inf
        or error <= ROOT_SETTINGS.max_newton_correction_over_w_scale * guess.w_scale
    ]
    located = _refine_guesses([(near_w[k], half_distances[k]) for k in refined], determinant)
    located.sort(key=lambda root: (-root.w.real, -root.w.imag))
    leading_growth = located[0].w.real if located else -math.inf
    near_indices = {guess.mesh_eigenvalue_index for guess, _ in near}
    # An eigenvalue inside the hull that approximates no root is spurious, or hides one that leads.
    spurious_count = sum(
        guess.w.real > leading_growth for guess in guesses if guess.mesh_eigenvalue_index not in near_indices
    )
    guesses_of_roots = [near[refined[root.guess_index]][0] for root in located]
    return _roots_with_errors(located, guesses_of_roots, determinant, spurious_count)


class _Guess(NamedTuple):
    """Eigenvalue w of a mesh in the a-priori box, and its index in the list of eigenvalues. mean_wave_number:
    mean of |q| along the arm. w_scale: change of w over which an exponent of D changes by about one."""

    mesh_eigenvalue_index: int
    """Index of the eigenvalue in the list of the mesh's eigenvalues."""
    w: complex
    mean_wave_number: float
    w_scale: float


def _guesses_in_box(mesh_w: Complex, determinant: ArmDeterminant, hull: EigenvalueHull) -> list[_Guess]:
    """The eigenvalues `mesh_w` of a mesh, (n,), that lie in the a-priori box; real where nearly real."""
    tolerance = ROOT_NEWTON_SETTINGS.real_axis_tolerance
    w = [w.real + 0j if abs(w.imag) <= tolerance * abs(w) else w for w in list_of(mesh_w)]
    in_box = [i for i, value in enumerate(w) if _is_in_eigenvalue_box(value, hull)]
    w_in_box = [w[i] for i in in_box]
    scales = list_of(mean_wave_numbers_and_w_scales(np.array(w_in_box, complex), determinant.samples))
    return [_Guess(*values) for values in zip(in_box, w_in_box, *scales, strict=True)]


def _resolved_guesses(
    guesses: list[_Guess], determinant: ArmDeterminant, max_q: float, max_end_q: Array
) -> list[_Guess]:
    """The guesses that the mesh resolves: either the mean of |q| along the arm is at most `max_q`, or the
    wave number at the clamp or at the tip, where an eigenfunction may be confined, is at most max_end_q[0] or
    max_end_q[1]."""
    rod = determinant.rod
    resolved = []
    for guess in guesses:
        is_resolved = guess.mean_wave_number <= max_q
        if not is_resolved:
            end_wave_numbers = local_wave_numbers(guess.w, float(rod.F), local_coefficients_at_ends(rod))
            is_resolved = bool((end_wave_numbers <= max_end_q).any())
        if is_resolved:
            resolved.append(guess)
    return resolved


def _roots_with_errors(
    located: "list[_LocatedRoot]",
    guesses: list[_Guess],
    determinant: ArmDeterminant,
    unmatched_mesh_eigenvalue_count: int,
) -> RootsOfD:
    """The `RootsOfD` of the roots `located`. guesses[i]: the guess from which located[i] was refined.
    unmatched_mesh_eigenvalue_count: as in `RootsOfD`."""
    errors = _errors_of_located_roots(located, determinant)
    # For so few numbers Python is faster than NumPy.
    displacement = [
        abs(root.w - guess.w) / max(abs(root.w), guess.w_scale)
        for root, guess in zip(located, guesses, strict=True)
    ]
    is_imaginary = [
        abs(root.w.real)
        <= max(
            ROOT_SETTINGS.imaginary_axis_tolerance_in_errors * error,
            ROOT_SETTINGS.imaginary_axis_tolerance * abs(root.w),
        )
        for root, error in zip(located, errors, strict=True)
    ]
    return RootsOfD(
        mesh_indices=np.array([guess.mesh_eigenvalue_index for guess in guesses], np.int64),
        w=np.array([root.w for root in located], complex),
        error=np.array(errors, float),
        relative_mesh_displacement=np.array(displacement, float),
        wave_number=np.array([guess.mean_wave_number for guess in guesses], float),
        is_imaginary=np.array(is_imaginary, bool),
        unmatched_mesh_eigenvalue_count=unmatched_mesh_eigenvalue_count,
    )


def _prepare_elements(determinant: ArmDeterminant, needed_w: float, later_w: float) -> None:
    """Prepares the propagators for all |w| up to `later_w`, if `later_w` is at most `max_later_w_over_root_w`
    times `needed_w`; otherwise for all |w| up to `needed_w`."""
    if needed_w < later_w <= ARM_ROOT_SETTINGS.max_later_w_over_root_w * needed_w:
        with suppress(FloatingPointError):  # too many elements: they are needed later, if at all
            determinant.propagators_for(later_w)
    determinant.propagators_for(needed_w)


def _is_in_eigenvalue_box(w: complex, hull: EigenvalueHull) -> bool:
    """Whether w is finite and lies in the box that contains all eigenvalues with real parts >= Re w."""
    if not cmath.isfinite(w):
        return False
    max_real, max_imag = hull.box(max(-w.real, 0.0))
    return w.real <= max_real and abs(w.imag) <= max_imag


def _separated_close_roots(
    w: list[complex], errors: list[float], determinant: ArmDeterminant
) -> tuple[list[complex], list[float]]:
    """Returns (w, half_distance). w: the eigenvalues; every pair closer than `max_pair_distance_in_errors`
    times the sum of its `errors` is replaced by two estimates of roots of D. half_distance: for each
    eigenvalue, half the new distance from its partner; inf if the eigenvalue was not moved."""
    w = w.copy()
    half_distance = [math.inf] * len(w)
    eigenvalues_and_errors = zip(w, errors, strict=True)
    if not any(
        abs(a - b) <= ROOT_SETTINGS.max_pair_distance_in_errors * (e + f)
        for (a, e), (b, f) in combinations(eigenvalues_and_errors, 2)
    ):
        return w, half_distance
    for i in range(len(w)):
        unpaired = [j for j in range(len(w)) if j != i and half_distance[j] == math.inf]
        if half_distance[i] < math.inf or not unpaired:
            continue
        partner = min(unpaired, key=lambda j: abs(w[j] - w[i]))
        if abs(w[partner] - w[i]) <= ROOT_SETTINGS.max_pair_distance_in_errors * (
            errors[i] + errors[partner]
        ):
            for _ in range(ROOT_SETTINGS.successive_parabolas_per_pair):
                middle = (w[i] + w[partner]) / 2
                # The middle of a real or conjugate pair is real, and rounding must not move it off the axis.
                if w[partner] == w[i].conjugate() or (w[i].imag == 0 and w[partner].imag == 0):
                    middle = complex(middle.real, 0.0)
                w[i], w[partner] = taylor_parabola_roots(middle, determinant)
            half_distance[i] = half_distance[partner] = abs(w[i] - w[partner]) / 2
    return w, half_distance


class _LocatedRoot(NamedTuple):
    """A root w of D with its error; guess_index: index of the guess from which it was refined."""

    w: complex
    error: float
    guess_index: int


def _refine_guesses(guesses: list[tuple[complex, float]], determinant: ArmDeterminant) -> list[_LocatedRoot]:
    """The root of D near each of `guesses`, a pair (w, half_distance) of corresponding entries of the result
    of `_separated_close_roots`. For conjugate guesses only the first is refined."""
    is_conjugate = [
        k > 0 and w.imag != 0 and w == guesses[k - 1][0].conjugate() for k, (w, _) in enumerate(guesses)
    ]
    refined = [guess for guess, skipped in zip(guesses, is_conjugate, strict=True) if not skipped]
    results = iter(
        refine_eigenvalues_and_errors([w for w, _ in refined], determinant, [step for _, step in refined])
    )
    roots: list[_LocatedRoot] = []
    for k, skipped in enumerate(is_conjugate):
        if skipped:
            roots.append(_LocatedRoot(roots[-1].w.conjugate(), roots[-1].error, k))
        else:
            roots.append(_LocatedRoot(*next(results), k))
    return roots


def _errors_of_located_roots(roots: list[_LocatedRoot], determinant: ArmDeterminant) -> list[float]:
    """Errors of the roots `roots`. For two entries that are the same root of D, the error is at least
    the distance 2 |D'/D''| of the next root."""
    errors = [root.error for root in roots]
    for i, first_root in enumerate(roots):
        for j in range(i + 1, len(roots)):
            distance = abs(first_root.w - roots[j].w)
            if distance <= ROOT_SETTINGS.same_root_distance_in_errors * (errors[i] + errors[j]):
                value = determinant.value(first_root.w)
                D_ww = abs(second_derivative(first_root.w, value.log_scale, determinant))
                next_root = 2 * abs(value.D_w) / max(D_ww, EXPONENT_SETTINGS.min_divisor)
                if distance < ROOT_SETTINGS.same_root_fraction_of_next_distance * next_root:
                    errors[i] = max(errors[i], next_root)
                    errors[j] = max(errors[j], next_root)
    return errors
