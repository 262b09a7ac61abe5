"""Sparse matrices A and M of the mixed form about the straight rod (`mixed_form`).

About the straight rod longitudinal and transverse components are decoupled and have separate matrices.
Unknowns of different elements are coupled only at the nodes between elements.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array
from scipy.sparse.linalg import SuperLU, splu

from ...arrays import Array, Complex
from ...model.balance import Values
from ..elements.elements import ELEMENT_SETTINGS
from ..elements.mesh import Mesh
from ..state_layout import SE2_DIMENSION
from .mixed_form import MixedForm

LONGITUDINAL_COMPONENTS = (0,)
"""Indices of the components of stresses and velocities in se(2) that reflection in the rod's axis does not
change."""
TRANSVERSE_COMPONENTS = (1, 2)
"""Indices of the components of stresses and velocities in se(2) that change their sign under reflection in
the rod's axis."""


class _SparsityPattern(NamedTuple):
    """Sparsity pattern of A for some components on a mesh; it contains the full diagonal.
    weak_derivative_rows, weak_derivative_columns: node indices of the nonzero entries of the weak derivative
    matrix W D (weights times differentiation matrix), without the column of the tip, (m,). pattern_indices:
    index in the pattern of each value that `StraightMatrices.A` concatenates. indices, indptr: rows and
    column starts in scipy's order. diagonal_indices: indices in the pattern of the diagonal entries, (n,)."""

    weak_derivative_rows: NDArray[np.int_]
    weak_derivative_columns: NDArray[np.int_]
    pattern_indices: NDArray[np.int_]
    indices: NDArray[np.int32]
    indptr: NDArray[np.int32]
    diagonal_indices: NDArray[np.int_]


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _sparsity_pattern(mesh: Mesh, component_count: int) -> _SparsityPattern:
    """Sparsity pattern of the matrix A on a mesh. component_count: number of components of stresses and
    velocities that the matrix contains."""
    N = mesh.node_count
    s = np.arange(component_count * N).reshape(-1, N)
    v = s.size + np.arange(component_count * (N + 1)).reshape(-1, N + 1)
    size = s.size + v.size
    i, j = np.nonzero(mesh.node_matrices.weak_derivative_matrix.T[:, :N])
    entries = (
        (s[:, j], v[:, i]),
        (v[:, i], s[:, j]),
        (v, v),
        (s, s),
        (s[:, None], v[:, :N]),
        (v[:, None, :N], s),
    )
    keys = np.concatenate([(columns * size + rows).ravel() for rows, columns in entries])
    pattern, positions = np.unique(keys, return_inverse=True)
    columns, indices = np.divmod(pattern, size)
    indptr = np.searchsorted(columns, np.arange(size + 1)).astype(np.int32)
    diagonal = np.flatnonzero(columns == indices)
    return _SparsityPattern(i, j, positions, indices.astype(np.int32), indptr, diagonal)


@dataclass(frozen=True, eq=False)
class StraightMatrices:
    """A and M of a `MixedForm` about its straight rod, restricted to some components of stresses and
    velocities. components: indices of these components. Vectors are states of the form, (unknowns,); all
    other components are ignored, and are 0 in results."""

    form: MixedForm
    components: tuple[int, ...]

    @cached_property
    def component_indices_in_state(self) -> NDArray[np.int_]:
        """Indices in a state of the unknowns of `components`, (n,)."""
        mask = np.zeros((SE2_DIMENSION, self.form.mesh.node_count + 1))
        mask[list(self.components)] = 1
        return np.flatnonzero(self.form.layout.state(mask, mask))

    @property
    def _sparsity_pattern(self) -> _SparsityPattern:
        return _sparsity_pattern(self.form.mesh, len(self.components))

    @cached_property
    def A(self) -> csc_array:
        """The part of the matrix A, (n, n), whose rows and columns belong to the n unknowns of
        `components`."""
        form = self.form
        own = list(self.components)
        pattern = self._sparsity_pattern
        WD = -form.mesh.node_matrices.weak_derivative_matrix.T[
            pattern.weak_derivative_rows, pattern.weak_derivative_columns
        ]
        strain_rates, forces = (terms[np.ix_(own, own)] for terms in form.A_terms_without_derivative)
        values = (
            np.tile(-WD, len(own)),
            WD * form.law_derivatives.law_tangent[own][:, pattern.weak_derivative_columns],
            -(form.nodal_rod.drag * form.mesh.quadrature_weights)[own],
            np.zeros(len(own) * form.mesh.node_count),
            strain_rates,
            forces,
        )
        entries = np.bincount(pattern.pattern_indices, np.concatenate([part.ravel() for part in values]))
        return csc_array(
            (entries, pattern.indices, pattern.indptr), shape=2 * (len(pattern.diagonal_indices),)
        )

    @cached_property
    def M(self) -> Array:
        """Diagonal of M for the unknowns of `components`, (n,)."""
        return self.form.M[self.component_indices_in_state]

    def times_A(self, x: Values) -> Values:
        """Product A x, (unknowns,)."""
        return self._state_with_component_values(self.A @ x[self.component_indices_in_state])

    def times_M(self, x: Values) -> Values:
        """Product M x, (unknowns,)."""
        return self._state_with_component_values(self.M * x[self.component_indices_in_state])

    def A_product_magnitude(self, p: Values, q: Values) -> float:
        """The number |p| |A| |q|, with the modulus of every entry. The rounding error of p A q is about
        machine epsilon times this number. p, q: (unknowns,)."""
        return float(
            np.abs(p[self.component_indices_in_state])
            @ (abs(self.A) @ np.abs(q[self.component_indices_in_state]))
        )

    def lu_factors(self, shift: complex) -> "StraightFactors":
        """LU factorisation of A - shift M."""
        pattern = self._sparsity_pattern
        values = self.A.data.astype(complex)
        values[pattern.diagonal_indices] -= shift * self.M
        K = csc_array((values, pattern.indices, pattern.indptr), shape=self.A.shape)
        return StraightFactors(self, splu(K))

    def _state_with_component_values(self, values: Values) -> Values:
        """A state, (unknowns,), with `values`, (n,), in the unknowns of `components`, 0 in all others."""
        x = np.zeros(self.form.unknown_count, values.dtype)
        x[self.component_indices_in_state] = values
        return x


@dataclass(frozen=True, eq=False)
class StraightFactors:
    """LU factorisation of the matrix K = A - shift M. lu: factorisation of the part of K, (n, n), whose rows
    and columns belong to the n unknowns of `matrices.components`."""

    matrices: StraightMatrices
    lu: SuperLU

    def solve(self, b: Values, adjoint: bool = False) -> Complex:
        """The solution x, (unknowns,), of K x = b or, if `adjoint`, of K^H x = b; b: (unknowns,)."""
        matrices = self.matrices
        right_side = b[matrices.component_indices_in_state].astype(complex)
        return matrices._state_with_component_values(self.lu.solve(right_side, "H" if adjoint else "N"))
