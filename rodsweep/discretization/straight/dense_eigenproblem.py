"""The transverse eigenproblem of one rod on one mesh as dense matrices, and the fields of its eigenvectors.

The unknowns (y, theta, s) and their scales are defined in `pencil` and `arm_pencil`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...model.rod import Rod
from ..elements.basis import value_and_slope_at_gauss_points
from ..elements.elements import Elements
from ..elements.quadrature import gauss_legendre_rule
from .arm_pencil import ArmPencil
from .field_interpolation import value_and_slope_matrices
from .pencil import Pencil, displacements_of_eigenvectors, shear_force

AnyPencil = Pencil | ArmPencil
"""The pencil of a uniform rod of linear material, or of an arm."""


@dataclass(frozen=True, eq=False)
class DenseEigenproblem:
    """The transverse eigenproblem A x = w B x of one rod, with dense A and diagonal B. A: (unknowns,
    unknowns). B: diagonal, (unknowns,). displacement_factors: factors that convert the unknowns to y and
    theta at the nodes, clamp excluded, (2, nodes)."""

    rod: Rod
    mesh: Elements
    """The elements on which the eigenproblem is discretised."""
    A: Array
    B: Array
    displacement_factors: Array

    def displacements(self, vectors: Complex) -> tuple[NDArray, NDArray]:
        """Returns (y, theta) of k eigenvectors `vectors`, (unknowns, k), at all nodes, clamp included,
        (nodes + 1, k) each."""
        return displacements_of_eigenvectors(vectors, self.displacement_factors)

    def fields_at(self, X: Complex, Z: Complex, points: Array) -> Complex:
        """Six fields, (6, k, points), of k modes at `points`, (points,), in [0, 1].

        X, Z: right and left eigenvectors, (unknowns, k) each. The fields are Y and Theta of X, its strains h2
        = Y' - nu Theta and Pi = Theta', and Y+ and Theta+ of Z. h2 = c2 s is exactly 0 in an unshearable rod.
        At a jump of a coefficient both strains are limits from the right.
        """
        c2 = self.rod.local_coefficients(self.mesh.points_inside_elements(points)).c2
        value, slope = value_and_slope_matrices(self.mesh, points)
        y, theta = self.displacements(X)
        # The adjoint modes belong to the conjugate of the eigenvalue of Z, hence the conjugates.
        adjoint_y, adjoint_theta = self.displacements(Z.conj())
        columns = [
            value @ y,
            value @ theta,
            c2[:, None] * shear_force(self.mesh, X, points),
            slope @ theta,
            value @ adjoint_y,
            value @ adjoint_theta,
        ]
        return np.stack([field.T for field in columns])

    def relative_curvature_rounding(self, X: Complex, points: Array) -> Array:
        """Rms rounding error of Pi = Theta' at `points`, (points,), largest over the points and divided by
        the largest Pi, in units of the machine epsilon, (k,). X: right eigenvectors, (unknowns, k)."""
        _, slope = value_and_slope_matrices(self.mesh, points)
        _, theta = self.displacements(X)
        largest: Array = np.sqrt((slope**2 @ np.abs(theta) ** 2).max(axis=0))
        return largest / np.abs(slope @ theta).max(axis=0)

    @property
    def bending_factor(self) -> Array:
        """Matrix G, (nodes, nodes), from the unknowns theta to bending strains at the Gauss points, each in
        units in which -G^T G is the block of A for theta."""
        order = self.mesh.order
        points, weights = gauss_legendre_rule(order)
        _, slope = value_and_slope_at_gauss_points(order, order)
        lengths = self.mesh.lengths
        u: Array = np.array(self.mesh.edges)[:-1, None] + lengths[:, None] * (points + 1) / 2
        roots = np.sqrt(weights * (2 / lengths[:, None]) / self.rod.local_coefficients(u).c3)
        G = np.zeros((self.mesh.node_count, self.mesh.node_count + 1))
        for e, root in enumerate(roots):
            G[e * order : (e + 1) * order, self.mesh.node_ranges[e]] = root[:, None] * slope
        # Column 0 is the clamp.
        factor: Array = G[:, 1:] * self.displacement_factors[1]
        return factor

    def A_with_tip_terms(self, p: float, r: float) -> Array:
        """A plus the matrix of the tip term p (a theta - b y) - r a y at u = 1, (unknowns, unknowns). p, r:
        results of `hermitian_tip_coefficients`. a, b: test functions of y and theta."""
        A = self.A.copy()
        n = self.mesh.node_count
        y, theta = self.displacement_factors[:, -1]
        A[n - 1, 2 * n - 1] += p * y * theta
        A[2 * n - 1, n - 1] -= p * y * theta
        A[n - 1, n - 1] -= r * y * y
        return A


def dense_eigenproblem(rod: Rod, pencil: AnyPencil) -> DenseEigenproblem:
    """The dense eigenproblem of the rod `rod` on the mesh of `pencil`."""
    matrices = pencil.matrices(rod)
    A = np.zeros((pencil.unknown_count, pencil.unknown_count))
    A[pencil.rows, pencil.columns] = matrices.A
    return DenseEigenproblem(
        rod,
        pencil if isinstance(pencil, Pencil) else pencil.mesh,
        A,
        matrices.B,
        matrices.displacement_factors,
    )
