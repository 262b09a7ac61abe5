"""The vectors of known eigenvalues on a mesh fine enough for them, with their errors.

All of it is done on two meshes, whose difference is the error estimate of the coarser one; the numbers
given are the finer one's.
"""

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from ..discretization.pencil import assemble
from ..discretization.resolution import Resolution, finer, mesh_accuracy, resolution_for
from ..model.rod import Rod
from .shapes import Shapes, mode_shapes

ORDER_STEP = 4
"""How much finer the second mesh is; two orders of magnitude in the vectors."""
MOST_MESHES = 4
MOST_UNKNOWNS = 1500
"""Unknowns beyond which dense linear algebra takes seconds."""
FINEST_MESH_ACCURACY = 1e-24


@dataclass(frozen=True, slots=True)
class Vectors:
    """Modes on one mesh, and their errors as in `rodsweep.solve.modes.Modes`, shape (modes,)."""

    shapes: Shapes
    mode_error: NDArray[np.float64]
    condition_error: NDArray[np.float64]

    def errors(self) -> dict[str, float]:
        """The largest relative errors, by quantity; inf where there is no number."""
        errors = {"modes": self.mode_error.max(), "condition numbers": self.condition_error.max()}
        return {name: inf if np.isnan(error) else float(error) for name, error in errors.items()}


def first_mesh(wave: float, accuracy: float) -> Resolution:
    """The coarser mesh of the first pair, for the largest wave number and a relative accuracy."""
    return resolution_for(wave, max(mesh_accuracy(accuracy, True), FINEST_MESH_ACCURACY))


def resolved_vectors(
    rod: Rod, eigenvalues: NDArray[np.complex128], points: NDArray[np.float64], wave: float, accuracy: float
) -> Vectors | None:
    """The vectors at `points` from the best of few meshes; None where even the first is too large."""
    mesh = first_mesh(wave, accuracy)
    coarse = mode_shapes(rod, assemble(mesh.elements, mesh.order), eigenvalues, points)
    best: Vectors | None = None
    least = inf
    for _ in range(MOST_MESHES):
        mesh = Resolution(mesh.elements, mesh.order + ORDER_STEP) if best is None else finer(mesh)
        if mesh.unknowns > MOST_UNKNOWNS:
            break
        fine = mode_shapes(rod, assemble(mesh.elements, mesh.order), eigenvalues, points)
        result = _compared(coarse, fine)
        error = max(result.errors().values())
        improved = error < least / 2
        if best is None or error < least:
            best, least = result, error
        if least <= accuracy or not improved:
            break
        coarse = fine
    return best


def _compared(coarse: Shapes, fine: Shapes) -> Vectors:
    """The finer mesh's modes, and how far the coarser one's are from them."""
    error = np.zeros(len(fine.condition))
    pairs = ((coarse.right, fine.right), (coarse.deformation, fine.deformation), (coarse.left, fine.left))
    for old, new in pairs:
        size = np.abs(new).max(axis=2)
        change = np.abs(new - old).max(axis=2)
        relative = np.where(size > 0, change / np.where(size > 0, size, 1.0), change)
        error = np.maximum(error, relative.max(axis=0))
    return Vectors(fine, error, np.abs(coarse.condition / fine.condition - 1))
