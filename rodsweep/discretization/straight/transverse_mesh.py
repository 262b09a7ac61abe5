"""Meshes of the transverse eigenproblem: equal elements for a uniform rod, an `ArmMesh` for any other arm.

A uniform rod of linear material has a `Resolution`. Every other arm has an `ArmMesh`, whose elements end at
the jumps of the material.
"""

from functools import lru_cache
from math import sqrt

from ...model.rod import Rod
from ..elements.elements import ELEMENT_SETTINGS
from ..elements.resolution import Resolution, finer_resolution, resolution_for
from .arm_pencil import ArmPencil
from .arm_resolution import ArmMesh, arm_elements, finer_arm_mesh, halved_where_coefficients_vary
from .dense_eigenproblem import AnyPencil
from .pencil import assemble_pencil

AnyMesh = Resolution | ArmMesh
"""Mesh of the transverse eigenproblem of a uniform rod or of an arm."""


def mesh_for(rod: Rod, wave_number: float, accuracy: float) -> AnyMesh:
    """The mesh on which eigenvalues of a rod whose fields have the wave number `wave_number`, in 1/L, have
    the relative `accuracy`, and the fields its square root."""
    if rod.is_uniform_and_linear:
        return resolution_for(wave_number, accuracy)
    elements = arm_elements(rod, wave_number, accuracy)
    return halved_where_coefficients_vary(rod, ArmMesh(elements.edges, elements.order), sqrt(accuracy))


def finer_mesh(rod: Rod, mesh: AnyMesh) -> AnyMesh:
    """The next mesh after `mesh` in a refinement, with about a third more unknowns."""
    return finer_resolution(mesh) if isinstance(mesh, Resolution) else finer_arm_mesh(rod, mesh)


def pencil_on(mesh: AnyMesh) -> AnyPencil:
    """The pencil of the transverse eigenproblem on a mesh, cached for other rods on an equal mesh."""
    if isinstance(mesh, Resolution):
        return assemble_pencil(mesh.element_count, mesh.order)
    return _arm_pencil(mesh)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_pencils)
def _arm_pencil(mesh: ArmMesh) -> ArmPencil:
    return ArmPencil(mesh)
