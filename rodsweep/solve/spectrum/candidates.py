"""One solve for the leading eigenvalues of a rod on one mesh, and the comparison with a count.

The mesh gives approximate eigenvalues, Newton's method on the determinant D refines them, and the winding
number of D shows whether an eigenvalue is missing. `rodsweep.solve.spectrum.search` chooses the next solve.
"""

from dataclasses import dataclass, replace
from math import inf
from typing import Any

import numpy as np

from ...arrays import Complex
from ...determinant.certificate.winding_number import EigenvalueCount
from ...determinant.roots.roots import RootsOfD
from ...discretization.straight.transverse_mesh import AnyMesh
from ...model.compiled.kernel_constants import KernelConstants
from ..backend.petsc import PETSC_EXCEPTIONS
from ..backend.solver_pools import destroy_pooled_solvers
from ..point_outcome import cause_of
from .problem import TransverseProblem


@dataclass(frozen=True, slots=True, kw_only=True)
class EigenvalueCandidateSettings(KernelConstants):
    """Settings for the eigenvalues of a mesh, and for the vertical lines right of which eigenvalues are
    counted."""

    min_wide_gap_over_real_part: float = 0.2
    """The vertical line of a count lies in a gap between successive real parts. For a stable rod, gaps are
    treated as equally wide if their width, divided by |Re w| of the left eigenvalue, exceeds this."""
    min_wide_gap_over_real_part_if_unstable: float = 0.05
    """Like `min_wide_gap_over_real_part`, for an unstable rod; less than `min_wide_gap_over_real_part`,
    because eigenvalues far to the left converge last and need a finer mesh."""
    relative_line_distance_from_last_w: float = 0.05
    """Distance from the last eigenvalue w found to the last vertical line tried for a count, to the left of
    w, divided by |w|."""
    relative_line_distance_from_leading_w: float = 0.5
    """Distance from a followed leading eigenvalue w to the first vertical line for a count, to the left of w,
    divided by |w|. A count at a distant line needs fewer nodes than at a near line. A line at
    `relative_line_distance_from_last_w` follows in case another eigenvalue lies between w and the first
    line."""
    min_relative_gap: float = 1e-6
    """A vertical line, right of which eigenvalues are counted, is not placed between two neighbouring real
    parts whose distance, divided by the modulus of the left one, is at most this number."""
    max_relative_same_root_distance: float = 1e-6
    """Roots found with two shifts are the same root if their distance is at most this times |w|. Taking two
    roots for one root is safe, because the count then disagrees; one root taken for two could agree with a
    wrong count."""
    max_count_lines: int = 3
    """Maximum number of vertical lines tried for the count of the eigenvalues of one rod."""
    proof_line_distance_in_errors: float = 3.0
    """Distance, to the left of the last wanted eigenvalue w, of the line of a proof from D'/D at real points
    (`completeness`): this multiple of the error of w, plus `relative_proof_line_distance` * |w|."""
    relative_proof_line_distance: float = 1e-9
    """Second part of the distance that `proof_line_distance_in_errors` describes, divided by |w|."""


EIGENVALUE_CANDIDATE_SETTINGS = EigenvalueCandidateSettings()


