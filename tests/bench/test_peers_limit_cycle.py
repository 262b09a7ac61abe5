"""The peers of the limit cycle: integrators follow the cycle, at their order; AUTO-07p continues the same."""

import ctypes
import shutil
import subprocess
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from surveyed import few, only, survey_only

from benchmarks import auto as auto_peer
from benchmarks.auto import AUTO, AUTO_SKIPPED, auto_program
from benchmarks.limit_cycle import integrators as cycle_peers
from benchmarks.limit_cycle import peers
from benchmarks.limit_cycle.auto_cycles import AutoSetting, continue_cycles, rod_file
from benchmarks.limit_cycle.auto_equations import EQUATIONS
from benchmarks.limit_cycle.continuation import (
    RODSWEEP,
    cycle_table,
    first_cycles,
    judged_measurement,
    ratio_table,
)
from benchmarks.limit_cycle.integrators import CVODE, CVODE_SKIPPED, installed_families
from rodsweep.bench.limit_cycle.default_integrator import DEFAULT_INTEGRATOR, IntegrationTask
from rodsweep.bench.limit_cycle.study import CYCLE_FOLLOWING_RACE_NAME, SETTLING_TO_CYCLE_RACE_NAME
from rodsweep.bench.limit_cycle.sweeping import ACCURACY, MeshConvergedCycle
from rodsweep.bench.limit_cycle.swept_rods import RODS
from rodsweep.bench.limit_cycle.tracking import (
    FOLLOWED_PERIODS,
    SMALL_STEP_SCHEME,
    cycle_request,
    measure_cycle_following,
    orbit_of,
    solve_reference,
    system_and_state_on_cycle,
    trajectory_measurement_fields,
)
from rodsweep.bench.study import Measurement
from rodsweep.solve.cycle.limit_cycle import solve_cycle
from rodsweep.solve.motion.integrator import integrator

