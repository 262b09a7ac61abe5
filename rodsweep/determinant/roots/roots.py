"""Refinement of a mesh's eigenvalues to roots of D by Newton's method, for uniform rods.

The mesh has to be only as fine as Newton's method needs. The accuracy of an eigenvalue is then the accuracy
of D, at the cost of a few evaluations of D. Two eigenvalues closer than the errors of the mesh are first
moved to the roots of the quadratic Taylor polynomial of D about their middle. These roots are real or complex
as the eigenvalues are; Newton's method from two real guesses would not converge to a complex pair, and from a
complex pair not to real eigenvalues.
"""

import cmath
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...model.compiled.compilation import compiled
from ...model.rod import Coefficients
from ..certificate.box_of_all_eigenvalues import box_from_sqrt_frequency_bound
from ..exponents import EXPONENT_SETTINGS
from ..rounding_at_root import rounding_error_at_root
from ..value import (
    distance_to_next_root,
    root_error_w_scale_and_wave_number,
    scaled_determinant,
    second_derivative,
)
from .newton import refine_eigenvalue
from .settings import ROOT_NEWTON_SETTINGS, ROOT_SETTINGS


class RootsOfD(NamedTuple):
    """Eigenvalues of a mesh refined to roots w of D, sorted by descending real part, then frequency; all
    arrays are (k,).

    mesh_indices: index of each root in the list of eigenvalues of the mesh. error: absolute error estimates.
    relative_mesh_displacement: |eigenvalue of the mesh - root| / max(|w|, change of w over which an exponent
    of D changes by 1). wave_number: largest |q|, in 1/L; for arms the mean of |q| along the arm.
    is_imaginary: whether the root is imaginary within its error. unmatched_mesh_eigenvalue_count: number of
    eigenvalues of the mesh that lie in the a-priori box right of all roots and do not approximate a root.
    """

    mesh_indices: NDArray[np.int64]
    w: Complex
    error: Array
    relative_mesh_displacement: Array
    wave_number: Array
    is_imaginary: NDArray[np.bool_]
    unmatched_mesh_eigenvalue_count: int


@compiled
def root_error_and_scales(w: complex, coefficients: Coefficients) -> tuple[float, float, float]:
    """Returns (estimated distance from w to the nearest root of D, change of w over which an exponent of D
    changes by 1, wave number |q|), as `root_error_w_scale_and_wave_number`, but also near double roots.

    With e = max(|D|, rounding error of D), the Newton correction e/|D'| is valid if |D'|^2 is large against e
    |D''|. Otherwise w lies at the distance |D'/D''| from the middle of two roots, and the roots lie within
    sqrt(2 e/|D''|) of the middle. The rounding error in e is a typical value if w is well conditioned;
    otherwise it covers nearly all rounding errors.
    """
    error, length, wave = root_error_w_scale_and_wave_number(w, coefficients)
    if error > ROOT_SETTINGS.min_ill_conditioned_relative_error * abs(w):
        D, D1, S, _ = scaled_determinant(w, coefficients)
        rounding_error = rounding_error_at_root(w, coefficients, S)
        e = max(abs(D), ROOT_SETTINGS.rounding_bound_fraction_at_root * rounding_error)
        error = e / max(abs(D1), EXPONENT_SETTINGS.min_divisor)
        if error > ROOT_SETTINGS.min_double_root_correction_over_w * abs(w):
            D_ww = abs(second_derivative(w, S, coefficients))
            # Close to a double root Newton's correction is useless: the roots of the parabola bound the
            # distance.
            if abs(D1) ** 2 < ROOT_SETTINGS.min_half_root_distance_in_corrections * e * D_ww:
                root_distance = math.sqrt(2 * e / D_ww)
                error = min(max(error, root_distance), abs(D1) / D_ww + root_distance)
    return error, length, wave


@compiled
def taylor_parabola_roots(middle: complex, coefficients: Coefficients) -> tuple[complex, complex]:
    """The two roots of the quadratic Taylor polynomial of D about `middle`, for a uniform rod. For a real
    `middle` the roots are both real or complex conjugates."""
    D, D1, S, _ = scaled_determinant(middle, coefficients)
    if middle.imag == 0:
        D = complex(D.real, 0.0)
        D1 = complex(D1.real, 0.0)
    return roots_of_parabola(middle, D, D1, second_derivative(middle, S, coefficients))


