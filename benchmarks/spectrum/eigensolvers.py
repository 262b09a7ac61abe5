"""Eigensolvers of LAPACK and SciPy on rodsweep's pencil, and on further discretisations of the rod.

Every solver takes a rod and a size, which is the order of the elements or the number of intervals of a
collocation. It returns the WANTED_MODES + 1 leading eigenvalues, largest real part first: the last wanted
eigenvalue may belong to a complex pair.
"""

from collections.abc import Callable
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse.linalg

from rodsweep.arrays import Array
from rodsweep.bench.spectrum import arm_spectra
from rodsweep.bench.spectrum.arm_spectra import mesh_of_arm, solve_next_arm
from rodsweep.bench.spectrum.rodsweep_and_exact_spectra import MODE_COUNT, PENCIL_GROUP, leading_eigenvalues
from rodsweep.bench.spectrum.study import ELEMENT_ORDERS, mesh_of_total_order
from rodsweep.bench.study import TimedMethod
from rodsweep.determinant.roots.newton import refine_eigenvalue
from rodsweep.discretization.straight.pencil import PENCIL_NORM_SETTINGS, assemble_pencil
from rodsweep.model.rod import Rod
from rodsweep.solve.spectrum.problem import transverse_problem

from ..lapack import Eigenvalues, inverse_spectrum, qz_spectrum, whole_matrices


def pencil_matrices(rod: Rod, size: int) -> tuple[Array, Array]:
    """(A, diagonal of B) of rodsweep's pencil of order `size`, shapes (unknowns, unknowns), (unknowns,)."""
    return whole_matrices(
        rod, mesh_of_total_order(size) if rod.is_uniform_and_linear else mesh_of_arm(rod, size)
    )


