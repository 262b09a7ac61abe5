"""Shapes of a rod at equidistant times from the start of a motion, for an animation."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ....arrays import Array
from ....discretization.elements.quadrature import lobatto_points
from ....discretization.explicit_system import ExplicitSystem
from ...motion.integrator import Trajectory
from ..cycle_outcome import MotionShapes


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeTraceSettings:
    """Settings for the shapes of a motion that are stored for an animation."""

    max_recorded_steps: int = 4000
    """Number of recorded time steps from which on no further run is recorded: some 50 to 100 returns of the
    tip, or 4 MB."""
    max_stored_shapes: int = 1600
    """Maximum number of stored shapes: 50 periods of 32 shapes."""
    max_tip_y_at_rest: float = 2e-3
    """An arm is at rest if the tip's |y|, in L, is at most this number."""
    min_returns_to_measure_period: int = 3
    """With fewer returns than this number, the period of the leading mode is used as the period of the
    motion."""


SHAPE_TRACE_SETTINGS = ShapeTraceSettings()


class ShapeTrace:
    """Record of the first time steps of one motion, and the interpolation of shapes between these time steps.
    run_times, run_states: times, (steps,), and states, (steps, unknowns), of each recorded run. step_count:
    number of recorded time steps."""

    def __init__(self, system: ExplicitSystem) -> None:
        self.system = system
        self.run_times: list[Array] = []
        self.run_states: list[Array] = []
        self.step_count = 0

    @property
    def is_full(self) -> bool:
        """Whether so many time steps are recorded that further runs are ignored."""
        return self.step_count >= SHAPE_TRACE_SETTINGS.max_recorded_steps

    def needs_more_motion(self, z: Array) -> bool:
        """Whether the motion is integrated further even if its outcome is known: the arm is not at rest, and
        the record is not full. z: current state, (unknowns,)."""
        return (
            not self.is_full
            and abs(float(self.system.tip_coordinates(z)[1])) > SHAPE_TRACE_SETTINGS.max_tip_y_at_rest
        )

    def begin_with_relaxation(self, z: Array, relaxed: Array, duration: float) -> None:
        """Records the start state z, (unknowns,). The relaxation from z to `relaxed`, (unknowns,), over
        `duration`, in tau2, is too short to be visible and is not recorded."""
        self._append_steps(np.zeros(1), z[None])

    def add_run(self, run: Trajectory, clock: float) -> None:
        """Records the time steps of a run that begins at the time `clock`, in tau2."""
        # A run that left the model may end with a state that is not finite.
        finite = np.isfinite(run.states).all(axis=1)
        self._append_steps(clock + run.times[finite], run.states[finite])

    def _append_steps(self, times: Array, states: Array) -> None:
        if not self.is_full:
            self.run_times.append(times)
            self.run_states.append(states)
            self.step_count += len(times)

    def motion_shapes(
        self, return_times: Sequence[float], period: float, frame_count: int, node_count: int
    ) -> MotionShapes:
        """Shapes on `node_count` Lobatto nodes, `frame_count` shapes per return of the tip, until the arm is
        at rest, at most SHAPE_TRACE_SETTINGS.max_stored_shapes.

        return_times: times of the last returns of the tip, in tau2. period: period of the leading mode, in
        tau2, used in place of the time per return if there are fewer than
        SHAPE_TRACE_SETTINGS.min_returns_to_measure_period returns.
        """
        from scipy.interpolate import CubicSpline  # slow import: 0.1 s, for few runs

        time_step = (
            # The median is not affected by a few irregular returns.
            float(np.median(np.diff(return_times)))
            if len(return_times) >= SHAPE_TRACE_SETTINGS.min_returns_to_measure_period
            else period
        ) / frame_count
        shape_times = time_step * np.arange(
            min(int(self.run_times[-1][-1] / time_step) + 1, SHAPE_TRACE_SETTINGS.max_stored_shapes)
        )
        run_indices = np.searchsorted([times[0] for times in self.run_times], shape_times, side="right") - 1
        states = np.empty((len(shape_times), self.system.unknown_count))
        for number, (times, steps) in enumerate(zip(self.run_times, self.run_states, strict=True)):
            is_in_run = run_indices == number
            if is_in_run.any():
                states[is_in_run] = (
                    # The first record is the start alone, through which there is no spline.
                    CubicSpline(times, steps)(shape_times[is_in_run]) if len(times) > 1 else steps[:1]
                )
        shapes = (
            self.system.shape(states)[:2] @ self.system.mesh.evaluation_matrix(lobatto_points(node_count)).T
        )
        is_complete = not self.is_full and len(shape_times) < SHAPE_TRACE_SETTINGS.max_stored_shapes
        moving_shapes = np.flatnonzero(np.abs(shapes[1, :, -1]) > SHAPE_TRACE_SETTINGS.max_tip_y_at_rest)
        # One shape at rest follows the last moving shape.
        return MotionShapes(time_step, shapes[:, : int(moving_shapes.max(initial=0)) + 2], is_complete)
