"""The leading eigenvalues of one rod: as few unknowns as the accuracy needs, none missed.

One attempt solves at a resolution, about a shift, for a number of eigenvalues. Two judges that know
nothing of meshes decide what to change next: the Newton correction of D at each eigenvalue
(resolution) and the winding number of D (missing eigenvalues). Both must agree before a point is ok.
"""

import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..discretization.quadrature import gauss_lobatto
from ..discretization.resolution import (
    MOST_UNKNOWNS,
    Resolution,
    expected_wave_number,
    finer,
    resolution_for,
)
from ..model.determinant import newton_corrections
from ..model.dispersion import most_amplified_wave, wave_numbers
from ..model.rod import Rod
from .certificate import Count, count_right_of
from .eigenpairs import eigen_solver, forget_solvers
from .petsc import PETSc
from .status import Status

SHIFT_ABOVE_GROWTH = 1.05
"""Shift in units of the growth rate of the most amplified wave, which bounds most spectra."""
SPARE_MODES = 1
"""Eigenvalues asked for beyond the wanted ones, to see where the next gap is."""
MOST_ATTEMPTS = 14
STALLED = 2
"""Refinements without a better error after which rounding, not the mesh, is taken as the limit."""
A_ROOT = 1e-2
"""Newton correction, in units of the length over which D changes, that still stands for a root of D."""
WIDE_GAP = 0.05
"""Relative gap between two real parts that is wide enough to draw a line through."""
NO_GAP = 1e-6
"""Relative gap below which two real parts count as equal."""
MOST_LINES = 3
"""Lines tried before the count is given up."""
REAL_BELOW = 1e-14
"""Relative imaginary part below which an eigenvalue is real: what rounding leaves of zero."""


@dataclass(frozen=True, slots=True)
class SpectrumRequest:
    """What is asked of every point: the number of modes, a relative accuracy, and the extras."""

    modes: int
    accuracy: float
    certify: bool
    vector_nodes: int = 0
    """Number of Lobatto nodes on which (Y, Theta) are wanted; 0 for none."""

    @property
    def mesh_accuracy(self) -> float:
        """What the mesh is chosen for: a vector's error is the square root of its eigenvalue's."""
        return self.accuracy**2 if self.vector_nodes else self.accuracy


