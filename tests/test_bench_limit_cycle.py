"""The benchmark of the limit cycle: every method follows the cycle, at its order; the ratios are stated."""

import ctypes
import shutil
import subprocess
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from rodsweep.bench import auto as auto_peer
from rodsweep.bench.auto import AUTO, auto_program
from rodsweep.bench.limit_cycle import integrators as cycle_peers
from rodsweep.bench.limit_cycle.auto_cycles import AutoSetting, continued, rod_file
from rodsweep.bench.limit_cycle.auto_equations import EQUATIONS
from rodsweep.bench.limit_cycle.continuation import (
    OWN,
    beside_auto,
    cycle_table,
    first_cycles,
    judged,
    ratio_table,
)
from rodsweep.bench.limit_cycle.integrators import CVODE, CVODE_MODULE, DEFAULT, families
from rodsweep.bench.limit_cycle.study import (
    Wait,
    limit_cycle_study,
    settling_table,
    target_table,
    time_at,
    work_table,
)
from rodsweep.bench.limit_cycle.sweeping import (
    ACCURACY,
    QUICK_RODS,
    RODS,
    ExactCycle,
    SweptRod,
    from_neighbour,
    sweep_points,
    sweep_table,
)
from rodsweep.bench.limit_cycle.tracking import (
    FOLLOWED_PERIODS,
    PERIOD_MAP,
    asked,
    judged_run,
    on_cycle,
    orbit_of,
    reference,
    returns_of,
    work_precision,
)
from rodsweep.bench.machine import installed
from rodsweep.bench.study import Measurement, Timed
from rodsweep.solve.cycle.limit_cycle import solve_cycle
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
COLD = ["cold, leading mode", "cold, Hopf point"]
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


@cache
def soft_rod():
    """A cycle of the first rod as the task finds it."""
    return orbit_of(solve_cycle(RODS[0], asked(ACCURACY), along="F"))


@cache
def exact():
    return ExactCycle.near(soft_rod())


@pytest.fixture(scope="module")
def auto(tmp_path_factory):
    program = auto_program(tmp_path_factory.mktemp("auto"), EQUATIONS)
    if program is None:
        pytest.skip("AUTO-07p or gfortran is not installed")
    return program


def test_the_reference_is_the_cycle_on_its_mesh():
    assert exact().period == pytest.approx(cycle().period, rel=1e-8)  # one element of order 18 leaves 1e-9
    assert exact().tip_y_max == pytest.approx(cycle().tip_y_max, rel=1e-8)
    moved = exact().at(50.5)
    solved = solve_cycle(replace(RODS[0], F=50.5), asked(ACCURACY), along="F")
    errors = moved.errors_of(solved.measures.period, solved.measures.tip_y_max)
    assert max(errors.values()) < ACCURACY


def test_points_of_a_sweep_are_as_accurate_as_they_say():
    found = sweep_points(QUICK_RODS, 1)
    assert [m.method for m in found] == ["sweep over F", "sweep over k1", *COLD]
    for m in found:
        assert m.error <= m.extra["estimate"] <= ACCURACY
        assert m.extra.get("multipliers", 7) > 6
        assert m.seconds > 0
    text = sweep_table(found)
    assert "| 30, 10000, 100, 0.01, 1 | sweep over k1 |" in text
    assert all(f"| median | {way} |" in text for way in COLD)


def test_a_point_without_a_cycle_is_shown_as_failed():
    rod = SweptRod(replace(RODS[2], F=25.0), exact(), {"F": None})
    with pytest.raises(ArithmeticError, match="no cycle: straight"):
        from_neighbour("F", ACCURACY, rod)
    failed = Measurement("rod", "sweep over F", "", 1.0, np.inf, failure="failed (ArithmeticError)")
    assert "| rod | sweep over F | failed (ArithmeticError) |  |" in sweep_table([failed])


@pytest.mark.skipif(shutil.which("gfortran") is None, reason="gfortran is not installed")
def test_equations_in_fortran_are_those_of_the_beam(tmp_path):
    beam, z = on_cycle(soft_rod())
    n = len(z)
    (tmp_path / "rod").write_bytes(rod_file(soft_rod().form))
    # A library of its own, which finds the rod where it was written.
    (tmp_path / "a.f90").write_text(EQUATIONS.replace("'rod'", f"'{tmp_path}/rod'"))
    words = ["gfortran", "-ffree-line-length-none", "-shared", "-fPIC", "a.f90", "-o", "a.so"]
    subprocess.run(words, cwd=tmp_path, check=True)
    func = ctypes.CDLL(str(tmp_path / "a.so")).func_

    def call(F, derivatives):
        out = [np.zeros(n), np.zeros((n, n)), np.zeros(n)]
        u, par, icp = z.copy(), np.array([F, 0.0]), np.zeros(2, np.int32)
        size, which = ctypes.byref(ctypes.c_int(n)), ctypes.byref(ctypes.c_int(derivatives))
        func(size, *(a.ctypes for a in (u, icp, par)), which, *(a.ctypes for a in out))
        return out

    F = beam.rod.F
    rate, jacobian, by_force = call(F, 2)
    matrix = beam.jacobian(z)
    terms = np.abs(matrix) @ np.abs(z)  # of the rate, which cancel on a cycle
    assert np.abs(rate - beam.rate(z)).max() < 1e-14 * terms.max()
    assert np.abs(jacobian.T - matrix).max() < 1e-14 * np.abs(matrix).max()
    difference = (call(F + 1, 0)[0] - call(F - 1, 0)[0]) / 2  # exact: the rate is quadratic in F
    assert np.abs(by_force - difference).max() < 1e-14 * terms.max()


