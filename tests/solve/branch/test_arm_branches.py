"""Branches of cycles of arms with jumps of the material."""

import numpy as np
import pytest

from rodsweep.discretization.elements.mesh import mesh_with_edges
from rodsweep.discretization.stress.form import StressForm
from rodsweep.model.material.laws import LAWS
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.bordered.scale import deflection_at_time_zero
from rodsweep.solve.orbit.orbit import Orbit
from rodsweep.solve.orbit.symmetry import REFLECTION

JUMP = 0.4
SOFTER = 0.3
STEP = Profile((0.0, JUMP, JUMP, 1.0), ((1.0,) * 6,) * 2 + ((1.0, 1.0, SOFTER, 1.0, 1.0, 1.0),) * 2)


@pytest.mark.parametrize("order", [5, 12])
@pytest.mark.parametrize("names", LAWS)
def test_the_deflection_of_a_shape_does_not_depend_on_the_mesh(order, names):
    """Where m3 jumps, branches of rubber arms stopped as soon as its mean limited their accuracy."""
    rod = Rod(F=20.0, k1=300.0, k2=150.0, gamma3=0.02, taper=0.7, material=RodMaterial(*names, STEP))
    form = StressForm(rod, mesh_with_edges((0.0, JUMP, 1.0), order))
    u = form.mesh.node_positions
    before, behind = 2 - u, 1.5 * (1 - u)
    m3 = np.where(u < JUMP, before, behind)
    bent = form.mesh.lengths * [before[order], behind[order] / SOFTER]
    m3[order] = bent.sum() / (form.mesh.lengths @ [1, 1 / SOFTER])
    x = form.layout.state_with_stresses({"m3": m3[:-1]})
    orbit = Orbit.from_states(form, REFLECTION, 1.0, np.array([x] * 7), 3)
    exact = 2 * JUMP - 1.5 * JUMP**2 + JUMP**3 / 3 + 0.5 * (1 - JUMP) ** 3 / SOFTER
    assert deflection_at_time_zero(orbit) == pytest.approx(exact, rel=1e-13)
