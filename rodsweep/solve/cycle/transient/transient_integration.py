"""Integration of a motion from a start until Newton's method finds its cycle, or until the rod is straight.

The motion is integrated from return to return (`poincare_returns`). Newton's method starts once two returns
agree to a relative distance of a tenth. Slow motions about the straight rod are shortened by jumps: the state
is scaled to the amplitude that the amplitude equation predicts (`amplitude_equation`), unless the path of the
motion is stored.

A rod with an unstable straight state leaves this state. The deflection may nevertheless decay while a large
axial stretch relaxes slowly; the motion then restarts from a small deflection in the leading mode."""

from collections import deque

import numpy as np

from ....arrays import Array
from ....discretization.explicit_system import ExplicitSystem
from ....discretization.stress.form import StressForm
from ....solve_progress import SolvePosition, report
from ....wording import counted
from ...motion.integrator import INTEGRATOR_SETTINGS, EndReason, Trajectory, integrator, relax_fast_components
from ...motion.leading_mode import leading_mode
from ...orbit.matrix.workspace import NewtonWorkspace
from ..accuracy.refined_cycle import RefinedCycle
from ..cycle_outcome import CycleRequest, TransientOutcome
from ..status import CycleStatus
from ..straight_rod import StraightRodStability, growth_rate_of_integrated_rod
from .amplitude_equation import AmplitudeEquation
from .cycle_search import CycleSearch
from .motion_mesh import rod_for_time_integration
from .orbit_from_motion import orbit_from_motion, state_with_scaled_deflection
from .poincare_returns import (
    RETURN_SETTINGS,
    has_too_few_returns,
    no_period_text,
    poincare_section_crossings,
    return_count_of_classified_run,
    returns_per_period_and_distance,
    run_failure,
    run_limit_by_returns,
    tip_angle_row,
)
from .schemes import time_schemes_for_growth
from .shape_trace import ShapeTrace
from .tip_trace import TipTrace
from .transient_settings import TRANSIENT_SETTINGS


