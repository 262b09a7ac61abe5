"""The processes that solve for the page of `explore`: newest request first, none left behind."""

import asyncio
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np
import pytest

import rodsweep as rs
from rodsweep.explore.page_state import PageState
from rodsweep.explore.solving.requests import Reply, SolveRequest
from rodsweep.explore.solving.solver_processes import CancellationDelays, SolverProcess, SolverProcesses

HARD = PageState().with_values(taper="0.6")
"""A rod whose branches take half a minute."""
SLOW = SolveRequest("branch", HARD)
QUICK = SolveRequest("thresholds", PageState())
LONGEST = 60.0
"""Seconds that a loaded machine may need to start a process and to solve one request."""


def wait_until(is_true: Callable[[], object]) -> None:
    """Runs the loop until a condition holds; AssertionError after `LONGEST`."""

    async def waiting() -> None:
        end = time.monotonic() + LONGEST
        while not is_true():
            assert time.monotonic() < end, "the solver did not answer"
            await asyncio.sleep(0.01)

    asyncio.get_event_loop().run_until_complete(waiting())


@pytest.fixture(scope="module", autouse=True)
def loop():
    made = asyncio.new_event_loop()
    asyncio.set_event_loop(made)
    yield made
    made.close()
    asyncio.set_event_loop(None)


@pytest.fixture(scope="module")
def solver():
    """One process for the tests that leave it idle: to start it takes a second."""
    made = SolverProcess(
        CancellationDelays(min_age_of_cancelled_solve=0.05, kill_after_cancellation_seconds=LONGEST)
    )
    yield made
    made.close()


def exists(pid: int) -> bool:
    """Whether a process runs; a zombie does not."""
    try:
        with open(f"/proc/{pid}/stat") as stat:
            return stat.read().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_an_answer_is_that_of_the_python_interface(solver):
    replies: list[Reply] = []
    solver.ask(("page", "spectrum"), SolveRequest("spectrum", PageState()), replies.append)
    wait_until(lambda: replies)
    found = replies[0].content
    answer = rs.Rod(F=50, k1=1e4, k2=100, gamma3=0.01).spectrum(modes=6)
    assert replies[0].outcome == "answer"
    assert found["growth_rate"] == pytest.approx(answer.growth_rate, rel=1e-10)
    assert (found["unstable_count"], bool(found["certified"])) == (answer.unstable_count, answer.certified)


def test_what_the_solver_refuses_comes_as_its_sentence(solver):
    replies: list[Reply] = []
    solver.ask(
        ("page", "spectrum"), SolveRequest("spectrum", PageState().with_values(F="2e4")), replies.append
    )
    wait_until(lambda: replies)
    assert replies[0].outcome == "refused"
    assert "crushed" in replies[0].content["sentence"]


def test_a_newer_request_cancels_an_older_one_in_the_same_process(solver):
    old: list[Reply] = []
    new: list[Reply] = []
    solver.ask(("page", "branch"), SLOW, old.append)
    pid = solver.pid
    wait_until_it_solves(solver)
    solver.ask(("page", "branch"), QUICK, new.append)
    wait_until(lambda: new)
    assert (old, new[0].outcome, solver.pid) == ([], "answer", pid)


def test_of_requests_that_wait_only_the_newest_is_answered(solver):
    replies: list[float] = []
    for F in range(20, 60):
        request = SolveRequest("spectrum", PageState().with_values(F=str(F)))
        solver.ask(("page", "spectrum"), request, lambda reply: replies.append(float(reply.content["F"])))
    wait_until(lambda: 59 in replies)
    assert len(replies) < 40
    assert np.all(np.diff(replies) > 0)


def test_requests_of_another_page_are_kept(solver):
    replies: dict[str, Reply] = {}
    for page in ("one", "two"):
        solver.ask((page, "thresholds"), QUICK, lambda reply, page=page: replies.setdefault(page, reply))
    wait_until(lambda: len(replies) == 2)
    assert {reply.outcome for reply in replies.values()} == {"answer"}


def test_a_page_that_ends_takes_its_requests_along(solver):
    replies: list[Reply] = []
    solver.ask(("one", "branch"), SLOW, replies.append)
    wait_until_it_solves(solver)
    solver.cancel_session("one")
    solver.ask(("two", "thresholds"), QUICK, replies.append)
    wait_until(lambda: replies)
    assert [reply.content["status"] for reply in replies] == ["ok"]
    assert "kinds" in replies[0].content


