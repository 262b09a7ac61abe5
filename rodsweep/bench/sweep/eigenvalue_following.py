"""Time of sweeps of spectra whose eigenvalues are followed along an axis of the grid, compared with sweeps
whose points are solved one by one."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import nan, prod
from pathlib import Path

from ...results.file.view import read_view
from ..study import Measurement, markdown_table
from .launch import CONFIG_NAME, RESULT, SOLVED, CommandRunCost, SweepCase

FOLLOWING_SWEEP_CONFIG = """
task: spectrum
parameters:
  F: {{start: 0, stop: {F_max}, num: {0}}}
  k1: {{start: 100, stop: 1.0e4, num: {1}, spacing: log}}
  k2: {{start: 100, stop: 1.0e4, num: {2}, spacing: log}}
  gamma3: {{start: 1.0e-4, stop: 1.0e-2, num: {3}, spacing: log}}
  taper: {taper}
spectrum: {{modes: 4, follow: {4}}}
"""
"""Config of a sweep, as a format string. Fields: 0 to 3: numbers of values of F, k1, k2 and gamma3; 4: value
of `follow`; F_max; taper."""
EIGENVALUE_FOLLOWING_METHOD = "followed"
"""Name of the method for sweeps whose eigenvalues are followed."""
POINT_BY_POINT_METHOD = "alone"
"""Name of the method for sweeps in which each point is solved alone."""


@dataclass(frozen=True, slots=True)
class ComparedGrids:
    """Two grids over F, k1, k2 and gamma3: a grid for following eigenvalues along its longest axis, and a
    smaller grid of points solved one by one.

    name: text that names the longest axis. following_grid_shape, point_by_point_grid_shape: numbers of values
    of F, k1, k2 and gamma3 of the two grids. F_max: largest force. taper: taper of all rods.
    """

    name: str
    following_grid_shape: tuple[int, int, int, int]
    point_by_point_grid_shape: tuple[int, int, int, int]
    F_max: float = 60.0
    taper: float = 1.0


GRID_PAIRS = (
    ComparedGrids("512 of F", (512, 2, 98, 2), (512, 2, 5, 2)),
    ComparedGrids("2000 of k2", (25, 2, 2000, 2), (2, 2, 2000, 2)),
    ComparedGrids("50 of F", (50, 40, 50, 2), (50, 4, 50, 2)),
    ComparedGrids("12 of F", (12, 12, 12, 12), (12, 12, 12, 6)),
    ComparedGrids("512 of F, cones", (512, 2, 4, 2), (32, 2, 4, 2), F_max=20.0, taper=0.5),
)
"""Pairs of grids that are timed."""
QUICK_GRID_PAIRS = (
    ComparedGrids("64 of F", (64, 2, 2, 2), (8, 2, 2, 2)),
    ComparedGrids("12 of F", (12, 2, 3, 2), (2, 2, 2, 2)),
    ComparedGrids("64 of F, cones", (64, 2, 2, 2), (2, 2, 2, 2), F_max=20.0, taper=0.5),
)
"""Pairs of grids that are timed in a quick run."""


def measure_eigenvalue_following(
    folder: Path, run: Callable[..., CommandRunCost], quick: bool
) -> list[Measurement]:
    """Measurements of sweeps of certified spectra on one rank: for each pair of grids first
    EIGENVALUE_FOLLOWING_METHOD, then POINT_BY_POINT_METHOD.

    run: see `CaseRunner` of `rodsweep.bench.sweep.study`.
    """
    measurements = []
    for grids in QUICK_GRID_PAIRS if quick else GRID_PAIRS:
        for method, shape in (
            (EIGENVALUE_FOLLOWING_METHOD, grids.following_grid_shape),
            (POINT_BY_POINT_METHOD, grids.point_by_point_grid_shape),
        ):
            directory = folder / f"{method} {grids.name}".replace(" ", "_")
            directory.mkdir()
            text = FOLLOWING_SWEEP_CONFIG.format(
                *shape,
                str(method == EIGENVALUE_FOLLOWING_METHOD).lower(),
                F_max=grids.F_max,
                taper=grids.taper,
            )
            (directory / CONFIG_NAME).write_text(text)
            case = SweepCase(grids.name, prod(shape), (directory,), SOLVED)
            measurements.append(following_sweep_measurement(case, method, run(case, 1)))
    return measurements


def following_sweep_measurement(case: SweepCase, method: str, run: CommandRunCost) -> Measurement:
    """Measurement of the sweep `case` by `method` from its run `run`: times, number of points solved on a
    mesh, number of points without certificate, and memory."""
    variables = read_view(case.directories[0] / RESULT).variables
    values = {
        "points": float(case.points),
        "microseconds": 1e6 * run.printed_seconds / case.points,
        "microseconds_solving": 1e6 * run.solver_seconds / case.points,
        "meshes": float((variables["elements"] > 0).sum()),
        "uncertified": float((variables["certified"] == 0).sum()),
        "rss_megabytes": max(run.first_and_other_rank_peak_bytes) / 1e6,
    }
    points = f"{case.points} points"
    return Measurement(f"axis, {case.name}", method, points, run.printed_seconds, nan, extra_columns=values)


def following_sweep_table(measurements: Sequence[Measurement]) -> str:
    """Table of the sweeps, with one line per pair of grids, after a paragraph that explains it."""
    rows = []
    for followed, unfollowed in zip(measurements[::2], measurements[1::2], strict=True):
        speedup = (
            unfollowed.extra_columns["microseconds_solving"] / followed.extra_columns["microseconds_solving"]
        )
        row = {"axis": followed.case.removeprefix("axis, "), "seconds": followed.seconds, "gain": speedup}
        unfollowed_values = {f"{name}_alone": value for name, value in unfollowed.extra_columns.items()}
        rows.append(row | followed.extra_columns | unfollowed_values)
    return (
        "Certified spectra, `modes: 4`, along the longest axis of grids of F, k1, k2, gamma3, on one rank; "
        '"alone" is `follow: false` on a part of the same grid. Seconds are printed by the run and include '
        "loading of compiled code, scheduling and storing; µs of the solver are from `seconds` in the file. "
        '"With a mesh" is the number of points that could not be followed, or not be proved complete. Cones '
        "have half the radius at their tips:\n\n"
    ) + markdown_table(
        "axis | points | s | µs a point | µs of the solver | alone | times | with a mesh | not certified "
        "| MB a rank",
        "{axis} | {points:.0f} | {seconds:.2f} | {microseconds:.1f} | {microseconds_solving:.1f} "
        "| {microseconds_solving_alone:.0f} | {gain:.1f} | {meshes:.0f} | {uncertified:.0f} "
        "| {rss_megabytes:.0f}",
        rows,
    )
