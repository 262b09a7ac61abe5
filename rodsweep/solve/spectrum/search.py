"""Search for the leading eigenvalues of one rod: few unknowns, the requested accuracy, no missing eigenvalue.

One solve (`rodsweep.solve.spectrum.candidates`) gives a number of eigenvalues nearest to a shift, on
one mesh, and refines the eigenvalues by Newton's method on the determinant D. The mesh error, the error of
the roots of D and the count of eigenvalues determine the next solve. The search ends when mesh error, root
error and count are satisfactory.
"""

from dataclasses import replace

from ...discretization.elements.resolution import RESOLUTION_SETTINGS, mesh_accuracy
from ...model.rod import Rod
from .candidates import Candidates, CheckedCandidates, candidates_on_mesh, compare_with_count
from .candidates import CountComparison as Comparison
from .problem import TransverseProblem, meshes_without_result_text, transverse_problem
from .search_settings import SEARCH_SETTINGS
from .spectrum import (
    Spectrum,
    SpectrumRequest,
    errors_with_rounding,
    failed_spectrum,
    modes_at_lobatto_nodes,
    spectrum_or_failure,
)
from .status import SpectrumStatus

__all__ = ["SpectrumSearch", "Spectrum", "SpectrumRequest", "solve_spectrum", "warm_up"]


def solve_spectrum(rod: Rod, request: SpectrumRequest) -> Spectrum:
    """The leading `request.mode_count` eigenvalues of a rod; a failure is a status, never an exception."""
    if not rod.is_uniform or rod.is_uniform_and_linear:
        return spectrum_or_failure(lambda: SpectrumSearch(rod, request).find_spectrum(), request)
    linear, rate = rod.equivalent_linear_rod_and_rate_factor
    scaled = solve_spectrum(linear, request)
    return replace(scaled, eigenvalues=rate * scaled.eigenvalues, error_estimate=rate * scaled.error_estimate)


def warm_up() -> None:
    """Loads compiled code and creates the solver objects, so that the first rod takes no extra time."""
    rod = Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4)
    SpectrumSearch(rod, SpectrumRequest(2, 1e-4, certify=True)).find_spectrum()


