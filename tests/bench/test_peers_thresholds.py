"""The peers of the thresholds: each finds what it claims to find, and misses what it may miss."""

import shutil
from dataclasses import replace
from functools import partial
from math import inf, isnan, nan
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq

from benchmarks import auto as auto_peer
from benchmarks import versions
from benchmarks.auto import auto_program
from benchmarks.installed import optional_module
from benchmarks.thresholds import continuation, peers
from benchmarks.thresholds.continuation import (
    CONTINUATION_GROUP,
    PYCONT,
    PYCONT_MODULE,
    hopf_by_auto,
    hopf_by_pycont,
    matrix_polynomial,
)
from benchmarks.thresholds.spectra_by_force import (
    STEP_SEARCHES,
    LeadingPair,
    growth_rate,
    hopf_by_interpolation,
    onset_by_square_root,
    onset_midpoint,
    threshold_by_steps,
    threshold_on_grid,
)
from rodsweep.bench.study import TimedMethod
from rodsweep.bench.thresholds.study import (
    HOPF,
    ONSET,
    UNIFORM_CASES,
    ThresholdCase,
    measure_rods,
    threshold_table,
)

CASE = {case.name: case for case in UNIFORM_CASES}
FLUTTERING = [case for case in UNIFORM_CASES if not isnan(case.hopf)]
FLOOR = 3e-12
"""Relative error of a threshold that the mesh of MESH_ACCURACY leaves, and M(F) by its rounding ten times."""
needs_pycont = pytest.mark.skipif(
    optional_module(PYCONT_MODULE) is None, reason="PyCont-Lite is not installed"
)


@pytest.fixture(scope="module")
def auto(tmp_path_factory):
    program = auto_program(tmp_path_factory.mktemp("auto"), continuation.EQUATIONS)
    if program is None:
        pytest.skip("AUTO-07p or gfortran is not installed")
    return program


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-12])
@pytest.mark.parametrize("name", ["Fig. 2b", "filament", "soft"])
def test_root_finding_reaches_its_tolerance(name, tolerance):
    case = CASE[name]
    for kind, searches in STEP_SEARCHES.items():
        for search in searches.values():
            found = search(tolerance, case)
            assert case.error_of(kind, found.force) < tolerance + FLOOR
            assert found.eigenproblem_count < 60


@pytest.mark.parametrize(
    "estimate, exact, order", [(hopf_by_interpolation, "hopf", 2), (onset_by_square_root, "onset", 2)]
)
def test_order_of_interpolation(estimate, exact, order):
    """Twice the points: the error falls by 2^order, if the threshold lies alike between two forces."""
    case = CASE["filament"]
    truth = getattr(case, exact)
    errors = []
    for intervals in (16, 32, 64):
        top = truth * intervals / (0.625 * intervals + 0.5)  # the threshold is halfway between two forces
        found = threshold_on_grid(estimate, intervals + 1, replace(case, search_end=top))
        assert found.eigenproblem_count == intervals + 1
        errors.append(abs(found.force - truth))
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([order, order], abs=0.25)


def test_onset_between_two_forces_is_within_half_a_step():
    case = CASE["filament"]
    for points in (20, 40, 80):
        found = threshold_on_grid(onset_midpoint, points, case)
        assert abs(found.force - case.onset) <= case.search_end / (points - 1) / 2


def test_a_grid_too_coarse_for_the_window_misses_it():
    case = CASE["narrow"]
    assert isnan(threshold_on_grid(hopf_by_interpolation, 50, case).force)
    assert case.error_of(HOPF, threshold_on_grid(hopf_by_interpolation, 200, case).force) < 1e-2
    assert isnan(threshold_by_steps(brentq, growth_rate, 1e-6, case).force)


@pytest.mark.parametrize("case", UNIFORM_CASES, ids=lambda case: case.name)
def test_the_ordinary_differential_equation_has_the_spectrum_of_the_pencil(case):
    M0, M1, M2 = matrix_polynomial(case)
    for F in (0.0, case.onset + 1, 0.9 * case.search_end):
        w = LeadingPair(case)(F)
        own = np.linalg.eigvals(M0 + F * M1 + F**2 * M2)
        distance = np.abs(own[:, None] - w).min(axis=0) / np.abs(w)
        assert distance.max() < 1e-8


