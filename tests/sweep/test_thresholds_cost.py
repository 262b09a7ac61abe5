"""The estimated cost of a search for thresholds is a finite number for every allowed force."""

import math

import numpy as np
import pytest

from rodsweep.api.keyword_arguments import config_tree, job_of_tree


@pytest.mark.parametrize("F_max", [200.0, 1e150, 1e300])
def test_cost_of_thresholds_is_finite_without_a_warning(F_max):
    keywords = {"k1": np.inf, "k2": 1e4, "gamma3": 1e-4, "F_max": F_max}
    cost = job_of_tree(config_tree("thresholds", keywords)).task.cost()
    assert 0 < cost.seconds < math.inf
