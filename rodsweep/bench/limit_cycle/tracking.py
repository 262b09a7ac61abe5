"""Errors and times of integrators that follow a limit cycle.

Every integrator starts on the cycle of one rod. The reference is the cycle on the same mesh in space and on a
mesh in time whose errors are rounding errors. Period and amplitude are measured in the same way for all
integrators: the steps around a return of the tip and around the largest y are repeated with small steps, so
that the measured error is the error of the integrator, not of an interpolation.
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
from ...discretization.elements.mesh import uniform_mesh
from ...discretization.explicit_system import ExplicitSystem
from ...model.rod import Rod
from ...solve.cycle.limit_cycle import CycleOutcome, CycleRequest, solve_cycle
from ...solve.cycle.transient.poincare_returns import tip_angle_row
from ...solve.motion.integrator import RunLimit, Trajectory, integrator
from ...solve.motion.time_scheme import TimeScheme
from ...solve.orbit.matrix.workspace import NewtonWorkspace
from ...solve.orbit.newton import solve_by_newton
from ...solve.orbit.orbit import Orbit
from ..study import Measurement, TimedMethod, measure_case
from .default_integrator import IntegrationTask

FIG5_ROD = Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2)
"""The rod of the paper's Fig. 5, at F = 0."""
CYCLE_FORCE = 50.0
"""F of the followed cycle."""
CYCLE_ELEMENT_ORDER = 18
"""Order of the single element in space; at F = 50 its relative errors of period and amplitude are 1e-9."""
REFERENCE_INTERVALS, REFERENCE_STAGES = 32, 6
"""Number of time intervals in half a period, and number of stages of an interval, on the mesh of the
reference cycle."""
REFERENCE_NEWTON_TOLERANCE = 1e-13
"""Relative tolerance of Newton's method for the reference cycle."""
SMALL_STEP_SCHEME = TimeScheme(
    "arkimex",
    "5",
    tolerance=1e-8,
    newton_tolerance_ratio=1e-6,
    has_equal_steps=True,
    options_prefix="bench_map_",
)
"""Scheme of the small steps by which returns and extrema are located. The error of its Newton iteration is
negligible."""
FOLLOWED_PERIODS = 6.3
"""Duration of a run, in periods. The first return is left out of the errors, because the start is not exactly
on the cycle."""
TARGET_ERROR = 1e-6
"""Error at which integrators are compared: the larger of the relative errors of period and amplitude."""
PERIODICITY_TOLERANCE = 1e-7
"""Relative accuracy requested from `solve_cycle`. An integrated motion is periodic if the states at two
successive returns of the tip (see `TipAngleReturns`) differ by at most this relative distance."""
START_DEFLECTION = 0.1
"""Tip deflection, in L, of the start from which the methods reach the cycle."""
MAX_TIP_RETURNS = 300
"""Maximum number of returns of the tip over which `solve_cycle` may integrate."""
SMALL_STEP_COUNT = 20
"""Number of small steps around a return or an extremum."""
SPLINE_DEGREE = 7
"""Degree of the interpolating spline through the states after the small steps."""
RETURN_NEWTON_STEP_COUNT = 2
"""Number of Newton steps that correct a return found on the spline. The spline has errors of 1e-8 rad."""
SMALL_STEPS_TIME_OVER_REPEATED_STEP = 1.25
"""Ratio of the total duration of the small steps to the repeated step. With the ratio 1 the return could be
missed."""


@dataclass(frozen=True, eq=False)
class ReferenceCycle:
    """Reference cycle of the benchmark. system: rod on its mesh in space. state: state z on the cycle,
    (unknowns,). period: in tau2. tip_y_max: largest y of the tip, in L."""

    system: ExplicitSystem
    state: Array
    period: float
    tip_y_max: float


def cycle_request(accuracy: float) -> CycleRequest:
    """Request for a cycle to a relative accuracy, without stored samples or shapes."""
    return CycleRequest(accuracy, START_DEFLECTION, 1, 0, 0, 0, MAX_TIP_RETURNS)


def solve_cycle_at_force(force: float) -> CycleOutcome:
    """The cycle of FIG5_ROD at F = `force`, solved as in the task `limit_cycle`."""
    return solve_cycle(
        FIG5_ROD.with_values(F=force), cycle_request(PERIODICITY_TOLERANCE), parameter_name="F"
    )


def orbit_of(cycle: CycleOutcome) -> Orbit:
    """The orbit of the solved cycle `cycle`; raises ArithmeticError if no cycle was found."""
    if cycle.start_for_next_rod is None:
        raise ArithmeticError(f"no cycle: {cycle.status.name} {cycle.message}")
    return cycle.start_for_next_rod.predictor.orbit


def system_and_state_on_cycle(orbit: Orbit) -> tuple[ExplicitSystem, Array]:
    """Returns (system, z): the rod and mesh of an orbit as a system for integrators, and the state of the
    orbit at the largest y of the tip, (unknowns,)."""
    stress_form = orbit.form
    system = ExplicitSystem(stress_form.rod, stress_form.mesh)
    return system, (orbit.start_state.reshape(3, -1) * system.sqrt_compliance[:, :-1]).ravel()


