"""Handing out points: every point once, slow rest given back, nobody dismissed too early."""

import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rodsweep.solve_progress import SolvePosition
from rodsweep.sweep.chunk_queue import CHUNK_SECONDS, NO_WORK_LEFT, ChunkQueue, RankReport, chunk_seconds
from rodsweep.sweep.chunk_requests import (
    ANSWER_TAG,
    PROGRESS_TAG,
    REQUEST_TAG,
    STOP_TAG,
    ChunkClient,
    ChunkServer,
)
from rodsweep.sweep.stop import StopRequest


@given(st.lists(st.integers(1, 40), min_size=1, max_size=4), st.integers(1, 4), st.integers(0, 2**32 - 1))
def test_every_unit_is_done_once_whatever_ranks_give_back_and_none_ends_before(sizes, ranks, seed):
    """Each rank does at least one unit of a chunk; it may have got the next one ahead."""
    rng = np.random.default_rng(seed)
    ends = np.cumsum(np.array(sizes) + 1)  # a unit between two ranges is not to do
    todo = [(int(end) - size, int(end)) for size, end in zip(sizes, ends, strict=True)]
    items = [item for start, stop in todo for item in range(start, stop)]
    handout, done = ChunkQueue(todo, ranks), []
    held = {rank: [] for rank in range(ranks)}
    while held:
        rank = rng.choice(list(held))
        chunks = held[rank]
        if len(chunks) == 1 and rng.random() < 0.5:
            ahead = handout.next_chunk_in_advance(rank)
            chunks += [ahead] if ahead else []
        if chunks:
            start, stop = chunks.pop(0)
            at = int(rng.integers(start, stop)) + 1
            done += range(start, at)
            handout.add_report(rank, RankReport(at - start, 10 ** rng.uniform(-4, 1), (at, stop)))
        chunk = None if chunks else handout.next_chunk(rank)
        if chunk == NO_WORK_LEFT:
            assert sorted(done) == items
            del held[rank]
        elif chunk:
            chunks.append(chunk)


def test_chunks_follow_the_pace_and_shrink_towards_the_end():
    handout = ChunkQueue([(0, 100_000)], rank_count=4)
    start, stop = handout.next_chunk(1)
    assert stop - start == 1
    handout.add_report(1, RankReport(1, 1e-3))
    start, stop = handout.next_chunk(1)
    assert stop - start == pytest.approx(CHUNK_SECONDS / 1e-3, abs=1)
    handout = ChunkQueue([(0, 16)], rank_count=4)
    handout.add_report(1, RankReport(1, 1e-6))
    assert handout.next_chunk(1) == (0, 2)


def test_rest_that_is_given_back_goes_to_the_next():
    handout = ChunkQueue([(0, 3)], rank_count=1)
    handout.add_report(0, RankReport(1, 1e-6))
    assert handout.next_chunk(0) == (0, 1)
    handout.add_report(0, RankReport(0, 1.0, (0, 1)))
    assert handout.next_chunk(1) == (0, 1)


def test_idle_rank_waits_while_another_may_give_back():
    handout = ChunkQueue([(0, 1)], rank_count=2)
    assert handout.next_chunk(0) == (0, 1)
    assert handout.next_chunk(1) is None
    handout.add_report(0, RankReport(0, 9.0, (0, 1)))
    assert handout.next_chunk(1) == (0, 1)
    assert handout.next_chunk(0) is None
    handout.add_report(1, RankReport(1, 0.1))
    assert handout.next_chunk(0) == handout.next_chunk(1) == NO_WORK_LEFT


