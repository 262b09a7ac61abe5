"""The limit-cycle benchmark: a cycle followed in time, reached by integration, and solved by collocation. The
contenders of CYCLE_FOLLOWING_RACE_NAME and SETTLING_TO_CYCLE_RACE_NAME integrate an `IntegrationTask` and
return a `Trajectory`. The settings of each method are tolerances, from the loosest."""

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite, log, nan

from ...model.parameters import NONLINEAR_ROD_PARAMETER_NAMES
from ...solve.cycle.rod_with_known_cycle import warm_up
from ...wording import counted
from ..peers import PeerContribution
from ..study import BenchmarkReport, Measurement, every_nth_setting, grouped_by_fields, markdown_table
from .default_integrator import DEFAULT_INTEGRATOR
from .settling import compare_settling
from .sweeping import measure_sweep_points, sweep_introduction, sweep_table
from .swept_rods import QUICK_RODS, RODS
from .tracking import (
    CYCLE_ELEMENT_ORDER,
    CYCLE_FORCE,
    FIG5_ROD,
    FOLLOWED_PERIODS,
    TARGET_ERROR,
    measure_cycle_following,
    solve_reference,
)

ROUND_COUNT = 9
"""Number of timed rounds."""
QUICK_ROUND_COUNT = 1
"""Number of timed rounds of a quick run."""
CYCLE_FOLLOWING_RACE_NAME = "following"
"""Name of the race in which integrators follow a cycle for some periods."""
SETTLING_TO_CYCLE_RACE_NAME = "waiting"
"""Name of the race in which integrators run until the motion is periodic."""
ERROR_NAMES_BY_PANEL = {
    "error of the period": "period_error",
    "error of the largest tip y": "amplitude_error",
}
"""Names of the errors in the figure, by the title of the panel."""


def run_limit_cycle_study(quick: bool, peers: PeerContribution) -> BenchmarkReport:
    """Runs the benchmark and returns the results: errors and times of integrators, methods that reach a
    cycle, cost of a point of a sweep, and sections of the peers. quick: whether to use fewer rounds,
    tolerances and rods."""
    warm_up()
    round_count, stride = (QUICK_ROUND_COUNT, 2) if quick else (ROUND_COUNT, 1)
    reference = solve_reference()
    following = [
        *DEFAULT_INTEGRATOR.following_contenders(),
        *peers.contenders_of_race(CYCLE_FOLLOWING_RACE_NAME),
    ]
    measurements = measure_cycle_following(reference, every_nth_setting(following, stride), round_count)
    blocks = [
        introduction(round_count),
        *peers.contender_notes,
        cycle_following_table(measurements),
        time_at_error_table(measurements),
    ]
    settling = [
        *DEFAULT_INTEGRATOR.settling_contenders(),
        *peers.contenders_of_race(SETTLING_TO_CYCLE_RACE_NAME),
    ]
    blocks.append(compare_settling(reference, settling, round_count))
    sweep_measurements = measure_sweep_points(QUICK_RODS if quick else RODS, round_count)
    blocks += [sweep_introduction(), sweep_table(sweep_measurements)]
    for section in peers.section_functions:
        text, more_text = section(round_count)
        blocks += text
        sweep_measurements += more_text
    panels = [
        replace(m, case=case, error=m.extra_columns.get(error, m.error))
        for case, error in ERROR_NAMES_BY_PANEL.items()
        for m in measurements
    ]
    report = "\n\n".join([*blocks, *peers.skipped_peer_sentences])
    return BenchmarkReport("limit_cycle", report, panels, "period", TARGET_ERROR, sweep_measurements)


def introduction(round_count: int) -> str:
    """Description of the race CYCLE_FOLLOWING_RACE_NAME for the report."""
    k1, k2, gamma3, gamma1 = (FIG5_ROD.values[name] for name in NONLINEAR_ROD_PARAMETER_NAMES[1:])
    return (
        f"The limit cycle of k1 = {k1:g}, k2 = {k2:g}, gamma3 = {gamma3:g}, gamma1 = {gamma1:g}, "
        f"F = {CYCLE_FORCE:g}, followed for {FOLLOWED_PERIODS} periods; one element of order "
        f"{CYCLE_ELEMENT_ORDER}, {3 * CYCLE_ELEMENT_ORDER} unknowns. All integrators call the same compiled "
        "functions for the rate and its Jacobian; the tolerance is the allowed error of each component of "
        "the state, divided by the largest value of this component. Errors of the period and of the "
        "largest tip y are relative and rms over 5 "
        f"returns. Times are medians of {counted(round_count, 'interleaved round')}."
    )


def cycle_following_table(measurements: Sequence[Measurement]) -> str:
    """Table of the race CYCLE_FOLLOWING_RACE_NAME: steps, time and errors of every method at every
    tolerance."""
    no_values = dict.fromkeys(("steps", "period_error", "amplitude_error"), nan)
    return markdown_table(
        "method | tolerance | steps a period | ms a period | error of period | error of amplitude",
        "{method} | {setting} | {failure}{steps:.1f} | {ms:.2f} | {period_error:.1e} | {amplitude_error:.1e}",
        [
            {"method": m.method, "setting": m.setting, "failure": m.failure, "ms": 1e3 * m.seconds}
            | no_values
            | m.extra_columns
            for m in measurements
        ],
    )


def time_at_error_table(measurements: Sequence[Measurement]) -> str:
    """Table of the race CYCLE_FOLLOWING_RACE_NAME at equal error, after a sentence that explains it: time of
    every method, interpolated at the error TARGET_ERROR."""
    times = {}
    for (method,), runs in grouped_by_fields(measurements, "method").items():
        errors = [m.error for m in runs]
        medians, least = ([getattr(m, name) for m in runs] for name in ("seconds", "least_seconds"))
        times[method] = tuple(time_at_error(TARGET_ERROR, errors, seconds) for seconds in (medians, least))
    default, default_least = times[DEFAULT_INTEGRATOR.name]
    rows = [
        {"method": method, "ms": 1e3 * median, "ratio": median / default, "by_least": least / default_least}
        for method, (median, least) in times.items()
    ]
    return (
        f"Time at which the larger of the two errors is {TARGET_ERROR:.0e}, interpolated. The last column "
        "uses the minimum times over all rounds, which depend less on the load of the machine:\n\n"
    ) + markdown_table(
        "method | ms a period | times the default's time | by minimum times",
        "{method} | {ms:.2f} | {ratio:.2f} | {by_least:.2f}",
        rows,
    )


def time_at_error(target: float, errors: Sequence[float], times: Sequence[float]) -> float:
    """Time of a method at the error `target`, interpolated in logarithms; nan if the method does not reach
    this error, or has no larger error at any setting.

    errors, times: error and time of each setting, from the loosest setting on. The time is interpolated
    between the last setting with an error above the target and the next setting, so that an accidentally
    small error at a loose tolerance has no effect.
    """
    inaccurate = [k for k, error in enumerate(errors) if not error <= target]
    if not inaccurate or inaccurate[-1] + 1 == len(errors) or not isfinite(errors[inaccurate[-1]]):
        return nan
    k = inaccurate[-1]
    fraction = log(errors[k] / target) / log(errors[k] / errors[k + 1])
    return times[k] * (times[k + 1] / times[k]) ** fraction
