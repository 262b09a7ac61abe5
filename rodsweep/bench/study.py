"""Results of a benchmark: methods timed in turn on cases, their errors, and tables in Markdown."""

import resource
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf, isfinite, isnan, nan
from pathlib import Path
from statistics import median
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from ..post.work_precision import draw_work_precision
from ..results.file.measurements import Table

Outcome = TypeVar("Outcome")
SHORT_RUN_SECONDS = 0.02
"""Duration in seconds below which the time of a run depends on the caches left by the previous run."""


@dataclass(frozen=True, slots=True)
class Contender:
    """A method at one setting: `run` takes a case, once if it is slow. group: methods that share a colour."""

    method: str
    setting: str
    group: str
    run: Callable[[Any], Any]
    slow: bool = False


@dataclass(frozen=True, slots=True)
class Measurement:
    """A method at one setting on one case: median seconds of a run, and its relative error.

    The error is nan if no error applies, and inf if the method failed; `failure` is the reason.
    least_seconds: minimum over all rounds, less sensitive to further loads on the machine. extra: further
    numbers by name.
    """

    case: str
    method: str
    setting: str
    seconds: float
    error: float
    group: str = ""
    failure: str = ""
    least_seconds: float = nan
    extra: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Study:
    """Result of one benchmark.

    unit: meaning of a run, as in "ms a point". target: the error to be reached. undrawn: measurements without
    a curve in the figure.
    """

    name: str
    text: str
    measurements: Sequence[Measurement]
    unit: str = "run"
    target: float | None = None
    undrawn: Sequence[Measurement] = ()

    @property
    def drawable(self) -> bool:
        """Whether any error can be drawn against time."""
        return any(isfinite(m.error) for m in self.measurements)

    def draw(self, output: Path) -> None:
        """Writes the figure: errors against time, a panel for each case, a curve for each method."""
        draw_work_precision(columns_of(self.measurements), f"ms a {self.unit}", self.target, output)

    def table(self) -> Table:
        """The measurements as columns, for the file."""
        return columns_of([*self.measurements, *self.undrawn])


def columns_of(measurements: Sequence[Measurement]) -> Table:
    """Measurements as columns."""
    columns: Table = {
        name: [getattr(m, name) for m in measurements]
        for name in ("case", "method", "group", "setting", "seconds", "least_seconds", "error", "failure")
    }
    for name in dict.fromkeys(name for m in measurements for name in m.extra):
        columns[name] = [m.extra.get(name, nan) for m in measurements]
    return columns


class TimedRuns(NamedTuple, Generic[Outcome]):
    """Result of the first run, and processor seconds of every timed run."""

    outcome: Outcome
    seconds: tuple[float, ...]

    @property
    def median(self) -> float:
        return median(self.seconds)


def race(runs: Sequence[Callable[[], Outcome]], rounds: Sequence[int]) -> list[TimedRuns[Outcome]]:
    """Times all runs in turn; rounds: number of timed rounds of each run.

    The first run loads and compiles, and counts only for runs without rounds. A short run is made twice in a
    row and the second one is timed, so that the caches do not depend on the previous method.
    """
    first = [_timed(run) for run in runs]
    seconds: list[list[float]] = [[] for _ in runs]
    for i in in_turn(rounds):
        if first[i].median < SHORT_RUN_SECONDS:
            runs[i]()
        seconds[i] += _timed(runs[i]).seconds
    return [TimedRuns(a.outcome, tuple(more) or a.seconds) for a, more in zip(first, seconds, strict=True)]


def in_turn(rounds: Sequence[int]) -> Iterator[int]:
    """Indices of the runs in the order of timing: round by round, so that slow spells affect all methods."""
    for turn in range(max(rounds)):
        yield from (i for i, most in enumerate(rounds) if turn < most)


def _timed(run: Callable[[], Outcome]) -> TimedRuns[Outcome]:
    began = processor_seconds()
    outcome = run()
    return TimedRuns(outcome, (processor_seconds() - began,))


def processor_seconds() -> float:
    """Processor seconds of this process and of the programs started by it."""
    programs = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + programs.ru_utime + programs.ru_stime


def failsafe(run: Callable[[Any], Outcome], case: Any) -> Outcome | Exception:
    """Result of a method on a case, or the exception raised by it."""
    try:
        with np.errstate(all="ignore"):
            return run(case)
    except Exception as error:
        return error


class JudgedCase(NamedTuple):
    """A case with its name; judge: function from an outcome to error and other fields of Measurement."""

    name: str
    case: Any
    judge: Callable[[Any], dict[str, Any]]


def contest(
    name: str, case: Any, contenders: Sequence[Contender], rounds: int, judge: Callable[[Any], dict[str, Any]]
) -> list[Measurement]:
    """Measurements of all contenders on one case."""
    return tournament([JudgedCase(name, case, judge)], contenders, rounds)


def tournament(
    entries: Sequence[JudgedCase], contenders: Sequence[Contender], rounds: int
) -> list[Measurement]:
    """Measurements of all contenders on all cases, timed in turn."""
    pairs = [(entry, contender) for entry in entries for contender in contenders]
    runs = [partial(failsafe, contender.run, entry.case) for entry, contender in pairs]
    raced = race(runs, [0 if contender.slow else rounds for _, contender in pairs])
    measurements = []
    for (entry, c), timed in zip(pairs, raced, strict=True):
        least = min(timed.seconds)
        failed = isinstance(timed.outcome, Exception)
        empty = Measurement(entry.name, c.method, c.setting, timed.median, inf, c.group, least_seconds=least)
        failure = {"failure": f"failed ({type(timed.outcome).__name__})"}
        measurements.append(replace(empty, **(failure if failed else entry.judge(timed.outcome))))
    return measurements


def grouped(measurements: Iterable[Measurement], *names: str) -> dict[tuple[str, ...], list[Measurement]]:
    """Measurements grouped by the values of the named fields, in order of appearance."""
    groups: dict[tuple[str, ...], list[Measurement]] = {}
    for m in measurements:
        groups.setdefault(tuple(getattr(m, name) for name in names), []).append(m)
    return groups


def every_nth_setting(contenders: Iterable[Contender], stride: int) -> list[Contender]:
    """Every n-th setting of each method, beginning with the first, for a quick run."""
    return [contender for settings in by_method(contenders).values() for contender in settings[::stride]]


def by_method(contenders: Iterable[Contender]) -> dict[str, list[Contender]]:
    """Settings of each method, in their order."""
    methods: dict[str, list[Contender]] = {}
    for contender in contenders:
        methods.setdefault(contender.method, []).append(contender)
    return methods


def middle(values: Iterable[float]) -> float:
    """Median of the values without nan; nan if all are nan."""
    numbers = [value for value in values if not isnan(value)]
    return float(median(numbers)) if numbers else nan


class PrintedNumber(float):
    """A number that is printed as "" if it is nan."""

    def __format__(self, form: str) -> str:
        return "" if isnan(self) else super().__format__(form)


def table(head: str, line: str, rows: Iterable[Mapping[str, object]]) -> str:
    """Table in Markdown from its head and the format of a row, such as "{method} | {seconds:.2f}"."""
    lines = [f"| {head} |", "|" + "---|" * (head.count("|") + 1)]
    for row in rows:
        cells = {
            k: PrintedNumber(value) if isinstance(value, int | float) else value for k, value in row.items()
        }
        lines.append(f"| {line.format_map(cells)} |")
    return "\n".join(lines)


def plural(count: int, noun: str) -> str:
    """A count with a regular noun: "1 round", "2 rounds"."""
    return f"{count} {noun}{'s' * (count != 1)}"
