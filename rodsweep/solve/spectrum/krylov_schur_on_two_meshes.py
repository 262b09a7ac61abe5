"""Leading eigenvalues of one rod by SLEPc alone: Krylov-Schur on two meshes, without the determinant D.

The finer mesh gives the eigenvalues; the differences from the eigenvalues of the coarser mesh give the
errors. Krylov-Schur finds the eigenvalues nearest to a shift above the growth rate of the most amplified
wave. The number of requested eigenvalues is doubled until the leading eigenvalues stay the same. No result is
certified.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...discretization.elements.resolution import RESOLUTION_SETTINGS, Resolution, mesh_accuracy
from ...discretization.straight.transverse_mesh import AnyMesh
from ...model.dispersion import local_coefficients_at_ends, local_wave_numbers, sampled_arm
from ...model.rod import Rod
from ..unsolvable import Unsolvable
from .problem import TransverseProblem, meshes_without_result_text, transverse_problem
from .spectrum import Spectrum, SpectrumRequest, modes_at_lobatto_nodes, spectrum_or_failure
from .status import SpectrumStatus


@dataclass(frozen=True, slots=True, kw_only=True)
class TwoMeshSettings:
    """Settings for eigenvalues whose errors are differences between two meshes."""

    max_finer_meshes: int = 8
    """Maximum number of meshes after the first; each has a third more unknowns than its predecessor."""
    spare_eigenvalue_count: int = 2
    """Number of eigenvalues requested first on a mesh, in addition to the wanted modes."""
    max_relative_change_by_doubled_request: float = 1e-9
    """The number of requested eigenvalues is doubled until the relative change of the leading eigenvalues is
    less than this."""
    max_scaled_change_by_doubled_request: float = 3e-11
    """The doubling also ends if the leading eigenvalues change by less than this times (|shift| + F^2). The
    value is a hundred times `scaled_rounding_error`, as rounding differs between SLEPc's releases and
    processors."""
    mesh_error_safety_factor: float = 3.0
    """Safety factor on the difference between two meshes, which estimates the error on the finer mesh."""
    scaled_rounding_error: float = 3e-13
    """Rounding error of an eigenvalue w, divided by |w| + |shift| + F^2. F^2 is included because the first
    eigenvalue of a pulled rod is exponentially small compared with F^2."""
    scaled_rounding_error_beyond_shear_stiffness: float = 3e-11
    """`scaled_rounding_error` of a rod that is pulled beyond its shear stiffness anywhere, g < 0: ten times
    the largest error of 54 such rods, whose growing modes have thin layers at the ends."""
    min_unknowns_per_mode: int = 3
    """Minimum number of unknowns of a mesh per requested eigenvalue: a third of the unknowns have no time
    derivative, and the highest modes of a mesh are not resolved."""


TWO_MESH_SETTINGS = TwoMeshSettings()


def solve_on_two_meshes(rod: Rod, request: SpectrumRequest) -> Spectrum:
    """The leading `request.mode_count` eigenvalues of a rod; a failure is returned as a status, never raised.
    No result is proved; `request.certify` is ignored."""
    return spectrum_or_failure(lambda: _spectrum_or_raise(rod, request), request)


def _spectrum_or_raise(rod: Rod, request: SpectrumRequest) -> Spectrum:
    """The result of `solve_on_two_meshes`; raises Unsolvable if no mesh gives enough eigenvalues."""
    problem = transverse_problem(rod)
    modes = request.mode_count
    mesh_tolerance = (
        mesh_accuracy(request.accuracy, needs_vectors=True) if request.vector_node_count else request.accuracy
    )
    mesh: AnyMesh = problem.mesh_for(modes, mesh_tolerance)
    # Without D only a second mesh gives an error estimate.
    coarser_eigenvalues = _leading_eigenvalues(problem, mesh, modes)
    best_spectrum: Spectrum | None = None
    smallest_error = math.inf
    for _ in range(TWO_MESH_SETTINGS.max_finer_meshes):
        is_resolved = _are_waves_represented(rod, coarser_eigenvalues.w[:modes], mesh)
        mesh = problem.finer_mesh(mesh)
        if mesh.unknown_count > RESOLUTION_SETTINGS.max_unknowns:
            break
        eigenvalues = _leading_eigenvalues(problem, mesh, modes)
        # Two meshes that are too coarse for a boundary layer may agree on a wrong eigenvalue.
        if is_resolved and len(eigenvalues.w):
            rounding_scale = _rounding_scale(problem)
            error = _errors_between_meshes(
                eigenvalues.w, coarser_eigenvalues.w, abs(problem.shift), rounding_scale,
                _scaled_rounding_error(rod),
            )  # fmt: skip
            spectrum = _spectrum_of_mesh(problem, request, mesh, eigenvalues, error)
            if spectrum.status == SpectrumStatus.ok:
                return spectrum
            # The finest mesh may have the largest rounding error. An eigenvalue smaller than its rounding
            # error, such as the leading eigenvalue of a pulled rod, must not decide: with `rounding_scale` in
            # the denominator its error counts only on a coarse mesh.
            moduli = np.abs(spectrum.eigenvalues)
            largest_error = float((spectrum.error_estimate / (moduli + rounding_scale)).max())
            if best_spectrum is None or largest_error < smallest_error:
                best_spectrum = spectrum
                smallest_error = largest_error
        coarser_eigenvalues = eigenvalues
    if best_spectrum is None:
        meshes = meshes_without_result_text(1 + TWO_MESH_SETTINGS.max_finer_meshes, problem.finer_mesh(mesh))
        raise Unsolvable(f"{meshes} resolves the requested modes")
    # If rounding dominates, the error may exceed the difference between the two meshes.
    best_spectrum = replace(
        best_spectrum,
        error_estimate=TWO_MESH_SETTINGS.mesh_error_safety_factor * best_spectrum.error_estimate,
    )
    return replace(best_spectrum, message=_missed_accuracy_text(problem, request, best_spectrum))


def _missed_accuracy_text(problem: TransverseProblem, request: SpectrumRequest, spectrum: Spectrum) -> str:
    """Message on the mode with the largest relative error: this error, its cause, and what to change."""
    moduli = np.abs(spectrum.eigenvalues)
    relative_errors = spectrum.error_estimate / moduli
    index = int(np.argmax(relative_errors))
    rounding_error = _scaled_rounding_error(problem.rod) * (moduli[index] + _rounding_scale(problem))
    cause = "rounding errors" if rounding_error > request.accuracy * moduli[index] else "the meshes"
    max_error = float(relative_errors[index])
    return (
        f"mode {index + 1} has a relative error of {max_error:.2e}, limited by {cause}, but the requested "
        f"accuracy is {request.accuracy:.2e}: use an accuracy above {max_error:.2e}, or method: determinant"
    )


def _rounding_scale(problem: TransverseProblem) -> float:
    """Sum of |shift| and F^2, in 1/tau2: rounding errors of eigenvalues are proportional to this rate."""
    return abs(problem.shift) + problem.rod.F**2


def _scaled_rounding_error(rod: Rod) -> float:
    """Rounding error of an eigenvalue w of a rod, divided by |w| + |shift| + F^2."""
    if (sampled_arm(rod).local_coefficients.g < 0).any():
        return TWO_MESH_SETTINGS.scaled_rounding_error_beyond_shear_stiffness
    return TWO_MESH_SETTINGS.scaled_rounding_error


class _MeshEigenvalues(NamedTuple):
    """Eigenvalues w of a mesh, (k,), sorted as in `rodsweep.model`, and their indices in SLEPc's list."""

    w: Complex
    slepc_indices: NDArray[np.intp]


