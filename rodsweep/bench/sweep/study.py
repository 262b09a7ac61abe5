"""The sweep benchmark: what a second rank gains, and what a point costs beside its solution.

Every number comes from `rodsweep run` itself. Where only the sweep is to be seen, up to 1e6 points, a solver
that costs nothing takes the place of the real one.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import nan
from pathlib import Path
from tempfile import TemporaryDirectory

from ..study import Measurement, Study, in_turn, middle
from ..tables import plural
from .cases import SweepCase, cycle_case, spectrum_case
from .launch import INSTANT, KILLED, SOLVED, CommandRun, launcher, run_case
from .report import APART, MEGABYTE, NO_LAUNCHER, growth_table, instant_table, introduction, solved_table

SIZES, QUICK_SIZES = (10**3, 10**4, 10**5, 10**6), (10**3, 10**4)
"""Points of the sweeps without a solver."""
ONCE_FROM = 10**6
"""Points from which a sweep without a solver is run once: the start is little of it then."""
SPECTRA, QUICK_SPECTRA = 200_000, 6_000
CYCLES, QUICK_CYCLES = 200, 10
ROUNDS, CYCLE_ROUNDS, QUICK_ROUNDS = 3, 2, 1

RunCase = Callable[..., CommandRun]
"""`run_case` with the words that start the command."""


def sweep_study(quick: bool, command: Sequence[str]) -> Study:
    """Runs the benchmark: the gain of a second rank, then what a point costs without a solver.

    command: the words that start the command that is measured, see `rodsweep.bench.sweep.launch`.
    """
    run, ranks = partial(run_case, command), (1, 2) if launcher(2) else (1,)
    with TemporaryDirectory(prefix="rodsweep-bench-") as place:
        solved = solved_sweeps(Path(place), run, quick, ranks)
        instant = instant_sweeps(Path(place), run, quick, ranks)
    blocks = [introduction(), solved_table(solved), instant_table(instant), growth_table(instant)]
    if len(ranks) == 1:
        blocks.append(NO_LAUNCHER)
    return Study("sweep", "\n\n".join(blocks), [*solved, *instant])


def solved_sweeps(place: Path, run: RunCase, quick: bool, ranks: Sequence[int]) -> list[Measurement]:
    """Spectra and limit cycles on one rank and on two, in turn."""
    rounds, cycle_rounds = (QUICK_ROUNDS, QUICK_ROUNDS) if quick else (ROUNDS, CYCLE_ROUNDS)
    count = QUICK_SPECTRA if quick else SPECTRA
    spectra = spectrum_case(place / "spectra", "spectra", count, SOLVED)
    cycles = cycle_case(place / "cycles", QUICK_CYCLES if quick else CYCLES, SOLVED)
    # Not timed: formulas may have to be compiled.
    run(spectrum_case(place / "first", "first", 8, SOLVED), 1)
    run(cycle_case(place / "first_cycle", 1, SOLVED), 1)
    entries = [(spectra, n, rounds) for n in ranks]
    if len(ranks) > 1:
        halves = [spectrum_case(place / f"half{i}", APART, count // 2, SOLVED) for i in (0, 1)]
        apart = replace(halves[0], points=count, directories=halves[0].directories + halves[1].directories)
        entries.append((apart, 1, rounds))
    return interleaved(run, entries + [(cycles, n, cycle_rounds) for n in ranks])


def instant_sweeps(place: Path, run: RunCase, quick: bool, ranks: Sequence[int]) -> list[Measurement]:
    """Sweeps of all sizes without a solver; then killed at their last point on one rank, and resumed."""
    sizes, rounds = (QUICK_SIZES, QUICK_ROUNDS) if quick else (SIZES, ROUNDS)
    entries = []
    for size in sizes:
        case = spectrum_case(place / f"instant{size}", "no solver", size, INSTANT)
        entries += [(case, n, 1 if size >= ONCE_FROM else rounds) for n in ranks]
    measurements = interleaved(run, entries)
    for size in sizes:
        killed = spectrum_case(place / f"killed{size}", KILLED, size, KILLED)
        resumed = replace(killed, name="resumed", kind=INSTANT)
        measurements.append(measured(killed, 1, [run(killed, 1)]))
        measurements.append(measured(resumed, 1, [run(resumed, 1, fresh=False)]))
    return measurements


def interleaved(run: RunCase, entries: Sequence[tuple[SweepCase, int, int]]) -> list[Measurement]:
    """Each case on its number of ranks in its number of rounds, all in turn."""
    runs: list[list[CommandRun]] = [[] for _ in entries]
    for i in in_turn([rounds for _, _, rounds in entries]):
        case, ranks, _ = entries[i]
        runs[i].append(run(case, ranks))
    return [measured(case, ranks, own) for (case, ranks, _), own in zip(entries, runs, strict=True)]


def measured(case: SweepCase, ranks: int, runs: Sequence[CommandRun]) -> Measurement:
    """The medians over all runs of one case on some ranks; no error applies."""
    seconds, processes = middle(run.seconds for run in runs), ranks * len(case.directories)
    memory = [max(values) / MEGABYTE for values in zip(*(run.memory for run in runs), strict=True)]
    extra = {
        "ranks": float(ranks),
        "points": float(case.points),
        "points_per_second": case.points / seconds,
        "inside_seconds": middle(run.inside for run in runs),
        "microseconds_overhead": middle(1e6 * (processes * r.inside - r.solving) / case.points for r in runs),
        "rss_megabytes": max(memory),
        "rss_megabytes_first": memory[0],
        "rss_megabytes_other": memory[1] if len(memory) > 1 else nan,
        "file_bytes_per_point": runs[0].file / case.points,
        "journal_bytes_per_point": runs[0].journal / (case.points - 1) if case.kind == KILLED else nan,
        "processors_elsewhere": middle(run.elsewhere for run in runs),
        "share_busy": middle(run.busy for run in runs),
    }
    return Measurement(case.name, plural(ranks, "rank"), f"{case.points} points", seconds, nan, extra=extra)
