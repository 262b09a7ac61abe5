"""SLEPc's Krylov-Schur method for the eigenvalues of a pencil nearest to a real shift, by shift-and-invert.

The matrices of a solver are created once and filled with new values for every rod. The shift is part of the
values: the pencil (A - shift B, B) is solved about 0, so that a diagonal B is combined with a dense A without
copies. B is singular; its null vectors belong to infinite eigenvalues, which shift-and-invert maps to zero
and never returns. The LU factorisation pivots: LAPACK's LU for small matrices or if PETSc has no sparse
package with pivoting, otherwise the sparse LU.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...arrays import Array, Complex
from ...discretization.straight.arm_pencil import ArmPencil
from ...discretization.straight.pencil import Pencil
from ...model.rod import Rod
from ...solve_progress import report
from ..backend.petsc import PETSc, SLEPc, sparse_lu_package


@dataclass(frozen=True, slots=True, kw_only=True)
class KrylovSettings:
    """Settings of Krylov-Schur by shift-and-invert, and of the solver objects stored for later rods."""

    shift_over_growth_rate: float = 1.05
    """Shift divided by the growth rate of the most amplified wave. This growth rate is above most spectra."""
    shift_over_smallest_growth_rate: float = 0.5
    """If eigenvalues farther left are missing, the new shift is this number times the smallest growth rate
    found. Below 1, so that among growing modes the shift moves to the left; not 0, because growth rates may
    be far apart."""
    shift_reduction_factor: float = 0.01
    """The shift is multiplied by this number if the previous shift gave no further eigenvalue."""
    max_dense_unknowns: int = 300
    """Matrices with up to this number of unknowns are factorised as dense: as fast as the sparse
    factorisation, with smaller rounding errors."""
    krylov_tolerance_if_refined: float = 1e-4
    """Krylov tolerance for eigenvalues that Newton's method on the determinant D refines."""
    spare_vectors_if_refined: int = 5
    """Number of Krylov vectors in addition to the wanted eigenvalues, if Newton's method on the determinant D
    refines the eigenvalues."""
    krylov_tolerance_if_not_refined: float = 1e-14
    """Krylov tolerance for eigenvalues and eigenvectors that are not refined: only the mesh error remains."""
    spare_vectors_if_not_refined: int = 13
    """Number of Krylov vectors in addition to the wanted eigenvalues, if these are not refined."""
    max_restarts: int = 200
    """Maximum number of restarts of the Krylov space."""
    max_vectors_beyond_finite_eigenvalues: int = 2
    """The number of Krylov vectors is at most the number of finite eigenvalues plus this. Applying
    shift-and-invert once, or twice for k2 = inf, removes all components of infinite eigenvalues. A larger
    Krylov space would add only rounding errors, on which LAPACK may fail (trexc)."""
    start_vector_width_over_node_spacing: float = 3.3
    """Width of the first Krylov vector, a displacement concentrated at the tip, divided by the distance
    between nodes. Every mode moves the tip, and the vector is as smooth as the wanted modes, which saves two
    Krylov steps of eleven."""
    start_vector_rotation_over_displacement: float = 0.1
    """Ratio of rotation and displacement in the first Krylov vector. Without rotation only rounding errors
    would excite modes of pure rotation, in rods whose displacement and rotation are uncoupled."""
    max_uniform_solvers: int = 24
    """Maximum number of stored solvers of uniform rods, one per mesh, if memory allows; a sweep needs few."""
    max_arm_solvers: int = 8
    """Maximum number of stored solvers of arms, one per mesh."""
    dense_matrices_per_solver: int = 9
    """Number of dense matrices that a solver of a small pencil stores: A, its factors, and constants."""
    stored_numbers_per_nonzero_entry: int = 11
    """Number of stored numbers per nonzero entry of a large pencil: A with pattern, factors, constants."""


KRYLOV_SETTINGS = KrylovSettings()

SPECTRUM_OPTIONS_PREFIX = "spectrum_"
"""Prefix of the PETSc options that override the settings of this eigensolver, as in -spectrum_eps_ncv 32."""


