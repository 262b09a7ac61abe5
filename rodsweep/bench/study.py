"""What a benchmark gives: measurements of methods on cases, and the text that presents them."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path
from typing import TypeVar

import numpy as np

from ..post.figures.work_precision import Curve, Panel, draw_work_precision
from ..results.file.measurements import Table

Outcome = TypeVar("Outcome")


@dataclass(frozen=True, slots=True)
class Measurement:
    """One method at one setting on one case: median seconds of one run, and its relative error.

    The error is nan where none applies and inf where the method failed. group: methods of one kind,
    which a figure gives one colour; extra: other numbers, by name.
    """

    case: str
    method: str
    setting: str
    seconds: float
    error: float
    group: str = ""
    extra: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Study:
    """One benchmark, done. unit: what a run is, as in "ms a point"; target: the error to be reached."""

    name: str
    text: str
    measurements: tuple[Measurement, ...]
    unit: str = "run"
    target: float | None = None

    @property
    def drawable(self) -> bool:
        """Whether there is an error to draw against time."""
        return any(isfinite(m.error) for m in self.measurements)

    def draw(self, output: Path) -> None:
        """Writes the figure: errors against time, a panel for each case, a curve for each method."""
        panels = []
        shown = [m for m in self.measurements if isfinite(m.error)]
        for case in dict.fromkeys(m.case for m in shown):
            here = [m for m in shown if m.case == case]
            curves = []
            for method in dict.fromkeys(m.method for m in here):
                own = [m for m in here if m.method == method]
                times, errors = ([getattr(m, name) for m in own] for name in ("seconds", "error"))
                curves.append(Curve(method, own[0].group, 1e3 * np.array(times), np.array(errors)))
            panels.append(Panel(case, tuple(curves)))
        draw_work_precision(panels, f"ms a {self.unit}", self.target, output)

    def table(self) -> Table:
        """The measurements as columns, for the file."""
        columns: Table = {
            name: [getattr(m, name) for m in self.measurements]
            for name in ("case", "method", "group", "setting", "seconds", "error")
        }
        for name in dict.fromkeys(name for m in self.measurements for name in m.extra):
            columns[name] = [m.extra.get(name, float("nan")) for m in self.measurements]
        return columns


def race(runs: Sequence[Callable[[], Outcome]], rounds: int) -> tuple[list[float], list[Outcome]]:
    """(median processor seconds, outcome of the first) of each, after a first round that is not timed.

    All in turn, round after round, so that a slow spell of the machine hits all alike; each twice in a row,
    the second timed, so that none finds the caches as another has left them. The processor's time does
    not count what other processes take.
    """
    outcomes = [run() for run in runs]
    times: list[list[float]] = [[] for _ in runs]
    for _ in range(rounds):
        for run, spent in zip(runs, times, strict=True):
            run()
            began = time.process_time()
            run()
            spent.append(time.process_time() - began)
    return [float(np.median(spent)) for spent in times], outcomes
