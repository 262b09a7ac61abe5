"""Eigensolvers and discretisations of others: on rodsweep's pencil, and on meshes of their own.

Each takes a rod and a size, the order of the elements or the intervals of a collocation, and gives the
leading eigenvalues, WANTED_MODES and one more, for a pair may straddle the end, largest real part first.
"""

from collections.abc import Callable
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse.linalg

from rodsweep.arrays import Array
from rodsweep.bench.spectrum import arms
from rodsweep.bench.spectrum.arms import mesh_of_arm, on_arm
from rodsweep.bench.spectrum.own import PENCIL, WANTED_MODES, leading
from rodsweep.bench.spectrum.study import ORDERS, mesh_of
from rodsweep.bench.study import Contender
from rodsweep.determinant.roots.newton import refine_eigenvalue
from rodsweep.discretization.straight.pencil import PENCIL_NORM, assemble_pencil
from rodsweep.model.rod import Rod
from rodsweep.solve.spectrum.problem import transverse_problem

from ..lapack import Eigenvalues, inverse_spectrum, qz, whole_matrices


def matrices_at(rod: Rod, size: int) -> tuple[Array, Array]:
    """(A, diagonal of B) of a rod or an arm at an order, shape (unknowns, unknowns) and (unknowns,)."""
    return whole_matrices(rod, mesh_of(size) if rod.standard else mesh_of_arm(rod, size))


def dense_qz(rod: Rod, size: int) -> Eigenvalues:
    """LAPACK's QZ (ggev), eigenvalues only; s at full weight, as its rounding needs."""
    A, B = matrices_at(rod, size)
    scale = np.ones(len(B))
    scale[2 * len(B) // 3 :] = PENCIL_NORM.shear_weight
    return leading(qz(A * scale[:, None] * scale, np.diag(B)), WANTED_MODES + 1)


def dense_inverse(rod: Rod, size: int) -> Eigenvalues:
    """LAPACK's LU and geev."""
    return leading(inverse_spectrum(*matrices_at(rod, size)), WANTED_MODES + 1)


def scipy_eigs(rod: Rod, size: int) -> Eigenvalues:
    """ARPACK through SciPy on the factorised shift-and-invert operator, with rodsweep's shift."""
    A, B = matrices_at(rod, size)
    shift = transverse_problem(rod).shift
    factors = scipy.linalg.lu_factor(A - np.diag(shift * B), check_finite=False)
    operator = scipy.sparse.linalg.LinearOperator(
        A.shape, matvec=lambda x: scipy.linalg.lu_solve(factors, B * x, check_finite=False), dtype=float
    )
    theta = scipy.sparse.linalg.eigs(operator, WANTED_MODES, v0=np.ones(len(B)), return_eigenvectors=False)
    return leading(shift + 1 / theta, WANTED_MODES + 1)


def lapack_on_d(rod: Rod, size: int) -> Eigenvalues:
    """LAPACK on a coarse pencil, then Newton's method on D: what a root polisher does."""
    return np.array([refine_eigenvalue(complex(w), rod.coefficients) for w in dense_inverse(rod, size)])


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
    pencil = assemble_pencil(mesh.elements, mesh.order)
    n = pencil.nodes
    whole = pencil.dense_terms().reshape(6, 3 * n, 3 * n).transpose(0, 2, 1)
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
    """The same of the first-order system in (y, theta, s, m), where no stiffness appears, on each piece of an
    arm between two jumps.
    """
    edges = (0.0, 1.0) if rod.standard else rod.build.breaks
    pieces = [_first_order(rod, a, b, size) for a, b in zip(edges[:-1], edges[1:], strict=True)]
    A, B = (scipy.linalg.block_diag(*blocks) for blocks in zip(*pieces, strict=True))
    n, last = size + 1, 4 * (size + 1) * (len(pieces) - 1)
    for start in range(0, len(B), 4 * n):
        upper, lower = start + np.array([0, n, 2 * n, 3 * n]), start + np.array([1, 2, 3, 4]) * n - 1
        rows = [*upper[:2], *lower[2:]]  # of the balances at the upper end, of the strains at the lower end
        A[rows] = B[rows] = 0.0
        A[rows, [*upper[2:], *lower[:2]]] = 1.0  # s and m there, y and theta
        if start > 0:
            A[rows[2:], upper[:2] - 4 * n] = -1.0
        if start < last:
            A[rows[:2], lower[2:] + 4 * n] = -1.0
    return leading(qz(A, B), WANTED_MODES + 1)


def _first_order(rod: Rod, a: float, b: float, size: int) -> tuple[Array, Array]:
    """(A, B) of the equations at all points of the piece from a to b, from its upper end to its lower."""
    inside = np.clip((1 + np.cos(np.pi * np.arange(size + 1) / size)) / 2, END_OF_PIECE, 1 - END_OF_PIECE)
    here = rod.local(a + (b - a) * inside)
    D = _chebyshev(size) / (b - a)
    zero = np.zeros_like(D)
    nu, c2, c3, g = map(np.diag, (here.nu, here.c2, here.c3, here.g))
    A = np.block(
        [[zero, zero, D, -rod.F * c3], [zero, zero, g, D], [D, -nu, -c2, zero], [zero, D, zero, -c3]]
    )
    return A, scipy.linalg.block_diag(np.diag(here.gamma2), np.diag(here.gamma3), zero, zero)


INTERVALS = (10, 12, 14, 16, 18, 20, 22, 24, 28, 32, 40, 56, 80)
END_OF_PIECE = 1e-12
"""Distance from a jump at which the coefficients of a piece are taken, in units of its length."""
ARM_INTERVALS = (10, 12, 14, 16, 20, 24, 32)
START_ORDERS = (8, 10, 11, 12, 14, 18, 24, 32, 40)
"""Of meshes whose eigenvalues are refined on D."""
OTHER_MESH = "other discretisations"


class Peer(NamedTuple):
    """What a user would write instead, and the group it belongs to in a figure."""

    name: str
    group: str
    solve: Callable[..., Eigenvalues]
    sizes: tuple[int, ...]


PEERS = (
    Peer("dense LAPACK QZ, same pencil", PENCIL, dense_qz, ORDERS),
    Peer("dense LAPACK LU and geev, same pencil", PENCIL, dense_inverse, ORDERS),
    Peer("SciPy eigs (ARPACK), same pencil", PENCIL, scipy_eigs, ORDERS),
    Peer("displacement spectral elements, geev", OTHER_MESH, displacement_elements, ORDERS),
    Peer("Chebyshev collocation, QZ", OTHER_MESH, chebyshev_qz, INTERVALS),
    Peer("Chebyshev, first-order system, QZ", OTHER_MESH, chebyshev_first_order, INTERVALS),
    Peer("LAPACK on a coarse mesh, Newton on D", "roots of D", lapack_on_d, START_ORDERS),
)


def contenders() -> list[Contender]:
    """All peers at all of their sizes."""
    return [
        Contender(peer.name, str(size), peer.group, partial(peer.solve, size=size))
        for peer in PEERS
        for size in peer.sizes
    ]


def arm_contenders() -> list[Contender]:
    """The peers that take an arm as it is, at all of their sizes on a piece of it."""
    taken = {dense_inverse: arms.ORDERS, scipy_eigs: arms.ORDERS, chebyshev_first_order: ARM_INTERVALS}
    return [
        Contender(peer.name, str(size), peer.group, partial(on_arm, peer.solve, size))
        for peer in PEERS
        for size in taken.get(peer.solve, ())
    ]
