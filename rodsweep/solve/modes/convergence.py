"""The vectors of known eigenvalues on a mesh fine enough for them, with their errors.

All of it is done on two meshes, whose difference is the error estimate of the coarser one; the numbers
given are the finer one's. Next to a double eigenvalue, where condition numbers grow like the inverse of the
distance of the two, two meshes may agree by luck: there the rounding that moves the two is added.
"""

from dataclasses import replace
from math import inf

import numpy as np

from ...arrays import Array, Complex
from ...discretization.elements.resolution import mesh_accuracy
from .inverse_iteration import Vectors, mode_vectors
from .problem import ModesProblem

ORDER_STEP = 4
"""How much finer the second mesh is; two orders of magnitude in the vectors."""
MOST_PAIRS = 4
MOST_DENSE_UNKNOWNS = 1500
"""Unknowns beyond which dense linear algebra takes seconds."""
FINEST_MESH_ACCURACY = 1e-24
ROUNDINGS = 2.0
"""Relative error of a condition number, in units of rounding/distance: 0.6 in the median, at most 3.4."""


def vector_accuracy(accuracy: float) -> float:
    """Accuracy of the eigenvalues of the coarser mesh of the first pair, for one of the vectors."""
    return max(mesh_accuracy(accuracy, True), FINEST_MESH_ACCURACY)


def converged_vectors(
    problem: ModesProblem, eigenvalues: Complex, points: Array, wave: float, accuracy: float
) -> Vectors | None:
    """The vectors at `points`, (n,), from the best of few meshes; None where even the first is too large."""
    rod, mesh = problem.rod, problem.mesh_for(wave, vector_accuracy(accuracy))
    gaps = np.array([problem.gap(complex(w)) for w in eigenvalues])
    coarse = mode_vectors(rod, problem.pencil(mesh), eigenvalues, points)
    best: Vectors | None = None
    least = inf
    for _ in range(MOST_PAIRS):
        mesh = problem.of_order(mesh, mesh.order + ORDER_STEP) if best is None else problem.finer(mesh)
        if mesh.unknowns > MOST_DENSE_UNKNOWNS:
            break
        fine = mode_vectors(rod, problem.pencil(mesh), eigenvalues, points)
        result = _compared(coarse, fine, gaps)
        error = max(result.errors().values())
        improved = error < least / 2
        if best is None or error < least:
            best, least = result, error
        if least <= accuracy or not improved:
            break
        coarse = fine
    return best


def _compared(coarse: Vectors, fine: Vectors, gaps: Array) -> Vectors:
    """The finer mesh's modes, and how far the coarser one's are from them."""
    error = np.zeros(len(fine.condition))
    pairs = ((coarse.right, fine.right), (coarse.deformation, fine.deformation), (coarse.left, fine.left))
    for old, new in pairs:
        size = np.abs(new).max(axis=2)
        change = np.abs(new - old).max(axis=2)
        relative = np.where(size > 0, change / np.where(size > 0, size, 1.0), change)
        error = np.maximum(error, relative.max(axis=0))
    # Of a normal operator, of condition 1, rounding moves the eigenvalues but turns no vector.
    turned = ROUNDINGS * (1 - 1 / fine.condition**2) * fine.rounding / np.maximum(gaps, 1e-300)
    moved = np.abs(coarse.condition / fine.condition - 1)
    return replace(fine, mode_error=error, condition_error=moved + turned)
