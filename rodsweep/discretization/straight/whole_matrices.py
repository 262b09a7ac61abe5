"""Dense matrices of the mixed form about a straight arm, whose elements differ from each other.

The interface is that of `rodsweep.discretization.straight.elements`, which uses the equal elements of a
uniform rod.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...model.balance import Values
from ..state_layout import PLANE_COMPONENTS
from .elements import LU, StraightElements, lu_factorisation, solve_factorised
from .mixed_form import MixedForm


@dataclass(frozen=True, eq=False)
class WholeMatrices:
    """A and M of a `MixedForm` about its straight arm, for the given components of stresses and velocities.

    Vectors are states of the form, (unknowns,); other components are ignored, and 0 in results.
    """

    form: MixedForm
    components: tuple[int, ...]

    @cached_property
    def state_indices(self) -> NDArray[np.int_]:
        """Indices in a state of the unknowns of the given components, (n,)."""
        size = self.form.mesh.nodes + 1
        marks = np.isin(np.arange(PLANE_COMPONENTS), self.components)[:, None] * np.ones(size)
        return np.flatnonzero(self.form.layout.state(marks, marks))

    @cached_property
    def A(self) -> Array:
        """Rows and columns of A that belong to the given components, (n, n)."""
        return self.form.A[np.ix_(self.state_indices, self.state_indices)]

    @cached_property
    def M(self) -> Array:
        """Diagonal of M for the given components, (n,)."""
        return self.form.M[self.state_indices]

    def apply_A(self, x: Values) -> Values:
        """Product A x, (unknowns,)."""
        return self._scatter(self.A @ x[self.state_indices])

    def times_M(self, x: Values) -> Values:
        """Product M x, (unknowns,)."""
        return self._scatter(self.M * x[self.state_indices])

    def size_of_product(self, p: Values, q: Values) -> float:
        """|p| |A| |q|, with the moduli of all entries: p A q has a rounding error relative to this number."""
        return float(np.abs(p[self.state_indices]) @ (np.abs(self.A) @ np.abs(q[self.state_indices])))

    def factors(self, shift: complex) -> "WholeFactors":
        """LU factorisation of A - shift M."""
        return WholeFactors(self, lu_factorisation(self.A - np.diag(shift * self.M).astype(complex)))

    def _scatter(self, values: Values) -> Values:
        """A state, (unknowns,), with `values`, (n,), in the given components and 0 in all others."""
        x = np.zeros(self.form.unknowns, values.dtype)
        x[self.state_indices] = values
        return x


@dataclass(frozen=True, eq=False)
class WholeFactors:
    """LU factorisation of the dense matrix K = A - shift M."""

    matrices: WholeMatrices
    factors: LU

    def solve(self, b: Values, adjoint: bool = False) -> Complex:
        """The solution x of K x = b, or of K^H x = b if `adjoint`; both (unknowns,)."""
        matrices = self.matrices
        x: Complex = matrices._scatter(solve_factorised(self.factors, b[matrices.state_indices], adjoint))
        return x


def straight_matrices(form: MixedForm, components: tuple[int, ...]) -> StraightElements | WholeMatrices:
    """A and M of a form about its straight rod, for the given components of stresses and velocities."""
    return (StraightElements if form.rod.standard else WholeMatrices)(form, components)
