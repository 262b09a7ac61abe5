"""The leading eigenvalues of one rod by SLEPc alone: Krylov-Schur on two meshes, without D.

The finer mesh gives the eigenvalues, what the coarser one has instead gives their errors. Krylov-Schur finds
the eigenvalues nearest a shift above the growth rate of the most amplified wave; twice as many are asked for
until the leading ones stay the same. That proves nothing: nothing is certified.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...discretization.elements.resolution import MOST_UNKNOWNS, mesh_accuracy
from ...model.rod import Rod
from ..point import Unsolvable, solved
from .problem import Mesh, TransverseProblem, forget_solvers, problem_of
from .spectrum import Spectrum, SpectrumRequest, no_spectrum, vectors_on_nodes
from .status import SpectrumStatus

MOST_FINER = 8
"""Meshes tried after the first, each a third finer."""
SPARE = 2
"""Eigenvalues asked for at first beyond the wanted ones."""
UNCHANGED = 1e-9
"""Relative change of the leading eigenvalues below which more eigenvalues do not change them."""
SAFETY, ROUNDING = 3.0, 3e-13
"""Factor on what two meshes differ by, and rounding error of an eigenvalue in units of its modulus, the shift
and F^2: under a pull the first eigenvalue is exponentially small against the latter."""


def solve_on_two_meshes(rod: Rod, request: SpectrumRequest) -> Spectrum:
    """The leading `request.modes` eigenvalues of `rod`; failures are a status, never an exception.

    Nothing is proved, whatever `request.certify` says.
    """

    def failed(cause: str) -> Spectrum:
        forget_solvers()
        return no_spectrum(SpectrumStatus.failed, request, cause)

    return solved(lambda: _solve(rod, request), failed)


def _solve(rod: Rod, request: SpectrumRequest) -> Spectrum:
    problem, modes = problem_of(rod), request.modes
    aim = mesh_accuracy(request.accuracy, vectors=True) if request.vector_nodes else request.accuracy
    mesh: Mesh = problem.mesh_for(modes, aim)
    before = _leading(problem, mesh, modes)
    best: Spectrum | None = None
    for _ in range(MOST_FINER):
        mesh = problem.finer(mesh)
        if mesh.unknowns > MOST_UNKNOWNS:
            break
        found = _leading(problem, mesh, modes)
        if len(found.w) >= modes and len(before.w):
            scale = abs(problem.shift) + rod.F**2
            here = _spectrum(problem, request, mesh, found, _errors(found.w, before.w, scale))
            if here.status == SpectrumStatus.ok:
                return here
            best = here if best is None else min(best, here, key=_worst)  # the finest may round most
        before = found
    if best is None:
        raise Unsolvable("no mesh within the limit has as many eigenvalues as are wanted")
    # Where rounding is what keeps the meshes apart, either may be off by more than they differ.
    return replace(best, error_estimate=SAFETY * best.error_estimate)


class _Found(NamedTuple):
    """Eigenvalues of a mesh, sorted as `rodsweep.model` states, (k,); indices: of each in SLEPc, (k,)."""

    w: Complex
    indices: NDArray[np.intp]


def _leading(problem: TransverseProblem, mesh: Mesh, modes: int) -> _Found:
    """At least so many leading eigenvalues of a mesh among all that were found on it.

    None of a mesh so coarse that twice as many cannot be asked for.
    """
    solver, wanted, before = problem.solver(mesh), modes + SPARE, np.empty(0, complex)
    while True:
        raw = solver.solve(problem.rod, problem.shift, wanted, tight=True)
        order = np.lexsort((-raw.imag, -raw.real))
        leading = raw[order[:modes]]
        same = len(leading) == len(before) == modes and np.allclose(leading, before, rtol=UNCHANGED, atol=0)
        if same:
            return _Found(raw[order], order)
        if 2 * wanted > mesh.unknowns // 3:
            return _Found(raw[:0], order[:0])
        before, wanted = leading, 2 * wanted


def _worst(found: Spectrum) -> float:
    """The largest relative error."""
    return float((found.error_estimate / np.abs(found.eigenvalues)).max())


def _errors(w: Complex, coarser: Complex, scale: float) -> Array:
    """Absolute errors of sorted eigenvalues, (k,), by those of a coarser mesh, (l,), in any order.

    scale: of the rates to which the matrix is rounded, in 1/tau2. Two meshes may round one eigenvalue alike
    by chance: each gets the relative error of its neighbours, too. Where two eigenvalues are about to meet,
    rounding grows, and the difference of the meshes with it.
    """
    apart = np.abs(w[:, None] - coarser).min(axis=1) / np.abs(w)
    padded = np.pad(apart, 1)
    relative = np.max([padded[:-2], padded[1:-1], padded[2:]], axis=0)
    others = np.abs(w[:, None] - w) + np.diag(np.full(len(w), np.inf))
    meeting = np.sqrt(1 + np.abs(w) / others.min(axis=1, initial=np.inf))
    errors: Array = SAFETY * relative * np.abs(w) + ROUNDING * meeting * (np.abs(w) + scale)
    return errors


def _spectrum(
    problem: TransverseProblem, request: SpectrumRequest, mesh: Mesh, found: _Found, error: Array
) -> Spectrum:
    """The outcome of a mesh; error: absolute, of all its eigenvalues, (k,)."""
    w, modes = found.w, request.modes
    enough = bool((error[:modes] <= request.accuracy * np.abs(w[:modes])).all())
    vectors = None
    if request.vector_nodes and enough:
        vectors = problem.solver(mesh).vectors(len(w))[:, found.indices]
    unstable = int((w.real > 0).sum())
    decide = slice(max(modes, unstable + 1))  # what is sorted behind decays faster
    known = unstable < len(w) and not (np.abs(w.real) <= error)[decide].any()
    return Spectrum(
        status=SpectrumStatus.ok if enough else SpectrumStatus.accuracy_not_reached,
        eigenvalues=w[:modes],
        error_estimate=error[:modes],
        unstable_count=unstable if known else -1,
        elements=mesh.elements,
        order=mesh.order,
        vectors=vectors_on_nodes(problem, request, mesh, vectors),
    )
