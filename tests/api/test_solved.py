"""Solved points in Python: their arrays and their Dataset are one result, whichever is used first."""

import copy
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.api.keyword_arguments import config_tree, job_of_tree
from rodsweep.api.solving_in_process import solve_in_process

ROD = {"F": 30, "k1": 1e4, "k2": 1e2, "gamma3": 1e-2}
ARM = {"length": "10 cm", "radius": "5 mm", "young": "100 kPa", "viscosity": "1.4 Pa s"}
CONFIGS = {
    "rod": ("spectrum", ROD | {"gamma1": 2, "longitudinal": True}),
    "line of rods": ("spectrum", ROD | {"F": [10, 30, 50]}),
    "thresholds": ("thresholds", ROD | {"F": None}),
    "arm": ("spectrum", {"arm": ARM | {"pressure": "2 kPa"}}),
    "arms": ("spectrum", {"arm": ARM | {"pressure": ["2 kPa", "3 kPa"], "radius": ["5 mm", "6 mm"]}}),
    "diagram": ("phase_diagram", ROD | {"F": [0, 60, 90], "k1": [130, 160]}),
}


@pytest.mark.parametrize("config", CONFIGS)
def test_solved_points_and_their_dataset_are_read_alike(config):
    task, keywords = CONFIGS[config]
    given = {name: value for name, value in keywords.items() if value is not None}
    solved = solve_in_process(job_of_tree(config_tree(task, given)))
    early, late = solved.view, view_of_dataset(solved.dataset, Path(task))
    assert early.variables.keys() == late.variables.keys()
    for name, values in late.variables.items():
        assert np.array_equal(early.variables[name], values, equal_nan=True)
        assert early.variables[name].dtype == values.dtype
    assert (early.task, early.config, early.status_flags) == (late.task, late.config, late.status_flags)
    assert (early.parameters, early.arm_axes, early.typed_units) == (
        late.parameters,
        late.arm_axes,
        late.typed_units,
    )
    assert early.is_grid == late.is_grid


@pytest.mark.parametrize("twin", [copy.deepcopy, lambda answer: pickle.loads(pickle.dumps(answer))])
def test_a_copy_of_an_answer_is_the_answer(twin):
    answer = rs.Rod(**ROD).spectrum()
    other = twin(answer)
    assert (other.status, other.config, repr(other)) == (answer.status, answer.config, repr(answer))
    assert np.array_equal(other.eigenvalues, answer.eigenvalues)
    assert other.whole.identical(answer.whole)


def test_a_dataset_has_the_time_of_the_solve_not_of_its_first_use():
    solved = solve_in_process(job_of_tree(config_tree("spectrum", ROD)))
    long_ago = {"started": "2001-01-01T00:00:00+00:00", "finished": "2001-01-01T00:00:01+00:00"}
    used_late = replace(solved, run_attributes={**solved.run_attributes, **long_ago})
    assert long_ago.items() <= used_late.dataset.attrs.items()
