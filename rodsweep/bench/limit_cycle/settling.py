"""Methods that reach a limit cycle from a given start: integration until the motion is periodic, and
`solve_cycle`."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf, isfinite, log, nan

import numpy as np

from ...solve.motion.leading_mode import leading_mode
from ..study import TimedMethod, TimedRuns, grouped_by_fields, markdown_table, time_runs
from .default_integrator import IntegrationTask
from .tracking import (
    CYCLE_FORCE,
    FOLLOWED_PERIODS,
    PERIODICITY_TOLERANCE,
    START_DEFLECTION,
    ReferenceCycle,
    orbit_of,
    solve_cycle_at_force,
    system_and_state_on_cycle,
    tip_angle_returns,
)

NEAR_HOPF_F = 27.43
"""A force F only 0.003 above the Hopf point, where a motion approaches the cycle very slowly."""
SOLVE_CYCLE_METHOD_NAME = "solve_cycle"
"""Name of rodsweep's `solve_cycle` in the table."""
SETTLING_METHOD_NAME_PREFIX = "waiting, "
"""Prefix, in the table, of the names of integrations until the motion is periodic."""
SETTLING_PERIOD_COUNT = 15
"""Duration, in periods, of an integration that should reach the cycle."""


@dataclass(frozen=True, slots=True)
class SettlingMethod:
    """A method that reaches the limit cycle from a given start.

    force: F. name: name of the method. setting: text of the integrator's tolerance, "" for `solve_cycle`.
    tip_return_count: number of returns of the tip until the motion is periodic; nan if the motion does not
    become periodic. relative_error: the larger of the relative errors of the period and of the largest tip y;
    inf if the cycle is not reached. run: the timed function. full_to_run_time_ratio: duration of the complete
    method divided by the duration of `run`. failed_tolerances: looser tolerances at which the integration
    failed.
    """

    force: float
    name: str
    setting: str
    tip_return_count: float
    relative_error: float
    run: Callable[[], object]
    full_to_run_time_ratio: float = 1.0
    failed_tolerances: tuple[str, ...] = ()

    @property
    def reaches_cycle(self) -> bool:
        """Whether the method reaches the cycle; an integration does if its motion becomes periodic."""
        return isfinite(self.tip_return_count)

    def row(self, timed: TimedRuns) -> dict[str, str | float]:
        """Values of a row of `settling_table`, by name."""
        method_text = self.name + (
            f" (fails at {', '.join(self.failed_tolerances)})" if self.failed_tolerances else ""
        )
        row: dict[str, str | float] = {"force": self.force, "way": method_text, "tolerance": self.setting}
        if not self.reaches_cycle:
            not_reached = f"not reached in {SETTLING_PERIOD_COUNT} periods"
            return row | {"returns": not_reached, "milliseconds": "", "error": nan}
        about_text = "about " if self.full_to_run_time_ratio != 1 else ""
        milliseconds = f"{about_text}{1e3 * self.full_to_run_time_ratio * timed.median_seconds:.0f}"
        returns = f"{about_text}{self.tip_return_count:.0f}"
        return row | {"returns": returns, "milliseconds": milliseconds, "error": self.relative_error}


def compare_settling(reference: ReferenceCycle, contenders: Sequence[TimedMethod], round_count: int) -> str:
    """Runs all methods that reach the cycle, at F = 50 and near the Hopf point, and returns the table of the
    methods with its explanation. reference: reference cycle at F = 50. contenders: contenders of the race
    SETTLING_TO_CYCLE_RACE_NAME. round_count: number of timed rounds."""
    settings = grouped_by_fields(contenders, "method")
    waiting = {method: _integrate_until_periodic(reference, runs) for (method,), runs in settings.items()}
    cycle = solve_cycle_at_force(CYCLE_FORCE)
    error = _cycle_error(reference, cycle.measures.period, cycle.measures.tip_y_max)
    methods = [_solve_cycle_method(CYCLE_FORCE, cycle.periods, error), *waiting.values()]
    methods += _methods_near_hopf([c for c in contenders if waiting[c.method].setting == c.setting])
    return settling_table(methods, time_runs([wait.run for wait in methods], [round_count] * len(methods)))


def _solve_cycle_method(force: float, periods: float, error: float) -> SettlingMethod:
    """The method `solve_cycle` at F = `force`. periods: number of returns of the tip over which `solve_cycle`
    integrated the motion. error: the larger of the relative errors of the period and of the largest tip y."""
    return SettlingMethod(
        force, SOLVE_CYCLE_METHOD_NAME, "", periods, error, partial(solve_cycle_at_force, force)
    )


