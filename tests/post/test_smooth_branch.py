"""A branch as it is drawn, against curves that are known between their cycles."""

import numpy as np
import pytest

from rodsweep.post.branch_curves import CurveOfCycles
from rodsweep.post.figures.smooth_branch import corners_of, through_cycles


def branch_of(u, second_maximum):
    """A branch over u in [0, 1] from a Hopf point: y is the larger of two maxima of y(t)."""
    at = 30 + 170 * u**2
    first = 0.7 * np.sin(2.2 * u) * (1 - 0.2 * u)
    y = np.maximum(first, second_maximum(u))
    return at, y, 0.1 * np.exp(-1.1 * u**2)


def curve_through(u, second_maximum):
    at, y, period = branch_of(u, second_maximum)
    pieces = np.ones(len(u) - 1, dtype=int)
    return CurveOfCycles(at, y, period, pieces, np.ones(len(u), dtype=bool), ())


def farthest(u, second_maximum):
    """The distance of the true branch from the drawn one, in units of the axes."""
    at, y, period, stable = through_cycles(curve_through(u, second_maximum))
    assert len(at) == len(y) == len(period) == len(stable) + 1
    true = branch_of(np.linspace(0, 1, 997), second_maximum)
    off = []
    for drawn, known in ((y, true[1]), (np.log(period), np.log(true[2]))):
        extent = np.array([np.ptp(at), np.ptp(drawn)])
        line, places = np.column_stack([at, drawn]) / extent, np.column_stack([true[0], known]) / extent
        sides = np.diff(line, axis=0)
        away = places[:, None] - line[:-1]
        share = np.clip((away * sides).sum(axis=2) / (sides**2).sum(axis=1), 0, 1)
        off.append(np.linalg.norm(away - share[:, :, None] * sides, axis=2).min(axis=1).max())
    return max(off)


@pytest.mark.parametrize("offset", np.linspace(0, 0.9, 7))
@pytest.mark.parametrize("rise", [1.2, 2.5])
def test_a_corner_is_drawn_where_another_maximum_becomes_the_largest(offset, rise):
    u = np.append(0.0, (np.arange(1, 25) - offset) / (24 - offset))

    def second(u):
        return 0.55 + rise * (u - 0.72)

    curve = curve_through(u, second)
    places = np.column_stack([curve.at, curve.y, np.log(curve.period)])
    assert len(corners_of(places, np.ptp(places, axis=0))) == 1
    assert farthest(u, second) < 5e-4


@pytest.mark.parametrize("count", [12, 24, 48])
def test_a_branch_of_one_maximum_has_no_corner(count):
    u = np.linspace(0, 1, count)
    curve = curve_through(u, lambda u: 0.0 * u)
    places = np.column_stack([curve.at, curve.y, np.log(curve.period)])
    assert not corners_of(places, np.ptp(places, axis=0))
    assert farthest(u, lambda u: 0.0 * u) < 5e-4


def test_a_corner_next_to_a_hopf_point_leaves_few_cycles_on_one_side():
    u = np.linspace(0, 1, 9)
    drawn = through_cycles(curve_through(u, lambda u: 4.0 * (u - 0.1)))
    assert all(np.isfinite(column).all() for column in drawn)
    assert np.ptp(drawn[0]) == pytest.approx(170) and drawn[1].max() < 4
