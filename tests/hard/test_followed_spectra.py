"""Spectra that are followed along random lines and grids, against single points; RODSWEEP_RODS lines."""

import math
import os

import numpy as np
import pytest
from followed_lines import Comparison, line, random_line
from surveyed import few

LINES = int(os.environ.get("RODSWEEP_RODS", "20"))
GRID_ROWS = max(1, LINES // 40)
"""Lines of each grid."""


@pytest.mark.long
def test_random_lines_are_as_single_points():
    rng, comparison = np.random.default_rng(2026), Comparison()
    for number in range(LINES):
        comparison.add(random_line(rng), modes=int(rng.integers(1, 9)), dense=number % 40 == 0)
    print(comparison.points, comparison.followed, comparison.counted)
    assert comparison.differences == []
    assert comparison.followed > 0.95 * comparison.points


@pytest.mark.parametrize("gamma3", few([0.0, 1e-2, 1e-4], 2))
@pytest.mark.parametrize("k1", [math.inf, 1e4, 200.0, 95.0])
def test_grids_are_as_single_points(k1, gamma3):
    """Over onsets and Hopf points, up to near crushing, and to 12 and more unstable modes."""
    comparison = Comparison()
    for k2 in np.geomspace(30, 1e5, GRID_ROWS):
        top = min(0.999 * k1, 90.0)
        comparison.add(line("F", np.linspace(0, top, 320), k1=k1, k2=k2, gamma3=gamma3), dense=False)
    for F in np.linspace(5, min(0.99 * k1, 1500), GRID_ROWS):
        comparison.add(line("k2", np.geomspace(20, 1e5, 200), F=F, k1=k1, gamma3=gamma3), dense=False)
    print(comparison.points, comparison.followed, comparison.unstable)
    assert comparison.differences == []
    assert comparison.followed > 0.9 * comparison.points