@dataclass(frozen=True, slots=True)
class Spectrum:
    """The leading transverse eigenvalues of one rod, in the order that `rodsweep.model` states.

    eigenvalues: complex, shape (modes,), in 1/tau2; error_estimate: |D/D'|, shape (modes,).
    unstable_count: eigenvalues with Re w > 0, or -1 where it is not known.
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


@dataclass(frozen=True, slots=True)
class _Found:
    """Everything one attempt found, sorted; only eigenvalues that stand for a root of D."""

    resolution: Resolution
    w: NDArray[np.complex128]
    error: NDArray[np.float64]
    vectors: NDArray[np.complex128] | None

    def worst(self, modes: int) -> float:
        """Largest relative error estimate of the leading modes; inf when there are too few."""
        if len(self.w) < modes:
            return np.inf
        return float((self.error[:modes] / np.abs(self.w[:modes])).max())


def vector_points(nodes: int) -> NDArray[np.float64]:
    """The Lobatto nodes in [0, 1] on which vectors are given, shape (nodes,)."""
    return (gauss_lobatto(nodes - 1)[0] + 1) / 2


def solve_spectrum(rod: Rod, request: SpectrumRequest) -> Spectrum:
    """The leading `request.modes` eigenvalues of `rod`; failures are a status, never an exception."""
    started = time.perf_counter()
    try:
        outcome = _solve(rod, request)
    except (PETSc.Error, np.linalg.LinAlgError, FloatingPointError, OverflowError, MemoryError) as error:
        forget_solvers()  # a PETSc object is not usable after an error inside it
        outcome = _nothing(Status.failed, request, str(error).splitlines()[-1])
    return replace(outcome, seconds=time.perf_counter() - started)


def warm_up() -> None:
    """Loads what is compiled and created at first use, so that no point pays for it."""
    _solve(Rod(30.0, 1e4, 1e4, 1e-4), SpectrumRequest(modes=2, accuracy=1e-4, certify=True))


def _solve(rod: Rod, request: SpectrumRequest) -> Spectrum:
    growth, wave = most_amplified_wave(rod)
    shift = SHIFT_ABOVE_GROWTH * growth
    wave_number = expected_wave_number(request.modes, wave)
    resolution = resolution_for(wave_number, request.mesh_accuracy)
    wanted = request.modes + SPARE_MODES
    best: _Found | None = None
    count: Count | None = None
    stalled = 0
    for _ in range(MOST_ATTEMPTS):
        if resolution.unknowns > MOST_UNKNOWNS:
            break
        found = _attempt(rod, resolution, shift, wanted, request.vector_nodes > 0)
        worst = found.worst(request.modes)
        if len(found.w) < request.modes:
            # Either too few converged, or what converged stands for no root yet: do both more.
            wanted, resolution = wanted + request.modes, finer(resolution)
            continue
        stalled = 0 if best is None or worst < 0.5 * best.worst(request.modes) else stalled + 1
        if best is None or len(found.w) > len(best.w) or worst <= best.worst(request.modes):
            best = found
        if request.certify:
            count, line = _count(rod, found, request.modes)
            here = int((found.w.real > line).sum())
            if count.number is not None and count.number > here:
                wanted = max(wanted, len(found.w)) + (count.number - here) + SPARE_MODES
                if _covers(found, wanted):
                    resolution = finer(resolution)
                stalled = 0
                continue
            if count.number is not None and count.number < here:
                resolution, stalled = finer(resolution), 0
                continue
        if worst <= request.accuracy:
            return _finished(rod, request, found, count)
        if stalled >= STALLED:
            break
        resolution = _next_resolution(rod, found, request)
    return _given_up(rod, request, best, count)


def _attempt(rod: Rod, resolution: Resolution, shift: float, wanted: int, vectors: bool) -> _Found:
    """One solve; what does not stand for a root of D of its own is dropped."""
    w, X = eigen_solver(resolution).solve(rod, shift, wanted, vectors)
    finite = np.isfinite(w)
    w, X = w[finite], None if X is None else X[:, finite]
    w = np.where(np.abs(w.imag) <= REAL_BELOW * np.abs(w), w.real, w)
    correction, length = newton_corrections(w, rod)
    error = np.abs(correction)
    apart = np.abs(w[:, None] - w[None, :])
    np.fill_diagonal(apart, np.inf)
    nearest = apart.min(axis=1) if len(w) > 1 else np.full(len(w), np.inf)
    root = (error <= A_ROOT * length) & (error <= nearest)
    order = np.lexsort((-w.imag, -w.real))
    order = order[root[order]]
    return _Found(resolution, w[order], error[order], None if X is None else X[:, order])


def _covers(found: _Found, wanted: int) -> bool:
    """Whether the mesh can hardly hold as many resolved modes as are wanted."""
    return wanted > found.resolution.unknowns // 6


def _next_resolution(rod: Rod, found: _Found, request: SpectrumRequest) -> Resolution:
    """A finer mesh: what the wave numbers now known ask for, at least the next finer one."""
    wave = max(max(wave_numbers(w, rod)) for w in found.w[: request.modes])
    informed = resolution_for(wave, request.mesh_accuracy)
    least = finer(found.resolution)
    return informed if informed.unknowns >= least.unknowns else least


def _count(rod: Rod, found: _Found, modes: int) -> tuple[Count, float]:
    """The winding number right of a line below the last wanted and below every unstable mode."""
    count, line = Count(None, 0), 0.0
    for line in _lines(found.w.real.tolist(), modes):
        count = count_right_of(line, rod)
        if count.number is not None:
            break
    return count, line


def _lines(real: list[float], modes: int) -> list[float]:
    """Where to draw the line, best first: in gaps between the real parts, the first wide one foremost.

    Behind the last of them it is drawn through the unknown, where the count may ask for more.
    """
    target = min(real[modes - 1], 0.0)
    below = [target] + [x for x in real if x < target]
    gaps = [
        (min((r - l) / abs(l), WIDE_GAP), (l + r) / 2) for l, r in zip(below[1:], below[:-1], strict=True)
    ]
    gaps.sort(key=lambda gap: -gap[0])  # stable: of the wide ones the first stays foremost
    lines = [middle for width, middle in gaps if width > NO_GAP][: MOST_LINES - 1]
    last = below[-1]
    return [*lines, last - WIDE_GAP * (abs(last) if last < 0 else abs(real[0]) + 1.0)]


def _undecided(found: _Found) -> bool:
    """Whether some eigenvalue lies on the imaginary axis within its error."""
    margin = np.maximum(4 * found.error, 1e-13 * np.abs(found.w))
    return bool((np.abs(found.w.real) <= margin).any())


def _finished(rod: Rod, request: SpectrumRequest, found: _Found, count: Count | None) -> Spectrum:
    status, message = Status.ok, ""
    certified = count is not None and count.number is not None
    if request.certify and not certified:
        status, message = Status.not_certified, count.why_not if count else ""
    undecided = _undecided(found)
    if undecided and request.certify:
        status = Status.undecided
    return _result(status, rod, request, found, None if undecided else certified, message)


def _given_up(rod: Rod, request: SpectrumRequest, best: _Found | None, count: Count | None) -> Spectrum:
    """The outcome when no attempt satisfied both judges: numbers only where none are wrong."""
    if best is None:
        return _nothing(Status.failed, request, "no mesh within the limit resolves the wanted modes")
    if count is not None and count.number is not None:
        line = min(best.w[request.modes - 1].real, 0.0)
        if count.number != int((best.w.real >= line).sum()):
            return _nothing(Status.modes_missing, request, f"the winding number counts {count.number}")
    certified = count is not None and count.number is not None
    undecided = _undecided(best)
    return _result(Status.accuracy_not_reached, rod, request, best, None if undecided else certified, "")


def _result(
    status: Status, rod: Rod, request: SpectrumRequest, found: _Found, certified: bool | None, message: str
) -> Spectrum:
    """The outcome with its numbers; `certified` is None where the sign of a growth rate is undecided."""
    m = request.modes
    return Spectrum(
        status=status,
        eigenvalues=found.w[:m],
        error_estimate=found.error[:m],
        unstable_count=-1 if certified is None else int((found.w.real > 0).sum()),
        certified=bool(certified),
        elements=found.resolution.elements,
        order=found.resolution.order,
        seconds=0.0,
        vectors=_vectors(rod, request, found),
        message=message,
    )


def _vectors(rod: Rod, request: SpectrumRequest, found: _Found) -> NDArray[np.complex128] | None:
    """(Y, Theta) on the Lobatto nodes; NaN where Y(1) vanishes and cannot be scaled to 1."""
    if found.vectors is None:
        return None
    pencil = eigen_solver(found.resolution).pencil
    y, theta = pencil.fields(found.vectors[:, : request.modes], rod)
    matrix = pencil.evaluation(vector_points(request.vector_nodes))
    tip = y[-1]
    size = np.maximum(np.abs(y).max(axis=0), np.abs(theta).max(axis=0))
    tip = np.where(np.abs(tip) > 1e-10 * size, tip, np.nan)
    return np.stack([(matrix @ y / tip).T, (matrix @ theta / tip).T])


def _nothing(status: Status, request: SpectrumRequest, message: str) -> Spectrum:
    empty = np.full(request.modes, np.nan)
    vectors = None
    if request.vector_nodes:
        vectors = np.full((2, request.modes, request.vector_nodes), np.nan + 0j)
    return Spectrum(status, empty + 0j, empty, -1, False, 0, 0, 0.0, vectors, message)
