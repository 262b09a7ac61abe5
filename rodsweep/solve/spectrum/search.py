"""Search for the leading eigenvalues of one rod: as few unknowns as the accuracy needs, no eigenvalue
missing.

One attempt (`rodsweep.solve.spectrum.candidates`) solves on a mesh, about a shift, for a number of
eigenvalues, and refines them on D. Mesh error, remaining error and count determine the next attempt. A point
is ok once all three are sufficient.
"""

from dataclasses import dataclass, replace
from typing import Any

from ...discretization.elements.resolution import RESOLUTION, mesh_accuracy
from ...model.rod import Rod
from ..backend.kept import forget_all
from ..point import solved
from .candidates import Candidates, CountComparison, candidates_on, compare_with_count
from .problem import TransverseProblem, problem_of
from .search_settings import SEARCH
from .spectrum import Spectrum, SpectrumRequest, no_spectrum, stated_errors, vectors_on_nodes
from .status import SpectrumStatus

__all__ = ["Search", "Spectrum", "SpectrumRequest", "solve_spectrum", "warm_up"]


@dataclass(frozen=True, slots=True)
class JudgedCandidates:
    """Candidates with a count, if requested, and the largest error in units of its limit."""

    found: Candidates
    verdict: CountComparison | None
    short: float
    """Largest error in units of its limit."""

    @property
    def grade(self) -> tuple[bool, float]:
        """Sort key, smaller is better: first a decided count, then accuracy."""
        return self.verdict is not None and self.verdict.count.number is None, self.short


def solve_spectrum(rod: Rod, request: SpectrumRequest) -> Spectrum:
    """The leading `request.modes` eigenvalues of a rod; a failure is a status, never an exception."""

    def failed(cause: str) -> Spectrum:
        forget_all()
        return no_spectrum(SpectrumStatus.failed, request, cause)

    if rod.uniform and not rod.standard:
        return _from_equivalent(rod, request)
    return solved(lambda: Search(rod, request).outcome(), failed)


def _from_equivalent(rod: Rod, request: SpectrumRequest) -> Spectrum:
    """Spectrum of a uniform rod of any law, from the equivalent linear rod; rates are rescaled."""
    linear, rate = rod.equivalent
    found = solve_spectrum(linear, request)
    return replace(found, eigenvalues=rate * found.eigenvalues, error_estimate=rate * found.error_estimate)


def warm_up() -> None:
    """Loads compiled code and creates solver objects, so that the first point takes no extra time."""
    Search(Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4), SpectrumRequest(2, 1e-4, certify=True)).outcome()


