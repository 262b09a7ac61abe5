"""The limit-cycle benchmark: a settled cycle followed in time, waited for, and solved.

The races FOLLOWING and WAITING run on an `IntegrationTask` and give a `Trajectory`. The settings of each
method are tolerances, from the loosest.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import inf, isfinite, log, nan

import numpy as np

from ...model.parameters import NONLINEAR_PARAMETERS
from ...solve.cycle.reference_rod import warm_up
from ...solve.motion.leading_mode import leading_mode
from ..peers import Peers
from ..study import (
    Contender,
    Measurement,
    Study,
    TimedRuns,
    by_method,
    every_nth_setting,
    grouped,
    plural,
    race,
    table,
)
from .integrators import DEFAULT, IntegrationTask
from .sweeping import QUICK_RODS, RODS, sweep_introduction, sweep_points, sweep_table
from .tracking import (
    AMPLITUDE,
    CYCLE_FORCE,
    CYCLE_ORDER,
    FIG5_ROD,
    FOLLOWED_PERIODS,
    SETTLED_WITHIN,
    TARGET,
    ReferenceCycle,
    cycle_at,
    on_cycle,
    orbit_of,
    reference,
    returns_of,
    work_precision,
)

ROUNDS = 9
QUICK_ROUNDS = 1
FOLLOWING = "following"
WAITING = "waiting"
DRAWN_ERRORS = {"error of the period": "period_error", "error of the largest tip y": "amplitude_error"}
NEAR_HOPF_F = 27.43
"""Force 0.003 above the Hopf point, where waiting takes very long."""
SOLVE = "solve_cycle"
WAITS = "waiting, "
PERIODS_OF_WAIT = 15
"""Length, in periods, of a run that waits for a cycle."""


def limit_cycle_study(quick: bool, peers: Peers) -> Study:
    """Runs the benchmark: work and precision, the ways to a settled cycle, and the peers' sections."""
    warm_up()
    rounds, stride = (QUICK_ROUNDS, 2) if quick else (ROUNDS, 1)
    at = reference()
    followers = every_nth_setting([*DEFAULT.followers(), *peers.of(FOLLOWING)], stride)
    found = work_precision(at, followers, rounds)
    blocks = [introduction(rounds), *peers.notes, work_table(found), target_table(found)]
    blocks.append(settling(at, [*DEFAULT.waiters(), *peers.of(WAITING)], rounds))
    undrawn = sweep_points(QUICK_RODS if quick else RODS, rounds)
    blocks += [sweep_introduction(), sweep_table(undrawn)]
    for section in peers.sections:
        text, further = section(rounds)
        blocks += text
        undrawn += further
    drawn = [
        replace(m, case=case, error=m.extra.get(error, m.error))
        for case, error in DRAWN_ERRORS.items()
        for m in found
    ]
    return Study("limit_cycle", "\n\n".join([*blocks, *peers.skipped]), drawn, "period", TARGET, undrawn)


def introduction(rounds: int) -> str:
    """Description of the measurements for the report."""
    k1, k2, gamma3, gamma1 = (FIG5_ROD.values[name] for name in NONLINEAR_PARAMETERS[1:])
    return (
        f"The settled cycle of k1 = {k1:g}, k2 = {k2:g}, gamma3 = {gamma3:g}, gamma1 = {gamma1:g}, "
        f"F = {CYCLE_FORCE:g}, followed for {FOLLOWED_PERIODS} periods; one element of order {CYCLE_ORDER}, "
        f"{3 * CYCLE_ORDER} unknowns. All integrators call the same compiled rate and Jacobian; the "
        "tolerance is per component of the state, in units of the component's largest value. Errors of the "
        "period and of the largest tip y are relative and rms over 5 returns. Times are medians of "
        f"{plural(rounds, 'interleaved round')}."
    )


def work_table(measurements: Sequence[Measurement]) -> str:
    """Table of all methods at all tolerances."""
    nothing = dict.fromkeys(("steps", "period_error", "amplitude_error"), nan)
    return table(
        "method | tolerance | steps a period | ms a period | error of period | error of amplitude",
        "{method} | {setting} | {failure}{steps:.1f} | {ms:.2f} | {period_error:.1e} | {amplitude_error:.1e}",
        [
            {"method": m.method, "setting": m.setting, "failure": m.failure, "ms": 1e3 * m.seconds}
            | nothing
            | m.extra
            for m in measurements
        ],
    )


def target_table(measurements: Sequence[Measurement]) -> str:
    """Table of all methods at equal error."""
    at = {}
    for (method,), own in grouped(measurements, "method").items():
        errors = [m.error for m in own]
        median = [m.seconds for m in own]
        least = [m.least_seconds for m in own]
        at[method] = time_at(TARGET, errors, median), time_at(TARGET, errors, least)
    default, by_least = at[DEFAULT.name]
    rows = [
        {"method": method, "ms": 1e3 * median, "ratio": median / default, "by_least": least / by_least}
        for method, (median, least) in at.items()
    ]
    return (
        f"At an error of {TARGET:.0e}, the larger of the two errors, interpolated. The last column uses the "
        "minimum times over all rounds, which depend less on the load of the machine:\n\n"
    ) + table(
        "method | ms a period | times the default's time | by the least times",
        "{method} | {ms:.2f} | {ratio:.2f} | {by_least:.2f}",
        rows,
    )


def time_at(target: float, errors: Sequence[float], times: Sequence[float]) -> float:
    """Time of a method at a given error, interpolated in logarithms; nan if the error is not reached.

    The interpolation uses the last setting above the target and its successor, so that an accidentally small
    error of a loose tolerance does not count.
    """
    above = [k for k, error in enumerate(errors) if not error <= target]
    if not above or above[-1] + 1 == len(errors) or not isfinite(errors[above[-1]]):
        return nan
    k = above[-1]
    share = log(errors[k] / target) / log(errors[k] / errors[k + 1])
    return times[k] * (times[k + 1] / times[k]) ** share


