"""LAPACK on whole matrices, those of rodsweep's pencil among them."""

import numpy as np
import scipy.linalg

from rodsweep.arrays import Array, Complex
from rodsweep.discretization.elements.resolution import Resolution
from rodsweep.discretization.straight.arm_pencil import ArmPencil
from rodsweep.discretization.straight.arm_resolution import ArmMesh
from rodsweep.discretization.straight.dense_form import dense_form
from rodsweep.discretization.straight.pencil import assemble_pencil
from rodsweep.model.rod import Rod

Eigenvalues = Complex

INFINITE_BELOW = 1e-11
"""beta of an infinite eigenvalue, in units of the largest, as rounding leaves it."""


def whole_matrices(rod: Rod, mesh: Resolution | ArmMesh) -> tuple[Array, Array]:
    """(A, diagonal of B), shape (unknowns, unknowns) and (unknowns,), the statical unknowns last."""
    if isinstance(mesh, ArmMesh):
        pencil = ArmPencil(mesh)
        found = pencil.matrices(rod)
        A = np.zeros((pencil.unknowns, pencil.unknowns))
        A[pencil.rows, pencil.columns] = found.A
        return A, found.B
    form = dense_form(rod, assemble_pencil(mesh.elements, mesh.order))
    return form.A, form.B


def inverse_spectrum(A: Array, B: Array) -> Eigenvalues:
    """The finite eigenvalues of (A, diag B): LU of A, then geev of the dynamic block of A^-1 B."""
    dynamic = int(np.count_nonzero(B))
    inverse = np.linalg.solve(A, np.diag(B)[:, :dynamic])[:dynamic]
    with np.errstate(divide="ignore"):
        return 1 / scipy.linalg.eigvals(inverse, check_finite=False)


def qz(A: Array, B: Array) -> Eigenvalues:
    """The finite eigenvalues of (A, B) by QZ (ggev); those whose beta is rounding are the infinite ones."""
    alpha, beta = scipy.linalg.eigvals(A, B, check_finite=False, homogeneous_eigvals=True)
    finite = np.abs(beta) > INFINITE_BELOW * np.abs(beta).max()
    return alpha[finite] / beta[finite]
