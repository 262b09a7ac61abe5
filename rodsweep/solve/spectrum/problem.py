"""The transverse eigenvalue problem of one rod for the search of leading eigenvalues.

A uniform rod of linear material has D in closed form and a pencil that is affine in its coefficients. Every
other arm has D from propagators and a pencil that is filled anew.
"""

from abc import ABC, abstractmethod
from functools import cached_property
from math import isfinite, sqrt
from typing import Any, ClassVar

from ...arrays import Array, Complex
from ...determinant.arm.completeness import none_is_missing
from ...determinant.arm.count import count_right_of as count_of_arm
from ...determinant.arm.count import is_countable
from ...determinant.arm.determinant import arm_determinant
from ...determinant.arm.hull import hull_of
from ...determinant.arm.roots import roots as roots_of_arm
from ...determinant.certificate.box import squared_amplification
from ...determinant.certificate.winding_number import Count, count_right_of
from ...determinant.roots import Roots, roots
from ...discretization.elements.resolution import Resolution, expected_wave_number, finer, resolution_for
from ...discretization.straight.arm_pencil import ArmMesh
from ...discretization.straight.arm_resolution import arm_mesh, finer_arm_mesh
from ...model.dispersion import local_growth, most_amplified_wave
from ...model.rod import Rod
from .arm_solver import ArmSolver, arm_solver, forget_arm_solvers
from .krylov_schur import EigenSolver, eigen_solver, forget_uniform_solvers

SHIFT_ABOVE_GROWTH = 1.05
"""Shift in units of the growth rate of the most amplified wave, which bounds most spectra."""

Mesh = Resolution | ArmMesh
"""Mesh of a uniform rod or of an arm."""


class TransverseProblem(ABC):
    """Discretization and determinant of one rod.

    shift: right of most spectra, in 1/tau2. bounded: whether an a-priori bound of the eigenvalues is known.
    is_count_slow: whether a count costs more than some eigenproblems.
    """

    rod: Rod
    shift: float
    bounded: bool
    is_count_slow: ClassVar[bool]

    @abstractmethod
    def mesh_for(self, modes: int, accuracy: float) -> Any:
        """The mesh expected to give a number of leading modes to a relative accuracy."""

    @abstractmethod
    def finer(self, mesh: Any) -> Any:
        """The next mesh after a mesh that is too coarse."""

    @abstractmethod
    def informed(self, mesh: Any, waves: Array, accuracy: float) -> Any:
        """The next mesh, from the wave numbers of the leading modes found, (modes,)."""

    @abstractmethod
    def solver(self, mesh: Any) -> Any:
        """The Krylov-Schur solver for a mesh."""

    @abstractmethod
    def roots(self, raw: Complex, most_waves: float) -> Roots:
        """Eigenvalues of a mesh, (n,), refined to roots of D; most_waves: largest |q| that the mesh
        represents."""

    @abstractmethod
    def count(self, line: float, found: Roots | None = None) -> Count:
        """Number of eigenvalues with Re w > line; found: roots that may make the count faster."""

    def none_is_missing(self, line: float, found: Roots) -> tuple[bool, int]:
        """(whether a proof without a count says that all right of a line are found, evaluations of D)."""
        return False, 0

    @cached_property
    def countable(self) -> bool:
        """Whether a count is possible; False if it fails for every line at most 0."""
        return True

    @abstractmethod
    def fields(self, mesh: Any, vectors: Complex) -> tuple[Complex, Complex]:
        """(y, theta) at all nodes of a mesh, (nodes + 1, k) each, from vectors of the last solve, (unknowns,
        k)."""

    def evaluation(self, mesh: Any, points: Array) -> Array:
        """Matrix from values at all nodes to values at `points` in [0, 1], shape (points, nodes + 1)."""
        matrix: Array = self.solver(mesh).pencil.evaluation(points)
        return matrix


