"""The sweep benchmark: what a second rank gains, and what a point costs beside its solution.

Every number comes from `rodsweep run` itself. Where only the sweep is to be seen, up to 1e6 points, a solver
that costs nothing takes the place of the real one.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import log, nan
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from ..study import Measurement, Study
from .launch import CONFIG, Case, Run, launcher, run

SIZES, QUICK_SIZES = (10**3, 10**4, 10**5, 10**6), (10**3, 10**4)
"""Points of the sweeps without a solver."""
ONCE_FROM = 10**6
"""Points from which a sweep without a solver is run once: the start is little of it then."""
SPECTRA, QUICK_SPECTRA = 200_000, 6_000
CYCLES, QUICK_CYCLES = 200, 10
ROUNDS, CYCLE_ROUNDS, QUICK_ROUNDS = 3, 2, 1
HOPF = 27.4271941267592812
"""F of the Hopf point of k1 = 1e4, k2 = 1e2, gamma3 = 1e-2."""
MEGABYTE = 1e6

SPECTRUM_CONFIG = """
task: spectrum
parameters:
  F: {{start: 0, stop: 90, num: {forces}}}
  k1: [200, .inf]
  k2: {k2}
  gamma3: 1.0e-4
spectrum: {{modes: 2}}
"""
CYCLE = "limit cycles"
APART = "spectra, two commands"
"""Each with half of the spectra on one rank, at the same time: what the machine allows two ranks to gain."""
CYCLE_CONFIG = "task: limit_cycle\nparameters: {points: points.csv}\n"


@dataclass(frozen=True, slots=True)
class Row:
    """The medians over all runs of one case on some ranks."""

    case: str
    points: int
    ranks: int
    runs: tuple[Run, ...]

    def median(self, of: Callable[[Run], float]) -> float:
        """The median of what `of` says of a run."""
        return float(np.median([of(run) for run in self.runs]))

    @property
    def seconds(self) -> float:
        return self.median(lambda run: run.seconds)

    @property
    def inside(self) -> float:
        return self.median(lambda run: run.inside)

    @property
    def beside(self) -> float:
        """Microseconds a point that the ranks spend on anything but the solver, the start left out."""
        return self.median(lambda run: 1e6 * (self.ranks * run.inside - run.solving) / self.points)

    @property
    def memory(self) -> list[float]:
        """Peak megabytes of the first rank, and of the largest other."""
        return [max(values) / MEGABYTE for values in zip(*(run.memory for run in self.runs), strict=True)]

    @property
    def file(self) -> float:
        """Bytes a point of the result file."""
        return self.runs[0].file / self.points

    @property
    def journal(self) -> float:
        """Bytes a point of the journals of a run that was killed at its last point."""
        return self.runs[0].journal / max(self.points - 1, 1)

    @property
    def elsewhere(self) -> float:
        return self.median(lambda run: run.elsewhere)

    @property
    def busy(self) -> float:
        """Share of the ranks' time that went into points."""
        return self.median(lambda run: run.busy)


def sweep_study(quick: bool) -> Study:
    """Runs the benchmark: the gain of a second rank, then what a point costs without a solver."""
    rounds = QUICK_ROUNDS if quick else ROUNDS
    ranks = (1, 2) if launcher(2) else (1,)
    with TemporaryDirectory(prefix="rodsweep-bench-") as place:
        solved = solved_rows(Path(place), quick, ranks, rounds)
        instant = instant_rows(Path(place), quick, ranks, rounds)
        resumed = resumed_rows(Path(place), quick)
    parts = [introduction(rounds), solved_table(solved)]
    if len(ranks) > 1:
        parts.append(ceiling(solved))
    else:
        parts.append("Two ranks are skipped: there is no mpiexec beside this Python or on PATH.")
    parts += [instant_table(instant, resumed), growth(instant, resumed)]
    rows = [*solved, *instant, *resumed]
    return Study("sweep", "\n\n".join(parts), tuple(measured(row) for row in rows), "run")


def spectrum_case(directory: Path, name: str, points: int, kind: str) -> Case:
    """A grid of two k1 and of F and k2; 200 points or more are rounded down to hundreds."""
    forces = 50 if points >= 200 else 2
    softnesses = points // (2 * forces)
    directory.mkdir()
    k2 = f"{{start: 100, stop: 1.0e4, num: {softnesses}, spacing: log}}"
    (directory / CONFIG).write_text(SPECTRUM_CONFIG.format(forces=forces, k2=k2))
    return Case(name, 2 * forces * softnesses, directory, kind)


def cycle_case(directory: Path, points: int) -> Case:
    """Limit cycles of very different cost, in an order that mixes them."""
    directory.mkdir()
    rows = [f"{F!r},1e4,1e2,1e-2,1" for F in uneven_forces(points).tolist()]
    (directory / "points.csv").write_text("\n".join(["F,k1,k2,gamma3,gamma1", *rows]) + "\n")
    (directory / CONFIG).write_text(CYCLE_CONFIG)
    return Case(CYCLE, points, directory)


