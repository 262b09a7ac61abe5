"""The matrices of the mixed form about a straight arm, whole: its elements differ from one another.

The interface is that of `rodsweep.discretization.straight.elements`, which eliminates the equal elements of a
uniform rod one by one.
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
    """A and M of a form about its straight arm, of some components of stresses and velocities alone.

    Vectors have the shape (unknowns,) of the form; other components are ignored, and 0 in results.
    """

    form: MixedForm
    components: tuple[int, ...]

    @cached_property
    def places(self) -> NDArray[np.int_]:
        """Indices of the unknowns of these components."""
        layout, size = self.form.layout, self.form.mesh.nodes + 1
        marks = np.isin(np.arange(COMPONENTS), self.components)[:, None] * np.ones(size)
        return np.flatnonzero(layout.state(marks, marks))

    @cached_property
    def A(self) -> Array:
        """A of these components, (places, places)."""
        return self.form.A[np.ix_(self.places, self.places)]

    @cached_property
    def M(self) -> Array:
        """The diagonal of M, (places,)."""
        return self.form.M[self.places]

    def times_A(self, x: Values) -> Values:
        """A x."""
        return self._spread(self.A @ x[self.places])

    def times_M(self, x: Values) -> Values:
        """M x."""
        return self._spread(self.M * x[self.places])

    def size_of_product(self, p: Values, q: Values) -> float:
        """|p| |A| |q|: what rounding in p A q is a part of."""
        return float(np.abs(p[self.places]) @ (np.abs(self.A) @ np.abs(q[self.places])))

    def factors(self, shift: complex) -> "WholeFactors":
        """A - shift M, factorised."""
        return WholeFactors(self, factorised(self.A - np.diag(shift * self.M).astype(complex)))

    def _spread(self, values: Values) -> Values:
        """A vector of the form with values, (places,), at these components."""
        x = np.zeros(self.form.unknowns, values.dtype)
        x[self.places] = values
        return x


@dataclass(frozen=True, eq=False)
class WholeFactors:
    """K = A - shift M, factorised."""

    matrices: WholeMatrices
    factors: LU

    def solve(self, b: Values, adjoint: bool = False) -> Complex:
        """x of K x = b, or of K^H x = b, (unknowns,)."""
        matrices = self.matrices
        x: Complex = matrices._spread(solved_with(self.factors, b[matrices.places], adjoint))
        return x


def straight_matrices(form: MixedForm, components: tuple[int, ...]) -> StraightElements | WholeMatrices:
    """A and M of a form about its straight rod, of some components."""
    return (StraightElements if form.rod.standard else WholeMatrices)(form, components)
