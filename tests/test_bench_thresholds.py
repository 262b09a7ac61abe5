"""The benchmark of thresholds: every peer finds what it claims to find, and what is missed is said."""

import json
import shutil
from dataclasses import replace
from math import inf, isnan, nan
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import ROOT

from rodsweep.bench.thresholds import continuation_codes as continuation_peers
from rodsweep.bench.thresholds import study as thresholds
from rodsweep.bench.thresholds.cases import CASES, Found, Problem, error_of
from rodsweep.bench.thresholds.continuation_codes import (
    auto_program,
    auto_version,
    hopf_by_auto,
    hopf_by_pycont,
    pycont_module,
    reduced,
)
from rodsweep.bench.thresholds.methods import CONTINUATION, HOPF, ONSET, Method, methods
from rodsweep.bench.thresholds.peers import (
    Spectra,
    hopf_by_brent,
    hopf_interpolated,
    onset_between,
    onset_by_bisection,
    onset_by_brent,
    onset_by_square_root,
)
from rodsweep.bench.thresholds.study import measure, table, thresholds_study
from rodsweep.bench.thresholds.study import methods as threshold_methods
from rodsweep.discretization.resolution import Resolution

CASE = {case.name: case for case in CASES}
FLUTTERING = [case for case in CASES if not isnan(case.hopf)]
FLOOR = 3e-12
"""Relative error of a threshold that the mesh of MESH_ACCURACY leaves, and M(F) by its rounding ten times."""
needs_pycont = pytest.mark.skipif(pycont_module() is None, reason="PyCont-Lite is not installed")


@pytest.fixture(scope="module")
def auto(tmp_path_factory):
    program = auto_program(tmp_path_factory.mktemp("auto"))
    if program is None:
        pytest.skip("AUTO-07p or gfortran is not installed")
    return program


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_numbers_of_the_cases_are_those_of_the_reference(case):
    rods = json.loads((ROOT / "tests" / "reference" / "thresholds.json").read_text())
    rod = next(r for r in rods if all(float(r[k]) == getattr(case, k) for k in ("k1", "k2", "gamma3")))
    for kind in (ONSET, HOPF):
        first = next((float(event["F"]) for event in rod["events"] if event["kind"] == kind), nan)
        assert getattr(case, kind) == pytest.approx(first, rel=1e-15, abs=0, nan_ok=True)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-12])
@pytest.mark.parametrize("name", ["Fig. 2b", "filament", "soft"])
def test_root_finding_reaches_its_tolerance(name, tolerance):
    case = CASE[name]
    for search, exact in (
        (hopf_by_brent, case.hopf),
        (onset_by_brent, case.onset),
        (onset_by_bisection, case.onset),
    ):
        found = search(tolerance, case.problem())
        assert error_of(found.force, exact) < tolerance + FLOOR
        assert found.solves < 60


@pytest.mark.parametrize(
    "by_grid, exact, order", [(hopf_interpolated, "hopf", 2), (onset_by_square_root, "onset", 2)]
)
def test_order_of_interpolation(by_grid, exact, order):
    """Twice the points: the error falls by 2^order, if the threshold lies alike between two forces."""
    case = CASE["filament"]
    truth = getattr(case, exact)
    errors = []
    for intervals in (16, 32, 64):
        top = truth * intervals / (0.625 * intervals + 0.5)  # the threshold is halfway between two forces
        found = by_grid(intervals + 1, replace(case.problem(), top=top))
        assert found.solves == intervals + 1
        errors.append(abs(found.force - truth))
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([order, order], abs=0.25)


def test_onset_between_two_forces_is_within_half_a_step():
    case = CASE["filament"]
    for points in (20, 40, 80):
        found = onset_between(points, case.problem())
        assert abs(found.force - case.onset) <= case.top / (points - 1) / 2


def test_a_grid_too_coarse_for_the_window_misses_it():
    problem = CASE["narrow"].problem()
    assert isnan(hopf_interpolated(50, problem).force)
    assert error_of(hopf_interpolated(200, problem).force, CASE["narrow"].hopf) < 1e-2
    assert isnan(hopf_by_brent(1e-6, problem).force)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_the_ordinary_differential_equation_has_the_spectrum_of_the_pencil(case):
    problem = case.problem()
    M0, M1, M2 = reduced(problem)
    for F in (0.0, case.onset + 1, 0.9 * case.top):
        w = Spectra(problem)(F)
        own = np.linalg.eigvals(M0 + F * M1 + F**2 * M2)
        distance = np.abs(own[:, None] - w).min(axis=0) / np.abs(w)
        assert distance.max() < 1e-8


@pytest.mark.parametrize("k1, k2, gamma3", [(1e3, np.inf, 0.0), (np.inf, 1e3, 0.0), (1e3, np.inf, 0.1)])
def test_rods_that_do_not_reduce_are_refused(k1, k2, gamma3):
    with pytest.raises(ArithmeticError):
        reduced(Problem(k1, k2, gamma3, Resolution(1, 8), 60.0))


