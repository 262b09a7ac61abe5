"""What a user would write instead for the leading eigenvalues of one rod.

Each peer takes a rod, a size and the number of modes and returns the leading eigenvalues and one more,
largest real part first. The size is the order of the elements, which are one up to LARGEST_ORDER, or the
number of collocation intervals.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import ceil

import numpy as np
import scipy.linalg
import scipy.sparse.linalg
from numpy.typing import NDArray

from ...determinant.newton import refined
from ...discretization.basis import differentiation, interpolation
from ...discretization.pencil import SHEAR_WEIGHT, assemble
from ...discretization.quadrature import gauss, gauss_lobatto
from ...discretization.resolution import LARGEST_ORDER, Resolution
from ...model.dispersion import most_amplified_wave
from ...model.rod import Rod
from ...solve.spectrum.krylov_schur import eigen_solver
from ...solve.spectrum.search import SHIFT_ABOVE_GROWTH

Array = NDArray[np.float64]
Eigenvalues = NDArray[np.complex128]
Solve = Callable[[Rod, int, int], Eigenvalues]

INFINITE_BELOW = 1e-11
"""beta of an infinite eigenvalue, in units of the largest, as rounding leaves it."""
ORDERS = (8, 10, 12, 14, 16, 18, 20, 24, 28, 32, 40, 56, 80)
INTERVALS = (10, 12, 14, 16, 18, 20, 22, 24, 28, 32, 40, 56, 80)
START_ORDERS = (8, 10, 11, 12, 14, 18, 24, 32, 40)
"""Of meshes whose eigenvalues are refined on D."""


@dataclass(frozen=True, slots=True)
class Peer:
    """A method, the group it belongs to in a figure, and its sizes from the cheapest."""

    name: str
    group: str
    solve: Solve
    sizes: tuple[int, ...]


def mesh(order: int) -> Resolution:
    """One element of this order, or as many equal ones as keep to LARGEST_ORDER."""
    elements = ceil(order / LARGEST_ORDER)
    return Resolution(elements, ceil(order / elements))


def _leading(w: Eigenvalues, modes: int) -> Eigenvalues:
    return w[np.argsort(-w.real, kind="stable")][: modes + 1]  # one more: a pair may straddle the end


def _qz(A: Array, B: Array) -> Eigenvalues:
    """The finite eigenvalues by LAPACK's QZ; those whose beta is rounding are the infinite ones."""
    alpha, beta = scipy.linalg.eigvals(A, B, check_finite=False, homogeneous_eigvals=True)
    finite = np.abs(beta) > INFINITE_BELOW * np.abs(beta).max()
    return alpha[finite] / beta[finite]


def _matrices(rod: Rod, order: int, shear_weight: float = 1.0) -> tuple[Array, Array]:
    """(A, diagonal of B), with s at full weight for methods whose rounding is relative to the norm of A."""
    resolution = mesh(order)
    pencil = assemble(resolution.elements, resolution.order)
    A = np.zeros((pencil.unknowns, pencil.unknowns))
    A[pencil.rows, pencil.columns] = pencil.stiffness(rod)
    scale = np.ones(pencil.unknowns)
    scale[2 * pencil.nodes :] = SHEAR_WEIGHT / shear_weight
    return A * scale[:, None] * scale, pencil.inertia(rod)


def krylov_schur(rod: Rod, order: int, modes: int) -> Eigenvalues:
    """SLEPc's Krylov-Schur on this tool's pencil to its last digit, without refinement on D."""
    shift = SHIFT_ABOVE_GROWTH * most_amplified_wave(rod)[0]
    return _leading(eigen_solver(mesh(order)).solve(rod, shift, modes, tight=True), modes)


def dense_qz(rod: Rod, order: int, modes: int) -> Eigenvalues:
    """LAPACK's QZ (ggev) on the same pencil, eigenvalues only."""
    A, B = _matrices(rod, order)
    return _leading(_qz(A, np.diag(B)), modes)


def dense_inverse(rod: Rod, order: int, modes: int) -> Eigenvalues:
    """LAPACK's LU of A, then the standard eigenproblem (geev) of the dynamic block of A^-1 B."""
    A, B = _matrices(rod, order, SHEAR_WEIGHT)
    dynamic = int(np.count_nonzero(B))
    T = scipy.linalg.solve(A, np.diag(B)[:, :dynamic], check_finite=False)[:dynamic]
    with np.errstate(divide="ignore"):
        return _leading(1 / scipy.linalg.eigvals(T, check_finite=False), modes)


def scipy_eigs(rod: Rod, order: int, modes: int) -> Eigenvalues:
    """ARPACK through SciPy on the factorised shift-and-invert operator of the same pencil and shift."""
    A, B = _matrices(rod, order, SHEAR_WEIGHT)
    shift = SHIFT_ABOVE_GROWTH * most_amplified_wave(rod)[0]
    factors = scipy.linalg.lu_factor(A - np.diag(shift * B), check_finite=False)
    operator = scipy.sparse.linalg.LinearOperator(
        A.shape, matvec=lambda x: scipy.linalg.lu_solve(factors, B * x, check_finite=False), dtype=float
    )
    theta = scipy.sparse.linalg.eigs(operator, modes, v0=np.ones(len(B)), return_eigenvectors=False)
    return _leading(shift + 1 / theta, modes)


