"""The matrices of the mixed form about the straight rod, element by element.

The equal elements of a uniform rod have the same matrices. A system with A - s M is solved by eliminating the
nodes inside the elements, with one factorisation for all of them, and then a system for the nodes between
them: what it costs hardly grows with the number of elements.

About the straight rod stretch and what is across it do not meet: each set of components stands alone.

On an element of even order p the inside alone is singular, or nearly so: P_p - 1 vanishes at both ends, and
its derivative at all nodes between them. Several elements ask for an odd order.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import zgetrf, zgetrs

from ...arrays import Array, Complex
from ...model.balance import Values, ad, coad
from ..elements.basis import differentiation
from ..elements.quadrature import gauss_lobatto
from ..state_layout import COMPONENTS
from .mixed_form import MixedForm

LONGITUDINAL, TRANSVERSE = (0,), (1, 2)
"""Components of se(2), of stresses and of velocities, that the reflection in the rod keeps or turns."""

Indices = NDArray[np.int_]


@dataclass(frozen=True, eq=False)
class _Numbering:
    """Where the unknowns of the elements stand; `local` unknowns of an element, `ends` of them at its ends.

    unknowns: (elements, local), into the unknowns of the form and one more, for the stresses of the tip,
    which are none; inside, ends: local numbers, the left end first; between: (elements, ends), into all
    unknowns between elements; asked: which of these there are, (all,).
    """

    unknowns: Indices
    inside: Indices
    ends: Indices
    between: Indices
    asked: NDArray[np.bool_]


@lru_cache(maxsize=64)
def _numbering(elements: int, order: int, components: tuple[int, ...]) -> _Numbering:
    last = elements * order
    nodes = np.arange(elements)[:, None] * order + np.arange(order + 1)
    unknown = COMPONENTS * (2 * last + 1)
    stresses = [np.where(nodes == last, unknown, c * last + nodes) for c in components]
    velocities = [COMPONENTS * last + c * (last + 1) + nodes for c in components]
    width = 2 * len(components)
    node = np.tile(np.arange(order + 1), width)
    inside = np.flatnonzero((node > 0) & (node < order)) if elements > 1 else np.array([], int)
    ends = np.setdiff1d(np.arange(len(node)), inside)
    ends = ends[np.argsort(node[ends], kind="stable")]
    between = np.arange(elements)[:, None] * width + np.arange(len(ends))
    unknowns = np.concatenate([*stresses, *velocities], axis=1)
    asked = np.ones(between[-1, -1] + 1, bool)
    asked[between[-1]] = unknowns[-1, ends] < unknown
    return _Numbering(unknowns, inside, ends, between, asked)


@dataclass(frozen=True, eq=False)
class StraightElements:
    """A and M of a form about its straight rod, of some components alone, element by element.

    Vectors have the shape (unknowns,) of the form; what they have in other components does not count.
    """

    form: MixedForm
    components: tuple[int, ...]

    @cached_property
    def numbering(self) -> _Numbering:
        """Raises ValueError for several elements of an even order."""
        mesh = self.form.mesh
        if mesh.elements > 1 and mesh.order % 2 == 0:
            raise ValueError(f"several elements need an odd order, not {mesh.order}")
        return _numbering(mesh.elements, mesh.order, self.components)

    @cached_property
    def A(self) -> Array:
        """What an element has of A, shape (local, local)."""
        form, each, some = self.form, np.eye(COMPONENTS), np.ix_(self.components, self.components)
        material = form.rod.material
        E, Sigma = material.rest[:, None], material.tip_stress[:, None]
        WD, W = self._reference
        half, nodes = len(self.components), np.arange(len(W))
        at_nodes = np.zeros((2 * half, 2 * half))
        at_nodes[:half, half:] = ad(E, each)[some]
        at_nodes[half:, :half] = (coad(E, each) + coad(np.diag(material.compliance), Sigma))[some]
        at_nodes[half:, half:] = -np.diag(material.drag)[some]
        A = np.zeros((2 * half, len(W), 2 * half, len(W)))
        A[:, nodes, :, nodes] = W[:, None, None] * at_nodes
        for stress in range(half):
            A[stress, :, half + stress] -= WD.T
            A[half + stress, :, stress] += WD
        return A.reshape(2 * half * len(W), -1)

    @cached_property
    def M(self) -> Array:
        """What an element has of the diagonal of M, shape (local,)."""
        stresses = np.outer(self.form.rod.material.compliance[list(self.components)], self._reference[1])
        return np.concatenate([stresses, 0 * stresses]).ravel()

    @property
    def _reference(self) -> tuple[Array, Array]:
        """(W D, W) of an element, shapes (nodes, nodes) and (nodes,)."""
        WD, w = _weighted_derivative(self.form.mesh.order)
        return WD, w / (2 * self.form.mesh.elements)

    def times_A(self, x: Values) -> Values:
        """A x."""
        return self.assembled(self.gathered(x) @ self.A.T)

    def times_M(self, x: Values) -> Values:
        """M x."""
        return self.assembled(self.gathered(x) * self.M)

    def size_of_product(self, p: Values, q: Values) -> float:
        """|p| |A| |q|: what rounding in p A q is a part of."""
        return float(np.sum(np.abs(self.gathered(p)) * (np.abs(self.gathered(q)) @ np.abs(self.A).T)))

    def gathered(self, x: Values) -> Values:
        """What the elements have of a vector, shape (elements, local)."""
        return np.append(x, 0)[self.numbering.unknowns]

    def assembled(self, parts: Values) -> Values:
        """The vector to which the elements contribute (elements, local)."""
        x = np.zeros(self.form.unknowns + 1, parts.dtype)
        np.add.at(x, self.numbering.unknowns, parts)
        return x[:-1]

    def factors(self, shift: complex) -> "ElementFactors":
        """A - shift M, factorised."""
        numbering, K = self.numbering, self.A - np.diag(shift * self.M).astype(complex)
        ends, asked = numbering.ends, numbering.asked
        inside, condensed = None, K[np.ix_(ends, ends)]
        if numbering.inside.size:
            inside = _Inside.of(K, numbering)
            condensed -= inside.entering @ inside.right
        whole = np.zeros((len(asked), len(asked)), complex)
        for here in numbering.between:
            whole[np.ix_(here, here)] += condensed
        return ElementFactors(
            elements=self, K=K, inside=inside, between=factorised(whole[np.ix_(asked, asked)])
        )


LU = tuple[Complex, NDArray[np.int32]]


@dataclass(frozen=True, eq=False, kw_only=True)
class _Inside:
    """The nodes inside an element eliminated: K_ii factorised, K_ie, K_ei, K_ii^-1 K_ie, K_ii^-H K_ei^H.

    Of the shapes (inside, ends), (ends, inside), (inside, ends), (inside, ends).
    """

    factors: LU
    leaving: Complex
    entering: Complex
    right: Complex
    left: Complex

    @classmethod
    def of(cls, K: Complex, numbering: _Numbering) -> Self:
        """Elimination of the interior of an element from its matrix K, (local, local)."""
        inside, ends = numbering.inside, numbering.ends
        factors = factorised(K[np.ix_(inside, inside)])
        leaving, entering = K[np.ix_(inside, ends)], K[np.ix_(ends, inside)]
        right, left = solved_with(factors, leaving), solved_with(factors, entering.conj().T, adjoint=True)
        return cls(factors=factors, leaving=leaving, entering=entering, right=right, left=left)

    def passed(self, adjoint: bool) -> tuple[Complex, Complex]:
        """What passes on what lies inside to the ends, and back: K_ei, K_ii^-1 K_ie, or of K^H."""
        return (self.leaving.conj().T, self.left) if adjoint else (self.entering, self.right)


@dataclass(frozen=True, eq=False, kw_only=True)
class ElementFactors:
    """K = A - shift M, factorised: inside the elements if there are several, and between them."""

    elements: StraightElements
    K: Complex
    inside: _Inside | None
    between: LU

    def solve(self, b: Values, adjoint: bool = False) -> Complex:
        """x of K x = b, or of K^H x = b, (unknowns,).

        With a step of iterative refinement where what lies inside was eliminated without pivots from between.
        """
        x, elements = self._eliminated(b, adjoint), self.elements
        if self.inside is None:
            return x
        rows = self.K.conj() if adjoint else self.K.T
        return x + self._eliminated(b - elements.assembled(elements.gathered(x) @ rows), adjoint)

    def _eliminated(self, b: Values, adjoint: bool) -> Complex:
        numbering, inside = self.elements.numbering, self.inside
        within, ends = (numbering.unknowns[:, part] for part in (numbering.inside, numbering.ends))
        right, between = np.zeros((2, len(numbering.asked)), complex)
        b, x = np.append(b, 0), np.zeros(len(b) + 1, complex)
        right[numbering.between] = b[ends]
        if inside is not None:
            to_ends, from_ends = inside.passed(adjoint)
            alone = solved_with(inside.factors, b[within].T, adjoint).T
            np.subtract.at(right, numbering.between, alone @ to_ends.T)
        between[numbering.asked] = solved_with(self.between, right[numbering.asked], adjoint)
        x[ends] = between[numbering.between]
        if inside is not None:
            x[within] = alone - between[numbering.between] @ from_ends.T
        return x[:-1]


def factorised(K: Complex) -> LU:
    """LU with partial pivoting of K, (n, n); a singular matrix gives infinite or nan numbers."""
    factors, pivots, _ = zgetrf(K)
    return factors, pivots


def solved_with(factors: LU, right: Values, adjoint: bool = False) -> Complex:
    """x of K x = right, or of K^H x = right, with right sides (n,) or (n, m)."""
    x, _ = zgetrs(*factors, right, trans=2 if adjoint else 0)
    return x


@lru_cache(maxsize=64)
def _weighted_derivative(order: int) -> tuple[Array, Array]:
    """(W D, W) on [-1, 1]: the lengths of elements cancel in W D."""
    x, w = gauss_lobatto(order)
    return w[:, None] * differentiation(x), w
