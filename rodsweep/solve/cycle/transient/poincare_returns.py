"""Returns of a motion to the Poincare section, where the tip's theta rises through 0; most motions return
once per period.

A motion is integrated from return to return. A cycle is near if the states at two returns agree.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite, isnan
from operator import mul
from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....discretization.explicit_system import ExplicitSystem
from ....wording import counted
from ...motion.integrator import EndReason, RunLimit, Trajectory
from .transient_settings import TRANSIENT_SETTINGS


@dataclass(frozen=True, slots=True, kw_only=True)
class ReturnSettings:
    """Settings for the returns of the tip to the section theta = 0, by which a motion is classified."""

    max_state_norm_of_straight_rod: float = 1e-6
    """A motion with |z| < max_state_norm_of_straight_rod has decayed to the straight state, if this state is
    stable; z: state. If the norm of the bending and shear components of z is smaller than this number, the
    rod no longer oscillates. Numerical damping governs smaller motions."""
    max_equal_return_distance: float = 0.03
    """Two returns are equal if their relative distance is at most this number, or at most twice the smallest
    distance of the last return from an earlier return."""
    max_returns_per_period: int = 8
    """A cycle is recognised if the tip returns at most this number of times per period."""
    max_steps_per_run: int = 20_000
    """Maximum number of time steps in one run."""
    convexity_tested_state_count: int = 200
    """If a run fails, this number of its last states is searched for a cross-section whose strain energy is
    not convex. The equations are ill-posed for such a cross-section, and the integrator may fail only some
    steps later."""
    return_time_bisection_count: int = 50
    """Number of bisections of a time step that locate a return in time; enough for all digits."""


RETURN_SETTINGS = ReturnSettings()


def tip_angle_row(system: ExplicitSystem) -> Array:
    """Row vector c, (unknowns,), whose product with a state z of the system is theta of the tip."""
    return system.layout.state_with_stresses(
        {"m3": (system.sqrt_compliance[2] * system.mesh.quadrature_weights)[:-1]}
    )


def run_limit_by_returns(angle_row: Array, z: Array, return_count: int) -> RunLimit:
    """Limit that ends a run from the state z, (unknowns,), after `return_count` returns of the tip or after
    RETURN_SETTINGS.max_steps_per_run time steps. angle_row: `tip_angle_row` of the system, (unknowns,)."""
    count = 0
    last_angle = float(angle_row @ z)

    def enough(state: Array) -> bool:
        nonlocal count, last_angle
        angle = float(angle_row @ state)
        count += int(last_angle < 0 <= angle)
        last_angle = angle
        return count >= return_count

    return RunLimit(enough, RETURN_SETTINGS.max_steps_per_run)


class RunFailure(NamedTuple):
    """Failure of a run before its limit. left_the_model: whether the model is no longer valid for the rod."""

    left_the_model: bool
    message: str
    """Reason for the failure, for the user."""


def run_failure(system: ExplicitSystem, run: Trajectory, return_count: int) -> RunFailure | None:
    """The failure of a run, with a message; None if the run is complete. return_count: number of returns of
    the tip before the run."""
    if run.end_reason in (EndReason.reached, EndReason.stopped):
        return None
    if run.end_reason == EndReason.left_the_model:
        h1 = system.least_stretch(run.states[-1])
        place = f"at a point of the rod after {counted(return_count, 'return')} of the tip"
        return RunFailure(True, f"the axial stretch h1 is {h1:.3g} {place}")
    if not run.message and _loses_convexity(
        system, run.states[-RETURN_SETTINGS.convexity_tested_state_count :]
    ):
        reason = (
            f"after {counted(return_count, 'return')} of the tip a cross-section has lost its stiffness: its "
            "strain energy is not convex, so the model ends there"
        )
        return RunFailure(True, reason)
    reason = "the integrator finds no time step with an acceptable error"
    if run.end_reason == EndReason.too_many_steps:
        reason = "the integrator reached the maximum number of time steps of one run"
    return RunFailure(False, run.message or reason)


def _loses_convexity(system: ExplicitSystem, states: Array) -> bool:
    """Whether the strain energy of a cross-section is not convex in one of the `states`, (k, unknowns)."""
    # The last states come first, because convexity is lost at the end of a run.
    return any(np.isfinite(state).all() and not system.has_convex_energy(state) for state in states[::-1])


def poincare_section_crossings(system: ExplicitSystem, run: Trajectory) -> tuple[Array, Array]:
    """Returns (times, states), (k,) and (k, unknowns), at which the tip's theta rises through 0 on a run;
    times in tau2 from the start of the run.

    Between two time steps a run is interpolated by the cubic Hermite polynomial.
    """
    angle_row = tip_angle_row(system)
    angle = run.states @ angle_row
    times: list[float] = []
    states: list[Array] = []
    # Half-open, so that an angle of exactly 0 at a time step counts once.
    for k in np.nonzero((angle[:-1] < 0) & (angle[1:] >= 0))[0]:
        h = run.times[k + 1] - run.times[k]
        end_states = run.states[k : k + 2]
        cubic = np.concatenate((end_states, h * system.state_derivative(end_states)))
        angles = (cubic @ angle_row).tolist()
        low = 0.0
        high = 1.0
        # Bisection of a scalar cubic: no step can leave the interval, and the full state is evaluated once.
        for _ in range(RETURN_SETTINGS.return_time_bisection_count):
            middle = (low + high) / 2
            if sum(map(mul, _hermite_weights(middle), angles)) < 0:
                low = middle
            else:
                high = middle
        times.append(run.times[k] + h * low)
        states.append(np.array(_hermite_weights(low)) @ cubic)
    return np.array(times), np.array(states).reshape(len(times), system.layout.unknown_count)


def _hermite_weights(x: float) -> tuple[float, float, float, float]:
    """Weights of (value at 0, value at 1, slope at 0, slope at 1) in the value at x of the cubic Hermite
    polynomial."""
    y = 1 - x
    # Cubic Hermite basis on [0, 1].
    return y * y * (1 + 2 * x), x * x * (3 - 2 * x), x * y * y, -x * x * y


def returns_per_period_and_distance(moments: Sequence[Array]) -> tuple[int, float]:
    """Returns (m, distance). m: number of returns per period: the smallest number for which the distance is
    nearly minimal. distance: relative distance between the last return and the m-th return before it. The
    result is (1, inf) if the moments at the last return are rounding errors.

    moments: bending moments at successive returns of the tip, (nodes,) each, the last return last. Only
    bending moments are compared, because the interpolation between time steps has errors in the stiff
    components, 1e-2 at k1 = 1e7.
    """
    size = np.linalg.norm(moments[-1])
    if (
        size < RETURN_SETTINGS.max_state_norm_of_straight_rod
    ):  # moments of this size are rounding errors, which do not repeat
        return 1, inf
    distances = [
        (float(np.linalg.norm(moments[-1] - moments[-1 - m]) / size), m) for m in range(1, len(moments))
    ]
    # The smallest m with a distance near the minimum, because the motion repeats after multiples of a period,
    # too.
    tolerance = max(2 * min(distances)[0], RETURN_SETTINGS.max_equal_return_distance)
    return next((m, distance) for distance, m in distances if distance <= tolerance)


def not_settled_text(
    total_count: int, return_count: int, return_distance: float, settled_count: int = 0
) -> str:
    """Message that explains why a motion has not settled after `total_count` returns of the tip.

    return_count: number of returns with a recorded state. return_distance: relative distance of the last
    return from an earlier return; NaN for too few returns, inf for a decayed motion. settled_count: number of
    returns until the motion settled on a coarser mesh; 0 if it has not settled.
    """
    if isfinite(return_distance):
        return (
            f"the motion does not repeat: after {total_count} returns of the tip the state still differs by "
            f"a relative {return_distance:.1e} from the state at an earlier return"
        )
    if isnan(return_distance) and settled_count:
        further = counted(total_count - settled_count, "further return")
        return (
            f"the motion has settled after {settled_count} returns of the tip, but the errors come from a "
            f"second integration, for which {further} are not enough"
        )
    if isnan(return_distance):
        return f"the tip returned to theta = 0 only {counted(return_count, 'time')}, so no period is known"
    return "the deflection has decayed to rounding error, but the straight rod is not stable"


def no_period_text(return_count: int, limit_text: str, last_returns: Sequence[tuple[float, Array]]) -> str:
    """Message on a motion in which no period was found, with a clause if the last returns almost repeat.

    return_count: number of returns of the tip. limit_text: clause on another limit that was reached, or
    empty. last_returns: time and bending moments, (nodes,), of each of the last returns.
    """
    text = f"no periodic motion within {counted(return_count, 'return')} of the tip{limit_text}"
    moments = [state for _, state in last_returns][-1 - RETURN_SETTINGS.max_returns_per_period :]
    if len(moments) < 2:
        return text
    _, distance = returns_per_period_and_distance(moments)
    if distance >= RETURN_SETTINGS.max_equal_return_distance:
        return text
    return (
        f"{text}, but the last returns differ by a relative {distance:.1e} only: the motion changes slowly, "
        "as near a fold of a branch of cycles, which the task `branch` follows"
    )


def has_too_few_returns(times: Array) -> bool:
    """Whether a run has too few returns for a classification. times: times of its returns, (k,)."""
    return len(times) < TRANSIENT_SETTINGS.min_returns_per_run


def return_count_of_classified_run(is_first: bool, left: int) -> int:
    """Number of returns of the next run of a motion that is classified after every run. is_first: whether the
    next run is the first. left: number of returns left up to the maximum."""
    usual = TRANSIENT_SETTINGS.returns_in_first_run if is_first else TRANSIENT_SETTINGS.returns_per_run
    return _return_count_of_run(usual, left, TRANSIENT_SETTINGS.min_returns_per_run)


def return_count_of_compared_run(left: int) -> int:
    """Number of returns of the next run of a motion whose returns are compared after every run. left: number
    of returns left up to the maximum."""
    return _return_count_of_run(TRANSIENT_SETTINGS.returns_per_run, left, TRANSIENT_SETTINGS.returns_per_run)


def _return_count_of_run(usual: int, left: int, least: int) -> int:
    """Number of returns of the next run: `usual`, or all `left` returns up to the maximum if fewer than
    `least` of them would be left for the run after it."""
    return usual if left - usual >= least else left