class SpectrumSearch:
    """Search for the leading eigenvalues of one rod. requested_count: number of eigenvalues in the first
    request; default: `request.mode_count` plus `additional_eigenvalue_count`."""

    def __init__(self, rod: Rod, request: SpectrumRequest, requested_count: int | None = None):
        self.problem = transverse_problem(rod, request.mode_count if request.certify else 0)
        self.request = request
        self.modes = request.mode_count
        self.needs_vectors = request.vector_node_count > 0
        # Eigenvectors of two meshes cannot be united, and without a count nothing shows what is missing.
        self.can_unite = request.certify and self.problem.is_count_slow and not self.needs_vectors
        has_bound = self.problem.has_eigenvalue_bound
        self.accuracy = mesh_accuracy(request.accuracy, self.needs_vectors) if has_bound else request.accuracy
        self.mesh = self.problem.mesh_for(request.mode_count, self.accuracy)
        default_count = request.mode_count + self.problem.additional_eigenvalue_count
        self.requested_count = default_count if requested_count is None else requested_count
        self.best: CheckedCandidates | None = None
        self.stalled_refinements = self.failure_count = 0
        self.incomplete: Candidates | None = None
        """Roots of D found so far, if fewer than requested or counted; later roots are added to them."""
        self.disagreement: Comparison | None = None
        """Last comparison in which the count differs from the number of eigenvalues found."""
        self.is_leader_unresolved = False
        """Whether on one of the meshes neither roots of D nor a count showed which eigenvalue leads."""
        self.last_failure = ""
        """Error message of SLEPc or LAPACK on the last mesh; empty if the last mesh was solved."""

    def find_spectrum(self) -> Spectrum:
        """The spectrum; solves on finer meshes end if roots and count agree, or no longer improve."""
        for solve_index in range(SEARCH_SETTINGS.max_meshes):
            is_too_fine = self.mesh.unknown_count > RESOLUTION_SETTINGS.max_unknowns
            if is_too_fine or self.failure_count > SEARCH_SETTINGS.max_failed_solves:
                break
            to_rounding = self.needs_vectors or solve_index > 0
            candidates = candidates_on_mesh(
                self.problem, self.mesh, self.requested_count, self.needs_vectors, to_rounding
            )
            self.last_failure = candidates.failure
            checked = self.check_candidates(candidates)
            if checked is None:
                continue
            self.update_best(checked)
            is_accurate = checked.error_over_limit <= SEARCH_SETTINGS.max_error_over_limit
            if is_accurate or self.stalled_refinements >= SEARCH_SETTINGS.max_stalled_refinements:
                break
            wave_numbers = candidates.roots.wave_number[: self.modes]
            self.mesh = self.problem.finer_mesh_for_waves(candidates.mesh, wave_numbers, self.accuracy)
        return self.best_spectrum()

    def check_candidates(self, candidates: Candidates) -> CheckedCandidates | None:
        """The roots of D in `candidates` with count and error; None if another solve is needed instead."""
        if self.incomplete is not None:
            candidates = candidates.united_with(self.incomplete)
        if len(candidates.roots.w) < self.modes:
            if self.can_unite and candidates.has_found_only_growing_eigenvalues:
                self.request_decaying_modes(candidates)
                return None
            # Too few eigenvalues converged to roots of D, or SLEPc failed: a finer mesh.
            self.failure_count += bool(candidates.failure)
            # If few eigenvalues are roots, the mesh is too coarse: further eigenvalues would be no roots.
            if len(candidates.roots.w) >= SEARCH_SETTINGS.min_found_fraction_for_more_modes * self.modes:
                self.requested_count += self.modes
            self.mesh = self.problem.finer_mesh(self.mesh)
            return None
        if self.count_needs_decaying_modes(candidates):
            self.request_decaying_modes(candidates)
            return None
        certify = self.request.certify
        comparison = compare_with_count(self.problem, candidates.roots, self.modes) if certify else None
        is_uncounted = comparison is not None and comparison.count.number is None
        if is_uncounted and candidates.roots.unmatched_mesh_eigenvalue_count:
            self.is_leader_unresolved = True
            self.mesh = self.problem.finer_mesh(self.mesh)
            return None
        if comparison is not None and comparison.count.number is not None and not comparison.agrees:
            self.disagreement = comparison
            self.incomplete = candidates
            self.request_missing_eigenvalues(comparison.count.number, comparison.found_count)
            return None
        return CheckedCandidates(candidates, comparison, self.error_over_limit(candidates, comparison))

    def error_over_limit(self, candidates: Candidates, comparison: Comparison | None) -> float:
        """Largest ratio of an error of `candidates` to the allowed error. With eigenvectors, or without a
        proof by a count, the distance of the mesh's eigenvalues from the roots of D is an error, too."""
        ratio = candidates.max_relative_error(self.modes) / self.request.accuracy
        if comparison is not None and comparison.agrees and not self.needs_vectors:
            return ratio
        settings = SEARCH_SETTINGS
        max_ratio = settings.max_relative_mesh_displacement
        if not self.problem.has_eigenvalue_bound:
            max_ratio = settings.max_mesh_displacement_if_w_unbounded
        distance_ratio = float(candidates.roots.relative_mesh_displacement[: self.modes].max())
        return max(ratio, distance_ratio / (self.request.accuracy if self.needs_vectors else max_ratio))

    def request_missing_eigenvalues(self, counted: int, found_count: int) -> None:
        """Requests more eigenvalues or a finer mesh, because `counted` and `found_count` differ."""
        if counted < found_count:  # spurious eigenvalues
            self.mesh = self.problem.finer_mesh(self.mesh)
            return
        requested_count = counted + SEARCH_SETTINGS.spare_mode_count
        if counted == found_count:
            # The line is within the error of an eigenvalue; left of a further eigenvalue it has room.
            requested_count = self.requested_count + SEARCH_SETTINGS.spare_mode_count
        elif requested_count <= self.requested_count:
            # The missing eigenvalues are far from the shift or unresolved.
            requested_count = self.requested_count + counted - found_count + SEARCH_SETTINGS.spare_mode_count
            self.problem.move_shift_right()
            self.mesh = self.problem.finer_mesh(self.mesh)
        self.request_eigenvalues(requested_count)

    def count_needs_decaying_modes(self, candidates: Candidates) -> bool:
        """Whether the count of an arm needs eigenvalues with Re w <= 0 too: all roots found have Re w > 0.
        False if `max_modes_found_without_proof` roots are found and no count can succeed."""
        if not (self.request.certify and self.problem.is_count_slow and (candidates.roots.w.real > 0).all()):
            return False
        count = len(candidates.roots.w)
        return count < SEARCH_SETTINGS.max_modes_found_without_proof or self.problem.is_countable

    def request_decaying_modes(self, candidates: Candidates) -> None:
        """Requests eigenvalues left of `candidates`, which all grow, because a count needs decaying modes
        too. If `can_unite`, moves the shift to the left; otherwise, or if the last solve gave no further
        eigenvalue, requests a larger number. Refines the mesh if fewer were found than requested."""
        self.is_leader_unresolved = True
        found_count = len(candidates.roots.w)
        if found_count < self.requested_count:
            self.mesh = self.problem.finer_mesh(self.mesh)
        earlier_count = 0 if self.incomplete is None else len(self.incomplete.roots.w)
        self.incomplete = candidates
        if not self.can_unite or (found_count == earlier_count and found_count >= self.modes):
            min_count = 2 * found_count + SEARCH_SETTINGS.spare_mode_count
            self.request_eigenvalues(max(self.requested_count, min_count))
        else:
            self.problem.move_shift_left(float(candidates.roots.w.real.min()))

    def request_eigenvalues(self, requested_count: int) -> None:
        """Requests `requested_count` eigenvalues, and refines the mesh until it has enough unknowns."""
        while (
            requested_count > self.mesh.unknown_count // SEARCH_SETTINGS.min_unknowns_per_mode
            and self.mesh.unknown_count <= RESOLUTION_SETTINGS.max_unknowns
        ):
            self.mesh = self.problem.finer_mesh(self.mesh)
        self.requested_count = requested_count

    def update_best(self, checked: CheckedCandidates) -> None:
        """Stores the candidates if they are the best so far; counts solves without progress."""
        best = self.best
        progress_limit = SEARCH_SETTINGS.max_progress_error_ratio * best.error_over_limit if best else 0.0
        is_better = best is None or checked.sort_key < (best.sort_key[0], progress_limit)
        self.stalled_refinements = 0 if is_better else self.stalled_refinements + 1
        is_accurate = checked.error_over_limit <= SEARCH_SETTINGS.max_error_over_limit
        if best is None or checked.sort_key <= best.sort_key or is_accurate:
            self.best = checked

    def best_spectrum(self) -> Spectrum:
        """The spectrum of the best candidates; without candidates, a failed spectrum with the reason."""
        if self.best is not None:
            return _best_spectrum(self.best, self.problem, self.request)
        if self.disagreement is not None:
            counted = self.disagreement.count.number
            reason = (
                f"the winding number counts {counted} eigenvalues right of a vertical line, but the meshes "
                f"give {self.disagreement.found_count}"
            )
            return failed_spectrum(SpectrumStatus.modes_missing, self.request, reason)
        if self.is_leader_unresolved:
            reason = "no mesh resolves all eigenvalues with large real parts, so the leading one is not known"
            return failed_spectrum(SpectrumStatus.modes_missing, self.request, reason)
        meshes = meshes_without_result_text(SEARCH_SETTINGS.max_meshes, self.mesh)
        reason = (
            self.last_failure
            or f"{meshes} resolves the requested modes{self.problem.shortest_growing_wave_clause}"
        )
        return failed_spectrum(SpectrumStatus.failed, self.request, reason)