@dataclass(frozen=True, slots=True)
class Candidates:
    """Outcome of one solve on `mesh`: k roots of D, sorted as defined in `rodsweep.model`. eigenvectors:
    eigenvectors on the mesh, (unknowns, k), or None. failure: error message of SLEPc or LAPACK, or empty."""

    mesh: AnyMesh
    roots: RootsOfD
    eigenvectors: Complex | None
    failure: str = ""

    def united_with(self, earlier: "Candidates") -> "Candidates":
        """These candidates and the roots of D that were found earlier, on another mesh or with another shift;
        unchanged if they have eigenvectors, which the earlier mesh does not share."""
        if self.eigenvectors is not None:
            return self
        own, other = self.roots, earlier.roots
        distances = np.abs(other.w[:, None] - own.w)
        same_distances = (
            EIGENVALUE_CANDIDATE_SETTINGS.max_relative_same_root_distance * np.abs(other.w) + other.error
        )
        is_new = (distances > np.maximum(same_distances[:, None], own.error)).all(axis=1)
        united = [np.append(mine, more[is_new]) for mine, more in zip(own[:-1], other[:-1], strict=True)]
        w = united[RootsOfD._fields.index("w")]
        order = np.lexsort((-w.imag, -w.real))
        return replace(
            self,
            roots=RootsOfD._make(
                [*(values[order] for values in united), own.unmatched_mesh_eigenvalue_count]
            ),
        )

    @property
    def has_found_only_growing_eigenvalues(self) -> bool:
        """Whether some roots of D are found, all of them grow, and every eigenvalue of the mesh farther to
        the right belongs to one of them: all other eigenvalues are then far to the left of the shift."""
        w = self.roots.w
        return len(w) > 0 and bool((w.real > 0).all()) and not self.roots.unmatched_mesh_eigenvalue_count

    def max_relative_error(self, mode_count: int) -> float:
        """Largest relative error estimate among the first `mode_count` roots."""
        errors: Any = self.roots.error[:mode_count].tolist()
        w: Any = self.roots.w[:mode_count].tolist()
        # An exponentially small eigenvalue may underflow to 0.
        return max(0.0, *(e / abs(v) if v else inf for e, v in zip(errors, w, strict=True)))


@dataclass(frozen=True, slots=True)
class CountComparison:
    """Numbers of eigenvalues to the right of a vertical line. count: number of all eigenvalues, counted or
    proved with D. found_count: number of the eigenvalues found."""

    count: EigenvalueCount
    found_count: int
    is_line_clear: bool
    """Whether the distance of every found eigenvalue from the vertical line is more than twice its error."""

    @property
    def agrees(self) -> bool:
        """Whether `count` and `found_count` are equal, and every found eigenvalue is clear of the
        line."""
        return self.is_line_clear and self.count.number == self.found_count


@dataclass(frozen=True, slots=True)
class CheckedCandidates:
    """Roots of D found by one solve, the comparison of their number with a count of eigenvalues (None if no
    count was requested), and their largest error."""

    candidates: Candidates
    """Roots of D found by one solve."""
    comparison: CountComparison | None
    error_over_limit: float
    """Largest ratio of an error to the allowed error; a ratio of at most
    `SearchSettings.max_error_over_limit` ends the search."""

    @property
    def sort_key(self) -> tuple[bool, float]:
        """Sort key, best candidates first: candidates with an undecided count come last; otherwise by
        increasing error."""
        return self.comparison is not None and self.comparison.count.number is None, self.error_over_limit


def candidates_on_mesh(
    problem: TransverseProblem, mesh: AnyMesh, requested_count: int, needs_vectors: bool, to_rounding: bool
) -> Candidates:
    """The eigenvalues of a mesh nearest to the shift of `problem`, refined to roots of D; spurious
    eigenvalues are dropped.

    requested_count: number of eigenvalues requested. needs_vectors: whether eigenvectors are returned.
    to_rounding: whether the eigenvalues of the mesh converge to rounding error before they are refined. After
    an error inside PETSc, SLEPc or LAPACK no eigenvalue is returned; the solver may succeed on another mesh.
    """
    mesh_eigenvalues: Complex = np.empty(0, complex)
    vectors = None
    failure = ""
    try:
        solver = problem.solver(mesh)
        mesh_eigenvalues = solver.solve(problem.rod, problem.shift, requested_count, to_rounding)
        vectors = solver.eigenvectors(len(mesh_eigenvalues)) if needs_vectors else None
    except PETSC_EXCEPTIONS as error:
        # After an error inside PETSc its objects are unusable.
        destroy_pooled_solvers()
        failure = cause_of(error)
    kept_roots = problem.refined_roots(mesh_eigenvalues, mesh)
    vectors = vectors[:, kept_roots.mesh_indices] if vectors is not None else None
    return Candidates(mesh, kept_roots, vectors, failure)


