"""The closed form of D against independent evaluations in multiple precision, and exact limits."""

import mpmath as mp
import numpy as np
import pytest
from hard.exact import derivatives
from reference import determinant as reference
from rods import rod_of

from rodsweep.determinant.parameter_path import determinant_value_on_path
from rodsweep.determinant.roots.newton import refine_eigenvalue
from rodsweep.determinant.roots.roots import root_error_and_scales
from rodsweep.determinant.rounding_at_root import rounding_error_at_root
from rodsweep.determinant.value import (
    DETERMINANT_SETTINGS,
    root_error_w_scale_and_wave_number,
    scaled_determinant,
)
from rodsweep.model.rod import Rod


def cases():
    """Random rods and random w, far beyond where eigenvalues lie."""
    random = np.random.default_rng(7)
    for i in range(60):
        k1, k2 = (
            float(10 ** random.uniform(1.3, 12)) if random.random() > 0.15 else np.inf for _ in range(2)
        )
        gamma3 = float(random.choice([0.0, 10 ** random.uniform(-8, 0.5)]))
        F = float(random.uniform(-0.5, 0.999) * min(k1, 300.0))
        w = complex(*(random.normal(size=2) * 10 ** random.uniform(-3, 5)))
        yield pytest.param(w, Rod(F=F, k1=k1, k2=k2, gamma3=gamma3), id=str(i))


@pytest.mark.parametrize(("w", "rod"), list(cases()))
@pytest.mark.parametrize("evaluation", [reference.D, reference.D_wedge])
def test_determinant_is_right_to_rounding(w, rod, evaluation):
    value, slope, scale, noise = scaled_determinant(w, rod.coefficients)
    parameters = (rod.F, rod.k1, rod.k2, rod.gamma3)
    exact = evaluation(w, *parameters) * mp.exp(-mp.mpf(scale))
    assert abs(mp.mpc(value) - exact) < noise
    with mp.workdps(40):
        h = mp.mpf(10) ** -12 * abs(w)
        exact = (evaluation(w + h, *parameters) - evaluation(w - h, *parameters)) / (2 * h)
        assert abs(mp.mpc(slope) - exact * mp.exp(-mp.mpf(scale))) < 1e-11 * abs(slope) + 1e3 * noise / abs(w)


def at(place, *rod):
    """(w, rod) beside w = -g nu/(c2 gamma3), where P = 0; `place` is the relative distance."""
    rod = rod_of(*rod)
    return -rod.g * rod.nu / (rod.c2 * rod.gamma3) * (1 + place), rod


def hard_cases():
    """Where terms of D cancel: P = 0, M = 0, z+- = 0, strong pulls, nearly crushed rods, next to w = 0."""
    random = np.random.default_rng(11)
    for i in range(400):
        F, k1, k2, gamma3 = (float(10 ** random.uniform(*r)) for r in ((-1, 2), (2, 5), (-0.3, 4), (-4, 1.5)))
        near = 1 + 10 ** random.uniform(-16, -0.5) * np.exp(2j * np.pi * random.random())
        near = near.real if i % 3 == 0 else near
        w = complex(*(random.normal(size=2) * 10 ** random.uniform(-3, 5)))
        if i % 6 == 1:
            F = -float(10 ** random.uniform(1, 4))
        elif i % 6 == 2:
            F = k1 * (1 - float(10 ** random.uniform(-9, -1)))
        F = min(F, 0.999999 * k1)
        rod = Rod(F=F, k1=k1, k2=k2, gamma3=gamma3)
        drag, shear = rod.c2 + gamma3, rod.c2 - gamma3
        if i % 6 == 3:
            w = complex(-rod.g * rod.nu / (rod.c2 * gamma3) * near)
        elif i % 6 == 4:
            w = complex(F * rod.g / drag * near)
        elif i % 6 == 5:
            product = [shear**2, -2 * rod.g * (drag * F + 2 * rod.nu), (F * rod.g) ** 2]
            w = complex(random.choice(np.roots(product)) * near)
        elif i % 6 == 0:
            w *= 10 ** random.uniform(-14, 0)
        if scaled_determinant(w, rod.coefficients)[2] < 200:
            yield w, rod


def rounding(w, rod):
    """The error of D in units of its noise."""
    value, _, scale, noise = scaled_determinant(w, rod.coefficients)
    exact = reference.D_wedge(w, rod.F, rod.k1, rod.k2, rod.gamma3, 60) * mp.exp(-mp.mpf(scale))
    return float(abs(mp.mpc(value) - exact)) / noise


def test_the_noise_bounds_what_rounding_does_where_terms_cancel():
    errors = [rounding(w, rod) for w, rod in hard_cases()]
    assert len(errors) > 300
    assert max(errors) < 1


def test_the_rounding_error_by_derivatives_bounds_what_rounding_does():
    ratios = []
    for w, rod in [*hard_cases(), *(case.values for case in cases())]:
        _, _, scale, noise = scaled_determinant(w, rod.coefficients)
        at_root = rounding_error_at_root(w, rod.coefficients, scale)
        assert 0 < at_root < 3 * noise
        ratios.append(rounding(w, rod) * noise / at_root)
    assert max(ratios) < 1