class UniformProblem(TransverseProblem):
    """The problem of a uniform rod of linear material."""

    is_count_slow = False

    def __init__(self, rod: Rod):
        self.rod = rod
        growth, self._wave = most_amplified_wave(rod)
        self.shift = SHIFT_ABOVE_GROWTH * growth
        self._amplification = sqrt(squared_amplification(rod))
        self.bounded = isfinite(self._amplification)

    def mesh_for(self, modes: int, accuracy: float) -> Resolution:
        return resolution_for(expected_wave_number(modes, self._wave), accuracy)

    def finer(self, mesh: Resolution) -> Resolution:
        return finer(mesh)

    def informed(self, mesh: Resolution, waves: Array, accuracy: float) -> Resolution:
        """The mesh for the wave numbers, (modes,), but at least the next finer mesh."""
        asked = resolution_for(float(waves.max()), accuracy)
        return max(asked, finer(mesh), key=lambda each: each.unknowns)

    def solver(self, mesh: Resolution) -> EigenSolver:
        return eigen_solver(mesh)

    def roots(self, raw: Complex, most_waves: float) -> Roots:
        """Eigenvalues of a mesh, (n,), refined to roots of D."""
        return roots(raw, self.rod.coefficients, self._amplification, most_waves)

    def count(self, line: float, found: Roots | None = None) -> Count:
        return count_right_of(line, self.rod)

    def fields(self, mesh: Resolution, vectors: Complex) -> tuple[Complex, Complex]:
        """(y, theta) at all nodes, (nodes + 1, k) each, from vectors, (unknowns, k)."""
        return eigen_solver(mesh).pencil.fields(vectors, self.rod)


class ArmProblem(TransverseProblem):
    """The problem of an arm that varies along its length."""

    is_count_slow = True

    def __init__(self, rod: Rod):
        self.rod = rod
        self._hull = hull_of(rod)
        self._determinant = arm_determinant(rod)
        self.bounded = isfinite(self._hull.a)
        growth, _ = local_growth(rod)
        self.shift = SHIFT_ABOVE_GROWTH * float(growth.max())

    def mesh_for(self, modes: int, accuracy: float) -> ArmMesh:
        return arm_mesh(self.rod, modes, accuracy)

    def finer(self, mesh: ArmMesh) -> ArmMesh:
        return finer_arm_mesh(self.rod, mesh)

    def informed(self, mesh: ArmMesh, waves: Array, accuracy: float) -> ArmMesh:
        """The next finer mesh; the wave numbers, (modes,), are ignored."""
        return finer_arm_mesh(self.rod, mesh)

    def solver(self, mesh: ArmMesh) -> ArmSolver:
        return arm_solver(mesh)

    def roots(self, raw: Complex, most_waves: float) -> Roots:
        """Eigenvalues of a mesh, (n,), refined to roots of D."""
        return roots_of_arm(raw, self._determinant, self._hull, most_waves)

    def count(self, line: float, found: Roots | None = None) -> Count:
        known = () if found is None else (found.w, found.error)
        return count_of_arm(line, self._determinant, self._hull, *known)

    @cached_property
    def countable(self) -> bool:
        return is_countable(self._determinant, self._hull)

    def none_is_missing(self, line: float, found: Roots) -> tuple[bool, int]:
        return none_is_missing(line, found.w, found.error, self._determinant, self._hull)

    def fields(self, mesh: ArmMesh, vectors: Complex) -> tuple[Complex, Complex]:
        """(y, theta) at all nodes, (nodes + 1, k) each, from vectors of the last solve, (unknowns, k)."""
        solver = arm_solver(mesh)
        return solver.pencil.fields(vectors, solver.matrices.scale)


def problem_of(rod: Rod) -> TransverseProblem:
    """The problem of a rod: uniform, or an arm."""
    return UniformProblem(rod) if rod.standard else ArmProblem(rod)


def forget_solvers() -> None:
    """Drops every kept solver: a PETSc object is unusable after an error inside PETSc."""
    forget_uniform_solvers()
    forget_arm_solvers()
