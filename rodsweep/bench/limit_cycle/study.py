"""The limit-cycle benchmark: work and precision of following a settled cycle, and of reaching one.

Every integrator starts on the cycle of the rod (1e4, 1e2, 1e-2), gamma1 = 1, F = 50. The reference is the
cycle on the same mesh by Newton's method on its period map.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib.metadata import version
from math import inf, log, nan

import numpy as np
from numpy.typing import NDArray

from ...discretization.beam import Beam, mesh
from ...model.rod import Rod
from ...solve.cycle.limit_cycle import (
    Cycle,
    CyclePoint,
    CycleRequest,
    solve_cycle,
    state_from_neighbour,
    warm_up,
)
from ...solve.cycle.measures import measures_of
from ...solve.cycle.refinement import TRANSIENT
from ...solve.cycle.shooting import shoot
from ...solve.motion.integrator import integrator
from ...solve.motion.leading_mode import leading_mode
from ..study import Measurement, Study
from .integrators import CVODE, DEFAULT, PYTHON, SCIPY, Family, Steps, families, returns

Array = NDArray[np.float64]

SOFT = (1e4, 1e2, 1e-2, 1.0)
"""k1, k2, gamma3, gamma1 of the paper's Fig. 5."""
F, NEAR_HOPF = 50.0, 27.43
"""The second is 0.003 above the Hopf point."""
ORDER = 18
"""Of the one element; it leaves 1e-9 of period and amplitude at F = 50."""
STEPS = 1024
"""Equal steps of the reference over its period; half as many change it by 2e-12."""
PERIODS = 6.3
"""Length of a run; the first return is left out, for a start is not a settled cycle."""
TARGET = 1e-6
"""Error, the larger of the two, at which the families are compared."""
SETTLED = 1e-7
"""Relative distance of two successive returns of one who waits; accuracy asked of solve_cycle."""
START, MOST_RETURNS, PERIODS_OF_WAIT = 0.1, 300, 15
"""Amplitude of the start in L; returns that solve_cycle may wait for, and periods of one who only waits."""
ROUNDS, QUICK_ROUNDS = 9, 1


@dataclass(frozen=True, eq=False)
class Reference:
    """The cycle: a state on it, its period in tau2 and the tip's largest y in L."""

    beam: Beam
    state: Array
    period: float
    tip_y_max: float


@dataclass(frozen=True, slots=True)
class Row:
    """One method at one tolerance; steps and milliseconds a period, errors relative (rms of the returns).

    milliseconds: median of the rounds; least: of all, which other loads on the machine disturb less.
    """

    method: str
    tolerance: float
    steps: float
    milliseconds: float
    period_error: float
    amplitude_error: float
    least: float = nan

    @property
    def error(self) -> float:
        return max(self.period_error, self.amplitude_error)


@dataclass(frozen=True, slots=True)
class Wait:
    """One way to a settled cycle: returns waited for, milliseconds, and the error of what it gives.

    failed: looser tolerances at which the integration itself failed.
    """

    force: float
    method: str
    tolerance: float
    returns: float
    milliseconds: float
    error: float
    failed: tuple[float, ...] = ()


def limit_cycle_study(quick: bool) -> Study:
    """Runs the benchmark: work and precision, and the ways to a settled cycle."""
    warm_up()
    rounds, stride = (QUICK_ROUNDS, 2) if quick else (ROUNDS, 1)
    at, every = reference(), families()
    rows = work_precision(at, every, rounds, stride)
    waits = waiting(at, every, rounds)
    waits += near_hopf(every, waits, rounds)
    text = "\n\n".join([introduction(rounds), rows_table(rows), summary(rows), waits_table(waits)])
    return Study("limit_cycle", text, tuple(_measured(rows)), "period", TARGET)


def _measured(rows: Sequence[Row]) -> list[Measurement]:
    """The rows as measurements of two errors."""
    cases = (("error of the period", "period_error"), ("error of the largest tip y", "amplitude_error"))
    return [
        Measurement(
            case,
            row.method,
            f"tolerance {row.tolerance:.0e}",
            row.milliseconds / 1e3,
            getattr(row, error),
            row.method.split()[0],
            {"steps": row.steps},
        )
        for case, error in cases
        for row in rows
    ]


