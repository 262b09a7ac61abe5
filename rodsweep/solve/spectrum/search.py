"""The leading eigenvalues of one rod: as few unknowns as the accuracy needs, none missed.

One attempt (`rodsweep.solve.spectrum.candidates`) solves at a resolution, about a shift, for a number of
eigenvalues, and refines them on D. How far the mesh was off, the error that is left and the count decide
what to change next; all must be in order before a point is ok.
"""

from dataclasses import dataclass, replace
from typing import Any

from ...discretization.elements.resolution import MOST_UNKNOWNS, mesh_accuracy
from ...model.rod import Rod
from ..point import solved
from .candidates import Candidates, Verdict, attempt, judge
from .problem import TransverseProblem, forget_solvers, problem_of
from .spectrum import Spectrum, SpectrumRequest, no_spectrum, vectors_on_nodes
from .status import SpectrumStatus

__all__ = ["Search", "Spectrum", "SpectrumRequest", "solve_spectrum", "warm_up"]

SPARE_MODES = 1
"""Eigenvalues asked for beyond those that the winding number counts."""
MOST_MESHES_TRIED = 12
MOST_FAILURES = 3
"""Attempts that may end with an error inside PETSc, SLEPc or LAPACK."""
NO_PROGRESS = 2
"""Refinements without a better error after which rounding, not the mesh, is taken as the limit."""
SAFETY, STALLED_SAFETY = 0.5, 0.8
"""Share of the accuracy that the error estimate may use up, being an estimate; more where rounding stalls."""
LARGEST_DISPLACEMENT, UNBOUNDED_DISPLACEMENT = 1e-3, 1e-6
"""Relative displacement of a mesh's eigenvalues from the roots of D that they lead to, beyond which it may
have missed what it was to find; where no bound holds its convergence is the only witness."""


@dataclass(frozen=True, slots=True)
class Judged:
    """Candidates with their count, if one was asked for, and how far short of the request they fall."""

    found: Candidates
    verdict: Verdict | None
    short: float
    """The largest of what may be too large, in units of what is allowed."""

    @property
    def grade(self) -> tuple[bool, float]:
        """Less is better: first what a count decides, then what is more accurate."""
        return self.verdict is not None and self.verdict.count.number is None, self.short


def solve_spectrum(rod: Rod, request: SpectrumRequest) -> Spectrum:
    """The leading `request.modes` eigenvalues of `rod`; failures are a status, never an exception."""

    def failed(cause: str) -> Spectrum:
        forget_solvers()
        return no_spectrum(SpectrumStatus.failed, request, cause)

    if rod.uniform and not rod.standard:
        return _in_own_time(rod, request)
    return solved(lambda: Search(rod, request).outcome(), failed)


def _in_own_time(rod: Rod, request: SpectrumRequest) -> Spectrum:
    """The spectrum of a uniform rod of any law, from that of the linear rod to which it is equivalent."""
    linear, rate = rod.equivalent
    found = solve_spectrum(linear, request)
    return replace(found, eigenvalues=rate * found.eigenvalues, error_estimate=rate * found.error_estimate)


def warm_up() -> None:
    """Loads what is compiled and created at first use, so that no point pays for it."""
    Search(Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4), SpectrumRequest(2, 1e-4, certify=True)).outcome()


