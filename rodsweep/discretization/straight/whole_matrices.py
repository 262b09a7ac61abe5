"""Dense matrices of the mixed form about a straight arm, whose elements have different matrices.

The interface is that of `rodsweep.discretization.straight.elements`, which uses the equal elements of a
uniform rod.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...model.balance import Values
from ..state_layout import COMPONENTS
from .elements import LU, StraightElements, factorised, solved_with
from .mixed_form import MixedForm


@dataclass(frozen=True, eq=False)
class WholeMatrices:
    """A and M of a `MixedForm` about its straight arm, for some components of stresses and velocities.

    Vectors are states of the form, (unknowns,); other components are ignored, and 0 in results.
    """

    form: MixedForm
    components: tuple[int, ...]

    @cached_property
    def places(self) -> NDArray[np.int_]:
        """Indices in a state of the unknowns of these components, (places,)."""
        size = self.form.mesh.nodes + 1
        marks = np.isin(np.arange(COMPONENTS), self.components)[:, None] * np.ones(size)
        return np.flatnonzero(self.form.layout.state(marks, marks))

    @cached_property
    def A(self) -> Array:
        """The block of A of these components, (places, places)."""
        return self.form.A[np.ix_(self.places, self.places)]

    @cached_property
    def M(self) -> Array:
        """The diagonal of M, (places,)."""
        return self.form.M[self.places]

    def times_A(self, x: Values) -> Values:
        """A x, shape (unknowns,)."""
        return self._spread(self.A @ x[self.places])

    def times_M(self, x: Values) -> Values:
        """M x, shape (unknowns,)."""
        return self._spread(self.M * x[self.places])

    def size_of_product(self, p: Values, q: Values) -> float:
        """|p| |A| |q|, with moduli of all entries: the scale of the rounding error of p A q."""
        return float(np.abs(p[self.places]) @ (np.abs(self.A) @ np.abs(q[self.places])))

    def factors(self, shift: complex) -> "WholeFactors":
        """Factorisation of A - shift M."""
        return WholeFactors(self, factorised(self.A - np.diag(shift * self.M).astype(complex)))

    def _spread(self, values: Values) -> Values:
        """A state with the values, (places,), of these components; all other entries are 0."""
        x = np.zeros(self.form.unknowns, values.dtype)
        x[self.places] = values
        return x


@dataclass(frozen=True, eq=False)
class WholeFactors:
    """Factorisation of K = A - shift M."""

    matrices: WholeMatrices
    factors: LU

    def solve(self, b: Values, adjoint: bool = False) -> Complex:
        """The solution x of K x = b, or of K^H x = b; both (unknowns,)."""
        matrices = self.matrices
        x: Complex = matrices._spread(solved_with(self.factors, b[matrices.places], adjoint))
        return x


def straight_matrices(form: MixedForm, components: tuple[int, ...]) -> StraightElements | WholeMatrices:
    """A and M of a form about its straight rod, for some components of stresses and velocities."""
    return (StraightElements if form.rod.standard else WholeMatrices)(form, components)
