"""The motion from a bent state that is let go, until the rod rests or beats."""

from dataclasses import replace

import numpy as np
import pytest

from rodsweep.discretization.explicit_system import ExplicitSystem
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle.limit_cycle import CycleOutcome, CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.cycle.transient.motion_mesh import motion_mesh
from rodsweep.solve.cycle.transient.shape_trace import SHAPE_TRACE_SETTINGS
from rodsweep.solve.motion.integrator import integrator
from rodsweep.solve.motion.time_scheme import TimeScheme
from rodsweep.solve.motion.tip_target import bent_state_with_tip_at

FLUTTER = Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2)
BISTABLE = Rod(F=175.0, k1=200.0, k2=1e4, gamma3=1e-4)
"""Straight and cycle are both stable: 155.6 < F < 199.2, configs/bistability.yaml."""
REQUEST = CycleRequest(1e-7, 0.01, 8, 0, 48, 33, 400, tip=(0.7, 0.5), frames=32)


def released(rod: Rod, x: float, y: float) -> CycleOutcome:
    return solve_cycle(rod, replace(REQUEST, tip=(x, y)))


def test_a_rod_that_flutters_comes_to_its_cycle_from_every_place():
    cycle = solve_cycle(FLUTTER, replace(REQUEST, tip=None, frames=0))
    for place in ((0.7, 0.5), (0.2, -0.6), (0.97, 0.01)):
        found = released(FLUTTER, *place)
        assert found.status == CycleStatus.cycle
        assert found.measures.period == pytest.approx(cycle.measures.period, rel=1e-6)
        assert found.motion_shapes.covers_whole_motion
        assert found.motion_shapes.shapes[:, 0, -1] == pytest.approx(place, abs=1e-6)


def test_a_rod_below_flutter_comes_to_rest_and_the_motion_ends_there():
    found = released(replace(FLUTTER, F=20.0), 0.7, 0.5)
    deflection = np.abs(found.motion_shapes.shapes[1])
    assert found.status == CycleStatus.straight
    assert deflection[-1].max() < 2 * SHAPE_TRACE_SETTINGS.max_tip_y_at_rest
    assert deflection[-20:].max() > SHAPE_TRACE_SETTINGS.max_tip_y_at_rest


def test_of_two_stable_states_the_place_decides():
    assert released(BISTABLE, 0.1249, 0.005).status == CycleStatus.straight
    assert released(BISTABLE, 0.05, 0.09).status == CycleStatus.cycle


def test_the_motion_is_that_of_another_time_scheme():
    system = ExplicitSystem(FLUTTER, motion_mesh(FLUTTER, 1e-5))
    motion = released(FLUTTER, 0.7, 0.5).motion_shapes
    z = bent_state_with_tip_at(system, 0.7, 0.5)
    for frame in (8, 20, 40):
        run = integrator(system.mesh, TimeScheme("bdf", "4", 1e-7)).run(
            system, z, frame * motion.time_step, 1e-8
        )
        # 1e-4 is the tolerance of the first run of a motion; errors add up over some 40 steps.
        assert motion.shapes[:, frame, -1] == pytest.approx(
            system.tip_coordinates(run.states[-1])[:2], abs=3e-3
        )


def test_a_motion_that_settles_slowly_is_stored_up_to_its_limit():
    onset = 37.0
    found = released(replace(FLUTTER, F=onset), 0.7, 0.5)
    assert found.motion_shapes.shapes.shape[1] <= SHAPE_TRACE_SETTINGS.max_stored_shapes
