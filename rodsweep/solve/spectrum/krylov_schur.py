"""Krylov-Schur solver for uniform rods on equal elements, with matrices affine in the coefficients."""

import math

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...discretization.elements.resolution import Resolution
from ...discretization.straight.pencil import (
    Pencil,
    assemble_pencil,
    displacements_of_eigenvectors,
    finite_eigenvalue_count,
)
from ...model.compiled.compilation import compiled
from ...model.rod import Rod
from ..backend.solver_pools import LruPool
from .shift_invert import KRYLOV_SETTINGS, CurrentPencil, ShiftInvertSolver


@compiled
def _write_shifted_matrix(A: NDArray, coefficients: NDArray, terms: NDArray, shift: NDArray) -> None:
    """Writes the matrix sum_i coefficients[i] terms[i] - diag(shift) into `A`, (n, n), which is PETSc's array
    transposed. coefficients: (m,). terms: matrices stored by columns, (m, n^2). shift: (n,)."""
    entries = A.reshape(-1)
    entries[:] = 0.0
    for i in range(len(coefficients)):
        for j in range(len(entries)):
            entries[j] += coefficients[i] * terms[i, j]
    for j in range(len(shift)):
        A[j, j] -= shift[j]


class UniformSolver(ShiftInvertSolver):
    """Krylov-Schur solver for all uniform rods on one mesh of equal elements."""

    def __init__(self, resolution: Resolution):
        self.pencil: Pencil = assemble_pencil(resolution.element_count, resolution.order)
        super().__init__(self.pencil, self.pencil.nodal_masses)
        if self.is_dense:
            self.dense_constant_matrices = self.pencil.dense_constant_matrices()
        # No rod has this drag, so the first load writes B.
        self.loaded_gamma3 = -1.0
        self.mass_diagonal: Array = np.ones(self.pencil.unknown_count)

    def load_matrices(self, rod: Rod, shift: float) -> CurrentPencil:
        rod, deflection_ratio = _equivalent_filament_and_deflection_ratio(rod)
        # The filament's eigenvalues are those of the rod times this factor, and so is the shift.
        shift *= deflection_ratio**2
        coefficients = self.pencil.constant_matrix_factors(rod)
        if not math.isfinite(coefficients.sum() + shift):
            raise FloatingPointError(
                "with these parameters matrix entries exceed the largest floating-point number"
            )
        # B depends on this drag only, so most rods of a sweep keep it.
        if rod.base_rotational_drag != self.loaded_gamma3:
            self.loaded_gamma3 = rod.base_rotational_drag
            self.mass_diagonal = self.pencil.mass_diagonal(rod)
            self.B.setValuesCSR(self.row_starts, self.row_starts[:-1], self.mass_diagonal)
            self.B.assemble()
        if self.is_dense:
            # PETSc stores dense matrices by columns, so the array is written transposed.
            _write_shifted_matrix(
                self.A.getDenseArray().T,
                coefficients,
                self.dense_constant_matrices,
                shift * self.mass_diagonal,
            )
        else:
            values = coefficients @ self.pencil.constant_matrix_entries
            values[self.is_diagonal_entry] -= shift * self.mass_diagonal
            self.A.setValuesCSR(self.indptr, self.indices, values)
        return CurrentPencil(finite_eigenvalue_count(rod, self.node_count), shift, deflection_ratio)

    def displacements(self, vectors: Complex, rod: Rod) -> tuple[Complex, Complex]:
        """Returns (y, theta) at all nodes, (nodes + 1, k) each. vectors: eigenvectors of the last solve,
        (unknowns, k)."""
        return displacements_of_eigenvectors(vectors, self.pencil.displacement_factors(rod))


def _equivalent_filament_and_deflection_ratio(rod: Rod) -> tuple[Rod, float]:
    """Returns (equivalent rod, deflection_ratio). Eigenvalues of `rod` = eigenvalues of the equivalent rod /
    deflection_ratio^2; y of `rod` = y of the equivalent rod * deflection_ratio.

    A partial beam (k2 = inf, gamma3 = 0) is equivalent to the filament under the force F nu, with times
    scaled by nu^2. Near crushing the matrices of the partial beam are badly scaled. Another rod is returned
    unchanged, with the ratio 1.
    """
    if rod.c2 == 0 and rod.base_rotational_drag == 0 and rod.nu != 1:
        return Rod(F=rod.F * rod.nu, k1=math.inf, k2=math.inf, gamma3=0.0), rod.nu
    return rod, 1.0


uniform_solver = LruPool(UniformSolver, KRYLOV_SETTINGS.max_uniform_solvers).get
"""The Krylov-Schur solver for a mesh; the solver is stored and reused for later rods."""
