"""A cycle with its multipliers from its neighbour in F: this tool beside AUTO-07p, at equal error.

AUTO's time of a cycle is the difference of two runs of different length by their difference in cycles: the
start of its program, and the first cycle, cancel.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np

from rodsweep.bench.limit_cycle.sweeping import RODS, TIMED_POINTS, ExactCycle, from_neighbour, name_of, swept
from rodsweep.bench.limit_cycle.tracking import (
    REFERENCE_INTERVALS,
    REFERENCE_NEWTON_TOLERANCE,
    REFERENCE_STAGES,
    SETTLED_WITHIN,
    cycle_request,
    orbit_of,
)
from rodsweep.bench.study import Measurement, TimedRuns, failsafe, race, table
from rodsweep.discretization.elements.mesh import mesh
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle.limit_cycle import solve_cycle
from rodsweep.solve.orbit.matrix.linearisation import Linearisation
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.newton import newton
from rodsweep.solve.orbit.orbit import Orbit

from ..auto import AUTO
from .auto_cycles import AutoSetting, Branch, continued

STEP, FEW, MANY = 0.01, 3, 23
"""AUTO's step in units of the force at which it ends, and cycles of its two runs."""
MOST_ROUNDS = 3
"""Of runs that take seconds."""
LARGE = 0.5
"""Modulus of a multiplier from which it is counted: next to 1 one is looked at."""
OWN = "rodsweep"
TARGETS = (1e-6, 1e-7)
ASKED = (2e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7)
"""Accuracies that rodsweep is asked for: what it reaches is better, for its estimates are careful."""
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
"""Those worth running. Where NTST and NCOL are odd, what is stiff has multipliers near -1, else near 1, where
Newton's matrix is nearly singular: on meshes as coarse as these AUTO then fails, but for IAD = 0."""
QUICK_SETTINGS = SETTINGS[1:6:4]
"""One for each target."""


def beside_auto(program: Path, quick: bool, rounds: int) -> tuple[list[str], list[Measurement]]:
    """Blocks of text, and the measurements, by the program that was compiled with the equations."""
    settings = QUICK_SETTINGS if quick else SETTINGS
    found = compared(program, RODS[0], settings, min(rounds, MOST_ROUNDS))
    return [introduction(RODS[0]), cycle_table(found), ratio_table(found)], found


def compared(program: Path, point: Rod, settings: Sequence[AutoSetting], rounds: int) -> list[Measurement]:
    """This tool at all targets and AUTO at all settings, timed in turn."""
    rods, step = [swept(point, accuracy) for accuracy in ASKED], STEP * point.F
    starts = first_cycles(replace(point, F=point.F - (MANY - 1) * step), settings)
    runs: list[Callable[[], Any]] = [
        partial(failsafe, partial(from_neighbour, "F", accuracy), rod)
        for accuracy, rod in zip(ASKED, rods, strict=True)
    ]
    for setting in settings:
        run = partial(continued, program, starts[setting.order], setting, step)
        runs += [partial(failsafe, run, cycles) for cycles in (FEW, MANY)]
    raced = race(runs, [rounds] * len(runs))
    ours, exact = len(ASKED), rods[-1].exact
    own = [
        judged(
            exact,
            Measurement(name_of(point), OWN, f"{accuracy:.0e}", timed.median / TIMED_POINTS, inf),
            timed.outcome,
        )
        for accuracy, timed in zip(ASKED, raced[:ours], strict=True)
    ]
    pairs = zip(settings, raced[ours::2], raced[ours + 1 :: 2], strict=True)
    peers = [
        judged(exact, Measurement(name_of(point), AUTO, str(setting), each(few, many), inf), many.outcome)
        for setting, few, many in pairs
    ]
    return own + peers


