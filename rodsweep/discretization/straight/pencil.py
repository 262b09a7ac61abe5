"""The transverse eigenproblem as a matrix pencil that is affine in the parameters.

Unknowns: y and theta in continuous P_p (Gauss-Lobatto nodes, lumped mass) without the clamped node, the shear
force s in discontinuous P_{p-1} (Gauss nodes); P_p: polynomials of degree p on each element. With test
functions (a, b, c),

    w <a, y>         = -<a', s> + F <a', theta> - F a(1) theta(1)
    w gamma3 <b, th> = -<b', theta'> + g <b, s>
    0                =  <c, y' - nu theta> - c2 <c, s>

These are the equations of Sec. VI with the shear force as an additional unknown (th: theta). Only compliances
appear, no stiffnesses, so k1, k2 = inf and gamma3 = 0 are allowed.

Every unknown is scaled by the square root of its mass; theta is also scaled by sqrt(gamma3), s by a small
weight. Krylov methods orthogonalise in the Euclidean norm, which is then the norm of the Gamma inner product
(Sec. VI): the problem at F = 0 is symmetric, and s, which has no time derivative, has almost no weight.
Without the scaling the fourth eigenvalue loses four digits.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import COMPLEX_NAN, Array, Complex
from ...model.compiled.kernel_constants import KernelConstants
from ...model.rod import Rod
from ..elements.basis import value_and_slope_at_gauss_points
from ..elements.elements import ELEMENT_SETTINGS, Elements, equal_edges
from ..elements.quadrature import gauss_legendre_rule, gauss_lobatto_rule
from .field_interpolation import shear_interpolation_matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class PencilNormSettings(KernelConstants):
    """Settings of the norm of a pencil (weights of the unknowns), and of the normalisation of modes."""

    shear_weight: float = 1e-9
    """Weight of the shear force s in the norm. Eigenvalues of nearly crushed rods lose seven digits at a
    weight of 1e-3, and no digits below 1e-8."""
    min_angle_weight: float = 1e-4
    """Minimum weight of theta in the norm. The weight sqrt(gamma3) would tend to 0 for gamma3 -> 0."""
    min_relative_tip_displacement: float = 1e-10
    """A mode is normalised to y(1) = 1 if |y(1)| > min_relative_tip_displacement * max(|y|, |theta|) of all
    nodes."""


PENCIL_NORM_SETTINGS = PencilNormSettings()


class PencilMatrices(NamedTuple):
    """The matrices of the pencil A x = w B x of one rod or arm. A: entries of A in the order of the sparsity
    pattern, (nnz,). B: diagonal of B, (unknowns,). displacement_factors: factors that convert the unknowns to
    y and theta at the nodes, clamp excluded, (2, nodes)."""

    A: Array
    B: Array
    displacement_factors: Array


@dataclass(frozen=True, eq=False)
class Pencil(Elements):
    """The pencil A x = w B x of uniform rods on equal elements, as six constant matrices.

    The matrix of one rod is A = sum_i constant_matrix_factors(rod)[i] constant_matrix_entries[i].
    constant_matrix_entries: entries of the constant matrices, (6, nnz). rows, columns: row and column of each
    entry, (nnz,), sorted by row, then column, with the full diagonal. nodal_masses: lumped mass of the nodes,
    (nodes,). B is diagonal: 1 for y, gamma3 divided by the squared angle weight for theta, 0 for s. The
    unknowns are y, theta and s, `node_count` of each, without the clamp."""

    rows: NDArray[np.int32]
    columns: NDArray[np.int32]
    constant_matrix_entries: Array
    nodal_masses: Array

    @property
    def unknown_count(self) -> int:
        """Number of rows of the matrices."""
        return 3 * self.node_count

    def constant_matrix_factors(self, rod: Rod) -> Array:
        """Factors by which the six constant matrices are multiplied for the rod `rod`, (6,)."""
        t = angle_weight(rod.base_rotational_drag)
        return np.array([1.0, 1 / t**2, rod.F / t, rod.g / t, rod.nu / t, rod.c2])

    def stiffness_entries(self, rod: Rod) -> Array:
        """Entries of the matrix A of the rod `rod`, (nnz,)."""
        return self.constant_matrix_factors(rod) @ self.constant_matrix_entries

    def dense_constant_matrices(self) -> Array:
        """The six constant matrices as dense flat matrices by columns, as LAPACK expects, (6, unknowns^2)."""
        dense = np.zeros((6, self.unknown_count**2))
        dense[:, self.columns.astype(int) * self.unknown_count + self.rows] = self.constant_matrix_entries
        return dense

    def matrices(self, rod: Rod) -> PencilMatrices:
        """The matrices of the pencil of the rod `rod`."""
        return PencilMatrices(
            self.stiffness_entries(rod), self.mass_diagonal(rod), self.displacement_factors(rod)
        )

    def mass_diagonal(self, rod: Rod) -> Array:
        """Diagonal of the matrix B of the rod `rod`, (unknowns,)."""
        B = np.zeros(self.unknown_count)
        B[: self.node_count] = 1.0
        B[self.node_count : 2 * self.node_count] = (
            rod.base_rotational_drag / angle_weight(rod.base_rotational_drag) ** 2
        )
        return B

    def displacement_factors(self, rod: Rod) -> Array:
        """Factors from the unknowns of a rod to y and theta at the nodes, clamp excluded, (2, nodes)."""
        inverse_root = 1 / np.sqrt(self.nodal_masses)
        return np.stack([inverse_root, inverse_root / angle_weight(rod.base_rotational_drag)])


def finite_eigenvalue_count(rod: Rod, node_count: int) -> int:
    """Number of finite eigenvalues of a rod on a mesh with `node_count` nodes, without the clamp. Every node
    contributes one eigenvalue for y, and one for theta if the rod has shear and rotational drag."""
    return node_count if rod.c2 == 0 or rod.base_rotational_drag == 0 else 2 * node_count


def displacements_of_eigenvectors(vectors: Complex, displacement_factors: Array) -> tuple[NDArray, NDArray]:
    """Returns (y, theta) of k eigenvectors `vectors`, (unknowns, k), at all nodes, clamp included, (nodes +
    1, k). displacement_factors: factors from the unknowns to y and theta at the nodes, clamp excluded, (2,
    nodes)."""
    n = displacement_factors.shape[1]
    clamp = np.zeros((1, vectors.shape[1]))
    y, theta = (
        np.vstack([clamp, vectors[i * n : (i + 1) * n] * displacement_factors[i][:, None]]) for i in range(2)
    )
    return y, theta


def angle_weight(gamma3: float) -> float:
    """Weight of theta in the norm: sqrt(gamma3), at least `PENCIL_NORM_SETTINGS.min_angle_weight`."""
    return max(sqrt(gamma3), PENCIL_NORM_SETTINGS.min_angle_weight)


def factors_to_unit_tip_displacement(y: Complex, theta: Complex) -> Complex:
    """Factors, (k,), that normalise k modes to y(1) = 1; NaN for a mode whose y(1) is 0 to rounding. y,
    theta: the modes at all nodes, (nodes + 1, k)."""
    largest_modulus = np.maximum(np.abs(y).max(axis=0), np.abs(theta).max(axis=0))
    return np.where(
        np.abs(y[-1]) > PENCIL_NORM_SETTINGS.min_relative_tip_displacement * largest_modulus,
        1 / y[-1],
        COMPLEX_NAN,
    )


def shear_force(mesh: Elements, vectors: Complex, points: Array) -> Complex:
    """Shear force s, (points, k), of k eigenvectors, (unknowns, k), at `points`, (points,), in [0, 1],
    interpolated from the Gauss nodes."""
    _, weights = gauss_legendre_rule(mesh.order)
    mass = (weights * mesh.lengths[:, None] / 2).ravel() * PENCIL_NORM_SETTINGS.shear_weight**2
    values = vectors[2 * mesh.node_count :] / np.sqrt(mass)[:, None]
    shear: Complex = shear_interpolation_matrix(mesh, points.tobytes()) @ values
    return shear


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_pencils)
def assemble_pencil(element_count: int, order: int) -> Pencil:
    """The pencil on `element_count` equal elements of order `order`."""
    n = element_count * order
    h = 1 / element_count
    _, wg = gauss_legendre_rule(order)
    value, slope = value_and_slope_at_gauss_points(order, order)
    mass = np.zeros(n + 1)
    blocks: list[tuple[int, NDArray[np.integer], NDArray[np.integer], NDArray[np.floating]]] = []
    for e in range(element_count):
        nodes = np.arange(e * order, (e + 1) * order + 1)
        mass[nodes] += gauss_lobatto_rule(order)[1] * h / 2
        is_unclamped = nodes > 0
        y = nodes[is_unclamped] - 1
        theta = n + y
        s = 2 * n + np.arange(e * order, (e + 1) * order)
        test = value[:, is_unclamped]
        test_slope = slope[:, is_unclamped]
        weight = wg * h / 2
        blocks += [
            (0, y, s, -test_slope.T * wg),
            (0, s, y, wg[:, None] * test_slope),
            (1, theta, theta, -(test_slope.T * wg) @ test_slope * 2 / h),
            (2, y, theta, (test_slope.T * wg) @ test),
            (3, theta, s, test.T * weight),
            (4, s, theta, -weight[:, None] * test),
            (5, s, s, -np.diag(weight)),
        ]
    # The follower force at the tip, -F a(1) theta(1).
    blocks.append((2, np.array([n - 1]), np.array([2 * n - 1]), np.array([[-1.0]])))
    masses = np.concatenate(
        [mass[1:], mass[1:], np.tile(wg * h / 2, element_count) * PENCIL_NORM_SETTINGS.shear_weight**2]
    )
    return _assemble_blocks(element_count, order, blocks, mass[1:], 1 / np.sqrt(masses))


def _assemble_blocks(
    element_count: int, order: int, blocks: list, mass: Array, unknown_scales: Array
) -> Pencil:
    """The `Pencil` in which the `blocks` of all elements are summed into one sparsity pattern. element_count,
    order: number and order of the elements. blocks: (index of the constant matrix, rows, columns, block) of
    each block. mass: lumped mass, (nodes,). unknown_scales: factors by which the unknowns are scaled,
    (unknowns,)."""
    size = 3 * element_count * order
    diagonal = np.arange(size)
    keys = [diagonal * size + diagonal]
    keys += [np.add.outer(rows * size, columns).ravel() for _, rows, columns, _ in blocks]
    pattern, positions = np.unique(np.concatenate(keys), return_inverse=True)
    rows, columns = np.divmod(pattern, size)
    terms = np.zeros((6, len(pattern)))
    position = size
    for term, _, _, block in blocks:
        # Blocks of neighbouring elements share entries, which += with repeated indices would count once.
        np.add.at(terms[term], positions[position : position + block.size], block.ravel())
        position += block.size
    terms *= unknown_scales[rows] * unknown_scales[columns]
    return Pencil(
        equal_edges(element_count), order, rows.astype(np.int32), columns.astype(np.int32), terms, mass
    )
