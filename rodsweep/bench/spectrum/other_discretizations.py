"""The leading eigenvalues by other discretisations: what one writes from the equations in y and theta.

As in `same_pencil`; the size of a collocation is the number of its intervals.
"""

from functools import lru_cache

import numpy as np
import scipy.linalg

from ...arrays import Array
from ...discretization.pencil import assemble
from ...model.rod import Rod
from ..lapack import Eigenvalues, leading, qz
from .same_pencil import WANTED_MODES, mesh_of


def displacement_elements(rod: Rod, size: int) -> Eigenvalues:
    """Spectral elements of (y, theta) alone with lumped masses, stiffnesses as they are, then geev."""
    bending, couple, tip = _displacement_pieces(size)
    mu, n = rod.k2 * rod.nu + rod.F, len(tip)
    A = np.block(
        [
            [-rod.k2 * bending, mu * couple - rod.F * tip],
            [mu * couple.T, -bending - rod.nu * mu * np.eye(n)],
        ]
    )
    A[n:] /= rod.gamma3
    return leading(scipy.linalg.eigvals(A, check_finite=False), WANTED_MODES + 1)


@lru_cache(maxsize=64)
def _displacement_pieces(size: int) -> tuple[Array, Array, Array]:
    """<a', b'>, <a', b> and a(1) b(1) in units of the masses, from the pencil's own pieces."""
    mesh = mesh_of(size)
    pencil = assemble(mesh.elements, mesh.order)
    n = pencil.nodes
    whole = pencil.dense_pieces().reshape(6, 3 * n, 3 * n).transpose(0, 2, 1)
    tip = np.diag(np.append(np.zeros(n - 1), 1 / pencil.mass[-1]))
    return -whole[1, n : 2 * n, n : 2 * n], whole[2, :n, n : 2 * n] + tip, tip


@lru_cache(maxsize=64)
def _chebyshev(n: int) -> Array:
    """The differentiation matrix at n + 1 Chebyshev points from the tip to the clamp (Trefethen's)."""
    x = np.cos(np.pi * np.arange(n + 1) / n)
    c = np.r_[2, np.ones(n - 1), 2] * (-1) ** np.arange(n + 1)
    D = np.outer(c, 1 / c) / (x[:, None] - x + np.eye(n + 1))
    return 2 * (D - np.diag(D.sum(axis=1)))


def chebyshev_qz(rod: Rod, size: int) -> Eigenvalues:
    """Collocation of (y, theta) at Chebyshev points, boundary rows replaced, then QZ."""
    D, one, n = _chebyshev(size), np.eye(size + 1), size + 1
    zero = np.zeros_like(one)
    mu = rod.k2 * rod.nu + rod.F
    A = np.block([[rod.k2 * (D @ D), -mu * D], [mu * D, D @ D - rod.nu * mu * one]])
    B = scipy.linalg.block_diag(one, rod.gamma3 * one)
    rows = [0, n - 1, n, 2 * n - 1]  # y and theta, each at the tip and at the clamp
    A[rows] = np.block(
        [[D[:1], -rod.nu * one[:1]], [one[-1:], zero[:1]], [zero[:1], D[:1]], [zero[:1], one[-1:]]]
    )
    B[rows] = 0.0
    largest = np.abs(A).max(axis=1, keepdims=True)  # without it QZ finds nothing at k2 = 1e8
    return leading(qz(A / largest, B / largest), WANTED_MODES + 1)


def chebyshev_first_order(rod: Rod, size: int) -> Eigenvalues:
    """The same of the first-order system in (y, theta, s, theta'), where no stiffness appears."""
    D, one, n = _chebyshev(size), np.eye(size + 1), size + 1
    zero = np.zeros_like(one)
    A = np.block(
        [
            [zero, zero, D, -rod.F * one],
            [zero, zero, rod.g * one, D],
            [D, -rod.nu * one, -rod.c2 * one, zero],
            [zero, D, zero, -one],
        ]
    )
    B = scipy.linalg.block_diag(one, rod.gamma3 * one, zero, zero)
    rows = [0, n, 3 * n - 1, 4 * n - 1]  # y and theta at the tip, s and theta' at the clamp, make room for
    A[rows] = np.eye(4 * n)[[2 * n, 3 * n, n - 1, 2 * n - 1]]  # s, theta' = 0 at the tip, y, theta = 0 there
    B[rows] = 0.0
    return leading(qz(A, B), WANTED_MODES + 1)
