"""Functions for all benchmarks: timing of methods in turn, errors of results, and tables in Markdown."""

import resource
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import inf, isfinite, isnan, nan
from pathlib import Path
from statistics import median
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from ..post.work_precision import draw_work_precision
from ..results.file.benchmark_file import Table

Outcome = TypeVar("Outcome")
"""Type of the result of a timed function."""
MethodOrMeasurement = TypeVar("MethodOrMeasurement", "TimedMethod", "Measurement")
MAX_CACHE_SENSITIVE_SECONDS = 0.02
"""If a run takes less than this duration, in s, its time depends on the contents of the processor caches
after the previous run."""


@dataclass(frozen=True, slots=True)
class TimedMethod:
    """A method at one setting that is compared with other methods. method, setting: names in the tables.

    group: name of a group of methods, which have the same colour in the figure. run: function (case) ->
    result. is_slow: whether the function is run only once, instead of in every round."""

    method: str
    setting: str
    group: str
    run: Callable[[Any], Any]
    is_slow: bool = False


@dataclass(frozen=True, slots=True)
class Measurement:
    """Time and error of a method at one setting on one case. case, method, setting, group: names, as in
    `TimedMethod`.

    seconds: median time of the rounds, in s: processor time, or clock time in the benchmark of sweeps. error:
    relative error; nan if there is no error to measure, inf if the method failed. failure: reason for the
    failure. least_seconds: minimum time of the rounds, in s, which depends less on other programs.
    extra_columns: further numbers by name."""

    case: str
    method: str
    setting: str
    seconds: float
    error: float
    group: str = ""
    failure: str = ""
    least_seconds: float = nan
    extra_columns: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class BenchmarkReport:
    """Report and measurements of one benchmark.

    text: report in Markdown. measurements: measurements in the figure. run_noun: noun for a run, as in "ms a
    point". target_error: error at which methods are compared. undrawn_measurements: further measurements,
    which are only in the file."""

    name: str
    """Name of the study, as in `rodsweep bench NAME`."""
    text: str
    measurements: Sequence[Measurement]
    run_noun: str = "run"
    target_error: float | None = None
    undrawn_measurements: Sequence[Measurement] = ()

    @property
    def is_drawable(self) -> bool:
        """Whether a measurement in `measurements` has a finite error, so that the figure is not empty."""
        return any(isfinite(m.error) for m in self.measurements)

    def draw(self, output: Path) -> None:
        """Writes a figure of errors against time into a file: a panel per case, a curve per method."""
        draw_work_precision(
            measurement_columns(self.measurements), f"ms a {self.run_noun}", self.target_error, output
        )

    def table(self) -> Table:
        """All measurements as the columns of a table, for the file."""
        return measurement_columns([*self.measurements, *self.undrawn_measurements])


def measurement_columns(measurements: Sequence[Measurement]) -> Table:
    """The measurements as columns, by name; a number that a measurement does not have is nan."""
    columns: Table = {
        name: [getattr(m, name) for m in measurements]
        for name in ("case", "method", "group", "setting", "seconds", "least_seconds", "error", "failure")
    }
    for name in dict.fromkeys(name for m in measurements for name in m.extra_columns):
        columns[name] = [m.extra_columns.get(name, nan) for m in measurements]
    return columns


class TimedRuns(NamedTuple, Generic[Outcome]):
    """Timed runs of a function. outcome: result of the first run. processor_seconds: processor time of every
    timed run, in s."""

    outcome: Outcome
    processor_seconds: tuple[float, ...]

    @property
    def median_seconds(self) -> float:
        return median(self.processor_seconds)


def time_runs(runs: Sequence[Callable[[], Outcome]], rounds: Sequence[int]) -> list[TimedRuns[Outcome]]:
    """Results and times of the functions `runs`, called in turn, round by round. rounds: number of timed
    rounds of each function.

    The first call of a function, which may load and compile code, is timed only if the function has no
    rounds. A function with a short run is called twice in succession and the second call is timed, so that
    the processor caches do not depend on the previous function.
    """
    first = [_time_one_run(run) for run in runs]
    seconds: list[list[float]] = [[] for _ in runs]
    for i in timing_order(rounds):
        if first[i].median_seconds < MAX_CACHE_SENSITIVE_SECONDS:
            runs[i]()
        seconds[i] += _time_one_run(runs[i]).processor_seconds
    return [
        TimedRuns(a.outcome, tuple(further) or a.processor_seconds)
        for a, further in zip(first, seconds, strict=True)
    ]


def timing_order(rounds: Sequence[int]) -> Iterator[int]:
    """Indices of functions in the order of timing: round by round, so that a slow period of the machine
    affects all functions. rounds: number of rounds of each function."""
    for round_number in range(max(rounds)):
        yield from (i for i, round_count in enumerate(rounds) if round_number < round_count)


