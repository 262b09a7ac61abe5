"""The benchmark of the sweep: it writes its tables; memory and file stay within what a point may take."""

import sys
from dataclasses import replace
from functools import partial
from math import isnan
from pathlib import Path

import numpy as np
import pytest
from conftest import RANK
from surveyed import survey_only

from rodsweep.bench.sweep import eigenvalue_following
from rodsweep.bench.sweep import study as sweep
from rodsweep.bench.sweep.launch import (
    HOPF_FORCE,
    INSTANT,
    KILLED,
    CommandRunCost,
    SweepCase,
    launcher_arguments,
    run_case,
    shuffled_forces,
    write_spectrum_case,
)
from rodsweep.bench.sweep.study import (
    TWO_COMMAND_CASE,
    added_point_cost_table,
    instant_solver_table,
    run_sweep_study,
    sweep_measurement,
)
from rodsweep.cli.benching import MEASURED_COMMAND
from rodsweep.errors import EnvironmentIncomplete

FEW_MEGABYTES = 4.0
MOST_BYTES = 100


run = partial(run_case, MEASURED_COMMAND)


def row(name, points, ranks, seconds, memory):
    """Three runs of which the median takes `seconds`."""
    case = SweepCase(name, points, (Path(),), KILLED if name == KILLED else INSTANT)
    runs = [
        CommandRunCost(
            seconds=s,
            printed_seconds=s - 0.5,
            solver_seconds=0.0,
            first_and_other_rank_peak_bytes=tuple(memory[:ranks]),
            file_bytes=1000 + 62 * points,
            journal_bytes=74 * (points - 1),
            processors_busy_elsewhere=0.0,
            busy_fraction=1.0,
        )
        for s in (seconds, 2 * seconds, seconds)
    ]
    return sweep_measurement(case, ranks, runs)


@survey_only
def test_quick_study_writes_its_tables_and_its_measurements(monkeypatch, loaded):
    """Its runs are forked from a loaded process; the tests below start theirs as users do."""
    monkeypatch.setattr(sweep, "QUICK_SIZES", (400,))
    monkeypatch.setattr(sweep, "QUICK_SPECTRUM_COUNT", 16)
    monkeypatch.setattr(sweep, "QUICK_CYCLE_COUNT", 2)
    monkeypatch.setattr(eigenvalue_following, "QUICK_GRID_PAIRS", eigenvalue_following.QUICK_GRID_PAIRS[1:])
    command = (sys.executable, "-SE", str(RANK), str(loaded.ranks), *MEASURED_COMMAND[1:])
    study = run_sweep_study(quick=True, command=command)
    assert "| spectra | 16 | 1 |" in study.text
    assert (f"| {TWO_COMMAND_CASE} | 16 | 1 |" in study.text) == bool(launcher_arguments(2))
    assert "| no solver | 400 | 1 |" in study.text
    assert "| resumed | 400 | 1 |" in study.text
    assert added_point_cost_table([]) in study.text
    assert "| limit cycles | 2 | 1 |" in study.text
    assert "| 12 of F | 144 |" in study.text
    assert ("| no solver | 400 | 2 |" in study.text) == bool(launcher_arguments(2))
    assert not study.is_drawable
    table = study.table()
    instant = [i for i, case in enumerate(table["case"]) if case == "no solver"]
    assert len(instant) == (2 if launcher_arguments(2) else 1)
    for name in ("ranks", "points", "points_per_second", "rss_megabytes", "file_bytes_per_point"):
        assert all(table[name][i] > 0 for i in instant), name
    assert all(np.isfinite(table["microseconds_overhead"][i]) for i in instant)
    killed = [i for i, case in enumerate(table["case"]) if case == "killed"]
    assert [round(table["journal_bytes_per_point"][i]) for i in killed] == [74]
    assert all(isnan(error) for error in table["error"])


