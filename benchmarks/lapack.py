"""Eigenvalues of dense matrix pencils by LAPACK, and the dense matrices of rodsweep's pencil."""

import numpy as np
import scipy.linalg

from rodsweep.arrays import Array, Complex
from rodsweep.discretization.elements.resolution import Resolution
from rodsweep.discretization.straight.arm_pencil import ArmPencil
from rodsweep.discretization.straight.arm_resolution import ArmMesh
from rodsweep.discretization.straight.dense_eigenproblem import dense_eigenproblem
from rodsweep.discretization.straight.pencil import assemble_pencil
from rodsweep.model.rod import Rod

Eigenvalues = Complex
"""Eigenvalues w in 1/tau2, shape (n,)."""

INFINITE_BELOW = 1e-11
"""An eigenvalue alpha/beta of QZ counts as infinite if |beta| is below this fraction of the largest |beta|:
rounding errors replace beta = 0."""


def whole_matrices(rod: Rod, mesh: Resolution | ArmMesh) -> tuple[Array, Array]:
    """(A, diagonal of B) of a rod's pencil A x = w B x, shapes (unknowns, unknowns) and (unknowns,).

    The unknowns without a time derivative, for which B is 0, are last.
    """
    if isinstance(mesh, ArmMesh):
        pencil = ArmPencil(mesh)
        found = pencil.matrices(rod)
        A = np.zeros((pencil.unknown_count, pencil.unknown_count))
        A[pencil.rows, pencil.columns] = found.A
        return A, found.B
    form = dense_eigenproblem(rod, assemble_pencil(mesh.element_count, mesh.order))
    return form.A, form.B


def inverse_spectrum(A: Array, B: Array) -> Eigenvalues:
    """Finite eigenvalues w of A x = w diag(B) x; A: (unknowns, unknowns), B: (unknowns,).

    LAPACK factorises A by LU and applies geev to the block of A^-1 diag(B) with nonzero columns.
    """
    dynamic = int(np.count_nonzero(B))
    inverse = np.linalg.solve(A, np.diag(B)[:, :dynamic])[:dynamic]
    with np.errstate(divide="ignore"):
        return 1 / scipy.linalg.eigvals(inverse, check_finite=False)


def qz_spectrum(A: Array, B: Array) -> Eigenvalues:
    """Finite eigenvalues w of A x = w B x by QZ (ggev); A and B: (unknowns, unknowns).

    Eigenvalues with |beta| below INFINITE_BELOW times the largest |beta| are infinite and left out.
    """
    alpha, beta = scipy.linalg.eigvals(A, B, check_finite=False, homogeneous_eigvals=True)
    finite = np.abs(beta) > INFINITE_BELOW * np.abs(beta).max()
    return alpha[finite] / beta[finite]
