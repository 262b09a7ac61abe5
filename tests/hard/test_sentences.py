"""Every number on the page of `show` and in figures of random rods and arms, and in reports on arms.

Each is held against the solvers; a number or a mark that nothing compares fails as well. The suite takes a
sweep of each task, RODSWEEP_RODS as many as it says (`make survey`: 300).
"""

import functools
import os
from dataclasses import replace

import numpy as np
import pytest
from surveyed import RODS

from . import arm_sentences, figures, sentences
from .arm_sentences import random_report, wrong_report
from .figures import random_figure, wrong_figure
from .page import IN_SIGHT, Page, page_of, unit_of
from .sentences import TASKS, random_sweep, solved, wrong_sentences
from .truths import changes_over_force

SWEEPS, BATCH = int(os.environ.get("RODSWEEP_RODS", str(len(TASKS)))), len(TASKS)
LEAST_READ = 10
"""Numbers on a page, on average, below which the reader no longer reads."""


@pytest.mark.parametrize("first", range(0, SWEEPS, BATCH))
def test_no_number_that_show_states_is_outside_its_error(first):
    wrong, read = [], 0
    for index in range(first, min(first + BATCH, SWEEPS)):
        found, count = wrong_sentences(*random_sweep(index))
        wrong += [(index, *why) for why in found]
        read += count
    assert wrong == []
    assert read >= LEAST_READ * min(BATCH, SWEEPS - first)


REPORTS = SWEEPS if RODS else 3


@pytest.mark.parametrize("first", range(0, REPORTS, BATCH))
def test_no_number_in_the_report_on_an_arm_is_wrong(first):
    wrong, read = [], 0
    for index in range(first, min(first + BATCH, REPORTS)):
        found, count = wrong_report(random_report(index))
        wrong += [(index, *why) for why in found]
        read += count
    assert wrong == []
    assert read >= LEAST_READ * min(BATCH, REPORTS - first)


LEAST_MARKS = 10
"""Marks of a figure, on average, below which the reader no longer reads."""


@pytest.mark.long
@pytest.mark.parametrize("first", range(0, SWEEPS, BATCH))
def test_no_text_and_no_mark_of_a_figure_is_wrong(first):
    wrong, marks, drawn = [], 0, 0
    for index in range(first, min(first + BATCH, SWEEPS)):
        found, counts = wrong_figure(*random_figure(index))
        wrong += [(index, *why) for why in found]
        drawn += counts is not None
        marks += counts[-1] if counts else 0
    assert wrong == []
    assert marks >= LEAST_MARKS * drawn > 0


LINE_OF_SPECTRA = {"F": [10.0, 20.0, 30.0, 40.0], "k1": 1e4, "k2": 1e2, "gamma3": 1e-2, "modes": 2}
DRAWN = {
    "spectrum": (LINE_OF_SPECTRA, {}, "growth_rate"),
    "thresholds": ({"k1": [150.0, 200.0, 300.0], "k2": 1e4, "gamma3": 1e-4, "F_max": 60.0}, {}, "F_hopf"),
}


@pytest.mark.long
@pytest.mark.parametrize("task", DRAWN)
def test_the_reader_finds_a_mark_that_is_wrong(task, monkeypatch):
    """A hundredth off, in the file that is drawn."""
    keywords, choices, name = DRAWN[task]
    true = figures.view_of_dataset

    def off(*given):
        view = true(*given)
        values = {n: np.asarray(view.variables[n]) for n in view.variables}
        return replace(view, variables=values | {name: 1.01 * values[name]})

    assert wrong_figure(task, keywords, choices, None)[0] == []
    monkeypatch.setattr(figures, "view_of_dataset", off)
    assert wrong_figure(task, keywords, choices, None)[0] != []


TEXTS_OFF = {"27.4272": "27.4372", "14.7993": "14.7893", "10^{4}": "10^{5}"}


@pytest.mark.long
@pytest.mark.parametrize("number", TEXTS_OFF)
def test_the_reader_finds_a_number_in_a_figure_that_is_wrong(number, monkeypatch):
    true = figures.Drawing._texts
    monkeypatch.setattr(
        figures.Drawing, "_texts", lambda d: (text.replace(number, TEXTS_OFF[number]) for text in true(d))
    )
    assert wrong_figure("spectrum", LINE_OF_SPECTRA, {}, None)[0] != []


ROD = {"F": [45.0, 60.0], "k1": 200.0, "k2": 1e4, "gamma3": 1e-4, "accuracy": 1e-4}
CYCLES = ("period", "tip_y_max", "frequency", "injection_mean", "multiplier", "linear_growth_rate")


@pytest.mark.parametrize("name", CYCLES)
def test_the_reader_finds_a_number_that_is_wrong(name, monkeypatch):
    """A hundredth off, in what is solved to the accuracy of the sweep, not in what is solved far better."""
    true = solved

    def off(task, keywords):
        view = true(task, keywords)
        if keywords["accuracy"] < ROD["accuracy"]:
            return view
        values = {n: np.asarray(view.variables[n]) for n in view.variables}
        return replace(view, variables=values | {name: 1.01 * values[name] + (name == "multiplier")})

    monkeypatch.setattr(sentences, "solved", off)
    assert wrong_sentences("limit_cycle", ROD)[0] != []


ARM = {
    "length": "2.4 cm",
    "young": ["160 kPa", "200 kPa"],
    "radius": "1.5 mm",
    "inner_radius": "0.7 mm",
    "poisson": 0.42,
    "viscosity": "273.7 Pa s",
    "drag": "range",
}
LOADED = {"young": "160 kPa", "pressure_over_flutter": [0.97, 1.5]}
OF_ARMS = {
    "thresholds": {"arm": ARM, "F_max": 60.0},
    "spectrum": {"arm": ARM | LOADED},
    "limit_cycle": {"arm": ARM | LOADED, "accuracy": 1e-3},
}
LEAST_LINES = 3
"""Lines in the units of an arm, below which its page has lost some."""
UNITS_OFF = 3
"""Units of its last digit by which a number is wrong that has to be found; a third of it, where more."""


@pytest.mark.long
@pytest.mark.parametrize("task", OF_ARMS)
def test_the_reader_finds_a_number_of_an_arm_that_is_wrong(task, monkeypatch):
    """The first number of every line in the arm's units, one after another."""
    views = functools.cache(lambda accuracy: solved(task, OF_ARMS[task] | accuracy_of(accuracy)))
    for reader in (sentences, arm_sentences):
        monkeypatch.setattr(reader, "changes_over_force", functools.cache(changes_over_force))
    monkeypatch.setattr(sentences, "solved", lambda _, keywords: views(keywords.get("accuracy")))
    page = page_of(views(OF_ARMS[task].get("accuracy")))
    lines = page[: page.index("the same in dimensionless numbers:")]
    assert wrong_sentences(task, OF_ARMS[task])[0] == []
    missed = []
    for i, line in enumerate(lines):
        if (number := IN_SIGHT.search(line)) is None:
            continue
        value = float(number[1])
        off = max(UNITS_OFF * unit_of(number[1]), abs(value) / 3)
        changed = f"{line[: number.start(1)]}{value + off:.12g}{line[number.end(1) :]}"
        other = Page("\n".join(["", *page[:i], changed, *page[i + 1 :]]))
        monkeypatch.setattr(sentences, "page_of", lambda _, other=other: other)
        missed += [] if wrong_sentences(task, OF_ARMS[task])[0] else [changed]
    assert missed == []
    assert len(lines) >= LEAST_LINES


def accuracy_of(accuracy):
    return {} if accuracy is None else {"accuracy": accuracy}
