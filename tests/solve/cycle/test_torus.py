"""Motions that never settle: a torus is told from what grows, decays, closes or was watched too briefly."""

from functools import cache

import numpy as np
import pytest
from rods import rod_of
from scipy.integrate import LSODA
from surveyed import survey_only

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.explicit_system import ExplicitSystem
from rodsweep.solve.cycle.limit_cycle import CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.cycle.transient import cycle_search
from rodsweep.solve.cycle.transient.poincare_returns import tip_angle_row
from rodsweep.solve.cycle.transient.torus import TORUS_TEST_SETTINGS, torus_frequency_of
from rodsweep.solve.motion.leading_mode import leading_mode
from rodsweep.solve.unsolvable import Unsolvable

SOFT = (1e4, 1e2, 1e-2, 1.0)
ROTATION = 1.54710
"""Angle of a return at F = 207, rad: SciPy's LSODA over 3000 returns with p = 24 and 600 with p = 30."""
MULTIPLIER = 1.0394
NUMBERS, ANGLE = np.arange(260), 1.3


@cache
def rod(F, most_periods):
    return solve_cycle(rod_of(F, *SOFT), CycleRequest(1e-6, 0.1, 3, 16, 4, 5, most_periods))


@pytest.mark.long
def test_a_torus_is_told_with_its_second_frequency_and_the_cycle_that_it_surrounds():
    c = rod(207.0, 400)
    assert c.status == CycleStatus.torus
    assert c.status.succeeded
    assert "modulated at 0.246 times the frequency of its oscillation" in c.message
    assert "inside the torus has a Floquet multiplier of modulus 1.04" in c.message
    assert c.modulation_ratio == pytest.approx(ROTATION / (2 * np.pi), rel=1e-3)
    assert c.multiplier == pytest.approx(MULTIPLIER, abs=1e-3)
    assert abs(np.angle(c.multipliers[0])) == pytest.approx(ROTATION, abs=0.1)
    assert c.trivial_multiplier_error < 1e-6
    assert c.errors.multiplier_error < 0.01


def test_nothing_of_a_cycle_is_stored_of_a_torus_but_its_multipliers():
    c = rod(207.0, 400)
    assert np.isnan([c.measures.period, c.measures.tip_y_max, c.errors.period_error]).all()
    assert c.tip is c.energy_and_powers is c.shape is c.start_for_next_rod is None


def test_a_torus_that_was_watched_too_briefly_is_not_settled():
    c = rod(208.0, 60)
    assert c.status == CycleStatus.not_settled
    assert np.isnan(c.multiplier)


@pytest.mark.long
def test_a_motion_that_spirals_into_a_stable_cycle_is_no_torus(monkeypatch):
    """At F = 203 the pair is inside the circle; without Newton's method the motion would not have settled."""
    assert rod(203.0, 400).status == CycleStatus.cycle

    def none(*_):
        raise Unsolvable("not looked for")

    monkeypatch.setattr(cycle_search, "refined_cycle", none)
    assert rod.__wrapped__(203.0, 120).status == CycleStatus.not_settled


@survey_only
def test_another_integrator_on_another_mesh_is_on_the_same_torus():
    """SciPy's LSODA; the states where theta of the tip rises through 0, by its dense output."""
    system = ExplicitSystem(rod_of(207.0, *SOFT[:3], gamma1=SOFT[3]), uniform_mesh(1, 21))
    z, row = leading_mode(system).state(0.1), tip_angle_row(system)
    run = LSODA(
        lambda _, z: system.state_derivative(z), 0.0, z, np.inf, rtol=1e-7, atol=1e-7 * np.abs(z).max(),
        jac=lambda _, z: system.jacobian(z),
    )  # fmt: skip
    returns = []
    while len(returns) < 400:
        before = row @ run.y
        run.step()
        if before < 0 <= row @ run.y:
            state, low, high = run.dense_output(), run.t_old, run.t
            for _ in range(40):
                middle = (low + high) / 2
                low, high = (middle, high) if row @ state(middle) < 0 else (low, middle)
            returns.append(system.layout.stress_field(state(low), "m3"))
    found = torus_frequency_of(np.array(returns[133:]), abs(np.angle(rod(207.0, 400).multipliers[0])))
    assert found.angle_per_return == pytest.approx(ROTATION, abs=1e-3)
    assert found.prediction_error < TORUS_TEST_SETTINGS.max_prediction_error_per_modulation / 5


# --- returns that are made up -----------------------------------------------------------------------------


def closed_curve(phases):
    """Points of a closed curve, (k, 3)."""
    first, second, third = (np.cos(m * phases + m) for m in (1, 2, 3))
    return 5 + np.stack([first + 0.2 * second, np.sin(phases) + 0.04 * third, 0.3 * first], axis=1)


def test_rotation_on_a_closed_curve_is_found():
    found = torus_frequency_of(closed_curve(ANGLE * NUMBERS), ANGLE + 0.1)
    assert found.angle_per_return == pytest.approx(ANGLE, abs=1e-6)
    assert found.prediction_error < 1e-3


@pytest.mark.parametrize("rate", [3e-3, -3e-3])
def test_growing_and_decaying_modulations_are_not_predicted(rate):
    returns = 5 + (closed_curve(ANGLE * NUMBERS) - 5) * np.exp(rate * NUMBERS)[:, None]
    assert (
        torus_frequency_of(returns, ANGLE).prediction_error
        > TORUS_TEST_SETTINGS.max_prediction_error_per_modulation
    )


def test_irregular_returns_are_not_predicted():
    noise = np.random.default_rng(1).normal(size=len(NUMBERS))
    irregular = closed_curve(ANGLE * NUMBERS + np.cumsum(0.3 * noise))
    assert (
        torus_frequency_of(irregular, ANGLE).prediction_error
        > TORUS_TEST_SETTINGS.max_prediction_error_per_modulation
    )


@pytest.mark.parametrize("turns, after", [(1, 2), (1, 3), (1, 4), (2, 9), (3, 11), (6, 13), (2, 15)])
def test_an_orbit_that_closes_after_several_returns_is_no_torus(turns, after):
    angle = 2 * np.pi * turns / after
    assert torus_frequency_of(closed_curve(angle * NUMBERS), min(angle, np.pi - 0.1)) is None


def test_too_few_returns_do_not_fill_the_curve():
    assert torus_frequency_of(closed_curve((np.pi / 2 + 0.01) * NUMBERS[:80]), np.pi / 2) is None