@compiled
def roots_of_parabola(middle: complex, D: complex, D1: complex, D2: complex) -> tuple[complex, complex]:
    """The two roots of the quadratic polynomial with value D, first derivative D1 and second derivative D2 at
    `middle`; `middle` twice if D2 = 0."""
    if D2 == 0:
        return middle, middle
    root = cmath.sqrt(D1 * D1 - 2 * D * D2)
    return middle + (root - D1) / D2, middle - (root + D1) / D2


@compiled
def _separate_close_pairs(w: Complex, error: Array, coefficients: Coefficients) -> Array:
    """Replaces, in w, every pair closer than `max_pair_distance_in_errors` times the sum of its errors by two
    estimates of roots of D. w, error: eigenvalues and errors, (n,). Returns for each eigenvalue half the new
    distance from its partner, (n,); inf if the eigenvalue was not moved."""
    half_distances = np.full(len(w), math.inf)
    for i in range(len(w)):
        if half_distances[i] < math.inf:
            continue
        nearest_index = -1
        min_distance = math.inf
        for j in range(len(w)):
            if j != i and half_distances[j] == math.inf and abs(w[j] - w[i]) < min_distance:
                nearest_index = j
                min_distance = abs(w[j] - w[i])
        if nearest_index >= 0 and min_distance <= ROOT_SETTINGS.max_pair_distance_in_errors * (
            error[i] + error[nearest_index]
        ):
            for _ in range(ROOT_SETTINGS.successive_parabolas_per_pair):
                middle = (w[i] + w[nearest_index]) / 2
                # The pair's centre is exactly real, and must stay so: its two roots are real or conjugate.
                if w[nearest_index] == w[i].conjugate() or (w[i].imag == 0 and w[nearest_index].imag == 0):
                    middle = complex(middle.real, 0.0)
                w[i], w[nearest_index] = taylor_parabola_roots(middle, coefficients)
            half_distances[i] = half_distances[nearest_index] = abs(w[i] - w[nearest_index]) / 2
    return half_distances


@compiled
def _descending_order(w: Complex) -> NDArray:
    """Indices that sort w, (n,), by descending real part, then descending frequency."""
    order = np.arange(len(w))
    sort_indices_descending(w, order)
    return order


@compiled
def sort_indices_descending(w: Complex, order: NDArray) -> None:
    """Sorts the indices `order` of w, (n,), in place, by descending real part of w, then descending
    frequency. Insertion sort: fast for lists that are almost sorted."""
    for m in range(1, len(order)):
        i = order[m]
        position = m
        # Insertion sort: the lists are short and nearly sorted.
        while position > 0:
            j = order[position - 1]
            if w[j].real > w[i].real or (w[j].real == w[i].real and w[j].imag >= w[i].imag):
                break
            order[position] = j
            position -= 1
        order[position] = i


