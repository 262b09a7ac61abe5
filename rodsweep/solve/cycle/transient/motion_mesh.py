"""Rod and mesh of an integrated motion: a rod near a limit instead of a rod in it, and the first mesh."""

from dataclasses import dataclass, replace

from ....discretization.elements.mesh import Mesh, mesh, mesh_on
from ....discretization.elements.resolution import expected_wave_number, resolution_for
from ....discretization.straight.arm_resolution import arm_elements, arm_mesh
from ....model.dispersion import most_amplified_wave
from ....model.rod import Rod


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionMeshSettings:
    """Settings for the mesh of an integrated motion."""

    accuracy: float = 1e-5
    """Accuracy of the mesh of the integrated motion. The motion decides only the basin of attraction;
    Newton's method supplies the digits of the cycle."""
    expected_modes: int = 3
    """Number of modes whose wave number determines the first mesh; the cycle refines the mesh later."""
    waves_per_root_force: float = 2.5
    """Largest wave number of a cycle in units of sqrt(F), the inverse of the length to which F bends a
    rod."""
    order_per_wave: float = 0.55
    """Order of the coarse mesh in units of a cycle's largest wave number."""
    min_order: int = 12
    """Smallest order of the coarse mesh."""
    coarse_accuracy: float = 1e-4
    """Accuracy of the linear problem on the coarse mesh of an arm."""
    max_stiffness: float = 1e8
    """Largest stiffness of an integrated rod. Rods beyond move alike, to 1e-6 or better."""
    min_drag: float = 1e-6
    """Smallest gamma3 of an integrated rod, for the same reason."""


MOTION_MESH = MotionMeshSettings()


def motion_mesh(rod: Rod, accuracy: float) -> Mesh:
    """The first mesh of a motion, for a relative accuracy."""
    by_force = MOTION_MESH.waves_per_root_force * abs(rod.F) ** 0.5
    if not rod.standard:
        modal = arm_mesh(rod, MOTION_MESH.expected_modes, accuracy)
        bent = arm_elements(rod, by_force, accuracy)
        finest = max(modal, bent, key=lambda each: each.nodes)
        return mesh_on(finest.edges, finest.order)
    wave = max(expected_wave_number(MOTION_MESH.expected_modes, most_amplified_wave(rod)[1]), by_force)
    resolution = resolution_for(wave, accuracy)
    return mesh(resolution.elements, resolution.order)


def coarse_mesh(rod: Rod) -> Mesh:
    """Mesh of the intermediate orbits on the branch from a Hopf point to a cycle."""
    wave_number = MOTION_MESH.waves_per_root_force * abs(rod.F) ** 0.5
    if rod.standard:
        return mesh(1, max(MOTION_MESH.min_order, int(MOTION_MESH.order_per_wave * wave_number)))
    elements = arm_elements(rod, wave_number, MOTION_MESH.coarse_accuracy)
    return mesh_on(elements.edges, elements.order)


def near_rod(rod: Rod) -> Rod:
    """The rod; a nearby rod for a rod in a limit, which the time stepper cannot integrate."""
    return replace(
        rod,
        k1=min(rod.k1, MOTION_MESH.max_stiffness),
        k2=min(rod.k2, MOTION_MESH.max_stiffness),
        gamma3=max(rod.gamma3, MOTION_MESH.min_drag),
    )
