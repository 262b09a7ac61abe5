"""The transverse eigenproblem of an arm with any profile and constitutive law, as a sparse matrix pencil.

The weak form is given in `rodsweep.discretization.straight.pencil`; here the coefficients c2(u), c3(u), nu(u)
and g(u) are evaluated at the Gauss points, gamma2(u) and gamma3(u) at the Lobatto nodes. Elements end where a
coefficient jumps, so the solution is smooth within each element. The matrices are not affine in any parameter
and are computed anew for every arm.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.local_coefficients import local_coefficient_array
from ...model.rod import Rod
from ..elements.basis import value_and_slope_at_gauss_points
from ..elements.quadrature import gauss_legendre_rule, gauss_lobatto_rule
from .arm_resolution import ArmMesh
from .pencil import PENCIL_NORM_SETTINGS, PencilMatrices


class _MeshMatrices(NamedTuple):
    """Matrices and weights of a mesh of elements of order p, from which `_pencil_of_coefficients` computes
    the pencil of an arm.

    interpolation_to_gauss_points, derivatives_at_gauss_points: matrices from nodes to Gauss points, (p, p +
    1). derivative_value_integrals: integrals of derivatives (rows) times values (columns) of the nodal
    polynomials, (p + 1, p + 1). arm_independent_entries: entries of the first two blocks, which are the same
    for every arm, (n,). weights_over_half_length, weights_times_half_length: Gauss weights divided by, and
    times, half the length of each element, (elements, p). nodal_masses: mass of the nodes, (elements, p + 1).
    pattern_indices: index in the sparsity pattern of A of each entry of all blocks, (m,). rows, columns: row
    and column of each entry of the sparsity pattern, (nnz,)."""

    interpolation_to_gauss_points: Array
    derivatives_at_gauss_points: Array
    derivative_value_integrals: Array
    arm_independent_entries: Array
    weights_over_half_length: Array
    weights_times_half_length: Array
    nodal_masses: Array
    pattern_indices: NDArray[np.int64]
    rows: NDArray[np.int32]
    columns: NDArray[np.int32]


class ArmPencil:
    """Sparsity pattern of the transverse eigenproblem on a mesh; `matrices` computes the matrices of any arm.

    Every break of the arm must be an edge of the mesh. rows, columns: row and column of each entry of the
    pattern, (nnz,), sorted by row, then column, with the full diagonal. The unknowns are y, theta and s,
    `mesh.node_count` of each.
    """

    def __init__(self, mesh: ArmMesh):
        self.mesh = mesh
        self.order = mesh.order
        self.node_count = mesh.node_count
        self.unknown_count = mesh.unknown_count
        edges = np.array(mesh.edges)
        h = mesh.lengths
        _, w = gauss_lobatto_rule(mesh.order)
        xg, wg = gauss_legendre_rule(mesh.order)
        value, slope = value_and_slope_at_gauss_points(mesh.order, mesh.order)
        gauss_points: Array = edges[:-1, None] + h[:, None] * (xg + 1) / 2
        # Gauss points of the elements, then their nodes, (elements, 2 order + 1).
        self._sample_points = np.concatenate(
            [gauss_points, mesh.one_sided_nodes.reshape(mesh.element_count, -1)], axis=1
        )
        slopes = slope.T * wg
        # The clamp is not an unknown and gets the index -1.
        self._y_indices: NDArray[np.int64] = (
            np.arange(mesh.element_count)[:, None] * mesh.order + np.arange(mesh.order + 1) - 1
        )
        self.rows, self.columns, pattern_indices = self._sparsity_pattern()
        self._mesh_matrices = _MeshMatrices(
            interpolation_to_gauss_points=value,
            derivatives_at_gauss_points=slope,
            derivative_value_integrals=slopes @ value,
            arm_independent_entries=np.concatenate(
                [np.tile(x.ravel(), mesh.element_count) for x in (-slopes, slopes.T)]
            ),
            weights_over_half_length=wg * (2 / h[:, None]),
            weights_times_half_length=wg * h[:, None] / 2,
            nodal_masses=w * h[:, None] / 2,
            pattern_indices=pattern_indices,
            rows=self.rows,
            columns=self.columns,
        )

    @property
    def node_positions(self) -> Array:
        """Material coordinate u of all nodes, both ends included, (nodes + 1,)."""
        return self.mesh.node_positions

    def matrices(self, rod: Rod) -> PencilMatrices:
        """The matrices of the pencil of the arm `rod`."""
        return PencilMatrices(
            *_pencil_of_coefficients(
                float(rod.F), local_coefficient_array([rod], self._sample_points)[:, 0], self._mesh_matrices
            )
        )

    def evaluation_matrix(self, points: Array) -> Array:
        """Matrix (n, nodes + 1) from values at all nodes to values at `points`, (n,), in [0, 1]."""
        return self.mesh.evaluation_matrix(points)

    def _sparsity_pattern(self) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int64]]:
        """Returns (rows, columns, positions). rows, columns: row and column of each entry of the pattern,
        (nnz,) each. positions: for each entry of all element blocks, its index in the pattern, (m,); nnz for
        entries in the row or column of the clamp."""
        n = self.node_count
        size = self.unknown_count
        y = self._y_indices
        theta = np.where(y < 0, -1, y + n)
        s = 2 * n + np.arange(n).reshape(self.mesh.element_count, self.order)
        pairs = [(y, s), (s, y), (theta, theta), (y, theta), (theta, s), (s, theta)]
        keys = [_row_major_indices(rows, columns, size) for rows, columns in pairs]
        # The last key is the entry of the follower force at the tip: row y(1), column theta(1).
        keys += [(s * size + s).ravel(), np.array([(n - 1) * size + 2 * n - 1])]
        all_keys = np.concatenate(keys)
        # The diagonal is complete, so that a shift A - sigma B keeps the pattern.
        diagonal = np.arange(size) * (size + 1)
        pattern = np.unique(np.concatenate([all_keys[all_keys >= 0], diagonal]))
        positions = np.where(all_keys < 0, len(pattern), np.searchsorted(pattern, all_keys))
        rows, columns = np.divmod(pattern, size)
        return rows.astype(np.int32), columns.astype(np.int32), positions


def _row_major_indices(rows: NDArray[np.int64], columns: NDArray[np.int64], size: int) -> NDArray[np.int64]:
    """Index row * size + column of each entry of all element blocks, flat; -1 if the row or column is the
    clamp. rows, columns: rows and columns of the block of each element, (elements, n) and (elements, m).
    size: number of unknowns."""
    keys = rows[:, :, None] * size + columns[:, None, :]
    clamped = (rows < 0)[:, :, None] | (columns < 0)[:, None, :]
    return np.where(clamped, -1, keys).ravel()


@compiled
def _pencil_of_coefficients(
    F: float, coefficients: Array, matrices: _MeshMatrices
) -> tuple[Array, Array, Array]:
    """Returns (A, B, displacement_factors), the fields of the `PencilMatrices` of an arm. F: follower force.
    coefficients: `LocalCoefficients` at the Gauss points, then at the nodes, of each element, (6, elements, 2
    order + 1)."""
    elements, order = matrices.weights_times_half_length.shape
    nodes = elements * order
    push = np.zeros(nodes + 1)
    turn = np.zeros(nodes + 1)
    least = np.zeros(nodes + 1)
    for e in range(elements):
        for i in range(order + 1):
            mass = matrices.nodal_masses[e, i]
            push[e * order + i] += mass * coefficients[3, e, order + i]
            turn[e * order + i] += mass * coefficients[4, e, order + i]
            least[e * order + i] += mass * PENCIL_NORM_SETTINGS.min_angle_weight**2
    scale = np.empty(3 * nodes)
    B = np.zeros(3 * nodes)
    for k in range(nodes):
        # Without rotational drag theta has no mass, so the scale of theta needs a lower limit of the mass.
        angle = max(turn[k + 1], least[k + 1])
        scale[k] = 1 / math.sqrt(push[k + 1])
        scale[nodes + k] = 1 / math.sqrt(angle)
        weight = matrices.weights_times_half_length[k // order, k % order]
        scale[2 * nodes + k] = 1 / math.sqrt(weight * PENCIL_NORM_SETTINGS.shear_weight**2)
        B[k] = 1.0
        B[nodes + k] = turn[k + 1] / angle
    # The last element of A collects the entries of the clamp, which are not used.
    A = np.zeros(len(matrices.rows) + 1)
    _add_entries(F, coefficients, matrices, A)
    for k in range(len(matrices.rows)):
        A[k] *= scale[matrices.rows[k]] * scale[matrices.columns[k]]
    return A[:-1].copy(), B, scale[: 2 * nodes].copy().reshape(2, nodes)


@compiled
def _add_entries(F: float, coefficients: Array, matrices: _MeshMatrices, A: Array) -> None:
    """Adds the entries of all element blocks, in the order of `pattern_indices`, to A. F: follower force.
    coefficients: coefficients of the arm, (6, elements, 2 order + 1). A: entries of the sparsity pattern,
    then one entry for all entries of the clamp, (nnz + 1,)."""
    elements, order = matrices.weights_times_half_length.shape
    value = matrices.interpolation_to_gauss_points
    positions = matrices.pattern_indices
    position = _add_block(matrices.arm_independent_entries, 0, positions, A)
    for e in range(elements):
        position = _add_block(
            _bending_block(
                matrices.derivatives_at_gauss_points,
                matrices.weights_over_half_length[e] / coefficients[2, e, :order],
            ),
            position,
            positions,
            A,
        )
    for _ in range(elements):
        position = _add_block(F * matrices.derivative_value_integrals, position, positions, A)
    for e in range(elements):
        position = _add_block(
            value.T * (matrices.weights_times_half_length[e] * coefficients[5, e, :order]),
            position,
            positions,
            A,
        )
    for e in range(elements):
        rotated = matrices.weights_times_half_length[e] * coefficients[0, e, :order]
        position = _add_block(-rotated.reshape(-1, 1) * value, position, positions, A)
    for e in range(elements):
        position = _add_block(
            -matrices.weights_times_half_length[e] * coefficients[1, e, :order], position, positions, A
        )
    A[positions[position]] -= F  # the follower force at the tip, -F a(1) theta(1)


@compiled
def _bending_block(slope: Array, factors: Array) -> Array:
    """The block -slope^T diag(factors) slope, (p + 1, p + 1). slope: (p, p + 1). factors: values at the
    Gauss points, (p,)."""
    block = np.zeros((slope.shape[1], slope.shape[1]))
    for q in range(len(factors)):
        for i in range(len(block)):
            factor = factors[q] * slope[q, i]
            for j in range(len(block)):
                block[i, j] -= factor * slope[q, j]
    return block


@compiled
def _add_block(block: Array, position: int, positions: NDArray[np.int64], A: Array) -> int:
    """Adds the entries of `block`, (...,), to A, (nnz + 1,). Returns the index in `pattern_indices` of the
    entry after the block. position: index in `pattern_indices` of the first entry of the block."""
    for entry in block.flat:
        A[positions[position]] += entry
        position += 1
    return position
