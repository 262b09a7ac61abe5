"""The leading eigenvalues of one rod: as few unknowns as the accuracy needs, none missed.

One attempt (`rodsweep.solve.spectrum.candidates`) solves at a resolution, about a shift, for a number of
eigenvalues, and refines them on D. How far the mesh was off, the error that is left and the count decide
what to change next; all must be in order before a point is ok.
"""

import time
from dataclasses import dataclass
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from ...determinant.box import squared_amplification
from ...discretization.quadrature import lobatto_points
from ...discretization.resolution import (
    MOST_UNKNOWNS,
    Resolution,
    expected_wave_number,
    finer,
    mesh_accuracy,
    resolution_for,
)
from ...model.dispersion import most_amplified_wave
from ...model.rod import Rod
from .candidates import PETSC_ERRORS, Found, Verdict, attempt, cause_of, judge
from .krylov_schur import eigen_solver, forget_solvers
from .status import Status

SHIFT_ABOVE_GROWTH = 1.05
"""Shift in units of the growth rate of the most amplified wave, which bounds most spectra."""
SPARE_MODES = 1
"""Eigenvalues asked for beyond those that the winding number counts."""
MOST_ATTEMPTS = 12
MOST_FAILURES = 3
"""Attempts that may end with an error inside PETSc, SLEPc or LAPACK."""
STALLED = 2
"""Refinements without a better error after which rounding, not the mesh, is taken as the limit."""
SAFETY, STALLED_SAFETY = 0.5, 0.8
"""Share of the accuracy that the error estimate may use up, being an estimate; more where rounding stalls."""
LARGEST_DISPLACEMENT, UNBOUNDED_DISPLACEMENT = 1e-3, 1e-6
"""Relative displacement of a mesh's eigenvalues from the roots of D that they lead to, beyond which it may
have missed what it was to find; where no bound holds its convergence is the only witness."""
NO_TIP = 1e-10
"""Y(1) in units of the largest value, below which a vector cannot be scaled by it."""


@dataclass(frozen=True, slots=True)
class SpectrumRequest:
    """What is asked of every point: the number of modes, a relative accuracy, and the extras."""

    modes: int
    accuracy: float
    certify: bool
    vector_nodes: int = 0
    """Number of Lobatto nodes on which (Y, Theta) are wanted; 0 for none."""


@dataclass(frozen=True, slots=True)
class Spectrum:
    """The leading transverse eigenvalues of one rod, in the order that `rodsweep.model` states.

    eigenvalues: complex, shape (modes,), in 1/tau2; error_estimate: |D/D'|, shape (modes,): at least a tenth
    of the error, and at most ten times it where that is no less than rounding of the force or of w makes it.
    unstable_count: eigenvalues with Re w > 0, or -1 where it is not known; proved where that was asked for.
    certified: the winding number proves that none right of the last given mode is missing.
    vectors: (Y, Theta), complex, shape (2, modes, vector_nodes), scaled to Y(1) = 1; or None.
    """

    status: Status
    eigenvalues: NDArray[np.complex128]
    error_estimate: NDArray[np.float64]
    unstable_count: int
    certified: bool
    elements: int
    order: int
    seconds: float
    vectors: NDArray[np.complex128] | None = None
    message: str = ""


def solve_spectrum(rod: Rod, request: SpectrumRequest) -> Spectrum:
    """The leading `request.modes` eigenvalues of `rod`; failures are a status, never an exception."""
    started = time.perf_counter()
    try:
        with np.errstate(all="ignore"):
            return _solve(rod, request, started)
    except (*PETSC_ERRORS, ArithmeticError, MemoryError) as error:
        forget_solvers()
        return _nothing(Status.failed, request, cause_of(error), started)


def warm_up() -> None:
    """Loads what is compiled and created at first use, so that no point pays for it."""
    _solve(Rod(30.0, 1e4, 1e4, 1e-4), SpectrumRequest(2, 1e-4, certify=True), time.perf_counter())


def _solve(rod: Rod, request: SpectrumRequest, started: float) -> Spectrum:
    growth, wave = most_amplified_wave(rod)
    shift = SHIFT_ABOVE_GROWTH * growth
    bounded = isfinite(squared_amplification(rod))
    aim = mesh_accuracy(request.accuracy, request.vector_nodes > 0) if bounded else request.accuracy
    resolution = resolution_for(expected_wave_number(request.modes, wave), aim)
    wanted = request.modes
    best: tuple[tuple[bool, float], Found, Verdict | None] | None = None
    lost: Verdict | None = None
    unresolved, stalled, failures = False, 0, 0
    why = "no mesh within the limit resolves the wanted modes"
    vectors = request.vector_nodes > 0
    for turn in range(MOST_ATTEMPTS):
        if resolution.unknowns > MOST_UNKNOWNS or failures > MOST_FAILURES:
            break
        found = attempt(rod, resolution, wanted, shift, vectors, tight=vectors or turn > 0)
        if len(found.w) < request.modes:
            # Too few converged, what converged stands for no root yet, or SLEPc failed: do both more.
            failures += bool(found.failure)
            why = found.failure or why
            wanted, resolution = wanted + request.modes, finer(resolution)
            continue
        verdict = judge(rod, found, request.modes) if request.certify else None
        if verdict is not None and verdict.count.number is not None and not verdict.agrees:
            lost = verdict
            wanted, resolution = _search_more(verdict, wanted, resolution)
            continue
        if verdict is not None and verdict.count.number is None and found.ahead:
            unresolved, resolution = True, finer(resolution)  # neither mesh nor count can tell what leads
            continue
        short = _shortfall(found, verdict, request, bounded)
        rank = verdict is not None and verdict.count.number is None, short
        stalled = 0 if best is None or rank < (best[0][0], 0.5 * best[0][1]) else stalled + 1
        if best is None or rank <= best[0]:
            best = rank, found, verdict
        if short <= SAFETY:
            return _result(Status.ok, rod, request, (found, verdict), started)
        if stalled >= STALLED:
            break
        resolution = _next_resolution(found, request.modes, aim)
    if best is not None:
        (_, short), found, verdict = best
        status = Status.ok if short <= STALLED_SAFETY else Status.accuracy_not_reached
        return _result(status, rod, request, (found, verdict), started)
    if lost is not None:
        return _nothing(
            Status.modes_missing, request, f"the winding number counts {lost.count.number}", started
        )
    if unresolved:
        return _nothing(Status.modes_missing, request, "no mesh resolves what may lead", started)
    return _nothing(Status.failed, request, why, started)


