"""Inside an unstable cycle a rod goes to rest, outside to the stable cycle: what marching in time says of it.

The rod of Fig. 2c between its restabilization, F = 155.6, and the fold of its cycles, F = 199.2: the straight
rod and a large cycle are stable, and the unstable cycle of the branch parts what goes to one from what goes
to the other. The start, the unstable cycle drawn to the straight rod or away from it, is marched by SciPy in
displacement form (`displacement_form.py`), which has no equation with the program in common.
"""

import pytest
from rods import rod_of

from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.solve.branch.arc_length_step import next_cycle
from rodsweep.solve.branch.start.first_cycle import first_cycle
from rodsweep.solve.branch.start.hopf_point import hopf_branch_start
from rodsweep.solve.changes.thresholds_along_path import find_imaginary_axis_crossings
from rodsweep.solve.cycle.limit_cycle import CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.measures import CycleMotion

from .displacement_form import Displaced, march_from

STIFFNESS = (200.0, 1e4, 1e-4)
ACCURACY, ORDER = 1e-5, 20
LEAST_Y = 0.05
"""Largest y of the tip, in L, from which on the unstable cycle is far enough from its Hopf point."""
BESIDE = 0.02
"""Relative distance of the starts from the unstable cycle: errors of it are far below."""
PERIODS = 40


@pytest.fixture(scope="module")
def unstable():
    """An unstable cycle on the branch from the restabilization."""
    rod = rod_of(0.0, *STIFFNESS)
    crossing = find_imaginary_axis_crossings(ParameterPath(rod, "F"), 100.0, 199.0).thresholds[-1]
    here = first_cycle(hopf_branch_start(ParameterPath(rod, "F"), crossing), ACCURACY, NewtonWorkspace())
    while here.cycle.measures.tip_y_max < LEAST_Y:
        here = next_cycle(here, ACCURACY)
    return here


@pytest.fixture(scope="module")
def stable(unstable):
    """The stable cycle at the same force, by way of one where the straight rod is unstable."""
    request = CycleRequest(ACCURACY, 0.01, 1, 0, 0, 0, 400)
    below = solve_cycle(rod_of(150.0, *STIFFNESS, 1.0), request, None, "F")
    return solve_cycle(
        rod_of(unstable.parameter_coordinate, *STIFFNESS, 1.0), request, below.start_for_next_rod, "F"
    )


def marched(unstable, share):
    """Where the rod goes from the unstable cycle, its distance from rest in units of the cycle's."""
    rod = Displaced(unstable.parameter_coordinate, *STIFFNESS, 1.0, ORDER)
    on_cycle = CycleMotion(unstable.orbit).shapes_from_mean_crossing(1, ORDER + 1)[:, 0, 1:].ravel()
    start = share * (on_cycle - rod.straight)
    return march_from(rod, start, PERIODS * unstable.orbit.period, 1e-6, 1e-8)


def test_cycle_is_unstable_beside_a_stable_straight_rod_and_a_stable_cycle(unstable, stable):
    assert unstable.cycle.largest_multiplier_modulus > 1.2
    assert stable.status == CycleStatus.cycle
    assert stable.linear_growth_rate < 0
    assert stable.measures.tip_y_max > 2 * unstable.cycle.measures.tip_y_max


def test_rod_inside_the_unstable_cycle_goes_to_rest(unstable):
    assert marched(unstable, 1 - BESIDE).word == "straight"


@pytest.mark.long
def test_rod_outside_the_unstable_cycle_goes_to_the_stable_one(unstable, stable):
    found = marched(unstable, 1 + BESIDE)
    assert found.word == "cycle"
    assert found.tip_y_max == pytest.approx(stable.measures.tip_y_max, rel=1e-3)
    assert found.period == pytest.approx(stable.measures.period, rel=1e-3)
