"""Cycles by time integration alone: against those of collocation, and how points end that have none."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from rods import rod_of
from surveyed import RODS

from rodsweep.discretization.elements.trigonometric import time_derivative
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle.by_integration import solve_by_integration
from rodsweep.solve.cycle.limit_cycle import CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.cycle.settled_motion import ReturnDistances
from rodsweep.solve.cycle.status import IntegratedCycleStatus
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum

ACCURACY = 1e-5
MOST_NOT_SETTLED = 0.15
"""Share of random rods whose motion settles too slowly for the returns allowed: 4 of 60 were seen."""
RETURNS = 400 if RODS else 60
"""Returns of the tip allowed: one of three rods has not settled after 400, which takes seconds."""


def request(accuracy, samples=0, shapes=0, nodes=0, most_periods=400):
    return CycleRequest(accuracy, 0.05, 5, samples, shapes, nodes, most_periods)


def random_rods(count):
    rng = np.random.default_rng(11)
    for _ in range(count):
        k1, k2, gamma3, gamma1 = 10 ** rng.uniform((2.2, 1.3, -4, -0.5), (4, 4, -1, 1))
        yield Rod(F=rng.uniform(40, min(0.9 * k1, 160)), k1=k1, k2=k2, gamma3=gamma3, gamma1=gamma1)


@cache
def pairs():
    """(cycle by collocation, cycle by integration) of random rods."""
    return [
        (
            solve_cycle(rod, request(1e-8)),
            solve_by_integration(rod, request(ACCURACY, most_periods=RETURNS)),
        )
        for rod in random_rods(RODS // 5 or 3)
    ]


@pytest.mark.long
def test_cycles_are_those_of_collocation_within_their_errors():
    assert any(other.status == IntegratedCycleStatus.cycle for _, other in pairs())
    for one, other in pairs():
        if other.status != IntegratedCycleStatus.cycle:
            continue
        assert one.status == CycleStatus.cycle
        a, b, errors = one.measures, other.measures, other.errors
        assert abs(b.period / a.period - 1) <= errors.period_error <= ACCURACY
        assert abs(b.tip_y_max / a.tip_y_max - 1) <= errors.amplitude_error <= ACCURACY
        for name in ("tip_x_min", "tip_x_max", "tip_y_min", "tip_theta_max"):
            off = abs(getattr(a, name) - getattr(b, name))
            assert off <= (errors.extrema_error + one.errors.extrema_error) * a.tip_y_max, name
        assert b.harmonic_amplitude == pytest.approx(a.harmonic_amplitude, abs=10 * ACCURACY)
        assert b.injection_mean == pytest.approx(a.injection_mean, rel=10 * ACCURACY)
        assert np.isnan(other.multiplier)


def test_a_motion_that_ends_otherwise_ends_so_by_collocation_too():
    """But for motions that settle too slowly to be waited for."""
    slow = 0
    for one, other in pairs():
        if other.status == IntegratedCycleStatus.not_settled:
            slow += 1
        elif other.status != IntegratedCycleStatus.cycle:
            assert other.status.name == one.status.name, (one, other)
    assert slow <= MOST_NOT_SETTLED * len(pairs()) + 1


def test_a_straight_rod_stays_straight():
    rod = Rod(F=20.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0)
    found = solve_by_integration(rod, request(ACCURACY))
    assert (found.status, found.message) == (
        IntegratedCycleStatus.straight,
        "the motion has decayed to rounding error",
    )
    assert np.isnan(found.measures.period)


def test_a_motion_beside_the_hopf_point_is_not_called_a_cycle_before_it_has_settled():
    """F** = 27.43: here it needs some thousands of returns."""
    rod = Rod(F=27.45, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0)
    found = solve_by_integration(rod, request(1e-6, most_periods=60))
    assert found.status == IntegratedCycleStatus.not_settled
    assert "returns of the tip the state still differs by a relative" in found.message


def test_a_tip_that_does_not_return_has_a_reason_in_words():
    """A pull beyond the shear stiffness bends the rod for good."""
    rod = Rod(F=-20.0, k1=150.0, k2=10.0, gamma3=0.0)
    found = solve_by_integration(rod, request(1e-3, most_periods=20))
    assert found.status == IntegratedCycleStatus.not_settled
    assert re.fullmatch(r"the tip returned to theta = 0 only \d times?, so no period is known", found.message)


def test_a_crushed_rod_leaves_the_model():
    found = solve_by_integration(
        Rod(F=195.0, k1=200.0, k2=1e4, gamma3=1e-4), replace(request(ACCURACY, most_periods=9), amplitude=0.5)
    )
    assert found.status == IntegratedCycleStatus.left_the_model


@pytest.mark.parametrize("rod", [(np.inf, np.inf, 0.0), (np.inf, 300.0, 1e-3), (400.0, np.inf, 1e-3)])
def test_a_rod_in_a_limit_states_what_the_rod_near_it_is_off_by(rod):
    point = rod_of(60.0, *rod, 1.0)
    one, other = solve_cycle(point, request(1e-8)), solve_by_integration(point, request(1e-4))
    assert (one.status.name, other.status.name) == ("cycle", "cycle")
    assert abs(other.measures.period / one.measures.period - 1) <= other.errors.period_error
    assert abs(other.measures.tip_y_max / one.measures.tip_y_max - 1) <= other.errors.amplitude_error


def test_samples_and_shapes_are_those_of_collocation():
    rod, asked = (
        Rod(F=40.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0),
        {"samples": 16, "shapes": 4, "nodes": 9},
    )
    one, other = solve_cycle(rod, request(1e-8, **asked)), solve_by_integration(rod, request(1e-6, **asked))
    assert other.tip == pytest.approx(one.tip, abs=1e-5)
    assert other.shape == pytest.approx(one.shape, abs=1e-5)


def test_the_energy_changes_by_what_is_injected_and_lost_also_at_low_accuracy():
    """A cubic between the 20 time steps that settle the motion was off by 2 %."""
    found = solve_by_integration(
        Rod(F=45.0, k1=2000.0, k2=1000.0, gamma3=1e-5, gamma1=0.57), request(2e-3, samples=48)
    )
    U, injection, dissipation = found.energy_and_powers
    rate = time_derivative(U) / found.measures.period
    assert rate == pytest.approx(injection - dissipation, abs=1e-3 * np.ptp(rate))


@pytest.mark.parametrize("k1", [448.955, np.inf])
def test_the_straight_rod_beside_a_motion_is_not_that_of_its_mesh(k1):
    rod = Rod(F=60.0, k1=k1, k2=193.709, gamma3=5e-4)
    exact = solve_spectrum(rod, SpectrumRequest(1, 1e-12, True)).eigenvalues[0]
    found = solve_by_integration(rod, request(1e-3))
    assert complex(found.linear_growth_rate, found.linear_frequency) == pytest.approx(exact, rel=1e-9)


def arm_with_jump(u, tip_gamma2=1.0, tip_gamma3=1.0, **parameters):
    """An arm whose drags jump at u, with factors 1 before the jump."""
    base, tip = (1.0,) * 6, (1.0,) * 4 + (tip_gamma2, tip_gamma3)
    return Rod(
        material=RodMaterial("linear", "fixed", Profile((0.0, u, u, 1.0), (base, base, tip, tip))),
        **parameters,
    )


def test_a_cycle_may_be_much_longer_than_the_time_constant_of_a_mode_that_does_not_oscillate():
    """Twenty times here: runs of so many time constants ended before the next return of the tip."""
    rod = arm_with_jump(0.5, tip_gamma3=20.0, F=30.0, k1=1e3, k2=30.0, gamma3=0.05)
    one, other = solve_cycle(rod, request(1e-4)), solve_by_integration(rod, request(1e-3))
    assert other.linear_frequency == 0
    assert one.measures.period * other.linear_growth_rate > 15
    assert (one.status, other.status) == (CycleStatus.cycle, IntegratedCycleStatus.cycle)
    assert abs(other.measures.period / one.measures.period - 1) <= (
        one.errors.period_error + other.errors.period_error
    )


def test_a_mode_with_the_tip_almost_at_rest_starts_a_small_motion():
    """At this force the tip of the mode moves by 1/2000 of the largest deflection."""
    rod = arm_with_jump(0.75, tip_gamma2=5.0, F=30.0, k1=1e3, k2=30.0, gamma3=0.01)
    found = solve_cycle(rod, replace(request(1e-3), amplitude=0.01))
    assert found.status == CycleStatus.cycle


def rates_of(distances):
    """Contraction rate after each of the tests with these distances, with a noise of 1e-3."""
    seen = ReturnDistances(1e-4)
    rates = []
    for distance in distances:
        seen.record_distance(distance, 0.2)
        rates.append(seen.contraction_rate)
    return rates


def test_distances_that_stay_below_the_noise_show_that_the_motion_has_settled():
    """The first distance was hardly above the noise, and its quotient with the noise was kept for good."""
    assert rates_of([1.05e-3] + [8e-5] * 4)[1:] == pytest.approx([0.99, 0.99, 0.842, 0.842], abs=1e-3)
    slow = [1.05e-3 * 0.998**k for k in range(200)]
    assert min(rates_of(slow)) >= 0.998**0.2


@pytest.mark.parametrize("amplitude", [0.01, 0.5])
def test_distances_that_are_integration_errors_do_not_keep_a_motion_from_settling(amplitude):
    """The distances of returns stayed at 2e-4 and at 1e-3 with a local tolerance of 1e-4, for 200 returns."""
    rod = rod_of(60.0, 1e4, 1e4, 1e-2, 1.0)
    one = solve_cycle(rod, request(1e-8))
    other = solve_by_integration(rod, replace(request(1e-2, most_periods=60), amplitude=amplitude))
    assert other.status == IntegratedCycleStatus.cycle
    assert abs(other.measures.period / one.measures.period - 1) <= other.errors.period_error


def test_a_motion_that_settles_fast_is_settled_at_low_accuracy():
    """After 400 returns, each 8e-5 from the one before, the motion was said not to repeat."""
    base, tip = (1.0, 1.0, 3.51, 1.0, 1.0, 1.0), (3.51, 1.0, 4.21, 1.0, 0.196, 1.11)
    material = RodMaterial(
        "neo_hookean", "swelling", Profile((0.0, 0.237, 0.237, 1.0), (base, base, tip, tip))
    )
    rod = Rod(F=68.823, k1=254.7, k2=346.3, gamma3=0.1302, gamma1=1.196, taper=0.663, material=material)
    found = solve_by_integration(rod, replace(request(1e-2, most_periods=60), amplitude=0.01))
    assert found.status == IntegratedCycleStatus.cycle
