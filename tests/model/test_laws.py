"""Every constitutive law: derivatives against differences, and the straight state against the stress."""

import numpy as np
import pytest

from rodsweep.model.material.laws import LAWS, law_of
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Crushed, NotUniform, Rod

STRETCHES = np.array([0.2, 0.55, 0.9, 1.0, 1.3, 2.5])
EVERY_LAW = pytest.mark.parametrize("law", LAWS.values(), ids=["-".join(key) for key in LAWS])


def slope(function, h, step=1e-4):
    """The derivative by a difference of fourth order."""
    near, far = function(h + step) - function(h - step), function(h + 2 * step) - function(h - 2 * step)
    return (8 * near - far) / (12 * step)


@EVERY_LAW
def test_derivatives_of_the_energy(law):
    np.testing.assert_allclose(
        law.stress(STRETCHES),
        slope(lambda h: law.energy_over_squared_strain(h) * (h - 1) ** 2, STRETCHES),
        rtol=1e-8,
        atol=1e-10,
    )
    np.testing.assert_allclose(law.stiffness(STRETCHES), slope(law.stress, STRETCHES), rtol=1e-8)
    np.testing.assert_allclose(
        law.bending_factor_slope(STRETCHES), slope(law.bending_factor, STRETCHES), rtol=1e-8, atol=1e-10
    )


@EVERY_LAW
def test_stiffnesses_keep_their_meaning_in_the_undeformed_rod(law):
    one = np.ones(1)
    assert law.stress(one) == 0
    assert law.stiffness(one) == law.bending_factor(one) == 1


@EVERY_LAW
def test_straight_state_carries_the_load(law):
    load = np.array([-30.0, -0.3, -1e-9, 1e-12, 1e-5, 0.4, 0.9, 3.0, 1e4])
    load = load[load < law.crushing_load]
    shortening = law.shortening(load)
    np.testing.assert_allclose(law.stress(1 - shortening), -load, rtol=1e-9, atol=1e-15)
    small = np.abs(load) < 1e-8
    np.testing.assert_allclose(shortening[small], load[small], rtol=3e-9)


@EVERY_LAW
def test_bending_factor_does_not_grow_under_stretch(law):
    """Bounds of coefficients over an element are taken at its ends."""
    assert (law.bending_factor_slope(np.linspace(0.05, 5, 200)) <= 0).all()


def test_unknown_laws_are_refused():
    with pytest.raises(ValueError, match="law = hooke is not known; it must be linear or"):
        law_of("hooke", "fixed")
    with pytest.raises(
        ValueError, match="section = swelling is not known for law = linear; it must be fixed"
    ):
        law_of("linear", "swelling")


def test_only_the_linear_material_is_crushed():
    """A cone of linear material is crushed where it is thinnest; rubber carries any force."""
    arm = {"k1": 100.0, "k2": 50.0, "gamma3": 0.01}
    with pytest.raises(Crushed, match="not below the crushing force 25$"):
        Rod(F=25.0, **arm, taper=0.5)
    assert Rod(F=24.0, **arm, taper=0.5).crushing_force == 25
    assert Rod(F=1000.0, **arm, taper=0.5, material=RodMaterial(law="neo_hookean")).crushing_force == np.inf


def test_an_arm_that_varies_states_no_constant_coefficients():
    with pytest.raises(NotUniform):
        _ = Rod(F=1.0, k1=100.0, k2=50.0, gamma3=0.01, taper=0.5).coefficients


def test_a_rod_elsewhere_keeps_its_build():
    rod = Rod(F=1.0, k1=100.0, k2=50.0, gamma3=0.01, taper=0.5, material=RodMaterial(law="neo_hookean"))
    assert (
        rod.with_values(F=2.0).material
        == rod.with_coordinate("k1", 0.0).material
        == rod.without_nonlinear_parameters.material
        == rod.material
    )


@pytest.mark.parametrize("taper", [0.5, 1.0, 1.3])
def test_the_relative_load_is_1_where_the_weakest_section_is_crushed(taper):
    at_base = {"k1": 170.0, "k2": 1e4, "gamma3": 1e-4, "taper": taper}
    crushing = 170.0 * min(taper, 1.0) ** 2
    for share in (0.5, 0.999):
        rod = Rod(F=share * crushing, **at_base)
        assert rod.material.force_over_crushing_force(rod.F, rod.k1, rod.taper) == pytest.approx(
            share, rel=1e-12
        )
    with pytest.raises(Crushed):
        Rod(F=1.001 * crushing, **at_base)
    rubber = Rod(F=3 * crushing, **at_base, material=RodMaterial("neo_hookean"))
    assert rubber.material.force_over_crushing_force(rubber.F, rubber.k1, rubber.taper) == 0


@pytest.mark.parametrize("section", ["fixed", "swelling"])
@pytest.mark.parametrize("pull", [1e2, 1e6, 1.1e6, 1e60, 1e103, 1e200])
def test_the_stretch_of_strongly_pulled_rubber_has_all_digits(section, pull):
    # nu^3 - 3 |x| nu^2 = 1, so nu = 3 |x| + 1/nu^2
    shortening = law_of("neo_hookean", section).shortening(-pull)
    assert 1 - shortening == pytest.approx(3 * pull + 1 / (9 * pull) / pull, rel=1e-13)


def test_rubber_has_nearly_all_digits_up_to_its_largest_load():
    law = law_of("neo_hookean", "fixed")
    nu = 1 - law.shortening(law.largest_accurate_load)
    # 3 x nu^2 = 1 - nu^3: the residual over its slope is the error of nu
    error = (1 - nu**3 - 3 * law.largest_accurate_load * nu**2) / (6 * law.largest_accurate_load * nu)
    assert abs(error) < 1e-14 * nu
