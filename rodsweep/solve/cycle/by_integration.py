"""The limit cycle of one rod by time integration alone: task `limit_cycle` with `method: integration`.

The characteristic determinant gives only the leading eigenvalue of the straight rod, which is stored. No
Floquet multiplier is computed: a motion that settles on a cycle shows that the cycle is stable in the plane.
Period and extrema are measured on two settled motions, the second on a finer mesh with a smaller tolerance;
the difference gives the error estimate. Near a Hopf point a motion may not settle within the allowed periods.
"""

from collections import deque
from dataclasses import replace
from math import nan

import numpy as np
from scipy.interpolate import CubicSpline

from ...arrays import Array
from ...discretization.elements.mesh import mesh_with_edges
from ...discretization.explicit_system import ExplicitSystem
from ...discretization.stress.form import StressForm
from ...model.rod import Rod
from ...solve_progress import SolvePosition, report
from ..motion.integrator import RunLimit, Trajectory, destroy_integrators, integrator, relax_fast_components
from ..motion.leading_mode import leading_mode
from ..motion.time_scheme import TimeScheme
from ..orbit.measures import CycleMotion, measures_of
from ..orbit.orbit import Orbit, node_time_fractions
from ..orbit.symmetry import NO_SYMMETRY
from ..point_outcome import outcome_or_failure
from .accuracy.cycle_errors import CycleErrors, errors_of_two_integrations, message_of_error
from .cycle_outcome import CycleOutcome, CycleRequest, with_measures
from .integration_settings import INTEGRATION_SETTINGS
from .settled_motion import (
    NoCycleFound,
    ReturnDistances,
    ReturnTimeEstimate,
    SettledMotion,
    max_settled_distance_from_cycle,
    with_reduced_tolerance,
)
from .status import IntegratedCycleStatus
from .straight_rod import straight_rod_stability
from .transient.motion_mesh import motion_mesh, rod_for_time_integration
from .transient.orbit_from_motion import collocation_states
from .transient.poincare_returns import (
    RETURN_SETTINGS,
    not_settled_text,
    poincare_section_crossings,
    return_count_of_compared_run,
    returns_per_period_and_distance,
    run_failure,
    run_limit_by_returns,
    tip_angle_row,
)
from .transient.transient_settings import TRANSIENT_SETTINGS


def solve_by_integration(rod: Rod, request: CycleRequest) -> CycleOutcome:
    """Outcome of a rod's motion from its leading mode, by time integration; a failure becomes a status."""

    def failed(cause: str) -> CycleOutcome:
        destroy_integrators()  # after an error inside PETSc its objects are unusable
        return CycleOutcome(status=IntegratedCycleStatus.failed, message=cause)

    return outcome_or_failure(lambda: _IntegrationUntilSettled(rod, request).cycle_outcome(), failed)


