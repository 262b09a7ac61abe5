"""The transverse eigenvalue problem of one rod, as used by the search for leading eigenvalues.

For a uniform rod of linear material, the determinant D has a closed form and the pencil is affine in the
coefficients. For every other arm, D is computed from propagators and the pencil is assembled for each arm.
"""

from abc import ABC, abstractmethod
from functools import cached_property
from math import isfinite, sqrt, tau
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...determinant.arm.completeness import (
    COMPLETENESS_SETTINGS,
    prove_complete,
    requirements_of_cheapest_proof,
)
from ...determinant.arm.count.count import count_right_of as count_of_arm
from ...determinant.arm.count.count import is_countable, largest_w_of_count
from ...determinant.arm.determinant import arm_determinant
from ...determinant.arm.hull.hull import hull_of
from ...determinant.arm.mesh_eigenvalue_refinement import refine_mesh_eigenvalues as roots_of_arm
from ...determinant.certificate.box_of_all_eigenvalues import frequency_bound
from ...determinant.certificate.winding_number import EigenvalueCount, count_right_of
from ...determinant.roots.roots import RootsOfD, refined_roots
from ...discretization.elements.resolution import (
    RESOLUTION_SETTINGS,
    Resolution,
    finer_resolution,
    resolution_for,
)
from ...discretization.straight.arm_resolution import ArmMesh, arm_mesh, finer_arm_mesh, graded_towards_ends
from ...discretization.straight.transverse_mesh import AnyMesh, finer_mesh
from ...discretization.straight.uniform_resolution import first_resolution
from ...model.dispersion import (
    largest_growth_and_wave_number,
    largest_growth_at_ends,
    most_amplified_local_waves,
)
from ...model.rod import Rod
from .arm_solver import ArmSolver, arm_solver
from .krylov_schur import UniformSolver, uniform_solver
from .path.eigenvalue_prediction import KnownRoots
from .shift_invert import KRYLOV_SETTINGS


class TransverseProblem(ABC):
    """Meshes, solver and determinant D of one rod. shift: target of Krylov-Schur, to the right of most
    spectra, in 1/tau2. has_eigenvalue_bound: whether an a-priori bound of the eigenvalues exists.
    is_count_slow: whether a count takes longer than several eigenproblems. largest_growing_wave_number:
    largest local wave number of amplified waves, in 1/L; 0 without such waves."""

    rod: Rod
    shift: float
    has_eigenvalue_bound: bool
    is_count_slow: ClassVar[bool]
    largest_growing_wave_number: float
    additional_eigenvalue_count: int = 0
    """Number of eigenvalues requested beyond the modes from the first mesh, for a proof by `completeness`."""

    def move_shift_right(self) -> None:
        """Moves the shift farther to the right, so that the eigenvalues nearest to the shift are the
        rightmost. The shift of a uniform rod stays, because it lies right of all amplified waves."""
        return

    def move_shift_left(self, leftmost: float) -> None:
        """Moves the shift to the left of the leftmost eigenvalue found, whose real part is `leftmost`. The
        shift of a uniform rod stays."""
        return

    @property
    def shortest_growing_wave_clause(self) -> str:
        """Clause with what is too short for a mesh, waves or the layers of a pulled rod, and a remedy."""
        if not (q := self.largest_growing_wave_number):
            return ""
        taper_clause = " or a larger taper" if self.rod.taper < 1 else ""
        cause = "boundary layers are short" if self.rod.F < 0 else f"waves as short as {tau / q:.1g} L grow"
        return f": {cause}; a smaller |F|{taper_clause} makes them longer"

    @abstractmethod
    def mesh_for(self, mode_count: int, accuracy: float) -> Any:
        """The mesh expected to give `mode_count` leading eigenvalues with relative error below `accuracy`."""

    def finer_mesh(self, mesh: AnyMesh) -> AnyMesh:
        """The next finer mesh after `mesh`, with about a third more unknowns."""
        return finer_mesh(self.rod, mesh)

    def finer_mesh_for_waves(self, mesh: Any, waves: Array, accuracy: float) -> Any:
        """The mesh to try after `mesh`. waves: wave numbers of the leading modes found, (modes,). accuracy:
        relative accuracy of the eigenvalues."""
        return self.finer_mesh(mesh)

    def solver(self, mesh: AnyMesh) -> UniformSolver | ArmSolver:
        """The Krylov-Schur solver for a mesh."""
        return uniform_solver(mesh) if isinstance(mesh, Resolution) else arm_solver(mesh)

    @abstractmethod
    def refined_roots(self, mesh_eigenvalues: Complex, mesh: Any) -> RootsOfD:
        """Roots of D refined from the eigenvalues `mesh_eigenvalues` of `mesh`, (n,); eigenvalues
        whose wave numbers the mesh does not represent are dropped."""

    @abstractmethod
    def count_right_of(self, line: float, roots: RootsOfD | KnownRoots | None = None) -> EigenvalueCount:
        """Proved number of eigenvalues with Re w > line. roots: known roots of D, for a faster count."""

    def completeness_proof_and_evaluations(self, line: float, roots: RootsOfD) -> tuple[bool, int]:
        """Returns (proved, evaluations). proved: whether it is proved that `roots` contains all eigenvalues
        to the right of `line`. evaluations: number of evaluations of D. The proof needs no count. For a
        uniform rod, whose count is fast, no proof is tried."""
        return False, 0

    @cached_property
    def is_countable(self) -> bool:
        """Whether a count can succeed at some vertical line; False if it fails at every real part <= 0."""
        return True


