"""The leading eigenvalue of a rod, followed from a neighbouring rod without a mesh.

Newton's method on the determinant D refines the eigenvalue of the neighbouring rod, and a count of
eigenvalues, or for an arm a proof without a count, shows that the refined eigenvalue leads.
"""

from collections.abc import Iterator
from math import isfinite
from typing import NamedTuple

import numpy as np

from ....arrays import Complex
from ....determinant.arm.completeness import largest_w_of_proof, prove_complete
from ....determinant.arm.count.count import count_right_of as count_of_arm
from ....determinant.arm.count.count import largest_w_of_count
from ....determinant.arm.determinant import arm_determinant
from ....determinant.arm.hull.hull import hull_of
from ....determinant.arm.newton import refine_eigenvalue_and_error
from ....determinant.certificate.winding_number import count_right_of
from ....determinant.roots.newton import refine_eigenvalue
from ....determinant.roots.roots import root_error_and_scales
from ....model.rod import Rod
from ..candidates import CANDIDATE_SETTINGS, line_for_proof
from .following import are_distinct_roots
from .prediction import KnownRoots


class LeadingEigenvalue(NamedTuple):
    """The leading eigenvalue w of a rod, in 1/tau2, with Im w >= 0, and its absolute error.

    eigenvalues: all followed eigenvalues of the rod with Im w >= 0, (n,), the leading eigenvalue first.
    """

    w: complex
    error: float
    eigenvalues: Complex


def follow_leading_eigenvalue(rod: Rod, near: Complex, accuracy: float) -> LeadingEigenvalue | None:
    """The leading eigenvalue of `rod`, followed from a neighbouring rod; None unless the eigenvalue is
    accurate, real or complex as for the neighbouring rod, and proved to lead.

    near: eigenvalues of the neighbouring rod with Im w >= 0, (n,), the leading eigenvalue first. For a
    uniform rod only the first eigenvalue is used; the proof for an arm that varies along its length needs
    several eigenvalues. accuracy: largest relative error.
    """
    if rod.is_uniform_and_linear:
        return _follow_leader_of_uniform(rod, complex(near[0]), accuracy)
    if rod.is_uniform:
        # The eigenvalues of the nonlinear rod are `rate` times the eigenvalues of an equivalent linear rod.
        linear_rod, rate = rod.equivalent_linear_rod
        leader = follow_leading_eigenvalue(linear_rod, near / rate, accuracy)
        if leader is None:
            return None
        return LeadingEigenvalue(rate * leader.w, rate * leader.error, rate * leader.eigenvalues)
    try:
        return _follow_leader_of_arm(rod, near, accuracy)
    except FloatingPointError:  # D needs too many elements
        return None


def _follow_leader_of_uniform(rod: Rod, near: complex, accuracy: float) -> LeadingEigenvalue | None:
    """The result of `follow_leading_eigenvalue` for a uniform rod of linear material.

    near: leading eigenvalue of the neighbouring rod. accuracy: largest relative error.
    """
    w = refine_eigenvalue(near, rod.coefficients)
    error, _, _ = root_error_and_scales(w, rod.coefficients)
    if not _matches_neighbour(w, error, near, accuracy):
        return None
    own_count = 2 if w.imag else 1  # a pair, or one real eigenvalue
    leads = any(count_right_of(line, rod).number == own_count for line in _lines_for_count(w))
    return LeadingEigenvalue(w, error, np.array([w])) if leads else None


def _follow_leader_of_arm(rod: Rod, near: Complex, accuracy: float) -> LeadingEigenvalue | None:
    """The result of `follow_leading_eigenvalue` for an arm that is not uniform; raises FloatingPointError if
    D needs too many elements.

    near: eigenvalues of the neighbouring arm, (n,), the leading eigenvalue first. accuracy: largest relative
    error.
    """
    hull = hull_of(rod)
    if not isfinite(hull.a) or not np.isfinite(near).all():
        return None
    determinant = arm_determinant(rod)
    near_leader = complex(near[0])
    largest_w = largest_w_of_proof(line_for_proof(near_leader, 0.0), hull, near)
    if not isfinite(largest_w):
        largest_w = largest_w_of_count(next(_lines_for_count(near_leader)), determinant, hull)
    determinant.propagators_for(largest_w)  # the elements for the proof also serve the eigenvalues
    roots = [refine_eigenvalue_and_error(value, determinant) for value in near.tolist()]
    w = np.array([root for root, _ in roots])
    error = np.array([error for _, error in roots])
    order = np.argsort(-w.real, kind="stable")
    w = w[order]
    error = error[order]
    leader = complex(w[0])
    if not _matches_neighbour(leader, float(error[0]), near_leader, accuracy) or not are_distinct_roots(
        w, error
    ):
        return None
    pairs = w.imag != 0
    known = KnownRoots(np.append(w, w[pairs].conj()), np.append(error, error[pairs]))
    complete, _ = prove_complete(line_for_proof(leader, float(error[0])), *known, determinant, hull)
    leads = complete or any(
        count_of_arm(line, determinant, hull, *known).number == (known.w.real > line).sum()
        for line in _lines_for_count(leader)
    )
    return LeadingEigenvalue(leader, float(error[0]), w) if leads else None


def _matches_neighbour(w: complex, error: float, near: complex, accuracy: float) -> bool:
    """Whether w has a relative error of at most `accuracy`, and is real or complex like the eigenvalue `near`
    of the neighbouring rod."""
    return error <= accuracy * abs(w) and w.imag >= 0 and (w.imag == 0) == (near.imag == 0)


def _lines_for_count(w: complex) -> Iterator[float]:
    """Real parts of two lines to the left of a leading eigenvalue w, for the count; the cheaper count
    first."""
    return (
        w.real - far * abs(w)
        for far in (CANDIDATE_SETTINGS.leader_line_distance, CANDIDATE_SETTINGS.last_line_distance)
    )