def test_two_threads_share_the_work_without_losing_any():
    handout = ChunkQueue([(0, 5000)], rank_count=2)
    seen: list[list[int]] = [[], []]

    def work(rank):
        report = RankReport()
        while True:
            handout.add_report(rank, report)
            while (chunk := handout.next_chunk(rank)) is None:
                time.sleep(1e-4)
            if chunk == NO_WORK_LEFT:
                return
            seen[rank] += range(*chunk)
            report = RankReport(chunk[1] - chunk[0], 1e-5 * (chunk[1] - chunk[0]))

    threads = [threading.Thread(target=work, args=(rank,)) for rank in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    assert sorted(seen[0] + seen[1]) == list(range(5000))


def test_points_that_all_ranks_have_kept_are_counted():
    handout = ChunkQueue([(0, 9)], rank_count=2)
    for rank, points in ((0, 2), (1, 3), (0, 1)):
        handout.add_report(rank, RankReport(newly_stored_point_count=points))
    assert handout.stored_points == 6


def test_after_a_stop_nobody_gets_more_and_nobody_waits():
    handout = ChunkQueue([(0, 100)], rank_count=2)
    assert handout.next_chunk(0) == (0, 1)
    handout.stop()
    assert handout.next_chunk(1) == NO_WORK_LEFT
    handout.add_report(0, RankReport(0, 1.0, (0, 1)))
    assert handout.next_chunk(0) == NO_WORK_LEFT


def test_many_ranks_ask_the_first_no_more_than_a_thousand_times_a_second():
    assert chunk_seconds(2) == CHUNK_SECONDS
    for ranks in (200, 10_000):
        handout = ChunkQueue([(0, 10**9)], ranks)
        handout.add_report(1, RankReport(1000, 1.0))
        start, stop = handout.next_chunk(1)
        assert ranks / ((stop - start) * 1e-3) <= 1001


def test_next_chunk_is_given_ahead_while_plenty_is_left():
    handout = ChunkQueue([(0, 9)], rank_count=2)
    assert handout.next_chunk(1) == (0, 1)
    assert handout.next_chunk_in_advance(1) == (1, 2)
    assert handout.next_chunk_in_advance(0) is None  # seven units left, fewer than four a rank
    handout.add_report(1, RankReport(1, 9.0))
    for _ in range(7):
        handout.next_chunk(0)
        handout.add_report(0, RankReport(1, 9.0))
    assert handout.next_chunk(0) is None  # rank 1 still has the one that it got ahead, and may give it back
    handout.add_report(1, RankReport(0, 9.0, (1, 2)))
    assert handout.next_chunk(0) == (1, 2)
    handout.add_report(0, RankReport(1, 9.0))
    assert handout.next_chunk(0) == NO_WORK_LEFT


class Mail:
    """In the place of MPI: what one rank receives from another, in order, and what it sends."""

    ANY_SOURCE = -1

    def __init__(self, sender=1):
        self.sender = sender
        self.received, self.sent = {}, []

    def post(self, tag, what):
        self.received.setdefault(tag, []).append(what)

    def Iprobe(self, source, tag, status=None):
        return source in (self.sender, self.ANY_SOURCE) and bool(self.received.get(tag))

    def Get_source(self):
        return self.sender

    def recv(self, source, tag):
        assert source == self.sender
        return self.received[tag].pop(0)

    def send(self, what, dest, tag):
        assert dest == self.sender
        self.sent.append(what)

    def Status(self):
        return self


def claims(mail, todo, monkeypatch, show=lambda words, begun: None):
    """The first rank's claims among two ranks, without a thread."""
    monkeypatch.setattr(ChunkServer, "_serve_until_all_ranks_finish", lambda self: None)
    ranks = SimpleNamespace(MPI=mail, comm=mail, size=2, first=True)
    return ChunkServer(ranks, ChunkQueue(todo, 2), StopRequest(), show)


def test_each_chunk_is_answered_once_whether_asked_for_ahead_or_not(monkeypatch):
    ahead, done = RankReport(is_request_in_advance=True), RankReport(1, 9.0)
    mail = Mail()
    first = claims(mail, [(0, 10)], monkeypatch)
    answers = []
    for report in [RankReport(), ahead, done, ahead, done, ahead, done, ahead, done]:
        mail.post(REQUEST_TAG, report)
        first.poll_messages()
        answers.append(mail.sent.pop() if mail.sent else None)
    # Ahead while eight units are left, then only once the last chunk is done.
    assert answers == [(0, 1), (1, 2), None, (2, 3), None, None, (3, 4), None, (4, 5)]


def test_what_a_stopped_rank_gives_back_is_for_another_run(monkeypatch):
    """Its report may come before the message that it was asked to stop, and while others wait."""
    mail = Mail()
    first = claims(mail, [(0, 1)], monkeypatch)
    for report in (RankReport(), RankReport(0, 9.0, (0, 1), 1, stop_signal="SIGTERM")):
        mail.post(REQUEST_TAG, report)
        first.poll_messages()
    assert first.stop.name == "SIGTERM"
    assert mail.sent == [(0, 1), "SIGTERM", NO_WORK_LEFT]
    assert first.queue.next_chunk(0) == NO_WORK_LEFT


def test_what_the_first_rank_gives_back_when_stopped_is_for_another_run(monkeypatch):
    first = claims(Mail(), [(0, 1)], monkeypatch)
    assert first.next_chunk(RankReport()) == (0, 1)
    first.stop.name = "SIGUSR1"
    assert first.next_chunk(RankReport(0, 9.0, (0, 1), 1)) == NO_WORK_LEFT


@pytest.mark.parametrize("asked", ["the first", "another"])
def test_a_rank_that_is_asked_to_stop_stops_all(monkeypatch, asked):
    mail = Mail()
    first = claims(mail, [(0, 9)], monkeypatch)
    if asked == "another":
        mail.post(STOP_TAG, "SIGTERM")
    else:
        first.stop.name = "SIGTERM"
    first.poll_messages()
    assert first.stop.name == "SIGTERM"
    assert mail.sent == ["SIGTERM"]
    mail.post(REQUEST_TAG, RankReport())
    first.poll_messages()
    assert mail.sent == ["SIGTERM", NO_WORK_LEFT]
    assert first.next_chunk(RankReport()) == NO_WORK_LEFT


def test_progress_counts_what_is_done_of_every_long_point_until_it_is_reported(monkeypatch):
    mail, shown = Mail(), []
    first = claims(mail, [(0, 9)], monkeypatch, lambda words, begun: shown.append((words, begun)))
    mail.post(PROGRESS_TAG, SolvePosition("branch", 0.5))
    first.poll_messages()
    first.report_position(SolvePosition("mesh"))  # its share is not known
    first.report_position(SolvePosition("cycle", 0.25))
    mail.post(REQUEST_TAG, RankReport(1, 9.0))
    first.poll_messages()
    first.report_position(SolvePosition("cycle", 0.75))
    assert shown == [("mesh", 0.5), ("cycle", 0.75), ("cycle", 0.75)]


def other_claims(mail):
    """The claims of a rank that is not the first."""
    return ChunkClient(SimpleNamespace(comm=mail), StopRequest())


def test_another_rank_asks_for_its_next_chunk_when_it_begins_one():
    mail = Mail(sender=0)
    rank, done = other_claims(mail), RankReport(3, 9.0)
    mail.post(ANSWER_TAG, (4, 7))
    assert rank.next_chunk(done) == (4, 7)
    assert mail.sent == [done, RankReport(is_request_in_advance=True)]
    mail.post(ANSWER_TAG, NO_WORK_LEFT)
    assert rank.next_chunk(done) == NO_WORK_LEFT
    assert mail.sent[2:] == [done]


def test_another_rank_tells_the_first_of_a_stop_or_hears_of_it_once():
    mail = Mail(sender=0)
    asked, told = other_claims(mail), other_claims(mail)
    for _ in range(2):
        told.poll_messages()
    assert not told.stop
    asked.stop.name = "SIGUSR1"
    for _ in range(2):
        asked.poll_messages()
    assert mail.sent == ["SIGUSR1"]
    mail.post(STOP_TAG, "SIGUSR1")
    for _ in range(2):
        told.poll_messages()
    assert told.stop.name == "SIGUSR1"
    assert mail.sent == ["SIGUSR1"]
