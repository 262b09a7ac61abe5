"""An orbit on another mesh, in this process or another."""

import pickle

import numpy as np
import pytest

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.stress.form import StressForm
from rodsweep.model.rod import Rod
from rodsweep.solve.orbit.orbit import Orbit
from rodsweep.solve.orbit.orbit_mesh import mesh_of_orbit
from rodsweep.solve.orbit.symmetry import NO_SYMMETRY, REFLECTION


@pytest.mark.parametrize("symmetry", [NO_SYMMETRY, REFLECTION], ids=["whole period", "half period"])
def test_an_orbit_from_another_rank_is_the_same_to_the_last_bit(symmetry):
    """On its own mesh, of which the other rank has a copy, and on a finer one."""
    form = StressForm(Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2), uniform_mesh(2, 9))
    states = np.random.default_rng(0).normal(size=(1 + 4 * 3, form.unknown_count))
    orbit = Orbit.from_states(form, symmetry, 0.02, states, 3)
    sent = pickle.loads(pickle.dumps(orbit))
    own, finer = mesh_of_orbit(orbit), mesh_of_orbit(orbit).finer_mesh
    assert mesh_of_orbit(sent) == own
    assert own.interpolated_orbit(sent).values.tobytes() == orbit.values.tobytes()
    assert finer.interpolated_orbit(sent).values.tobytes() == finer.interpolated_orbit(orbit).values.tobytes()
