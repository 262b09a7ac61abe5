"""Progress of a sweep: a bar on a terminal or in a notebook, and lines at intervals in a log."""

import os
import sys
import time
from functools import cache
from importlib.util import find_spec
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from ..solve_progress import SolvePosition
from .remaining_time import RemainingTimeEstimator, duration_text, rate_in_words
from .stop import SingleRankCommunication, SolverReportListener, StopRequest

QUIET_SECONDS = 1.0
"""Seconds before progress is shown for the first time; a shorter sweep shows no progress."""
LINE_SECONDS = 10.0
"""Seconds between two progress lines in a log."""
BAR_SECONDS = 0.1
"""Seconds between two updates of a progress bar."""


def is_stderr_a_terminal() -> bool:
    """Whether standard error is a terminal; under an MPI launcher, the launcher's standard error counts
    too."""
    if sys.stderr.isatty():
        return True
    # The launcher pipes the output of its ranks, so a rank's own standard error is never a terminal.
    launcher = f"/proc/{os.getppid()}/fd/2"
    if not any(name in os.environ for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE")):
        return False
    try:
        return os.readlink(launcher).startswith(("/dev/pts/", "/dev/tty"))
    except OSError:  # the launcher was killed, and its parent belongs to somebody else
        return False


@cache
def can_show_notebook_bar() -> bool:
    """Whether a progress bar can appear in cells of a notebook; without ipywidgets rich prints a warning."""
    return Console().is_jupyter and find_spec("ipywidgets") is not None


class SilentProgress:
    """Progress display that shows nothing."""

    def __call__(self, finished_count: int) -> None: ...

    def show_position(self, text: str, fraction_sum: float = 0.0) -> None: ...

    def close(self) -> None: ...


class ProgressReporter:
    """Shows the number of finished points, the rate, the remaining time and the progress of a long point.
    total: number of all points; None if unknown. title: text before the bar. noun: name of the counted
    objects in a line."""

    def __init__(self, total: int | None, title: str, noun: str = "points", is_bar: bool | None = None):
        """total, title, noun: see the class. is_bar: True for a progress bar, False for lines; None: a bar on
        a terminal, lines elsewhere."""
        self.total = total
        self.noun = noun
        self.remaining_time = None if total is None else RemainingTimeEstimator(total)
        self.start_time = self.next_display = 0.0
        """Start of the sweep and time of the next display, on the monotonic clock, in s; 0 before the
        start."""
        self.finished_count = 0
        self.fraction_sum = 0.0
        self.position_text = ""
        shows_bar = is_stderr_a_terminal() if is_bar is None else is_bar
        self.bar = _progress_bar(title) if shows_bar else None
        if self.bar is not None:
            self.task = self.bar.add_task(title, total=total, count="", rate="", left="", where="")

    def __call__(self, finished_count: int) -> None:
        """Records the number `finished_count` of finished points, and displays it if due; 0 starts the
        clock."""
        # The clock starts after the preparation, in which no point can finish.
        if not finished_count:
            self.start_time = time.monotonic()
            self.next_display = self.start_time + QUIET_SECONDS
        self.finished_count = finished_count
        self.fraction_sum = 0.0
        self.position_text = ""
        self._show_if_due()

    def show_position(self, text: str, fraction_sum: float = 0.0) -> None:
        """Shows the text `text` on the progress in a point that takes long, if an update is due.
        fraction_sum: sum of the completed fractions of all unfinished points."""
        self.fraction_sum = fraction_sum
        self.position_text = text
        self._show_if_due()

    def _show_if_due(self) -> None:
        """Draws the bar or prints a line, if an update is due."""
        now = time.monotonic()
        if not self.start_time or now < self.next_display:
            return
        elapsed = now - self.start_time
        rate = rate_in_words(self.finished_count, elapsed) if self.total else ""
        seconds = None
        if self.remaining_time:
            seconds = self.remaining_time.remaining_seconds(self.finished_count, elapsed, self.fraction_sum)
        time_left = "" if seconds is None else f"about {duration_text(seconds)} left"
        count = f"{self.finished_count} of {self.total}" if self.total else f"{self.finished_count or ''}"
        if self.bar is not None:
            # Starting an already running bar does nothing; started here, a quick sweep shows none.
            self.bar.start()
            self.next_display = now + BAR_SECONDS
            fields: dict[str, Any] = {
                "count": count,
                "rate": rate,
                "left": time_left,
                "where": self.position_text,
            }
            self.bar.update(self.task, completed=self.finished_count + self.fraction_sum, **fields)
            # Without a thread of its own the bar cannot draw in the middle of another message.
            self.bar.refresh()
            return
        self.next_display = now + LINE_SECONDS
        noun = "point" if self.total == 1 and self.noun == "points" else self.noun
        summary = ", ".join(filter(None, (f"{count} {noun}" if count else "", rate, time_left)))
        print("; ".join(filter(None, (summary, self.position_text))), file=sys.stderr, flush=True)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.stop()


Display = ProgressReporter | SilentProgress
"""Progress display, or its silent substitute."""


def display_listener(display: Display, name: str) -> SolverReportListener:
    """Listener that shows the progress of the solve `name` in the display `display`. Ctrl-C still raises
    KeyboardInterrupt."""

    def show(position: SolvePosition) -> None:
        display.show_position(position.text, position.completed_fraction or 0.0)

    return SolverReportListener(SingleRankCommunication(show), StopRequest(), lambda: name)


def _progress_bar(title: str) -> Progress:
    """Progress bar on standard error, or in a notebook, that begins with `title`."""
    console = Console() if can_show_notebook_bar() else Console(file=sys.stderr, force_terminal=True)
    fields = (f"{{task.fields[{name}]}}" for name in ("count", "rate", "left", "where"))
    # A unit or a file name in brackets would be taken as a style.
    title_column, *field_columns = (TextColumn(text, markup=False) for text in (title, *fields))
    return Progress(
        title_column, BarColumn(), *field_columns, console=console, transient=True, auto_refresh=False
    )
