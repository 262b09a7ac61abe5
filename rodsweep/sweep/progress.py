"""How far a sweep is: a bar on a terminal, a plain line now and then in a log."""

import os
import sys
import time

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from .pace import Pace, in_words, rate_in_words

LINE_SECONDS = 10.0
"""Seconds between lines in a log; the first comes after one second."""
BAR_SECONDS = 0.1


def on_terminal() -> bool:
    """Whether the user sees our output live: a launcher's ranks write to its pipe, not to its terminal."""
    if sys.stderr.isatty():
        return True
    launcher = f"/proc/{os.getppid()}/fd/2"
    under_mpi = any(name in os.environ for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE"))
    return under_mpi and os.path.realpath(launcher).startswith(("/dev/pts/", "/dev/tty"))


class Teller:
    """Tells how many of `total` points are done, with rate and remaining time."""

    def __init__(self, total: int, title: str):
        self.total, self.began, self.pace = total, time.monotonic(), Pace(total)
        self.next = self.began + 1.0
        self.bar: Progress | None = None
        if on_terminal():
            console = Console(file=sys.stderr, force_terminal=True)
            columns = (
                TextColumn(title, markup=False),
                BarColumn(),
                MofNCompleteColumn(),
                TextColumn("{task.fields[rate]}"),
                TextColumn("{task.fields[left]}"),
            )
            self.bar = Progress(*columns, console=console, transient=True, auto_refresh=False)
            self.task = self.bar.add_task(title, total=total, rate="", left="")
            self.bar.start()

    def __call__(self, done: int) -> None:
        """Hears that `done` points are done in all; says so when it is time."""
        now = time.monotonic()
        if now < self.next:
            return
        passed = now - self.began
        rate, seconds = rate_in_words(done, passed), self.pace.left(done, passed)
        left = "" if seconds is None else f"about {in_words(seconds)} left"
        if self.bar is not None:
            self.next = now + BAR_SECONDS
            self.bar.update(self.task, completed=done, rate=rate, left=left)
            self.bar.refresh()
            return
        self.next = now + LINE_SECONDS
        told = ", ".join(filter(None, (f"{done} of {self.total} points", rate, left)))
        print(told, file=sys.stderr, flush=True)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.stop()