def _time_one_run(run: Callable[[], Outcome]) -> TimedRuns[Outcome]:
    """Outcome and processor time of one call of `run`, child processes included."""
    start = processor_seconds_with_children()
    outcome = run()
    return TimedRuns(outcome, (processor_seconds_with_children() - start,))


def processor_seconds_with_children() -> float:
    """Processor time, in s, used so far by this process and by its finished child processes."""
    programs = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + programs.ru_utime + programs.ru_stime


def result_or_error(run: Callable[[Any], Outcome], case: Any) -> Outcome | Exception:
    """Result of `run(case)`, or the exception that this call raised."""
    try:
        with np.errstate(all="ignore"):
            return run(case)
    except Exception as error:
        return error


ErrorMeasuringFunction = Callable[[Any], dict[str, Any]]
"""Function from a result of a method to a dictionary with `error` and further fields of `Measurement`."""


class CaseWithErrorMeasure(NamedTuple):
    """A case on which methods are compared, with its name and the function that measures errors."""

    name: str
    case: Any
    measure_error: ErrorMeasuringFunction
    """Function from a method's result on the case to the fields of `Measurement`."""


def measure_case(
    name: str,
    case: Any,
    contenders: Sequence[TimedMethod],
    round_count: int,
    measure_error: ErrorMeasuringFunction,
) -> list[Measurement]:
    """Measurements of all methods `contenders` on one case, timed in turn. name: name of the case.
    round_count: number of timed runs of each method; a slow method runs only once. measure_error: function
    from a method's result to the fields of `Measurement`."""
    return measure_cases([CaseWithErrorMeasure(name, case, measure_error)], contenders, round_count)


def measure_cases(
    cases: Sequence[CaseWithErrorMeasure], contenders: Sequence[TimedMethod], round_count: int
) -> list[Measurement]:
    """Measurements of all methods `contenders` on all cases `cases`, timed in turn. round_count: number of
    timed runs of each method on a case; a slow method runs only once."""
    pairs = [(entry, contender) for entry in cases for contender in contenders]
    runs = [partial(result_or_error, contender.run, entry.case) for entry, contender in pairs]
    times = time_runs(runs, [0 if contender.is_slow else round_count for _, contender in pairs])
    measurements = []
    for (entry, c), timed in zip(pairs, times, strict=True):
        failed = isinstance(timed.outcome, Exception)
        failure_fields = {"failure": f"failed ({type(timed.outcome).__name__})"}
        fields = {"error": inf} | (failure_fields if failed else entry.measure_error(timed.outcome))
        names = {"case": entry.name, "method": c.method, "setting": c.setting, "group": c.group}
        fields |= names | {"seconds": timed.median_seconds, "least_seconds": min(timed.processor_seconds)}
        measurements.append(Measurement(**fields))
    return measurements


def grouped_by_fields(
    items: Iterable[MethodOrMeasurement], *names: str
) -> dict[tuple[str, ...], list[MethodOrMeasurement]]:
    """Lists of methods or measurements with equal values of the fields `names`, by these values, in order of
    first appearance."""
    groups: dict[tuple[str, ...], list[MethodOrMeasurement]] = {}
    for item in items:
        groups.setdefault(tuple(getattr(item, name) for name in names), []).append(item)
    return groups


def every_nth_setting(contenders: Iterable[TimedMethod], stride: int) -> list[TimedMethod]:
    """The methods with every n-th setting of each method, from the first setting, for a quick run.
    contenders: methods with all settings. stride: n."""
    return [c for settings in grouped_by_fields(contenders, "method").values() for c in settings[::stride]]


def nan_median(values: Iterable[float]) -> float:
    """Median of the values that are not nan; nan if all are nan."""
    numbers = [value for value in values if not isnan(value)]
    return float(median(numbers)) if numbers else nan


class BlankIfNan(float):
    """A number whose formatted text is "" if the number is nan."""

    def __format__(self, form: str) -> str:
        return "" if isnan(self) else super().__format__(form)


def markdown_table(titles: str, line: str, rows: Iterable[Mapping[str, object]]) -> str:
    """Table in Markdown.

    titles: titles of the columns, separated by |. line: format string of a row, such as "{method} |
    {seconds:.2f}". rows: values of each row, by name.
    """
    lines = [f"| {titles} |", "|" + "---|" * (titles.count("|") + 1)]
    for row in rows:
        cells = {k: BlankIfNan(v) if isinstance(v, int | float) else v for k, v in row.items()}
        lines.append(f"| {line.format_map(cells)} |")
    return "\n".join(lines)