@compiled
def refined_roots(raw: Complex, coefficients: Coefficients, sqrt_bound: float, max_q: float) -> RootsOfD:
    """Roots of D, refined from the eigenvalues of a mesh in `raw`, (n,), that approximate a root
    of D.

    sqrt_bound: square root of `rodsweep.determinant.certificate.box_of_all_eigenvalues.frequency_bound`.
    max_q: largest wave number |q| that the mesh resolves. Infinite eigenvalues, which rounding makes finite,
    are dropped: they lie outside the a-priori box, have too large a |q|, or are far from every root.
    """
    error: Array = np.empty(len(raw))
    length: Array = np.empty(len(raw))
    wave: Array = np.empty(len(raw))
    is_near = np.zeros(len(raw), dtype=np.bool_)
    inside = np.zeros(len(raw), dtype=np.bool_)
    guess = raw.copy()
    for i in range(len(raw)):
        if not (math.isfinite(raw[i].real) and math.isfinite(raw[i].imag)):
            continue
        if abs(raw[i].imag) <= ROOT_NEWTON_SETTINGS.real_axis_tolerance * abs(raw[i]):
            guess[i] = complex(raw[i].real, 0.0)
        error[i], length[i], wave[i] = root_error_and_scales(guess[i], coefficients)
        # No eigenvalue lies outside the box: eigenvalues of the mesh outside the box are artefacts.
        real, imag = box_from_sqrt_frequency_bound(sqrt_bound, max(-guess[i].real, 0.0))
        inside[i] = guess[i].real <= real and abs(guess[i].imag) <= imag
        max_error = ROOT_SETTINGS.max_pair_correction_over_w_scale * length[i]
        is_near[i] = inside[i] and wave[i] <= max_q and error[i] <= max_error
    indices = np.flatnonzero(is_near)
    guess = guess[indices]
    error = error[indices]
    length = length[indices]
    wave = wave[indices]
    is_near_root = error <= ROOT_SETTINGS.max_newton_correction_over_w_scale * length
    w, is_refined = _refine_candidates(guess, error, wave, is_near_root, coefficients)
    order = np.flatnonzero(is_refined)
    order = order[_descending_order(w[order])]
    displacement = np.abs(w[order] - guess[order]) / np.maximum(np.abs(w[order]), length[order])
    indices = indices[order]
    w = w[order]
    error = error[order]
    wave = wave[order]
    _increase_errors_of_equal_roots(w, error, coefficients)
    axis = np.abs(w.real) <= np.maximum(
        ROOT_SETTINGS.imaginary_axis_tolerance_in_errors * error,
        ROOT_SETTINGS.imaginary_axis_tolerance * np.abs(w),
    )
    # An eigenvalue in the box that leads all roots is spurious, or the trace of a root that was missed.
    spurious_count = (inside & ~is_near & (raw.real > (w[0].real if len(w) else -math.inf))).sum()
    return RootsOfD(indices, w, error, displacement, wave, axis, int(spurious_count))


@compiled
def _refine_candidates(
    first: Complex, error: Array, wave: Array, is_near_root: NDArray[np.bool_], coefficients: Coefficients
) -> tuple[Complex, NDArray[np.bool_]]:
    """Returns (w, mask), both (k,). w: eigenvalues refined to roots of D. mask: whether w[i] is a root.
    first: eigenvalues of the mesh, (k,). is_near_root: whether first[i] approximates a root, (k,). error,
    wave: errors and wave numbers, (k,), updated in place."""
    w = first.copy()
    half_distances = _separate_close_pairs(w, error, coefficients)
    is_separated = np.isfinite(half_distances)
    is_root = is_separated | is_near_root
    for i in range(len(w)):
        if not is_root[i]:
            continue
        # Pairs moved to the roots of a parabola are not conjugates of their neighbours in the list.
        is_conjugate = i > 0 and w[i].imag != 0 and not is_separated[i - 1] and not is_separated[i]
        if is_conjugate and w[i] == first[i - 1].conjugate():
            # The conjugate is refined already.
            w[i] = w[i - 1].conjugate()
            error[i] = error[i - 1]
            wave[i] = wave[i - 1]
        else:
            # Close to a double root D and D' are rounding errors, whose quotient may lead anywhere.
            w[i] = refine_eigenvalue(w[i], coefficients, half_distances[i])
            error[i], _, wave[i] = root_error_and_scales(w[i], coefficients)
    return w, is_root


@compiled
def _increase_errors_of_equal_roots(w: Complex, error: Array, coefficients: Coefficients) -> None:
    """Increases, in place, the errors of any two entries of w that converged to the same root of D; the
    errors are then at least 2 |D'/D''|, the distance to the next root. w, error: roots and their errors,
    (n,)."""
    for i in range(len(w)):
        for j in range(i + 1, len(w)):
            distance = abs(w[i] - w[j])
            if distance <= ROOT_SETTINGS.same_root_distance_in_errors * (error[i] + error[j]):
                next_root = distance_to_next_root(w[i], coefficients)
                if distance < ROOT_SETTINGS.same_root_fraction_of_next_distance * next_root:
                    error[i] = max(error[i], next_root)
                    error[j] = max(error[j], next_root)
