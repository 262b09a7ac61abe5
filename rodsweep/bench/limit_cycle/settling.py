"""The ways to a settled cycle: solving for it, or waiting until it is reached."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf, isfinite, log, nan

import numpy as np

from ...solve.motion.leading_mode import leading_mode
from ..study import Timed, race, table
from .integrators import Family
from .tracking import (
    AMPLITUDE,
    CYCLE_FORCE,
    FOLLOWED_PERIODS,
    SETTLED_WITHIN,
    Reference,
    cycle_at,
    on_cycle,
    returns_of,
)

NEAR_HOPF = 27.43
"""A force 0.003 above the Hopf point."""
SOLVE, WAITING = "solve_cycle", "waiting, "
PERIODS_OF_WAIT = 15
"""Of one who only waits."""


@dataclass(frozen=True, slots=True)
class Wait:
    """One way to a settled cycle: returns waited for, and the error of what it gives.

    run: what takes the time, or a part of it, of which the whole is `times` as much. failed: looser
    tolerances at which the integration itself failed.
    """

    force: float
    way: str
    tolerance: float
    returns: float
    error: float
    run: Callable[[], object]
    times: float = 1.0
    failed: tuple[float, ...] = ()

    def row(self, timed: Timed) -> dict[str, str | float]:
        """A line of the table."""
        failures = ", ".join(f"{tolerance:.0e}" for tolerance in self.failed)
        settled, about = isfinite(self.returns), "about " if self.times != 1 else ""
        return {
            "force": self.force,
            "way": self.way + (f" (fails at {failures})" if failures else ""),
            "tolerance": self.tolerance,
            "returns": f"{about}{self.returns:.0f}" if settled else f"not settled in {PERIODS_OF_WAIT}",
            "milliseconds": f"{about}{1e3 * self.times * timed.median:.0f}" if settled else "",
            "error": self.error if settled else nan,
        }


def settling(at: Reference, every: Sequence[Family], rounds: int) -> str:
    """All ways at F = 50 and next to the Hopf point; a table."""
    waiting = {family: _waited(at, family) for family in every if family.settling}
    cycle = cycle_at(CYCLE_FORCE)
    left = _error(at, cycle.measures.period, cycle.measures.tip_y_max)
    waits = [Wait(CYCLE_FORCE, SOLVE, nan, cycle.periods, left, partial(cycle_at, CYCLE_FORCE))]
    waits += waiting.values()
    waits += _near_hopf({f: wait.tolerance for f, wait in waiting.items() if isfinite(wait.tolerance)})
    return settling_table(waits, race([wait.run for wait in waits], [rounds] * len(waits)))


def settling_table(waits: Sequence[Wait], raced: Sequence[Timed]) -> str:
    """What each way took."""
    return (
        f"To the settled cycle from a start of {AMPLITUDE:g} L, settled where two successive returns agree "
        f"to {SETTLED_WITHIN:.0e}, at the loosest tolerance that settles and leaves no larger error; who "
        "waits is given this tolerance. solve_cycle is asked for the same, and its time includes its choice "
        f"of mesh and its proof of stability. At F = {NEAR_HOPF:g} waiting is estimated, from below: "
        f"ln({SETTLED_WITHIN:.0e})/ln(largest multiplier) periods, at the milliseconds that one takes there; "
        "the errors are then solve_cycle's estimate and the aim.\n\n"
    ) + table(
        "F | way | tolerance | returns | ms | error left",
        "{force:g} | {way} | {tolerance:.0e} | {returns} | {milliseconds} | {error:.0e}",
        [wait.row(timed) for wait, timed in zip(waits, raced, strict=True)],
    )


def _error(at: Reference, period: float, height: float) -> float:
    return max(abs(period / at.period - 1), abs(height / at.tip_y_max - 1))


def _waited(at: Reference, family: Family) -> Wait:
    """Waiting at the loosest tolerance at which two successive returns come to agree and are right."""
    run = partial(family.integrate, at.beam, AMPLITUDE * leading_mode(at.beam).z.real)
    failed: tuple[float, ...] = ()
    for tolerance in family.settling:
        try:
            found = returns_of(at.beam, run(PERIODS_OF_WAIT * at.period, tolerance))
        except ArithmeticError:
            failed += (tolerance,)
            continue
        sizes = np.linalg.norm(found.states[1:], axis=1)
        distances = np.linalg.norm(np.diff(found.states, axis=0), axis=1) / sizes
        settled = np.flatnonzero(distances <= SETTLED_WITHIN).tolist()
        for k in settled[:1]:
            left = _error(at, found.times[k + 1] - found.times[k], found.heights[k])
            if left <= SETTLED_WITHIN:
                again = partial(run, float(found.times[k + 1]), tolerance)
                return Wait(CYCLE_FORCE, WAITING + family.name, tolerance, k + 2, left, again, failed=failed)
    return Wait(CYCLE_FORCE, WAITING + family.name, nan, nan, inf, lambda: None, failed=failed)


def _near_hopf(tolerances: dict[Family, float]) -> list[Wait]:
    """Next to the Hopf point, where waiting is estimated from the largest multiplier."""
    cycle = cycle_at(NEAR_HOPF)
    beam, z = on_cycle(cycle, NEAR_HOPF, cycle.elements, cycle.order)
    count = log(SETTLED_WITHIN) / log(cycle.multiplier)
    error = max(cycle.errors.period_error, cycle.errors.amplitude_error)
    waits = [Wait(NEAR_HOPF, SOLVE, nan, cycle.periods, error, partial(cycle_at, NEAR_HOPF))]
    for family, tolerance in tolerances.items():
        run = partial(family.integrate, beam, z, FOLLOWED_PERIODS * cycle.measures.period, tolerance)
        times = count / FOLLOWED_PERIODS
        waits.append(Wait(NEAR_HOPF, WAITING + family.name, tolerance, count, SETTLED_WITHIN, run, times))
    return waits
