"""Printed answers, tables and pages of `show`: the answer first, aligned, in the window, digits by errors."""

import io
from contextlib import redirect_stdout
from math import floor, log10
from pathlib import Path
from random import Random

import numpy as np
import pytest
from conftest import ROOT
from printed import WINDOW, flaws_of_columns, flaws_of_layout, unit_of
from surveyed import few

import rodsweep as rs
from rodsweep.api.answers.data_frames import data_frame_of
from rodsweep.api.task_results import DatasetResult
from rodsweep.cli.checking import print_job_check
from rodsweep.post.headline.one_rod import ColumnTexts
from rodsweep.post.headline.sentences import HEADLINES
from rodsweep.post.summary import show_summary
from rodsweep.post.tables.alignment import (
    aligned_at_decimal_points,
    aligned_column_cells,
    rewrap_line,
    rows_with_prose,
    table_blocks,
)
from rodsweep.post.tables.column import Column
from rodsweep.results.file.view import read_view
from rodsweep.tasks import TASKS
from rodsweep.tasks.running.job import job_of_file

ROD = {"F": 50, "k1": 1e4, "k2": 1e2, "gamma3": 1e-2}
ARM = {"length": "14 cm", "radius": "4 mm", "young": "100 kPa", "viscosity": "10 Pa s", "pressure": "3 kPa"}
WORDS = ["rod", "beats", "period,", "and", "the", "tip", "reaches", "y", "while", "gamma3", "threshold"]
GROUPS = ["Reliability", "Further results", "Parameters", "Provenance"]
"""Headings of `show` in their order."""


def real(name, values):
    values = np.asarray(values, float)
    return Column(name, "1", name, values, np.isnan(values))


def sentence(rng):
    return " ".join(rng.choices(WORDS, k=rng.randint(1, 60)))


@pytest.mark.parametrize("seed", range(20))
def test_a_number_has_the_digits_that_its_error_allows(seed):
    """The last digit is that of the error's first; the error that is printed holds the printed number."""
    rng = np.random.default_rng(seed)
    values = rng.choice([-1, 1], 50) * 10 ** rng.uniform(-8, 8, 50)
    relative = 10 ** rng.uniform(-13, -1, 50)
    columns = [real("period", values), real("period_error", relative)]
    pairs = ColumnTexts(columns, {}).value_and_error_texts("period")
    for (text, stated), value, error in zip(pairs, values, relative * np.abs(values), strict=True):
        digit = 10.0 ** floor(log10(error))
        assert unit_of(text) > 0.9999 * digit, (text, value, error)
        assert abs(float(text) - value) <= 0.5001 * digit, (text, value, error)
        assert error + abs(float(text) - value) <= float(stated) * (1 + 1e-8)
        assert len(stated.partition("e")[0]) == 1
    printed = [float(text) for text in ColumnTexts(columns, {}).texts("period_error")]
    numbers = np.array([float(text) for text, _ in pairs])
    assert (np.abs(numbers - values) <= np.array(printed) * np.abs(values)).all()


def test_numbers_of_unknown_error_have_six_digits_and_missing_ones_none():
    digits = ColumnTexts([real("tip_x_max", [0.123456789, np.nan, 0, np.inf])], {})
    assert digits.value_and_error_texts("tip_x_max") == [("0.123457", ""), ("", ""), ("0", ""), ("inf", "")]


def test_a_number_below_its_error_has_no_digit():
    columns = [real("multiplier", [0.0005, -0.04, 3]), real("multiplier_error", [0.01, 0.05, 20])]
    assert ColumnTexts(columns, {}).texts("multiplier") == ["0.00", "-0.04", "0"]


def test_an_si_number_has_the_relative_error_of_its_own():
    columns = [real("period", [0.5]), real("period_si", [320.262]), real("period_error", [1e-3])]
    assert ColumnTexts(columns, {"period": "period_si"}).value_and_error_texts("period_si") == [
        ("320.3", "4e-01")
    ]


@pytest.mark.parametrize("seed", range(20))
def test_columns_are_aligned_in_blocks_within_the_window(seed):
    rng = Random(seed)
    rows = rng.randint(1, 6)
    names = ["mode", *(f"name{'_long' * rng.randint(0, 3)}_{i}" for i in range(rng.randint(1, 9)))]
    columns = [[str(i + 1) for i in range(rows)]]
    columns += [
        [f"{rng.uniform(-1, 1) * 10 ** rng.randint(-9, 9):.{rng.randint(1, 12)}g}" for _ in range(rows)]
        for _ in names[1:]
    ]
    cells = [
        aligned_column_cells((name, "k3/L^2"), column) for name, column in zip(names, columns, strict=True)
    ]
    found = [line for block in table_blocks(cells) for line in (*block, "")]
    assert max(map(len, found)) <= WINDOW
    assert not list(flaws_of_columns("\n".join(["", *found])))
    told = " ".join(found).split()
    for text in (*names, *(cell for column in columns for cell in column)):
        assert text in told


