"""The leading eigenvalue of a rod, followed from a neighbouring rod without a mesh.

Newton's method on the determinant D refines the eigenvalue of the neighbouring rod, and a count of
eigenvalues shows that the refined eigenvalue leads; for arms that are not uniform, a proof without a count is
tried first.
"""

from collections.abc import Iterator
from math import inf, isfinite
from typing import NamedTuple

import numpy as np

from ....arrays import Array, Complex, list_of
from ....determinant.arm.completeness import largest_w_of_proof, prove_complete
from ....determinant.arm.count.count import count_right_of as count_of_arm
from ....determinant.arm.count.count import largest_w_of_count
from ....determinant.arm.determinant import ArmDeterminant, arm_determinant
from ....determinant.arm.hull.hull import hull_of
from ....determinant.arm.newton import refine_eigenvalues_and_errors, taylor_parabola_roots
from ....determinant.certificate.winding_number import count_right_of
from ....determinant.roots.newton import refine_eigenvalue
from ....determinant.roots.roots import root_error_and_scales
from ....model.rod import Rod
from ..candidates import EIGENVALUE_CANDIDATE_SETTINGS, line_for_proof
from .eigenvalue_following import are_distinct_roots
from .eigenvalue_prediction import KnownRoots
from .leader_in_range import ArmRange, leader_in_range


class LeadingEigenvalue(NamedTuple):
    """The leading eigenvalue w of a rod, in 1/tau2, with Im w >= 0, and its absolute error. eigenvalues: all
    followed eigenvalues of the rod with Im w >= 0, (n,), the leading eigenvalue first. is_proved_by_count:
    whether the arm is not uniform, and the proof that w leads needed a count of its eigenvalues."""

    w: complex
    error: float
    eigenvalues: Complex
    is_proved_by_count: bool = False


def follow_leading_eigenvalue(rod: Rod, guesses: Complex, accuracy: float) -> LeadingEigenvalue | None:
    """The leading eigenvalue of `rod`, followed from a neighbouring rod; None unless the eigenvalue is
    accurate, proved to lead, and real or complex as for the neighbouring rod.

    guesses: eigenvalues of the neighbouring rod with Im w >= 0, (n,), the leading eigenvalue first. For a
    uniform rod only the first eigenvalue is used; the proof for an arm that varies along its length needs
    several eigenvalues. accuracy: largest relative error.
    """
    if rod.is_uniform_and_linear:
        return _follow_leader_of_uniform(rod, complex(guesses[0]), accuracy)
    if rod.is_uniform:
        # The eigenvalues of the nonlinear rod are `rate` times the eigenvalues of an equivalent linear rod.
        linear_rod, rate = rod.equivalent_linear_rod_and_rate_factor
        leading_w = follow_leading_eigenvalue(linear_rod, guesses / rate, accuracy)
        if leading_w is None:
            return None
        return LeadingEigenvalue(rate * leading_w.w, rate * leading_w.error, rate * leading_w.eigenvalues)
    try:
        return _follow_leader_of_arm(rod, guesses, accuracy)
    except FloatingPointError:  # D needs too many elements
        return None


def follow_leader_in_range(
    rod: Rod, guesses: Complex, accuracy: float, parameter_name: str, arm_range: ArmRange
) -> LeadingEigenvalue | None:
    """The result of `follow_leading_eigenvalue` for a nonuniform arm of a chain, from propagators
    interpolated over a range of arms; None also outside the range. guesses: eigenvalues of the previous arm,
    (n,), as in `follow_leading_eigenvalue`. accuracy: largest relative error. parameter_name: the varied
    parameter."""
    roots = leader_in_range(rod, parameter_name, arm_range, guesses)
    if roots is None:
        return None
    w, error = roots
    leading_w = complex(w[0])
    if not _is_accurate_and_real_like_neighbour(leading_w, float(error[0]), complex(guesses[0]), accuracy):
        return None
    return LeadingEigenvalue(leading_w, float(error[0]), w)


def _follow_leader_of_uniform(rod: Rod, guess: complex, accuracy: float) -> LeadingEigenvalue | None:
    """The result of `follow_leading_eigenvalue` for a uniform rod of linear material. guess: leading
    eigenvalue of the neighbouring rod. accuracy: largest relative error."""
    w = refine_eigenvalue(guess, rod.coefficients)
    error, _, _ = root_error_and_scales(w, rod.coefficients)
    if not _is_accurate_and_real_like_neighbour(w, error, guess, accuracy):
        return None
    mode_count = 2 if w.imag else 1  # a pair, or one real eigenvalue
    is_leading = any(count_right_of(line, rod).number == mode_count for line in _lines_for_count(w))
    return LeadingEigenvalue(w, error, np.array([w])) if is_leading else None


