"""Estimated costs are finite for every allowed force, and close to the times of soft and pulled rods."""

import math

import numpy as np
import pytest

from rodsweep.api.keyword_arguments import config_tree, job_of_tree


@pytest.mark.parametrize("F_max", [200.0, 1e150, 1e300])
def test_cost_of_thresholds_is_finite_without_a_warning(F_max):
    keywords = {"k1": np.inf, "k2": 1e4, "gamma3": 1e-4, "F_max": F_max}
    cost = job_of_tree(config_tree("thresholds", keywords)).task.cost()
    assert 0 < cost.seconds < math.inf


@pytest.mark.parametrize(
    ("task", "keywords", "measured"),
    [
        # Seconds on one core.
        ("spectrum", {"F": -1e4, "k2": 1e4}, 0.016),
        ("spectrum", {"F": -1e4, "k2": 1e2, "gamma3": 1e-2}, 2.8),
        ("spectrum", {"F": -1e6, "k2": 1e4}, 0.24),
        ("spectrum", {"F": 20.0, "k2": 1e-3}, 0.89),
        ("spectrum", {"F": 100.0, "k2": 1e-2}, 2.8),
        ("spectrum", {"F": 100.0, "k2": 1e-3}, 100.0),
        ("spectrum", {"F": 2000.0, "k2": 1e4}, 0.009),
        ("spectrum", {"F": -5e3, "k2": 1e4, "taper": 0.5}, 0.31),
        ("spectrum", {"F": [-1e4, -1e3, 100], "k2": 1e2, "method": "krylov_schur"}, 0.16),
        ("thresholds", {"k2": [0.01, 0.1], "F_max": 45}, 3.4),
        ("thresholds", {"k2": [1, 100], "taper": 0.5, "F_max": 45}, 21.5),
        ("criticality", {"k2": [0.1, 1], "F_max": 45}, 0.65),
        ("phase_diagram", {"F": [0, 20, 40], "k1": [1e3, 1e4], "k2": 0.1}, 0.85),
        ("phase_diagram", {"F": [-1e4, 0, 100], "k1": [3e4, 1e5], "k2": 1e4}, 0.88),
        ("limit_cycle", {"F": -1e4, "k2": 1e4}, 6.5),
        ("limit_cycle", {"F": -100, "k2": 1e4}, 0.1),
        ("limit_cycle", {"F": [30, 40, 60], "k2": 100, "gamma3": 1e-2, "method": "integration"}, 5.2),
    ],
)
def test_costs_of_soft_and_pulled_rods_have_the_size_of_the_measured_times(task, keywords, measured):
    """Within a factor of four; some were estimated at a thousandth of the time."""
    given = {"k1": 1e4, "gamma3": 1e-4} | keywords
    cost = job_of_tree(config_tree(task, given)).task.cost()
    assert measured / 4 < cost.seconds < 4 * measured