class TransientIntegration:
    """Integration of the motion of one rod from a start; `integrate_to_outcome` is called only once. form:
    the rod whose cycle is solved for, and the mesh. straight: stability of the straight rod. parameter_name,
    unstable_cycle: see `CycleSearch`. system: the integrated rod; a nearby rod if the rod of `form` has k1 =
    inf, k2 = inf or gamma3 = 0. record: the stored tip's path or shapes; None if not requested. returns,
    steps, jump_count: numbers of returns, time steps and jumps so far."""

    def __init__(
        self,
        form: StressForm,
        straight: StraightRodStability,
        request: CycleRequest,
        parameter_name: str | None,
        unstable_cycle: RefinedCycle | None,
        workspace: NewtonWorkspace,
    ) -> None:
        self.system = ExplicitSystem(rod_for_time_integration(form.rod), form.mesh)
        self.form = form
        self.straight = straight
        self.search = CycleSearch(request.accuracy, parameter_name, unstable_cycle, workspace)
        self.max_returns = request.most_periods
        self.leading_mode = leading_mode(self.system)
        trace = ShapeTrace if request.frames else TipTrace
        self.record = trace(self.system) if request.is_motion_recorded else None
        rate = straight.growth_rate(self.leading_mode.w.real)
        period = self.leading_mode.period
        schemes = time_schemes_for_growth(rate * period, request.transient > 0)
        self.first_scheme, self.scheme, growth_error, max_steps = schemes
        self.max_steps = max_steps * max(request.most_periods, TRANSIENT_SETTINGS.min_returns_of_step_limit)
        excess = rate - growth_rate_of_integrated_rod(form.rod, self.system.rod, straight, rate)
        self.amplitude_equation = AmplitudeEquation(period, rate, excess, growth_error)
        self.step = period / TRANSIENT_SETTINGS.first_time_steps_per_period
        """First time step of the next run, in tau2."""
        self.past_returns: deque[tuple[float, Array]] = deque(maxlen=TRANSIENT_SETTINGS.max_stored_returns)
        """Times, in tau2, and bending moments of the last returns since the last jump."""
        self.elapsed_time = 0.0
        self.returns = self.steps = self.jump_count = 0
        self.unsolved_message = ""
        """Message that no cycle is found near a periodic motion; "" while the search continues."""

    def integrate_to_outcome(self, z: Array) -> TransientOutcome:
        """Outcome of the motion from the state z, (unknowns,)."""
        z = self._state_after_fast_decay(z)
        is_first_run = True
        while self.returns < self.max_returns and self.steps < self.max_steps and not self.unsolved_message:
            report(lambda: SolvePosition(f"{self.returns} of at most {self.max_returns} returns of the tip"))
            returns = return_count_of_classified_run(is_first_run, self.max_returns - self.returns)
            run = self._run_of_returns(z, returns, is_first_run)
            if failure := run_failure(self.system, run, self.returns):
                status = CycleStatus.left_the_model if failure.left_the_model else CycleStatus.failed
                return self._outcome(status, failure.message)
            z = run.states[-1]
            times, states = poincare_section_crossings(self.system, run)
            self._record_returns(run, times, states)
            # An unstable rod is excluded, because rounding errors exceed the growth of so small a motion.
            has_decayed = np.linalg.norm(z) < RETURN_SETTINGS.max_state_norm_of_straight_rod
            if self.straight.is_stable is not False and has_decayed:
                return self._outcome(CycleStatus.straight, "the motion has decayed to rounding error")
            if self.straight.is_stable is False and not self._bends_beyond_rounding(z):
                if self.record or self.jump_count >= TRANSIENT_SETTINGS.max_state_jumps:
                    break
                # The rod is unstable, but the state has no component along the growing mode beyond rounding.
                z = self._state_after_jump(self.leading_mode.state(TRANSIENT_SETTINGS.restart_tip_y))
                continue
            is_first = is_first_run
            is_first_run = False
            if not has_too_few_returns(times):
                outcome, z = self._outcome_or_next_state(run, times, states, is_first)
                if outcome is not None:
                    return outcome
        if (cycle := self._cycle_approached_slowly(z)) is not None:
            return self._outcome(*cycle.status_and_message(self.search.accuracy), cycle)
        return self._outcome(CycleStatus.not_settled, self._not_settled_text(z))

    def _outcome_or_next_state(
        self, run: Trajectory, times: Array, states: Array, is_first: bool
    ) -> tuple[TransientOutcome | None, Array]:
        """Returns (outcome after `run`, None while it is unknown; state from which the motion continues,
        (unknowns,)). times, states: times and states of the returns, (k,) and (k, unknowns). is_first:
        whether the run is the first of the motion."""
        z = run.states[-1]
        equation = self.amplitude_equation
        if is_first and equation.is_slow_mode(times, states):
            return None, z
        continues = self.record is not None and self.record.needs_more_motion(z)
        if not (is_first or continues) and equation.decays_at_linear_rate(times, states):
            return self._outcome(CycleStatus.straight, "the motion decays at the rate of the leading mode"), z
        may_jump = not is_first and self.jump_count < TRANSIENT_SETTINGS.max_state_jumps
        factor = equation.scaling_factor_to_cycle(times, states) if may_jump else None
        if factor is not None:
            if not self.record or self.record.is_full:  # a motion with a stored path has no jumps
                z = self._state_after_jump(state_with_scaled_deflection(self.system, z, factor))
            return None, z
        cycle = None if equation.decays_no_slower_than_mode(times, states) else self._cycle_from_returns(run)
        if cycle is None:
            return None, z
        return self._outcome(*cycle.status_and_message(self.search.accuracy), cycle), z

    def _cycle_approached_slowly(self, z: Array) -> RefinedCycle | None:
        """The stable cycle that a motion with slowly changing amplitude approaches, predicted from its last
        returns and solved by Newton's method; None if there is none. z: current state, (unknowns,)."""
        factor = self.amplitude_equation.scaling_factor_to_slow_limit(self.past_returns)
        if factor is None or self.record or self.unsolved_message:
            return None
        start = state_with_scaled_deflection(self.system, z, factor)
        start = relax_fast_components(self.system, start, self.leading_mode.period)
        run = self._run_of_returns(start, TRANSIENT_SETTINGS.returns_per_run)
        times, _ = poincare_section_crossings(self.system, run)
        if len(times) < 2 or run_failure(self.system, run, self.returns):
            return None
        return self._cycle_near(run, float(times[-1] - times[-2]), 1)

    def _record_returns(self, run: Trajectory, times: Array, states: Array) -> None:
        """Counts the returns and time steps of `run`; records the times `times`, (k,), and the bending
        moments of the states `states`, (k, unknowns), of the returns."""
        self.returns += max(len(times), 1)
        self.steps += len(run.times) - 1
        moments = self.system.layout.stress_field(states, "m3")
        self.past_returns.extend(zip(map(float, self.elapsed_time + times), moments, strict=True))
        self.elapsed_time += run.times[-1]

    def _state_after_jump(self, z: Array) -> Array:
        """Makes a jump of the motion to the state z, (unknowns,), and discards the earlier returns; returns
        the state after the decay of the fast components of z."""
        self.jump_count += 1
        self.past_returns.clear()
        return relax_fast_components(self.system, z, self.leading_mode.period)

    def _not_settled_text(self, z: Array) -> str:
        """Message that explains why the motion, now at the state z, (unknowns,), has not settled."""
        if self.unsolved_message:
            return f"after {counted(self.returns, 'return')} of the tip {self.unsolved_message}"
        if self._bends_beyond_rounding(z):
            limit_text = f", at the maximum of {self.steps} time steps" * (self.steps >= self.max_steps)
            return no_period_text(self.returns, limit_text, self.past_returns)
        is_unstable = self.straight.is_stable is False
        reason = "the straight rod is unstable" if is_unstable else "the stretch of the rod has not relaxed"
        return f"the deflection has decayed after {self.returns} returns, but {reason}"

    def _bends_beyond_rounding(self, z: Array) -> bool:
        """Whether the bending and shear components of the state z, (unknowns,), exceed rounding errors."""
        size = np.linalg.norm(self.system.layout.transverse_unknowns(z))
        return bool(size >= RETURN_SETTINGS.max_state_norm_of_straight_rod)

    def _state_after_fast_decay(self, z: Array) -> Array:
        """The state z, (unknowns,), after the decay of its fast components, with which the record begins."""
        period, settings = self.leading_mode.period, INTEGRATOR_SETTINGS
        shortening = settings.relaxation_shortening_if_stored if self.record else 1.0
        relaxed_state = relax_fast_components(self.system, z, period, shortening)
        if self.record:
            self.elapsed_time = settings.relaxation_duration_over_period * period / shortening
            self.record.begin_with_relaxation(z, relaxed_state, self.elapsed_time)
        return relaxed_state

    def _outcome(self, status: CycleStatus, text: str, cycle: RefinedCycle | None = None) -> TransientOutcome:
        return TransientOutcome(status, text, self.returns, cycle)

    def _run_of_returns(self, z: Array, returns: int, first: bool = False) -> Trajectory:
        """A run from the state z, (unknowns,), over `returns` returns. The run lasts at most
        `max_actual_to_expected_run_duration` times the expected time of these returns. first: whether the run
        is the first of the motion."""
        scheme = self.first_scheme if first else self.scheme
        limit = run_limit_by_returns(tip_angle_row(self.system), z, returns)
        # A slow-fast cycle may take many time constants of a leading mode that does not oscillate.
        last = self.past_returns[-1][0] - self.past_returns[-2][0] if len(self.past_returns) > 1 else 0.0
        max_ratio = TRANSIENT_SETTINGS.max_actual_to_expected_run_duration
        duration = max_ratio * returns * max(self.leading_mode.period, last)
        run = integrator(self.system.mesh, scheme).run(self.system, z, duration, self.step, limit)
        if len(run.times) > 2:
            self.step = run.times[-1] - run.times[-2]
        if self.record:
            self.record.add_run(run, self.elapsed_time)
        return run

    def _cycle_from_returns(self, run: Trajectory) -> RefinedCycle | None:
        """The stable cycle near the end of a run, if the returns repeat and Newton's method converges; None
        otherwise, and before the next attempt is due. After too many failures near a periodic motion, sets
        `unsolved_message`."""
        states = [state for _, state in self.past_returns][-1 - RETURN_SETTINGS.max_returns_per_period :]
        count, distance = returns_per_period_and_distance(states)
        often_failed = self.search.successive_failures >= TRANSIENT_SETTINGS.max_successive_newton_failures
        if often_failed and distance < TRANSIENT_SETTINGS.max_return_distance_if_periodic:
            repeats_text = f"the motion repeats within {distance:.0e}, but Newton's method"
            self.unsolved_message = f"{repeats_text} finds no cycle near this motion on finer meshes"
            return None
        may_settle = self.record is not None and self.returns < self.max_returns // 2
        is_far = distance >= self.search.max_return_distance(may_settle)
        if is_far or self.returns < self.search.min_returns:
            return None
        self.search.count_attempt(self.returns)
        return self._cycle_near(run, self.past_returns[-1][0] - self.past_returns[-1 - count][0], count)

    def _cycle_near(self, run: Trajectory, period: float, return_count: int) -> RefinedCycle | None:
        """The stable cycle near the end of a run, by Newton's method; None if not found. period: approximate
        period, in tau2. return_count: number of returns of the tip per period. The run may be shorter than
        the period."""
        if run.times[-1] < period:
            start = run.states[-1]
            run = integrator(self.system.mesh, self.scheme).run(self.system, start, period, self.step)
            if run.end_reason != EndReason.reached:
                return None
        orbit = orbit_from_motion(self.system, self.form, run, period, return_count)
        return self.search.stable_cycle_near(orbit)
