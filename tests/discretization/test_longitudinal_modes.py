"""Longitudinal eigenvalues of arms against closed forms, transfer matrices and integration along the arm."""

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from rodsweep.discretization.straight.longitudinal_modes import (
    longitudinal_eigenvalues,
    longitudinal_eigenvalues_and_errors,
)
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod

LAWS = (("linear", "fixed"), ("neo_hookean", "fixed"), ("neo_hookean", "swelling"))


def stepped(rng):
    """A random arm with up to four jumps, of any law."""
    rows, here = [(0.0, *np.ones(6))], np.ones(6)
    for u in np.unique(np.round(rng.uniform(0.05, 0.95, rng.integers(1, 5)), 3)):
        rows.append((u, *here))
        here = here * 10 ** rng.uniform(-1, 1, 6)
        rows.append((u, *here))
    rows.append((1.0, *here))
    u, factors = tuple(float(row[0]) for row in rows), tuple(tuple(map(float, row[1:])) for row in rows)
    law, section = LAWS[rng.integers(3)]
    k1, gamma1 = float(10 ** rng.uniform(2, 4)), float(10 ** rng.uniform(-1, 1))
    material = RodMaterial(law=law, section=section, profile=Profile(u, factors))
    return Rod(F=1e-3 * k1, k1=k1, k2=50.0, gamma3=0.1, gamma1=gamma1, material=material)


def tip_stress(rod, w):
    """K x' at the tip for x(0) = 0, K x'(0) = 1, of an arm with constant segments, in thirty digits."""
    breaks = rod.material.breaks
    here = rod.cross_sections_at((breaks[:-1] + breaks[1:]) / 2)
    stiffness = rod.material.constitutive_law.stiffness(here.nu) / here.compliance[0]
    x, stress = mpmath.mpf(0), mpmath.mpf(1)
    for length, K, drag in zip(
        np.diff(breaks).tolist(), stiffness.tolist(), here.drag[0].tolist(), strict=True
    ):
        q = mpmath.sqrt(drag * -w / K)
        c, s = mpmath.cos(q * length), mpmath.sin(q * length)
        x, stress = x * c + stress * s / (K * q), stress * c - x * K * q * s
    return stress


def test_uniform_arms_have_the_closed_form():
    linear = Rod(F=3.0, k1=100.0, k2=50.0, gamma3=0.1, gamma1=0.7)
    assert longitudinal_eigenvalues_and_errors(linear, 8)[0] == pytest.approx(
        longitudinal_eigenvalues(100.0, 0.7, 8), rel=1e-13
    )
    rubber = Rod(F=30.0, k1=100.0, k2=50.0, gamma3=0.1, material=RodMaterial(law="neo_hookean"))
    (nu,) = np.roots([1, 3 * 0.3, 0, -1])[np.isreal(np.roots([1, 0.9, 0, -1]))].real
    tangent = 100.0 * (1 + 2 / nu**3) / 3
    assert longitudinal_eigenvalues_and_errors(rubber, 3)[0] == pytest.approx(
        longitudinal_eigenvalues(tangent, 1.0, 3), rel=1e-12
    )


@pytest.mark.parametrize("seed", range(8))
def test_stepped_arms_have_the_eigenvalues_of_transfer_matrices_and_no_other(seed):
    rod = stepped(np.random.default_rng(seed))
    w, error = longitudinal_eigenvalues_and_errors(rod, 4)
    with mpmath.workdps(30):
        for value, stated in zip(w.tolist(), error.tolist(), strict=True):
            sides = (mpmath.mpf(value) * (1 + side * mpmath.mpf(10) ** -9) for side in (-1, 1))
            true = mpmath.findroot(lambda x: tip_stress(rod, x), tuple(sides), tol=1e-24)
            assert abs(float(value / true - 1)) <= stated < 1e-11
        signs = [mpmath.sign(tip_stress(rod, x)) for x in np.linspace(1e-6 * w[0], 1.0001 * w[3], 200)]
    assert np.count_nonzero(np.diff([int(sign) for sign in signs])) == 4


@pytest.mark.long
@pytest.mark.parametrize(("law", "section"), LAWS)
def test_cones_with_a_jump_have_the_eigenvalues_of_integration_along_the_arm(law, section):
    ends = ((1.0,) * 6, (1.3,) * 6, (5.0,) * 6, (20.0,) * 6)
    material = RodMaterial(law=law, section=section, profile=Profile((0.0, 0.4, 0.4, 1.0), ends))
    rod = Rod(F=30.0, k1=100.0, k2=50.0, gamma3=0.1, gamma1=0.7, taper=0.3, material=material)

    def tip(w):
        state = np.array([0.0, 1.0])
        for start, stop in ((0.0, 0.4), (0.4, 1.0)):

            def change(u, y, inside=(start + 1e-13, stop - 1e-13)):
                here = rod.cross_sections_at(np.array([np.clip(u, *inside)]))
                tangent = material.constitutive_law.stiffness(here.nu[0]) / here.compliance[0, 0]
                return [y[1] / tangent, w * here.drag[0, 0] * y[0]]

            state = solve_ivp(change, (start, stop), state, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        return state[1]

    for value in longitudinal_eigenvalues_and_errors(rod, 2)[0].tolist():
        assert brentq(tip, 1.01 * value, 0.99 * value, rtol=1e-13) == pytest.approx(value, rel=1e-10)


def test_an_inextensible_arm_is_refused():
    with pytest.raises(ValueError, match="inextensible"):
        longitudinal_eigenvalues_and_errors(Rod(F=1.0, k1=np.inf, k2=50.0, gamma3=0.1, taper=0.5), 2)
