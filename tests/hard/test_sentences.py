"""Every number on the page of `show` for random rods and arms, and in reports on arms, against the solvers.

A number that nothing compares fails as well. The suite takes a sweep of each task, RODSWEEP_RODS as many
as it says (`make survey`: 300).
"""

import os
from dataclasses import replace

import numpy as np
import pytest

from . import sentences
from .arm_sentences import random_report, wrong_report
from .sentences import TASKS, random_sweep, solved, wrong_sentences

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


@pytest.mark.parametrize("first", range(0, SWEEPS, BATCH))
def test_no_number_in_the_report_on_an_arm_is_wrong(first):
    wrong, read = [], 0
    for index in range(first, min(first + BATCH, SWEEPS)):
        found, count = wrong_report(random_report(index))
        wrong += [(index, *why) for why in found]
        read += count
    assert wrong == []
    assert read >= LEAST_READ * min(BATCH, SWEEPS - first)


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
