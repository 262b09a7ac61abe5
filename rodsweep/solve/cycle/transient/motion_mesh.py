"""Rod and mesh for the integration of a motion; huge or infinite stiffnesses and tiny drags are replaced."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import ceil

from ....discretization.elements.elements import halved_element_edges
from ....discretization.elements.mesh import Mesh, mesh_with_edges, uniform_mesh
from ....discretization.elements.resolution import (
    RESOLUTION_SETTINGS,
    expected_wave_number,
    resolution_for,
)
from ....discretization.straight.arm_resolution import arm_elements, arm_mesh
from ....model.dispersion import largest_growth_and_wave_number
from ....model.rod import Rod


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionMeshSettings:
    """Settings for the rod and the mesh of an integrated motion."""

    accuracy: float = 1e-5
    """Relative accuracy of the mesh of an integrated motion. The motion only has to reach the basin of
    attraction of the cycle; Newton's method gives the accuracy of the cycle."""
    accuracy_of_stored_motion: float = 1e-10
    """Relative accuracy of the mesh of a motion whose path is stored: an error of the growth rate shifts the
    phase of the whole later motion. The integration takes a quarter longer than with `accuracy`, and its
    errors were 30 to 500 times smaller on four arms."""
    order_refinement_factor: float = 1.5
    """Factor by which the order of the elements increases if a motion repeats on its mesh but no cycle is
    found near this motion: compressed rubber may bend more sharply than linear waves."""
    max_refinements: int = 3
    """Maximum number of times that the mesh of a motion is refined."""
    max_refined_nodes: int = 64
    """Maximum number of nodes of a refined mesh; with more nodes a motion takes minutes."""
    first_mesh_mode_count: int = 3
    """Number of modes that the first mesh resolves; the mesh is refined for the cycle later."""
    wave_number_per_root_force: float = 2.5
    """Largest expected wave number of a cycle, in 1/L, divided by sqrt(F), F in k3/L^2; 1/sqrt(F) is the
    length over which the force bends a rod."""
    coarse_order_per_wave_number: float = 0.55
    """Order of the coarse mesh divided by the largest expected wave number of a cycle, in 1/L."""
    min_coarse_order: int = 12
    """Smallest order of the coarse mesh."""
    coarse_accuracy: float = 1e-4
    """Relative accuracy to which the coarse mesh of an arm resolves waves of the largest expected wave
    number."""
    max_stiffness: float = 1e8
    """A larger dimensionless stiffness k1 or k2 is replaced by this value for the integration; the motion
    changes by 1e-6 or less."""
    min_rotational_drag: float = 1e-6
    """A smaller rotational drag gamma3 is replaced by this value for the integration; the motion changes by
    1e-6 or less."""
    min_axial_drag: float = 1e-6
    """A smaller axial drag gamma1, anywhere along the arm, is replaced by this value for the integration; the
    motion changes by 1e-5 or less."""


MOTION_MESH_SETTINGS = MotionMeshSettings()


def motion_mesh(rod: Rod, accuracy: float) -> Mesh:
    """The first mesh for the integration of the motion of `rod` to the relative accuracy `accuracy`."""
    wave_number = MOTION_MESH_SETTINGS.wave_number_per_root_force * abs(rod.F) ** 0.5
    if not rod.is_uniform_and_linear:
        modal_mesh = arm_mesh(rod, MOTION_MESH_SETTINGS.first_mesh_mode_count, accuracy)
        mesh = arm_elements(rod, wave_number, accuracy)
        # The bends of a large motion may be sharper than those of its modes.
        finest_mesh = max(modal_mesh, mesh, key=lambda each: each.node_count)
        return mesh_with_edges(finest_mesh.edges, finest_mesh.order)
    max_wave_number = max(
        expected_wave_number(
            MOTION_MESH_SETTINGS.first_mesh_mode_count, largest_growth_and_wave_number(rod)[1]
        ),
        wave_number,
    )
    resolution = resolution_for(max_wave_number, accuracy)
    return uniform_mesh(resolution.element_count, resolution.order)


def accuracy_of_motion_mesh(is_stored: bool) -> float:
    """Relative accuracy of the first mesh of an integrated motion. is_stored: whether the path of the motion
    is stored."""
    return MOTION_MESH_SETTINGS.accuracy_of_stored_motion if is_stored else MOTION_MESH_SETTINGS.accuracy


def motion_meshes_by_refinement(rod: Rod, is_stored: bool) -> Iterator[Mesh]:
    """Yields the first mesh for the integration of the motion of `rod`, and then finer meshes. is_stored:
    whether the path of the motion is stored."""
    mesh = motion_mesh(rod, accuracy_of_motion_mesh(is_stored))
    yield mesh
    for _ in range(MOTION_MESH_SETTINGS.max_refinements):
        order = ceil(MOTION_MESH_SETTINGS.order_refinement_factor * mesh.order)
        edges = mesh.edges
        # The order of an element is limited; half the order on halved elements has as many unknowns.
        if order > RESOLUTION_SETTINGS.max_order:
            edges = halved_element_edges(edges)
            order = ceil(order / 2)
        mesh = mesh_with_edges(edges, order)
        if mesh.node_count > MOTION_MESH_SETTINGS.max_refined_nodes:
            return
        yield mesh


def coarse_mesh_for_branch_to_cycle(rod: Rod) -> Mesh:
    """Coarse mesh for the intermediate orbits on the branch from a Hopf point to the cycle of a rod."""
    wave_number = MOTION_MESH_SETTINGS.wave_number_per_root_force * abs(rod.F) ** 0.5
    if rod.is_uniform_and_linear:
        return uniform_mesh(
            1,
            max(
                MOTION_MESH_SETTINGS.min_coarse_order,
                int(MOTION_MESH_SETTINGS.coarse_order_per_wave_number * wave_number),
            ),
        )
    elements = arm_elements(rod, wave_number, MOTION_MESH_SETTINGS.coarse_accuracy)
    return mesh_with_edges(elements.edges, elements.order)


def rod_for_time_integration(rod: Rod, distance: float = 1.0) -> Rod:
    """A rod near `rod` that can be integrated in time; a limiting rod (k1 = inf, k2 = inf or gamma3 = 0)
    cannot. At the base k1 and k2 are at most MOTION_MESH_SETTINGS.max_stiffness / `distance`; at the base and
    in every row of a profile gamma3 and gamma1 are at least `distance` times `min_rotational_drag` and
    `min_axial_drag`. Larger stiffnesses along the arm stay: they cost no digits, because the unknowns of
    `ExplicitSystem` are scaled with the compliances."""
    least = {
        "gamma3": distance * MOTION_MESH_SETTINGS.min_rotational_drag,
        "gamma1": distance * MOTION_MESH_SETTINGS.min_axial_drag,
    }
    max_stiffness = MOTION_MESH_SETTINGS.max_stiffness / distance
    drags = {name: max(getattr(rod, name), value) for name, value in least.items()}
    material = rod.material
    if material.profile is not None:
        profile = material.profile
        for name, value in least.items():
            # A row may be far below the base, and one point without drag makes the whole system stiff.
            profile = profile.with_factors_above(name, value / drags[name], rod.taper)
        material = replace(material, profile=profile)
    stiffnesses = {"k1": min(rod.k1, max_stiffness), "k2": min(rod.k2, max_stiffness)}
    return replace(rod.with_values(**stiffnesses, **drags), material=material)
