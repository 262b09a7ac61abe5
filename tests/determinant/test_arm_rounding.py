"""Errors of eigenvalues close to crushing, where minors are large in the middle of an arm."""

import math

import numpy as np
import pytest
from surveyed import RODS

from rodsweep.determinant.arm.arm_family import interpolated_family
from rodsweep.determinant.arm.arm_family_values import eigenvalue_of_family_arm
from rodsweep.determinant.arm.determinant import ArmDeterminant, coefficient_samples, elements_for
from rodsweep.determinant.arm.elements.settings import ARM_ELEMENT_SETTINGS
from rodsweep.determinant.arm.rounding import rounding_error_from_propagators
from rodsweep.determinant.arm.value import determinant_from_propagators
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.spectrum.search import SpectrumRequest, SpectrumStatus, solve_spectrum

CLOSE_PAIR = Rod(
    F=116.98506875,
    k1=109.83750492645562,
    k2=7.02,
    gamma3=0.21681568646611862,
    material=RodMaterial(
        profile=Profile(
            (0.0, 1.0),
            (
                (1.4726647073144412, 1.0, 1.0, 1.0, 1.0, 1.0),
                (1.116211212073014, 1, 1, 1, 1.2836789734528988, 1),
            ),
        )
    ),
)
"""Crushed at F = 122.6; two leading real eigenvalues are 0.49 apart at 2552."""

THIN_CONES = {
    "a thousandth below crushing, high modes": (
        Rod(
            F=4.851994585748762,
            k1=6748.341426961149,
            k2=2623.35568299453,
            gamma3=5.60231613826886e-05,
            taper=0.02681403817693805,
        ),
        12,
    ),
    "pulled": (
        Rod(
            F=-1.1921683365447857,
            k1=10894.065482652612,
            k2=40081.66693612231,
            gamma3=0.03686913377416974,
            taper=0.025089721504858123,
        ),
        4,
    ),
    "rubber without rotational drag": (
        Rod(
            F=-0.1387033375053797,
            k1=24.7697815807116,
            k2=17.044865060202163,
            gamma3=0.0,
            taper=0.016978966831355653,
            material=RodMaterial("neo_hookean"),
        ),
        2,
    ),
}
"""Cones, and numbers of modes. Their local exponents grow several times over the last thirtieth of the
length; on elements that did not follow, eigenvalues were wrong by 4, 97 and 1e12 times their estimates."""


def nearly_crushed(rng):
    """An arm of two to four smooth parts, close to the force that crushes its weakest section."""
    rows = int(rng.integers(2, 5))
    factors = 10 ** rng.uniform(-0.5, 0.5, rows)
    u = (0.0, *np.sort(rng.uniform(0.1, 0.9, rows - 2)).tolist(), 1.0)
    k1 = 10 ** rng.uniform(1.5, 2.5)
    return Rod(
        F=k1 * factors.min() * (1 - 10 ** rng.uniform(-4, -0.5)),
        k1=k1,
        k2=k1 * 10 ** rng.uniform(-3, 0.5),
        gamma3=float(rng.choice([0.0, 10 ** rng.uniform(-6, -0.5)])),
        material=RodMaterial(
            profile=Profile(u, tuple((f, f, f * f, 1.0, 1.0, 1.0) for f in factors.tolist()))
        ),
    )


def refined(w, determinant, factor):
    """The eigenvalue near w on the elements for a multiple of |w|."""
    for _ in range(6):
        value = determinant.value_on_finer_elements(w, factor)
        step = value.D / value.D_w
        w -= complex(step.real, 0.0) if w.imag == 0 else step
    return w


def leading(rod):
    found = solve_spectrum(rod, SpectrumRequest(4, 1e-6, certify=True))
    if found.status != SpectrumStatus.ok:
        return []
    pairs = zip(found.eigenvalues.tolist(), found.error_estimate.tolist(), strict=True)
    return [(w, error) for w, error in pairs if w.imag >= 0]


