"""Linear systems whose matrices differ only in the last row, the border."""

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs

from ....arrays import Array


class LinearSystemWithBorderRow:
    """Solver for linear systems of M equations that differ only in the last row of the matrix, the border.
    matrix: (M, M); the last row is replaced by the border of each system. Successive systems mostly have
    equal borders, so the factors of the last system are kept."""

    def __init__(self, matrix: Array) -> None:
        self._matrix = matrix
        self._border: Array = np.empty(0)

    def solve(self, border: Array, right_side: Array) -> Array:
        """Solution, (M,), with the last row `border`, (M,), and the right-hand side `right_side`, (M,);
        raises LinAlgError if the matrix is singular."""
        if not np.array_equal(border, self._border):
            matrix = self._matrix.copy()
            matrix[-1] = border
            self._factors, self._pivots, info = dgetrf(matrix)
            if info > 0:
                raise np.linalg.LinAlgError("the matrix is singular")
            self._border = border
        solution: Array = dgetrs(self._factors, self._pivots, right_side)[0]
        return solution
