"""Time integration of one rod from one state by PETSc's TS: the steps, and the reason why the run ended.

The default is fully implicit ARKIMEX of order 5, the fastest scheme in measurements. Three measures reduce
the time further. Stages are extrapolated from the stages of this step and of the last step. Newton's method
is compiled, and its tolerance is a fraction of the step's tolerance. Each step has a single Jacobian, at the
state predicted for the middle of the step; a Jacobian at the start of the step needs a quarter more
iterations.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ...arrays import Array
from ...discretization.elements.mesh import Mesh
from ...discretization.explicit_system import ExplicitSystem
from ...discretization.state_layout import plane_layout
from ..backend.petsc import PETSc
from ..backend.petsc_c_functions import call_petsc
from ..backend.solver_pools import LruPool
from .callbacks import CallbackWorkspace
from .step_record import end_step, pop_stored_steps
from .time_scheme import TimeScheme


@dataclass(frozen=True, slots=True, kw_only=True)
class IntegratorSettings:
    """Settings of the time integration: tolerances, limits, and the run in `relax_fast_components`."""

    max_relative_stagnant_newton_step: float = 1e-9
    """Newton's method for a stage stops, as converged, if it stagnates at steps whose rms size, divided by
    the largest component of the initial state, is at most this."""
    first_step_over_duration: float = 1e-3
    """Default first time step, as a fraction of the run's duration."""
    max_steps: int = 100_000
    """Default maximum number of time steps of a run."""
    max_rejections: int = 30
    """PETSc ends the run after more than this number of successive rejections of one time step."""
    max_failed_stages: int = 1_000_000
    """PETSc ends the run after more failures of Newton's method than this; each shortens the step."""
    relaxation_duration_over_period: float = 1e-3
    """Duration of the run in `relax_fast_components`, as a fraction of the period."""
    relaxation_steps_per_period: float = 1e5
    """Period divided by the first time step in `relax_fast_components`; fast components decay within ten
    steps."""
    relaxation_shortening_if_stored: float = 100.0
    """Value of `shortening` in `relax_fast_components` for a stored motion; 1 would cause errors of 1e-5."""
    relaxation_tolerance: float = 1e-3
    """Relative local error per time step in `relax_fast_components`."""
    max_pooled_integrators: int = 8
    """Maximum number of integrators in the pool, which serve further runs with the same mesh and scheme."""


INTEGRATOR_SETTINGS = IntegratorSettings()


RELAXATION_SCHEME = TimeScheme(
    "beuler", "", tolerance=INTEGRATOR_SETTINGS.relaxation_tolerance, options_prefix="cycle_relaxation_"
)
"""Time scheme of the run in `relax_fast_components`: backward Euler, which damps fast components."""


class EndReason(IntEnum):
    """Reason why a run of the time integration ended. reached: end of the duration. stopped: by the condition
    `RunLimit.is_reached`. left_the_model: a stretch h1 <= 0. too_many_steps: `RunLimit.max_steps` steps.
    failed: an error or a failed step of PETSc, or a state that is not finite."""

    reached = 0
    stopped = 1
    left_the_model = 2
    too_many_steps = 3
    failed = 4


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Result of a run: times in tau2, (steps + 1,), states z, (steps + 1, unknowns), reason for the end of
    the run, and PETSc's error message."""

    end_reason: EndReason
    """Reason why the run ended."""
    times: Array
    states: Array
    message: str = ""


@dataclass(frozen=True, slots=True)
class RunLimit:
    """Conditions that end a run early: a step ends at a state z for which `is_reached(z)` is true, or
    `max_steps` steps are made. is_reached: None without such a condition."""

    is_reached: Callable[[Array], bool] | None = None
    max_steps: int = INTEGRATOR_SETTINGS.max_steps


DEFAULT_RUN_LIMIT = RunLimit()
"""Limit of a run by the default maximum number of steps only."""


