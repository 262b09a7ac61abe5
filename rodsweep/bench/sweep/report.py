"""The tables of the sweep benchmark."""

from collections.abc import Sequence
from itertools import pairwise
from math import log, nan

from ..study import Measurement, grouped
from ..tables import table
from .launch import KILLED

APART = "spectra, two commands"
"""Each with half of the spectra, on one rank: what the machine allows two ranks to gain."""
MEGABYTE = 1e6
NO_LAUNCHER = "Two ranks are skipped: there is no mpiexec beside this Python or on PATH."


def introduction() -> str:
    """What is measured."""
    return (
        "`mpiexec -n RANKS rodsweep run CONFIG` as a whole, medians of interleaved rounds. Spectra: "
        "`modes: 2`, certified, over F, k1, k2; two commands, each with half of them on one rank, gain what "
        "two processors of this machine gain at most. Limit cycles: of k1 = 1e4, k2 = 1e2, gamma3 = 1e-2, at "
        "forces far below the Hopf point, down to 1e-6 below and 1e-7 above it, and ordinary ones, mixed. "
        "Inside is the time that the run itself states, without the start of Python and MPI; % busy of the "
        "ranks' time in the sweep went into points, the rest into waiting. Beside the solver is the "
        "ranks' time inside less the `seconds` in the file: loading what is compiled, handing out, storing, "
        "and waiting. Memory is the peak of a rank's resident set. While other programs, or the host of a "
        "virtual machine, keep processors busy, a second rank gains less."
    )


def numbers(m: Measurement) -> dict[str, object]:
    """All that is known of a sweep, by name."""
    microseconds = 1e6 * m.extra["ranks"] * m.seconds
    own: dict[str, object] = {
        "case": m.case,
        "seconds": m.seconds,
        "microseconds": microseconds / m.extra["points"],
    }
    return own | m.extra


def solved_table(measurements: Sequence[Measurement]) -> str:
    """Spectra and limit cycles with their solvers."""
    rows = []
    for m in measurements:
        kind = m.case.split(",")[0]  # who is apart gains on who is not
        one = next(other for other in measurements if other.case == kind and other.extra["ranks"] == 1)
        gains = {
            "gain": nan if m is one else one.seconds / m.seconds,
            "inside": nan if m is one else one.extra["inside_seconds"] / m.extra["inside_seconds"],
            "busy": 100 * m.extra["share_busy"],
        }
        rows.append(numbers(m) | gains)
    return table(
        "sweep | points | ranks | s | points a second | gain | gain inside | % busy "
        "| µs a point beside the solver | MB a rank | processors busy elsewhere",
        "{case} | {points:.0f} | {ranks:.0f} | {seconds:.2f} | {points_per_second:.4g} | {gain:.2f} "
        "| {inside:.2f} | {busy:.1f} | {microseconds_overhead:.0f} | {rss_megabytes:.1f} "
        "| {processors_elsewhere:.2f}",
        rows,
    )


def instant_table(measurements: Sequence[Measurement]) -> str:
    """Sweeps without a solver, and what a kill leaves of them."""
    return (
        "The same command with a solver that returns random eigenvalues at once, so that everything counts "
        "as scheduling and storing; then killed at its last point on one rank, and resumed:\n\n"
    ) + table(
        "sweep | points | ranks | s | µs a point | MB, first rank | MB, other | bytes a point, file "
        "| bytes a point, journal",
        "{case} | {points:.0f} | {ranks:.0f} | {seconds:.2f} | {microseconds:.1f} "
        "| {rss_megabytes_first:.1f} | {rss_megabytes_other:.1f} | {file_bytes_per_point:.1f} "
        "| {journal_bytes_per_point:.1f}",
        map(numbers, measurements),
    )


def growth_table(measurements: Sequence[Measurement]) -> str:
    """How time, memory and file grow from each size to the next; what is killed has no file."""
    rows = []
    for (case, method), sizes in grouped(measurements, "case", "method").items():
        if case == KILLED:
            continue
        for less, more in pairwise(sizes):
            row: dict[str, object] = {
                "case": case,
                "method": method,
                "power": growth_power(sizes[0], less, more),
            }
            for name, end in totals(more).items():
                start = totals(less)[name]
                row[name] = (end - start) / (more.extra["points"] - less.extra["points"])
            rows.append(row | {"less": less.extra["points"], "more": more.extra["points"]})
    return (
        "What a further point takes, of all ranks together; the power is that of the points with which the "
        "time beyond that of the smallest sweep grows:\n\n"
    ) + table(
        "sweep | on | from | to points | µs | bytes of file | bytes, first rank | bytes, other | power",
        "{case} | {method} | {less:.0f} | {more:.0f} | {microseconds:.3g} | {file:.4g} | {first:+.1f} "
        "| {other:+.1f} | {power:.2f}",
        rows,
    )


def totals(m: Measurement) -> dict[str, float]:
    """What a whole sweep takes: microseconds of all ranks, bytes of its file and of the ranks' memory."""
    return {
        "microseconds": 1e6 * m.extra["ranks"] * m.seconds,
        "file": m.extra["file_bytes_per_point"] * m.extra["points"],
        "first": MEGABYTE * m.extra["rss_megabytes_first"],
        "other": MEGABYTE * m.extra["rss_megabytes_other"],
    }


def growth_power(start: Measurement, less: Measurement, more: Measurement) -> float:
    """With which the time beyond that of the smallest sweep grows; nan where it does not."""
    if less is start or min(less.seconds, more.seconds) <= start.seconds:
        return nan
    times = (more.seconds - start.seconds) / (less.seconds - start.seconds)
    points = [m.extra["points"] - start.extra["points"] for m in (more, less)]
    return log(times) / log(points[0] / points[1])