FAMILIES = (DEFAULT_INTEGRATOR, *installed_families())
FOLLOWED = few(FAMILIES, 4)
ORDERS = {
    "ARKIMEX 2": (2, 1e-4, 1e-5),
    "ARKIMEX 3": (3, 1e-5, 1e-7),
    "ARKIMEX 4": (4, 3e-6, 1e-8),
    DEFAULT_INTEGRATOR.name: (5, 1e-5, 3e-7),
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
    return solve_reference()


@cache
def rows():
    """Two tolerances of each family."""
    chosen = [
        replace(
            f,
            following_tolerances=LOOSE_AND_TIGHT.get(
                f.name, (f.following_tolerances[0], f.following_tolerances[-1])
            ),
        )
        for f in FOLLOWED
    ]
    return measure_cycle_following(
        cycle(), [c for family in chosen for c in family.following_contenders()], 1
    )


def of(name):
    return [row for row in rows() if row.method == name]


@pytest.mark.long
@pytest.mark.parametrize("family", FOLLOWED, ids=lambda family: family.name)
def test_every_method_follows_the_cycle_and_gains_from_a_tighter_tolerance(family):
    loose, tight = of(family.name)
    assert 0 < tight.error < 3e-5
    assert np.isfinite(loose.error)
    assert tight.error < loose.error / 5
    assert tight.extra_columns["steps"] > loose.extra_columns["steps"]
    assert tight.seconds > 0


@pytest.mark.parametrize("name", only([DEFAULT_INTEGRATOR.name], ORDERS))
def test_order_of_the_errors(name):
    order, *tolerances = ORDERS[name]
    family, at = next(f for f in FAMILIES if f.name == name), cycle()
    over = integrator(at.system.mesh, SMALL_STEP_SCHEME).run(at.system, at.state, at.period, at.period / 128)
    error, steps = np.zeros((2, PHASES)), np.zeros((2, PHASES))
    for phase, state in enumerate(over.states[: 128 : 128 // PHASES + 1]):
        for i, tolerance in enumerate(tolerances):
            run = family.integrate(tolerance, IntegrationTask(at.system, state, FOLLOWED_PERIODS * at.period))
            error[i, phase] = trajectory_measurement_fields(replace(at, state=state), run)["error"]
            steps[i, phase] = len(run.times) - 1
    (loose, tight), (few, many) = np.sqrt((error**2).mean(axis=1)), steps.mean(axis=1)
    assert np.log(loose / tight) / np.log(many / few) == pytest.approx(order, abs=0.7)


def test_cvode_is_left_out_in_one_sentence_where_it_is_not_installed(monkeypatch, tmp_path):
    monkeypatch.setattr(cycle_peers, "optional_module", lambda _: None)
    found = peers(quick=True, folder=tmp_path)
    assert CVODE not in [
        contender.method for contender in found.contenders_of_race(CYCLE_FOLLOWING_RACE_NAME)
    ]
    assert found.skipped_peer_sentences[0] == CVODE_SKIPPED


def test_every_integrator_takes_part_where_it_is_installed(tmp_path):
    found = peers(quick=True, folder=tmp_path)
    assert {c.method for c in found.contenders_of_race(CYCLE_FOLLOWING_RACE_NAME)} == {
        family.name for family in installed_families()
    }
    assert {c.method for c in found.contenders_of_race(SETTLING_TO_CYCLE_RACE_NAME)} == {
        f.name for f in installed_families() if f.settling_tolerances
    }
    assert (AUTO_SKIPPED in found.skipped_peer_sentences) == (not found.section_functions)
    assert (CVODE_SKIPPED in found.skipped_peer_sentences) == (
        CVODE not in {family.name for family in installed_families()}
    )


@cache
def soft_rod():
    """A cycle of the first rod as the task finds it."""
    return orbit_of(solve_cycle(RODS[0], cycle_request(ACCURACY), parameter_name="F"))


@cache
def exact():
    return MeshConvergedCycle.converged_from_orbit(soft_rod())


@pytest.fixture(scope="module")
def auto(tmp_path_factory):
    program = auto_program(tmp_path_factory.mktemp("auto"), EQUATIONS)
    if program is None:
        pytest.skip("AUTO-07p or gfortran is not installed")
    return program


@pytest.mark.skipif(shutil.which("gfortran") is None, reason="gfortran is not installed")
def test_equations_in_fortran_are_those_of_the_beam(tmp_path):
    system, z = system_and_state_on_cycle(soft_rod())
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

    F = system.rod.F
    rate, jacobian, by_force = call(F, 2)
    matrix = system.jacobian(z)
    terms = np.abs(matrix) @ np.abs(z)  # of the rate, which cancel on a cycle
    assert np.abs(rate - system.state_derivative(z)).max() < 1e-14 * terms.max()
    assert np.abs(jacobian.T - matrix).max() < 1e-14 * np.abs(matrix).max()
    difference = (call(F + 1, 0)[0] - call(F - 1, 0)[0]) / 2  # exact: the rate is quadratic in F
    assert np.abs(by_force - difference).max() < 1e-14 * terms.max()


@pytest.mark.long
def test_auto_continues_the_same_cycles(auto):
    """To the error that its mesh leaves, which falls with the mesh."""
    rough, fine = AutoSetting(14, 15, 3, 3), AutoSetting(16, 9, 5, 3)
    starts = first_cycles(replace(RODS[0], F=49.0), [rough, fine])
    errors = []
    for setting in (rough, fine):
        branch = continue_cycles(auto, starts[setting.order], setting, 0.5, 3)
        assert abs(branch.F - 50.0) < 1e-5
        assert len(branch.multipliers) == 3 * setting.order
        assert np.abs(branch.multipliers - 1).min() < 1e-3
        errors.append(exact().cycle_at_force(branch.F).errors_of(branch.period, branch.tip_y_max))
    for name in errors[0]:
        assert errors[1][name] < 3e-7
        assert errors[1][name] < errors[0][name] / 3 < 3e-6


def test_auto_that_loses_its_branch_is_a_failure(auto):
    setting = AutoSetting(8, 2, 2, 3)
    start = first_cycles(RODS[0], [setting])[8]
    with pytest.raises(RuntimeError, match="of 5 cycles"):
        continue_cycles(auto, start, setting, 5.0, 5)


def test_auto_is_left_out_in_one_sentence_where_it_is_not_installed(monkeypatch, tmp_path):
    monkeypatch.setattr(auto_peer, "AUTO_LIBRARY", tmp_path / "nowhere")
    found = peers(quick=True, folder=tmp_path)
    assert (
        found.skipped_peer_sentences[-1]
        == "AUTO-07p is skipped: it needs the program (Debian: auto-07p) and gfortran."
    )
    assert found.section_functions == ()


@survey_only
def test_the_section_of_auto_has_its_tables(tmp_path):
    found = peers(quick=True, folder=tmp_path)
    if not found.section_functions:
        pytest.skip("AUTO-07p or gfortran is not installed")
    (section,) = found.section_functions
    text, measurements = section(1)
    assert [block.count("\n| AUTO-07p | p = ") for block in text] == [0, 2, 0]
    assert text[2].count("\n| 1e-0") == 2
    assert {m.method for m in measurements} == {RODSWEEP, AUTO}


def test_at_equal_error_auto_has_its_fastest_setting():
    def of(method, setting, ms, error):
        return Measurement("", method, setting, 1e-3 * ms, error)

    own = [of(RODSWEEP, "1e-06", 4.0, 1e-8), of(RODSWEEP, "1e-07", 5.0, 1e-9)]
    peers = [of(AUTO, "a", 40.0, 9e-7), of(AUTO, "b", 10.0, 2e-6), of(AUTO, "c", 80.0, 1e-7)]
    text = ratio_table([*own, *peers])
    assert "| 1e-06 | 4.0 | 1e-06 | 40.0 | a | 10.0 |" in text
    assert "| 1e-07 | 4.0 | 1e-06 | 80.0 | c | 20.0 |" in text
    failed = judged_measurement(None, of(AUTO, "d", 1.0, np.inf), RuntimeError("lost"))
    assert "| 1e-07 | 4.0 | 1e-06 |  |  |  |" in ratio_table([*own, failed])
    assert "| AUTO-07p | d | failed (lost) |" in cycle_table([failed])
