"""Time integration of one rod by PETSc TS: a run from one state, its steps, and the reason of its end.

The default is fully implicit ARKIMEX of order 5, the fastest scheme in measurements. The speed comes from
three measures. Stages are extrapolated from the stages of this step and the last. Newton's method is
compiled, and stops at a share of the step's tolerance. Each step has a single Jacobian, at the state
predicted for the middle of the step; a Jacobian at the start costs a quarter more iterations.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ...arrays import Array
from ...discretization.beam import Beam
from ...discretization.elements.mesh import Mesh
from ...discretization.state_layout import plane_layout
from ..backend.c_functions import call
from ..backend.kept import LruPool
from ..backend.petsc import PETSc
from .callbacks import Workspace
from .step_record import end_step, take_steps
from .time_scheme import TimeScheme


@dataclass(frozen=True, slots=True, kw_only=True)
class IntegratorSettings:
    """Limits of a run of the time integration."""

    stage_rounding: float = 1e-9
    """Size of a Newton step, relative to the motion, at which stagnation is due to rounding errors."""
    first_step_share: float = 1e-3
    """Default first step in units of the duration."""
    max_steps: int = 100_000
    """Default maximum number of steps."""
    max_rejections: int = 30
    """Maximum number of successive rejections of one step."""
    max_failed_stages: int = 1_000_000
    """Maximum number of failures of Newton's method in a run."""
    relaxation_share: float = 1e-3
    """Duration of `relaxed` in periods."""
    relaxation_steps: float = 1e5
    """First steps of `relaxed` that would fill a period; the fast components decay within ten steps."""
    relaxation_tolerance: float = 1e-3
    """Tolerance of the scheme of `relaxed`."""
    kept: int = 8
    """Number of integrators kept for further runs on equal meshes."""


INTEGRATOR = IntegratorSettings()


RELAXATION = TimeScheme("beuler", "", tolerance=INTEGRATOR.relaxation_tolerance, prefix="cycle_relaxation_")
"""Scheme of `relaxed`."""