class _IntegrationUntilSettled:
    """Integration of the motion of one rod until the motion settles, on successively finer meshes."""

    def __init__(self, rod: Rod, request: CycleRequest) -> None:
        self.request = request
        self.limiting_rod = rod
        self.rod = rod_for_time_integration(rod)
        self.mesh = motion_mesh(rod, request.accuracy)
        tolerance = INTEGRATION_SETTINGS.local_tolerance_per_accuracy * request.accuracy
        self.scheme = TimeScheme("arkimex", "5", tolerance=tolerance)
        self.system = ExplicitSystem(self.rod, self.mesh)
        self.leading_mode = leading_mode(self.system)
        self.return_count = self.settled_count = 0  # returns so far, and until the motion last settled
        self.return_times = ReturnTimeEstimate(self.leading_mode.period)
        self.time_intervals_per_return = INTEGRATION_SETTINGS.measurement_intervals_per_return

    def cycle_outcome(self) -> CycleOutcome:
        """The outcome for the rod: the cycle with its errors, or the status of a motion without a cycle."""
        # Exact; an eigenvalue of the mesh has errors up to 1e-3.
        w = straight_rod_stability(self.limiting_rod).w
        straight = CycleOutcome(
            status=IntegratedCycleStatus.straight, linear_growth_rate=w.real, linear_frequency=w.imag
        )
        try:
            start = self.leading_mode.state(self.request.amplitude)
            z = relax_fast_components(self.system, start, self.leading_mode.period)
            settled = self._integrate_until_settled(z)
            motion = self._cycle_of_settled_motion(settled)
            is_nearby_rod = self.rod != self.limiting_rod
            error_ratio = INTEGRATION_SETTINGS.max_nearby_rod_error_over_accuracy if is_nearby_rod else 1.0
            tolerance = self.request.accuracy * error_ratio
            for _ in range(INTEGRATION_SETTINGS.max_integration_comparisons):
                settled = self._settled_on_finer_mesh(settled)
                coarser_motion = motion
                motion = self._cycle_of_settled_motion(settled)
                settled_distance = max_settled_distance_from_cycle(self.request.accuracy)
                errors = errors_of_two_integrations(coarser_motion, motion, settled_distance)
                if errors.largest_weighted_error <= tolerance:
                    break
            if is_nearby_rod:
                errors = self._errors_with_limiting_rod_error(settled, motion, errors)
        except NoCycleFound as end:
            return replace(straight, status=end.status, message=end.message, periods=self.return_count)
        return self._with_measures(straight, motion, errors)

    def _settled_on_finer_mesh(self, settled: SettledMotion) -> SettledMotion:
        """The motion `settled`, continued on a finer mesh with a smaller tolerance until it settles again."""
        coarser_system = self.system
        order = self.mesh.order + INTEGRATION_SETTINGS.element_order_increase
        self.mesh = mesh_with_edges(self.mesh.edges, order)
        self.scheme = with_reduced_tolerance(self.scheme)
        self.time_intervals_per_return *= INTEGRATION_SETTINGS.measurement_interval_growth_factor
        self.system = ExplicitSystem(self.rod, self.mesh)
        z = self.system.state_of_stresses(coarser_system.stresses_on_mesh(self.system.mesh, settled.state))
        return self._integrate_until_settled(relax_fast_components(self.system, z, self.leading_mode.period))

    def _integrate_until_settled(self, z: Array) -> SettledMotion:
        """The settled motion from the state z, (unknowns,); raises NoCycleFound."""
        past_moments: deque[Array] = deque(maxlen=RETURN_SETTINGS.max_returns_per_period + 1)
        angle_row = tip_angle_row(self.system)
        time_step = self.leading_mode.period / TRANSIENT_SETTINGS.first_time_steps_per_period
        distances = ReturnDistances(self.scheme.tolerance)
        max_returns = self.request.most_periods
        while self.return_count < max_returns:
            report(lambda: SolvePosition(f"{self.return_count} of at most {max_returns} returns of the tip"))
            returns = return_count_of_compared_run(max_returns - self.return_count)
            limit = run_limit_by_returns(angle_row, z, returns)
            run = self._integrate(z, self._max_run_duration(returns), time_step, limit)
            z = run.states[-1]
            # The last time step of a run is the first time step of the next run, which continues the motion.
            time_step = float(run.times[-1] - run.times[-2])
            times, states = self._return_times_and_states(run)
            self.return_times.record_run(times, float(run.times[-1]))
            past_moments.extend(self.system.layout.stress_field(states, "m3"))
            self.return_count += max(len(states), 1)
            has_decayed = np.linalg.norm(z) < RETURN_SETTINGS.max_state_norm_of_straight_rod
            if self.leading_mode.w.real < 0 and has_decayed:
                raise NoCycleFound(IntegratedCycleStatus.straight, "the motion has decayed to rounding error")
            if len(past_moments) <= TRANSIENT_SETTINGS.returns_per_run:
                continue
            returns_per_repetition, distance = returns_per_period_and_distance(list(past_moments))
            distances.record_distance(distance, returns_per_repetition / returns)
            if distances.have_settled(self.request.accuracy):
                self.settled_count = self.return_count
                return SettledMotion(z, returns_per_repetition, time_step)
            if distances.are_integration_errors:
                self.scheme = with_reduced_tolerance(self.scheme)
                distances.restart(self.scheme.tolerance)
                past_moments.clear()
        message = not_settled_text(self.return_count, len(past_moments), distances.last, self.settled_count)
        raise NoCycleFound(IntegratedCycleStatus.not_settled, message)

    def _max_run_duration(self, returns: int) -> float:
        """Largest duration, in tau2, of a run in which the tip is expected to return `returns` times."""
        max_ratio = TRANSIENT_SETTINGS.max_actual_to_expected_run_duration
        return max_ratio * returns * self.return_times.time_per_return

    def _integrate(
        self, z: Array, duration: float, step: float, limit: RunLimit, scheme: TimeScheme | None = None
    ) -> Trajectory:
        """The motion from the state z, (unknowns,), over `duration`, in tau2, or to `limit`; raises
        NoCycleFound if the run fails. step: first time step, in tau2. scheme: None for `self.scheme`."""
        run = integrator(self.system.mesh, scheme or self.scheme).run(self.system, z, duration, step, limit)
        if failure := run_failure(self.system, run, self.return_count):
            status = IntegratedCycleStatus.failed
            if failure.left_the_model:
                status = IntegratedCycleStatus.left_the_model
            raise NoCycleFound(status, failure.message)
        return run

    def _return_times_and_states(self, run: Trajectory) -> tuple[Array, Array]:
        """Returns (times, states), (k,) and (k, unknowns), at which the tip's theta rises through 0 on a run.
        The motion is integrated to these times, because cubic interpolation is less accurate."""
        times = poincare_section_crossings(self.system, run)[0]
        angle_row = tip_angle_row(self.system)
        states = np.empty((len(times), self.system.unknown_count))
        for i, time in enumerate(times):
            step_index = int(np.searchsorted(run.times, time, side="right")) - 1
            elapsed_time = float(time - run.times[step_index])
            z = run.states[step_index]
            if elapsed_time > 0:
                z = self._integrate(z, elapsed_time, elapsed_time, RunLimit()).states[-1]
            rates = self.system.state_derivative(z[None])[0]
            # A Newton step in time from the interpolated crossing: theta is smooth there.
            delay = float(angle_row @ z) / float(angle_row @ rates)
            times[i] = time - delay
            states[i] = z - delay * rates
        return times, states

    def _cycle_of_settled_motion(self, settled: SettledMotion) -> CycleMotion:
        """The cycle of a settled motion, from a further run of more than a period; raises NoCycleFound."""
        count = settled.returns_per_period + 2
        limit = run_limit_by_returns(tip_angle_row(self.system), settled.state, count)
        tolerance = min(self.scheme.tolerance, INTEGRATION_SETTINGS.max_local_tolerance_of_measured_run)
        duration = self._max_run_duration(count)
        scheme = replace(self.scheme, tolerance=tolerance)
        run = self._integrate(settled.state, duration, settled.last_time_step, limit, scheme)
        times = self._return_times_and_states(run)[0]
        if len(times) <= settled.returns_per_period:
            raise NoCycleFound(
                IntegratedCycleStatus.not_settled,
                f"after {self.return_count} returns to theta = 0 the tip does not return again",
            )
        period = float(times[settled.returns_per_period] - times[0])
        spline = CubicSpline(run.times, run.states)
        stages = INTEGRATION_SETTINGS.measurement_stage_count
        interval_count = self.time_intervals_per_return * settled.returns_per_period
        states = spline(times[0] + period * node_time_fractions(interval_count, stages))
        form = StressForm(self.rod, self.system.mesh)
        states = collocation_states(self.system, form, states)
        return CycleMotion(Orbit.from_states(form, NO_SYMMETRY, period, states, stages))

    def _errors_with_limiting_rod_error(
        self, settled: SettledMotion, cycle: CycleMotion, errors: CycleErrors
    ) -> CycleErrors:
        """The errors `errors` of `cycle`, increased by the effect of replacing a limiting rod (k1 = inf, k2 =
        inf or gamma3 = 0) by a nearby rod that can be integrated; measured by a second nearby rod. Raises
        NoCycleFound. settled: settled motion on this cycle."""
        self.rod = rod_for_time_integration(
            self.limiting_rod, INTEGRATION_SETTINGS.second_rod_limit_distance_ratio
        )
        self.system = ExplicitSystem(self.rod, self.mesh)
        z = relax_fast_components(self.system, settled.state, self.leading_mode.period)
        second_cycle = self._cycle_of_settled_motion(self._integrate_until_settled(z))
        limit_errors = errors_of_two_integrations(cycle, second_cycle, 0.0)
        return CycleErrors(
            errors.period_error + limit_errors.period_error,
            errors.amplitude_error + limit_errors.amplitude_error,
            errors.extrema_error + limit_errors.extrema_error,
            nan,
        )

    def _with_measures(self, outcome: CycleOutcome, motion: CycleMotion, errors: CycleErrors) -> CycleOutcome:
        """The outcome `outcome` with the status, measures and errors of the cycle `motion`."""
        is_accurate = errors.largest_weighted_error <= self.request.accuracy
        cycle = replace(
            outcome,
            status=IntegratedCycleStatus.cycle if is_accurate else IntegratedCycleStatus.not_settled,
            message="" if is_accurate else message_of_error(errors, self.request.accuracy),
            periods=self.return_count,
        )
        return with_measures(cycle, self.request, motion, measures_of(motion), errors)
