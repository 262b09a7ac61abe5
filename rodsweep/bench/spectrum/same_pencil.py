"""The leading eigenvalues of a rod by rodsweep, and by others' eigensolvers on rodsweep's own pencil.

Each takes a rod and a size, the order of the elements, and returns the leading eigenvalues, WANTED_MODES and
one more, for a pair may straddle the end, largest real part first.
"""

from math import ceil

import numpy as np
import scipy.linalg
import scipy.sparse.linalg

from ...determinant.roots import refined
from ...discretization.pencil import SHEAR_WEIGHT
from ...discretization.resolution import LARGEST_ORDER, Resolution
from ...model.dispersion import most_amplified_wave
from ...model.rod import Rod
from ...solve.spectrum.krylov_schur import eigen_solver
from ...solve.spectrum.search import SHIFT_ABOVE_GROWTH, SpectrumRequest, solve_spectrum
from ..lapack import Eigenvalues, inverse_spectrum, leading, qz, whole_matrices

WANTED_MODES = 4
ACCURACY = 1e-12
"""Asked of rodsweep, whose error does not depend on it."""


def own_spectrum(rod: Rod, certify: bool) -> Eigenvalues:
    """This tool as its task uses it; it chooses the size itself."""
    return solve_spectrum(rod, SpectrumRequest(WANTED_MODES, ACCURACY, certify)).eigenvalues


def mesh_of(order: int) -> Resolution:
    """One element of this order, or as many equal ones as keep to LARGEST_ORDER."""
    elements = ceil(order / LARGEST_ORDER)
    return Resolution(elements, ceil(order / elements))


def shift_of(rod: Rod) -> float:
    """The shift of rodsweep's own shift-and-invert."""
    return SHIFT_ABOVE_GROWTH * most_amplified_wave(rod)[0]


def krylov_schur(rod: Rod, size: int) -> Eigenvalues:
    """SLEPc's Krylov-Schur to its last digit, without refinement on D."""
    return leading(
        eigen_solver(mesh_of(size)).solve(rod, shift_of(rod), WANTED_MODES, tight=True), WANTED_MODES + 1
    )


def dense_qz(rod: Rod, size: int) -> Eigenvalues:
    """LAPACK's QZ (ggev), eigenvalues only; s at full weight, as its rounding needs."""
    A, B = whole_matrices(rod, mesh_of(size))
    scale = np.ones(len(B))
    scale[2 * len(B) // 3 :] = SHEAR_WEIGHT
    return leading(qz(A * scale[:, None] * scale, np.diag(B)), WANTED_MODES + 1)


def dense_inverse(rod: Rod, size: int) -> Eigenvalues:
    """LAPACK's LU and geev."""
    return leading(inverse_spectrum(*whole_matrices(rod, mesh_of(size))), WANTED_MODES + 1)


def scipy_eigs(rod: Rod, size: int) -> Eigenvalues:
    """ARPACK through SciPy on the factorised shift-and-invert operator, with rodsweep's shift."""
    A, B = whole_matrices(rod, mesh_of(size))
    shift = shift_of(rod)
    factors = scipy.linalg.lu_factor(A - np.diag(shift * B), check_finite=False)
    operator = scipy.sparse.linalg.LinearOperator(
        A.shape, matvec=lambda x: scipy.linalg.lu_solve(factors, B * x, check_finite=False), dtype=float
    )
    theta = scipy.sparse.linalg.eigs(operator, WANTED_MODES, v0=np.ones(len(B)), return_eigenvectors=False)
    return leading(shift + 1 / theta, WANTED_MODES + 1)


def lapack_on_d(rod: Rod, size: int) -> Eigenvalues:
    """LAPACK on a coarse pencil, then Newton's method on D: what a root polisher does."""
    return np.array([refined(complex(w), rod.coefficients) for w in dense_inverse(rod, size)])