class UniformProblem(TransverseProblem):
    """The transverse eigenvalue problem of a uniform rod of linear material."""

    is_count_slow = False

    def __init__(self, rod: Rod):
        self.rod = rod
        growth, self.largest_growing_wave_number = largest_growth_and_wave_number(rod)
        self.shift = _shift_right_of_waves(rod, growth)
        self._sqrt_frequency_bound = sqrt(frequency_bound(rod))
        self.has_eigenvalue_bound = isfinite(self._sqrt_frequency_bound)

    def mesh_for(self, mode_count: int, accuracy: float) -> Resolution:
        return first_resolution(self.rod, mode_count, accuracy, self.largest_growing_wave_number)

    def finer_mesh_for_waves(self, mesh: Resolution, waves: Array, accuracy: float) -> Resolution:
        """The mesh for the largest wave number of `waves`, (modes,), and the relative accuracy `accuracy`; at
        least the next finer mesh after `mesh`."""
        requested_mesh = resolution_for(float(waves.max()), accuracy)
        return max(requested_mesh, finer_resolution(mesh), key=lambda each: each.unknown_count)

    def refined_roots(self, mesh_eigenvalues: Complex, mesh: Any) -> RootsOfD:
        """Roots of D refined from `mesh_eigenvalues`, (n,), as in `TransverseProblem.refined_roots`."""
        max_q = RESOLUTION_SETTINGS.max_wave_number_per_node * mesh.element_count * mesh.order
        return refined_roots(mesh_eigenvalues, self.rod.coefficients, self._sqrt_frequency_bound, max_q)

    def count_right_of(self, line: float, roots: RootsOfD | KnownRoots | None = None) -> EigenvalueCount:
        return count_right_of(line, self.rod)


