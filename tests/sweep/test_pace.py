"""The time left that a run tells: near the truth and without jumps, for made-up costs of points, no clock."""

import io
from itertools import accumulate

import numpy as np
import pytest

from rodsweep.sweep.progress import is_stderr_a_terminal
from rodsweep.sweep.remaining_time import (
    POINT_COUNT_RATIO_OF_SUCCESSIVE_RECORDS,
    RemainingTimeEstimator,
    duration_text,
    rate_in_words,
)

RANDOM = np.random.default_rng(3)
COLD, WARM = 0.1, 0.01
COSTS = {
    "alike": np.full(400, 0.05),
    "chains": np.tile([COLD] + [WARM] * 19, 40),
    "a cold start": np.concatenate([[4.0], np.full(600, 0.02)]),
    "hard points now and then": np.where(RANDOM.random(1000) < 0.02, 1.0, 0.02),
    "dearer on the way": np.linspace(0.01, 0.04, 500),
    "slow and few": np.full(12, 40.0),
}
"""Seconds of every point of a sweep."""


def told(costs, every=0.0, together=1):
    """(time, what is said to be left, what is left) each time that something is said.

    every: seconds between what is said; together: points that are heard of at once, as of other ranks.
    """
    pace, said, after = RemainingTimeEstimator(len(costs)), [], 0.0
    times = list(accumulate(costs))
    for done in range(together, len(costs) + 1, together):
        now = times[done - 1]
        if now < after:
            continue
        after = now + every
        left = pace.remaining_seconds(done, now)
        if left is not None:
            said.append((now, left, times[-1] - now))
    return np.array(said)


WRONG_BY = {
    "alike": 1e-9,
    "chains": 0.02,
    "a cold start": 0.02,
    "hard points now and then": 0.25,  # some twenty in all: a third of them are known to 1/sqrt(7)
    "dearer on the way": 0.3,  # that it goes on to grow is not foreseen
    "slow and few": 1e-9,
}
"""What may be wrong of the time left after a third, in units of the whole."""
JUMPS_BY = {"hard points now and then": 0.12, "dearer on the way": 0.08}
"""How far the end may move while a tenth of the time passes, in units of the whole; else as above."""


@pytest.mark.parametrize("together", [1, 25])
@pytest.mark.parametrize("kind", [kind for kind in COSTS if kind != "slow and few"])
def test_time_left_is_near_the_truth_after_a_third_and_does_not_jump(kind, together):
    now, left, true = told(COSTS[kind], every=0.1, together=together).T
    whole, end = COSTS[kind].sum(), now + left
    late = np.flatnonzero(now > whole / 3)
    assert np.abs(left - true)[late].max() <= WRONG_BY[kind] * whole
    soon = (late[(late >= i) & (now[late] <= now[i] + whole / 10)] for i in late)
    assert max(np.ptp(end[places]) for places in soon) <= JUMPS_BY.get(kind, WRONG_BY[kind]) * whole


def test_constant_costs_are_foreseen_to_rounding():
    for now, left, true in told(COSTS["alike"]):
        assert left == pytest.approx(true, abs=1e-9), now


@pytest.mark.parametrize("kind", COSTS)
def test_nothing_is_left_at_the_end(kind):
    assert told(COSTS[kind])[-1, 1] == 0


def test_nothing_is_said_before_the_pace_is_known():
    pace = RemainingTimeEstimator(100)
    assert [pace.remaining_seconds(done, now) for done, now in ((0, 5.0), (1, 6.0), (2, 7.0))] == [
        None,
        None,
        None,
    ]
    assert pace.remaining_seconds(3, 8.0) == pytest.approx(97)
    assert RemainingTimeEstimator(1).remaining_seconds(1, 4.0) == 0


def test_a_point_that_does_not_end_is_waited_for():
    pace = RemainingTimeEstimator(20)
    for done in range(1, 11):
        pace.remaining_seconds(done, float(done))
    waits = [pace.remaining_seconds(10, 10.0 + waited) for waited in (1.0, 20.0, 100.0, 1000.0)]
    assert waits == sorted(waits)
    assert waits[-1] > 100


def test_time_left_of_long_points_is_told_from_the_share_that_is_done():
    pace = RemainingTimeEstimator(4)
    assert pace.remaining_seconds(0, 5.0, 0.05) is None, "its start would decide"
    assert pace.remaining_seconds(0, 10.0, 0.5) == pytest.approx(70)
    alone = [
        (now, RemainingTimeEstimator(1).remaining_seconds(0, now, now / 80.0)) for now in (8.0, 40.0, 79.0)
    ]
    assert alone == [(now, pytest.approx(80.0 - now)) for now in (8.0, 40.0, 79.0)]


def test_share_that_is_done_of_the_point_in_work_counts_beside_whole_points():
    pace = RemainingTimeEstimator(10)
    for done in range(1, 6):
        pace.remaining_seconds(done, 10.0 * done)
    assert pace.remaining_seconds(5, 55.0, 0.5) == pytest.approx(45)
    assert pace._seconds_per_point(5, 90.0, 0.5) > 10, "the point in work takes longer than those before it"


def test_memory_does_not_grow_with_the_points():
    pace = RemainingTimeEstimator(10**6)
    for done in range(1, 10**5):
        pace.remaining_seconds(done, done * 1e-3)
    assert len(pace.records) < 3 * np.log(10**5) / np.log(POINT_COUNT_RATIO_OF_SUCCESSIVE_RECORDS)


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0.0, "0 s"), (8.4, "8 s"), (86.0, "86 s"), (87.0, "1.4 min"), (600, "10 min"), (5220, "1.4 h")],
)
def test_times_are_said_to_two_digits(seconds, text):
    assert duration_text(seconds) == text


def test_rates_are_said_by_the_point_where_it_is_slow():
    assert rate_in_words(700, 20.0) == "35/s"
    assert rate_in_words(2, 24.0) == "12 s per point"
    assert rate_in_words(0, 3.0) == ""


def test_a_launcher_that_was_killed_is_no_terminal(monkeypatch):
    """The parent is then process 1, whose files may not be read."""

    def refuse(path):
        raise PermissionError(path)

    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    monkeypatch.setattr("os.readlink", refuse)
    monkeypatch.setattr("sys.stderr", io.StringIO())
    assert not is_stderr_a_terminal()
