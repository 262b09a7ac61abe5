"""Every number that `show` states of sweeps of random rods, against the solvers.

The suite takes a sweep of each task, RODSWEEP_RODS as many as it says (`make survey`: 300).
"""

import os

import pytest

from .sentences import TASKS, random_sweep, wrong_sentences

SWEEPS, BATCH = int(os.environ.get("RODSWEEP_RODS", str(len(TASKS)))), len(TASKS)


@pytest.mark.parametrize("first", range(0, SWEEPS, BATCH))
def test_no_number_that_show_states_is_outside_its_error(first):
    wrong, read = [], 0
    for index in range(first, min(first + BATCH, SWEEPS)):
        found, count = wrong_sentences(*random_sweep(index))
        wrong += [(index, *why) for why in found]
        read += count
    assert wrong == []
    assert read >= min(BATCH, SWEEPS - first), "of every sweep a sentence is read, on average"
