"""The maximum number of returns of a motion holds, and the smallest one allowed is the fewest that can do."""

from dataclasses import replace
from math import inf, isnan

import pytest

from rodsweep.config.task.limit_cycle import MIN_MOST_PERIODS_BY_METHOD
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle.by_integration import solve_by_integration
from rodsweep.solve.cycle.limit_cycle import CycleRequest, solve_cycle
from rodsweep.solve.cycle.transient.poincare_returns import (
    return_count_of_classified_run,
    return_count_of_compared_run,
)

FAST = Rod(F=100.0, k1=1e4, k2=1e4, gamma3=1e-2, gamma1=1.0)
"""A rod whose motion is on its cycle after the first returns."""
TORUS = Rod(F=207.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0)
"""A rod whose motion never settles on a cycle."""
REQUEST = CycleRequest(
    accuracy=1e-2, amplitude=0.3, harmonics=1, samples=0, shapes=0, nodes=0, most_periods=400
)


def solved(rod, method, most_periods):
    solve = {"collocation": solve_cycle, "integration": solve_by_integration}[method]
    return solve(rod, replace(REQUEST, most_periods=most_periods))


@pytest.mark.parametrize("method", MIN_MOST_PERIODS_BY_METHOD)
def test_the_fewest_returns_allowed_are_the_fewest_that_give_a_cycle(method):
    least = MIN_MOST_PERIODS_BY_METHOD[method]
    enough, too_few = solved(FAST, method, least), solved(FAST, method, least - 1)
    assert (enough.status.name, enough.periods) == ("cycle", least)
    assert enough.errors.period_error < REQUEST.accuracy
    assert (too_few.status.name, too_few.periods) == ("not_settled", least - 1)
    assert isnan(too_few.measures.period)


@pytest.mark.parametrize("method", MIN_MOST_PERIODS_BY_METHOD)
@pytest.mark.parametrize("more", [0, 1, 6])
def test_a_motion_ends_at_its_maximum_of_returns(method, more):
    most_periods = MIN_MOST_PERIODS_BY_METHOD[method] + more
    found = solved(TORUS, method, most_periods)
    assert (found.status.name, found.periods) == ("not_settled", most_periods)
    assert f"{most_periods} returns" in found.message


@pytest.mark.parametrize("most_periods", [10, 15])
def test_too_few_returns_for_the_errors_are_named(most_periods):
    found = solved(FAST, "integration", most_periods)
    settled = 10 if most_periods == 15 else most_periods
    further = f"{most_periods - settled} further returns"
    assert found.status.name == "not_settled"
    assert found.message == (
        f"the motion has settled after {settled} returns of the tip, but the errors come from a second "
        f"integration, for which {further} are not enough"
    )


def test_a_limiting_rod_needs_a_third_integration():
    rod = Rod(F=100.0, k1=inf, k2=1e4, gamma3=1e-2, gamma1=1.0)
    found = {most: solved(rod, "integration", most) for most in (25, 26)}
    assert {most: one.status.name for most, one in found.items()} == {25: "not_settled", 26: "cycle"}
    assert "has settled after 20 returns of the tip, but the errors" in found[25].message


@pytest.mark.parametrize("most", [*range(1, 30), 300, 400])
def test_runs_of_a_motion_add_up_to_its_maximum(most):
    total, runs = 0, []
    while total < most:
        runs.append(return_count_of_classified_run(not runs, most - total))
        total += runs[-1]
    assert total == most
    assert all(run >= 3 for run in runs) or most < 3
    compared = 0
    while compared < most:
        run = return_count_of_compared_run(most - compared)
        assert run >= 5 or most < 5
        compared += run
    assert compared == most