def test_auto_continues_the_same_cycles(auto):
    """To the error that its mesh leaves, which falls with the mesh."""
    rough, fine = AutoSetting(14, 15, 3, 3), AutoSetting(16, 9, 5, 3)
    starts = first_cycles(replace(RODS[0], F=49.0), [rough, fine])
    errors = []
    for setting in (rough, fine):
        branch = continued(auto, starts[setting.order], setting, 0.5, 3)
        assert abs(branch.F - 50.0) < 1e-5
        assert len(branch.multipliers) == 3 * setting.order
        assert np.abs(branch.multipliers - 1).min() < 1e-3
        errors.append(exact().at(branch.F).errors_of(branch.period, branch.tip_y_max))
    for name in errors[0]:
        assert errors[1][name] < 3e-7
        assert errors[1][name] < errors[0][name] / 3 < 3e-6


def test_auto_that_loses_its_branch_is_a_failure(auto):
    setting = AutoSetting(8, 2, 2, 3)
    start = first_cycles(RODS[0], [setting])[8]
    with pytest.raises(RuntimeError, match="of 5 cycles"):
        continued(auto, start, setting, 5.0, 5)


def test_auto_is_left_out_in_one_sentence_where_it_is_not_installed(monkeypatch, tmp_path):
    monkeypatch.setattr(auto_peer, "AUTO_LIBRARY", tmp_path / "nowhere")
    blocks, measurements = beside_auto(1, quick=True)
    assert blocks == ["AUTO-07p is skipped: it needs the program (Debian: auto-07p) and gfortran."]
    assert measurements == []


def test_at_equal_error_auto_has_its_fastest_setting():
    def of(method, setting, ms, error):
        return Measurement("", method, setting, 1e-3 * ms, error)

    own = [of(OWN, "1e-06", 4.0, 1e-8), of(OWN, "1e-07", 5.0, 1e-9)]
    peers = [of(AUTO, "a", 40.0, 9e-7), of(AUTO, "b", 10.0, 2e-6), of(AUTO, "c", 80.0, 1e-7)]
    text = ratio_table([*own, *peers])
    assert "| 1e-06 | 4.0 | 1e-06 | 40.0 | a | 10.0 |" in text
    assert "| 1e-07 | 4.0 | 1e-06 | 80.0 | c | 20.0 |" in text
    failed = judged(None, of(AUTO, "d", 1.0, np.inf), RuntimeError("lost"))
    assert "| 1e-07 | 4.0 | 1e-06 |  |  |  |" in ratio_table([*own, failed])
    assert "| AUTO-07p | d | failed (lost) |" in cycle_table([failed])


def test_the_benchmark_writes_its_tables_and_its_figure(monkeypatch, tmp_path):
    few = [replace(f, tolerances=f.tolerances[1:4:2], settling=f.settling[-3:]) for f in families()[3:4]]
    radau = next(f for f in families() if f.name == "SciPy Radau")
    few.append(replace(radau, tolerances=(1e-3, 1e-5), settling=(1e-5,)))
    monkeypatch.setattr("rodsweep.bench.limit_cycle.study.families", lambda: few)
    auto = Measurement("30", AUTO, "p = 14", 1.0, 1e-6)
    monkeypatch.setattr("rodsweep.bench.limit_cycle.study.beside_auto", lambda *_: (["with AUTO"], [auto]))
    study = limit_cycle_study(quick=True)
    text = study.text
    assert "| 30, 10000, 100, 0.01, 1 | sweep over F |" in text
    assert text.endswith("with AUTO")
    assert len(study.table()["error"]) == len(study.measurements) + 5
    assert "| 50 | solve_cycle |" in text
    assert "| 27.43 | waiting, ARKIMEX 5 (default) |" in text
    assert "| ARKIMEX 5 (default) |" in text.split("times the default's time")[1]
    assert ("CVODE is skipped: scikit-sundae is not installed" in text) == (installed(CVODE_MODULE) is None)
    assert {m.case for m in study.measurements} == {"error of the period", "error of the largest tip y"}
    study.draw(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
