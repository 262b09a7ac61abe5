"""The sweep benchmark: speedup by a second rank, and overhead of a point in addition to its solution.

All numbers are measured on runs of `rodsweep run`. To measure the overhead of up to 1e6 points, an instant
solver, which returns random results at once, replaces the real solver.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from math import log, nan
from pathlib import Path
from tempfile import TemporaryDirectory

from ...wording import counted
from ..study import BenchmarkReport, Measurement, grouped_by_fields, markdown_table, nan_median, timing_order
from .eigenvalue_following import following_sweep_table, measure_eigenvalue_following
from .launch import (
    INSTANT,
    KILLED,
    SOLVED,
    CommandRunCost,
    SweepCase,
    launcher_arguments,
    run_case,
    write_cycle_case,
    write_spectrum_case,
)

SWEEP_SIZES, QUICK_SIZES = (10**3, 10**4, 10**5, 10**6), (10**3, 10**4)
"""Numbers of points of the sweeps with the instant solver, in a complete and in a quick run."""
MIN_POINTS_OF_UNREPEATED_SWEEP = 10**6
"""Sweeps with the instant solver and this number of points or more are run only once."""
SPECTRUM_COUNT, QUICK_SPECTRUM_COUNT = 200_000, 6_000
"""Number of points of the sweep of spectra, in a complete and in a quick run."""
CYCLE_COUNT, QUICK_CYCLE_COUNT = 200, 10
"""Number of points of the sweep of limit cycles, in a complete and in a quick run."""
ROUND_COUNT, CYCLE_ROUND_COUNT, QUICK_ROUND_COUNT = 3, 2, 1
"""Numbers of timed rounds of spectra, of limit cycles, and of all sweeps of a quick run."""
TWO_COMMAND_CASE = "spectra, two commands"
"""Name of the case of two simultaneous commands, each with half of the spectra on one rank; its speed is an
upper bound for the speed of two ranks."""
MEGABYTE = 1e6
"""Number of bytes of a megabyte."""
INTRODUCTION = """
`mpiexec -n RANKS rodsweep run CONFIG` as a whole, medians of interleaved rounds. Spectra: `modes: 2`,
certified, over F, k1, k2. Two commands, each with half of the spectra on one rank, show the largest possible
gain of two processors on this machine. Limit cycles: k1 = 1e4, k2 = 1e2, gamma3 = 1e-2, at mixed forces far
below the Hopf point, down to 1e-6 below and 1e-7 above it, and far above. "Inside" is the time printed by the
run, without the start of Python and MPI; "% busy" is the fraction of the ranks' time in the sweep spent on
points, not on waiting. "Outside the solver" is the ranks' time inside minus the `seconds` in the file:
loading compiled code, scheduling, storing, and waiting. Memory is the peak of a rank's resident set. A second
rank gains less while other programs, or the host of a virtual machine, keep processors busy."""
"""Description of the measurements for the report."""
CaseRunner = Callable[..., CommandRunCost]
"""Function that runs a sweep: (case, number of ranks, fresh: replace an existing file) -> cost."""


def run_sweep_study(quick: bool, command: Sequence[str]) -> BenchmarkReport:
    """Results of the benchmark: speedup by a second rank, followed eigenvalues, and overhead of a point.

    quick: whether to use fewer points and rounds. command: first arguments of the measured command, see
    `rodsweep.bench.sweep.launch`.
    """
    run = partial(run_case, command)
    ranks = (1, 2) if launcher_arguments(2) else (1,)
    with TemporaryDirectory(prefix="rodsweep-bench-") as folder:
        solved = measure_solved_sweeps(Path(folder), run, quick, ranks)
        followed = measure_eigenvalue_following(Path(folder), run, quick)
        instant = measure_instant_sweeps(Path(folder), run, quick, ranks)
    blocks = [INTRODUCTION.strip(), real_solver_table(solved), following_sweep_table(followed)]
    blocks += [instant_solver_table(instant), added_point_cost_table(instant)]
    if len(ranks) == 1:
        blocks.append("Two ranks are skipped: there is no mpiexec in the folder of this Python or on PATH.")
    return BenchmarkReport("sweep", "\n\n".join(blocks), [*solved, *followed, *instant])


def measure_solved_sweeps(
    folder: Path, run: CaseRunner, quick: bool, ranks: Sequence[int]
) -> list[Measurement]:
    """Measurements of sweeps of spectra and of limit cycles with the real solver, run in turn."""
    rounds, cycle_rounds = (QUICK_ROUND_COUNT,) * 2 if quick else (ROUND_COUNT, CYCLE_ROUND_COUNT)
    count = QUICK_SPECTRUM_COUNT if quick else SPECTRUM_COUNT
    spectra = write_spectrum_case(folder / "spectra", "spectra", count, SOLVED)
    cycles = write_cycle_case(folder / "cycles", QUICK_CYCLE_COUNT if quick else CYCLE_COUNT, SOLVED)
    # Not timed: the first runs may compile the formulas.
    run(write_spectrum_case(folder / "first", "first", 8, SOLVED), 1)
    run(write_cycle_case(folder / "first_cycle", 1, SOLVED), 1)
    entries = [(spectra, rank_count, rounds) for rank_count in ranks]
    if len(ranks) > 1:
        halves = [
            write_spectrum_case(folder / f"half{i}", TWO_COMMAND_CASE, count // 2, SOLVED) for i in (0, 1)
        ]
        both = replace(halves[0], points=count, directories=halves[0].directories + halves[1].directories)
        entries.append((both, 1, rounds))
    return measure_in_turn(run, entries + [(cycles, rank_count, cycle_rounds) for rank_count in ranks])


def measure_instant_sweeps(
    folder: Path, run: CaseRunner, quick: bool, ranks: Sequence[int]
) -> list[Measurement]:
    """Measurements of sweeps of all sizes with the instant solver: complete, killed and resumed. ranks:
    numbers of ranks; killed and resumed sweeps have one rank."""
    sizes, rounds = (QUICK_SIZES, QUICK_ROUND_COUNT) if quick else (SWEEP_SIZES, ROUND_COUNT)
    entries = []
    for size in sizes:
        case = write_spectrum_case(folder / f"instant{size}", "no solver", size, INSTANT)
        round_count = 1 if size >= MIN_POINTS_OF_UNREPEATED_SWEEP else rounds
        entries += [(case, rank_count, round_count) for rank_count in ranks]
    measurements = measure_in_turn(run, entries)
    for size in sizes:
        killed = write_spectrum_case(folder / f"killed{size}", KILLED, size, KILLED)
        resumed = replace(killed, name="resumed", solver_kind=INSTANT)
        measurements.append(sweep_measurement(killed, 1, [run(killed, 1)]))
        measurements.append(sweep_measurement(resumed, 1, [run(resumed, 1, fresh=False)]))
    return measurements


def measure_in_turn(run: CaseRunner, planned_runs: Sequence[tuple[SweepCase, int, int]]) -> list[Measurement]:
    """Measurements of sweeps, run in turn; planned_runs: (case, number of ranks, number of rounds)."""
    runs: list[list[CommandRunCost]] = [[] for _ in planned_runs]
    for i in timing_order([rounds for _, _, rounds in planned_runs]):
        case, ranks, _ = planned_runs[i]
        runs[i].append(run(case, ranks))
    measured = zip(planned_runs, runs, strict=True)
    return [sweep_measurement(case, ranks, own_runs) for (case, ranks, _), own_runs in measured]


def sweep_measurement(case: SweepCase, rank_count: int, runs: Sequence[CommandRunCost]) -> Measurement:
    """Measurement of a sweep from several runs of it: times are medians; the field `error` is nan."""
    seconds = nan_median(run.seconds for run in runs)
    processes = rank_count * len(case.directories)
    peaks = zip(*(run.first_and_other_rank_peak_bytes for run in runs), strict=True)
    memory = [max(values) / MEGABYTE for values in peaks]
    journal_bytes, is_killed = runs[0].journal_bytes, case.solver_kind == KILLED
    overheads = (processes * run.printed_seconds - run.solver_seconds for run in runs)
    extra = {
        "ranks": float(rank_count),
        "points": float(case.points),
        "points_per_second": case.points / seconds,
        "inside_seconds": nan_median(run.printed_seconds for run in runs),
        "microseconds_overhead": nan_median(1e6 * overhead / case.points for overhead in overheads),
        "rss_megabytes": max(memory),
        "rss_megabytes_first": memory[0],
        "rss_megabytes_other": memory[1] if len(memory) > 1 else nan,
        "file_bytes_per_point": runs[0].file_bytes / case.points,
        "journal_bytes_per_point": journal_bytes / (case.points - 1) if is_killed else nan,
        "processors_elsewhere": nan_median(run.processors_busy_elsewhere for run in runs),
        "share_busy": nan_median(run.busy_fraction for run in runs),
    }
    return Measurement(
        case.name, counted(rank_count, "rank"), f"{case.points} points", seconds, nan, extra_columns=extra
    )


def values_of_table_row(m: Measurement) -> dict[str, object]:
    """Numbers of a measured sweep for a row of a table, by name of the column."""
    microseconds = 1e6 * m.extra_columns["ranks"] * m.seconds / m.extra_columns["points"]
    return {"case": m.case, "seconds": m.seconds, "microseconds": microseconds, **m.extra_columns}


def real_solver_table(measurements: Sequence[Measurement]) -> str:
    """Table of the sweeps of spectra and limit cycles with the real solver."""
    rows = []
    for m in measurements:
        kind = m.case.split(",")[0]  # two commands are compared with one command for the same sweep
        single = next(
            other for other in measurements if other.case == kind and other.extra_columns["ranks"] == 1
        )
        inside, single_inside = (entry.extra_columns["inside_seconds"] for entry in (m, single))
        gains = {
            "gain": nan if m is single else single.seconds / m.seconds,
            "inside": nan if m is single else single_inside / inside,
            "busy": 100 * m.extra_columns["share_busy"],
        }
        rows.append(values_of_table_row(m) | gains)
    return markdown_table(
        "sweep | points | ranks | s | points a second | gain | gain inside | % busy "
        "| µs a point outside the solver | MB a rank | processors busy elsewhere",
        "{case} | {points:.0f} | {ranks:.0f} | {seconds:.2f} | {points_per_second:.4g} | {gain:.2f} "
        "| {inside:.2f} | {busy:.1f} | {microseconds_overhead:.0f} | {rss_megabytes:.1f} "
        "| {processors_elsewhere:.2f}",
        rows,
    )


def instant_solver_table(measurements: Sequence[Measurement]) -> str:
    """Explained table of the sweeps with the instant solver: complete, killed and resumed."""
    return (
        "The command with an instant solver that returns random eigenvalues: all time is scheduling and "
        "storing. Next, a sweep killed at the last point on one rank, and resumed:\n\n"
    ) + markdown_table(
        "sweep | points | ranks | s | µs a point | MB, first rank | MB, other | bytes a point, file "
        "| bytes a point, journal",
        "{case} | {points:.0f} | {ranks:.0f} | {seconds:.2f} | {microseconds:.1f} "
        "| {rss_megabytes_first:.1f} | {rss_megabytes_other:.1f} | {file_bytes_per_point:.1f} "
        "| {journal_bytes_per_point:.1f}",
        map(values_of_table_row, measurements),
    )


def added_point_cost_table(measurements: Sequence[Measurement]) -> str:
    """Explained table of time, memory and file size per further point, between successive sweep sizes."""
    rows = []
    for (case, method), sizes in grouped_by_fields(measurements, "case", "method").items():
        if case == KILLED:
            continue
        for small_sweep, large_sweep in pairwise(sizes):
            few_points = small_sweep.extra_columns["points"]
            many_points = large_sweep.extra_columns["points"]
            start = time_file_and_memory_totals(small_sweep)
            row: dict[str, object] = {"case": case, "method": method, "less": few_points, "more": many_points}
            row |= {
                name: (end - start[name]) / (many_points - few_points)
                for name, end in time_file_and_memory_totals(large_sweep).items()
            }
            rows.append(row | {"power": time_growth_exponent(sizes[0], small_sweep, large_sweep)})
    return (
        'Cost of an additional point, summed over ranks. "Power" is the exponent with which the time, minus '
        "the time of the smallest sweep, grows with the number of points:\n\n"
    ) + markdown_table(
        "sweep | on | from | to points | µs | bytes of file | bytes, first rank | bytes, other | power",
        "{case} | {method} | {less:.0f} | {more:.0f} | {microseconds:.3g} | {file:.4g} | {first:+.1f} "
        "| {other:+.1f} | {power:.2f}",
        rows,
    )


def time_file_and_memory_totals(m: Measurement) -> dict[str, float]:
    """Totals of a measured sweep, by name: microseconds of all ranks, bytes of file and of memory."""
    return {
        "microseconds": 1e6 * m.extra_columns["ranks"] * m.seconds,
        "file": m.extra_columns["file_bytes_per_point"] * m.extra_columns["points"],
        "first": MEGABYTE * m.extra_columns["rss_megabytes_first"],
        "other": MEGABYTE * m.extra_columns["rss_megabytes_other"],
    }


def time_growth_exponent(start: Measurement, small: Measurement, large: Measurement) -> float:
    """Exponent p of growth, t(n) - t(n0) ~ (n - n0)^p; t(n): time of a sweep of n points, n0: number of
    points of `start`.

    start: the smallest sweep. small, large: sweeps of two successive sizes. Returns nan if `small` is
    `start`, or if the time of a sweep is not above the time of `start`.
    """
    if small is start or min(small.seconds, large.seconds) <= start.seconds:
        return nan
    time_ratio = (large.seconds - start.seconds) / (small.seconds - start.seconds)
    points = [m.extra_columns["points"] - start.extra_columns["points"] for m in (large, small)]
    return log(time_ratio) / log(points[0] / points[1])