def test_the_rounding_error_by_derivatives_is_small_at_high_modes_of_a_pulled_rod():
    """Where effects of one rounding cancel: the sum of moduli is ten times as large, or more."""
    rod = Rod(F=-8.0, k1=1e4, k2=1e2, gamma3=1e-2)
    for guess in (-14645.3, -44321.0685 + 65.8233j):
        w = refine_eigenvalue(complex(guess), rod.coefficients)
        _, _, scale, noise = scaled_determinant(w, rod.coefficients)
        assert rounding(w, rod) * noise < rounding_error_at_root(w, rod.coefficients, scale) < noise / 8


@pytest.mark.parametrize(
    ("F", "k1", "gamma3", "guess"),
    [
        (-2435.396491691431, 36.2377642702722, 0.0024668777254547563, -2.9e-173),
        (-2600.0, 33.0, 1e-3, -1e-196),
        (-2000.0, 34.0, 0.0, -3e-154),
    ],
)
def test_errors_cover_eigenvalues_whose_square_underflows(F, k1, gamma3, guess):
    rod = Rod(F=F, k1=k1, k2=np.inf, gamma3=gamma3)
    w = refine_eigenvalue(complex(guess), rod.coefficients)
    _, _, scale, noise = scaled_determinant(w, rod.coefficients)
    exact = reference.refine(mp.mpmathify(w), F, k1, np.inf, gamma3)
    difference = abs(exact - mp.mpmathify(w))
    assert difference <= root_error_and_scales(w, rod.coefficients)[0] < 1e-12 * abs(w)
    assert 0 < rounding_error_at_root(w, rod.coefficients, scale) < 3 * noise


def test_the_typical_rounding_fraction_is_typical():
    errors = [rounding(*case.values) for case in cases()]
    assert (
        DETERMINANT_SETTINGS.typical_rounding_error_over_bound / 10
        < np.median(errors)
        < DETERMINANT_SETTINGS.typical_rounding_error_over_bound
    )


PULLS_AND_PUSHES = [
    (3.0, np.inf, 2.0, 0.0563),
    (-5.0, 50.0, 20.0, 0.4),
    (30.0, 1e4, 1e4, 3.0),
    (5.0, 1e4, 10.0, 0.1),
]


@pytest.mark.parametrize("place", [0.0, 1e-15, -1e-12, 1e-8, 1e-5j, -1e-2])
@pytest.mark.parametrize("rod", PULLS_AND_PUSHES, ids=str)
def test_nothing_is_lost_where_exponents_vanish(rod, place):
    """D and all of its derivatives, at P = 0 and beside it, where the slopes of z+ and z- are infinite."""
    w, known = complex(at(place, *rod)[0]), rod_of(*rod)
    exact = derivatives(w, rod, ("w", "F", "c1", "c2", "gamma3"))
    for name, along in zip(("F", "k1", "k2", "gamma3"), exact[1:], strict=True):
        found = determinant_value_on_path(w, known.coefficients, known.coefficient_derivative(name))
        size = mp.exp(-mp.mpf(found[3]))
        assert abs(mp.mpc(found[0]) - reference.D(w, *rod, digits=40) * size) < min(found[4], 1e-12)
        assert abs(mp.mpc(found[1]) - exact[0] * size) < 1e-12 * abs(found[1])
        assert abs(mp.mpc(found[2]) - along * size) < 1e-12 * abs(found[2])


def test_the_length_of_newtons_correction_does_not_shrink_where_exponents_vanish():
    for rod in PULLS_AND_PUSHES:
        beside, there = (
            root_error_w_scale_and_wave_number(complex(at(d, *rod)[0]), rod_of(*rod).coefficients)[1]
            for d in (0.3, 1e-14)
        )
        assert there > beside / 10


def test_determinant_is_one_at_rest():
    """D(0) = 1 for every rod: there is no static instability (a follower force never buckles a rod)."""
    for rod in (
        Rod(F=30, k1=1e4, k2=1e4, gamma3=1e-4),
        Rod(F=-50, k1=100, k2=20, gamma3=0.0),
        Rod(F=30, k1=np.inf, k2=np.inf, gamma3=0.0),
    ):
        assert scaled_determinant(0j, rod.coefficients)[0] == pytest.approx(
            np.exp(-scaled_determinant(0j, rod.coefficients)[2]), rel=1e-12
        )


def test_filament_roots_are_those_of_the_cantilever():
    """F = 0, rigid in stretch and shear: w = -b^4 with cosh b cos b = -1, the clamped-free system."""
    rod = Rod(F=0.0, k1=np.inf, k2=np.inf, gamma3=0.0)
    for n in range(1, 5):
        b = mp.findroot(lambda b: mp.cosh(b) * mp.cos(b) + 1, (n - 0.5) * mp.pi)
        w = float(-(b**4))
        assert root_error_w_scale_and_wave_number(complex(w), rod.coefficients)[0] < 1e-13 * abs(w)


def test_newton_correction_is_the_distance_to_the_root():
    rod = Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4)
    root = complex(reference.refine(mp.mpc(-54.3, 145.7), 30, 1e4, 1e4, 1e-4))
    for distance in (1e-3, 1e-6j, 1e-9 - 1e-9j):
        found = root_error_w_scale_and_wave_number(root + distance, rod.coefficients)[0]
        assert found == pytest.approx(abs(distance), rel=1e-2)
