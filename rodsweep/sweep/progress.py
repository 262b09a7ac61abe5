"""How far a sweep is: a bar on a terminal or in a notebook, a plain line now and then in a log."""

import os
import sys
import time

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from .remaining_time import Pace, in_words, rate_in_words

FIRST_SECONDS, LINE_SECONDS = 1.0, 10.0
"""Seconds after which something is shown, and between lines in a log."""
BAR_SECONDS = 0.1


def on_terminal() -> bool:
    """Whether the user sees our output live: a launcher's ranks write to its pipe, not to its terminal."""
    if sys.stderr.isatty():
        return True
    launcher = f"/proc/{os.getppid()}/fd/2"
    under_mpi = any(name in os.environ for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE"))
    return under_mpi and os.path.realpath(launcher).startswith(("/dev/pts/", "/dev/tty"))


def in_notebook() -> bool:
    """Whether output goes into a cell of a notebook."""
    return Console().is_jupyter


class Silent:
    """Shows nothing."""

    def __call__(self, done: int) -> None: ...

    def place(self, words: str, begun: float = 0.0) -> None: ...

    def close(self) -> None: ...


class Teller:
    """Shows how many of `total` points are done, with rate and remaining time, and where a long point is.

    total: None where it is not known, as of units that depend on each other. noun: of what is counted.
    """

    def __init__(self, total: int | None, title: str, noun: str = "points", live: bool | None = None):
        """live: whether there is a bar instead of lines; by default on a terminal."""
        self.total, self.noun = total, noun
        self.pace = None if total is None else Pace(total)
        self.began = self.next = 0.0
        self.done, self.begun, self.where = 0, 0.0, ""
        self.bar = _bar(title) if (on_terminal() if live is None else live) else None
        if self.bar is not None:
            self.task = self.bar.add_task(title, total=total, count="", rate="", left="", where="")

    def __call__(self, done: int) -> None:
        """Takes how many points are done in all; shows it when it is time. The clock starts at 0."""
        if not done:
            self.began = time.monotonic()
            self.next = self.began + FIRST_SECONDS
        self.done, self.begun, self.where = done, 0.0, ""
        self._show()

    def place(self, words: str, begun: float = 0.0) -> None:
        """Takes where a long point is; shows it when it is time.

        begun: how much is done of all points that are being solved, in points.
        """
        self.begun, self.where = begun, words
        self._show()

    def _show(self) -> None:
        now = time.monotonic()
        if not self.began or now < self.next:
            return
        passed = now - self.began
        rate = rate_in_words(self.done, passed) if self.total else ""
        seconds = self.pace.left(self.done, passed, self.begun) if self.pace else None
        left = "" if seconds is None else f"about {in_words(seconds)} left"
        count = f"{self.done} of {self.total}" if self.total else f"{self.done or ''}"
        if self.bar is not None:
            self.bar.start()
            self.next = now + BAR_SECONDS
            self.bar.update(
                self.task,
                completed=self.done + self.begun,
                count=count,
                rate=rate,
                left=left,
                where=self.where,
            )
            self.bar.refresh()
            return
        self.next = now + LINE_SECONDS
        told = ", ".join(filter(None, (f"{count} {self.noun}" if count else "", rate, left)))
        print("; ".join(filter(None, (told, self.where))), file=sys.stderr, flush=True)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.stop()


def _bar(title: str) -> Progress:
    """A bar on standard error, or in a notebook."""
    console = Console() if in_notebook() else Console(file=sys.stderr, force_terminal=True)
    columns = (
        TextColumn(title, markup=False),
        BarColumn(),
        *(
            TextColumn(f"{{task.fields[{name}]}}", markup=False)
            for name in ("count", "rate", "left", "where")
        ),
    )
    return Progress(*columns, console=console, transient=True, auto_refresh=False)