@pytest.mark.parametrize("case", FLUTTERING, ids=lambda case: case.name)
def test_auto_finds_the_hopf_point_and_gains_from_its_tolerance(auto, case):
    loose, tight = (hopf_by_auto(auto, 1.0, tolerance, case.problem()) for tolerance in (1e-3, 1e-10))
    assert error_of(loose.force, case.hopf) < 1e-3
    assert error_of(tight.force, case.hopf) < 1e-9  # AUTO ends when F moves by less than the tolerance, 1e-10
    assert case.hopf - 1 < loose.solves <= tight.solves < case.hopf + 20
    assert tight.outside > 0


def test_auto_finds_nothing_where_nothing_is(auto):
    found = hopf_by_auto(auto, 1.0, 1e-6, CASE["Fig. 2d"].problem())
    assert isnan(found.force)
    assert not found.failure
    assert "0.9" in auto_version() or not auto_version()


@needs_pycont
def test_pycont_finds_the_hopf_point_in_silence(capsys):
    for name in ("filament", "Fig. 2b"):
        found = hopf_by_pycont(pycont_module(), 0.25, CASE[name].problem())
        assert error_of(found.force, CASE[name].hopf) < 1e-7
        assert found.products > 1000
    assert capsys.readouterr().out == ""


def test_a_continuation_code_that_fails_is_shown_as_failed():
    def give_up(*_):
        raise RuntimeError("no convergence")

    def run(problem):
        return hopf_by_pycont(SimpleNamespace(arclengthContinuation=give_up), 1.0, problem)

    for case in (CASE["filament"], CASE["Fig. 2d"]):
        (result,) = measure(HOPF, [case], [Method("a", "", CONTINUATION, run, slow=True)], 1)
        assert result.error == inf
        assert "| failed (RuntimeError) |" in table(HOPF, [case], [result])


def test_what_is_missed_or_invented_has_no_finite_error():
    assert error_of(10.001, 10.0) == pytest.approx(1e-4)
    assert error_of(nan, 10.0) == inf
    assert error_of(30.0, 10.0) == inf
    assert error_of(10.0, nan) == inf
    assert isnan(error_of(nan, nan))


def test_tables_say_what_was_missed():
    cases = [CASE["filament"], CASE["narrow"], CASE["Fig. 2d"]]
    for force, cells in (
        (nan, "missed | missed | none"),
        (20.0, "wrong (20.00) | wrong (20.00) | wrong (20.00)"),
        (CASE["narrow"].hopf, "wrong (74.83) | 0e+00 | wrong (74.83)"),
    ):
        method = Method("a", "b", "", lambda _, force=force: Found(force, 10), slow=True)
        assert f"| {cells} |" in table(HOPF, cases, measure(HOPF, cases, [method], 1))


def test_time_of_other_programs_is_counted():
    method = Method("a", "", "", lambda _: Found(nan, 1, outside=2.0))
    (result,) = measure(HOPF, [CASE["Fig. 2d"]], [method], 3)
    assert result.seconds == pytest.approx(2.0, abs=0.1)


def test_peers_that_are_not_installed_are_skipped_with_a_line(monkeypatch, tmp_path):
    monkeypatch.setattr(continuation_peers, "pycont_module", lambda: None)
    monkeypatch.setattr(shutil, "which", lambda _: None)
    every, skipped = methods(tmp_path, quick=True)
    assert [line.split(" is skipped")[0] for line in skipped] == ["AUTO-07p", "PyCont-Lite"]
    assert not any(method.group == CONTINUATION for found in every.values() for method in found)


def test_a_program_that_crashes_is_a_failure(tmp_path):
    program = tmp_path / "rod"
    program.write_text("#!/bin/sh\nexit 3\n")
    program.chmod(0o755)
    found = hopf_by_auto(program, 1.0, 1e-6, CASE["filament"].problem())
    assert isnan(found.force)
    assert found.failure == "status 3"


def test_auto_without_its_library_is_not_there(monkeypatch, tmp_path):
    monkeypatch.setattr(continuation_peers, "AUTO_LIBRARY", tmp_path / "nowhere")
    assert auto_program(tmp_path) is None


def test_the_study_writes_its_text_and_its_figure(monkeypatch, tmp_path):
    monkeypatch.setattr(thresholds, "QUICK_CASES", (CASE["filament"], CASE["Fig. 2d"]))
    monkeypatch.setattr(threshold_methods, "GRIDS", (20, 40))
    monkeypatch.setattr(continuation_peers, "pycont_module", lambda: None)
    study = thresholds_study(quick=True)
    rows = [line.split(" | ") for line in study.text.splitlines() if line.startswith("| rodsweep")]
    assert len(rows) == 4
    assert all(float(row[5].strip(" |")) < 1e-14 for row in rows)
    assert all(row[6].strip(" |") == "none" for row in rows[2:])
    assert "PyCont-Lite is skipped" in study.text
    assert {m.group for m in study.measurements} >= {"rodsweep", "grid and interpolation"}
    assert len(study.table()["eigenproblems"]) == len(study.measurements)
    study.draw(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