def compare_with_count(problem: TransverseProblem, roots: RootsOfD, mode_count: int) -> CountComparison:
    """Number of eigenvalues to the right of a vertical line, by a proof or a count, compared with the number
    found there. The line lies to the left of the `mode_count` leading eigenvalues and of all unstable
    eigenvalues. roots: eigenvalues found, at least `mode_count`, by descending real part."""
    w: Any = roots.w.tolist()  # for so few numbers Python is faster than NumPy
    errors: Any = roots.error.tolist()
    # A proof is far cheaper than a count, so it is tried first.
    line = line_for_proof(w[mode_count - 1], errors[mode_count - 1])
    is_complete, evaluations = problem.completeness_proof_and_evaluations(line, roots)
    if is_complete:
        found_count, is_line_clear = _count_right_of(line, w, errors)
        return CountComparison(EigenvalueCount(found_count, evaluations), found_count, is_line_clear)
    # A count fails close to an eigenvalue that is not among those found; another line may be free.
    for line in lines_for_count(w, mode_count):
        count = problem.count_right_of(line, roots)
        if count.number is not None:
            break
    return CountComparison(count, *_count_right_of(line, w, errors))


def line_for_proof(last_wanted: complex, error: float) -> float:
    """Real part <= 0 of a vertical line to the left of the last wanted eigenvalue and of all unstable
    eigenvalues. The module `completeness` proves, without a winding number, that all eigenvalues right of
    this line are known. last_wanted: the last wanted eigenvalue. error: its absolute error."""
    return min(
        last_wanted.real
        - EIGENVALUE_CANDIDATE_SETTINGS.proof_line_distance_in_errors * error
        - EIGENVALUE_CANDIDATE_SETTINGS.relative_proof_line_distance * abs(last_wanted),
        0.0,
    )


def _count_right_of(line: float, w: list[complex], errors: list[float]) -> tuple[int, bool]:
    """Returns (number of eigenvalues w to the right of `line`, is_line_clear). is_line_clear: whether the
    distance of each w from the line is more than twice the error of w. errors: absolute errors of w."""
    is_line_clear = all(abs(value.real - line) > 2 * error for value, error in zip(w, errors, strict=True))
    return sum(value.real > line for value in w), is_line_clear


def lines_for_count(w: list[complex], mode_count: int) -> list[float]:
    """Real parts of up to `max_count_lines` vertical lines to the right of which eigenvalues are counted,
    best first: middles of the widest gaps between real parts, to the left of the `mode_count` leading and of
    all unstable eigenvalues.

    w: eigenvalues found, by descending real part. Gaps wider than `min_wide_gap_over_real_part` (unstable
    rod: `min_wide_gap_over_real_part_if_unstable`) are equally good; the rightmost comes first. The last line
    lies to the left of all eigenvalues found.
    """
    wide_gap_over_real_part = (
        EIGENVALUE_CANDIDATE_SETTINGS.min_wide_gap_over_real_part_if_unstable
        if w[0].real > 0
        else EIGENVALUE_CANDIDATE_SETTINGS.min_wide_gap_over_real_part
    )
    # Left of the imaginary axis too, so that one count also gives the number of unstable modes.
    rightmost_end = min(w[mode_count - 1].real, 0.0)
    real_parts = [rightmost_end] + [value.real for value in w if value.real < rightmost_end]
    gaps = []
    for right, left in zip(real_parts[:-1], real_parts[1:], strict=True):
        # Relative, because the spacing of the eigenvalues grows with their moduli.
        width = (right - left) / abs(left)
        if width > EIGENVALUE_CANDIDATE_SETTINGS.min_relative_gap:
            # Wider gaps count as equal, because eigenvalues far to the left converge last.
            gaps.append((min(width, wide_gap_over_real_part), (left + right) / 2))
    gaps.sort(key=lambda gap: -gap[0])  # stable sort: the first wide gap stays first
    last_real_part = real_parts[-1]
    last_line = last_real_part - EIGENVALUE_CANDIDATE_SETTINGS.relative_line_distance_from_last_w * (
        # If all found eigenvalues grow, the line must still lie left of the axis.
        abs(w[-1]) if last_real_part < 0 else abs(w[0].real) + 1.0
    )
    return [*(middle for _, middle in gaps[: EIGENVALUE_CANDIDATE_SETTINGS.max_count_lines - 1]), last_line]
