"""The MPI ranks of a run: their processes, whichever process started them, and the moment they end."""

import os
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

VARIABLES = (b"OMPI_COMM_WORLD_RANK", b"PMIX_RANK", b"PMI_RANK")
"""Variables of the environment in which a launcher tells a process its rank."""
COMMANDS = (b"/rodsweep", b"/faults/rank.py")
"""Ends of the words that start a rank: the command, or what has it forked from a loaded process."""
SERVER = b"/faults/server.py"
PATIENCE = 300.0
"""Seconds after which a wait is given up: what hangs is to fail, and nothing else on the busiest machine."""


def pause_until(condition: Callable[[], bool], what: str, pause: float = 0.01) -> None:
    """Waits until a condition holds, asked for every `pause` seconds; `what` is said where it never does."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, what
        time.sleep(pause)


def ranks_in(directory: Path) -> dict[int, int]:
    """{rank: process} of the `rodsweep` under mpiexec that works in a directory.

    Ranks are children of the launcher or of what that starts, and of nobody once it is killed.
    """
    found = {}
    for entry in Path("/proc").iterdir():
        with suppress(OSError, ValueError):  # no process, one that has just ended, or another user's
            pid = int(entry.name)
            if not os.path.samefile(entry / "cwd", directory):
                continue
            words = (entry / "cmdline").read_bytes().split(b"\0")
            given = dict(v.partition(b"=")[::2] for v in (entry / "environ").read_bytes().split(b"\0"))
            number = next((given[name] for name in VARIABLES if name in given), None)
            # The launcher has the command among its words as well, behind its own.
            if number is not None and any(
                word.endswith((b"/rodsweep", b"/faults/rank.py")) for word in words[:3]
            ):
                found[int(number)] = pid
    return found


def children_in(directory: Path) -> list[int]:
    """The children of a loaded process, see `faults.server`, that work in a directory."""
    found = []
    for entry in Path("/proc").iterdir():
        with suppress(OSError, ValueError):
            pid = int(entry.name)
            if os.path.samefile(entry / "cwd", directory) and SERVER in (entry / "cmdline").read_bytes():
                found.append(pid)
    return found


def wait_for_children(directory: Path) -> None:
    """Waits until no child of a loaded process works in a directory: it outlives who handed over to it."""
    pause_until(lambda: not children_in(directory), f"children in {directory} do not end")


def wait_for_end(directory: Path) -> None:
    """Waits until no rank works in a directory: ranks outlive a killed launcher for a moment."""
    pause_until(lambda: not ranks_in(directory), f"ranks in {directory} do not end")
    wait_for_children(directory)


def kill(*pids: int) -> None:
    """Kills processes, whichever of them are left."""
    for pid in pids:
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
