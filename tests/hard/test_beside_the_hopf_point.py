"""Cycles so close to their Hopf point that growth is lost in the integrator's error, and rods as close below.

Known exactly: on which side there is a cycle, that its amplitude is as the square root of the distance, and
that a perturbation of it decays twice as fast as one of the straight rod grows.
"""

from functools import cache

import numpy as np
import pytest
from rods import rod_of
from surveyed import few

from rodsweep.solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from rodsweep.solve.cycle.limit_cycle import CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.orbit.matrix.linearisation import Linearisation

RODS = [
    (1e4, 1e2, 1e-2, 1.0), (557.1, 3933.0, 3.16e-3, 0.21), (4.878e4, 3997.0, 4.11e-4, 0.26),
    (5.142e4, 288.4, 1.49e-4, 4.0),
]  # fmt: skip
ACCURACY = 1e-7


@cache
def hopf(rod):
    """F** of a rod."""
    found = solve_thresholds(rod_of(0.0, *rod), ThresholdsRequest(60.0, 1e-12, False, 4))
    return next(c.value for c in found.thresholds if c.kind.name == "hopf")


@cache
def beside(rod, distance, start="mode", accuracy=ACCURACY):
    """What a rod does at a relative distance from its Hopf point."""
    point = rod_of(hopf(rod) * (1 + distance), *rod)
    return solve_cycle(point, CycleRequest(accuracy, 0.01, 1, 0, 0, 0, most_periods=400, start=start))


@pytest.mark.parametrize("rod", RODS)
def test_amplitude_is_as_the_square_root_of_the_distance(rod):
    distances = np.array([1e-7, 1e-6, 1e-5])
    found = [beside(rod, distance) for distance in distances]
    assert [c.status for c in found] == [CycleStatus.cycle] * 3
    assert max(c.periods for c in found) <= 60
    squares = np.array([c.measures.tip_y_max**2 for c in found]) / distances
    # What a relative distance of 1e-5 adds to the law, and what 1e-12 of the Hopf point takes at 1e-7.
    assert squares / squares[1] == pytest.approx(1.0, abs=1e-4)
    assert squares[0] / squares[1] == pytest.approx(1.0, abs=3e-5)


@pytest.mark.parametrize("rod", RODS)
def test_a_cycle_recovers_twice_as_fast_as_the_straight_rod_is_left(rod):
    c = beside(rod, 1e-5)
    assert -np.log(c.multiplier) / (c.linear_growth_rate * c.measures.period) == pytest.approx(2.0, abs=0.02)


@pytest.mark.parametrize("rod", RODS)
def test_the_hopf_point_leads_to_the_same_cycle_however_near(rod):
    for distance in (1e-7, 1e-5):
        mode, start = beside(rod, distance), beside(rod, distance, "hopf")
        assert start.status == CycleStatus.cycle
        assert start.measures.tip_y_max == pytest.approx(mode.measures.tip_y_max, rel=2 * ACCURACY)
        assert start.measures.period == pytest.approx(mode.measures.period, rel=2 * ACCURACY)


@pytest.mark.parametrize("accuracy", [1e-9, 1e-10, 1e-11])
@pytest.mark.parametrize("distance", [1e-6, 1e-7])
def test_the_error_of_the_amplitude_contains_rounding(distance, accuracy):
    """The amplitude by an independent solution of the same rod: y = sqrt(d) (A + B d), extrapolated from
    cycles by Fourier collocation at d = 1e-4 to 3.2e-3; the Hopf point is a zero of D in quadruple precision.
    Errors were 5e-11 to 5e-9, and up to a hundred times their estimates.
    """
    hopf_point, rounded_part = 27.427194126759282, -1.1e-15
    cycle = beside(RODS[0], distance, "hopf", accuracy)
    exact = (hopf(RODS[0]) * (1 + distance) - hopf_point - rounded_part) / hopf_point
    amplitude = exact**0.5 * (0.898059510153 + 0.162248 * exact)
    assert cycle.measures.tip_y_max == pytest.approx(amplitude, rel=cycle.errors.amplitude_error)


@pytest.mark.parametrize("rod", RODS)
def test_amplitudes_of_several_accuracies_agree_within_their_errors(rod):
    cycles = [beside(rod, 1e-7, "hopf", accuracy) for accuracy in (1e-9, 1e-10, 1e-11)]
    for one, other in zip(cycles[:-1], cycles[1:], strict=True):
        errors = one.errors.amplitude_error + other.errors.amplitude_error
        assert one.measures.tip_y_max == pytest.approx(other.measures.tip_y_max, rel=errors)


@pytest.mark.parametrize("rod", RODS)
def test_meshes_are_not_refined_below_the_effect_of_rounding_on_the_amplitude(rod, monkeypatch):
    """At 1e-7 from the Hopf point rounding leaves eight digits. Finer meshes would cost seconds and add no
    digit."""
    work = []
    assemble = Linearisation.__init__

    def assemble_and_count(self, orbit, *rest):
        work.append(orbit.interval_count * orbit.form.unknown_count**3)
        assemble(self, orbit, *rest)

    monkeypatch.setattr(Linearisation, "__init__", assemble_and_count)
    cycles, works = [], []
    for accuracy in (1e-8, 1e-11):
        work.clear()
        cycles.append(beside.__wrapped__(rod, 1e-7, "hopf", accuracy))
        works.append(sum(work))
    assert cycles[-1].errors.amplitude_error > 1e-9
    assert "rounding errors may change the amplitude" in cycles[-1].message
    assert works[1] < 10 * works[0]


@pytest.mark.long
@pytest.mark.parametrize("distance", few([-1e-8, -1e-5, -1e-7], 2))
@pytest.mark.parametrize("rod", RODS)
def test_a_rod_below_is_straight(rod, distance):
    c = beside(rod, distance)
    assert c.status == CycleStatus.straight
    assert c.periods <= 150
