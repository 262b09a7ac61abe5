"""Krylov-Schur for nonuniform arms, on elements that end at jumps of a coefficient."""

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex
from ...discretization.straight.arm_pencil import ArmPencil
from ...discretization.straight.arm_resolution import ArmMesh
from ...discretization.straight.pencil import Matrices, fields_of, finite_eigenvalues
from ...model.rod import Rod
from ..backend.kept import LruPool
from .shift_invert import KRYLOV, ShiftInvertSolver, SolverContents


class ArmSolver(ShiftInvertSolver):
    """Krylov-Schur for the arms on one mesh."""

    matrices: Matrices
    """Matrices of the last solved arm."""

    def __init__(self, mesh: ArmMesh):
        self.pencil = ArmPencil(mesh)
        n = self.pencil.unknowns
        super().__init__(self.pencil, np.full(self.pencil.nodes, 1 / self.pencil.nodes))
        self._places: NDArray[np.int64] = self.pencil.columns.astype(np.int64) * n + self.pencil.rows

    def load(self, rod: Rod, shift: float) -> SolverContents:
        self.matrices = found = self.pencil.matrices(rod)
        if not np.isfinite(found.A.sum() + found.B.sum() + shift):
            raise FloatingPointError(
                "with these parameters matrix entries exceed the largest floating-point number"
            )
        self.B.setValuesCSR(self.line, self.line[:-1], found.B)
        self.B.assemble()
        values = found.A.copy()
        values[self.diagonal] -= shift * found.B
        if self.dense:
            flat = self.A.getDenseArray().T.reshape(-1)  # stored by columns
            flat[:] = 0.0
            flat[self._places] = values
        else:
            self.A.setValuesCSR(self.indptr, self.indices, values)
        return SolverContents(finite_eigenvalues(rod, self.nodes), shift)

    def fields(self, vectors: Complex, rod: Rod) -> tuple[Complex, Complex]:
        """(y, theta) at all nodes, (nodes + 1, k) each, from vectors of the last solve, (unknowns, k)."""
        return fields_of(vectors, self.matrices.scale)


_kept = LruPool(ArmSolver, KRYLOV.arm_solvers_kept)


def arm_solver(mesh: ArmMesh) -> ArmSolver:
    """The solver for a mesh; kept for later points."""
    return _kept.get(mesh)
