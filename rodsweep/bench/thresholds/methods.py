"""The ways to an onset or a Hopf point that the thresholds benchmark compares, and their settings."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from math import nan
from pathlib import Path

from ...solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from . import continuation_codes as codes
from . import peers as sweeps
from .cases import Found, Problem

ONSET, HOPF = "onset", "hopf"
"""Kinds of thresholds, by their names in Case and in rodsweep's results."""
F_MAX = 200.0
GRIDS, LARGE_GRID = (50, 200), 800
TOLERANCES = (1e-3, 1e-6, 1e-12)
AUTO_SETTINGS = ((5.0, 1e-7), (1.0, 1e-4), (1.0, 1e-10))
"""(step in F, EPSS)."""
PYCONT_STEPS = (0.25, 0.5)
"""From 0.5 upwards it is chance on some rods whether it finds the Hopf point; quick runs do without 0.5."""
AUTO, PYCONT = "AUTO-07p", "PyCont-Lite"
OWN, SWEEP, CONTINUATION = "rodsweep", "grid and interpolation", "continuation"


@dataclass(frozen=True, slots=True)
class Method:
    """A way to one kind of threshold, at one setting; slow ones are timed once."""

    name: str
    setting: str
    group: str
    run: Callable[[Problem], Found]
    slow: bool = False


def methods(directory: Path, quick: bool) -> tuple[dict[str, list[Method]], list[str]]:
    """All that can be run here, by the kind of threshold, and a line for each that cannot."""
    every = {kind: [_own(kind, True), _own(kind, False)] for kind in (ONSET, HOPF)}
    on_grids: tuple[tuple[str, str, Callable[[int, Problem], Found]], ...] = (
        (ONSET, "grid, between two forces", sweeps.onset_between),
        (ONSET, "grid, square-root law", sweeps.onset_by_square_root),
        (HOPF, "grid, linear interpolation", sweeps.hopf_interpolated),
    )
    for kind, name, by_grid in on_grids:
        for points in GRIDS if quick else (*GRIDS, LARGE_GRID):
            run = partial(by_grid, points)
            every[kind].append(Method(name, f"{points} forces", SWEEP, run, points == LARGE_GRID))
    searches: tuple[tuple[str, str, Callable[[float, Problem], Found]], ...] = (
        (ONSET, "steps, bisection on Im w > 0", sweeps.onset_by_bisection),
        (ONSET, "steps, Brent on (w1 - w2)^2", sweeps.onset_by_brent),
        (HOPF, "steps, Brent on Re w", sweeps.hopf_by_brent),
    )
    for kind, name, search in searches:
        for tolerance in TOLERANCES:
            run = partial(search, tolerance)
            every[kind].append(Method(name, f"tolerance {tolerance:.0e}", SWEEP, run))
    continuation, skipped = _continuation(directory, quick)
    every[HOPF] += continuation
    return every, skipped


def _own(kind: str, certify: bool) -> Method:
    request = ThresholdsRequest(F_MAX, 1e-10, certify, 64)

    def run(problem: Problem) -> Found:
        result = solve_thresholds(problem.k1, problem.k2, problem.gamma3, request)
        first = {c.kind.name: c.at for c in reversed(result.crossings)}
        return Found(first.get(kind, nan), result.transitions.solves, determinants=result.transitions.boxes)

    return Method("rodsweep, all changes", "with proof" if certify else "without proof", OWN, run)


def _continuation(directory: Path, quick: bool) -> tuple[list[Method], list[str]]:
    found, skipped = [], []
    program = codes.auto_program(directory)
    if program is None:
        skipped.append(f"{AUTO} is skipped: it needs the program (Debian: auto-07p) and gfortran.")
    else:
        for step, tolerance in AUTO_SETTINGS:
            run = partial(codes.hopf_by_auto, program, step, tolerance)
            found.append(Method(AUTO, f"step {step:g}, EPSS {tolerance:.0e}", CONTINUATION, run))
    module = codes.pycont_module()
    if module is None:
        skipped.append(f"{PYCONT} is skipped: it is not installed (extra `bench`).")
    else:
        for step in PYCONT_STEPS[: 1 if quick else None]:
            run = partial(codes.hopf_by_pycont, module, step)
            found.append(Method(PYCONT, f"step {step:g}", CONTINUATION, run, slow=True))
    return found, skipped
