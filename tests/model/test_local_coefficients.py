"""Local coefficients in compiled code against those of NumPy."""

import numpy as np
import pytest

from rodsweep.model.local_coefficients import local_coefficient_array
from rodsweep.model.material.laws import LAWS
from rodsweep.model.material.profile import FACTOR_NAMES, Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod

PROFILE = Profile(
    (0.0, 0.3, 0.3, 1.0), ((1.0,) * len(FACTOR_NAMES), (1.2, 0.8, 1.1, 1.0, 1.3, 2.0)) + ((0.5,) * 6,) * 2
)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("taper", [1.0, 0.2, 3.0])
def test_compiled_coefficients_equal_those_of_the_material(law, taper):
    material = RodMaterial(*law, PROFILE)
    rods = [
        Rod(F=F, k1=k1, k2=40.0, gamma3=0.02, taper=taper, material=material)
        for F, k1 in ((0.0, 10.0), (1e-9, 10.0), (0.15, 10.0), (-3.0, 0.1), (-1e8, 0.1), (0.3, np.inf))
    ]
    if law[0] != "linear":  # beyond the load at which the cubic equation for nu has three real roots
        rods.append(Rod(F=40.0, k1=10.0, k2=40.0, gamma3=0.02, taper=taper, material=material))
    u = np.linspace(0.01, 0.99, 24).reshape(4, 6)
    remainder = np.full(u.shape, 1e-18)
    found = local_coefficient_array(rods, u, remainder)
    assert found.shape == (6, len(rods), *u.shape)
    exact = np.array([rod.local_coefficients(u, remainder) for rod in rods]).swapaxes(0, 1)
    np.testing.assert_allclose(found, exact, rtol=0 if law[0] == "linear" else 4e-15)
