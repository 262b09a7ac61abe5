"""The transverse eigenproblem of an arm with profiles and any law as a sparse matrix pencil.

The weak form is that of `rodsweep.discretization.straight.pencil`, with weights c2(u), c3(u), nu(u), g(u) at
the Gauss points and gamma2(u), gamma3(u) at the Lobatto nodes. Elements end where a coefficient jumps, so the
solution is smooth within each element. The matrix is not affine in any parameter, and is filled for every
arm.
"""

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...model.rod import Rod
from ..elements.basis import differentiation, interpolation
from ..elements.elements import Elements
from ..elements.quadrature import gauss, gauss_lobatto
from .pencil import PENCIL_NORM, Matrices


class ArmMesh(Elements):
    """Elements for `ArmPencil`; an element must end wherever a coefficient jumps."""

    @property
    def unknowns(self) -> int:
        """The total number of unknowns y, theta and s."""
        return 3 * self.nodes


class ArmPencil:
    """Sparsity pattern on a mesh, and matrices of any arm whose breaks are edges of the mesh.

    rows, columns: indices of the pattern, (nnz,), sorted by row, then column, with the diagonal. The unknowns
    are (y, theta, s), `mesh.nodes` of each.
    """

    def __init__(self, mesh: ArmMesh):
        self.mesh = mesh
        self.order = mesh.order
        self.nodes = mesh.nodes
        self.unknowns = mesh.unknowns
        edges = np.array(mesh.edges)
        self._h = mesh.lengths
        self._x, self._w = gauss_lobatto(mesh.order)
        xg, self._wg = gauss(mesh.order)
        self._value = interpolation(self._x, xg)
        self._slope = self._value @ differentiation(self._x)
        self._gauss_points: Array = edges[:-1, None] + self._h[:, None] * (xg + 1) / 2
        self._lobatto_points = mesh.points_inside
        self._y: NDArray[np.int64] = (
            np.arange(mesh.elements)[:, None] * mesh.order + np.arange(mesh.order + 1) - 1
        )
        self.rows, self.columns, self._where = self._pattern()

    @property
    def positions(self) -> Array:
        """u of all nodes, both ends included, shape (nodes + 1,)."""
        return self.mesh.positions

    def matrices(self, rod: Rod) -> Matrices:
        """The pencil of an arm."""
        inside = rod.local(self._gauss_points)
        at_nodes = rod.local(self._lobatto_points)
        weight = self._wg * self._h[:, None] / 2
        S = self._slope
        V = self._value
        wg = self._wg
        shape = (self.mesh.elements, self.order + 1, self.order)
        blocks = [
            np.broadcast_to(-S.T * wg, shape),
            np.broadcast_to(wg[:, None] * S, (shape[0], shape[2], shape[1])),
            -np.einsum("gi,eg,gj->eij", S, wg / inside.c3 * (2 / self._h[:, None]), S),
            np.broadcast_to(rod.F * (S.T * wg) @ V, (shape[0], shape[1], shape[1])),
            V.T * (weight * inside.g)[:, None, :],
            -(weight * inside.nu)[:, :, None] * V,
            -weight * inside.c2,
        ]
        # The last entry is the follower force at the tip, -F a(1) theta(1).
        entries = np.concatenate([*(block.ravel() for block in blocks), [-rod.F]])
        # Entries of the clamp are summed behind the pattern and dropped.
        summed = np.bincount(self._where, entries, minlength=len(self.rows) + 1)[: len(self.rows)]
        lumped = self._w * self._h[:, None] / 2
        push = self._at_nodes(lumped * at_nodes.gamma2)
        turn = self._at_nodes(lumped * at_nodes.gamma3)
        least = PENCIL_NORM.least_angle_weight**2 * self._at_nodes(lumped)
        # Without rotational drag theta has no mass, and its scale would be infinite.
        angle = np.maximum(turn, least)
        masses = np.concatenate([push, angle, weight.ravel() * PENCIL_NORM.shear_weight**2])
        scale = 1 / np.sqrt(masses)
        B = np.concatenate([np.ones(self.nodes), turn / angle, np.zeros(self.nodes)])
        A = summed * scale[self.rows] * scale[self.columns]
        return Matrices(A, B, scale[: 2 * self.nodes].reshape(2, -1))

    def evaluation(self, points: Array) -> Array:
        """Matrix from values at all nodes to values at `points` in [0, 1], shape (points, nodes + 1)."""
        return self.mesh.evaluation(points)

    def _at_nodes(self, values: Array) -> Array:
        """Values of the elements, (elements, order + 1), summed at each node except the clamp, (nodes,)."""
        node = (self._y + 1).ravel()
        return np.asarray(np.bincount(node, values.ravel(), minlength=self.nodes + 1)[1:], float)

    def _pattern(self) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int64]]:
        """(rows, columns, index in the pattern of each entry of the blocks of `matrices`).

        Entries of the clamp have an index beyond the pattern.
        """
        n = self.nodes
        size = self.unknowns
        y = self._y
        theta = np.where(y < 0, -1, y + n)
        s = 2 * n + np.arange(n).reshape(self.mesh.elements, self.order)
        pairs = [(y, s), (s, y), (theta, theta), (y, theta), (theta, s), (s, theta)]
        keys = [_keys(rows, columns, size) for rows, columns in pairs]
        keys += [(s * size + s).ravel(), np.array([(n - 1) * size + 2 * n - 1])]
        every = np.concatenate(keys)
        diagonal = np.arange(size) * (size + 1)
        pattern = np.unique(np.concatenate([every[every >= 0], diagonal]))
        where = np.where(every < 0, len(pattern), np.searchsorted(pattern, every))
        rows, columns = np.divmod(pattern, size)
        return rows.astype(np.int32), columns.astype(np.int32), where


def _keys(rows: NDArray[np.int64], columns: NDArray[np.int64], size: int) -> NDArray[np.int64]:
    """row * size + column of each entry of the elements' blocks; -1 if the row or column is the clamp.

    rows, columns: (elements, n) and (elements, m).
    """
    keys = rows[:, :, None] * size + columns[:, None, :]
    clamped = (rows < 0)[:, :, None] | (columns < 0)[:, None, :]
    return np.where(clamped, -1, keys).ravel()
