"""Leading eigenvalues of one rod by SLEPc alone: Krylov-Schur on two meshes, without the determinant D.

The finer mesh gives the eigenvalues; the differences from the eigenvalues of the coarser mesh give the
errors. Krylov-Schur finds the eigenvalues nearest to a shift above the growth rate of the most amplified
wave. The number of requested eigenvalues is doubled until the leading eigenvalues stay the same. No result is
certified.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...discretization.elements.resolution import RESOLUTION_SETTINGS, mesh_accuracy
from ...discretization.straight.transverse_mesh import AnyMesh
from ...model.rod import Rod
from ..backend.solver_pools import destroy_pooled_solvers
from ..point_outcome import outcome_or_failure
from ..unsolvable import Unsolvable
from .problem import TransverseProblem, meshes_text, transverse_problem
from .spectrum import Spectrum, SpectrumRequest, failed_spectrum, modes_at_lobatto_nodes
from .status import SpectrumStatus


@dataclass(frozen=True, slots=True, kw_only=True)
class TwoMeshSettings:
    """Settings for eigenvalues whose errors are differences between two meshes."""

    max_finer_meshes: int = 8
    """Maximum number of meshes after the first; each has a third more unknowns than its predecessor."""
    spare_eigenvalues: int = 2
    """Number of eigenvalues requested first on a mesh, in addition to the wanted modes."""
    unchanged_tolerance: float = 1e-9
    """The number of requested eigenvalues is doubled until the leading eigenvalues change relatively by less
    than this."""
    unchanged_rounding_tolerance: float = 3e-11
    """The doubling also ends if the leading eigenvalues change by less than this times (|shift| + F^2). The
    value is a hundred times `rounding`, because rounding differs between releases of SLEPc and between
    processors."""
    mesh_error_factor: float = 3.0
    """Safety factor on the difference between the eigenvalues of two meshes, which estimates the error on
    the finer mesh."""
    rounding: float = 3e-13
    """Rounding error of an eigenvalue w, divided by |w| + |shift| + F^2. F^2 is included because the first
    eigenvalue of a pulled rod is exponentially small compared with F^2."""
    min_unknowns_per_mode: int = 3
    """Minimum number of unknowns of a mesh per requested eigenvalue: a third of the unknowns have no time
    derivative, and the highest modes of a mesh are not resolved."""


TWO_MESH_SETTINGS = TwoMeshSettings()


def solve_on_two_meshes(rod: Rod, request: SpectrumRequest) -> Spectrum:
    """The leading `request.modes` eigenvalues of a rod; a failure is returned as a status, never raised.

    No result is proved; `request.certify` is ignored.
    """

    def failed(cause: str) -> Spectrum:
        destroy_pooled_solvers()
        return failed_spectrum(SpectrumStatus.failed, request, cause)

    return outcome_or_failure(lambda: _spectrum_or_raise(rod, request), failed)


def _spectrum_or_raise(rod: Rod, request: SpectrumRequest) -> Spectrum:
    """The result of `solve_on_two_meshes`; raises Unsolvable if no mesh gives enough eigenvalues."""
    problem = transverse_problem(rod)
    modes = request.modes
    aim = mesh_accuracy(request.accuracy, vectors=True) if request.vector_node_count else request.accuracy
    mesh: AnyMesh = problem.mesh_for(modes, aim)
    before = _leading_eigenvalues(problem, mesh, modes)
    best: Spectrum | None = None
    for _ in range(TWO_MESH_SETTINGS.max_finer_meshes):
        mesh = problem.finer_mesh(mesh)
        if mesh.unknown_count > RESOLUTION_SETTINGS.max_unknowns:
            break
        found = _leading_eigenvalues(problem, mesh, modes)
        if len(found.w) >= modes and len(before.w):
            here = _spectrum_of_mesh(
                problem,
                request,
                mesh,
                found,
                _errors_between_meshes(found.w, before.w, _eigenvalue_rounding_scale(problem)),
            )
            if here.status == SpectrumStatus.ok:
                return here
            # The finest mesh may have the largest rounding error.
            best = here if best is None else min(best, here, key=_largest_error)
        before = found
    if best is None:
        meshes = meshes_text(1 + TWO_MESH_SETTINGS.max_finer_meshes, problem.finer_mesh(mesh))
        raise Unsolvable(f"{meshes} gives the requested number of eigenvalues")
    # If rounding dominates, the error may exceed the difference between the two meshes.
    best = replace(best, error_estimate=TWO_MESH_SETTINGS.mesh_error_factor * best.error_estimate)
    return replace(best, message=_missed_accuracy_text(problem, request, best))


def _missed_accuracy_text(problem: TransverseProblem, request: SpectrumRequest, best: Spectrum) -> str:
    """Which mode misses the requested accuracy by most, by how much, why, and what to change."""
    sizes = np.abs(best.eigenvalues)
    relative = best.error_estimate / sizes
    worst = int(np.argmax(relative))
    rounding = TWO_MESH_SETTINGS.rounding * (sizes[worst] + _eigenvalue_rounding_scale(problem))
    cause = "rounding errors" if rounding > request.accuracy * sizes[worst] else "the meshes"
    reached = float(relative[worst])
    return (
        f"mode {worst + 1} has a relative error of {reached:.2e}, limited by {cause}, but the requested "
        f"accuracy is {request.accuracy:.2e}: use an accuracy above {reached:.2e}, or method: determinant"
    )


def _eigenvalue_rounding_scale(problem: TransverseProblem) -> float:
    """Sum of |shift| and F^2, in 1/tau2: rounding errors of eigenvalues are proportional to this rate."""
    return abs(problem.shift) + problem.rod.F**2


class _MeshEigenvalues(NamedTuple):
    """Eigenvalues w of a mesh, (k,), sorted as defined in `rodsweep.model`, and their indices in SLEPc's
    list, (k,).
    """

    w: Complex
    indices: NDArray[np.intp]


def _leading_eigenvalues(problem: TransverseProblem, mesh: AnyMesh, modes: int) -> _MeshEigenvalues:
    """Sorted eigenvalues of a mesh. The requested number is doubled until the `modes` leading eigenvalues no
    longer change.

    The result is empty if the mesh is too coarse for a doubled request.
    """
    solver = problem.solver(mesh)
    requested = modes + TWO_MESH_SETTINGS.spare_eigenvalues
    # The solver finds the eigenvalues nearest to the shift, which need not lead: more are requested until
    # the leading eigenvalues stay the same.
    before = np.empty(0, complex)
    while True:
        raw = solver.solve(problem.rod, problem.shift, requested, tight=True)
        order = np.lexsort((-raw.imag, -raw.real))
        leading = raw[order[:modes]]
        complete = len(leading) == len(before) == modes
        by_rounding = TWO_MESH_SETTINGS.unchanged_rounding_tolerance * _eigenvalue_rounding_scale(problem)
        if complete and np.allclose(
            leading, before, rtol=TWO_MESH_SETTINGS.unchanged_tolerance, atol=by_rounding
        ):
            return _MeshEigenvalues(raw[order], order)
        if 2 * requested > mesh.unknown_count // TWO_MESH_SETTINGS.min_unknowns_per_mode:
            return _MeshEigenvalues(raw[:0], order[:0])
        before = leading
        requested = 2 * requested


def _largest_error(found: Spectrum) -> float:
    """Largest relative error estimate among the eigenvalues of a spectrum."""
    return float((found.error_estimate / np.abs(found.eigenvalues)).max())


def _errors_between_meshes(w: Complex, coarser: Complex, scale: float) -> Array:
    """Absolute errors of the sorted eigenvalues w, (k,), from the unsorted eigenvalues `coarser`, (l,), of a
    coarser mesh.

    scale: result of `_eigenvalue_rounding_scale`. Two meshes may agree on one eigenvalue by chance. The
    relative error of an eigenvalue is therefore the largest of three differences: of the eigenvalue and of
    its two neighbours. Near a double eigenvalue the stated rounding errors are larger than elsewhere.
    """
    apart = np.abs(w[:, None] - coarser).min(axis=1) / np.abs(w)
    padded = np.pad(apart, 1)
    relative = np.max([padded[:-2], padded[1:-1], padded[2:]], axis=0)
    others = np.abs(w[:, None] - w) + np.diag(np.full(len(w), np.inf))
    meeting = np.sqrt(1 + np.abs(w) / others.min(axis=1, initial=np.inf))
    errors: Array = TWO_MESH_SETTINGS.mesh_error_factor * relative * np.abs(
        w
    ) + TWO_MESH_SETTINGS.rounding * meeting * (np.abs(w) + scale)
    return errors


def _spectrum_of_mesh(
    problem: TransverseProblem, request: SpectrumRequest, mesh: AnyMesh, found: _MeshEigenvalues, error: Array
) -> Spectrum:
    """The spectrum of one mesh, with the status from the errors. error: absolute error of each found
    eigenvalue, (k,).
    """
    w = found.w
    modes = request.modes
    enough = bool((error[:modes] <= request.accuracy * np.abs(w[:modes])).all())
    vectors = None
    if request.vector_node_count and enough:
        vectors = problem.solver(mesh).vectors(len(w))[:, found.indices]
    unstable = int((w.real > 0).sum())
    decide = slice(max(modes, unstable + 1))  # later eigenvalues decay faster
    known = unstable < len(w) and not (np.abs(w.real) <= error)[decide].any()
    return Spectrum(
        status=SpectrumStatus.ok if enough else SpectrumStatus.accuracy_not_reached,
        eigenvalues=w[:modes],
        error_estimate=error[:modes],
        unstable_count=unstable if known else -1,
        elements=mesh.element_count,
        order=mesh.order,
        vectors=modes_at_lobatto_nodes(problem, request, mesh, vectors),
    )