def test_a_solver_that_does_not_answer_is_killed_and_started_again():
    solver = SolverProcess(
        CancellationDelays(min_age_of_cancelled_solve=0.05, kill_after_cancellation_seconds=0.2)
    )
    try:
        replies: list[Reply] = []
        solver.ask(("page", "branch"), SLOW, replies.append)
        first = solver.pid
        wait_until(lambda: solver.is_ready)
        os.kill(first, signal.SIGSTOP)
        solver.ask(("page", "branch"), QUICK, replies.append)
        wait_until(lambda: replies)
        assert (replies[0].outcome, solver.start_count) == ("answer", 2)
        assert not exists(first)
    finally:
        solver.close()


def test_a_solver_that_dies_says_so_and_the_next_request_is_answered(solver):
    replies: list[Reply] = []
    solver.ask(("page", "branch"), SLOW, replies.append)
    os.kill(solver.pid, signal.SIGKILL)
    wait_until(lambda: replies)
    assert replies[0].outcome == "failed"
    solver.ask(("page", "branch"), QUICK, replies.append)
    wait_until(lambda: len(replies) == 2)
    assert replies[1].outcome == "answer"


@pytest.mark.long
def test_what_is_forked_has_started_neither_mpi_nor_petsc_nor_threads():
    lines = [
        "import os, sys",
        "import rodsweep.explore.solving.worker",
        "print(*{'mpi4py.MPI', 'petsc4py.PETSc'} & set(sys.modules), len(os.listdir('/proc/self/task')))",
    ]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}  # as the command sets it
    argv = [sys.executable, "-c", "\n".join(lines)]
    assert subprocess.run(argv, env=environment, capture_output=True, text=True, check=True).stdout == "1\n"


def test_closing_ends_all_processes():
    solvers = SolverProcesses()
    solvers.warm_up()
    pids = [solver.pid for solver in solvers.groups.values() if solver.pid is not None]
    assert len(pids) == 3
    solvers.close()
    assert not any(map(exists, pids))


@pytest.mark.long
def test_a_solver_ends_in_the_middle_of_a_solve_when_its_page_is_killed():
    """The page's process has no time to say anything."""
    lines = [
        "import asyncio, sys, time",
        "from rodsweep.explore.solving.requests import SolveRequest",
        "from rodsweep.explore.solving.solver_processes import SolverProcess",
        "from rodsweep.explore.page_state import PageState",
        "asyncio.set_event_loop(asyncio.new_event_loop())",
        "solver = SolverProcess()",
        "request = SolveRequest('branch', PageState().with_values(taper='0.6'))",
        "solver.ask(('page', 'branch'), request, print)",
        "print(solver.pid, flush=True)",
        "time.sleep(100)",
    ]
    page = subprocess.Popen([sys.executable, "-c", "\n".join(lines)], stdout=subprocess.PIPE, text=True)
    assert page.stdout is not None
    pid = int(page.stdout.readline())
    assert exists(pid)
    page.kill()
    page.wait()
    page.stdout.close()
    wait_until(lambda: not exists(pid))


def wait_until_it_solves(solver: SolverProcess) -> None:
    """Waits until the process has used half a second of processor time since it became ready."""
    wait_until(lambda: solver.is_ready)
    before = _seconds_used(solver)
    wait_until(lambda: _seconds_used(solver) > before + 0.5)


def _seconds_used(solver: SolverProcess) -> float:
    with open(f"/proc/{solver.pid}/stat") as stat:
        used = sum(map(int, stat.read().rpartition(")")[2].split()[11:13]))
    return used / os.sysconf("SC_CLK_TCK")


def test_a_long_solve_sends_its_progress_until_it_is_cancelled(solver):
    replies: list[Reply] = []
    places: list[Reply] = []
    solver.ask(("page", "branch"), SLOW, replies.append, places.append)
    pid = solver.pid
    wait_until(lambda: places)
    assert places[0].outcome == "progress"
    assert places[0].content["text"]
    solver.cancel(("page", "branch"))
    solver.ask(("page", "thresholds"), QUICK, replies.append)
    wait_until(lambda: replies)
    assert ([reply.outcome for reply in replies], solver.pid) == (["answer"], pid)