def introduction(rounds: int) -> str:
    """What is measured, and with which versions."""
    names = ["SciPy", *(["scikit-sundae"] if any(f.name == CVODE for f in families()) else [])]
    versions = ", ".join(f"{name} {version(name)}" for name in names)
    k1, k2, gamma3, gamma1 = SOFT
    return (
        f"The settled cycle of k1 = {k1:g}, k2 = {k2:g}, gamma3 = {gamma3:g}, gamma1 = {gamma1:g}, "
        f"F = {F:g}, followed for {PERIODS} periods; one element of order {ORDER}, {3 * ORDER} unknowns. "
        f"All integrators call the same compiled rate and Jacobian ({versions}); the tolerance is per "
        "component of the state, in units of its largest. Errors of period and largest tip y are relative "
        f"and rms over 5 returns. Times are of the processor, one thread, median of {rounds} interleaved "
        f"round{'s' * (rounds > 1)}; where the machine is shared, trust the ratios rather than the times."
    )


def rows_table(rows: Sequence[Row]) -> str:
    """The work-precision table."""
    lines = [
        "| method | tolerance | steps a period | ms a period | error of period | error of amplitude |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {r.method} | {r.tolerance:.0e} | {r.steps:.1f} | {r.milliseconds:.2f} | {r.period_error:.1e} "
        f"| {r.amplitude_error:.1e} |"
        if np.isfinite(r.error)
        else f"| {r.method} | {r.tolerance:.0e} | failed | | | |"
        for r in rows
    ]
    return "\n".join(lines)


def waits_table(waits: Sequence[Wait]) -> str:
    """The table of the ways to a settled cycle."""
    lines = [
        f"To the settled cycle from a start of {START:g} L, settled where two successive returns agree to "
        f"{SETTLED:.0e}, at the loosest tolerance that settles and leaves no larger error: who waits is "
        "given this tolerance, and the returns for nothing. solve_cycle is asked for the same accuracy, and "
        f"its time includes its choice of mesh and its proof of stability. At F = {NEAR_HOPF:g} waiting is "
        f"not run but estimated, from below: ln({SETTLED:.0e})/ln(largest multiplier) periods at the "
        "milliseconds that a period takes there; the errors are then solve_cycle's estimate and the aim.",
        "",
        "| F | way | tolerance | returns | ms | error left |",
        "|---|---|---|---|---|---|",
    ]
    for w in waits:
        tolerance = f"{w.tolerance:.0e}" if np.isfinite(w.tolerance) else ""
        failures = ", ".join(f"{failure:.0e}" for failure in w.failed)
        name = f"{w.method} (fails at {failures})" if failures else w.method
        if not np.isfinite(w.returns):
            lines.append(f"| {w.force:g} | waiting, {name} | | not settled in {PERIODS_OF_WAIT} | | |")
            continue
        about = "" if w.force == F or not tolerance else "about "
        way = f"waiting, {name}" if tolerance else name
        lines.append(
            f"| {w.force:g} | {way} | {tolerance} | {about}{w.returns:.0f} | {about}{w.milliseconds:.0f} "
            f"| {w.error:.0e} |"
        )
    return "\n".join(lines)


def reference() -> Reference:
    """The cycle on the benchmark's mesh, by Newton's method on its period map."""
    cycle = _cycle(F)
    beam = Beam(Rod(F, *SOFT[:3]), SOFT[3], mesh(1, ORDER))
    run = integrator(beam.mesh, TRANSIENT).run(
        beam, state_from_neighbour(beam, _state(cycle)), cycle.measures.period, cycle.measures.period / 1000
    )
    orbit = shoot(beam, run.states[-1], cycle.measures.period, STEPS)
    if orbit is None:
        raise ArithmeticError(f"no cycle on one element of order {ORDER}")
    return Reference(beam, orbit.state, orbit.period, measures_of(beam, orbit.run).tip_y_max)


