"""Mode vectors of known eigenvalues, on a mesh fine enough, with their errors.

Two meshes are compared: their difference is the error estimate of the coarser mesh, and the finer mesh gives
the results. Beside a double eigenvalue, where condition numbers grow like the inverse distance of the two
eigenvalues, two meshes may agree by chance; the effect of rounding on the distance is added there.
"""

from dataclasses import dataclass, replace
from math import inf, ulp

import numpy as np

from ...arrays import Array, Complex
from ...determinant.arm.determinant import arm_determinant
from ...determinant.arm.newton import second_derivative
from ...determinant.exponents import EXPONENTS
from ...determinant.value import distance_to_next_root
from ...discretization.elements.resolution import mesh_accuracy
from ...discretization.straight.transverse_mesh import finer_mesh, mesh_for, pencil_on
from ...model.rod import Rod
from .inverse_iteration import ModeVectors, mode_vectors


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeMeshSettings:
    """Settings for the meshes of the modes and their condition numbers."""

    more_orders: int = 4
    """Increase of the order on the second mesh; it gains two orders of magnitude in the vectors."""
    max_meshes: int = 4
    """Maximum number of finer meshes."""
    max_unknowns: int = 1500
    """Largest number of unknowns; dense linear algebra on a larger mesh takes seconds."""
    finest_accuracy: float = 1e-24
    """Smallest accuracy of the eigenvalues that the first mesh is chosen for."""
    roundings: float = 2.0
    """Relative rounding error of a condition number in units of rounding/distance; measured: median 0.6,
    maximum 3.4."""


MODE_MESH = ModeMeshSettings()


def vector_accuracy(accuracy: float) -> float:
    """Accuracy of the eigenvalues for which the first mesh is chosen, for a given accuracy of the vectors."""
    return max(mesh_accuracy(accuracy, True), MODE_MESH.finest_accuracy)


def converged_vectors(
    rod: Rod, eigenvalues: Complex, points: Array, wave: float, accuracy: float
) -> ModeVectors | None:
    """Mode vectors at `points`, (n,), on the best of a few meshes; None if even the first mesh is too
    large."""
    mesh = mesh_for(rod, wave, vector_accuracy(accuracy))
    gaps = np.array([gap(rod, complex(w)) for w in eigenvalues])
    coarse = mode_vectors(rod, pencil_on(mesh), eigenvalues, points)
    best: ModeVectors | None = None
    least = inf
    for _ in range(MODE_MESH.max_meshes):
        if best is None:
            mesh = replace(mesh, order=mesh.order + MODE_MESH.more_orders)
        else:
            mesh = finer_mesh(rod, mesh)
        if mesh.unknowns > MODE_MESH.max_unknowns:
            break
        fine = mode_vectors(rod, pencil_on(mesh), eigenvalues, points)
        result = _compared(coarse, fine, gaps)
        error = max(result.errors().values())
        # A mesh that does not halve the error has met rounding errors.
        improved = error < least / 2
        if best is None or error < least:
            best = result
            least = error
        if least <= accuracy or not improved:
            break
        coarse = fine
    return best


def _compared(coarse: ModeVectors, fine: ModeVectors, gaps: Array) -> ModeVectors:
    """The finer mesh's modes, with the differences of the coarser mesh's modes as errors; gaps: (modes,)."""
    error = np.zeros(len(fine.condition))
    pairs = ((coarse.right, fine.right), (coarse.deformation, fine.deformation), (coarse.left, fine.left))
    for old, new in pairs:
        size = np.abs(new).max(axis=2)
        change = np.abs(new - old).max(axis=2)
        relative = np.where(size > 0, change / np.where(size > 0, size, 1.0), change)
        error = np.maximum(error, relative.max(axis=0))
    # For a normal operator, of condition number 1, rounding moves the eigenvalues but turns no vector.
    turned = (
        MODE_MESH.roundings
        * (1 - 1 / fine.condition**2)
        * fine.rounding
        / np.maximum(gaps, EXPONENTS.least_divisor)
    )
    moved = np.abs(coarse.condition / fine.condition - 1)
    return replace(fine, mode_error=error, condition_error=moved + turned)


def gap(rod: Rod, w: complex) -> float:
    """Estimated distance of eigenvalue w from the nearest other one, 2 |D'/D''|; accurate if small."""
    if rod.standard:
        return distance_to_next_root(w, rod.coefficients)
    determinant = arm_determinant(rod)
    value = determinant.value(w)
    second = abs(second_derivative(w, value.S, determinant))
    return 2 * abs(value.D_w) / max(second, ulp(0.0))