def settling_table(methods: Sequence[SettlingMethod], times: Sequence[TimedRuns]) -> str:
    """Table in Markdown, after a paragraph that explains it: returns, time and error of each of `methods`.
    times: timed runs of the methods, in the same order."""
    return (
        f"From a start of {START_DEFLECTION:g} L to the limit cycle. Waiting ends when two successive "
        f"returns agree to {PERIODICITY_TOLERANCE:.0e}. The integrator has the loosest tolerance at which "
        "the returns agree and the errors of the period and of y are no larger than this; the user is "
        "assumed to know this tolerance. solve_cycle has the same accuracy; its time includes the choice of "
        f"mesh and the proof of stability. At F = {NEAR_HOPF_F:g} the number of periods is a lower bound, "
        f"ln({PERIODICITY_TOLERANCE:.0e})/ln(largest multiplier), and the time follows from the time per "
        "period; the error is the estimate of solve_cycle and, for waiting, the required accuracy.\n\n"
    ) + markdown_table(
        "F | method | tolerance | returns | ms | error",
        "{force:g} | {way} | {tolerance} | {returns} | {milliseconds} | {error:.0e}",
        [method.row(timed) for method, timed in zip(methods, times, strict=True)],
    )


def _cycle_error(reference: ReferenceCycle, period: float, height: float) -> float:
    return max(abs(period / reference.period - 1), abs(height / reference.tip_y_max - 1))


def _integrate_until_periodic(reference: ReferenceCycle, contenders: Sequence[TimedMethod]) -> SettlingMethod:
    """The integration to a periodic motion with the loosest tolerance for which two successive returns agree
    within PERIODICITY_TOLERANCE, and period and largest tip y have at most this relative error. If no
    tolerance suffices, a method whose `reaches_cycle` is False. contenders: runs of one integrator with
    different tolerances, from the loosest to the tightest."""
    start = leading_mode(reference.system).state(START_DEFLECTION)
    task = IntegrationTask(reference.system, start, SETTLING_PERIOD_COUNT * reference.period)
    name = SETTLING_METHOD_NAME_PREFIX + contenders[0].method
    failed: tuple[str, ...] = ()
    for contender in contenders:
        try:
            returns = tip_angle_returns(reference.system, contender.run(task))
        except ArithmeticError:
            failed += (contender.setting,)
            continue
        sizes = np.linalg.norm(returns.states[1:], axis=1)
        distances = np.linalg.norm(np.diff(returns.states, axis=0), axis=1) / sizes
        periodic_indices = list(map(int, np.flatnonzero(distances <= PERIODICITY_TOLERANCE)))
        for k in periodic_indices[:1]:
            period = float(returns.times[k + 1] - returns.times[k])
            error = _cycle_error(reference, period, float(returns.tip_y_max_between_returns[k]))
            if error <= PERIODICITY_TOLERANCE:
                run = partial(contender.run, task._replace(duration=float(returns.times[k + 1])))
                setting = contender.setting
                return SettlingMethod(CYCLE_FORCE, name, setting, k + 2, error, run, failed_tolerances=failed)
    return SettlingMethod(CYCLE_FORCE, name, "", nan, inf, lambda: None, failed_tolerances=failed)


def _methods_near_hopf(settled_contenders: Sequence[TimedMethod]) -> list[SettlingMethod]:
    """Methods that reach the cycle near the Hopf point: `solve_cycle`, and integrations by the contenders
    `settled_contenders`. The number of periods until an integrated motion is periodic is estimated from the
    largest Floquet multiplier."""
    cycle = solve_cycle_at_force(NEAR_HOPF_F)
    task = IntegrationTask(
        *system_and_state_on_cycle(orbit_of(cycle)), FOLLOWED_PERIODS * cycle.measures.period
    )
    return_count = log(PERIODICITY_TOLERANCE) / log(cycle.multiplier)
    error = max(cycle.errors.period_error, cycle.errors.amplitude_error)
    methods = [_solve_cycle_method(NEAR_HOPF_F, cycle.periods, error)]
    for c in settled_contenders:
        cost = partial(c.run, task), return_count / FOLLOWED_PERIODS
        name = SETTLING_METHOD_NAME_PREFIX + c.method
        methods.append(
            SettlingMethod(NEAR_HOPF_F, name, c.setting, return_count, PERIODICITY_TOLERANCE, *cost)
        )
    return methods