def _cycle(force: float) -> Cycle:
    return solve_cycle(CyclePoint(force, *SOFT), CycleRequest(SETTLED, START, 1, 0, 0, 0, MOST_RETURNS))


def _state(cycle: Cycle) -> Array:
    if cycle.state is None:
        raise ArithmeticError(f"no cycle: {cycle.message}")
    return cycle.state


def work_precision(at: Reference, every: Sequence[Family], rounds: int, stride: int) -> list[Row]:
    """All methods at each stride-th tolerance in turn, round after round; the first one gives the errors."""
    cases = [(family, tolerance) for family in every for tolerance in family.tolerances[::stride]]
    times: list[list[float]] = [[] for _ in cases]
    found: list[tuple[float, float, float]] = []
    for turn in range(rounds + 1):
        for (family, tolerance), spent in zip(cases, times, strict=True):
            began = time.process_time()
            steps = _attempt(family, at, tolerance)
            if turn:
                spent.append(time.process_time() - began)
            elif steps is None:
                found.append((nan, inf, inf))
            else:
                found.append(((len(steps.times) - 1) / PERIODS, *errors(at, steps)))
    unit = 1e3 / PERIODS
    return [
        Row(family.name, tolerance, steps, unit * float(np.median(spent)), period, height, unit * min(spent))
        for (family, tolerance), spent, (steps, period, height) in zip(cases, times, found, strict=True)
    ]


def _attempt(family: Family, at: Reference, tolerance: float) -> Steps | None:
    """The run along the cycle, None where it fails."""
    try:
        return family.integrate(at.beam, at.state, PERIODS * at.period, tolerance)
    except ArithmeticError:
        return None


def errors(at: Reference, steps: Steps) -> tuple[float, float]:
    """Relative rms errors of the period and of the tip's largest y, over all returns but the first."""
    found = returns(at.beam, steps)
    return _rms(np.diff(found.times)[1:] / at.period - 1), _rms(found.heights[1:] / at.tip_y_max - 1)


def _rms(values: NDArray[np.floating]) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else inf


def milliseconds_at(rows: Sequence[Row], target: float, least: bool = False) -> float:
    """Milliseconds a period of one method at an error, interpolated in the logarithms; NaN if out of reach.

    Between the last row above the target and the next: a tolerance that is lucky once does not count.
    """
    above = [k for k, row in enumerate(rows) if not row.error <= target]
    if not above or above[-1] + 1 == len(rows) or not np.isfinite(rows[above[-1]].error):
        return nan
    a, b = rows[above[-1]], rows[above[-1] + 1]
    times = (a.least, b.least) if least else (a.milliseconds, b.milliseconds)
    share = log(a.error / target) / log(a.error / b.error)
    return times[0] * (times[1] / times[0]) ** share


def summary(rows: Sequence[Row]) -> str:
    """Milliseconds of each method at the target, and those of others in units of the default's."""
    names = list(dict.fromkeys(row.method for row in rows))
    own = {name: [row for row in rows if row.method == name] for name in names}
    at = {name: milliseconds_at(own[name], TARGET) for name in names}
    least = {name: milliseconds_at(own[name], TARGET, least=True) for name in names}
    each = ", ".join(f"{name} {ms:.2f}" for name, ms in at.items())
    lines = [f"At error {TARGET:.0e} (the larger of the two, interpolated), ms a period: {each}.", ""]
    groups = {
        "SciPy's best": [name for name in names if name.startswith(SCIPY)],
        "the better of SciPy's BDF and Radau": [name for name in names if name in PYTHON],
        CVODE: [name for name in names if name == CVODE],
    }
    for title, members in groups.items():
        if not members:
            lines.append(f"- {title} is skipped: scikit-sundae is not installed (extra `cvode`).")
            continue
        best = min(members, key=lambda name: at[name] if np.isfinite(at[name]) else inf)
        which = "" if best == title else f" ({best})"
        ratio, by_least = at[best] / at[DEFAULT], least[best] / least[DEFAULT]
        lines.append(
            f"- {title}{which}: {ratio:.2f} times the default's time ({by_least:.2f} by the least times)."
        )
    return "\n".join(lines)