class RunEnding(IntEnum):
    """Reasons of the end of a run."""

    reached = 0
    stopped = 1
    left_the_model = 2
    too_many_steps = 3
    failed = 4


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Steps of a run: times in tau2, (steps + 1,), states z, (steps + 1, unknowns); and why the run ended."""

    ending: RunEnding
    times: Array
    states: Array
    message: str = ""


@dataclass(frozen=True, slots=True)
class RunLimit:
    """Early end of a run: a step to z with `reached(z)`, or the maximum number of steps."""

    reached: Callable[[Array], bool] | None = None
    max_steps: int = INTEGRATOR.max_steps


UNLIMITED = RunLimit()


class Integrator:
    """A TS for a mesh and a scheme; `run` may be called any number of times, for any rod."""

    def __init__(self, mesh: Mesh, scheme: TimeScheme) -> None:
        self.scheme = scheme
        self.workspace = Workspace(mesh)
        unknowns = plane_layout(mesh.nodes).unknowns
        self.vector = PETSc.Vec().createSeq(unknowns, comm=PETSc.COMM_SELF)
        self.matrix = PETSc.Mat().createDense((unknowns, unknowns), comm=PETSc.COMM_SELF)
        self.matrix.setUp()
        self.matrix.assemble()
        self.ts = self._create()
        self.broken = False
        self._limit = UNLIMITED

    def _create(self) -> "PETSc.TS":
        database = PETSc.Options()
        prefix = self.scheme.prefix
        ts = PETSc.TS().create(comm=PETSc.COMM_SELF)
        ts.setOptionsPrefix(prefix)
        ts.setProblemType(PETSc.TS.ProblemType.NONLINEAR)
        ts.setMaxStepRejections(INTEGRATOR.max_rejections)
        ts.setMaxSNESFailures(INTEGRATOR.max_failed_stages)
        options = self.scheme.petsc_options(database.getString(prefix + "ts_type", self.scheme.family))
        ours = {
            prefix + name: value for name, value in options.items() if not database.hasName(prefix + name)
        }
        for name, value in ours.items():
            database.setValue(name, value)
        ts.setErrorIfStepFails(False)
        ts.setExactFinalTime(PETSc.TS.ExactFinalTime.MATCHSTEP)
        try:
            ts.setFromOptions()
            ts.getSNES().getKSP().setFromOptions()  # a SNES of type shell does not do this
        finally:
            for name in ours:  # the remaining options are the user's, and are recorded as such
                database.delValue(name)
        self.workspace.attach(ts, self.matrix)
        return ts

    def _stop_at_limit(self, ts: "PETSc.TS") -> None:
        """Post-step of a run with a `RunLimit.reached`: stores the step, and ends the run at the limit."""
        end_step.ctypes(ts.handle)
        if self._limit.reached is not None and self._limit.reached(self.vector.array_r.copy()):
            ts.setConvergedReason(PETSc.TS.ConvergedReason.CONVERGED_USER)

    def run(
        self, beam: Beam, z: Array, duration: float, step: float = 0.0, limit: RunLimit = UNLIMITED
    ) -> Trajectory:
        """Integrates from z, shape (unknowns,), over `duration` or to the limit; failures become a RunEnding.

        step: the first step, or each step if the steps are equal. Tolerances are relative to the largest
        component of z, so that small motions are integrated as accurately as large ones.
        """
        ts = self.ts
        scheme = self.scheme
        self._limit = limit
        size = float(np.abs(z).max()) or 1.0
        self.vector.array_w[:] = z
        ts.setTolerances(rtol=0.0, atol=scheme.tolerance * size)
        tolerance = scheme.newton * scheme.tolerance * size
        self.workspace.prepare(beam, tolerance, INTEGRATOR.stage_rounding * size)
        ts.setTime(0.0)
        ts.setStepNumber(0)
        ts.setMaxTime(duration)
        ts.setMaxSteps(limit.max_steps)
        ts.setTimeStep(step or INTEGRATOR.first_step_share * duration)
        ts.restartStep()
        ts.setConvergedReason(PETSc.TS.ConvergedReason.CONVERGED_ITERATING)
        if limit.reached is None:
            call("TSSetPostStep", ts.handle, end_step.address)
        else:
            ts.setPostStep(self._stop_at_limit)
        message = ""
        try:
            ts.solve(self.vector)
        except (PETSc.Error, SystemError) as error:
            message = str(error.__cause__ or error).splitlines()[-1]
            self.broken = True  # after an error inside PETSc its objects are unusable
        rows = np.concatenate([[np.append(0.0, z)], take_steps(self.workspace.context)])
        times = np.ascontiguousarray(rows[:, 0])
        states = np.ascontiguousarray(rows[:, 1:])
        return Trajectory(self._ending(message, states[-1]), times, states, message)

    def _ending(self, message: str, end: Array) -> RunEnding:
        reason = self.ts.getConvergedReason()
        reasons = PETSc.TS.ConvergedReason
        if message or reason < 0 or not np.isfinite(end).all():
            return RunEnding.failed
        if self.workspace.context["left"]:
            return RunEnding.left_the_model
        named = {reasons.CONVERGED_TIME: RunEnding.reached, reasons.CONVERGED_USER: RunEnding.stopped}
        return named.get(reason, RunEnding.too_many_steps)

    @property
    def kept_bytes(self) -> int:
        """Memory of the dense Jacobian, its factors and a copy, in bytes."""
        return 3 * 8 * self.vector.size**2

    def destroy(self) -> None:
        """Frees the PETSc objects; TS and integrator refer to each other, so garbage collection would not."""
        for held in (self.ts, self.workspace, self.matrix, self.vector):
            held.destroy()


_kept: LruPool[tuple[Mesh, TimeScheme], Integrator] = LruPool(lambda key: Integrator(*key), INTEGRATOR.kept)


def integrator(mesh: Mesh, scheme: TimeScheme) -> Integrator:
    """The kept integrator for a mesh and a scheme; replaced after an error."""
    key = mesh, scheme
    if _kept.get(key).broken:
        _kept.drop(key)
    return _kept.get(key)


def forget_integrators() -> None:
    """Drops all kept integrators, after an error or a change of options."""
    _kept.clear()


def relaxed(beam: Beam, z: Array, period: float) -> Array:
    """The state z, (unknowns,), after a thousandth of a period, when its fast components have decayed.

    A scaled or interpolated state has rates of 1e10/tau2 in the components that k1, k2 and 1/gamma3 make
    fast. The explicit first stage of ARKIMEX does not damp these components at any step length; backward
    Euler damps them within ten steps. If the run fails, z itself is returned.
    """
    duration = INTEGRATOR.relaxation_share * period
    step = period / INTEGRATOR.relaxation_steps
    run = integrator(beam.mesh, RELAXATION).run(beam, z, duration, step)
    return run.states[-1] if run.ending == RunEnding.reached else z
