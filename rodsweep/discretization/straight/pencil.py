"""The transverse eigenproblem as a matrix pencil that is affine in the parameters.

Unknowns: y and theta in continuous P_p (Gauss-Lobatto nodes, lumped mass) without the clamped node,
the shear force s in discontinuous P_{p-1} (Gauss nodes). With test functions (a, b, c),

    w <a, y>         = -<a', s> + F <a', theta> - F a(1) theta(1)
    w gamma3 <b, th> = -<b', theta'> + g <b, s>
    0                =  <c, y' - nu theta> - c2 <c, s>

which is Sec. VI with the shear force kept as an unknown: no stiffness appears, only compliances, so
that k1, k2 = inf and gamma3 = 0 are ordinary values.

Every unknown is scaled by the square root of its mass, theta by sqrt(gamma3) and s by SHEAR_WEIGHT
besides: the Euclidean norm in which a Krylov space is orthogonalised is then the norm of the Gamma
inner product (Sec. VI), in which the problem at F = 0 is symmetric and s, which carries no time
derivative, weighs next to nothing. Unscaled, the fourth eigenvalue loses four digits.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...model.rod import Rod
from ..elements.basis import differentiation, interpolation
from ..elements.elements import Elements, equal_edges
from ..elements.quadrature import gauss, gauss_lobatto

SHEAR_WEIGHT = 1e-9
"""Weight of s in the norm. Nearly crushed rods lose seven digits at 1e-3, none below 1e-8."""
LEAST_ANGLE_WEIGHT = 1e-4
"""Weight of theta for gamma3 -> 0, where it carries no time derivative either."""
NO_TIP = 1e-10
"""y(1) in units of the largest value, below which a vector cannot be scaled by it."""


@dataclass(frozen=True, eq=False)
class Pencil(Elements):
    """Constant pieces for equal elements.

    The matrix of one rod is A = sum_i coefficients(rod)[i] pieces[i], in coordinate form: pieces
    has shape (6, nnz), rows and columns shape (nnz,), sorted by row, then column, diagonal included.
    B is diagonal: 1 for y, gamma3 over the squared angle weight for theta, 0 for s.
    The unknowns are (y, theta, s), (nodes, nodes, nodes) of them; `nodes` is without the clamp.
    """

    rows: NDArray[np.int32]
    columns: NDArray[np.int32]
    pieces: Array
    mass: Array

    @property
    def unknowns(self) -> int:
        return 3 * self.nodes

    def finite(self, rod: Rod) -> int:
        """The number of finite eigenvalues: without shear or rotational drag theta follows y."""
        return self.nodes if rod.c2 == 0 or rod.rotational_drag == 0 else 2 * self.nodes

    def coefficients(self, rod: Rod) -> Array:
        """What the pieces are multiplied by, shape (6,)."""
        t, g, nu = angle_weight(rod.rotational_drag), rod.g, rod.nu
        return np.array([1.0, 1 / t**2, rod.F / t, g / t, nu / t, rod.c2])

    def stiffness(self, rod: Rod) -> Array:
        """The entries of A, shape (nnz,)."""
        return self.coefficients(rod) @ self.pieces

    def dense_pieces(self) -> Array:
        """The pieces as whole matrices, column by column as LAPACK stores them, shape (6, unknowns^2)."""
        whole = np.zeros((6, self.unknowns**2))
        whole[:, self.columns.astype(int) * self.unknowns + self.rows] = self.pieces
        return whole

    def dense(self, rod: Rod) -> tuple[Array, Array]:
        """(A, diagonal of B) of the rod as whole arrays, shapes (unknowns, unknowns) and (unknowns,)."""
        A = np.zeros((self.unknowns, self.unknowns))
        A[self.rows, self.columns] = self.stiffness(rod)
        return A, self.inertia(rod)

    def inertia(self, rod: Rod) -> Array:
        """The diagonal of B, shape (unknowns,)."""
        B = np.zeros(self.unknowns)
        B[: self.nodes] = 1.0
        B[self.nodes : 2 * self.nodes] = rod.rotational_drag / angle_weight(rod.rotational_drag) ** 2
        return B

    def scale(self, rod: Rod) -> Array:
        """What y and theta at the nodes are in units of the unknowns, (2, nodes)."""
        push = 1 / np.sqrt(self.mass)
        return np.stack([push, push / angle_weight(rod.rotational_drag)])

    def fields(self, vectors: Complex, rod: Rod) -> tuple[NDArray, NDArray]:
        """(y, theta) at all nodes, the clamp included, shape (nodes + 1, k), from k eigenvectors."""
        push, turn = self.scale(rod)[:, :, None]
        clamp = np.zeros((1, vectors.shape[1]))
        y = vectors[: self.nodes] * push
        theta = vectors[self.nodes : 2 * self.nodes] * turn
        return np.vstack([clamp, y]), np.vstack([clamp, theta])


def angle_weight(gamma3: float) -> float:
    """Weight of theta in the norm: sqrt(gamma3), bounded below."""
    return max(sqrt(gamma3), LEAST_ANGLE_WEIGHT)


def tip_scale(y: Complex, theta: Complex) -> Complex:
    """Factors (k,) that scale k modes (nodes + 1, k) to y(1) = 1; NaN for a mode whose tip does not move."""
    size = np.maximum(np.abs(y).max(axis=0), np.abs(theta).max(axis=0))
    return np.where(np.abs(y[-1]) > NO_TIP * size, 1 / y[-1], np.nan + 0j)


def shear_force(mesh: Elements, vectors: Complex, points: Array) -> Complex:
    """s of the vectors at `points`, from its own unknowns at the Gauss nodes; shape (points, k)."""
    nodes, weights = gauss(mesh.order)
    mass = (weights * mesh.lengths[:, None] / 2).ravel() * SHEAR_WEIGHT**2
    values = vectors[2 * mesh.nodes :] / np.sqrt(mass)[:, None]
    result = np.empty((len(points), vectors.shape[1]), complex)
    for first, here, local in mesh.by_element(points):
        result[here] = interpolation(nodes, local) @ values[first : first + mesh.order]
    return result


def slope(mesh: Elements, values: Complex, points: Array) -> Complex:
    """The derivative at `points` of fields given at all nodes, shape (nodes + 1, k); shape (points, k)."""
    nodes, _ = gauss_lobatto(mesh.order)
    derivative = 2 * differentiation(nodes)
    result = np.empty((len(points), values.shape[1]), complex)
    for first, here, local in mesh.by_element(points):
        changes = derivative @ values[first : first + mesh.order + 1] / mesh.lengths[first // mesh.order]
        result[here] = interpolation(nodes, local) @ changes
    return result


@lru_cache(maxsize=64)
def assemble(elements: int, order: int) -> Pencil:
    """The constant pieces on `elements` equal elements of order `order`."""
    n, h = elements * order, 1 / elements
    x, w = gauss_lobatto(order)
    xg, wg = gauss(order)
    value = interpolation(x, xg)
    slope = value @ differentiation(x)
    mass = np.zeros(n + 1)
    entries: list[tuple[int, NDArray[np.integer], NDArray[np.integer], NDArray[np.floating]]] = []
    for e in range(elements):
        local = np.arange(e * order, (e + 1) * order + 1)
        mass[local] += w * h / 2
        keep = local > 0
        y = local[keep] - 1
        theta, s = n + y, 2 * n + np.arange(e * order, (e + 1) * order)
        test, test_slope, weight = value[:, keep], slope[:, keep], wg * h / 2
        entries += [
            (0, y, s, -test_slope.T * wg),
            (0, s, y, wg[:, None] * test_slope),
            (1, theta, theta, -(test_slope.T * wg) @ test_slope * 2 / h),
            (2, y, theta, (test_slope.T * wg) @ test),
            (3, theta, s, test.T * weight),
            (4, s, theta, -weight[:, None] * test),
            (5, s, s, -np.diag(weight)),
        ]
    entries.append((2, np.array([n - 1]), np.array([2 * n - 1]), np.array([[-1.0]])))
    masses = np.concatenate([mass[1:], mass[1:], np.tile(wg * h / 2, elements) * SHEAR_WEIGHT**2])
    return _gather(elements, order, entries, mass[1:], 1 / np.sqrt(masses))


def _gather(elements: int, order: int, entries: list, mass: Array, scale: Array) -> Pencil:
    """Sums the element entries (piece, rows, columns, block) into one sorted coordinate pattern."""
    size = 3 * elements * order
    diagonal = np.arange(size)
    key = [diagonal * size + diagonal]
    key += [np.add.outer(rows * size, columns).ravel() for _, rows, columns, _ in entries]
    pattern, where = np.unique(np.concatenate(key), return_inverse=True)
    rows, columns = np.divmod(pattern, size)
    pieces = np.zeros((6, len(pattern)))
    at = size
    for piece, _, _, block in entries:
        np.add.at(pieces[piece], where[at : at + block.size], block.ravel())
        at += block.size
    pieces *= scale[rows] * scale[columns]
    return Pencil(equal_edges(elements), order, rows.astype(np.int32), columns.astype(np.int32), pieces, mass)
