"""The transverse problem of one rod on one mesh as dense matrices, and fields of eigenvectors.

Unknowns (y, theta, s) and scales are those of `pencil` and `arm_pencil`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...model.rod import Rod
from ..elements.elements import ELEMENTS, Elements
from .arm_pencil import ArmPencil
from .pencil import Pencil, derivatives_at, fields_of, shear_force

AnyPencil = Pencil | ArmPencil
"""The pencil of a uniform rod of linear material, or of any arm."""


@dataclass(frozen=True, eq=False)
class DenseForm:
    """The eigenproblem A x = w B x of one rod.

    A: (unknowns, unknowns). B: diagonal of B, (unknowns,). scale: factors from unknowns to y and theta at the
    nodes, (2, nodes).
    """

    rod: Rod
    mesh: Elements
    A: Array
    B: Array
    scale: Array

    def fields(self, vectors: Complex) -> tuple[NDArray, NDArray]:
        """(y, theta) at all nodes, clamp included, (nodes + 1, k), of k eigenvectors, (unknowns, k)."""
        return fields_of(vectors, self.scale)

    def strains(self, vectors: Complex, points: Array) -> Complex:
        """(h2, Pi) = (Y' - nu Theta, Theta') of k eigenvectors at points, (2, k, points).

        h2 = c2 s is exactly 0 in an unshearable rod. At a jump of a coefficient, both are right limits.
        """
        c2 = self.rod.local(_inside(self.mesh, points)).c2
        shear = c2[:, None] * shear_force(self.mesh, vectors, points)
        return np.stack([shear.T, derivatives_at(self.mesh, self.fields(vectors)[1], points).T])

    def with_tip_terms(self, pair: float, tip: float) -> Array:
        """A plus the tip term pair (a theta - b y) - tip a y, with test functions (a, b), at u = 1."""
        A = self.A.copy()
        n = self.mesh.nodes
        y, theta = self.scale[:, -1]
        A[n - 1, 2 * n - 1] += pair * y * theta
        A[2 * n - 1, n - 1] -= pair * y * theta
        A[n - 1, n - 1] -= tip * y * y
        return A


def dense_form(rod: Rod, pencil: AnyPencil) -> DenseForm:
    """The dense eigenproblem of a rod on the mesh of a pencil."""
    found = pencil.matrices(rod)
    A = np.zeros((pencil.unknowns, pencil.unknowns))
    A[pencil.rows, pencil.columns] = found.A
    return DenseForm(rod, pencil if isinstance(pencil, Pencil) else pencil.mesh, A, found.B, found.scale)


def _inside(mesh: Elements, points: Array) -> Array:
    """Points, (n,), moved from the ends of elements into the element of `Elements.by_element`."""
    moved = np.array(points, dtype=float)
    for first, inside, local in mesh.by_element(points):
        e = first // mesh.order
        place = mesh.edges[e] + mesh.lengths[e] * (local + 1) / 2
        moved[inside] = np.clip(place, mesh.edges[e] + ELEMENTS.inside, mesh.edges[e + 1] - ELEMENTS.inside)
    return moved