@pytest.mark.parametrize("seed", range(RODS // 5 or 10))
def test_eigenvalues_close_to_crushing_are_within_their_errors(seed):
    rod = nearly_crushed(np.random.default_rng([77, seed]))
    determinant = ArmDeterminant(rod)
    for w, error in leading(rod):
        for factor in (1.4, 2.2, 3.5):
            assert abs(refined(w, determinant, factor) - w) <= 2 * error, (rod, rod.material)


def test_two_close_eigenvalues_have_larger_errors_than_the_products_at_the_tip():
    determinant = ArmDeterminant(CLOSE_PAIR)
    pair = [(w, error) for w, error in leading(CLOSE_PAIR) if 2551 < w.real < 2553]
    assert len(pair) == 2
    for w, error in pair:
        W, polynomials = determinant.propagators_for(abs(w))
        value = determinant_from_propagators(w, W, polynomials)
        assert rounding_error_from_propagators(w, W, polynomials, value.log_scale) > 20 * value.rounding_error
        spread = [abs(refined(w, determinant, factor) - w) for factor in (1.4, 2.2, 3.5)]
        assert 1e-12 < max(spread) <= 2 * error < 1e-8


def test_eigenvalues_of_families_close_to_crushing_are_within_their_errors():
    path = ParameterPath(CLOSE_PAIR, "F")
    family = interpolated_family(path, 110.0, 117.0, 6000.0)
    for F in (112.3, 115.1, CLOSE_PAIR.F):
        determinant = ArmDeterminant(path.rod_at(F))
        for guess, _ in leading(path.rod_at(F)):
            w, _, error = eigenvalue_of_family_arm(family, guess, F)
            assert abs(w - refined(guess, determinant, 2.2)) <= 2 * error


def test_the_rounding_error_does_not_depend_on_the_scale():
    determinant = ArmDeterminant(CLOSE_PAIR)
    W, polynomials = determinant.propagators_for(3000.0)
    one, other = (rounding_error_from_propagators(2500.0 + 10j, W, polynomials, S) for S in (0.0, 5.0))
    assert one == pytest.approx(other * math.exp(5.0), rel=1e-12)


def thin_cone(rng):
    """A cone of taper 0.015 to 0.1 of any material, pulled, pushed or close to crushing."""
    taper = 10 ** rng.uniform(math.log10(0.015), -1)
    k1 = 10 ** rng.uniform(1.2, 3.5)
    crushing = k1 * taper**2 * (1 - 10 ** rng.uniform(-5, -0.2))
    forces = (crushing, -(10 ** rng.uniform(0, 2)) * 10 * taper**2, 10 ** rng.uniform(0, 2) * taper**3)
    law = [("linear", "fixed"), ("neo_hookean", "fixed"), ("neo_hookean", "swelling")][rng.integers(3)]
    return Rod(
        F=min(crushing, 150.0, forces[rng.integers(3)]),
        k1=k1,
        k2=10 ** rng.uniform(0.5, 6),
        gamma3=float(rng.choice([0.0, 10 ** rng.uniform(-6, 0.3)])),
        taper=taper,
        material=RodMaterial(*law),
    )


def assert_within_errors(rod, modes):
    """Each leading eigenvalue of `rod` is that of much shorter elements, within its error estimate."""
    determinant = ArmDeterminant(rod)
    found = solve_spectrum(rod, SpectrumRequest(modes, 1e-8, certify=False))
    assert found.status == SpectrumStatus.ok
    for w, error in zip(found.eigenvalues.tolist(), found.error_estimate.tolist(), strict=True):
        if w.imag >= 0:
            assert error < 1e-11 * abs(w)
            # Elements for 300 |w| are at most a quarter as long, and the tip's a tenth.
            assert abs(refined(w, determinant, 300.0) - w) <= error, (rod, w)


@pytest.mark.parametrize("name", THIN_CONES)
def test_eigenvalues_of_thin_cones_are_within_their_errors(name):
    assert_within_errors(*THIN_CONES[name])


@pytest.mark.parametrize("seed", range(RODS // 5 or 10))
def test_eigenvalues_of_random_thin_cones_are_within_their_errors(seed):
    assert_within_errors(thin_cone(np.random.default_rng([78, seed])), 3)


@pytest.mark.parametrize("name", THIN_CONES)
def test_no_exponent_of_an_element_exceeds_its_limit(name):
    rod, _ = THIN_CONES[name]
    for W in (16.0, 1e4, 1e7):
        elements = elements_for([rod], coefficient_samples([rod]), W)
        nu, c2, c3, gamma2, gamma3, g = elements.local_coefficients[:, 0]
        squares = (c2 * gamma2 + c3 * gamma3) * W + abs(rod.F * c3 * g)
        squares += 2 * np.sqrt(W * abs(g * nu * gamma2 * c3) + W**2 * c2 * c3 * gamma2 * gamma3)
        _, weights = np.polynomial.legendre.leggauss(squares.shape[1])
        exponents = np.sqrt(squares) @ weights / 2 * elements.lengths
        limit = ARM_ELEMENT_SETTINGS.max_exponent_excess_factor * ARM_ELEMENT_SETTINGS.max_exponent
        assert exponents.max() <= limit * (1 + 1e-12)
