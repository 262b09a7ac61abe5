"""A time step whose Newton method diverges is repeated with a shorter step and a fresh matrix."""

import pytest

from rodsweep.discretization.beam import Beam
from rodsweep.model.material.build import Build
from rodsweep.model.material.profile import Profile
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle.transient.motion_mesh import MOTION_ACCURACY, motion_mesh
from rodsweep.solve.motion.integrator import RELAXATION, Ending, Integrator
from rodsweep.solve.motion.leading_mode import leading_mode
from rodsweep.solve.motion.time_scheme import TimeScheme

STIFF_END = Profile((0.0, 0.6, 0.6, 1.0), (*((1.0,) * 6,) * 2, *((7.0, 7.0, 7.0, 1.0, 1.0, 0.3),) * 2))
RUBBER = Rod(
    F=60.0, k1=830.0, k2=35.0, gamma3=2e-6, gamma1=1.0, build=Build("neo_hookean", "swelling", STIFF_END)
)
DURATION = 0.005


@pytest.mark.parametrize("scheme", [RELAXATION, TimeScheme("arkimex", "4", tolerance=1e-4)])
def test_run_recovers_from_a_step_whose_newton_iterates_overflow(scheme):
    """From a first step of twice the duration, the iterates at the jump of the material become infinite."""
    mesh = motion_mesh(RUBBER, MOTION_ACCURACY)
    beam = Beam(RUBBER, mesh)
    integrator = Integrator(mesh, scheme)
    run = integrator.run(beam, leading_mode(beam).z.real, DURATION, 2 * DURATION)
    failures = integrator.ts.getSNESFailures()
    integrator.destroy()
    assert failures > 0
    assert run.ending == Ending.reached
    assert run.times[-1] == pytest.approx(DURATION, rel=1e-12)
