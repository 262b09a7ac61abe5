"""Continuation of cycles in F, with their Floquet multipliers: rodsweep and AUTO-07p timed at equal error.

AUTO's time per cycle is the difference of the times of a long and a short run, divided by the difference of
their numbers of cycles: the start of the program and the first cycle cancel.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np

from rodsweep.bench.limit_cycle.sweeping import (
    TIMED_POINT_COUNT,
    MeshConvergedCycle,
    solve_timed_points,
    swept_rod,
)
from rodsweep.bench.limit_cycle.swept_rods import RODS, rod_label
from rodsweep.bench.limit_cycle.tracking import (
    PERIODICITY_TOLERANCE,
    REFERENCE_INTERVALS,
    REFERENCE_NEWTON_TOLERANCE,
    REFERENCE_STAGES,
    cycle_request,
    orbit_of,
)
from rodsweep.bench.study import Measurement, TimedRuns, markdown_table, result_or_error, time_runs
from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle.limit_cycle import solve_cycle
from rodsweep.solve.orbit.matrix.linearisation import Linearisation
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.newton import solve_by_newton
from rodsweep.solve.orbit.orbit import Orbit

from ..auto import AUTO
from .auto_cycles import AutoCycle, AutoSetting, continue_cycles

RELATIVE_STEP = 0.01
"""Step of AUTO in F, as a fraction of the last force."""
SHORT_RUN_CYCLES, LONG_RUN_CYCLES = 3, 23
"""Numbers of cycles of AUTO's two runs."""
MAX_ROUNDS = 3
"""Maximum number of timed rounds, because the runs take seconds."""
LARGE_MODULUS = 0.5
"""Modulus above which a Floquet multiplier is counted: multipliers near 1 decide the stability."""
RODSWEEP = "rodsweep"
TARGET_ERRORS = (1e-6, 1e-7)
"""Errors at which the two codes are compared."""
REQUESTED_ACCURACIES = (2e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7)
"""Accuracies requested from rodsweep. Its errors are smaller, because its error estimates are cautious."""
SETTINGS = (
    AutoSetting(13, 19, 3, 3),
    AutoSetting(14, 17, 3, 3),
    AutoSetting(14, 21, 3, 3),
    AutoSetting(14, 12, 4, 0),
    AutoSetting(14, 7, 5, 3),
    AutoSetting(15, 27, 3, 3),
    AutoSetting(15, 29, 3, 3),
    AutoSetting(15, 9, 5, 3),
    AutoSetting(16, 29, 3, 3),
    AutoSetting(16, 9, 5, 3),
    AutoSetting(16, 14, 4, 3),
)
"""Settings of AUTO that are fast for their error.

If NTST and NCOL are odd, the stiff unknowns have spurious multipliers near -1; otherwise the multipliers are
near 1, and Newton's matrix is nearly singular. On such coarse meshes AUTO then fails, except with IAD = 0."""
QUICK_SETTINGS = SETTINGS[1:6:4]
"""Settings of a quick run, one for each target."""


def compare_with_auto(program: Path, quick: bool, rounds: int) -> tuple[list[str], list[Measurement]]:
    """(blocks of text for the report, measurements) of rodsweep and AUTO on the first rod of the study.

    program: AUTO compiled with the rod's equations. quick: QUICK_SETTINGS only. rounds: timed rounds.
    """
    settings = QUICK_SETTINGS if quick else SETTINGS
    found = measure_continuation(program, RODS[0], settings, min(rounds, MAX_ROUNDS))
    return [introduction(RODS[0]), cycle_table(found), ratio_table(found)], found


def measure_continuation(
    program: Path, point: Rod, settings: Sequence[AutoSetting], rounds: int
) -> list[Measurement]:
    """Measurements of rodsweep at all requested accuracies and of AUTO at all settings, timed in turn."""
    rods, step = (
        [swept_rod(point, accuracy) for accuracy in REQUESTED_ACCURACIES],
        RELATIVE_STEP * point.F,
    )
    starts = first_cycles(replace(point, F=point.F - (LONG_RUN_CYCLES - 1) * step), settings)
    runs: list[Callable[[], Any]] = [
        partial(result_or_error, partial(solve_timed_points, "F", accuracy), rod)
        for accuracy, rod in zip(REQUESTED_ACCURACIES, rods, strict=True)
    ]
    for setting in settings:
        run = partial(continue_cycles, program, starts[setting.order], setting, step)
        runs += [partial(result_or_error, run, cycles) for cycles in (SHORT_RUN_CYCLES, LONG_RUN_CYCLES)]
    raced = time_runs(runs, [rounds] * len(runs))
    ours, exact = len(REQUESTED_ACCURACIES), rods[-1].reference_cycle
    own = [
        judged_measurement(
            exact,
            Measurement(
                rod_label(point), RODSWEEP, f"{accuracy:.0e}", timed.median_seconds / TIMED_POINT_COUNT, inf
            ),
            timed.outcome,
        )
        for accuracy, timed in zip(REQUESTED_ACCURACIES, raced[:ours], strict=True)
    ]
    pairs = zip(settings, raced[ours::2], raced[ours + 1 :: 2], strict=True)
    peers = [
        judged_measurement(
            exact,
            Measurement(rod_label(point), AUTO, str(setting), seconds_per_cycle(short, long), inf),
            long.outcome,
        )
        for setting, short, long in pairs
    ]
    return own + peers


