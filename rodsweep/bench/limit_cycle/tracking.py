"""Work and precision of following a settled cycle in time.

Every integrator starts on the cycle of one rod. The reference is the cycle on the same mesh in space, and on
a mesh in time with rounding errors only. Period and amplitude are measured alike for all integrators: steps
around a return of the tip and around the largest y are repeated in small steps, so that the measured error is
the error of the integration and not of an interpolant.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PPoly, make_interp_spline

from ...arrays import Array
from ...discretization.beam import Beam
from ...discretization.elements.mesh import mesh
from ...model.rod import Rod
from ...solve.cycle.limit_cycle import Cycle, CycleRequest, solve_cycle
from ...solve.cycle.transient.returns import tip_angle_row
from ...solve.motion.integrator import RunLimit, Trajectory, integrator
from ...solve.motion.time_scheme import TimeScheme
from ...solve.orbit.matrix.workspace import NewtonWorkspace
from ...solve.orbit.newton import newton
from ...solve.orbit.orbit import Orbit
from ..study import Contender, Measurement, contest
from .integrators import IntegrationTask

FIG5_ROD = Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2)
"""The rod of the paper's Fig. 5 without its force."""
CYCLE_FORCE = 50.0
CYCLE_ORDER = 18
"""Order of the single element in space. Its error of period and amplitude is 1e-9 at F = 50."""
REFERENCE_INTERVALS, REFERENCE_STAGES = 32, 6
"""Mesh of the reference in time, over half a period."""
REFERENCE_NEWTON_TOLERANCE = 1e-13
"""Relative tolerance of Newton's method for the reference."""
PERIOD_MAP = TimeScheme("arkimex", "5", tolerance=1e-8, newton=1e-6, equal_steps=True, prefix="bench_map_")
"""Scheme for locating events. The number of equal steps decides the error; Newton's is negligible."""
FOLLOWED_PERIODS = 6.3
"""Length of a run in periods. The first return is left out, because the start is not exactly on the cycle."""
TARGET = 1e-6
"""Error at which the families are compared, the larger of the errors of period and amplitude."""
SETTLED_WITHIN = 1e-7
"""Accuracy requested from solve_cycle; when waiting, relative distance of two successive returns."""
AMPLITUDE = 0.1
"""Tip deflection at the start, in L."""
MOST_RETURNS = 300
"""Maximum number of returns for which solve_cycle may wait."""
SMALL_STEPS = 20
"""Number of small steps around an event."""
DEGREE = 7
"""Degree of the spline through the small steps."""
CORRECTIONS = 2
"""Newton steps from the spline's root to the event, because the spline alone has errors of 1e-8 rad."""
OVERSHOOT = 1.25
"""Length of the repeated step, in units of the original step, which has an error and might miss the event."""


@dataclass(frozen=True, eq=False)
class ReferenceCycle:
    """The reference cycle: a state on it, its period in tau2 and the tip's largest y in L."""

    beam: Beam
    state: Array
    period: float
    tip_y_max: float


def cycle_request(accuracy: float) -> CycleRequest:
    """Request for a cycle at an accuracy, without stored samples or shapes."""
    return CycleRequest(accuracy, AMPLITUDE, 1, 0, 0, 0, MOST_RETURNS)


def cycle_at(force: float) -> Cycle:
    """The rod's cycle as found by the task limit_cycle."""
    return solve_cycle(FIG5_ROD.changed(F=force), cycle_request(SETTLED_WITHIN), along="F")


def orbit_of(cycle: Cycle) -> Orbit:
    """The orbit on the mesh chosen for it; raises ArithmeticError if there is no cycle."""
    if cycle.neighbour is None:
        raise ArithmeticError(f"no cycle: {cycle.status.name} {cycle.message}")
    return cycle.neighbour.predictor.orbit


def on_cycle(orbit: Orbit) -> tuple[Beam, Array]:
    """The beam for the integrators, and its state z on the cycle where y is largest, shape (unknowns,)."""
    form = orbit.form
    beam = Beam(form.rod, form.mesh)
    return beam, (orbit.start.reshape(3, -1) * beam.roots[:, :-1]).ravel()