@pytest.mark.parametrize("seed", range(20))
def test_prose_and_sentences_are_folded_within_the_window_and_whole(seed):
    rng = Random(seed)
    table = [
        ("x" * rng.randint(1, 40), f"{rng.uniform(0, 1e6):.8g}", "k3/L^2", sentence(rng)) for _ in range(5)
    ]
    lines = rows_with_prose(table)
    assert max(map(len, lines)) <= WINDOW
    assert all(word in " ".join(lines) for row in table for word in " ".join(row).split())
    text = "  " * rng.randint(0, 1) + f"{sentence(rng)} k1 = 147.9215 (+- 9e-13), {sentence(rng)}"
    folded = rewrap_line(text)
    assert max(map(len, folded.splitlines())) <= WINDOW
    assert folded.split() == text.split()
    assert "k1 = 147.9215 (+- 9e-13)" in folded


def test_points_are_below_each_other_and_words_at_the_left():
    assert aligned_at_decimal_points(["1", "-22.5", "3e-09"]) == ["  1    ", "-22.5  ", "  3e-09"]
    assert aligned_at_decimal_points(["hopf", "fold", ""]) == ["hopf", "fold", "    "]


def test_every_task_of_one_rod_has_a_headline():
    assert HEADLINES.keys() == {name for name in TASKS if hasattr(rs.Rod, name)}


@pytest.mark.parametrize("task", ["spectrum", "modes", "thresholds", "criticality"])
@pytest.mark.parametrize("made", [lambda: rs.Rod(**ROD), lambda: rs.Arm(**ARM)], ids=["rod", "arm"])
def test_an_answer_is_laid_out_well(task, made):
    answer = getattr(made(), task)()
    assert not list(flaws_of_layout(answer))
    assert answer.status in repr(answer)
    whole = " ".join(repr(answer.table()).split())
    for name, meaning in answer.meanings.items():
        if name not in ("status", "seconds") and answer.data[name].ndim == 0:
            assert name in whole
            unknown = answer.data[name].dtype.kind == "f" and np.isnan(answer.data[name])
            assert unknown or meaning.removesuffix("; -1: not known") in whole


def test_an_answer_that_failed_begins_with_the_meaning_of_its_status():
    whole = rs.Rod(**ROD).spectrum().whole.copy(deep=True)
    flags = dict(
        zip(whole.status.attrs["flag_meanings"].split(), whole.status.attrs["flag_values"], strict=True)
    )
    whole["status"][...] = flags["failed"]
    for name in ("growth_rate", "frequency", "error_estimate"):
        whole[name][...] = np.nan
    whole["unstable_count"][...] = -1
    answer = rs.Answer("rod", DatasetResult(whole), "no factorization")
    first, second, *_ = repr(answer).splitlines()
    assert first.startswith(f"spectrum: {answer.sentence[:60]}")
    assert "rod, spectrum: failed" in repr(answer)
    assert not list(flaws_of_layout(answer))


@pytest.mark.long
@pytest.mark.parametrize("width", few([80, 120], 1))
@pytest.mark.parametrize(
    ("task", "asked"),
    [
        ("spectrum", ROD),
        ("spectrum", ROD | {"F": [10, 30, 50], "k1": [200, 1e4]}),
        ("modes", ROD | {"F": [10, 50]}),
        ("thresholds", ROD | {"F": None, "k2": [1e2, 1e4]}),
        ("criticality", {"k1": 200, "k2": 1e4, "gamma3": 1e-4, "F_max": 180}),
        ("phase_diagram", {"F": [0, 50, 90], "k1": [130, 160], "k2": 1e4, "gamma3": 1e-4}),
        ("thresholds", {"arm": {name: value for name, value in ARM.items() if name != "pressure"}}),
        ("spectrum", {"arm": ARM | {"pressure": ["1 kPa", "3 kPa"]}}),
    ],
)
def test_show_stays_in_the_window_with_a_heading_for_each_group(task, asked, width, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", str(width))
    rs.sweep(task, **{name: value for name, value in asked.items() if value is not None}).to_netcdf("r.nc")
    page = io.StringIO()
    with redirect_stdout(page):
        show_summary(read_view(Path("r.nc")))
    lines = page.getvalue().splitlines()
    assert max(map(len, lines)) <= width
    assert lines[0] == f"r.nc: {task}, task {task}"
    assert lines[1].strip()
    assert lines[1] not in GROUPS
    headings = [line for line in lines if line in GROUPS]
    assert headings == [group for group in GROUPS if group in headings]
    assert {"Reliability", "Parameters", "Provenance"} <= set(headings)
    assert all(lines[lines.index(heading) - 1] == "" for heading in headings)


@pytest.mark.parametrize("name", ["fig2c", "taper", "segments", "beating_arm"])
def test_check_stays_in_the_window(name, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(WINDOW))
    page = io.StringIO()
    with redirect_stdout(page):
        print_job_check(job_of_file(ROOT / "configs" / f"{name}.yaml", ()))
    lines = page.getvalue().splitlines()
    assert max(map(len, lines)) <= WINDOW
    assert any(line.startswith("expected cost: ") for line in lines)


def test_a_frame_holds_no_negative_zero():
    frame = data_frame_of([real("multiplier_imag", [-0.0, -1.5, np.nan])])
    assert frame.to_csv(index=False, header=False, na_rep="none") == "0.0\n-1.5\nnone\n"