def uneven_forces(count: int) -> np.ndarray:
    """Forces far below the Hopf point, just below it, just above it, and ordinary ones, well mixed."""
    below, close, above = count // 5, count // 6, count // 4
    forces = np.concatenate(
        [
            np.linspace(5, 27, below),
            HOPF * (1 - np.geomspace(1e-6, 1e-2, close)),
            HOPF * (1 + np.geomspace(1e-7, 1e-2, above)),
            np.linspace(28, 90, count - below - close - above),
        ]
    )
    return np.random.default_rng(1).permutation(forces)


def solved_rows(place: Path, quick: bool, ranks: Sequence[int], rounds: int) -> list[Row]:
    """Spectra and limit cycles on one rank and on two, in turn."""
    count = QUICK_SPECTRA if quick else SPECTRA
    spectra = spectrum_case(place / "spectra", "spectra", count, "solved")
    cases = [spectra, cycle_case(place / "cycles", QUICK_CYCLES if quick else CYCLES)]
    first = [spectrum_case(place / "first", "first", 8, "solved"), cycle_case(place / "first_cycle", 1)]
    for case in first:  # not timed: formulas may have to be compiled
        run(case, 1)
    pairs = [(case, n) for case in cases for n in ranks]
    if len(ranks) > 1:
        halves = [spectrum_case(place / f"half{i}", APART, count // 2, "solved") for i in (0, 1)]
        pairs.insert(len(ranks), (replace(halves[0], points=count, beside=halves[1]), 1))
    return interleaved(pairs, [min(rounds, CYCLE_ROUNDS) if c.name == CYCLE else rounds for c, _ in pairs])


def instant_rows(place: Path, quick: bool, ranks: Sequence[int], rounds: int) -> list[Row]:
    """Sweeps of all sizes without a solver."""
    sizes = QUICK_SIZES if quick else SIZES
    cases = [spectrum_case(place / f"instant{size}", "no solver", size, "instant") for size in sizes]
    pairs = [(case, n) for case in cases for n in ranks]
    return interleaved(pairs, [1 if case.points >= ONCE_FROM else rounds for case, _ in pairs])


def interleaved(pairs: Sequence[tuple[Case, int]], rounds: Sequence[int]) -> list[Row]:
    """Each case on its number of ranks, all in turn, so that a slow spell of the machine hits all alike."""
    runs: list[list[Run]] = [[] for _ in pairs]
    for turn in range(max(rounds)):
        for (case, ranks), own, most in zip(pairs, runs, rounds, strict=True):
            if turn < most:
                own.append(run(case, ranks))
    return [
        Row(case.name, case.points, ranks, tuple(own)) for (case, ranks), own in zip(pairs, runs, strict=True)
    ]


def resumed_rows(place: Path, quick: bool) -> list[Row]:
    """What is left of a run that is killed at its last point, and the run that takes it up."""
    rows = []
    for size in QUICK_SIZES if quick else SIZES:
        case = spectrum_case(place / f"killed{size}", "killed", size, "killed")
        killed = run(case, 1)
        rows.append(Row(case.name, case.points, 1, (killed,)))
        again = Case("resumed", case.points, case.directory, "instant")
        rows.append(Row(again.name, again.points, 1, (run(again, 1, fresh=False),)))
    return rows


def measured(row: Row) -> Measurement:
    """A row as a measurement; no error applies."""
    megabytes = row.memory
    extra = {
        "ranks": float(row.ranks),
        "points": float(row.points),
        "points_per_second": row.points / row.seconds,
        "microseconds_overhead": row.beside,
        "rss_megabytes": max(megabytes),
        "rss_megabytes_first": megabytes[0],
        "file_bytes_per_point": row.file,
        "journal_bytes_per_point": row.journal if row.case == "killed" else nan,
        "processors_elsewhere": row.elsewhere,
        "share_busy": row.busy,
    }
    method = f"{row.ranks} rank{'s' * (row.ranks > 1)}"
    return Measurement(row.case, method, f"{row.points} points", row.seconds, nan, "", extra)


def introduction(rounds: int) -> str:
    """What is measured."""
    often = (
        f"medians of {rounds} interleaved rounds ({CYCLE_ROUNDS} of limit cycles, 1 of {ONCE_FROM} points)"
    )
    return (
        f"`mpiexec -n RANKS rodsweep run CONFIG` as a whole, {often if rounds > 1 else 'one round'}. "
        "Spectra: `modes: 2`, certified, over F, k1, k2. Limit cycles: of k1 = 1e4, k2 = 1e2, "
        "gamma3 = 1e-2, at forces far below the Hopf point, down to 1e-6 below and 1e-7 above it, and "
        "ordinary ones, mixed. Inside is the time that the run itself states, without the start of Python "
        "and MPI; of the ranks' time in the sweep, % busy went into points, the rest into waiting for more "
        "or for each other. Beside the solver is the ranks' time inside less the `seconds` in the "
        "file: loading what is compiled, handing out, storing, and waiting. Memory is the peak of a rank's "
        "resident set. While other programs, or the host of a virtual machine, keep processors busy, a "
        "second rank gains less."
    )


def solved_table(rows: Sequence[Row]) -> str:
    """Spectra and limit cycles with their solvers."""
    lines = [
        "| sweep | points | ranks | s | points a second | gain | gain inside | % busy "
        "| µs a point beside the solver | MB a rank | processors busy elsewhere |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    alone = {row.case: row for row in rows if row.ranks == 1}
    for row in (row for row in rows if row.case != APART):
        one = alone[row.case]
        gains = " | " if row is one else f"{one.seconds / row.seconds:.2f} | {one.inside / row.inside:.2f}"
        lines.append(
            f"| {row.case} | {row.points} | {row.ranks} | {row.seconds:.2f} | {row.points / row.seconds:.4g} "
            f"| {gains} | {100 * row.busy:.1f} | {row.beside:.0f} | {max(row.memory):.1f} "
            f"| {row.elsewhere:.2f} |"
        )
    return "\n".join(lines)


def ceiling(rows: Sequence[Row]) -> str:
    """What two commands that know nothing of each other gain, the most that two ranks can."""
    apart = next(row for row in rows if row.case == APART)
    alone = next(row for row in rows if row.ranks == 1 and row.case != APART)
    return (
        f"Two commands side by side, each with half of the spectra on one rank, take {apart.seconds:.2f} s "
        f"together, {alone.seconds / apart.seconds:.2f} times less than one command with all: this is what "
        "two processors of this machine gain at most, and what two ranks have to be compared with."
    )


def instant_table(rows: Sequence[Row], resumed: Sequence[Row]) -> str:
    """Sweeps without a solver, and what a kill leaves of them."""
    lines = [
        "The same command with a solver that returns random eigenvalues at once, so that everything counts "
        "as scheduling and storing; then killed at its last point on one rank, and resumed:",
        "",
        "| points | ranks | s | µs a point | µs a further point | MB, first rank | MB, other "
        "| bytes a point, file | bytes a point, journal | s to resume | MB, resuming |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    after = {(row.case, row.points): row for row in resumed}
    for row in rows:
        fewer = [r for r in rows if r.ranks == row.ranks and r.points < row.points]
        further = f"{_further(fewer[-1], row, _microseconds):.1f}" if fewer else ""
        first, *others = (f"{megabytes:.1f}" for megabytes in row.memory)
        end = " | | "
        if row.ranks == 1:
            killed, again = after["killed", row.points], after["resumed", row.points]
            end = f"{killed.journal:.1f} | {again.seconds:.2f} | {max(again.memory):.1f}"
        lines.append(
            f"| {row.points} | {row.ranks} | {row.seconds:.2f} | {_microseconds(row) / row.points:.1f} "
            f"| {further} | {first} | {''.join(others)} | {row.file:.1f} | {end} |"
        )
    return "\n".join(lines)


def growth(rows: Sequence[Row], resumed: Sequence[Row]) -> str:
    """How time, memory and file grow over the last step of the sizes."""
    kinds = [(f"{n} rank{'s' * (n > 1)}", [row for row in rows if row.ranks == n]) for n in (1, 2)]
    kinds.append(("resumed", [row for row in resumed if row.case == "resumed"]))
    lines = []
    for name, every in kinds:
        if len(every) < 2:
            continue
        less, more = every[-2:]
        words = [
            f"From {less.points} to {more.points} points, {name}: {_exponent(every)}a further point "
            f"takes {_further(less, more, _microseconds):.3g} µs of a rank and "
            f"{_further(less, more, lambda row: row.runs[0].file):.4g} bytes of the file"
        ]
        for rank, a, b in zip(("first", "other"), less.memory, more.memory, strict=False):
            each = (b - a) * MEGABYTE / (more.points - less.points)
            moved = f"{b - a:+.1f} MB, {each:+.1f} bytes a point"
            words.append(f"the peak of the {rank} rank's memory moves by {moved}")
        lines.append("- " + "; ".join(words) + ".")
    return "\n".join(lines)


def _microseconds(row: Row) -> float:
    """Of all ranks."""
    return 1e6 * row.ranks * row.seconds


def _further(less: Row, more: Row, of: Callable[[Row], float]) -> float:
    """What a further point takes of something."""
    return (of(more) - of(less)) / (more.points - less.points)


def _exponent(rows: Sequence[Row]) -> str:
    """The power of the points with which the time beyond that of the smallest sweep grows, in words."""
    if len(rows) < 3:
        return ""
    a, b = (row.seconds - rows[0].seconds for row in rows[-2:])
    if min(a, b) <= 0:
        return ""
    power = log(b / a) / log((rows[-1].points - rows[0].points) / (rows[-2].points - rows[0].points))
    return f"time beyond the start grows as the points to the power {power:.2f}; "
