"""Strains beside a jump of the material, and the shapes integrated with them."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from rodsweep.discretization.elements.mesh import mesh_with_edges
from rodsweep.discretization.explicit_system import ExplicitSystem
from rodsweep.discretization.stress.form import StressForm
from rodsweep.model.material.laws import LAWS
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.material.stress_strain import LocalSection, stress_minus_rest_stress
from rodsweep.model.rod import Rod

LINEAR_ARM = "linear", "fixed"
JUMP = 0.4
FACTORS = (0.6, 3.0, 0.3, 1.0, 1.0, 0.5)
STEP = Profile((0.0, JUMP, JUMP, 1.0), ((1.0,) * 6,) * 2 + (FACTORS,) * 2)
VALUES = {"F": 20.0, "k1": 100.0, "k2": 60.0, "gamma3": 0.02, "gamma1": 0.7}
FIELDS = {"n1": Polynomial([9, -20, 11]), "n2": Polynomial([-8, 3, 5]), "m3": Polynomial([1.5, -1, -0.5])}
"""Stresses that vanish at the tip."""


def arm(order, names=LINEAR_ARM, ratios=(), **values):
    grid = mesh_with_edges((0.0, JUMP, 1.0), order, ratios)
    return StressForm(Rod(**VALUES | values, material=RodMaterial(*names, STEP)), grid)


def smooth_state(form):
    u = form.mesh.node_positions
    return form.layout.state(np.array([field(u) for field in FIELDS.values()]), np.zeros((3, len(u))))


def exact_tip():
    """(x, y) of the tip of the linear arm under `FIELDS`, by Gauss quadrature on each segment."""
    points, weights = np.polynomial.legendre.leggauss(40)
    place, theta = np.zeros(2), 0.0
    for start, end, (f1, f2, f3) in ((0.0, JUMP, (1, 1, 1)), (JUMP, 1.0, FACTORS[:3])):
        u = (start + end + (end - start) * points) / 2
        bent = FIELDS["m3"].integ() / f3
        angle = theta + bent(u) - bent(start)
        h1 = 1 + (FIELDS["n1"](u) - VALUES["F"]) / (VALUES["k1"] * f1)
        h2 = FIELDS["n2"](u) / (VALUES["k2"] * f2)
        slope = h1 * [np.cos(angle), np.sin(angle)] + h2 * [-np.sin(angle), np.cos(angle)]
        place = place + slope @ weights * (end - start) / 2
        theta += bent(end) - bent(start)
    return place


@pytest.mark.parametrize("ratios", [(), (0.875, 1.0), (1.0, 0.75)])
def test_the_tip_of_an_arm_with_a_jump_is_exact_on_a_coarse_mesh(ratios):
    form = arm(8, ratios=ratios)
    x, y, _ = form.tip_coordinates(smooth_state(form))
    assert (x, y) == pytest.approx(exact_tip(), abs=1e-12)


@pytest.mark.parametrize("ratios", [(), (1.0, 0.5)])
@pytest.mark.parametrize("names", LAWS)
def test_both_sides_of_a_jump_have_one_stress_and_its_strain_on_average(names, ratios):
    form = arm(6, names, ratios)
    x = smooth_state(form)
    sides = form.element_strains(x)[:, 6:8]
    rest = form.element_strains(0 * x)[0, 6:8]
    stresses = []
    for strain, nu, factors in zip(sides.T, rest, ((1, 1, 1), FACTORS[:3]), strict=True):
        c1, c2, c3 = 1 / (np.array([VALUES["k1"], VALUES["k2"], 1.0]) * factors)
        law = form.nodal_rod.law_number
        beyond_rest = stress_minus_rest_stress(
            law, LocalSection(nu, c1, c3), (strain[0] - nu) / c1, strain[2] / c3
        )
        stresses.append([beyond_rest.N, strain[1] / c2, beyond_rest.M])
    assert stresses[0] == pytest.approx(stresses[1], rel=1e-12)
    # Lobatto's weight at an end is the length over p (p + 1).
    weights = form.mesh.lengths / [p * (p + 1) for p in form.mesh.orders]
    mean = sides @ (weights / weights.sum())
    assert mean == pytest.approx(form.strains(x)[:, 6], rel=1e-12)


@pytest.mark.parametrize("names", LAWS)
@pytest.mark.parametrize(("rigid", "ratios"), [("k1", ()), ("k2", (0.5, 1.0)), (None, (1.0, 0.75))])
def test_changes_of_strains_are_their_derivatives(names, rigid, ratios):
    form = arm(6, names, ratios, **{rigid: np.inf} if rigid else {})
    x, step = smooth_state(form), 1e-6
    change = np.random.default_rng(2).standard_normal(len(x))
    ahead, behind = (form.element_strains(x + sign * step * change) for sign in (1, -1))
    measured = (ahead - behind) / (2 * step)
    assert form.element_strain_rates(x, change) == pytest.approx(measured, abs=1e-9)


def test_an_arm_leaves_the_model_where_its_softer_side_is_crushed():
    """The mean stretch of both sides is still positive."""
    form = arm(6)
    system = ExplicitSystem(form.rod, form.mesh)
    S = np.zeros((3, form.mesh.node_count + 1))
    for pull, crushed in ((-39.0, False), (-41.0, True)):  # k1 is 60 behind the jump, and F is 20
        S[0, 6] = pull
        z = system.state_of_stresses(S)
        assert system.strains(z)[0].min() > 0
        assert (system.least_stretch(z) < 0) == crushed
        assert (z[6] <= system.crushing_z1[6]) == crushed