def dense_qz(rod: Rod, size: int) -> Eigenvalues:
    """Leading eigenvalues by LAPACK's QZ (ggev). The shear unknowns are scaled to limit rounding errors."""
    A, B = pencil_matrices(rod, size)
    scale = np.ones(len(B))
    scale[2 * len(B) // 3 :] = PENCIL_NORM_SETTINGS.shear_weight
    return leading_eigenvalues(qz_spectrum(A * scale[:, None] * scale, np.diag(B)), MODE_COUNT + 1)


def dense_inverse(rod: Rod, size: int) -> Eigenvalues:
    """Leading eigenvalues by LAPACK's LU of A and geev of A^-1 B."""
    return leading_eigenvalues(inverse_spectrum(*pencil_matrices(rod, size)), MODE_COUNT + 1)


def scipy_eigs(rod: Rod, size: int) -> Eigenvalues:
    """Leading eigenvalues by SciPy's ARPACK on the shift-and-invert operator with rodsweep's shift."""
    A, B = pencil_matrices(rod, size)
    shift = transverse_problem(rod).shift
    factors = scipy.linalg.lu_factor(A - np.diag(shift * B), check_finite=False)
    operator = scipy.sparse.linalg.LinearOperator(
        A.shape, matvec=lambda x: scipy.linalg.lu_solve(factors, B * x, check_finite=False), dtype=float
    )
    theta = scipy.sparse.linalg.eigs(operator, MODE_COUNT, v0=np.ones(len(B)), return_eigenvectors=False)
    return leading_eigenvalues(shift + 1 / theta, MODE_COUNT + 1)


def lapack_on_d(rod: Rod, size: int) -> Eigenvalues:
    """Leading eigenvalues by LAPACK on a coarse pencil, refine_eigenvalue by Newton's method on D."""
    return np.array([refine_eigenvalue(complex(w), rod.coefficients) for w in dense_inverse(rod, size)])


def displacement_elements(rod: Rod, size: int) -> Eigenvalues:
    """Leading eigenvalues by geev on spectral elements of (y, theta) with lumped mass matrices.

    The matrix contains the stiffness k2 itself, not its inverse.
    """
    bending, couple, tip = _displacement_pieces(size)
    mu, n = rod.k2 * rod.nu + rod.F, len(tip)
    A = np.block(
        [
            [-rod.k2 * bending, mu * couple - rod.F * tip],
            [mu * couple.T, -bending - rod.nu * mu * np.eye(n)],
        ]
    )
    A[n:] /= rod.gamma3
    return leading_eigenvalues(scipy.linalg.eigvals(A, check_finite=False), MODE_COUNT + 1)


@lru_cache(maxsize=64)
def _displacement_pieces(size: int) -> tuple[Array, Array, Array]:
    """Matrices of <a', b'>, <a', b> and a(1) b(1) divided by the lumped masses, (nodes, nodes) each.

    a, b: shape functions. The matrices are taken from rodsweep's pencil.
    """
    mesh = mesh_of_total_order(size)
    pencil = assemble_pencil(mesh.element_count, mesh.order)
    n = pencil.node_count
    whole = pencil.dense_constant_matrices().reshape(6, 3 * n, 3 * n).transpose(0, 2, 1)
    tip = np.diag(np.append(np.zeros(n - 1), 1 / pencil.nodal_masses[-1]))
    return -whole[1, n : 2 * n, n : 2 * n], whole[2, :n, n : 2 * n] + tip, tip


@lru_cache(maxsize=64)
def _chebyshev(n: int) -> Array:
    """Differentiation matrix, (n + 1, n + 1), at n + 1 Chebyshev points from tip to clamp (Trefethen)."""
    x = np.cos(np.pi * np.arange(n + 1) / n)
    c = np.r_[2, np.ones(n - 1), 2] * (-1) ** np.arange(n + 1)
    D = np.outer(c, 1 / c) / (x[:, None] - x + np.eye(n + 1))
    return 2 * (D - np.diag(D.sum(axis=1)))


def chebyshev_qz(rod: Rod, size: int) -> Eigenvalues:
    """Leading eigenvalues by QZ on a collocation of (y, theta) at Chebyshev points.

    Rows of the end points are replaced by the boundary conditions.
    """
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
    return leading_eigenvalues(qz_spectrum(A / largest, B / largest), MODE_COUNT + 1)


def chebyshev_first_order(rod: Rod, size: int) -> Eigenvalues:
    """Leading eigenvalues by QZ on a Chebyshev collocation of the first-order system in (y, theta, s, m).

    The first-order system contains compliances instead of stiffnesses. An arm is divided at its jumps, and
    every segment has `size` intervals.
    """
    edges = (0.0, 1.0) if rod.is_uniform_and_linear else rod.material.breaks
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
    return leading_eigenvalues(qz_spectrum(A, B), MODE_COUNT + 1)


def _first_order(rod: Rod, a: float, b: float, size: int) -> tuple[Array, Array]:
    """(A, B) of the first-order system on the segment from a to b, (4 n, 4 n) with n = size + 1 points.

    The points run from the end b to the end a.
    """
    inside = np.clip((1 + np.cos(np.pi * np.arange(size + 1) / size)) / 2, END_OF_PIECE, 1 - END_OF_PIECE)
    here = rod.local_coefficients(a + (b - a) * inside)
    D = _chebyshev(size) / (b - a)
    zero = np.zeros_like(D)
    nu, c2, c3, g = map(np.diag, (here.nu, here.c2, here.c3, here.g))
    A = np.block(
        [[zero, zero, D, -rod.F * c3], [zero, zero, g, D], [D, -nu, -c2, zero], [zero, D, zero, -c3]]
    )
    return A, scipy.linalg.block_diag(np.diag(here.gamma2), np.diag(here.gamma3), zero, zero)


INTERVALS = (10, 12, 14, 16, 18, 20, 22, 24, 28, 32, 40, 56, 80)
"""Numbers of intervals of the Chebyshev collocations."""
END_OF_PIECE = 1e-12
"""Distance from a jump, as a fraction of the segment's length, at which the coefficients at the end of a
segment are evaluated."""
ARM_INTERVALS = (10, 12, 14, 16, 20, 24, 32)
"""Numbers of intervals of the Chebyshev collocation on every segment of an arm."""
START_ORDERS = (8, 10, 11, 12, 14, 18, 24, 32, 40)
"""Orders of the pencils whose eigenvalues are refined on D."""
OTHER_MESH_GROUP = "other discretisations"
"""Group, in a figure, of methods that do not use rodsweep's pencil."""


class Peer(NamedTuple):
    """An eigensolver with the sizes at which it is run. group: its group of curves in the figure."""

    name: str
    group: str
    solve: Callable[..., Eigenvalues]
    sizes: tuple[int, ...]


PEERS = (
    Peer("dense LAPACK QZ, same pencil", PENCIL_GROUP, dense_qz, ELEMENT_ORDERS),
    Peer("dense LAPACK LU and geev, same pencil", PENCIL_GROUP, dense_inverse, ELEMENT_ORDERS),
    Peer("SciPy eigs (ARPACK), same pencil", PENCIL_GROUP, scipy_eigs, ELEMENT_ORDERS),
    Peer("displacement spectral elements, geev", OTHER_MESH_GROUP, displacement_elements, ELEMENT_ORDERS),
    Peer("Chebyshev collocation, QZ", OTHER_MESH_GROUP, chebyshev_qz, INTERVALS),
    Peer("Chebyshev, first-order system, QZ", OTHER_MESH_GROUP, chebyshev_first_order, INTERVALS),
    Peer("LAPACK on a coarse mesh, Newton on D", "roots of D", lapack_on_d, START_ORDERS),
)


def contenders() -> list[TimedMethod]:
    """All peers on a rod, at all of their sizes."""
    return [
        TimedMethod(peer.name, str(size), peer.group, partial(peer.solve, size=size))
        for peer in PEERS
        for size in peer.sizes
    ]


def arm_contenders() -> list[TimedMethod]:
    """The peers that solve arms with properties that vary along the length, at all of their sizes."""
    taken = {
        dense_inverse: arm_spectra.ELEMENT_ORDERS,
        scipy_eigs: arm_spectra.ELEMENT_ORDERS,
        chebyshev_first_order: ARM_INTERVALS,
    }
    return [
        TimedMethod(peer.name, str(size), peer.group, partial(solve_next_arm, peer.solve, size))
        for peer in PEERS
        for size in taken.get(peer.solve, ())
    ]