def solve_reference() -> ReferenceCycle:
    """The reference cycle at CYCLE_FORCE, on one element in space, by collocation on a fine mesh in time."""
    solved = orbit_of(solve_cycle_at_force(CYCLE_FORCE))
    start = solved.on_mesh(uniform_mesh(1, CYCLE_ELEMENT_ORDER), REFERENCE_INTERVALS, REFERENCE_STAGES)
    orbit = solve_by_newton(start, REFERENCE_NEWTON_TOLERANCE, NewtonWorkspace()).orbit
    height = float(abs(orbit.form.tip_coordinates(orbit.start_state)[1]))
    return ReferenceCycle(*system_and_state_on_cycle(orbit), orbit.period, height)


def measure_cycle_following(
    reference: ReferenceCycle, contenders: Iterable[TimedMethod], round_count: int
) -> list[Measurement]:
    """Measurements of the `contenders`, which follow the reference cycle `reference` in time; times are
    divided by the number of periods."""
    task = IntegrationTask(reference.system, reference.state, FOLLOWED_PERIODS * reference.period)
    measure_error = partial(trajectory_measurement_fields, reference)
    return [
        replace(m, seconds=m.seconds / FOLLOWED_PERIODS, least_seconds=m.least_seconds / FOLLOWED_PERIODS)
        for m in measure_case(f"F = {CYCLE_FORCE:g}", task, list(contenders), round_count, measure_error)
    ]


def trajectory_measurement_fields(reference: ReferenceCycle, trajectory: Trajectory) -> dict[str, Any]:
    """Fields of `Measurement` for a trajectory: relative rms errors of the period and of the largest tip y,
    without the first return, and steps per period."""
    returns = tip_angle_returns(reference.system, trajectory)
    period = _rms(np.diff(returns.times)[1:] / reference.period - 1)
    amplitude = _rms(returns.tip_y_max_between_returns[1:] / reference.tip_y_max - 1)
    steps_per_period = (len(trajectory.times) - 1) / FOLLOWED_PERIODS
    values = {"steps": steps_per_period, "period_error": period, "amplitude_error": amplitude}
    return {"error": max(period, amplitude), "extra_columns": values}


def _rms(values: NDArray[np.floating]) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else inf


@dataclass(frozen=True, eq=False)
class TipAngleReturns:
    """Returns of the tip in a run, at which the tip angle theta rises through 0.

    times: times of the returns, in tau2, (k,). states: z at the returns, (k, unknowns).
    tip_y_max_between_returns: largest y of the tip, in L, between successive returns, (k - 1,).
    """

    times: Array
    states: Array
    tip_y_max_between_returns: Array


def tip_angle_returns(system: ExplicitSystem, run: Trajectory) -> TipAngleReturns:
    """Returns of the tip in a run, see `TipAngleReturns`: time and state by Newton's method with small steps,
    largest y of the tip from a repetition of the run with small steps."""
    row = tip_angle_row(system)
    y = system.tip_coordinates(run.states)[1]
    angle = run.states @ row
    upward_steps = list(map(int, np.flatnonzero((angle[:-1] < 0) & (angle[1:] >= 0))))
    times = []
    states = []
    tip_y_max_between_returns = []
    for k in upward_steps:
        step = SMALL_STEPS_TIME_OVER_REPEATED_STEP * (run.times[k + 1] - run.times[k])
        fine_run = _integrate_in_small_steps(system, run.states[k], step)
        duration = float(_spline(fine_run.times, fine_run.states @ row).roots(extrapolate=False)[0])
        for _ in range(RETURN_NEWTON_STEP_COUNT):
            state_at_return = _integrate_in_small_steps(system, run.states[k], duration).states[-1]
            duration -= float(row @ state_at_return) / float(row @ system.state_derivative(state_at_return))
        times.append(run.times[k] + duration)
        states.append(_integrate_in_small_steps(system, run.states[k], duration).states[-1])
    for start, end in pairwise(upward_steps):
        tip_y_max_between_returns.append(
            tip_y_max_near_step(system, run, start + int(np.argmax(y[start : end + 1])))
        )
    return TipAngleReturns(np.array(times), np.array(states), np.array(tip_y_max_between_returns))


def tip_y_max_near_step(system: ExplicitSystem, run: Trajectory, k: int) -> float:
    """Largest y of the tip, in L, during two steps of a run: the step that ends at its k-th state, k >= 1,
    and the next step."""
    fine_run = _integrate_in_small_steps(system, run.states[k - 1], run.times[k + 1] - run.times[k - 1])
    height = _spline(fine_run.times, system.tip_coordinates(fine_run.states)[1])
    return float(height(height.derivative().roots(extrapolate=False)).max())


def _integrate_in_small_steps(system: ExplicitSystem, state: Array, duration: float) -> Trajectory:
    """Trajectory from the state z, (unknowns,), over `duration`, in tau2, in SMALL_STEP_COUNT equal steps."""
    limit = RunLimit(max_steps=SMALL_STEP_COUNT + 2)
    return integrator(system.mesh, SMALL_STEP_SCHEME).run(
        system, state, duration, duration / SMALL_STEP_COUNT, limit
    )


def _spline(times: Array, values: Array) -> PPoly:
    return PPoly.from_spline(make_interp_spline(times, values, SPLINE_DEGREE))