class CurrentPencil(NamedTuple):
    """Data of the rod whose matrices a solver contains.

    finite_eigenvalue_count: number of finite eigenvalues. shift: shift in the units of the pencil's
    eigenvalues. deflection_ratio: eigenvalues of the rod = eigenvalues of the pencil / deflection_ratio^2; y
    of the rod = y of the pencil * deflection_ratio.
    """

    finite_eigenvalue_count: int
    shift: float
    deflection_ratio: float = 1.0


class ShiftInvertSolver(ABC):
    """Krylov-Schur solver for pencils of one sparsity pattern; `solve` may be called any number of times.
    mass: lumped masses of the nodes, without the clamp, (nodes,), for the first Krylov vector. A, B: PETSc's
    matrices A - shift B and B of the rod in `current_pencil`. eps: SLEPc's solver."""

    def __init__(self, pattern: Pencil | ArmPencil, mass: Array):
        self.node_count = pattern.node_count
        n = pattern.unknown_count
        package = sparse_lu_package()
        self.is_dense = n <= KRYLOV_SETTINGS.max_dense_unknowns or package is None
        self.is_diagonal_entry = pattern.rows == pattern.columns
        self.indptr = np.searchsorted(pattern.rows, np.arange(n + 1)).astype(PETSc.IntType)
        self.indices = pattern.columns.astype(PETSc.IntType)
        self.A = PETSc.Mat()
        self.B = PETSc.Mat()
        if self.is_dense:
            self.A.createDense([n, n], comm=PETSc.COMM_SELF).setUp()
        else:
            values = np.ones(len(self.indices))
            self.A.createAIJ([n, n], csr=(self.indptr, self.indices, values), comm=PETSc.COMM_SELF)
        self.row_starts = np.arange(n + 1, dtype=PETSc.IntType)
        self.B.createAIJ(
            [n, n], csr=(self.row_starts, self.row_starts[:-1], np.ones(n)), comm=PETSc.COMM_SELF
        )
        first = np.zeros(n)
        distance = (
            (1 - pattern.node_positions[1:])
            * pattern.node_count
            / KRYLOV_SETTINGS.start_vector_width_over_node_spacing
        )
        # Every mode moves the tip, so a vector concentrated there contains all of them.
        first[: pattern.node_count] = np.exp(-(distance**2)) * np.sqrt(mass)
        first[pattern.node_count : 2 * pattern.node_count] = (
            KRYLOV_SETTINGS.start_vector_rotation_over_displacement * first[: pattern.node_count]
        )
        self.start_vector = PETSc.Vec().createWithArray(first, comm=PETSc.COMM_SELF)
        self.krylov_size_option = PETSc.Options(SPECTRUM_OPTIONS_PREFIX).getInt("eps_ncv", 0)
        self.tolerance_option = PETSc.Options(SPECTRUM_OPTIONS_PREFIX).getReal("eps_tol", 0.0)
        self.eps = self._create_eps("petsc" if self.is_dense else package)
        self.current_pencil = CurrentPencil(0, 0.0)

    def _create_eps(self, package: str | None) -> "SLEPc.EPS":
        """SLEPc's Krylov-Schur solver with shift-and-invert; package: PETSc's name of the LU package."""
        eps = SLEPc.EPS().create(PETSc.COMM_SELF)
        eps.setOptionsPrefix(SPECTRUM_OPTIONS_PREFIX)
        eps.setProblemType(SLEPc.EPS.ProblemType.GNHEP)
        eps.setType(SLEPc.EPS.Type.KRYLOVSCHUR)
        eps.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
        # `load_matrices` has already shifted the matrix.
        eps.setTarget(0.0)
        spectral_transform = eps.getST()
        spectral_transform.setType(SLEPc.ST.Type.SINVERT)
        # With the target 0, A itself is factorised, without a shifted copy.
        spectral_transform.setMatMode(SLEPc.ST.MatMode.INPLACE)
        ksp = spectral_transform.getKSP()
        ksp.setType(PETSc.KSP.Type.PREONLY)
        ksp.getPC().setType(PETSc.PC.Type.LU)
        ksp.getPC().setFactorSolverType(package)
        eps.setFromOptions()
        return eps

    @abstractmethod
    def load_matrices(self, rod: Rod, shift: float) -> CurrentPencil:
        """Fills PETSc's matrices A - shift B and B with the values for `rod`, and returns data of the pencil.
        shift: in 1/tau2."""

    @abstractmethod
    def displacements(self, vectors: Complex, rod: Rod) -> tuple[Complex, Complex]:
        """Returns (y, theta) at all nodes, (nodes + 1, k) each. vectors: eigenvectors of the last solve,
        (unknowns, k). rod: the rod that was solved."""

    def solve(self, rod: Rod, shift: float, requested_count: int, to_rounding: bool = False) -> Complex:
        """Eigenvalues of a rod nearest to the shift, complex, unsorted, (k,), in 1/tau2; k >=
        `requested_count` if enough eigenvalues converge.

        shift: in 1/tau2. to_rounding: whether the eigenvalues converge to rounding error on the mesh, instead
        of the few digits that Newton's method on D needs. Raises PETSc.Error.
        """
        report()
        self.current_pencil = self.load_matrices(rod, shift)
        self.A.assemble()
        self.eps.setOperators(self.A, self.B)
        max_count = self.current_pencil.finite_eigenvalue_count
        requested_count = min(requested_count, max_count - 1)  # a conjugate pair may add one
        spare_vectors = (
            KRYLOV_SETTINGS.spare_vectors_if_not_refined
            if to_rounding
            else KRYLOV_SETTINGS.spare_vectors_if_refined
        )
        tolerance = (
            KRYLOV_SETTINGS.krylov_tolerance_if_not_refined
            if to_rounding
            else KRYLOV_SETTINGS.krylov_tolerance_if_refined
        )
        vector_count = self.krylov_size_option or max(2 * requested_count, requested_count + spare_vectors)
        self.eps.setTolerances(self.tolerance_option or tolerance, KRYLOV_SETTINGS.max_restarts)
        # Beyond the finite eigenvalues only the infinite ones remain, which shift-and-invert maps to 0.
        vector_count = min(vector_count, max_count + KRYLOV_SETTINGS.max_vectors_beyond_finite_eigenvalues)
        self.eps.setDimensions(requested_count, vector_count, vector_count)
        # A fixed start instead of SLEPc's random one gives the same bits in every run.
        self.eps.setInitialSpace(self.start_vector)
        self.eps.solve()
        converged_count = self.eps.getConverged()
        w: Complex = np.array([self.eps.getEigenvalue(i) for i in range(converged_count)], complex)
        return (w + self.current_pencil.shift) / self.current_pencil.deflection_ratio**2

    def eigenvectors(self, count: int) -> Complex:
        """Eigenvectors of the first `count` eigenvalues of the last `solve`, (unknowns, count)."""
        real, imag = self.A.createVecs()
        X = np.empty((len(self.row_starts) - 1, count), dtype=complex)
        for i in range(count):
            self.eps.getEigenvector(i, real, imag)
            X[:, i] = real.array + 1j * imag.array
        # The solver works on the equivalent filament, whose deflection has another scale.
        X[: self.node_count] *= self.current_pencil.deflection_ratio
        real.destroy()
        imag.destroy()
        return X

    @property
    def memory_bytes(self) -> int:
        """Estimated memory of a solver, in bytes: matrices with factors, Krylov space and projected matrices.
        Destroying a solver frees 0.5 to 0.9 of this estimate, measured with up to 640 Krylov vectors; pencils
        stay in memory."""
        n = len(self.row_starts) - 1
        vector_count = self.eps.getDimensions()[1] + 1
        matrices = (
            KRYLOV_SETTINGS.dense_matrices_per_solver * n * n
            if self.is_dense
            else KRYLOV_SETTINGS.stored_numbers_per_nonzero_entry * len(self.indices)
        )
        return 8 * (matrices + 2 * n * vector_count + 4 * vector_count**2)

    def destroy(self) -> None:
        """Frees the PETSc and SLEPc objects of the solver."""
        for petsc_object in (self.eps, self.A, self.B, self.start_vector):
            petsc_object.destroy()
