"""Right and left modes of given eigenvalues on a sufficiently fine mesh, with error estimates.

The modes of the finer of two meshes are returned. The error estimate is the difference between the two meshes
plus an estimate of the rounding errors, which two meshes may share.
"""

from dataclasses import dataclass, replace
from math import ceil, inf

import numpy as np

from ...arrays import Array, Complex
from ...discretization.elements.resolution import mesh_accuracy
from ...discretization.straight.transverse_mesh import mesh_for, pencil_on
from ...model.rod import Rod
from .inverse_iteration import ModeVectors, largest_relative_change, mode_vectors


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeMeshSettings:
    """Settings of the meshes on which modes and condition numbers are computed."""

    order_increase: int = 4
    """Increase of the element order from the first mesh to the second; the errors of the modes fall by a
    factor of 100."""
    further_mesh_order_ratio: float = 4 / 3
    """Element order of a further mesh, divided by the order of the previous mesh. Elements are not split: a
    mesh of halved elements of lower order may be less accurate than its predecessor, as if rounding errors
    dominated."""
    max_finer_meshes: int = 4
    """Maximum number of meshes after the first, each finer than its predecessor."""
    max_unknowns: int = 1500
    """Largest number of unknowns of a mesh; dense linear algebra on a larger mesh takes seconds."""
    finest_first_mesh_accuracy: float = 1e-24
    """The first mesh is chosen for a relative accuracy of eigenvalues not smaller than this."""


MODE_MESH_SETTINGS = ModeMeshSettings()


def mesh_accuracy_for_modes(accuracy: float) -> float:
    """Relative accuracy of eigenvalues for the first mesh if the modes need the accuracy `accuracy`."""
    return max(mesh_accuracy(accuracy, True), MODE_MESH_SETTINGS.finest_first_mesh_accuracy)


def converged_modes(
    rod: Rod, eigenvalues: Complex, points: Array, max_q: float, accuracy: float
) -> ModeVectors | None:
    """Modes of `eigenvalues`, (modes,), at `points` in [0, 1], (n,), from the mesh with the smallest error
    estimate; None if even the second mesh has more than `ModeMeshSettings.max_unknowns` unknowns. max_q: wave
    number that the mesh must resolve. accuracy: requested relative accuracy, at which the refinement ends."""
    mesh = mesh_for(rod, max_q, mesh_accuracy_for_modes(accuracy))
    coarse_modes = mode_vectors(rod, pencil_on(mesh), eigenvalues, points, estimates_rounding=False)
    best_modes: ModeVectors | None = None
    min_error = inf
    for _ in range(MODE_MESH_SETTINGS.max_finer_meshes):
        order = mesh.order + MODE_MESH_SETTINGS.order_increase
        max_order = MODE_MESH_SETTINGS.max_unknowns * mesh.order // mesh.unknown_count
        if order > max_order:
            break
        if best_modes is not None:
            order = ceil(MODE_MESH_SETTINGS.further_mesh_order_ratio * mesh.order)
        mesh = replace(mesh, order=min(order, max_order))
        fine_modes = mode_vectors(rod, pencil_on(mesh), eigenvalues, points)
        result = _with_errors_from_coarse(coarse_modes, fine_modes)
        error = max(result.relative_errors_by_name().values())
        # If a finer mesh does not halve the error, rounding errors dominate.
        has_improved = error < min_error / 2
        if best_modes is None or error < min_error:
            best_modes = result
            min_error = error
        if min_error <= accuracy or not has_improved:
            break
        coarse_modes = fine_modes
    return best_modes


def _with_errors_from_coarse(coarse: ModeVectors, fine: ModeVectors) -> ModeVectors:
    """`fine` with larger error estimates: to each rounding error of `fine`, the difference between the modes
    of `fine` and of `coarse` is added."""
    return replace(
        fine,
        mode_error=fine.mode_error + largest_relative_change(coarse.fields, fine.fields),
        condition_error=fine.condition_error + np.abs(coarse.condition / fine.condition - 1),
    )
