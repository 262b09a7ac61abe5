"""The matrices of the mixed form about the straight uniform rod, element by element.

The equal elements of a uniform rod have equal matrices. A system with the matrix A - s M is solved by static
condensation: the interior nodes of the elements are eliminated, with one factorisation for all elements; then
a system for the unknowns at the ends of all elements is solved. The cost hardly grows with the number of
elements.

About the straight rod longitudinal and transverse components are decoupled and have separate matrices.

If the order p of elements is even, the interior block is singular or nearly singular: P_p - 1 vanishes at
both ends of an element, and its derivative vanishes at all interior nodes (P_p: Legendre polynomial). Several
elements therefore need an odd order.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Self

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import zgetrf, zgetrs

from ...arrays import Array, Complex
from ...model.balance import Values, ad, coad
from ..elements.basis import differentiation_matrix
from ..elements.elements import ELEMENT_SETTINGS
from ..elements.quadrature import gauss_lobatto_rule
from ..state_layout import SE2_DIMENSION
from .element_numbering import ElementNumbering, element_numbering
from .mixed_form import MixedForm

LONGITUDINAL_COMPONENTS = (0,)
"""Indices of the components of stresses and velocities in se(2) that reflection in the rod's axis keeps."""
TRANSVERSE_COMPONENTS = (1, 2)
"""Indices of the components of stresses and velocities in se(2) that change their sign under reflection in
the rod's axis."""


@dataclass(frozen=True, eq=False)
class StraightElements:
    """A and M of a `MixedForm` about its straight rod, restricted to some components, as matrices of one
    element. components: indices of these components of stresses and velocities. Vectors are states of the
    form, (unknowns,); all other components are ignored, and are 0 in results."""

    form: MixedForm
    components: tuple[int, ...]

    @cached_property
    def numbering(self) -> ElementNumbering:
        """Indices of the unknowns of every element. ValueError for several elements of an even order."""
        mesh = self.form.mesh
        if mesh.element_count > 1 and mesh.order % 2 == 0:
            raise ValueError(f"several elements need an odd order, not {mesh.order}")
        return element_numbering(mesh.element_count, mesh.order, self.components)

    @cached_property
    def A(self) -> Array:
        """Contribution of one element to the matrix A of the mixed form, (local, local)."""
        identity = np.eye(SE2_DIMENSION)
        block = np.ix_(self.components, self.components)
        coefficients = self.form.rod.balance_coefficients
        E = coefficients.rest_strain[:, None]
        Sigma = coefficients.tip_stress[:, None]
        WD, W = self._element_derivative_and_weights
        # Local unknowns: stresses at all nodes, then velocities; `half` components of each.
        component_count = len(self.components)
        nodes = np.arange(len(W))
        local_block = np.zeros((2 * component_count, 2 * component_count))
        local_block[:component_count, component_count:] = ad(E, identity)[block]
        local_block[component_count:, :component_count] = (
            coad(E, identity) + coad(np.diag(coefficients.compliance), Sigma)
        )[block]
        local_block[component_count:, component_count:] = -np.diag(coefficients.drag)[block]
        A = np.zeros((2 * component_count, len(W), 2 * component_count, len(W)))
        A[:, nodes, :, nodes] = W[:, None, None] * local_block
        for stress in range(component_count):
            A[stress, :, component_count + stress] -= WD.T
            A[component_count + stress, :, stress] += WD
        return A.reshape(2 * component_count * len(W), -1)

    @cached_property
    def M(self) -> Array:
        """Contribution of one element to the diagonal of the matrix M of the mixed form, (local,)."""
        stresses = np.outer(
            self.form.rod.balance_coefficients.compliance[list(self.components)],
            self._element_derivative_and_weights[1],
        )
        return np.concatenate([stresses, 0 * stresses]).ravel()

    @property
    def _element_derivative_and_weights(self) -> tuple[Array, Array]:
        """Returns (W D, W) of one element. W: quadrature weights, scaled to the length of the element,
        (nodes,). W D: diag(W) times the differentiation matrix D of the element, (nodes, nodes)."""
        WD, w = _reference_derivative_and_weights(self.form.mesh.order)
        return WD, w / (2 * self.form.mesh.element_count)

    def times_A(self, x: Values) -> Values:
        """Product A x, (unknowns,)."""
        return self.assemble(self.gather(x) @ self.A.T)

    def times_M(self, x: Values) -> Values:
        """Product M x, (unknowns,)."""
        return self.assemble(self.gather(x) * self.M)

    def A_product_magnitude(self, p: Values, q: Values) -> float:
        """The number |p| |A| |q|, with the modulus of every entry. The rounding error of p A q is about
        machine epsilon times this number. p, q: (unknowns,)."""
        return float(np.sum(np.abs(self.gather(p)) * (np.abs(self.gather(q)) @ np.abs(self.A).T)))

    def gather(self, x: Values) -> Values:
        """Entries of a vector x, (unknowns,), by element, (elements, local)."""
        return np.append(x, 0)[self.numbering.state_indices]

    def assemble(self, element_vectors: Values) -> Values:
        """Sum of element contributions, (elements, local), as a vector (unknowns,)."""
        # One more entry collects the stresses at the tip, which are not unknowns.
        x = np.zeros(self.form.unknown_count + 1, element_vectors.dtype)
        # Nodes between elements occur twice in the indices, where x[...] += would add only one of the two.
        np.add.at(x, self.numbering.state_indices, element_vectors)
        return x[:-1]

    def lu_factors(self, shift: complex) -> "ElementFactors":
        """LU factorisation of A - shift M by static condensation."""
        numbering = self.numbering
        K = self.A - np.diag(shift * self.M).astype(complex)
        schur_complement = K[np.ix_(numbering.interface_positions, numbering.interface_positions)]
        interior = None
        if numbering.interior_positions.size:
            interior = _InteriorElimination.from_matrix(K, numbering)
            schur_complement -= interior.K_ei @ interior.solved_K_ie
        is_unknown = numbering.is_unknown
        assembled = np.zeros((len(is_unknown), len(is_unknown)), complex)
        for element in numbering.interface_indices:
            assembled[np.ix_(element, element)] += schur_complement
        interface = lu_factorisation(assembled[np.ix_(is_unknown, is_unknown)])
        return ElementFactors(elements=self, K=K, interior=interior, interface=interface)