def _leading_eigenvalues(problem: TransverseProblem, mesh: AnyMesh, mode_count: int) -> _MeshEigenvalues:
    """Sorted eigenvalues of a mesh. The requested number is doubled until the `mode_count` leading
    eigenvalues no longer change. The result is empty if the mesh is too coarse for a doubled request."""
    solver = problem.solver(mesh)
    requested_count = mode_count + TWO_MESH_SETTINGS.spare_eigenvalue_count
    # The solver finds the eigenvalues nearest to the shift, which need not lead: more are requested until
    # the leading eigenvalues stay the same.
    previous_w = np.empty(0, complex)
    while True:
        mesh_eigenvalues = solver.solve(problem.rod, problem.shift, requested_count, to_rounding=True)
        order = np.lexsort((-mesh_eigenvalues.imag, -mesh_eigenvalues.real))
        leading_w = mesh_eigenvalues[order[:mode_count]]
        is_complete = len(leading_w) == len(previous_w) == mode_count
        rounding_change = TWO_MESH_SETTINGS.max_scaled_change_by_doubled_request * _rounding_scale(problem)
        if is_complete and np.allclose(
            leading_w,
            previous_w,
            rtol=TWO_MESH_SETTINGS.max_relative_change_by_doubled_request,
            atol=rounding_change,
        ):
            return _MeshEigenvalues(mesh_eigenvalues[order], order)
        if 2 * requested_count > mesh.unknown_count // TWO_MESH_SETTINGS.min_unknowns_per_mode:
            return _MeshEigenvalues(mesh_eigenvalues[:0], order[:0])
        previous_w = leading_w
        requested_count = 2 * requested_count