@pytest.mark.long
def test_memory_of_a_rank_does_not_grow_with_the_grid(tmp_path):
    """Up to a kill at the last point, and in the next run, which reads all that is there."""
    peaks = {}
    for points in (2_000, 50_000):
        case = write_spectrum_case(tmp_path / str(points), "killed", points, "killed")
        killed = run(case, 1)
        assert killed.journal_bytes > 74 * (points - 1)
        resumed = run(replace(case, solver_kind="instant"), 1, fresh=False)
        peaks[points] = [
            killed.first_and_other_rank_peak_bytes[0],
            resumed.first_and_other_rank_peak_bytes[0],
        ]
    for few, many in zip(*peaks.values(), strict=True):
        assert 5e7 < few < many + 1e6 * FEW_MEGABYTES
        assert many < few + 1e6 * FEW_MEGABYTES


@pytest.mark.long
def test_file_takes_less_than_a_hundred_bytes_a_point(tmp_path):
    case = write_spectrum_case(tmp_path / "grid", "no solver", 20_000, "instant")
    taken = run(case, 1)
    assert case.points == 20_000
    assert taken.file_bytes < MOST_BYTES * case.points
    table = "\n".join(f"{F!r},200,{1e3 + F!r},1e-4" for F in np.linspace(0, 90, 20_000).tolist())
    (case.directories[0] / "p.csv").write_text(f"F,k1,k2,gamma3\n{table}\n")
    (case.directories[0] / "c.yaml").write_text(
        "task: spectrum\nparameters: {points: p.csv}\nspectrum: {modes: 2}\n"
    )
    assert run(case, 1).file_bytes < MOST_BYTES * case.points


def test_a_run_that_fails_is_told(tmp_path):
    case = write_spectrum_case(tmp_path / "grid", "no solver", 8, "instant")
    (case.directories[0] / "c.yaml").write_text("task: spectrum\n")
    with pytest.raises(EnvironmentIncomplete, match="parameters"):
        run(case, 1)


def test_two_ranks_are_skipped_without_a_launcher(monkeypatch):
    monkeypatch.setattr(sweep, "launcher_arguments", lambda ranks: [])
    solved, instant = [], []

    def sweeps(into, kinds):
        return lambda place, run, quick, ranks: (
            into.extend(row(k, 10, ranks[-1], 2, [1]) for k in kinds) or into
        )

    monkeypatch.setattr(sweep, "measure_solved_sweeps", sweeps(solved, ["spectra"]))
    monkeypatch.setattr(sweep, "measure_eigenvalue_following", lambda *words: [])
    monkeypatch.setattr(sweep, "measure_instant_sweeps", sweeps(instant, ["no solver", KILLED, "resumed"]))
    assert "Two ranks are skipped" in run_sweep_study(quick=True, command=()).text
    assert {m.method for m in solved + instant} == {"1 rank"}


def test_growth_is_that_of_each_step():
    rows = [
        row("no solver", 10**k, n, 1 + 1e-5 * 10**k / n, [10**8, 2 * 10**8])
        for n in (1, 2)
        for k in (3, 4, 5)
    ]
    text = added_point_cost_table(rows)
    assert "| no solver | 1 rank | 1000 | 10000 | 10 | 62 | +0.0 |  |  |" in text
    assert "| no solver | 1 rank | 10000 | 100000 | 10 | 62 | +0.0 |  | 1.00 |" in text
    assert "| no solver | 2 ranks | 10000 | 100000 | 10 | 62 | +0.0 | +0.0 | 1.00 |" in text
    killed = row(KILLED, 10**5, 1, 1.0, [10**8])
    assert added_point_cost_table([killed]).endswith("---|")
    text = instant_solver_table([*rows, killed])
    assert "| no solver | 100000 | 2 | 1.50 | 30.0 | 100.0 | 200.0 | 62.0 |  |" in text
    assert "| killed | 100000 | 1 | 1.00 | 10.0 | 100.0 |  | 62.0 | 74.0 |" in text


def test_uneven_forces_lie_on_both_sides_of_the_hopf_point_and_close_to_it():
    forces = shuffled_forces(60)
    assert len(forces) == 60
    distance = forces / HOPF_FORCE - 1
    assert distance.min() < -0.5
    assert distance.max() > 1
    assert 0 < distance[distance > 0].min() < 2e-7
    assert not (np.diff(forces) > 0).all()