class ArmProblem(TransverseProblem):
    """The transverse eigenvalue problem of an arm that is not a uniform rod of linear material.
    modes_to_prove: number of leading modes to be proved complete; 0 if no proof is requested."""

    is_count_slow = True

    def __init__(self, rod: Rod, modes_to_prove: int = 0):
        self.rod = rod
        self._modes_to_prove = modes_to_prove
        self._has_proof_failed = False
        self._hull = hull_of(rod)
        self._determinant = arm_determinant(rod)
        self.has_eigenvalue_bound = isfinite(self._hull.a)
        if modes_to_prove and self.has_eigenvalue_bound:
            self.additional_eigenvalue_count = COMPLETENESS_SETTINGS.eigenvalue_count_beyond_modes
        growth, wave_numbers = most_amplified_local_waves(rod)
        self.largest_growing_wave_number = float(wave_numbers.max())
        self.shift = _shift_right_of_waves(rod, float(growth.max()))

    def move_shift_right(self) -> None:
        """Doubles the shift, or moves it farther, beyond the growth rate of local waves at the ends, which
        the sample points may miss at a thin tip; at most to the right end of the hull of the spectrum."""
        right_end = self._hull.a**2 / (4 * (1 - self._hull.c))
        growth = KRYLOV_SETTINGS.shift_over_growth_rate * largest_growth_at_ends(self.rod)
        self.shift = max(self.shift, min(max(2 * self.shift, growth), right_end))

    def move_shift_left(self, leftmost: float) -> None:
        left = KRYLOV_SETTINGS.shift_over_smallest_growth_rate * leftmost
        self.shift = left if left < self.shift else KRYLOV_SETTINGS.shift_reduction_factor * self.shift

    def mesh_for(self, mode_count: int, accuracy: float) -> ArmMesh:
        return arm_mesh(self.rod, mode_count, accuracy)

    def finer_mesh(self, mesh: Any) -> ArmMesh:
        return graded_towards_ends(self.rod, finer_arm_mesh(self.rod, mesh))

    def refined_roots(self, mesh_eigenvalues: Complex, mesh: Any) -> RootsOfD:
        """Roots of D refined from `mesh_eigenvalues`, (n,), with the same indices. If a proof of completeness
        is requested and has not failed before, only the eigenvalues that the proof needs are refined."""
        needed_mask, max_abs_w = self._needed_mask_and_max_abs_w(mesh_eigenvalues)
        max_q_of_unit_element = RESOLUTION_SETTINGS.max_wave_number_per_node * mesh.order
        max_end_q = max_q_of_unit_element * (1 / mesh.lengths[[0, -1]])
        # Infinite values are dropped by the refinement; all others keep their indices.
        w = np.where(needed_mask, mesh_eigenvalues, np.inf)
        max_q = max_q_of_unit_element * mesh.element_count
        return roots_of_arm(w, self._determinant, self._hull, max_q, max_abs_w, max_end_q)

    def _needed_mask_and_max_abs_w(self, mesh_eigenvalues: Complex) -> tuple[NDArray[np.bool_], float]:
        """Returns (mask, max_abs_w). mask: True for each of the `mesh_eigenvalues` that the proof will need,
        (n,). max_abs_w: largest |w| at which the proof needs D; 0 if unknown."""
        needed_mask = np.isfinite(mesh_eigenvalues)
        may_prove = self._modes_to_prove > 0 and self.has_eigenvalue_bound
        if not may_prove or needed_mask.sum() < self._modes_to_prove:
            return needed_mask, 0.0
        finite = np.flatnonzero(needed_mask)
        order = finite[np.lexsort((-mesh_eigenvalues.imag[finite], -mesh_eigenvalues.real[finite]))]
        w = mesh_eigenvalues[order]
        line = min(float(w[self._modes_to_prove - 1].real), 0.0)
        number, max_abs_w = requirements_of_cheapest_proof(line, self._hull, w, self._modes_to_prove)
        # After a failed proof a count decides, which needs all eigenvalues right of its line.
        if not number or self._has_proof_failed:
            return needed_mask, largest_w_of_count(line, self._determinant, self._hull)
        needed_mask[order[number:]] = False
        return needed_mask, max_abs_w

    def count_right_of(self, line: float, roots: RootsOfD | KnownRoots | None = None) -> EigenvalueCount:
        w_and_errors = () if roots is None else (roots.w, roots.error)
        return count_of_arm(line, self._determinant, self._hull, *w_and_errors)

    @cached_property
    def is_countable(self) -> bool:
        return is_countable(self._determinant, self._hull)

    def completeness_proof_and_evaluations(self, line: float, roots: RootsOfD) -> tuple[bool, int]:
        is_complete, evaluations = prove_complete(line, roots.w, roots.error, self._determinant, self._hull)
        # The next mesh then refines all eigenvalues, as a count needs them.
        self._has_proof_failed |= not is_complete
        return is_complete, evaluations


def _shift_right_of_waves(rod: Rod, growth: float) -> float:
    """The shift, in 1/tau2, of a rod whose most amplified wave has the growth rate `growth`. The shift lies
    so far to the right that the eigenvalues nearest to it are mostly the rightmost.

    If no wave grows, the shift is the rate -F of a string under the pull. With the shift 0, next to the
    exponentially small leading eigenvalue of a pulled rod, rounding errors would hide all others."""
    return KRYLOV_SETTINGS.shift_over_growth_rate * growth if growth else max(-rod.F, 0.0)


def transverse_problem(rod: Rod, modes_to_prove: int = 0) -> TransverseProblem:
    """The transverse eigenvalue problem of a rod. modes_to_prove: number of modes to prove complete, or 0."""
    return UniformProblem(rod) if rod.is_uniform_and_linear else ArmProblem(rod, modes_to_prove)


def meshes_without_result_text(mesh_count: int, next_mesh: AnyMesh) -> str:
    """Subject of a message on meshes without a result: all meshes of a size that may be solved, or the first
    `mesh_count` meshes, which are coarser than `next_mesh`."""
    if next_mesh.unknown_count > RESOLUTION_SETTINGS.max_unknowns:
        return f"no mesh of at most {RESOLUTION_SETTINGS.max_unknowns} unknowns"
    return f"none of {mesh_count} meshes with fewer than {next_mesh.unknown_count} unknowns"