def waiting(at: Reference, every: Sequence[Family], rounds: int) -> list[Wait]:
    """From the start to the settled cycle at F = 50: solving for it, and waiting with some of the families.

    Who waits pays nothing here for finding the returns, nor for finding the tolerance that settles.
    """
    cycle = _cycle(F)
    left = _error(at, cycle.measures.period, cycle.measures.tip_y_max)
    runs: list[Callable[[], object]] = [partial(_cycle, F)]
    waits = [Wait(F, "solve_cycle", nan, cycle.periods, nan, left)]
    for family in every:
        if family.settling:
            run, wait = _wait(at, family)
            runs.append(run)
            waits.append(wait)
    return [
        replace(wait, milliseconds=ms) for wait, ms in zip(waits, _milliseconds(runs, rounds), strict=True)
    ]


def _error(at: Reference, period: float, height: float) -> float:
    return max(abs(period / at.period - 1), abs(height / at.tip_y_max - 1))


def _wait(at: Reference, family: Family) -> tuple[Callable[[], object], Wait]:
    """Waiting at the loosest tolerance at which two successive returns come to agree and are right."""
    run = partial(family.integrate, at.beam, START * leading_mode(at.beam).z.real)
    failed: tuple[float, ...] = ()
    for tolerance in family.settling:
        try:
            found = returns(at.beam, run(PERIODS_OF_WAIT * at.period, tolerance))
        except ArithmeticError:
            failed += (tolerance,)
            continue
        sizes = np.linalg.norm(found.states[1:], axis=1)
        distances = np.linalg.norm(np.diff(found.states, axis=0), axis=1) / sizes
        settled = np.nonzero(distances <= SETTLED)[0]
        if not len(settled):
            continue
        k = int(settled[0])
        left = _error(at, found.times[k + 1] - found.times[k], found.heights[k])
        if left <= SETTLED:
            again = partial(run, float(found.times[k + 1]), tolerance)
            return again, Wait(F, family.name, tolerance, k + 2, nan, left, failed)
    return lambda: None, Wait(F, family.name, nan, nan, nan, inf, failed)


def _milliseconds(runs: Sequence[Callable[[], object]], rounds: int) -> list[float]:
    """Medians over the rounds, all in turn."""
    times: list[list[float]] = [[] for _ in runs]
    for _ in range(rounds):
        for run, spent in zip(runs, times, strict=True):
            began = time.process_time()
            run()
            spent.append(1e3 * (time.process_time() - began))
    return [float(np.median(spent)) for spent in times]


def near_hopf(every: Sequence[Family], waits: Sequence[Wait], rounds: int) -> list[Wait]:
    """The same next to the Hopf point, where waiting is estimated from the largest multiplier."""
    cycle = _cycle(NEAR_HOPF)
    beam = Beam(Rod(NEAR_HOPF, *SOFT[:3]), SOFT[3], mesh(cycle.elements, cycle.order))
    z, count = state_from_neighbour(beam, _state(cycle)), log(SETTLED) / log(cycle.multiplier)
    settled = {wait.method: wait.tolerance for wait in waits if np.isfinite(wait.tolerance)}
    waiters = [family for family in every if family.name in settled]
    runs: list[Callable[[], object]] = [partial(_cycle, NEAR_HOPF)]
    for family in waiters:
        runs.append(partial(family.integrate, beam, z, PERIODS * cycle.measures.period, settled[family.name]))
    own, *others = _milliseconds(runs, rounds)
    estimate = max(cycle.errors.period_error, cycle.errors.amplitude_error)
    return [Wait(NEAR_HOPF, "solve_cycle", nan, cycle.periods, own, estimate)] + [
        Wait(NEAR_HOPF, family.name, settled[family.name], count, ms / PERIODS * count, SETTLED)
        for family, ms in zip(waiters, others, strict=True)
    ]
