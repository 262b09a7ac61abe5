"""Ctrl-C at any instant, and several threads: no crash, and afterwards the same bits as alone.

RODSWEEP_INTERRUPTS says how often each task is interrupted; `make stress` does it more often.
"""

import json
import os
import random
import signal
import subprocess
import sys
import threading

import pytest
from conftest import NOT_FITTED

from rodsweep import solve_progress
from rodsweep.solve.solve_lock import SignalDeferral, one_at_a_time

INTERRUPTS = int(os.environ.get("RODSWEEP_INTERRUPTS", "1"))
TASKS = """
import rodsweep as rs
ROD = rs.Rod(F=40.0, k1=1e4, k2=1e2, gamma3=1e-2)
FREE = {"k1": [1e3, 1e4], "k2": 1e2, "gamma3": 1e-2}
ARM = {"length": "10 cm", "radius": "5 mm", "young": "100 kPa", "viscosity": "1 Pa s", "pressure": "1 kPa"}
TASKS = {
    "spectrum": lambda: ROD.spectrum().data,
    "thresholds": lambda: ROD.thresholds().data,
    "modes": lambda: ROD.modes(nodes=9).data,
    "criticality": lambda: ROD.criticality(F_max=60).data,
    "cycle": lambda: ROD.cycle(accuracy=1e-3).data,
    "branch": lambda: ROD.branch(start=20, stop=40, accuracy=1e-3).data,
    "sweep of spectra": lambda: rs.sweep("spectrum", F=[20, 30, 40], **FREE),
    "sweep of thresholds": lambda: rs.sweep("thresholds", **FREE),
    "sweep of normal forms": lambda: rs.sweep("criticality", F_max=60, **FREE),
    "sweep of cycles": lambda: rs.sweep("limit_cycle", F=[35, 40], accuracy=1e-3, **FREE),
    "arm": lambda: repr(rs.Arm(**ARM).report()),
    "figure": lambda: rs.plot(rs.sweep("spectrum", **(FREE | {"k1": 1e4}), F=[20, 30, 40])).image,
    "phase diagram": lambda: rs.sweep("phase_diagram", F=[10, 20, 30, 40], **FREE),
}

def bits(task):
    data = TASKS[task]()
    if isinstance(data, str | bytes):
        return data
    return {name: data[name].values.tobytes() for name in data.data_vars if name != "seconds"}
"""
ALL_IN_ONE = f"""
import json, random, signal, sys, threading, time
{TASKS}
{"" if INTERRUPTS > 1 else NOT_FITTED}
alone, seconds = {{}}, {{}}
for task in TASKS:
    began = time.perf_counter()
    alone[task] = bits(task)
    seconds[task] = time.perf_counter() - began

def beside_others():
    faults = []
    def work(seed):
        try:
            some = sorted(TASKS)[seed % 3 :: 3]  # so that each is solved by two threads
            for task in random.Random(seed).sample(some, len(some)):
                if bits(task) != alone[task]:
                    faults.append(task)
        except BaseException as error:
            faults.append(repr(error))
    threads = [threading.Thread(target=work, args=(seed,)) for seed in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return faults

def interrupt(delay):
    time.sleep(delay)
    signal.raise_signal(signal.SIGINT)

def interrupted(chance, times):
    faults, came = [], 0
    for task in TASKS:
        for _ in range(times):
            thread = threading.Thread(target=interrupt, args=(chance.random() * seconds[task],))
            try:
                thread.start()
                bits(task)
                thread.join()
                time.sleep(0.001)
            except KeyboardInterrupt:
                came += 1
            except Exception as error:
                faults.append(repr(error))
            thread.join()
            if bits(task) != alone[task]:
                faults.append(task)
    return came, faults

print(json.dumps([beside_others(), *interrupted(random.Random(int(sys.argv[1])), int(sys.argv[2]))]))
"""
"""One process: every task alone, then by six threads, then interrupted."""


@pytest.fixture(scope="module")
def told():
    """(seed, faults of the threads, interrupts that came, faults after interrupts)."""
    seed = random.randrange(10**9)
    words = [sys.executable, "-c", ALL_IN_ONE, str(seed), str(INTERRUPTS)]
    done = subprocess.run(words, capture_output=True, check=False)
    assert done.returncode == 0, f"seed {seed}: {done.stderr.decode()}"
    return seed, *json.loads(done.stdout.splitlines()[-1])


@pytest.mark.long
def test_six_threads_give_the_bits_of_one(told):
    assert told[1] == []


@pytest.mark.long
def test_interrupts_at_random_instants_leave_the_same_bits(told):
    seed, _, came, faults = told
    assert faults == [], f"seed {seed}"
    assert came > 0


def test_a_handler_runs_at_a_safe_place_and_not_before():
    place = []

    def handler(number, frame):
        place.append(number)
        raise TimeoutError

    before = signal.signal(signal.SIGUSR2, handler)
    try:
        with (
            pytest.raises(TimeoutError),
            SignalDeferral() as held,
            solve_progress.reporting_to(held.call_due_handlers),
        ):
            signal.raise_signal(signal.SIGUSR2)
            assert place == []
            solve_progress.report()
            pytest.fail("the handler's exception was lost")
        with pytest.raises(TimeoutError), SignalDeferral():
            signal.raise_signal(signal.SIGUSR2)
        assert place == [signal.SIGUSR2] * 2
        assert signal.getsignal(signal.SIGUSR2) == handler
    finally:
        signal.signal(signal.SIGUSR2, before)


def test_reports_are_heard_by_all_who_listen():
    heard = []
    with (
        solve_progress.reporting_to(lambda place: heard.append("outer")),
        solve_progress.reporting_to(lambda place: heard.append(place())),
    ):
        solve_progress.report(lambda: solve_progress.SolvePosition("inner", 0.25))
    solve_progress.report()
    assert heard == ["outer", solve_progress.SolvePosition("inner", 0.25)]


def test_a_place_in_a_part_is_told_as_one_in_the_whole():
    heard = []
    with (
        solve_progress.reporting_to(lambda place: heard.append(place())),
        solve_progress.solve_part("branch 2", (0.5, 0.9)),
    ):
        solve_progress.report(lambda: solve_progress.SolvePosition("F = 50", 0.25))
        with solve_progress.solve_part("corner"):
            solve_progress.report(lambda: solve_progress.SolvePosition("F = 51", 0.5))
        solve_progress.report()
    assert heard[0] == ("branch 2: F = 50", pytest.approx(0.6))
    assert heard[1] == ("branch 2: corner: F = 51", 0.5), "a part whose shares are unknown"
    assert heard[2] == solve_progress.SolvePosition(), "a safe place without words"


def test_threads_wait_for_one_another():
    inside, most = [], []

    @one_at_a_time
    def work():
        inside.append(1)
        most.append(len(inside))
        threading.Event().wait(0.001)
        inside.pop()

    threads = [threading.Thread(target=work) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == [1] * 6
