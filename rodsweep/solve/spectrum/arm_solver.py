"""Krylov-Schur solver for nonuniform arms, on elements with boundaries at the jumps of every coefficient."""

from math import isfinite

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...discretization.straight.arm_pencil import ArmPencil
from ...discretization.straight.arm_resolution import ArmMesh
from ...discretization.straight.pencil import (
    PencilMatrices,
    displacements_of_eigenvectors,
    finite_eigenvalue_count,
)
from ...model.compiled.compilation import compiled
from ...model.rod import Rod
from ..backend.solver_pools import LruPool
from .shift_invert import KRYLOV_SETTINGS, CurrentPencil, ShiftInvertSolver


@compiled
def _sum_of_all_entries(A: Array, B: Array) -> float:
    """Sum of all entries of both arrays, (n,) and (m,)."""
    return float(A.sum() + B.sum())


@compiled
def _write_shifted_matrix(A: Array, values: Array, places: NDArray, shift: Array) -> None:
    """Writes `values`, (nnz,), minus diag(shift) into `A`, the transpose of PETSc's array, (n, n). places:
    index of each value in the entries of A, (nnz,). shift: (n,)."""
    entries = A.reshape(-1)
    entries[:] = 0.0
    for k in range(len(values)):
        entries[places[k]] = values[k]
    for i in range(len(shift)):
        A[i, i] -= shift[i]


class ArmSolver(ShiftInvertSolver):
    """Krylov-Schur solver for all nonuniform arms on one mesh."""

    matrices: PencilMatrices
    """Matrices of the arm that was solved last."""

    def __init__(self, mesh: ArmMesh):
        self.pencil = ArmPencil(mesh)
        n = self.pencil.unknown_count
        super().__init__(self.pencil, np.full(self.pencil.node_count, 1 / self.pencil.node_count))
        self._places: NDArray[np.int64] = self.pencil.columns.astype(np.int64) * n + self.pencil.rows

    def load_matrices(self, rod: Rod, shift: float) -> CurrentPencil:
        self.matrices = matrices = self.pencil.matrices(rod)
        # One sum tests all entries at once: inf or nan anywhere makes it non-finite.
        if not isfinite(_sum_of_all_entries(matrices.A, matrices.B) + shift):
            raise FloatingPointError(
                "with these parameters matrix entries exceed the largest floating-point number"
            )
        # B is diagonal, so the column of each entry is the number of its row.
        self.B.setValuesCSR(self.row_starts, self.row_starts[:-1], matrices.B)
        self.B.assemble()
        if self.is_dense:
            # PETSc stores dense matrices by columns.
            _write_shifted_matrix(self.A.getDenseArray().T, matrices.A, self._places, shift * matrices.B)
        else:
            values = matrices.A.copy()
            values[self.is_diagonal_entry] -= shift * matrices.B
            self.A.setValuesCSR(self.indptr, self.indices, values)
        return CurrentPencil(finite_eigenvalue_count(rod, self.node_count), shift)

    def displacements(self, vectors: Complex, rod: Rod) -> tuple[Complex, Complex]:
        """Returns (y, theta) at all nodes, (nodes + 1, k) each. vectors: eigenvectors of the arm that was
        solved last, (unknowns, k). rod: not needed, because the matrices are those of this arm."""
        return displacements_of_eigenvectors(vectors, self.matrices.displacement_factors)


arm_solver = LruPool(ArmSolver, KRYLOV_SETTINGS.max_arm_solvers).get
"""The Krylov-Schur solver for a mesh; the solver is stored and reused for later arms on this mesh."""