def reference() -> ReferenceCycle:
    """The cycle on the benchmark's mesh in space, by collocation in time."""
    near = orbit_of(cycle_at(CYCLE_FORCE)).on(mesh(1, CYCLE_ORDER), REFERENCE_INTERVALS, REFERENCE_STAGES)
    orbit = newton(near, REFERENCE_NEWTON_TOLERANCE, NewtonWorkspace()).orbit
    return ReferenceCycle(*on_cycle(orbit), orbit.period, float(abs(orbit.form.tip(orbit.start)[1])))


def work_precision(at: ReferenceCycle, contenders: Iterable[Contender], rounds: int) -> list[Measurement]:
    """Measurements of all contenders along the cycle; seconds are per period."""
    leg = IntegrationTask(at.beam, at.state, FOLLOWED_PERIODS * at.period)
    return [
        replace(m, seconds=m.seconds / FOLLOWED_PERIODS, least_seconds=m.least_seconds / FOLLOWED_PERIODS)
        for m in contest(f"F = {CYCLE_FORCE:g}", leg, list(contenders), rounds, partial(judged_run, at))
    ]


def judged_run(at: ReferenceCycle, run: Trajectory) -> dict[str, Any]:
    """Relative rms errors of the period and of the tip's largest y, over all returns but the first."""
    found = returns_of(at.beam, run)
    period = _rms(np.diff(found.times)[1:] / at.period - 1)
    amplitude = _rms(found.heights[1:] / at.tip_y_max - 1)
    steps = (len(run.times) - 1) / FOLLOWED_PERIODS
    extra = {"steps": steps, "period_error": period, "amplitude_error": amplitude}
    return {"error": max(period, amplitude), "extra": extra}


def _rms(values: NDArray[np.floating]) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else inf


@dataclass(frozen=True, eq=False)
class TipReturns:
    """Returns of a run: times at which theta of the tip rises through 0.

    times in tau2, (k,), states z, (k, unknowns); heights: the tip's largest y in L between two returns, (k -
    1,).
    """

    times: Array
    states: Array
    heights: Array


def returns_of(beam: Beam, run: Trajectory) -> TipReturns:
    """All returns of a run."""
    row = tip_angle_row(beam)
    y = beam.tip(run.states)[1]
    angle = run.states @ row
    rising = list(map(int, np.flatnonzero((angle[:-1] < 0) & (angle[1:] >= 0))))
    times = []
    states = []
    heights = []
    for k in rising:
        again = _again(beam, run.states[k], OVERSHOOT * (run.times[k + 1] - run.times[k]))
        when = float(_spline(again.times, again.states @ row).roots(extrapolate=False)[0])
        for _ in range(CORRECTIONS):
            there = _again(beam, run.states[k], when).states[-1]
            when -= float(row @ there) / float(row @ beam.rate(there))
        times.append(run.times[k] + when)
        states.append(_again(beam, run.states[k], when).states[-1])
    for first, last in pairwise(rising):
        heights.append(height_near(beam, run, first + int(np.argmax(y[first : last + 1]))))
    return TipReturns(np.array(times), np.array(states), np.array(heights))


def height_near(beam: Beam, run: Trajectory, k: int) -> float:
    """Largest y of the tip in L in the two steps around the k-th."""
    again = _again(beam, run.states[k - 1], run.times[k + 1] - run.times[k - 1])
    height = _spline(again.times, beam.tip(again.states)[1])
    return float(height(height.derivative().roots(extrapolate=False)).max())


def _again(beam: Beam, z: Array, duration: float) -> Trajectory:
    """The run repeated from a state z with equal small steps over a duration."""
    limit = RunLimit(max_steps=SMALL_STEPS + 2)
    return integrator(beam.mesh, PERIOD_MAP).run(beam, z, duration, duration / SMALL_STEPS, limit)


def _spline(times: Array, values: Array) -> PPoly:
    return PPoly.from_spline(make_interp_spline(times, values, DEGREE))
