"""Sparse matrices of the mixed form about a straight arm whose elements differ from each other.

`WholeRodMatrices` has the same methods as `StraightElements` of `rodsweep.discretization.straight.elements`,
which uses the equal elements of a uniform rod.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import SuperLU, splu

from ...arrays import Array, Complex
from ...model.balance import Values
from ..state_layout import SE2_DIMENSION
from .elements import StraightElements
from .mixed_form import MixedForm


@dataclass(frozen=True, eq=False)
class WholeRodMatrices:
    """A and M of a `MixedForm` about its straight arm, restricted to some components of stresses and
    velocities. components: indices of these components. Vectors are states of the form, (unknowns,); all
    other components are ignored, and are 0 in results."""

    form: MixedForm
    components: tuple[int, ...]

    @cached_property
    def state_indices(self) -> NDArray[np.int_]:
        """Indices in a state of the unknowns of `components`, (n,)."""
        size = self.form.mesh.node_count + 1
        mask = np.isin(np.arange(SE2_DIMENSION), self.components)[:, None] * np.ones(size)
        return np.flatnonzero(self.form.layout.state(mask, mask))

    @cached_property
    def A(self) -> csc_array:
        """Rows and columns of the matrix A for the n unknowns of `components`, (n, n). Unknowns of different
        elements are coupled only at the nodes between elements."""
        return csc_array(self.form.A[np.ix_(self.state_indices, self.state_indices)])

    @cached_property
    def M(self) -> Array:
        """Diagonal of M for the unknowns of `components`, (n,)."""
        return self.form.M[self.state_indices]

    def times_A(self, x: Values) -> Values:
        """Product A x, (unknowns,)."""
        return self._scatter(self.A @ x[self.state_indices])

    def times_M(self, x: Values) -> Values:
        """Product M x, (unknowns,)."""
        return self._scatter(self.M * x[self.state_indices])

    def A_product_magnitude(self, p: Values, q: Values) -> float:
        """The number |p| |A| |q|, with the modulus of every entry. The rounding error of p A q is about
        machine epsilon times this number. p, q: (unknowns,)."""
        return float(np.abs(p[self.state_indices]) @ (abs(self.A) @ np.abs(q[self.state_indices])))

    def lu_factors(self, shift: complex) -> "WholeRodFactors":
        """LU factorisation of A - shift M."""
        return WholeRodFactors(self, splu(csc_array(self.A - diags_array(shift * self.M), dtype=complex)))

    def _scatter(self, values: Values) -> Values:
        """A state, (unknowns,), with `values`, (n,), in the unknowns of `components`, 0 in all others."""
        x = np.zeros(self.form.unknown_count, values.dtype)
        x[self.state_indices] = values
        return x


@dataclass(frozen=True, eq=False)
class WholeRodFactors:
    """LU factorisation of the sparse matrix K = A - shift M."""

    matrices: WholeRodMatrices
    factors: SuperLU

    def solve(self, b: Values, adjoint: bool = False) -> Complex:
        """The solution x, (unknowns,), of K x = b or, if `adjoint`, of K^H x = b; b: (unknowns,)."""
        matrices = self.matrices
        right_side = b[matrices.state_indices].astype(complex)
        x: Complex = matrices._scatter(self.factors.solve(right_side, trans="H" if adjoint else "N"))
        return x


def straight_matrices(form: MixedForm, components: tuple[int, ...]) -> StraightElements | WholeRodMatrices:
    """A and M of the form `form` about its straight rod. components: indices of the components of stresses
    and velocities to which A and M are restricted."""
    if form.rod.is_uniform_and_linear:
        return StraightElements(form, components)
    return WholeRodMatrices(form, components)
