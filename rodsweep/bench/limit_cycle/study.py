"""The limit-cycle benchmark: work and precision of following a settled cycle, and of reaching one."""

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite, log, nan

from ...solve.cycle.limit_cycle import warm_up
from ..study import Measurement, Study, grouped, plural, table
from .integrators import CVODE, DEFAULT, families
from .settling import settling
from .tracking import (
    CYCLE_FORCE,
    CYCLE_ORDER,
    FIG5_ROD,
    FOLLOWED_PERIODS,
    TARGET,
    reference,
    work_precision,
)

ROUNDS, QUICK_ROUNDS = 9, 1
DRAWN_ERRORS = {"error of the period": "period_error", "error of the largest tip y": "amplitude_error"}


def limit_cycle_study(quick: bool) -> Study:
    """Runs the benchmark: work and precision, and the ways to a settled cycle."""
    warm_up()
    rounds, stride = (QUICK_ROUNDS, 2) if quick else (ROUNDS, 1)
    at, every = reference(), families()
    found = work_precision(at, every, rounds, stride)
    blocks = [introduction(rounds), work_table(found), target_table(found)]
    if CVODE not in [family.name for family in every]:
        blocks.append(f"{CVODE} is skipped: scikit-sundae is not installed (extra `cvode`).")
    blocks.append(settling(at, every, rounds))
    drawn = [
        replace(m, case=case, error=m.extra.get(error, m.error))
        for case, error in DRAWN_ERRORS.items()
        for m in found
    ]
    return Study("limit_cycle", "\n\n".join(blocks), drawn, "period", TARGET)


def introduction(rounds: int) -> str:
    """What is measured."""
    k1, k2, gamma3, gamma1 = FIG5_ROD
    return (
        f"The settled cycle of k1 = {k1:g}, k2 = {k2:g}, gamma3 = {gamma3:g}, gamma1 = {gamma1:g}, "
        f"F = {CYCLE_FORCE:g}, followed for {FOLLOWED_PERIODS} periods; one element of order {CYCLE_ORDER}, "
        f"{3 * CYCLE_ORDER} unknowns. All integrators call the same compiled rate and Jacobian; the "
        "tolerance is per component of the state, in units of its largest. Errors of period and largest tip "
        f"y are relative and rms over 5 returns. Times are medians of {plural(rounds, 'interleaved round')}."
    )


def work_table(measurements: Sequence[Measurement]) -> str:
    """All methods at all tolerances."""
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
    """All methods at equal error."""
    at = {}
    for (method,), own in grouped(measurements, "method").items():
        errors = [m.error for m in own]
        median, least = [m.seconds for m in own], [m.least_seconds for m in own]
        at[method] = time_at(TARGET, errors, median), time_at(TARGET, errors, least)
    default, by_least = at[DEFAULT]
    rows = [
        {"method": method, "ms": 1e3 * median, "ratio": median / default, "by_least": least / by_least}
        for method, (median, least) in at.items()
    ]
    return (
        f"At error {TARGET:.0e}, the larger of the two, interpolated; the last column by the least times of "
        "all rounds, which other loads disturb less:\n\n"
    ) + table(
        "method | ms a period | times the default's time | by the least times",
        "{method} | {ms:.2f} | {ratio:.2f} | {by_least:.2f}",
        rows,
    )


def time_at(target: float, errors: Sequence[float], times: Sequence[float]) -> float:
    """Time of one method at an error, interpolated in the logarithms; nan if out of reach.

    Between the last setting above the target and the next: a tolerance that is lucky once does not count.
    """
    above = [k for k, error in enumerate(errors) if not error <= target]
    if not above or above[-1] + 1 == len(errors) or not isfinite(errors[above[-1]]):
        return nan
    k = above[-1]
    share = log(errors[k] / target) / log(errors[k] / errors[k + 1])
    return times[k] * (times[k + 1] / times[k]) ** share
