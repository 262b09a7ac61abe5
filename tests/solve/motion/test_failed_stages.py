"""A time step whose Newton method diverges is repeated with a shorter step and a fresh matrix."""

import numpy as np
import pytest

from rodsweep.discretization.explicit_system import ExplicitSystem
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle.cycle_outcome import CycleRequest
from rodsweep.solve.cycle.limit_cycle import solve_cycle
from rodsweep.solve.cycle.status import CycleStatus
from rodsweep.solve.cycle.transient.motion_mesh import MOTION_MESH_SETTINGS, motion_mesh
from rodsweep.solve.motion.integrator import RELAXATION_SCHEME, EndReason, Integrator
from rodsweep.solve.motion.leading_mode import leading_mode
from rodsweep.solve.motion.time_scheme import TimeScheme

STIFF_END = Profile((0.0, 0.6, 0.6, 1.0), (*((1.0,) * 6,) * 2, *((7.0, 7.0, 7.0, 1.0, 1.0, 0.3),) * 2))
RUBBER = Rod(
    F=60.0,
    k1=830.0,
    k2=35.0,
    gamma3=2e-6,
    gamma1=1.0,
    material=RodMaterial("neo_hookean", "swelling", STIFF_END),
)
DURATION = 0.005


@pytest.mark.parametrize("scheme", [RELAXATION_SCHEME, TimeScheme("arkimex", "4", tolerance=1e-4)])
def test_run_recovers_from_a_step_whose_newton_iterates_overflow(scheme):
    """From a first step of twice the duration, the iterates at the jump of the material become infinite."""
    mesh = motion_mesh(RUBBER, MOTION_MESH_SETTINGS.accuracy)
    system = ExplicitSystem(RUBBER, mesh)
    integrator = Integrator(mesh, scheme)
    run = integrator.run(system, leading_mode(system).mode.real, DURATION, 2 * DURATION)
    failures = integrator.ts.getSNESFailures()
    integrator.destroy()
    assert failures > 0
    assert run.end_reason == EndReason.reached
    assert run.times[-1] == pytest.approx(DURATION, rel=1e-12)


def moved_energy(system, z, pull, moment):
    """The energy of the state z with other stretching and bending of its fourth node."""
    state = z.copy()
    system.layout.stress_field(state, "n1")[3] += pull
    system.layout.stress_field(state, "m3")[3] += moment
    return float(system.elastic_energy(state))


def test_energy_of_a_section_is_convex_where_the_hessian_by_differences_is_positive():
    """The energy of states with one bent node each, by central differences in its stretch and bending."""
    system = ExplicitSystem(RUBBER, motion_mesh(RUBBER, MOTION_MESH_SETTINGS.accuracy))
    h, verdicts = 1e-3, []
    for bending in (1.0, 10.0, 14.0, 17.0, 20.0, 30.0):
        z = np.zeros(system.unknown_count)
        system.layout.stress_field(z, "m3")[3] = bending
        U = {(i, j): moved_energy(system, z, i * h, j * h) for i in (-1, 0, 1) for j in (-1, 0, 1)}
        a = U[1, 0] - 2 * U[0, 0] + U[-1, 0]
        b = U[0, 1] - 2 * U[0, 0] + U[0, -1]
        c = (U[1, 1] - U[1, -1] - U[-1, 1] + U[-1, -1]) / 4
        assert system.has_convex_energy(z) == (a > 0 and a * b > c * c)
        verdicts.append(system.has_convex_energy(z))
    assert verdicts[0] and not verdicts[-1]


@pytest.mark.parametrize("step", range(8))
def test_rubber_that_loses_its_stiffness_leaves_the_model(step):
    """At forces that differ by rounding errors only: the last accepted state may be convex or not."""
    soft_end = (0.2267, 7.722, 0.1047, 1.0, 1.0, 2.409)
    profile = Profile((0.0, 0.283, 0.283, 1.0), ((1.0,) * 6, (1.0,) * 6, soft_end, soft_end))
    material = RodMaterial("neo_hookean", "swelling", profile)
    F = 81.05 * (1 + step * 1e-13)
    rod = Rod(F=F, k1=222.81, k2=9.0225, gamma3=3.95e-5, gamma1=1.0, material=material)
    cycle = solve_cycle(rod, CycleRequest(1e-6, 0.1, 1, 0, 0, 0, 400))
    assert cycle.status == CycleStatus.left_the_model
    assert "not convex" in cycle.message