def first_cycles(point: Rod, settings: Sequence[AutoSetting]) -> dict[int, Orbit]:
    """First cycle of AUTO's runs, by the order of the single element in space."""
    near = orbit_of(solve_cycle(point, cycle_request(PERIODICITY_TOLERANCE), parameter_name="F"))
    orders = {setting.order for setting in settings}
    moved = {
        order: near.on_mesh(uniform_mesh(1, order), REFERENCE_INTERVALS, REFERENCE_STAGES) for order in orders
    }
    return {
        order: solve_by_newton(orbit, REFERENCE_NEWTON_TOLERANCE, NewtonWorkspace()).orbit
        for order, orbit in moved.items()
    }


def seconds_per_cycle(short: TimedRuns, long: TimedRuns) -> float:
    """AUTO's time per cycle in seconds, from its short and its long run."""
    return (long.median_seconds - short.median_seconds) / (LONG_RUN_CYCLES - SHORT_RUN_CYCLES)


def judged_measurement(exact: MeshConvergedCycle, m: Measurement, outcome: Any) -> Measurement:
    """The measurement `m` completed by the errors of its outcome, or by the reason of its failure.

    outcome: `AutoCycle` of AUTO, `CycleOutcome` of rodsweep, or the exception raised.
    """
    if isinstance(outcome, Exception):
        return replace(m, failure=f"failed ({outcome})", seconds=nan)
    if isinstance(outcome, AutoCycle):
        errors = exact.cycle_at_force(outcome.F).errors_of(outcome.period, outcome.tip_y_max)
        multipliers = outcome.multipliers
    else:
        errors = exact.errors_of(outcome.measures.period, outcome.measures.tip_y_max)
        multipliers = Linearisation(orbit_of(outcome), NewtonWorkspace()).multipliers()
    large = float(np.count_nonzero(np.abs(multipliers) > LARGE_MODULUS))
    return replace(m, error=max(errors.values()), extra_columns=errors | {"large": large})


def introduction(point: Rod) -> str:
    """Description of the comparison for the report."""
    return (
        f"{AUTO} (IPS = 2, ISP = 2, NWTN = 1, the exact Jacobian compiled with -O3) continues the cycles of "
        f"F, k1, k2, gamma3, gamma1 = {rod_label(point)} with all multipliers up to this F, in "
        f"{LONG_RUN_CYCLES - 1} steps of {RELATIVE_STEP:.0%}, on one element of order p, starting from a "
        "cycle of rodsweep. The time per cycle is the difference between this run and a run of "
        f"{SHORT_RUN_CYCLES} cycles, so that the start does not count. Errors are those of the last cycle. "
        f"rodsweep's time is the mean of {TIMED_POINT_COUNT} cycles and includes the choice of the mesh and "
        "the "
        f"error estimate; {AUTO} has neither. Multipliers are counted beyond {LARGE_MODULUS:g} in modulus, "
        "with the trivial one; Gauss collocation adds spurious ones."
    )


def cycle_table(measurements: Sequence[Measurement]) -> str:
    """Table of rodsweep and AUTO at all settings: time per cycle, errors, number of large multipliers."""
    nothing = dict.fromkeys(("period_error", "amplitude_error", "large"), nan)
    return markdown_table(
        "method | setting | ms | error of period | error of amplitude "
        f"| multipliers beyond {LARGE_MODULUS:g}",
        "{method} | {setting} | {failure}{ms:.1f} | {period_error:.1e} | {amplitude_error:.1e} | {large:.0f}",
        [
            {"method": m.method, "setting": m.setting, "failure": m.failure, "ms": 1e3 * m.seconds}
            | nothing
            | m.extra_columns
            for m in measurements
        ],
    )


def ratio_table(measurements: Sequence[Measurement]) -> str:
    """Table of the fastest settings of rodsweep and AUTO that reach each target error, and of their ratio."""
    rows = []
    for target in TARGET_ERRORS:
        own, peer = (fastest_measurement(measurements, method, target) for method in (RODSWEEP, AUTO))
        row = {"target": target, "own": 1e3 * own.seconds, "asked": own.setting}
        row |= {"auto": 1e3 * peer.seconds, "setting": peer.setting, "ratio": peer.seconds / own.seconds}
        rows.append(row)
    return (
        "At equal error: each method at its fastest setting in the table above that reaches the error. For "
        "rodsweep, the setting is the requested accuracy.\n\n"
    ) + markdown_table(
        f"error | ms, rodsweep | at | ms, {AUTO} | at | times rodsweep's time",
        "{target:.0e} | {own:.1f} | {asked} | {auto:.1f} | {setting} | {ratio:.1f}",
        rows,
    )


def fastest_measurement(measurements: Sequence[Measurement], method: str, target: float) -> Measurement:
    """Fastest measurement of a method with an error of at most `target`; its seconds are NaN if none has."""
    enough = [m for m in measurements if m.method == method and m.error <= target]
    return min(enough, key=lambda m: m.seconds, default=Measurement("", method, "", nan, inf))