def lapack_on_d(rod: Rod, order: int, modes: int) -> Eigenvalues:
    """LAPACK on a coarse pencil, then Newton's method on D: what a root polisher does."""
    start = dense_inverse(rod, order, modes)
    return np.array([refined(complex(w), rod.coefficients) for w in start])


def displacement_elements(rod: Rod, order: int, modes: int) -> Eigenvalues:
    """Spectral elements of (y, theta) alone with lumped masses, stiffnesses as they are, then geev."""
    resolution = mesh(order)
    shear, couple, angle, mixed, weights = _displacement_pieces(resolution.elements, resolution.order)
    k2, nu = rod.k2, rod.nu
    yy = -k2 * shear
    yt = (k2 * nu + rod.F) * couple
    yt[-1, -1] -= rod.F
    ty = (k2 * nu + rod.F) * mixed
    tt = -angle - nu * (k2 * nu + rod.F) * np.diag(weights)
    A = np.block([[yy, yt], [ty, tt]])
    A /= np.concatenate([weights, rod.gamma3 * weights])[:, None]
    return _leading(scipy.linalg.eigvals(A, check_finite=False), modes)


@lru_cache(maxsize=64)
def _displacement_pieces(elements: int, order: int) -> tuple[Array, Array, Array, Array, Array]:
    """(<a', y'>, <a', theta>, <b', theta'>, <b, y'>, masses) without the clamped node."""
    x, w = gauss_lobatto(order)
    xg, wg = gauss(order)
    value = interpolation(x, xg)
    slope = value @ differentiation(x)
    n = elements * order + 1
    stiff, cross, masses = np.zeros((n, n)), np.zeros((n, n)), np.zeros(n)
    for e in range(elements):
        here = slice(e * order, (e + 1) * order + 1)
        masses[here] += w / (2 * elements)
        stiff[here, here] += 2 * elements * (slope.T * wg) @ slope
        cross[here, here] += (slope.T * wg) @ value
    free = slice(1, None)
    return stiff[free, free], cross[free, free], stiff[free, free], cross[free, free].T, masses[free]


@lru_cache(maxsize=64)
def _chebyshev(n: int) -> Array:
    """The differentiation matrix at n + 1 Chebyshev points from the tip to the clamp (Trefethen's)."""
    x = np.cos(np.pi * np.arange(n + 1) / n)
    c = np.r_[2, np.ones(n - 1), 2] * (-1) ** np.arange(n + 1)
    difference = x[:, None] - x[None, :]
    D = np.outer(c, 1 / c) / (difference + np.eye(n + 1))
    D -= np.diag(D.sum(axis=1))
    return 2 * D


def chebyshev_qz(rod: Rod, n: int, modes: int) -> Eigenvalues:
    """Collocation of (y, theta) at n + 1 Chebyshev points, boundary rows replaced, then QZ."""
    D = _chebyshev(n)
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
    size = np.abs(A).max(axis=1, keepdims=True)  # without it QZ finds nothing at k2 = 1e8
    return _leading(_qz(A / size, B / size), modes)


def chebyshev_first_order(rod: Rod, n: int, modes: int) -> Eigenvalues:
    """The same of the first-order system in (y, theta, s, theta'), where no stiffness appears."""
    D = _chebyshev(n)
    zero, one = np.zeros((n + 1, n + 1)), np.eye(n + 1)
    A = np.block(
        [
            [zero, zero, D, -rod.F * one],
            [zero, zero, rod.g * one, D],
            [D, -rod.nu * one, -rod.c2 * one, zero],
            [zero, D, zero, -one],
        ]
    )
    B = scipy.linalg.block_diag(one, rod.gamma3 * one, zero, zero)
    size = n + 1
    tip, clamp = 0, n
    for row, column in (
        (tip, 2 * size + tip),
        (size + tip, 3 * size + tip),
        (2 * size + clamp, clamp),
        (3 * size + clamp, size + clamp),
    ):
        A[row], B[row] = 0.0, 0.0
        A[row, column] = 1.0
    return _leading(_qz(A, B), modes)


PENCIL, OTHER, ROOTS = "the same pencil", "other discretisations", "roots of D"
PEERS = (
    Peer("Krylov-Schur alone, same pencil", PENCIL, krylov_schur, ORDERS),
    Peer("dense LAPACK QZ, same pencil", PENCIL, dense_qz, ORDERS),
    Peer("dense LAPACK LU and geev, same pencil", PENCIL, dense_inverse, ORDERS),
    Peer("SciPy eigs (ARPACK), same pencil", PENCIL, scipy_eigs, ORDERS),
    Peer("displacement spectral elements, geev", OTHER, displacement_elements, ORDERS),
    Peer("Chebyshev collocation, QZ", OTHER, chebyshev_qz, INTERVALS),
    Peer("Chebyshev, first-order system, QZ", OTHER, chebyshev_first_order, INTERVALS),
    Peer("LAPACK on a coarse mesh, Newton on D", ROOTS, lapack_on_d, START_ORDERS),
)