def _are_waves_represented(rod: Rod, w: Complex, mesh: AnyMesh) -> bool:
    """Whether a mesh represents the exponentials exp(+-q u) of all its eigenvalues w, (k,), on average along
    the rod or at an end, to which an eigenfunction may be confined; False without eigenvalues."""
    max_q = RESOLUTION_SETTINGS.max_wave_number_per_node * mesh.order
    lengths = np.full(2, 1 / mesh.element_count) if isinstance(mesh, Resolution) else mesh.lengths
    _, weights, coefficients = sampled_arm(rod)
    mean_q = local_wave_numbers(w[:, None], rod.F, coefficients) @ weights
    end_q = local_wave_numbers(w[:, None], rod.F, local_coefficients_at_ends(rod))
    is_represented = (mean_q <= max_q * mesh.element_count) | (end_q * lengths[[0, -1]] <= max_q).any(axis=1)
    return len(w) > 0 and bool(is_represented.all())


def _errors_between_meshes(
    w: Complex, coarser_w: Complex, shift: float, rounding_scale: float, scaled_rounding_error: float
) -> Array:
    """Absolute errors of the sorted eigenvalues w, (k,), from the unsorted eigenvalues `coarser_w`, (l,), of
    a coarser mesh.

    shift: modulus of the shift. rounding_scale, scaled_rounding_error: results of `_rounding_scale` and
    `_scaled_rounding_error`. Two meshes may agree on one eigenvalue by chance. The mesh error of an
    eigenvalue is therefore the largest of three relative differences between the meshes: the difference of
    the eigenvalue itself, and the differences of its two neighbours less their rounding errors. Rounding
    errors, which are larger near a double eigenvalue, are added.
    """
    moduli = np.abs(w)
    separations = np.abs(w[:, None] - w) + np.diag(np.full(len(w), np.inf))
    # Close eigenvalues are ill-conditioned: a rounding error e of w changes the product (v - w1) (v - w2) by
    # e |w|, and hence a double eigenvalue by the square root of e |w|.
    squared_errors = scaled_rounding_error * (moduli + shift) * moduli
    crowding_errors = np.minimum(
        squared_errors / separations.min(axis=1, initial=np.inf), np.sqrt(squared_errors)
    )
    rounding_errors = scaled_rounding_error * (moduli + rounding_scale) + crowding_errors
    distances = np.abs(w[:, None] - coarser_w).min(axis=1)
    # In a cluster the nearest eigenvalue of the coarser mesh may be a neighbour's, so neighbours count too.
    # The leading eigenvalue of a pulled rod, a rounding error, says nothing about the next one.
    padded_distances = np.pad(np.maximum(distances - rounding_errors, 0) / moduli, 1)
    neighbour_distances = np.maximum(padded_distances[:-2], padded_distances[2:])
    mesh_errors = np.maximum(distances, neighbour_distances * moduli)
    errors: Array = TWO_MESH_SETTINGS.mesh_error_safety_factor * mesh_errors + rounding_errors
    return errors


def _spectrum_of_mesh(
    problem: TransverseProblem,
    request: SpectrumRequest,
    mesh: AnyMesh,
    eigenvalues: _MeshEigenvalues,
    error: Array,
) -> Spectrum:
    """The spectrum of one mesh, with the status from the errors. error: absolute error of each eigenvalue
    found, (k,)."""
    w = eigenvalues.w
    modes = request.mode_count
    is_accurate = bool((error[:modes] <= request.accuracy * np.abs(w[:modes])).all())
    vectors = None
    # Eigenvectors of a mesh that is not accepted would be thrown away.
    if request.vector_node_count and is_accurate:
        vectors = problem.solver(mesh).eigenvectors(len(w))[:, eigenvalues.slepc_indices]
    unstable_count = int((w.real > 0).sum())
    decisive_modes = slice(max(modes, unstable_count + 1))  # later eigenvalues decay faster
    is_known = unstable_count < len(w) and not (np.abs(w.real) <= error)[decisive_modes].any()
    return Spectrum(
        status=SpectrumStatus.ok if is_accurate else SpectrumStatus.accuracy_not_reached,
        eigenvalues=w[:modes],
        error_estimate=error[:modes],
        unstable_count=unstable_count if is_known else -1,
        elements=mesh.element_count,
        order=mesh.order,
        vectors=modes_at_lobatto_nodes(problem, request, mesh, vectors),
    )
