"""The benchmark of the limit cycle: its errors are those of what it times; the ratios are stated."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from surveyed import survey_only

from rodsweep.bench.limit_cycle.default_integrator import DEFAULT_INTEGRATOR, IntegrationTask
from rodsweep.bench.limit_cycle.settling import SettlingMethod, settling_table
from rodsweep.bench.limit_cycle.study import (
    CYCLE_FOLLOWING_RACE_NAME,
    SETTLING_TO_CYCLE_RACE_NAME,
    cycle_following_table,
    run_limit_cycle_study,
    time_at_error,
    time_at_error_table,
)
from rodsweep.bench.limit_cycle.sweeping import (
    ACCURACY,
    MeshConvergedCycle,
    SweptRod,
    measure_sweep_points,
    solve_timed_points,
    sweep_table,
)
from rodsweep.bench.limit_cycle.swept_rods import QUICK_RODS, RODS
from rodsweep.bench.limit_cycle.tracking import (
    FOLLOWED_PERIODS,
    SMALL_STEP_SCHEME,
    cycle_request,
    orbit_of,
    solve_reference,
    tip_angle_returns,
    trajectory_measurement_fields,
)
from rodsweep.bench.peers import NO_PEERS, PeerContribution
from rodsweep.bench.study import Measurement, TimedMethod, TimedRuns
from rodsweep.solve.cycle.limit_cycle import solve_cycle
from rodsweep.solve.motion.integrator import integrator
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace

COLD = ["cold, leading mode", "cold, Hopf point"]


@cache
def cycle():
    return solve_reference()


def test_error_of_an_exact_run_is_that_of_the_measurement():
    at = cycle()
    steps = int(128 * FOLLOWED_PERIODS)
    duration = steps / 128 * at.period
    run = integrator(at.system.mesh, SMALL_STEP_SCHEME).run(at.system, at.state, duration, at.period / 128)
    assert trajectory_measurement_fields(at, run)["error"] < 1e-8


def test_returns_lie_on_the_section():
    at = cycle()
    steps = DEFAULT_INTEGRATOR.integrate(
        1e-5, IntegrationTask(at.system, at.state, FOLLOWED_PERIODS * at.period)
    )
    found = tip_angle_returns(at.system, steps)
    angle = at.system.tip_coordinates(found.states)[2]
    assert len(found.times) >= 6
    assert np.abs(angle).max() < 1e-9 * np.abs(at.system.tip_coordinates(steps.states)[2]).max()


def test_interpolation_in_the_logarithms():
    times, errors = [10.0, 20.0, 80.0], [1e-4, 1e-5, 1e-7]
    assert time_at_error(1e-6, errors, times) == pytest.approx(40.0)
    assert time_at_error(1e-6, [1e-7, *errors], [1.0, *times]) == pytest.approx(40.0)  # once lucky
    assert np.isnan(time_at_error(1e-6, errors[:2], times[:2]))
    assert np.isnan(time_at_error(1e-6, errors[2:], times[2:]))


def test_table_at_equal_error_states_the_ratios():
    def pair(name, ms):
        return [
            Measurement("", name, "", 1e-3 * ms * factor, error, least_seconds=5e-4 * ms * factor)
            for factor, error in ((0.5, 1e-5), (2, 1e-7))
        ]

    text = time_at_error_table(
        [*pair(DEFAULT_INTEGRATOR.name, 10.0), *pair("slow", 25.0), *pair("rough", 8.0)[:1]]
    )
    assert f"| {DEFAULT_INTEGRATOR.name} | 10.00 | 1.00 | 1.00 |" in text
    assert "| slow | 25.00 | 2.50 | 2.50 |" in text
    assert "| rough |  |  |  |" in text


def test_tables_show_what_failed():
    failed = Measurement("", "a", "1e-05", 1.0, np.inf, failure="failed (ArithmeticError)")
    assert "| a | 1e-05 | failed (ArithmeticError) |" in cycle_following_table([failed])
    never = SettlingMethod(
        50.0, "waiting, a", "", np.nan, np.inf, print, failed_tolerances=("1e-06", "1e-07")
    )
    text = settling_table([never], [TimedRuns(None, (1.0,))])
    assert "waiting, a (fails at 1e-06, 1e-07) |  | not reached" in text


@cache
def soft_rod():
    """A cycle of the first rod as the task finds it."""
    return orbit_of(solve_cycle(RODS[0], cycle_request(ACCURACY), parameter_name="F"))


@cache
def exact():
    return MeshConvergedCycle.converged_from_orbit(soft_rod())


def test_the_reference_is_the_cycle_on_its_mesh():
    assert exact().period == pytest.approx(cycle().period, rel=1e-8)  # one element of order 18 leaves 1e-9
    assert exact().tip_y_max == pytest.approx(cycle().tip_y_max, rel=1e-8)
    moved = exact().cycle_at_force(50.5)
    solved = solve_cycle(replace(RODS[0], F=50.5), cycle_request(ACCURACY), parameter_name="F")
    errors = moved.errors_of(solved.measures.period, solved.measures.tip_y_max)
    assert max(errors.values()) < ACCURACY


def test_points_of_a_sweep_are_as_accurate_as_they_say():
    found = measure_sweep_points(QUICK_RODS, 1)
    assert [m.method for m in found] == ["sweep over F", "sweep over k1", *COLD]
    for m in found:
        assert m.error <= m.extra_columns["estimate"] <= ACCURACY
        assert m.extra_columns.get("multipliers", 7) > 6
        assert m.seconds > 0
    text = sweep_table(found)
    assert "| 30, 10000, 100, 0.01, 1 | sweep over k1 |" in text
    assert all(f"| median | {way} |" in text for way in COLD)


def test_a_point_without_a_cycle_is_shown_as_failed():
    rod = SweptRod(replace(RODS[2], F=25.0), exact(), {"F": None}, NewtonWorkspace())
    with pytest.raises(ArithmeticError, match="no cycle: straight"):
        solve_timed_points("F", ACCURACY, rod)
    failed = Measurement("rod", "sweep over F", "", 1.0, np.inf, failure="failed (ArithmeticError)")
    assert "| rod | sweep over F | failed (ArithmeticError) |  |" in sweep_table([failed])


@survey_only
def test_the_benchmark_times_rodsweep_alone(tmp_path):
    study = run_limit_cycle_study(quick=True, peers=NO_PEERS)
    text = study.text
    assert "| 30, 10000, 100, 0.01, 1 | sweep over F |" in text
    assert len(study.table()["error"]) == len(study.measurements) + 4
    assert "| 50 | solve_cycle |" in text
    assert "| 27.43 | waiting, ARKIMEX 5 (default) |" in text
    assert "| ARKIMEX 5 (default) |" in text.split("times the default's time")[1]
    assert {m.case for m in study.measurements} == {"error of the period", "error of the largest tip y"}
    assert {m.method for m in study.measurements} == {DEFAULT_INTEGRATOR.name}
    study.draw(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.long
def test_the_benchmark_times_peers_beside_rodsweep(monkeypatch):
    """One that fails, one that is rodsweep's own under another name, and a section of its own."""
    monkeypatch.setattr("rodsweep.bench.limit_cycle.study.measure_sweep_points", lambda *_: [])

    def gives_up(leg):
        raise ArithmeticError("too stiff")

    double = replace(
        DEFAULT_INTEGRATOR, name="double", following_tolerances=(1e-5, 1e-8), settling_tolerances=(1e-7,)
    )
    failing = [TimedMethod("failing", tolerance, "failing", gives_up) for tolerance in ("1e-05", "1e-07")]
    further = Measurement("30", "continuation", "p = 14", 1.0, 1e-6)
    peers = PeerContribution(
        contenders_by_race={
            CYCLE_FOLLOWING_RACE_NAME: double.following_contenders() + failing,
            SETTLING_TO_CYCLE_RACE_NAME: double.settling_contenders() + failing,
        },
        section_functions=[lambda rounds: ([f"a section of {rounds}"], [further])],
        contender_notes=["A note."],
        skipped_peer_sentences=["Another is skipped."],
    )
    study = run_limit_cycle_study(quick=True, peers=peers)
    assert "\n\nA note.\n\n| method |" in study.text
    assert "| failing | 1e-05 | failed (ArithmeticError) |" in study.text
    assert "| double |" in study.text.split("times the default's time")[1]
    assert "| 50 | waiting, failing (fails at 1e-05, 1e-07) |  | not reached" in study.text
    assert "| 50 | waiting, double | 1e-07 |" in study.text
    assert "| 27.43 | waiting, double | 1e-07 | about" in study.text
    assert "| 27.43 | waiting, failing" not in study.text
    assert study.text.endswith("a section of 1\n\nAnother is skipped.")
    assert study.table()["method"][-1] == "continuation"