class Integrator:
    """PETSc time integrator for a mesh and a scheme; `run` may be called any number of times, for any rod."""

    def __init__(self, mesh: Mesh, scheme: TimeScheme) -> None:
        self.scheme = scheme
        self.workspace = CallbackWorkspace(mesh)
        unknowns = plane_layout(mesh.node_count).unknown_count
        self.vector = PETSc.Vec().createSeq(unknowns, comm=PETSc.COMM_SELF)
        self.matrix = PETSc.Mat().createDense((unknowns, unknowns), comm=PETSc.COMM_SELF)
        self.matrix.setUp()
        self.matrix.assemble()
        self.ts = self._create_ts()
        self.is_broken = False
        self._limit = DEFAULT_RUN_LIMIT

    def _create_ts(self) -> "PETSc.TS":
        """A TS with the options of the scheme, which the user's PETSc options override."""
        database = PETSc.Options()
        prefix = self.scheme.options_prefix
        ts = PETSc.TS().create(comm=PETSc.COMM_SELF)
        ts.setOptionsPrefix(prefix)
        ts.setProblemType(PETSc.TS.ProblemType.NONLINEAR)
        ts.setMaxStepRejections(INTEGRATOR_SETTINGS.max_rejections)
        ts.setMaxSNESFailures(INTEGRATOR_SETTINGS.max_failed_stages)
        options = self.scheme.petsc_options(database.getString(prefix + "ts_type", self.scheme.ts_type))
        own_options = {
            prefix + name: value for name, value in options.items() if not database.hasName(prefix + name)
        }
        for name, value in own_options.items():
            database.setValue(name, value)
        ts.setErrorIfStepFails(False)
        ts.setExactFinalTime(PETSc.TS.ExactFinalTime.MATCHSTEP)
        try:
            ts.setFromOptions()
            ts.getSNES().getKSP().setFromOptions()  # a SNES of type shell does not do this
        finally:
            for name in own_options:  # the remaining options are the user's, and are recorded as such
                database.delValue(name)
        self.workspace.register_callbacks(ts, self.matrix)
        return ts

    def _stop_at_limit(self, ts: "PETSc.TS") -> None:
        """Post-step function of a run with a `RunLimit.is_reached`: stores the step; ends the run if the
        limit is reached."""
        end_step.ctypes(ts.handle)
        if self._limit.is_reached is not None and self._limit.is_reached(self.vector.array_r.copy()):
            ts.setConvergedReason(PETSc.TS.ConvergedReason.CONVERGED_USER)

    def run(
        self,
        system: ExplicitSystem,
        z: Array,
        duration: float,
        first_step: float = 0.0,
        limit: RunLimit = DEFAULT_RUN_LIMIT,
    ) -> Trajectory:
        """Integrates from the state z, (unknowns,), over `duration`, in tau2, or to the limit. A failure is
        returned as an `EndReason`, never raised.

        first_step: the first time step, or every time step of a scheme with equal steps, in tau2; 0 for the
        default. Tolerances are relative to the largest component of z, so that small and large motions are
        integrated with the same relative accuracy.
        """
        ts = self.ts
        scheme = self.scheme
        self._limit = limit
        # A state of 0 would make all tolerances 0.
        state_size = float(np.abs(z).max()) or 1.0
        self.vector.array_w[:] = z
        ts.setTolerances(rtol=0.0, atol=scheme.tolerance * state_size)
        tolerance = scheme.newton_tolerance_ratio * scheme.tolerance * state_size
        self.workspace.set_rod_and_tolerances(
            system, tolerance, INTEGRATOR_SETTINGS.max_relative_stagnant_newton_step * state_size
        )
        ts.setTime(0.0)
        ts.setStepNumber(0)
        ts.setMaxTime(duration)
        ts.setMaxSteps(limit.max_steps)
        ts.setTimeStep(first_step or INTEGRATOR_SETTINGS.first_step_over_duration * duration)
        # The first step must not extrapolate from an earlier run.
        ts.restartStep()
        ts.setConvergedReason(PETSc.TS.ConvergedReason.CONVERGED_ITERATING)
        if limit.is_reached is None:
            call_petsc("TSSetPostStep", ts.handle, end_step.address)
        else:
            ts.setPostStep(self._stop_at_limit)
        message = ""
        try:
            ts.solve(self.vector)
        except (PETSc.Error, SystemError) as error:
            message = str(error.__cause__ or error).splitlines()[-1]
            self.is_broken = True  # after an error inside PETSc its objects are unusable
        rows = np.concatenate([[np.append(0.0, z)], pop_stored_steps(self.workspace.context)])
        times = np.ascontiguousarray(rows[:, 0])
        states = np.ascontiguousarray(rows[:, 1:])
        return Trajectory(self._run_end_reason(message, states[-1]), times, states, message)

    def _run_end_reason(self, message: str, end_state: Array) -> EndReason:
        """Reason why the run ended. message: PETSc's error message, or empty. end_state: last state."""
        reason = self.ts.getConvergedReason()
        reasons = PETSc.TS.ConvergedReason
        if message or reason < 0 or not np.isfinite(end_state).all():
            return EndReason.failed
        if self.workspace.context["left"]:
            return EndReason.left_the_model
        end_reasons = {reasons.CONVERGED_TIME: EndReason.reached, reasons.CONVERGED_USER: EndReason.stopped}
        return end_reasons.get(reason, EndReason.too_many_steps)

    @property
    def memory_bytes(self) -> int:
        """Estimate of the memory in bytes: the dense Jacobian, its LU factors and a copy."""
        return 3 * 8 * self.vector.size**2

    def destroy(self) -> None:
        """Frees the PETSc objects: TS and integrator refer to each other, so garbage collection would not."""
        for petsc_object in (self.ts, self.workspace, self.matrix, self.vector):
            petsc_object.destroy()


_integrators: LruPool[tuple[Mesh, TimeScheme], Integrator] = LruPool(
    lambda key: Integrator(*key), INTEGRATOR_SETTINGS.max_pooled_integrators
)


def integrator(mesh: Mesh, scheme: TimeScheme) -> Integrator:
    """The pooled integrator for `mesh` and `scheme`; a new one after an error inside PETSc."""
    key = mesh, scheme
    if _integrators.get(key).is_broken:
        _integrators.destroy_object(key)
    return _integrators.get(key)


def destroy_integrators() -> None:
    """Destroys all pooled integrators, after an error or a change of PETSc options."""
    _integrators.destroy_all()


def relax_fast_components(system: ExplicitSystem, z: Array, period: float, shortening: float = 1.0) -> Array:
    """The state, (unknowns,), that the rod reaches from the state z, (unknowns,), after a thousandth of
    `period`/`shortening`, in tau2, when the fast components of z have decayed.

    A scaled or interpolated state has rates of 1e10/tau2 in the components with the fast relaxation due to
    k1, k2 and 1/gamma3. The explicit first stage of ARKIMEX does not damp these components at any step
    length; backward Euler damps these components within ten steps. If the run fails, z itself is returned.
    """
    duration = INTEGRATOR_SETTINGS.relaxation_duration_over_period * period / shortening
    step = period / shortening / INTEGRATOR_SETTINGS.relaxation_steps_per_period
    trajectory = integrator(system.mesh, RELAXATION_SCHEME).run(system, z, duration, step)
    return trajectory.states[-1] if trajectory.end_reason == EndReason.reached else z