class Search:
    """The search for one rod's leading eigenvalues: what to try next, the best so far, what went wrong.

    wanted: how many eigenvalues the mesh is asked for at first, by default as many as the request.
    """

    def __init__(self, rod: Rod, request: SpectrumRequest, wanted: int | None = None):
        self.problem, self.request, self.modes = problem_of(rod), request, request.modes
        self.with_vectors = request.vector_nodes > 0
        bounded = self.problem.bounded
        self.aim = mesh_accuracy(request.accuracy, self.with_vectors) if bounded else request.accuracy
        self.mesh = self.problem.mesh_for(request.modes, self.aim)
        self.wanted = request.modes if wanted is None else wanted
        self.best: Judged | None = None
        self.stalled = self.failures = 0
        self.lost: Verdict | None = None
        """The last count that the eigenvalues found do not explain."""
        self.unresolved = False
        """Whether neither mesh nor count could tell what leads."""
        self.why = "no mesh within the limit resolves the wanted modes"

    def outcome(self) -> Spectrum:
        """Tries meshes until one is good enough or none gets better."""
        for turn in range(MOST_MESHES_TRIED):
            if self.mesh.unknowns > MOST_UNKNOWNS or self.failures > MOST_FAILURES:
                break
            tight = self.with_vectors or turn > 0
            found = attempt(self.problem, self.mesh, self.wanted, self.with_vectors, tight)
            judged = self.judged(found)
            if judged is None:
                continue
            self.keep(judged)
            if judged.short <= SAFETY or self.stalled >= NO_PROGRESS:
                break
            self.mesh = self.problem.informed(found.mesh, found.roots.wave[: self.modes], self.aim)
        return self.concluded()

    def judged(self, found: Candidates) -> Judged | None:
        """The candidates if nothing is missing among them; else what to change before the next attempt."""
        if len(found.roots.w) < self.modes:
            # Too few converged, what converged stands for no root yet, or SLEPc failed: do both more.
            self.failures += bool(found.failure)
            self.why = found.failure or self.why
            self.wanted, self.mesh = self.wanted + self.modes, self.problem.finer(self.mesh)
            return None
        verdict = judge(self.problem, found.roots, self.modes) if self.request.certify else None
        if verdict is not None and verdict.count.number is None and found.roots.ahead:
            self.unresolved, self.mesh = True, self.problem.finer(self.mesh)
            return None
        if verdict is not None and verdict.count.number is not None and not verdict.agrees:
            self.lost = verdict
            self.search_more(verdict.count.number, verdict.here)
            return None
        return Judged(found, verdict, self.shortfall(found, verdict))

    def shortfall(self, found: Candidates, verdict: Verdict | None) -> float:
        """`Judged.short`: roots of D that the count proves to be all need no witness in the mesh.

        Vectors do, and what no count can prove.
        """
        error = found.worst(self.modes) / self.request.accuracy
        if verdict is not None and verdict.agrees and not self.with_vectors:
            return error
        allowed = LARGEST_DISPLACEMENT if self.problem.bounded else UNBOUNDED_DISPLACEMENT
        coarseness = float(found.roots.displacement[: self.modes].max())
        return max(error, coarseness / (self.request.accuracy if self.with_vectors else allowed))

    def search_more(self, number: int, here: int) -> None:
        """Asks for more after a count of `number`, of which `here` were found."""
        if number <= here:  # impostors, or a line that the mesh leaves within the errors
            self.mesh = self.problem.finer(self.mesh)
            return
        more = number + SPARE_MODES
        if more <= self.wanted:  # enough were asked for: they are farther from the shift, or beyond the mesh
            more, self.mesh = self.wanted + number - here + SPARE_MODES, self.problem.finer(self.mesh)
        while more > self.mesh.unknowns // 6 and self.mesh.unknowns <= MOST_UNKNOWNS:
            self.mesh = self.problem.finer(self.mesh)
        self.wanted = more

    def keep(self, judged: Judged) -> None:
        """Keeps the candidates if they are the best so far, and notes whether there is progress."""
        best = self.best
        progress = best is None or judged.grade < (best.grade[0], 0.5 * best.short)
        self.stalled = 0 if progress else self.stalled + 1
        if best is None or judged.grade <= best.grade or judged.short <= SAFETY:
            self.best = judged

    def concluded(self) -> Spectrum:
        """The best that was found, or why there is nothing."""
        if self.best is not None:
            return _result(self.best, self.problem, self.request)
        if self.lost is not None:
            counted = f"the winding number counts {self.lost.count.number}"
            return no_spectrum(SpectrumStatus.modes_missing, self.request, counted)
        if self.unresolved:
            return no_spectrum(SpectrumStatus.modes_missing, self.request, "no mesh resolves what may lead")
        return no_spectrum(SpectrumStatus.failed, self.request, self.why)


def _result(best: Judged, problem: TransverseProblem, request: SpectrumRequest) -> Spectrum:
    """The outcome with its numbers, and how far they are proved."""
    found, verdict = best.found.roots, best.verdict
    status = SpectrumStatus.ok if best.short <= STALLED_SAFETY else SpectrumStatus.accuracy_not_reached
    proved = verdict is not None and verdict.agrees
    w: Any = found.w.tolist()
    on_the_axis: Any = found.on_the_axis.tolist()
    undecided = any(on_the_axis)
    message = ""
    if status == SpectrumStatus.ok and request.certify:
        if undecided:
            status = SpectrumStatus.undecided
        elif not proved:
            status, message = SpectrumStatus.not_certified, verdict.count.why_not if verdict else ""
    unstable = sum(value.real > 0 for value in w)
    # Where no proof is asked for the unstable modes are counted if the search went past them.
    known = not undecided and (proved if request.certify else unstable < len(found.w))
    return Spectrum(
        status=status,
        eigenvalues=found.w[: request.modes],
        error_estimate=found.error[: request.modes],
        unstable_count=unstable if known else -1,
        certified=proved and not undecided,
        elements=best.found.mesh.elements,
        order=best.found.mesh.order,
        vectors=vectors_on_nodes(problem, request, best.found.mesh, best.found.vectors),
        message=message,
    )
