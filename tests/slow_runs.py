"""Slow runs that tests can interrupt at a counted point, so that no test depends on timing."""

from pathlib import Path
from subprocess import Popen

from ranks import pause_until

from rodsweep.results.file.view import read_view

FOR_EVER = 1e9


def slowly(pause: float, points: int = 1) -> str:
    """What every rank executes first: from so many records on it waits after each, until asked to stop.

    A record is a point's, or those of the points that were solved together.
    """
    return f"""
import time
from rodsweep.results.run.journal import Journal
from rodsweep.sweep.stop import StopRequest

note = StopRequest._record_signal_name
kept, heard = [], []

def then_wait(append):
    def append_and_wait(self, index, *given):
        append(self, index, *given)
        kept.append(index)
        until = time.monotonic() + {pause!r}
        while len(kept) >= {points} and not heard and time.monotonic() < until:
            time.sleep(0.01)

    return append_and_wait

def note_and_go_on(self, number, frame):
    heard.append(number)
    note(self, number, frame)

Journal.append, Journal.append_all = then_wait(Journal.append), then_wait(Journal.append_all)
StopRequest._record_signal_name = note_and_go_on
"""


def pause_until_journalled(process: Popen, path: Path, points: int) -> None:
    """Waits until so many points are in the journals of a run that goes on meanwhile."""

    def are_there() -> bool:
        assert process.poll() is None, process.communicate()
        return path.exists() and read_view(path).journalled_count >= points

    # The run waits for what comes, and to read its file takes some milliseconds of the processor.
    pause_until(are_there, f"{points} points are not in the journals of {path}", pause=0.05)
