"""Where a rod has two stable states, a point of the task limit_cycle says so."""

import numpy as np
import pytest
from rods import rod_of
from shown import shown

from rodsweep.results.file.view import read_view
from rodsweep.results.layouts.limit_cycle import SECOND_STABLE_STATES
from rodsweep.solve.cycle.limit_cycle import CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.cycle.second_state import SecondStableState, second_state_force_and_message
from rodsweep.solve.hopf.subcritical_hopf import subcritical_hopf_near

FIG_2C = (200.0, 1e4, 1e-4)
SUBCRITICAL = (100.0, 1e4, 0.1)
"""A rod whose first Hopf point, at 43.0249569, is subcritical: a = -1.4889."""
HOPF, A = 43.0249569, 1.4889


def test_words_have_the_numbers_of_the_solver():
    assert dict((word, number) for number, word in SECOND_STABLE_STATES) == {
        s.name: int(s) for s in SecondStableState
    }


@pytest.mark.parametrize(
    ("rod", "F"),
    [(FIG_2C, 45.0), (SUBCRITICAL, 20.0), (FIG_2C, 0.0), (FIG_2C, -5.0), ((1e4, 1e4, 1e-4), 37.0)],
)
def test_rod_below_a_supercritical_hopf_point_or_far_from_any_has_no_second_state(rod, F):
    assert subcritical_hopf_near(rod_of(F, *rod)) is None
    state, at, message = second_state_force_and_message(rod_of(F, *rod), CycleStatus.straight, True)
    assert (state, message) == (SecondStableState.none_known, "")
    assert np.isnan(at)


def test_rod_below_a_subcritical_hopf_point_has_its_unstable_cycle():
    beside = subcritical_hopf_near(rod_of(HOPF * (1 - 1e-4), *SUBCRITICAL))
    assert pytest.approx(HOPF, rel=1e-8) == beside.F
    assert beside.unstable_cycle_y == pytest.approx(A * 1e-2, rel=1e-3)


def test_rod_above_a_subcritical_restabilization_has_its_unstable_cycle():
    assert pytest.approx(155.600159298791, rel=1e-10) == subcritical_hopf_near(rod_of(180.0, *FIG_2C)).F


def test_the_nearer_of_two_subcritical_hopf_points_is_named():
    """At k1 = 100 the rod flutters from 43.02 to 68.44; its second Hopf point is subcritical too."""
    assert pytest.approx(68.4391325, rel=1e-8) == subcritical_hopf_near(rod_of(69.0, *SUBCRITICAL)).F


@pytest.mark.parametrize(
    ("status", "stable", "state"),
    [
        (CycleStatus.cycle, False, SecondStableState.none_known),
        (CycleStatus.cycle, True, SecondStableState.straight),
        (CycleStatus.unstable, True, SecondStableState.straight),
        (CycleStatus.cycle, None, SecondStableState.not_known),
        (CycleStatus.failed, True, SecondStableState.not_known),
    ],
)
def test_state_is_told_from_the_straight_rod(status, stable, state):
    assert second_state_force_and_message(rod_of(180.0, *FIG_2C), status, stable)[0] == state


def test_small_start_below_a_subcritical_hopf_point_ends_straight_with_a_cycle_possible():
    request = CycleRequest(1e-5, 1e-3, 1, 0, 0, 0, 400)
    cycle = solve_cycle(rod_of(42.5, *SUBCRITICAL, 1.0), request)
    assert (cycle.status, cycle.second_state) == (CycleStatus.straight, SecondStableState.cycle_possible)
    assert cycle.subcritical_F == pytest.approx(HOPF, rel=1e-8)
    assert "the Hopf point at F = 43.0249569 is subcritical" in cycle.message


CHAIN = """
task: limit_cycle
parameters: {F: [150, 160], k1: 200, k2: 1.0e4, gamma3: 1.0e-4}
limit_cycle: {start: neighbour, along: F}
accuracy: 1.0e-5
"""


def test_cycle_beside_a_stable_straight_rod_says_that_there_are_two_states(command):
    told = shown(command, CHAIN)
    assert "two stable states at 1 of 2 points: the straight rod is stable as well" in told
    assert "a stable cycle may exist" not in told
    v = read_view(command.directory / "c.h5").variables
    assert v["second_state"].ravel().tolist() == [SecondStableState.none_known, SecondStableState.straight]
