"""The benchmark of the limit cycle: every method follows the cycle, at its order; the ratios are stated."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from rodsweep.bench.limit_cycle import integrators as cycle_peers
from rodsweep.bench.limit_cycle.integrators import CVODE, CVODE_MODULE, DEFAULT, families
from rodsweep.bench.limit_cycle.study import (
    Wait,
    limit_cycle_study,
    settling_table,
    target_table,
    time_at,
    work_table,
)
from rodsweep.bench.limit_cycle.tracking import (
    FOLLOWED_PERIODS,
    judged_run,
    reference,
    returns_of,
    work_precision,
)
from rodsweep.bench.machine import installed
from rodsweep.bench.study import Measurement, Timed
from rodsweep.solve.cycle.shooting import PERIOD_MAP
from rodsweep.solve.motion.integrator import integrator

ORDERS = {
    "ARKIMEX 2": (2, 1e-4, 1e-5),
    "ARKIMEX 3": (3, 1e-5, 1e-7),
    "ARKIMEX 4": (4, 3e-6, 1e-8),
    DEFAULT: (5, 1e-5, 3e-7),
    "ROSW ra34pw2": (3, 1e-4, 1e-6),
    "ROSW rodas3": (3, 1e-4, 1e-6),
}
"""One-step methods: steps of equal error per step show the order of the global error. With it two tolerances
between which errors are the method's: chance rules at looser ones, what measures them at tighter ones."""
PHASES = 5
"""Starts along the cycle over which errors are averaged: one may be twice as far off as another."""
LOOSE_AND_TIGHT = {"ARKIMEX 2": (1e-4, 1e-5), "ARKIMEX 3": (1e-5, 1e-7), "BDF 5": (1e-7, 1e-9)}


@cache
def cycle():
    return reference()


@cache
def rows():
    """Two tolerances of each family."""
    chosen = [
        replace(f, tolerances=LOOSE_AND_TIGHT.get(f.name, (f.tolerances[0], f.tolerances[-1])))
        for f in families()
    ]
    return work_precision(cycle(), chosen, 1, 1)


def of(name):
    return [row for row in rows() if row.method == name]


@pytest.mark.parametrize("family", families(), ids=lambda family: family.name)
def test_every_method_follows_the_cycle_and_gains_from_a_tighter_tolerance(family):
    loose, tight = of(family.name)
    assert 0 < tight.error < 3e-5
    assert np.isfinite(loose.error)
    assert tight.error < loose.error / 5
    assert tight.extra["steps"] > loose.extra["steps"]
    assert tight.seconds > 0


@pytest.mark.parametrize("name", ORDERS)
def test_order_of_the_errors(name):
    order, *tolerances = ORDERS[name]
    family, at = next(f for f in families() if f.name == name), cycle()
    over = integrator(at.beam.mesh, PERIOD_MAP).run(at.beam, at.state, at.period, at.period / 128)
    error, steps = np.zeros((2, PHASES)), np.zeros((2, PHASES))
    for phase, state in enumerate(over.states[: 128 : 128 // PHASES + 1]):
        for i, tolerance in enumerate(tolerances):
            run = family.integrate(at.beam, state, FOLLOWED_PERIODS * at.period, tolerance)
            error[i, phase] = judged_run(replace(at, state=state), run)["error"]
            steps[i, phase] = len(run.times) - 1
    (loose, tight), (few, many) = np.sqrt((error**2).mean(axis=1)), steps.mean(axis=1)
    assert np.log(loose / tight) / np.log(many / few) == pytest.approx(order, abs=0.7)


def test_error_of_an_exact_run_is_that_of_the_measurement():
    at = cycle()
    steps = int(128 * FOLLOWED_PERIODS)
    duration = steps / 128 * at.period
    run = integrator(at.beam.mesh, PERIOD_MAP).run(at.beam, at.state, duration, at.period / 128)
    assert judged_run(at, run)["error"] < 1e-8


def test_returns_lie_on_the_section():
    at = cycle()
    steps = families()[3].integrate(at.beam, at.state, FOLLOWED_PERIODS * at.period, 1e-5)
    found = returns_of(at.beam, steps)
    angle = at.beam.tip(found.states)[2]
    assert len(found.times) >= 6
    assert np.abs(angle).max() < 1e-9 * np.abs(at.beam.tip(steps.states)[2]).max()


def test_interpolation_in_the_logarithms():
    times, errors = [10.0, 20.0, 80.0], [1e-4, 1e-5, 1e-7]
    assert time_at(1e-6, errors, times) == pytest.approx(40.0)
    assert time_at(1e-6, [1e-7, *errors], [1.0, *times]) == pytest.approx(40.0)  # once lucky
    assert np.isnan(time_at(1e-6, errors[:2], times[:2]))
    assert np.isnan(time_at(1e-6, errors[2:], times[2:]))


def test_table_at_equal_error_states_the_ratios():
    def pair(name, ms):
        return [
            Measurement("", name, "", 1e-3 * ms * factor, error, least_seconds=5e-4 * ms * factor)
            for factor, error in ((0.5, 1e-5), (2, 1e-7))
        ]

    text = target_table([*pair(DEFAULT, 10.0), *pair("SciPy Radau", 25.0), *pair(CVODE, 8.0)[:1]])
    assert f"| {DEFAULT} | 10.00 | 1.00 | 1.00 |" in text
    assert "| SciPy Radau | 25.00 | 2.50 | 2.50 |" in text
    assert "| CVODE |  |  |  |" in text


def test_cvode_is_left_out_where_it_is_not_installed(monkeypatch):
    monkeypatch.setattr(cycle_peers, "installed", lambda _: None)
    assert CVODE not in [family.name for family in families()]


def test_cvode_takes_part_where_it_is_installed():
    assert (CVODE in [family.name for family in families()]) == (installed(CVODE_MODULE) is not None)


def test_tables_show_what_failed():
    failed = Measurement("", "a", "1e-05", 1.0, np.inf, failure="failed (ArithmeticError)")
    assert "| a | 1e-05 | failed (ArithmeticError) |" in work_table([failed])
    never = Wait(50.0, "waiting, a", np.nan, np.nan, np.inf, print, failed=(1e-6, 1e-7))
    text = settling_table([never], [Timed(None, (1.0,))])
    assert "waiting, a (fails at 1e-06, 1e-07) |  | not settled" in text


def test_the_benchmark_writes_its_tables_and_its_figure(monkeypatch, tmp_path):
    few = [replace(f, tolerances=f.tolerances[1:4:2], settling=f.settling[-3:]) for f in families()[3:4]]
    radau = next(f for f in families() if f.name == "SciPy Radau")
    few.append(replace(radau, tolerances=(1e-3, 1e-5), settling=(1e-5,)))
    monkeypatch.setattr("rodsweep.bench.limit_cycle.study.families", lambda: few)
    study = limit_cycle_study(quick=True)
    text = study.text
    assert "| 50 | solve_cycle |" in text
    assert "| 27.43 | waiting, ARKIMEX 5 (default) |" in text
    assert "| ARKIMEX 5 (default) |" in text.split("times the default's time")[1]
    assert ("CVODE is skipped: scikit-sundae is not installed" in text) == (installed(CVODE_MODULE) is None)
    assert {m.case for m in study.measurements} == {"error of the period", "error of the largest tip y"}
    study.draw(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
