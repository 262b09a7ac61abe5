"""Eigenvalues of the pencil nearest a real shift: SLEPc's Krylov-Schur with shift-and-invert.

The objects are created once per resolution and reused with new values. The shift enters the values:
the pencil (A - shift B, B) is solved about 0, so that a diagonal B meets a dense A and nothing is
copied. B is singular; its null vectors belong to infinite eigenvalues, which shift-and-invert sends
to zero and never returns. The factorisation pivots: LAPACK's where the matrix is small or PETSc has
nothing else, otherwise a sparse one.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...discretization.elements.resolution import Resolution
from ...discretization.straight.pencil import Pencil, assemble
from ...model.compiled.compilation import compiled
from ...model.rod import Rod
from ...watch import report
from ..backend.kept import Kept
from ..backend.petsc import PETSc, SLEPc, sparse_package

DENSE_UP_TO = 300
"""Unknowns up to which the dense factorisation is no slower than a sparse one; it rounds less."""
START_TOLERANCE, START_SPARE = 1e-4, 5
"""Krylov tolerance, and Krylov vectors beyond the wanted eigenvalues, where these are refined on D."""
TIGHT_TOLERANCE, TIGHT_SPARE = 1e-14, 13
"""The same where nothing refines them, nor their vectors: the mesh is to be the only error."""
MOST_RESTARTS = 200
STEPS_OF_INFINITY = 2
"""Steps of shift-and-invert after which nothing of infinite eigenvalues is left: one, or two where k2 = inf.
All that a Krylov space has beyond these and the finite ones is rounding, in which LAPACK may fail (trexc)."""
START_WIDTH = 3.3
"""Width of the first Krylov vector in units of the distance of nodes: a displacement next to the tip, which
every mode moves, as smooth as the wanted modes are. It saves two steps of eleven."""
MOST_KEPT = 24
"""Solvers kept for the next point of an equal resolution: a sweep uses few, and one has some megabytes."""
SPECTRUM_PREFIX = "spectrum_"
"""Prefix of the PETSc options that override this solver, as in -spectrum_eps_ncv 32."""


@compiled
def _fill(A: NDArray, coefficients: NDArray, pieces: NDArray, shift: NDArray) -> None:
    """A = sum_i coefficients[i] pieces[i] - diag(shift) in the memory of A, whose transpose is given."""
    flat = A.reshape(-1)
    flat[:] = 0.0
    for i in range(len(coefficients)):
        for j in range(len(flat)):
            flat[j] += coefficients[i] * pieces[i, j]
    for j in range(len(shift)):
        A[j, j] -= shift[j]


class EigenSolver:
    """Krylov-Schur for one resolution; `solve` may be called any number of times."""

    def __init__(self, resolution: Resolution):
        self.pencil: Pencil = assemble(resolution.elements, resolution.order)
        n = self.pencil.unknowns
        package = sparse_package()
        self.dense = n <= DENSE_UP_TO or package is None
        self.diagonal = self.pencil.rows == self.pencil.columns
        self.indptr = np.searchsorted(self.pencil.rows, np.arange(n + 1)).astype(PETSc.IntType)
        self.indices = self.pencil.columns.astype(PETSc.IntType)
        self.A, self.B = PETSc.Mat(), PETSc.Mat()
        if self.dense:
            self.A.createDense([n, n], comm=PETSc.COMM_SELF).setUp()
            self.pieces = self.pencil.dense_pieces()
        else:
            values = np.ones(len(self.indices))
            self.A.createAIJ([n, n], csr=(self.indptr, self.indices, values), comm=PETSc.COMM_SELF)
        self.line = np.arange(n + 1, dtype=PETSc.IntType)
        self.B.createAIJ([n, n], csr=(self.line, self.line[:-1], np.ones(n)), comm=PETSc.COMM_SELF)
        self.gamma3, self.pace = -1.0, 1.0
        self.inertia: Array = np.ones(n)
        first = np.zeros(n)
        distance = (1 - self.pencil.positions[1:]) * self.pencil.nodes / START_WIDTH
        first[: self.pencil.nodes] = np.exp(-(distance**2)) * np.sqrt(self.pencil.mass)
        self.start = PETSc.Vec().createWithArray(first, comm=PETSc.COMM_SELF)
        self.users_krylov = PETSc.Options(SPECTRUM_PREFIX).getInt("eps_ncv", 0)
        self.users_tolerance = PETSc.Options(SPECTRUM_PREFIX).getReal("eps_tol", 0.0)
        self.eps = self._solver("petsc" if self.dense else package)

    def _solver(self, package: str | None) -> "SLEPc.EPS":
        eps = SLEPc.EPS().create(PETSc.COMM_SELF)
        eps.setOptionsPrefix(SPECTRUM_PREFIX)
        eps.setProblemType(SLEPc.EPS.ProblemType.GNHEP)
        eps.setType(SLEPc.EPS.Type.KRYLOVSCHUR)
        eps.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
        eps.setTarget(0.0)
        transform = eps.getST()
        transform.setType(SLEPc.ST.Type.SINVERT)
        transform.setMatMode(SLEPc.ST.MatMode.INPLACE)
        ksp = transform.getKSP()
        ksp.setType(PETSc.KSP.Type.PREONLY)
        ksp.getPC().setType(PETSc.PC.Type.LU)
        ksp.getPC().setFactorSolverType(package)
        eps.setFromOptions()
        return eps

    def solve(self, rod: Rod, shift: float, wanted: int, tight: bool = False) -> Complex:
        """At least `wanted` eigenvalues nearest the shift where they converge, unsorted; none is left out.

        Complex, shape (k,), in 1/tau2. tight: to the last digit of the mesh, not just to start from.
        Raises PETSc.Error where PETSc fails.
        """
        report()
        rod, self.pace = _as_filament(rod)
        shift *= self.pace**2
        coefficients = self.pencil.coefficients(rod)
        if not math.isfinite(coefficients.sum() + shift):
            raise FloatingPointError("the parameters overflow the matrix entries")
        if rod.rotational_drag != self.gamma3:
            self.gamma3, self.inertia = rod.rotational_drag, self.pencil.inertia(rod)
            self.B.setValuesCSR(self.line, self.line[:-1], self.inertia)
            self.B.assemble()
        if self.dense:
            _fill(self.A.getDenseArray().T, coefficients, self.pieces, shift * self.inertia)
        else:
            values = coefficients @ self.pencil.pieces
            values[self.diagonal] -= shift * self.inertia
            self.A.setValuesCSR(self.indptr, self.indices, values)
        self.A.assemble()
        self.eps.setOperators(self.A, self.B)
        most = self.pencil.finite(rod)
        wanted = min(wanted, most - 1)  # a pair may be one more
        spare, tolerance = (TIGHT_SPARE, TIGHT_TOLERANCE) if tight else (START_SPARE, START_TOLERANCE)
        krylov = self.users_krylov or max(2 * wanted, wanted + spare)
        self.eps.setTolerances(self.users_tolerance or tolerance, MOST_RESTARTS)
        krylov = min(krylov, most + STEPS_OF_INFINITY)
        self.eps.setDimensions(wanted, krylov, krylov)
        self.eps.setInitialSpace(self.start)
        self.eps.solve()
        found = self.eps.getConverged()
        w: Complex = np.array([self.eps.getEigenvalue(i) for i in range(found)], complex)
        return (w + shift) / self.pace**2

    def vectors(self, found: int) -> Complex:
        """The vectors of what the last `solve` found, shape (unknowns, found)."""
        real, imag = self.A.createVecs()
        X = np.empty((self.pencil.unknowns, found), dtype=complex)
        for i in range(found):
            self.eps.getEigenvector(i, real, imag)
            X[:, i] = real.array + 1j * imag.array
        X[: self.pencil.nodes] *= self.pace
        real.destroy()
        imag.destroy()
        return X

    def destroy(self) -> None:
        """Gives the objects of PETSc and SLEPc back."""
        for held in (self.eps, self.A, self.B, self.start):
            held.destroy()


def _as_filament(rod: Rod) -> tuple[Rod, float]:
    """(rod, pace): the rod whose eigenvalues in units of 1/pace^2 are those of `rod`, y in units of pace.

    A partial beam (k2 = inf, gamma3 = 0) moves like the filament under the force F nu, slower by nu^2; close
    to being crushed its own matrices are too badly scaled.
    """
    if rod.c2 == 0 and rod.rotational_drag == 0 and rod.nu != 1:
        return Rod(F=rod.F * rod.nu, k1=math.inf, k2=math.inf, gamma3=0.0), rod.nu
    return rod, 1.0


_kept = Kept(EigenSolver, MOST_KEPT)


def eigen_solver(resolution: Resolution) -> EigenSolver:
    """The solver for a resolution, kept for the next point."""
    return _kept.get(resolution)


def forget_solvers() -> None:
    """Drops every kept solver: a PETSc object is not usable after an error inside it."""
    _kept.clear()