def _shortfall(found: Found, verdict: Verdict | None, request: SpectrumRequest, bounded: bool) -> float:
    """The largest of what may be too large, in units of what is allowed.

    Roots of D that the count proves to be all need no witness in the mesh; vectors do, and what no count
    can prove.
    """
    error = found.worst(request.modes) / request.accuracy
    if verdict is not None and verdict.agrees and not request.vector_nodes:
        return error
    allowed = LARGEST_DISPLACEMENT if bounded else UNBOUNDED_DISPLACEMENT
    return max(
        error, found.coarseness(request.modes) / (request.accuracy if request.vector_nodes else allowed)
    )


def _search_more(verdict: Verdict, wanted: int, resolution: Resolution) -> tuple[int, Resolution]:
    """(eigenvalues to ask for, mesh) after a count that the found eigenvalues do not explain."""
    number = verdict.count.number or 0
    if number <= verdict.here:  # impostors, or a line that the mesh leaves within the errors
        return wanted, finer(resolution)
    more = number + SPARE_MODES
    if more <= wanted:  # enough were asked for: they are farther from the shift, or beyond the mesh
        more, resolution = wanted + number - verdict.here + SPARE_MODES, finer(resolution)
    while more > resolution.unknowns // 6 and resolution.unknowns <= MOST_UNKNOWNS:
        resolution = finer(resolution)
    return more, resolution


def _next_resolution(found: Found, modes: int, mesh_accuracy: float) -> Resolution:
    """A finer mesh: what the wave numbers now known ask for, at least the next finer one."""
    informed = resolution_for(float(found.wave[:modes].max()), mesh_accuracy)
    least = finer(found.resolution)
    return informed if informed.unknowns >= least.unknowns else least


def _result(
    status: Status, rod: Rod, request: SpectrumRequest, judged: tuple[Found, Verdict | None], started: float
) -> Spectrum:
    """The outcome with its numbers, and how far they are proved."""
    found, verdict = judged
    m = request.modes
    proved = verdict is not None and verdict.agrees
    undecided = bool(found.on_the_axis.any())
    message = ""
    if status == Status.ok and request.certify:
        if undecided:
            status = Status.undecided
        elif not proved:
            status, message = Status.not_certified, verdict.count.why_not if verdict else ""
    unstable = int((found.w.real > 0).sum())
    # Where no proof is asked for the unstable modes are counted if the search went past them.
    known = not undecided and (proved if request.certify else unstable < len(found.w))
    return Spectrum(
        status=status,
        eigenvalues=found.w[:m],
        error_estimate=found.error[:m],
        unstable_count=unstable if known else -1,
        certified=proved and not undecided,
        elements=found.resolution.elements,
        order=found.resolution.order,
        vectors=_vectors(rod, request, found),
        seconds=time.perf_counter() - started,
        message=message,
    )


def _vectors(rod: Rod, request: SpectrumRequest, found: Found) -> NDArray[np.complex128] | None:
    """(Y, Theta) on the Lobatto nodes; NaN where Y(1) vanishes and cannot be scaled to 1."""
    if found.vectors is None:
        return None
    pencil = eigen_solver(found.resolution).pencil
    y, theta = pencil.fields(found.vectors[:, : request.modes], rod)
    matrix = pencil.evaluation(lobatto_points(request.vector_nodes))
    size = np.maximum(np.abs(y).max(axis=0), np.abs(theta).max(axis=0))
    scale = np.full(len(size), np.nan + 0j)
    tipped = np.abs(y[-1]) > NO_TIP * size
    scale[tipped] = 1 / y[-1][tipped]
    return np.stack([(matrix @ y * scale).T, (matrix @ theta * scale).T])


def _nothing(status: Status, request: SpectrumRequest, message: str, started: float) -> Spectrum:
    empty = np.full(request.modes, np.nan)
    vectors = None
    if request.vector_nodes:
        vectors = np.full((2, request.modes, request.vector_nodes), np.nan + 0j)
    seconds = time.perf_counter() - started
    return Spectrum(status, empty + 0j, empty, -1, False, 0, 0, seconds, vectors, message)