class Search:
    """State of the search for the leading eigenvalues of one rod: next attempt, best result, failures.

    wanted: number of eigenvalues first requested from the mesh; by default `request.modes`.
    """

    def __init__(self, rod: Rod, request: SpectrumRequest, wanted: int | None = None):
        self.problem = problem_of(rod, request.modes if request.certify else 0)
        self.request = request
        self.modes = request.modes
        self.with_vectors = request.vector_nodes > 0
        bounded = self.problem.bounded
        self.aim = mesh_accuracy(request.accuracy, self.with_vectors) if bounded else request.accuracy
        self.mesh = self.problem.mesh_for(request.modes, self.aim)
        self.wanted = request.modes + self.problem.spare if wanted is None else wanted
        self.best: JudgedCandidates | None = None
        self.stalled = self.failures = 0
        self.lost: CountComparison | None = None
        """The last count that disagrees with the eigenvalues found."""
        self.unresolved = False
        """Whether neither a mesh nor a count could decide which eigenvalue leads."""
        self.why = f"no mesh of at most {RESOLUTION.most_unknowns} unknowns resolves the requested modes"

    def outcome(self) -> Spectrum:
        """Tries meshes until the result is good enough or improves no more."""
        for turn in range(SEARCH.max_meshes):
            if self.mesh.unknowns > RESOLUTION.most_unknowns or self.failures > SEARCH.max_failures:
                break
            tight = self.with_vectors or turn > 0
            found = candidates_on(self.problem, self.mesh, self.wanted, self.with_vectors, tight)
            judged = self.judged(found)
            if judged is None:
                continue
            self.keep(judged)
            if judged.short <= SEARCH.error_share or self.stalled >= SEARCH.no_progress:
                break
            self.mesh = self.problem.next_mesh_for(found.mesh, found.roots.wave[: self.modes], self.aim)
        return self.concluded()

    def judged(self, found: Candidates) -> JudgedCandidates | None:
        """The candidates if complete; otherwise None, after a change of the next attempt."""
        if len(found.roots.w) < self.modes:
            # Too few converged, or converged to no root, or SLEPc failed: a finer mesh.
            self.failures += bool(found.failure)
            self.why = found.failure or self.why
            # Where hardly any is a root the mesh is too coarse: further eigenvalues would be no roots either.
            if len(found.roots.w) >= SEARCH.resolved_share * self.modes:
                self.wanted += self.modes
            self.mesh = self.problem.finer(self.mesh)
            return None
        if self.needs_beyond_axis(found):
            self.request_beyond_axis(len(found.roots.w))
            return None
        verdict = compare_with_count(self.problem, found.roots, self.modes) if self.request.certify else None
        if verdict is not None and verdict.count.number is None and found.roots.ahead:
            self.unresolved = True
            self.mesh = self.problem.finer(self.mesh)
            return None
        if verdict is not None and verdict.count.number is not None and not verdict.agrees:
            self.lost = verdict
            self.request_missing(verdict.count.number, verdict.here)
            return None
        return JudgedCandidates(found, verdict, self.shortfall(found, verdict))

    def shortfall(self, found: Candidates, verdict: CountComparison | None) -> float:
        """`JudgedCandidates.short`. The mesh need not resolve roots of D that the count proves complete.

        The mesh must resolve vectors, and eigenvalues without a proof.
        """
        error = found.worst(self.modes) / self.request.accuracy
        if verdict is not None and verdict.agrees and not self.with_vectors:
            return error
        allowed = SEARCH.largest_displacement if self.problem.bounded else SEARCH.unbounded_displacement
        coarseness = float(found.roots.displacement[: self.modes].max())
        return max(error, coarseness / (self.request.accuracy if self.with_vectors else allowed))

    def request_missing(self, number: int, here: int) -> None:
        """Requests more eigenvalues or a finer mesh: the winding number counts `number`, and `here` are
        found.
        """
        if number <= here:  # spurious eigenvalues, or a line within the errors
            self.mesh = self.problem.finer(self.mesh)
            return
        more = number + SEARCH.spare_modes
        if more <= self.wanted:  # the missing ones are further from the shift, or unresolved
            more = self.wanted + number - here + SEARCH.spare_modes
            self.mesh = self.problem.finer(self.mesh)
        self.request_more(more)

    def needs_beyond_axis(self, found: Candidates) -> bool:
        """Whether eigenvalues beyond the axis are needed for a count, or for a list that nothing proves."""
        if not (self.request.certify and self.problem.is_count_slow and (found.roots.w.real > 0).all()):
            return False
        return len(found.roots.w) < SEARCH.enough_unproved or self.problem.countable

    def request_beyond_axis(self, number: int) -> None:
        """Requests more eigenvalues than the `number` found, which all grow: a count needs those beyond."""
        self.unresolved = True
        if number < self.wanted:
            self.mesh = self.problem.finer(self.mesh)
        self.request_more(max(self.wanted, 2 * number + SEARCH.spare_modes))

    def request_more(self, wanted: int) -> None:
        """Requests a larger number of eigenvalues, on a mesh that holds as many."""
        while (
            wanted > self.mesh.unknowns // SEARCH.unknowns_a_mode
            and self.mesh.unknowns <= RESOLUTION.most_unknowns
        ):
            self.mesh = self.problem.finer(self.mesh)
        self.wanted = wanted

    def keep(self, judged: JudgedCandidates) -> None:
        """Keeps the candidates if better than all before; counts attempts without progress."""
        best = self.best
        better = best is None or judged.grade < (best.grade[0], SEARCH.progress * best.short)
        self.stalled = 0 if better else self.stalled + 1
        if best is None or judged.grade <= best.grade or judged.short <= SEARCH.error_share:
            self.best = judged

    def concluded(self) -> Spectrum:
        """The best result, or the reason for having none."""
        if self.best is not None:
            return _result(self.best, self.problem, self.request)
        if self.lost is not None:
            lost = self.lost
            counted = f"the winding number counts {lost.count.number} eigenvalues where {lost.here} are found"
            return no_spectrum(SpectrumStatus.modes_missing, self.request, counted)
        if self.unresolved:
            why = "no mesh resolves all eigenvalues that may be the leading ones"
            return no_spectrum(SpectrumStatus.modes_missing, self.request, why)
        return no_spectrum(SpectrumStatus.failed, self.request, self.why)


def _result(best: JudgedCandidates, problem: TransverseProblem, request: SpectrumRequest) -> Spectrum:
    """The outcome with its numbers and the extent of their proof."""
    found = best.found.roots
    verdict = best.verdict
    accurate = best.short <= SEARCH.stalled_error_share
    status = SpectrumStatus.ok if accurate else SpectrumStatus.accuracy_not_reached
    proved = verdict is not None and verdict.agrees
    w: Any = found.w.tolist()
    on_the_axis: Any = found.on_the_axis.tolist()
    undecided = any(on_the_axis)
    message = ""
    if status == SpectrumStatus.ok and request.certify:
        if undecided:
            status = SpectrumStatus.undecided
        elif not proved:
            status = SpectrumStatus.not_certified
            message = verdict.count.why_not if verdict else ""
    unstable = sum(value.real > 0 for value in w)
    # Without a request for a proof, the unstable modes are known if the search went beyond them.
    known = not undecided and (proved if request.certify else unstable < len(found.w))
    return Spectrum(
        status=status,
        eigenvalues=found.w[: request.modes],
        error_estimate=stated_errors(found.w, found.error, problem.rod)[: request.modes],
        unstable_count=unstable if known else -1,
        certified=proved and not undecided,
        elements=best.found.mesh.elements,
        order=best.found.mesh.order,
        vectors=vectors_on_nodes(problem, request, best.found.mesh, best.found.vectors),
        message=message,
    )