@dataclass(frozen=True, slots=True)
class SettlingMethod:
    """One way to a settled cycle, with the number of returns waited for and the error of the result.

    setting: the tolerance. run: the timed run, which takes 1/times of the whole time. failed: looser
    tolerances at which the integration failed.
    """

    force: float
    way: str
    setting: str
    returns: float
    error: float
    run: Callable[[], object]
    times: float = 1.0
    failed: tuple[str, ...] = ()

    @property
    def settled(self) -> bool:
        """Whether the cycle was reached."""
        return isfinite(self.returns)

    def row(self, timed: TimedRuns) -> dict[str, str | float]:
        """Row of the table."""
        about = "about " if self.times != 1 else ""
        return {
            "force": self.force,
            "way": self.way + (f" (fails at {', '.join(self.failed)})" if self.failed else ""),
            "tolerance": self.setting,
            "returns": f"{about}{self.returns:.0f}" if self.settled else f"not settled in {PERIODS_OF_WAIT}",
            "milliseconds": f"{about}{1e3 * self.times * timed.median:.0f}" if self.settled else "",
            "error": self.error if self.settled else nan,
        }


def settling(at: ReferenceCycle, every: Sequence[Contender], rounds: int) -> str:
    """Table of all ways to the cycle at F = 50 and near the Hopf point."""
    waiting = {method: _waited(at, settings) for method, settings in by_method(every).items()}
    cycle = cycle_at(CYCLE_FORCE)
    left = _error(at, cycle.measures.period, cycle.measures.tip_y_max)
    waits = [SettlingMethod(CYCLE_FORCE, SOLVE, "", cycle.periods, left, partial(cycle_at, CYCLE_FORCE))]
    waits += waiting.values()
    waits += _near_hopf([c for c in every if waiting[c.method].setting == c.setting])
    return settling_table(waits, race([wait.run for wait in waits], [rounds] * len(waits)))


def settling_table(waits: Sequence[SettlingMethod], raced: Sequence[TimedRuns]) -> str:
    """Table of the times of all ways."""
    return (
        f"From a start of {AMPLITUDE:g} L to the settled cycle. Waiting ends when two successive returns "
        f"agree to {SETTLED_WITHIN:.0e}, at the loosest tolerance that settles with no larger error; the "
        "user is assumed to know this tolerance. solve_cycle has the same accuracy; its time includes the "
        f"choice of mesh and the proof of stability. At F = {NEAR_HOPF_F:g} the number of periods is "
        f"estimated from below as ln({SETTLED_WITHIN:.0e})/ln(largest multiplier), and the time from the "
        "time per period; the errors are solve_cycle's estimate and, for waiting, the target.\n\n"
    ) + table(
        "F | way | tolerance | returns | ms | error left",
        "{force:g} | {way} | {tolerance} | {returns} | {milliseconds} | {error:.0e}",
        [wait.row(timed) for wait, timed in zip(waits, raced, strict=True)],
    )


def _error(at: ReferenceCycle, period: float, height: float) -> float:
    return max(abs(period / at.period - 1), abs(height / at.tip_y_max - 1))


def _waited(at: ReferenceCycle, settings: Sequence[Contender]) -> SettlingMethod:
    """Waiting at the loosest tolerance at which two successive returns agree and are accurate."""
    leg = IntegrationTask(at.beam, AMPLITUDE * leading_mode(at.beam).z.real, PERIODS_OF_WAIT * at.period)
    way = WAITS + settings[0].method
    failed: tuple[str, ...] = ()
    for contender in settings:
        try:
            found = returns_of(at.beam, contender.run(leg))
        except ArithmeticError:
            failed += (contender.setting,)
            continue
        sizes = np.linalg.norm(found.states[1:], axis=1)
        distances = np.linalg.norm(np.diff(found.states, axis=0), axis=1) / sizes
        settled = list(map(int, np.flatnonzero(distances <= SETTLED_WITHIN)))
        for k in settled[:1]:
            left = _error(at, float(found.times[k + 1] - found.times[k]), float(found.heights[k]))
            if left <= SETTLED_WITHIN:
                again = partial(contender.run, leg._replace(duration=float(found.times[k + 1])))
                return SettlingMethod(CYCLE_FORCE, way, contender.setting, k + 2, left, again, failed=failed)
    return SettlingMethod(CYCLE_FORCE, way, "", nan, inf, lambda: None, failed=failed)


def _near_hopf(settled: Sequence[Contender]) -> list[SettlingMethod]:
    """Ways near the Hopf point; the number of periods of waiting is estimated from the largest multiplier."""
    cycle = cycle_at(NEAR_HOPF_F)
    leg = IntegrationTask(*on_cycle(orbit_of(cycle)), FOLLOWED_PERIODS * cycle.measures.period)
    count = log(SETTLED_WITHIN) / log(cycle.multiplier)
    error = max(cycle.errors.period_error, cycle.errors.amplitude_error)
    waits = [SettlingMethod(NEAR_HOPF_F, SOLVE, "", cycle.periods, error, partial(cycle_at, NEAR_HOPF_F))]
    for contender in settled:
        run = partial(contender.run, leg)
        times = count / FOLLOWED_PERIODS
        way = WAITS + contender.method
        waits.append(SettlingMethod(NEAR_HOPF_F, way, contender.setting, count, SETTLED_WITHIN, run, times))
    return waits
