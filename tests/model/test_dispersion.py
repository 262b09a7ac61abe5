"""The most amplified wave of the dispersion relation, against a search over wave numbers."""

import math

import numpy as np
import pytest

from rodsweep.determinant.arm.determinant import ArmDeterminant, coefficient_samples
from rodsweep.model.dispersion import (
    SAMPLES_PER_INTERVAL,
    largest_growth_and_wave_number,
    most_amplified_local_waves,
    sampled_arm,
)
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod


def growth_rate(rod: Rod, K: np.ndarray) -> np.ndarray:
    """Largest real part of the two roots w of the dispersion relation of the paper, Sec. VI, at every K."""
    F, nu, c2, gamma3 = rod.coefficients
    linear = (c2 + gamma3) * K + rod.g * nu
    coefficients = np.stack([np.full_like(K, gamma3 * c2), linear, K**2 - F * rod.g * K], axis=-1)
    return np.array([np.roots(each).real.max() for each in coefficients])


@pytest.mark.parametrize("seed", range(20))
def test_no_wave_grows_faster_than_the_most_amplified_wave(seed: int) -> None:
    """For random rods with F > 0 no other wave number has a larger growth rate, and the wave has its rate."""
    random = np.random.default_rng(seed)
    k1 = 10 ** random.uniform(0, 6)
    F = k1 * 10 ** random.uniform(-3, -0.01)
    rod = Rod(F=F, k1=k1, k2=10 ** random.uniform(-2, 6), gamma3=10 ** random.uniform(-8, 2))
    rate, wave_number = largest_growth_and_wave_number(rod)
    others = F * rod.g * np.linspace(1e-3, 1, 400)
    assert growth_rate(rod, np.array([wave_number**2]))[0] == pytest.approx(rate, rel=1e-6)
    assert np.all(growth_rate(rod, others) <= rate * (1 + 1e-6))


@pytest.mark.parametrize("gamma3", [0.0, 1e-6, 1e-2])
def test_growth_of_a_pulled_soft_rod_is_attained(gamma3: float) -> None:
    """A pulled rod with F < -k2, soft in shear, is unstable by shear, perhaps without a largest rate."""
    rod = Rod(F=-30.0, k1=1e4, k2=1.0, gamma3=gamma3)
    rate, wave_number = largest_growth_and_wave_number(rod)
    assert rate > 100
    assert rate == pytest.approx(growth_rate(rod, np.array([wave_number**2]))[0], rel=1e-6)


def test_rod_without_load_or_with_small_pull_has_no_growing_wave() -> None:
    for F in (0.0, -5.0):
        assert largest_growth_and_wave_number(Rod(F=F, k1=1e4, k2=1e4, gamma3=1e-4)) == (0.0, 0.0)


def test_waves_at_extreme_forces_do_not_overflow() -> None:
    """Without drag of rotation K = F g/2 exactly; c2 > 0 lowers the wave number, not its order."""
    for F in (1e100, 1e160, 1e300):
        assert largest_growth_and_wave_number(Rod(F=F, k1=math.inf, k2=math.inf, gamma3=0.0))[
            1
        ] == pytest.approx(math.sqrt(F / 2), rel=1e-12)
    assert math.isfinite(largest_growth_and_wave_number(Rod(F=1e140, k1=math.inf, k2=1e4, gamma3=1e-4))[1])


def test_local_waves_of_a_slightly_tapered_arm_are_those_of_the_uniform_rod() -> None:
    uniform = Rod(F=50.0, k1=200.0, k2=1e4, gamma3=1e-4)
    rates, wave_numbers = most_amplified_local_waves(
        Rod(F=50.0, k1=200.0, k2=1e4, gamma3=1e-4, taper=1 - 1e-9)
    )
    rate, wave_number = largest_growth_and_wave_number(uniform)
    np.testing.assert_allclose(rates, rate, rtol=1e-7)
    np.testing.assert_allclose(wave_numbers, wave_number, rtol=1e-7)


def test_one_sample_of_a_constant_segment_gives_the_integrals_of_many():
    rows = tuple((r**2, r**2, r**4, 1.0, 1.0, r**2) for r in (1.0, 1.0, 0.6, 0.6))
    almost = ((1 + 1e-12, *rows[0][1:]), *rows[1:])
    u = (0.0, 0.4, 0.4, 1.0)
    constant, varying = (
        Rod(F=14.0, k1=1e4, k2=1e2, gamma3=1e-2, material=RodMaterial(profile=Profile(u, table)))
        for table in (rows, almost)
    )
    assert len(sampled_arm(constant).points) == 2
    assert len(sampled_arm(varying).points) == 2 * SAMPLES_PER_INTERVAL
    for w in (-3e3 + 0j, 20 + 150j):
        one, many = ArmDeterminant(constant), ArmDeterminant(varying)
        assert one.mean_wave_number_bound(w) == pytest.approx(many.mean_wave_number_bound(w), rel=1e-11)
        assert one.w_scale(w) == pytest.approx(many.w_scale(w), rel=1e-11)
    # Along the taper one arm only has constant segments; its points would miss the others' variation.
    path = [constant, constant.with_values(taper=0.5)]
    assert len(coefficient_samples(path).points) == 2 * SAMPLES_PER_INTERVAL
