"""Meshes and determinant of one rod for its modes.

A uniform rod of linear material has equal elements and a determinant D in closed form. Every other arm has
elements that end at jumps of a coefficient, and D from propagators.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from ...determinant.arm.determinant import arm_determinant
from ...determinant.arm.roots import second_derivative
from ...determinant.value import distance_to_next, newton_correction
from ...discretization.elements.resolution import Resolution, finer, resolution_for
from ...discretization.straight.arm_pencil import ArmMesh, ArmPencil
from ...discretization.straight.arm_resolution import arm_elements, finer_arm_mesh
from ...discretization.straight.dense_form import AnyPencil
from ...discretization.straight.pencil import assemble
from ...model.rod import Rod


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeProblemSettings:
    """Number of pencils of arms kept in memory."""

    pencils_kept: int = 16
    """Number of sparsity patterns of arm pencils that are kept for later points on equal meshes."""


MODE_PROBLEM = ModeProblemSettings()


class ModesProblem(ABC):
    """Discretization and determinant of a rod for its modes."""

    rod: Rod

    @abstractmethod
    def mesh_for(self, wave_number: float, accuracy: float) -> Any:
        """Mesh that resolves fields of a wave number, in 1/L, to a relative accuracy."""

    @abstractmethod
    def of_order(self, mesh: Any, order: int) -> Any:
        """A mesh with the same elements and a given order."""

    @abstractmethod
    def finer(self, mesh: Any) -> Any:
        """The next mesh after a mesh that is too coarse."""

    @abstractmethod
    def pencil(self, mesh: Any) -> AnyPencil:
        """The pencil on a mesh."""

    @abstractmethod
    def wave_number(self, w: complex) -> float:
        """Wave number of the mode with eigenvalue w, in 1/L."""

    @abstractmethod
    def gap(self, w: complex) -> float:
        """Estimated distance of eigenvalue w from the nearest other eigenvalue, 2 |D'/D''|; accurate for
        small distances."""


class UniformModes(ModesProblem):
    """The problem of a uniform rod of linear material."""

    def __init__(self, rod: Rod):
        self.rod = rod

    def mesh_for(self, wave_number: float, accuracy: float) -> Resolution:
        return resolution_for(wave_number, accuracy)

    def of_order(self, mesh: Resolution, order: int) -> Resolution:
        return Resolution(mesh.elements, order)

    def finer(self, mesh: Resolution) -> Resolution:
        return finer(mesh)

    def pencil(self, mesh: Resolution) -> AnyPencil:
        return assemble(mesh.elements, mesh.order)

    def wave_number(self, w: complex) -> float:
        return newton_correction(w, self.rod.coefficients)[2]

    def gap(self, w: complex) -> float:
        return distance_to_next(w, self.rod.coefficients)


class ArmModes(ModesProblem):
    """The problem of an arm that varies along its length."""

    def __init__(self, rod: Rod):
        self.rod = rod
        self._determinant = arm_determinant(rod)

    def mesh_for(self, wave_number: float, accuracy: float) -> ArmMesh:
        elements = arm_elements(self.rod, wave_number, accuracy)
        return ArmMesh(elements.edges, elements.order)

    def of_order(self, mesh: ArmMesh, order: int) -> ArmMesh:
        return ArmMesh(mesh.edges, order)

    def finer(self, mesh: ArmMesh) -> ArmMesh:
        return finer_arm_mesh(self.rod, mesh)

    def pencil(self, mesh: ArmMesh) -> AnyPencil:
        return _arm_pencil(mesh)

    def wave_number(self, w: complex) -> float:
        return self._determinant.wave_number(w)

    def gap(self, w: complex) -> float:
        value = self._determinant.value(w)
        second = abs(second_derivative(w, value.S, self._determinant))
        return 2 * abs(value.D_w) / max(second, math.ulp(0.0))


@lru_cache(maxsize=MODE_PROBLEM.pencils_kept)
def _arm_pencil(mesh: ArmMesh) -> ArmPencil:
    return ArmPencil(mesh)


def modes_problem(rod: Rod) -> ModesProblem:
    """The problem of a rod: uniform, or an arm."""
    return UniformModes(rod) if rod.standard else ArmModes(rod)
