"""The benchmark of thresholds: its exact numbers, and what it says of what is missed."""

import json
from math import inf, isnan, nan

import pytest
from conftest import ROOT
from reference import dense_arm

from rodsweep.bench.peers import NO_PEERS, PeerContribution
from rodsweep.bench.study import TimedMethod
from rodsweep.bench.thresholds import study as thresholds
from rodsweep.bench.thresholds.study import (
    ARM_CASES,
    ARM_INTRODUCTION,
    HOPF,
    ONSET,
    UNIFORM_CASES,
    FirstThreshold,
    ThresholdCase,
    measure_rods,
    run_thresholds_study,
    threshold_table,
)

CASE = {case.name: case for case in UNIFORM_CASES}


@pytest.mark.parametrize("case", UNIFORM_CASES, ids=lambda case: case.name)
def test_numbers_of_the_cases_are_those_of_the_reference(case):
    rods = json.loads((ROOT / "tests" / "reference" / "thresholds.json").read_text())
    rod = next(r for r in rods if all(float(r[k]) == getattr(case, k) for k in ("k1", "k2", "gamma3")))
    for kind in (ONSET, HOPF):
        first = next((float(event["F"]) for event in rod["events"] if event["kind"] == kind), nan)
        assert getattr(case, kind) == pytest.approx(first, rel=1e-15, abs=0, nan_ok=True)


@pytest.mark.parametrize("case", ARM_CASES, ids=lambda case: case.name)
def test_numbers_of_the_arms_are_those_of_another_code(case):
    w = dense_arm.eigenvalues(case.rod(case.hopf), p=10)
    assert abs(w[0].real) < 1e-8 * abs(w[0])
    w = dense_arm.eigenvalues(case.rod(case.onset), p=10)
    assert abs((w[0] - w[1]) ** 2) < 1e-7 * abs(w[0]) ** 2


def test_what_is_missed_or_invented_has_no_finite_error():
    case = ThresholdCase("", 1e4, 1e4, 1e-4, 10.0, nan)
    assert case.error_of(ONSET, 10.001) == pytest.approx(1e-4)
    assert case.error_of(ONSET, nan) == inf
    assert case.error_of(ONSET, 30.0) == inf
    assert case.error_of(HOPF, 10.0) == inf
    assert isnan(case.error_of(HOPF, nan))


def test_tables_say_what_was_missed():
    cases = [CASE["filament"], CASE["narrow"], CASE["Fig. 2d"]]
    for force, cells in (
        (nan, "missed | missed | none"),
        (20.0, "wrong (20.00) | wrong (20.00) | wrong (20.00)"),
        (CASE["narrow"].hopf, "wrong (74.83) | 0e+00 | wrong (74.83)"),
    ):
        method = TimedMethod("a", "b", "", lambda _, force=force: FirstThreshold(force, 10), is_slow=True)
        assert f"| {cells} |" in threshold_table(HOPF, measure_rods(HOPF, cases, [method], 1))


@pytest.mark.long
def test_the_study_writes_its_text_and_its_figure(monkeypatch, tmp_path):
    monkeypatch.setattr(thresholds, "QUICK_CASES", (CASE["filament"], CASE["Fig. 2d"]))
    study = run_thresholds_study(quick=True, peers=NO_PEERS)
    rows = [line.split(" | ") for line in study.text.splitlines() if line.startswith("| rodsweep")]
    assert len(rows) == 8
    of_rods, of_arms = rows[:4], rows[4:]
    assert all(float(row[5].strip(" |")) < 1e-14 for row in of_rods)
    assert all(row[6].strip(" |") == "none" for row in of_rods[2:])
    assert all(float(cell.strip(" |")) < 1e-12 for row in of_arms for cell in row[5:])
    assert {m.group for m in study.measurements} == {"rodsweep"}
    assert len(study.table()["eigenproblems"]) == len(study.measurements)
    study.draw(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.long
def test_peers_take_part_in_the_race_of_their_threshold(monkeypatch):
    monkeypatch.setattr(thresholds, "QUICK_CASES", (CASE["filament"],))
    found = TimedMethod("of Hopf points", "a", "g", lambda case: FirstThreshold(case.hopf, 1))
    peers = PeerContribution(
        {HOPF: [found]}, contender_notes=["A note."], skipped_peer_sentences=["Another is skipped."]
    )
    text = run_thresholds_study(quick=True, peers=peers).text
    introduction, onsets, hopf_points, of_arms, onsets_of_arms, hopf_points_of_arms, skipped = text.split(
        "\n\n"
    )
    assert introduction.endswith(" A note.")
    assert of_arms == ARM_INTRODUCTION
    assert "of Hopf points" not in onsets + onsets_of_arms
    assert "| of Hopf points | a |" in hopf_points
    assert "| of Hopf points | a |" in hopf_points_of_arms
    assert skipped == "Another is skipped."