@pytest.mark.parametrize("k1, k2, gamma3", [(1e3, np.inf, 0.0), (np.inf, 1e3, 0.0), (1e3, np.inf, 0.1)])
def test_rods_that_do_not_reduce_are_refused(k1, k2, gamma3):
    with pytest.raises(ArithmeticError):
        matrix_polynomial(ThresholdCase("", k1, k2, gamma3, 20.0, nan))


@pytest.mark.parametrize("case", FLUTTERING, ids=lambda case: case.name)
def test_auto_finds_the_hopf_point_and_gains_from_its_tolerance(auto, case):
    loose, tight = (hopf_by_auto(auto, 1.0, tolerance, case) for tolerance in (1e-3, 1e-10))
    assert case.error_of(HOPF, loose.force) < 1e-3
    assert case.error_of(HOPF, tight.force) < 1e-9  # AUTO ends when F moves by less than the tolerance, 1e-10
    assert case.hopf - 1 < loose.eigenproblem_count <= tight.eigenproblem_count < case.hopf + 20


def test_auto_finds_nothing_where_nothing_is(auto):
    found = hopf_by_auto(auto, 1.0, 1e-6, CASE["Fig. 2d"])
    assert isnan(found.force)
    assert "auto-07p" not in versions() or "0.9" in versions()["auto-07p"]


@pytest.mark.long
@needs_pycont
def test_pycont_finds_the_hopf_point_in_silence(capsys):
    for name in ("filament", "Fig. 2b"):
        found = hopf_by_pycont(optional_module(PYCONT_MODULE), 0.25, CASE[name])
        assert CASE[name].error_of(HOPF, found.force) < 1e-7
        assert found.matrix_vector_product_count > 1000
    assert capsys.readouterr().out == ""


def test_a_continuation_code_that_fails_is_shown_as_failed():
    def give_up(*_):
        raise RuntimeError("no convergence")

    run = partial(hopf_by_pycont, SimpleNamespace(arclengthContinuation=give_up), 1.0)
    for case in (CASE["filament"], CASE["Fig. 2d"]):
        (result,) = measure_rods(
            HOPF, [case], [TimedMethod("a", "", CONTINUATION_GROUP, run, is_slow=True)], 1
        )
        assert result.error == inf
        assert "| failed (RuntimeError) |" in threshold_table(HOPF, [result])


def test_peers_that_are_not_installed_are_skipped_with_a_line(monkeypatch, tmp_path):
    monkeypatch.setattr(continuation, "optional_module", lambda _: None)
    monkeypatch.setattr(shutil, "which", lambda _: None)
    found = peers(quick=True, folder=tmp_path)
    assert [line.split(" is skipped")[0] for line in found.skipped_peer_sentences] == [
        "AUTO-07p",
        "PyCont-Lite",
    ]
    assert {contender.group for contender in found.contenders_of_race(HOPF)} == {"grid and interpolation"}
    assert not any("PyCont" in note for note in found.contender_notes)


def test_peers_that_are_installed_take_part_and_are_explained(tmp_path):
    found = peers(quick=True, folder=tmp_path)
    codes = {c.method for c in found.contenders_of_race(HOPF) if c.group == CONTINUATION_GROUP}
    assert (PYCONT in codes) == (optional_module(PYCONT_MODULE) is not None)
    assert len(codes) + len(found.skipped_peer_sentences) == 2
    assert len(codes) == len(found.contender_notes) - 1
    assert not any(c.group == CONTINUATION_GROUP for c in found.contenders_of_race(ONSET))


def test_a_program_that_crashes_is_a_failure(tmp_path):
    program = tmp_path / "rod"
    program.write_text("#!/bin/sh\nexit 3\n")
    program.chmod(0o755)
    with pytest.raises(RuntimeError, match="status 3"):
        hopf_by_auto(program, 1.0, 1e-6, CASE["filament"])


def test_auto_without_its_library_is_not_there(monkeypatch, tmp_path):
    monkeypatch.setattr(auto_peer, "AUTO_LIBRARY", tmp_path / "nowhere")
    assert auto_program(tmp_path, continuation.EQUATIONS) is None
