"""What a user would write instead: dense LAPACK, SciPy's eigs, Chebyshev collocation with QZ.

Each peer returns the leading eigenvalues of a rod and one more, largest real part first.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
import scipy.linalg
import scipy.sparse.linalg
from numpy.typing import NDArray

from ..discretization.pencil import SHEAR_WEIGHT, assemble
from ..discretization.resolution import Resolution
from ..model.dispersion import most_amplified_wave
from ..model.rod import Rod
from ..solve.spectrum import SHIFT_ABOVE_GROWTH

Eigenvalues = NDArray[np.complex128]
INFINITE_BELOW = 1e-11
"""beta of an infinite eigenvalue, in units of the largest, as rounding leaves it."""


def _leading(w: Eigenvalues, modes: int) -> Eigenvalues:
    return w[np.argsort(-w.real, kind="stable")][: modes + 1]  # one more: a pair may straddle the end


def _qz(A: NDArray, B: NDArray) -> Eigenvalues:
    """The finite eigenvalues by LAPACK's QZ; those whose beta is rounding are the infinite ones."""
    alpha, beta = scipy.linalg.eigvals(A, B, check_finite=False, homogeneous_eigvals=True)
    finite = np.abs(beta) > INFINITE_BELOW * np.abs(beta).max()
    return alpha[finite] / beta[finite]


def _matrices(rod: Rod, resolution: Resolution, shear_weight: float = 1.0) -> tuple[NDArray, NDArray]:
    """(A, diagonal of B), with s at full weight for methods whose rounding is relative to the norm of A."""
    pencil = assemble(resolution.elements, resolution.order)
    A = np.zeros((pencil.unknowns, pencil.unknowns))
    A[pencil.rows, pencil.columns] = pencil.stiffness(rod)
    scale = np.ones(pencil.unknowns)
    scale[2 * pencil.nodes :] = SHEAR_WEIGHT / shear_weight
    return A * scale[:, None] * scale, pencil.inertia(rod)


def dense_qz(rod: Rod, resolution: Resolution, modes: int) -> Eigenvalues:
    """LAPACK's QZ (ggev) on the same pencil, eigenvalues only."""
    A, B = _matrices(rod, resolution)
    return _leading(_qz(A, np.diag(B)), modes)


def dense_inverse(rod: Rod, resolution: Resolution, modes: int) -> Eigenvalues:
    """LAPACK's LU of A, then the standard eigenproblem (geev) of the dynamic block of A^-1 B."""
    A, B = _matrices(rod, resolution, SHEAR_WEIGHT)
    dynamic = int(np.count_nonzero(B))
    T = scipy.linalg.solve(A, np.diag(B)[:, :dynamic], check_finite=False)[:dynamic]
    with np.errstate(divide="ignore"):
        return _leading(1 / scipy.linalg.eigvals(T, check_finite=False), modes)


def scipy_eigs(rod: Rod, resolution: Resolution, modes: int) -> Eigenvalues:
    """ARPACK through SciPy on the factorised shift-and-invert operator of the same pencil and shift."""
    A, B = _matrices(rod, resolution, SHEAR_WEIGHT)
    shift = SHIFT_ABOVE_GROWTH * most_amplified_wave(rod)[0]
    factors = scipy.linalg.lu_factor(A - np.diag(shift * B), check_finite=False)
    operator = scipy.sparse.linalg.LinearOperator(
        A.shape, matvec=lambda x: scipy.linalg.lu_solve(factors, B * x, check_finite=False), dtype=float
    )
    start = np.ones(len(B))
    theta = scipy.sparse.linalg.eigs(operator, modes, v0=start, return_eigenvectors=False)
    return _leading(shift + 1 / theta, modes)


@lru_cache(maxsize=64)
def _chebyshev(n: int) -> tuple[NDArray, NDArray]:
    """Chebyshev points on [0, 1] and the differentiation matrix (Trefethen's construction)."""
    x = np.cos(np.pi * np.arange(n + 1) / n)
    c = np.r_[2, np.ones(n - 1), 2] * (-1) ** np.arange(n + 1)
    difference = x[:, None] - x[None, :]
    D = np.outer(c, 1 / c) / (difference + np.eye(n + 1))
    D -= np.diag(D.sum(axis=1))
    return (1 + x) / 2, 2 * D


def chebyshev_qz(rod: Rod, n: int, modes: int) -> Eigenvalues:
    """Collocation of (y, theta) at n + 1 Chebyshev points, boundary rows replaced, then QZ."""
    _, D = _chebyshev(n)
    zero, one = np.zeros((n + 1, n + 1)), np.eye(n + 1)
    D2 = D @ D
    mu = rod.k2 * rod.nu + rod.F
    A = np.block([[rod.k2 * D2, -mu * D], [mu * D, D2 - rod.nu * mu * one]])
    B = scipy.linalg.block_diag(one, rod.gamma3 * one)
    tip, clamp = 0, n
    for row, condition in (
        (clamp, np.r_[one[clamp], zero[0]]),
        (n + 1 + clamp, np.r_[zero[0], one[clamp]]),
        (tip, np.r_[D[tip], -rod.nu * one[tip]]),
        (n + 1 + tip, np.r_[zero[0], D[tip]]),
    ):
        A[row], B[row] = condition, 0.0
    return _leading(_qz(A, B), modes)


Peer = Callable[[Rod, Resolution, int], Eigenvalues]
SAME_PENCIL: dict[str, Peer] = {
    "dense LAPACK, QZ": dense_qz,
    "dense LAPACK, LU and geev of the inverse": dense_inverse,
    "SciPy eigs (ARPACK)": scipy_eigs,
}
