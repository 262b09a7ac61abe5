"""A branch as it is drawn, against curves that are known between their cycles."""

import numpy as np
import pytest
from surveyed import few

from rodsweep.post.figures.smooth_branch import corners_by_previous_cycle, smooth_curve_of_branch
from rodsweep.post.stored_branches import StoredBranch


def branch_of(u, second_maximum):
    """A branch over u in [0, 1] from a Hopf point: y is the larger of two maxima of y(t)."""
    at = 30 + 170 * u**2
    first = 0.7 * np.sin(2.2 * u) * (1 - 0.2 * u)
    y = np.maximum(first, second_maximum(u))
    return at, y, 0.1 * np.exp(-1.1 * u**2)


def curve_through(u, second_maximum):
    at, y, period = branch_of(u, second_maximum)
    pieces = np.ones(len(u) - 1, dtype=int)
    return StoredBranch(at, y, period, pieces, np.ones(len(u), dtype=bool), ())


def farthest(u, second_maximum):
    """The distance of the true branch from the drawn one, in units of the axes."""
    at, y, period, stable = smooth_curve_of_branch(curve_through(u, second_maximum))
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


@pytest.mark.long
@pytest.mark.parametrize("offset", few(np.linspace(0, 0.9, 7), 3))
@pytest.mark.parametrize("rise", [1.2, 2.5])
def test_a_corner_is_drawn_where_another_maximum_becomes_the_largest(offset, rise):
    u = np.append(0.0, (np.arange(1, 25) - offset) / (24 - offset))

    def second(u):
        return 0.55 + rise * (u - 0.72)

    curve = curve_through(u, second)
    places = np.column_stack([curve.parameter, curve.tip_y_max, np.log(curve.period)])
    assert len(corners_by_previous_cycle(places, np.ptp(places, axis=0))) == 1
    assert farthest(u, second) < 5e-4


@pytest.mark.parametrize("count", [12, 24, 48])
def test_a_branch_of_one_maximum_has_no_corner(count):
    u = np.linspace(0, 1, count)
    curve = curve_through(u, lambda u: 0.0 * u)
    places = np.column_stack([curve.parameter, curve.tip_y_max, np.log(curve.period)])
    assert not corners_by_previous_cycle(places, np.ptp(places, axis=0))
    assert farthest(u, lambda u: 0.0 * u) < 5e-4


def test_a_corner_may_lie_behind_the_second_cycle_from_a_hopf_point():
    u = np.linspace(0, 1, 9)
    at, y, period = 30 + 170 * u, np.maximum(u, 4 * u - 0.48), np.exp(-u)
    curve = StoredBranch(at, y, period, np.ones(8, dtype=int), np.ones(9, dtype=bool), ())
    places = np.column_stack([at, y, np.log(period)])
    (corner,) = corners_by_previous_cycle(places, np.ptp(places, axis=0)).items()
    assert corner[0] == 1
    assert corner[1] == pytest.approx([30 + 170 * 0.16, 0.16, -0.16], rel=1e-9)
    x, drawn, drawn_period, _ = smooth_curve_of_branch(curve)
    beyond = (x - 30) / 170 >= 0.16  # before, the branch leaves its mirror image at y = 0
    true = (x[beyond] - 30) / 170
    assert drawn[beyond] == pytest.approx(4 * true - 0.48, abs=1e-9)
    assert drawn_period[beyond] == pytest.approx(np.exp(-true), rel=1e-9)
    assert (np.diff(x) >= 0).all() and (np.diff(drawn) >= 0).all()


def test_steps_that_grow_at_a_bend_make_no_waves():
    at = np.array([82.0, 84, 86, 88.3, 91, 93.1, 96.3, 100.9, 105.9, 107.6])

    def log_period(at):
        return 0.3 * np.logaddexp(0, (at - 97) / 3.5) ** 1.5 / 8 - 0.02 * np.tanh((at - 82) / 3)

    fine = np.linspace(at[0], at[-1], 2001)
    pieces = np.ones(len(at) - 1, dtype=int)
    curve = StoredBranch(at, 0.1 - 1e-4 * (at - 91) ** 2 / 3, np.exp(log_period(at)), pieces, pieces > 0, ())
    x, _, period, _ = smooth_curve_of_branch(curve)
    off = np.interp(fine, x, np.log(period)) - log_period(fine)
    assert np.abs(off).max() < 4e-3 * np.ptp(log_period(at))


def test_a_branch_that_ends_next_to_its_hopf_point_is_a_square_root_to_its_end():
    """With the steps of a branch of a rod, which is followed over a twentieth of its force."""
    sizes = [0.0, 0.0200, 0.0220, 0.0241, 0.0282, 0.0365, 0.0451, 0.0629, 0.0922, 0.1257, 0.1650, 0.2056]
    y = np.array(sizes)
    curve = StoredBranch(
        37.93 * (1 + 1.56 * y**2), y, 0.1 * np.exp(-0.5 * y**2), np.ones(11, int), np.ones(12, bool), ()
    )
    at, drawn, _, _ = smooth_curve_of_branch(curve)
    true = np.sqrt(np.maximum(at / 37.93 - 1, 0) / 1.56)
    off = np.abs(drawn - true)[np.append(False, np.diff(at) > 0)]
    assert off.max() < 1e-4 * sizes[-1]