def first_cycles(point: Rod, settings: Sequence[AutoSetting]) -> dict[int, Orbit]:
    """AUTO's first cycle on one element of each order."""
    near = orbit_of(solve_cycle(point, cycle_request(SETTLED_WITHIN), along="F"))
    orders = {setting.order for setting in settings}
    moved = {order: near.on(mesh(1, order), REFERENCE_INTERVALS, REFERENCE_STAGES) for order in orders}
    return {
        order: newton(orbit, REFERENCE_NEWTON_TOLERANCE, NewtonWorkspace()).orbit
        for order, orbit in moved.items()
    }


def each(few: TimedRuns, many: TimedRuns) -> float:
    """Seconds of one cycle."""
    return (many.median - few.median) / (MANY - FEW)


def judged(exact: ExactCycle, m: Measurement, outcome: Any) -> Measurement:
    """The measurement with its errors, or with the failure."""
    if isinstance(outcome, Exception):
        return replace(m, failure=f"failed ({outcome})", seconds=nan)
    if isinstance(outcome, Branch):
        errors = exact.at(outcome.F).errors_of(outcome.period, outcome.tip_y_max)
        multipliers = outcome.multipliers
    else:
        errors = exact.errors_of(outcome.measures.period, outcome.measures.tip_y_max)
        multipliers = Linearisation(orbit_of(outcome), NewtonWorkspace()).multipliers()
    large = float(np.count_nonzero(np.abs(multipliers) > LARGE))
    return replace(m, error=max(errors.values()), extra=errors | {"large": large})


def introduction(point: Rod) -> str:
    """What is compared."""
    return (
        f"{AUTO} (IPS = 2, ISP = 2, NWTN = 1, the exact Jacobian compiled with -O3) continues the cycles of "
        f"F, k1, k2, gamma3, gamma1 = {name_of(point)} with all multipliers up to this F, in {MANY - 1} "
        f"steps of {STEP:.0%}, on one element of order p, starting from a cycle of rodsweep. The time per "
        f"cycle is the difference between this run and a run of {FEW} cycles, so that the start does not "
        f"count. Errors are those of the last cycle. rodsweep's time is the mean of {TIMED_POINTS} cycles "
        f"and includes the choice of the mesh and the error estimate; {AUTO} has neither. Multipliers are "
        f"counted beyond {LARGE:g} in modulus, with the trivial one; Gauss collocation adds spurious ones."
    )


def cycle_table(measurements: Sequence[Measurement]) -> str:
    """All methods at all settings."""
    nothing = dict.fromkeys(("period_error", "amplitude_error", "large"), nan)
    return table(
        f"method | setting | ms | error of period | error of amplitude | multipliers beyond {LARGE:g}",
        "{method} | {setting} | {failure}{ms:.1f} | {period_error:.1e} | {amplitude_error:.1e} | {large:.0f}",
        [
            {"method": m.method, "setting": m.setting, "failure": m.failure, "ms": 1e3 * m.seconds}
            | nothing
            | m.extra
            for m in measurements
        ],
    )


def ratio_table(measurements: Sequence[Measurement]) -> str:
    """At each target: the fastest setting of either that reaches it."""
    rows = []
    for target in TARGETS:
        own, peer = (fastest(measurements, method, target) for method in (OWN, AUTO))
        row = {"target": target, "own": 1e3 * own.seconds, "asked": own.setting}
        row |= {"auto": 1e3 * peer.seconds, "setting": peer.setting, "ratio": peer.seconds / own.seconds}
        rows.append(row)
    return (
        "At equal error: each method at its fastest setting in the table above that reaches the error. For "
        "rodsweep, the setting is the requested accuracy.\n\n"
    ) + table(
        f"error | ms, rodsweep | at | ms, {AUTO} | at | times rodsweep's time",
        "{target:.0e} | {own:.1f} | {asked} | {auto:.1f} | {setting} | {ratio:.1f}",
        rows,
    )


def fastest(measurements: Sequence[Measurement], method: str, target: float) -> Measurement:
    """A method's fastest measurement whose error is at most a target's; NaN where there is none."""
    enough = [m for m in measurements if m.method == method and m.error <= target]
    return min(enough, key=lambda m: m.seconds, default=Measurement("", method, "", nan, inf))