LU = tuple[Complex, NDArray[np.int32]]
"""LU factorisation by LAPACK: (factors, pivots)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class _InteriorElimination:
    """Elimination of the interior unknowns of an element with the matrix K. K_ie, K_ei: coupling of the
    interior unknowns (index i) and the unknowns at both ends (index e), (inside, ends) and (ends, inside).

    interior_factors: LU factorisation of K_ii. solved_K_ie: K_ii^-1 K_ie, (inside, ends).
    adjoint_solved_K_ei: K_ii^-H K_ei^H, (inside, ends).
    """

    interior_factors: LU
    K_ie: Complex
    K_ei: Complex
    solved_K_ie: Complex
    adjoint_solved_K_ei: Complex

    @classmethod
    def from_matrix(cls, K: Complex, numbering: ElementNumbering) -> Self:
        """The elimination of the interior unknowns from an element matrix K, (local, local)."""
        interior = numbering.interior_positions
        ends = numbering.interface_positions
        factors = lu_factorisation(K[np.ix_(interior, interior)])
        K_ie = K[np.ix_(interior, ends)]
        K_ei = K[np.ix_(ends, interior)]
        solved = solve_factorised(factors, K_ie)
        adjoint = solve_factorised(factors, K_ei.conj().T, adjoint=True)
        return cls(
            interior_factors=factors, K_ie=K_ie, K_ei=K_ei, solved_K_ie=solved, adjoint_solved_K_ei=adjoint
        )

    def coupling_matrices(self, adjoint: bool) -> tuple[Complex, Complex]:
        """Returns (K_ei, K_ii^-1 K_ie); if `adjoint`, the same two matrices of K^H."""
        return (self.K_ie.conj().T, self.adjoint_solved_K_ei) if adjoint else (self.K_ei, self.solved_K_ie)


@dataclass(frozen=True, eq=False, kw_only=True)
class ElementFactors:
    """Factorisation of A - shift M by static condensation. K: matrix of one element. interior: elimination of
    the interior unknowns of an element, None for a single element. interface: LU factorisation of the matrix
    of the end unknowns of all elements; for a single element, of all its unknowns."""

    elements: StraightElements
    K: Complex
    interior: _InteriorElimination | None
    interface: LU

    def solve(self, b: Values, adjoint: bool = False) -> Complex:
        """The solution x, (unknowns,), of (A - shift M) x = b or, if `adjoint`, of (A - shift M)^H x = b; b:
        (unknowns,). The elimination of the interior chooses no pivots at the ends of elements, so one step of
        iterative refinement follows."""
        elements = self.elements
        x = self._solve_unrefined(b, adjoint)
        if self.interior is None:
            return x
        # Vectors of elements are rows here, so that K x is x K^T, and K^H x is x conj(K).
        rows = self.K.conj() if adjoint else self.K.T
        return x + self._solve_unrefined(b - elements.assemble(elements.gather(x) @ rows), adjoint)

    def _solve_unrefined(self, b: Values, adjoint: bool) -> Complex:
        """The solution of `solve` without the step of iterative refinement, (unknowns,)."""
        numbering = self.elements.numbering
        elimination = self.interior
        is_unknown = numbering.is_unknown
        interior = numbering.state_indices[:, numbering.interior_positions]
        ends = numbering.state_indices[:, numbering.interface_positions]
        b = np.append(b, 0)
        x = np.zeros(len(b), complex)
        b_e = np.zeros(len(is_unknown), complex)
        x_e = np.zeros(len(is_unknown), complex)
        b_e[numbering.interface_indices] = b[ends]
        if elimination is not None:
            K_ei, solved_K_ie = elimination.coupling_matrices(adjoint)
            solved_b_i = solve_factorised(elimination.interior_factors, b[interior].T, adjoint).T
            # End nodes occur twice in the indices, where b_e[...] -= would subtract only one of the two.
            np.subtract.at(b_e, numbering.interface_indices, solved_b_i @ K_ei.T)
        x_e[is_unknown] = solve_factorised(self.interface, b_e[is_unknown], adjoint)
        x[ends] = x_e[numbering.interface_indices]
        if elimination is not None:
            # x_i = K_ii^-1 (b_i - K_ie x_e)
            x[interior] = solved_b_i - x_e[numbering.interface_indices] @ solved_K_ie.T
        return x[:-1]


def lu_factorisation(K: Complex) -> LU:
    """LU factorisation of K, (n, n), with partial pivoting. If K is singular, solutions are inf or nan."""
    factors, pivots, _ = zgetrf(K)
    return factors, pivots


def solve_factorised(factors: LU, right_side: Values, adjoint: bool = False) -> Complex:
    """The solution x of K x = right_side, or of K^H x = right_side if `adjoint`. factors: LU factorisation of
    K, (n, n). right_side: (n,) or (n, m)."""
    x, _ = zgetrs(*factors, right_side, trans=2 if adjoint else 0)
    return x


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _reference_derivative_and_weights(order: int) -> tuple[Array, Array]:
    """Returns (W D, W) on the element [-1, 1]. W: quadrature weights, (order + 1,). W D: diag(W) times the
    differentiation matrix, (order + 1, order + 1), which is the same for elements of every length."""
    x, w = gauss_lobatto_rule(order)
    return w[:, None] * differentiation_matrix(x), w
