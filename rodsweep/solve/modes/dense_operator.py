"""The operator L of one rod on one mesh as whole arrays, for dense linear algebra.

In the coordinates in which the Gamma norm is Euclidean the inverse of L is G = B^1/2 A^-1 B^1/2. It exists
in every limit; infinite eigenvalues of the pencil are its zeros. For gamma3 = 0 the state is y
alone, and so is the norm: theta follows at once.
"""

import numpy as np

from ...arrays import Array
from ...discretization.pencil import Pencil
from ...model.rod import Rod


def dense_operator(rod: Rod, pencil: Pencil) -> tuple[Array, Array]:
    """(A, diagonal of B) of the rod as whole arrays, shapes (unknowns, unknowns) and (unknowns,)."""
    A = np.zeros((pencil.unknowns, pencil.unknowns))
    A[pencil.rows, pencil.columns] = pencil.stiffness(rod)
    return A, pencil.inertia(rod)


def shifted_inverse(A: Array, B: Array, shift: float) -> Array:
    """B^1/2 (A - shift B)^-1 B^1/2 on the n unknowns that carry a time derivative, shape (n, n)."""
    moving = B > 0
    root = np.sqrt(B[moving])
    inverse = np.linalg.inv(A - np.diag(shift * B))[np.ix_(moving, moving)]
    return root[:, None] * inverse * root
