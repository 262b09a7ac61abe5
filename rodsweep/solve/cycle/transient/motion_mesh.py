"""Rod and mesh of an integrated motion: a rod near a limit instead of a rod in it, and the first mesh."""

from dataclasses import replace

from ....discretization.elements.mesh import Mesh, mesh, mesh_on
from ....discretization.elements.resolution import expected_wave_number, resolution_for
from ....discretization.straight.arm_resolution import arm_elements, arm_mesh
from ....model.dispersion import most_amplified_wave
from ....model.rod import Rod

MOTION_ACCURACY = 1e-5
"""Accuracy of the mesh of the integrated motion. The motion decides only the basin of attraction; Newton's
method supplies the digits of the cycle."""
EXPECTED_MODES = 3
"""Number of modes whose wave number determines the first mesh; the cycle refines the mesh later."""
WAVES_PER_ROOT_FORCE = 2.5
"""Largest wave number of a cycle in units of sqrt(F), the inverse of the length to which F bends a rod."""
ORDER_PER_WAVE, LEAST_ORDER = 0.55, 12
"""Order of the coarse mesh in units of a cycle's largest wave number; and the smallest order."""
COARSE_ACCURACY = 1e-4
"""Accuracy of the linear problem on the coarse mesh of an arm."""
STIFFEST, MIN_DRAG = 1e8, 1e-6
"""Largest stiffness and smallest gamma3 of an integrated rod. Rods beyond move alike, to 1e-6 or better."""


def motion_mesh(rod: Rod, accuracy: float) -> Mesh:
    """The first mesh of a motion, for a relative accuracy."""
    by_force = WAVES_PER_ROOT_FORCE * abs(rod.F) ** 0.5
    if not rod.standard:
        modal, bent = arm_mesh(rod, EXPECTED_MODES, accuracy), arm_elements(rod, by_force, accuracy)
        finest = max(modal, bent, key=lambda each: each.nodes)
        return mesh_on(finest.edges, finest.order)
    wave = max(expected_wave_number(EXPECTED_MODES, most_amplified_wave(rod)[1]), by_force)
    resolution = resolution_for(wave, accuracy)
    return mesh(resolution.elements, resolution.order)


def coarse_mesh(rod: Rod) -> Mesh:
    """Mesh of the intermediate orbits on the branch from a Hopf point to a cycle."""
    wave_number = WAVES_PER_ROOT_FORCE * abs(rod.F) ** 0.5
    if rod.standard:
        return mesh(1, max(LEAST_ORDER, int(ORDER_PER_WAVE * wave_number)))
    elements = arm_elements(rod, wave_number, COARSE_ACCURACY)
    return mesh_on(elements.edges, elements.order)


def near_rod(rod: Rod) -> Rod:
    """The rod; a nearby rod for a rod in a limit, which the time stepper cannot integrate."""
    return replace(rod, k1=min(rod.k1, STIFFEST), k2=min(rod.k2, STIFFEST), gamma3=max(rod.gamma3, MIN_DRAG))
