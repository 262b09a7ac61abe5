"""Crushing forces and ranges from which sentences about rows are made."""

import numpy as np
import pytest

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.post.crushing import crushing_forces
from rodsweep.post.range_unions import intersection_of_ranges, union_of_ranges


def test_the_thinnest_section_of_each_arm_is_crushed_first(tmp_path):
    cones = {"F": 1.0, "k1": [100.0, 400.0], "k2": 50.0, "gamma3": 0.01, "taper": 0.5}
    view = view_of_dataset(rs.sweep("spectrum", **cones, progress=False), tmp_path / "cones.h5")
    assert crushing_forces(view) == pytest.approx([25.0, 100.0])
    rubber = rs.sweep("spectrum", **cones, law="neo_hookean", progress=False)
    assert np.all(crushing_forces(view_of_dataset(rubber, tmp_path / "rubber.h5")) == np.inf)


@pytest.mark.parametrize("sign", [1, -1])
def test_ranges_that_touch_are_joined_at_values_of_either_sign(sign):
    touching = [sorted((sign * 1.0, sign * 5.0)), sorted((sign * 5.0, sign * 10.0))]
    assert union_of_ranges(touching) == [tuple(sorted((sign * 1.0, sign * 10.0)))]
    assert intersection_of_ranges([tuple(touching[0])], [tuple(touching[1])]) == []
