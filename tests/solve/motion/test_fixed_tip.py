"""The rod bent with its tip at a chosen place, from which a motion starts."""

import numpy as np
import pytest

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.explicit_system import ExplicitSystem
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.motion.tip_target import TIP_TARGET_SETTINGS, bent_state_with_tip_at

RODS = {
    "flutter": Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2),
    "soft": Rod(F=20.0, k1=60.0, k2=30.0, gamma3=0.1),
    "stiff": Rod(F=0.0, k1=1e8, k2=1e8, gamma3=1e-6),
    "pulled": Rod(F=-20.0, k1=1e4, k2=1e2, gamma3=1e-2),
    "rubber": Rod(F=20.0, k1=100.0, k2=30.0, gamma3=0.1, material=RodMaterial(law="neo_hookean")),
}
EACH_ROD = pytest.mark.parametrize("rod", RODS.values(), ids=RODS)
PLACES = [(0.6, 0.2), (0.6, -0.2), (0.3, 0.0), (0.0, 0.55), (-0.3, 0.2), (0.0, 0.0), (-0.1, -0.5)]


def beam_of(rod: Rod) -> ExplicitSystem:
    return ExplicitSystem(rod, uniform_mesh(3, 8))


@EACH_ROD
@pytest.mark.parametrize("place", PLACES)
def test_the_tip_is_at_its_place(rod, place):
    system = beam_of(rod)
    assert system.tip_coordinates(bent_state_with_tip_at(system, *place))[:2] == pytest.approx(
        place, abs=1e-8
    )


@EACH_ROD
def test_stretch_and_shear_are_those_of_the_straight_rod(rod):
    system = beam_of(rod)
    held = system.strains(bent_state_with_tip_at(system, 0.4, 0.3))
    assert held[:2] == pytest.approx(system.strains(np.zeros(system.unknown_count))[:2], abs=1e-12)


@EACH_ROD
@pytest.mark.parametrize("place", [(0.5, 0.3), (-0.2, 0.4)])
def test_the_curvature_is_the_moment_of_a_force_at_the_tip(rod, place):
    """Pi = f x (r(1) - r), two numbers for the whole curve, to the accuracy of the mesh."""
    system = beam_of(rod)
    z = bent_state_with_tip_at(system, *place)
    x, y, _ = system.shape(z)
    Pi = system.strains(z)[2]
    arms = np.stack([x[-1] - x, y[-1] - y], axis=1)
    force = np.linalg.lstsq(arms, Pi, rcond=None)[0]
    assert Pi == pytest.approx(arms @ force, abs=1e-4 * np.abs(Pi).max())


def test_a_mirrored_place_gives_the_mirrored_shape():
    system = beam_of(RODS["flutter"])
    above, below = (system.shape(bent_state_with_tip_at(system, 0.5, y)) for y in (0.3, -0.3))
    assert below == pytest.approx(above * np.array([[1], [-1], [-1]]), abs=1e-9)


@EACH_ROD
def test_a_place_out_of_reach_is_drawn_towards_the_clamp(rod):
    system = beam_of(rod)
    length = system.tip_coordinates(np.zeros(system.unknown_count))[0]
    x, y = system.tip_coordinates(bent_state_with_tip_at(system, 3.0, 4.0))[:2]
    assert (x, y) == pytest.approx(
        (
            0.6 * TIP_TARGET_SETTINGS.max_clamp_distance_over_length * length,
            0.8 * TIP_TARGET_SETTINGS.max_clamp_distance_over_length * length,
        ),
        abs=1e-8,
    )
