"""Krylov-Schur for a uniform rod on equal elements, with matrices affine in the coefficients."""

import math

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...discretization.elements.resolution import Resolution
from ...discretization.straight.pencil import Pencil, assemble, fields_of, finite_eigenvalues
from ...model.compiled.compilation import compiled
from ...model.rod import Rod
from ..backend.kept import LruPool
from .shift_invert import KRYLOV, ShiftInvertSolver, SolverContents


@compiled
def _fill(A: NDArray, coefficients: NDArray, pieces: NDArray, shift: NDArray) -> None:
    """A = sum_i coefficients[i] pieces[i] - diag(shift), written into the transpose of PETSc's array of A."""
    flat = A.reshape(-1)
    flat[:] = 0.0
    for i in range(len(coefficients)):
        for j in range(len(flat)):
            flat[j] += coefficients[i] * pieces[i, j]
    for j in range(len(shift)):
        A[j, j] -= shift[j]


class EigenSolver(ShiftInvertSolver):
    """Krylov-Schur for one resolution."""

    def __init__(self, resolution: Resolution):
        self.pencil: Pencil = assemble(resolution.elements, resolution.order)
        super().__init__(self.pencil, self.pencil.mass)
        if self.dense:
            self.pieces = self.pencil.dense_pieces()
        self.gamma3 = -1.0
        self.inertia: Array = np.ones(self.pencil.unknowns)

    def load(self, rod: Rod, shift: float) -> SolverContents:
        rod, pace = _as_filament(rod)
        shift *= pace**2
        coefficients = self.pencil.coefficients(rod)
        if not math.isfinite(coefficients.sum() + shift):
            raise FloatingPointError(
                "with these parameters matrix entries exceed the largest floating-point number"
            )
        if rod.rotational_drag != self.gamma3:
            self.gamma3 = rod.rotational_drag
            self.inertia = self.pencil.inertia(rod)
            self.B.setValuesCSR(self.line, self.line[:-1], self.inertia)
            self.B.assemble()
        if self.dense:
            _fill(self.A.getDenseArray().T, coefficients, self.pieces, shift * self.inertia)
        else:
            values = coefficients @ self.pencil.pieces
            values[self.diagonal] -= shift * self.inertia
            self.A.setValuesCSR(self.indptr, self.indices, values)
        return SolverContents(finite_eigenvalues(rod, self.nodes), shift, pace)

    def fields(self, vectors: Complex, rod: Rod) -> tuple[Complex, Complex]:
        """(y, theta) at all nodes, (nodes + 1, k) each, from vectors of the last solve, (unknowns, k)."""
        return fields_of(vectors, self.pencil.scale(rod))


def _as_filament(rod: Rod) -> tuple[Rod, float]:
    """(equivalent rod, pace): the equivalent rod has the eigenvalues of `rod` times pace^2, and y of `rod`
    over pace.

    A partial beam (k2 = inf, gamma3 = 0) moves like the filament under the force F nu, with times scaled by
    nu^2. Near crushing the matrices of the beam itself are too badly scaled.
    """
    if rod.c2 == 0 and rod.rotational_drag == 0 and rod.nu != 1:
        return Rod(F=rod.F * rod.nu, k1=math.inf, k2=math.inf, gamma3=0.0), rod.nu
    return rod, 1.0


_kept = LruPool(EigenSolver, KRYLOV.uniform_solvers_kept)


def eigen_solver(resolution: Resolution) -> EigenSolver:
    """The solver for a resolution; kept for later points."""
    return _kept.get(resolution)