def _follow_leader_of_arm(rod: Rod, guesses: Complex, accuracy: float) -> LeadingEigenvalue | None:
    """The result of `follow_leading_eigenvalue` for an arm that is not uniform; raises FloatingPointError if
    D needs too many elements. guesses: eigenvalues of the neighbouring arm, (n,), the leading eigenvalue
    first. accuracy: largest relative error."""
    hull = hull_of(rod)
    if not isfinite(hull.a) or not np.isfinite(guesses).all():
        return None
    determinant = arm_determinant(rod)
    guess = complex(guesses[0])
    largest_w = largest_w_of_proof(line_for_proof(guess, 0.0), hull, guesses)
    if not isfinite(largest_w):
        largest_w = largest_w_of_count(next(_lines_for_count(guess)), determinant, hull)
    determinant.propagators_for(largest_w)  # the elements for the proof also serve the eigenvalues
    w, error = _refined_eigenvalues_and_errors(guesses, determinant, accuracy)
    # Another followed eigenvalue may have taken the lead on the way from the neighbour.
    order = np.argsort(-w.real, kind="stable")
    w = w[order]
    error = error[order]
    leading_w = complex(w[0])
    if not _is_accurate_and_real_like_neighbour(
        leading_w, float(error[0]), guess, accuracy
    ) or not are_distinct_roots(w, error):
        return None
    known_roots = _with_conjugates(w, error)
    is_complete, _ = prove_complete(
        line_for_proof(leading_w, float(error[0])), *known_roots, determinant, hull
    )
    is_leading = is_complete or any(
        count_of_arm(line, determinant, hull, *known_roots).number == (known_roots.w.real > line).sum()
        for line in _lines_for_count(leading_w)
    )
    if not is_leading:
        return None
    return LeadingEigenvalue(leading_w, float(error[0]), w, is_proved_by_count=not is_complete)


def _refined_eigenvalues_and_errors(
    guesses: Complex, determinant: ArmDeterminant, accuracy: float
) -> tuple[Complex, Array]:
    """Returns (w, errors), (m,) each: the eigenvalues of an arm near `guesses`, (n,), and their absolute
    errors. Where Newton's method finds no complex eigenvalue of the relative error `accuracy` near a complex
    guess, two real eigenvalues take its place; where it finds none near two real guesses, a complex
    eigenvalue takes their place."""
    w, error = _newton_roots_and_errors(guesses, determinant)
    is_lost = (error > accuracy * np.abs(w)) | ((w.imag == 0) & (guesses.imag != 0))
    if not is_lost.any():
        return w, error
    # Two eigenvalues close to a double root are those of a parabola about it.
    middles = list_of(guesses[is_lost & (guesses.imag != 0)].real)
    real_guesses = guesses[is_lost & (guesses.imag == 0)].real
    if len(real_guesses):
        middles.append(float(real_guesses.mean()))
    pairs = [taylor_parabola_roots(complex(middle), determinant) for middle in middles]
    added = np.array([root for pair in pairs for root in pair if root.imag >= 0])
    new_w, new_error = _newton_roots_and_errors(added, determinant)
    return np.append(w[~is_lost], new_w), np.append(error[~is_lost], new_error)


def _newton_roots_and_errors(guesses: Complex, determinant: ArmDeterminant) -> tuple[Complex, Array]:
    """Returns (w, errors): the roots of D found by Newton's method from each of `guesses`, and their absolute
    errors; (n,) each."""
    roots = refine_eigenvalues_and_errors(list_of(guesses), determinant, [inf] * len(guesses))
    return np.array([root for root, _ in roots]), np.array([error for _, error in roots])


def is_arm_leader_proved_without_count(rod: Rod, w: Complex, error: Array) -> bool:
    """Whether eigenvalues of a nonuniform arm prove without a count which of them leads. w, error:
    eigenvalues with Im w >= 0 and their absolute errors, (n,) each, the leading eigenvalue first."""
    line = line_for_proof(complex(w[0]), float(error[0]))
    try:
        return prove_complete(line, *_with_conjugates(w, error), arm_determinant(rod), hull_of(rod))[0]
    except FloatingPointError:  # D needs too many elements
        return False


def _with_conjugates(w: Complex, error: Array) -> KnownRoots:
    """The eigenvalues w with Im w >= 0, (n,), their conjugates, and the errors of all."""
    pairs = w.imag != 0
    return KnownRoots(np.append(w, w[pairs].conj()), np.append(error, error[pairs]))


def _is_accurate_and_real_like_neighbour(
    w: complex, error: float, neighbour_w: complex, accuracy: float
) -> bool:
    """Whether w has Im w >= 0 and a relative error of at most `accuracy`, and is real or complex like the
    eigenvalue `neighbour_w` of the neighbouring rod."""
    return error <= accuracy * abs(w) and w.imag >= 0 and (w.imag == 0) == (neighbour_w.imag == 0)


def _lines_for_count(w: complex) -> Iterator[float]:
    """Real parts of two vertical lines to the left of a leading eigenvalue w, for counts of the eigenvalues
    right of a line; the line of the cheaper count first."""
    return (
        # Another eigenvalue may lie right of the far line; the near line then excludes it.
        w.real - distance * abs(w)
        for distance in (
            EIGENVALUE_CANDIDATE_SETTINGS.relative_line_distance_from_leading_w,
            EIGENVALUE_CANDIDATE_SETTINGS.relative_line_distance_from_last_w,
        )
    )