def _best_spectrum(best: CheckedCandidates, problem: TransverseProblem, request: SpectrumRequest) -> Spectrum:
    """The spectrum with the best roots of D found, with its status and whether it is proved complete."""
    roots, comparison = best.candidates.roots, best.comparison
    error_over_limit = best.error_over_limit
    if request.certify and not request.vector_node_count:  # the mesh is not accurate, but the roots of D are
        error_over_limit = best.candidates.max_relative_error(request.mode_count) / request.accuracy
    is_accurate = error_over_limit <= SEARCH_SETTINGS.max_stalled_error_over_limit
    status = SpectrumStatus.ok if is_accurate else SpectrumStatus.accuracy_not_reached
    is_proved = comparison is not None and comparison.agrees
    is_undecided = bool(roots.is_imaginary.any())
    message = ""
    if status == SpectrumStatus.ok and request.certify:
        if not is_proved:
            status = SpectrumStatus.not_certified
            message = comparison.count.failure_reason if comparison else ""
        elif is_undecided:
            status = SpectrumStatus.undecided
    unstable_count = int((roots.w.real > 0).sum())
    # Without a request for a proof, the unstable modes are known if the search went beyond them.
    is_known = not is_undecided and (is_proved if request.certify else unstable_count < len(roots.w))
    return Spectrum(
        status=status,
        eigenvalues=roots.w[: request.mode_count],
        error_estimate=errors_with_rounding(roots.w, roots.error, problem.rod)[: request.mode_count],
        unstable_count=unstable_count if is_known else -1,
        certified=is_proved and not is_undecided,
        elements=best.candidates.mesh.element_count,
        order=best.candidates.mesh.order,
        vectors=modes_at_lobatto_nodes(problem, request, best.candidates.mesh, best.candidates.eigenvectors),
        message=message,
    )
