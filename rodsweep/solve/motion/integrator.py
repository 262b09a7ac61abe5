"""Time evolution of one rod by PETSc TS: a run from one state, its steps and how it ended.

The default is ARKIMEX of order 5 with everything implicit, chosen by measurement. What makes it fast: stages
predicted from those of this step and the last; Newton's method compiled, and its test tied to the step's
tolerance; one Jacobian a step, that of the state expected half-way (at its start it costs a quarter more
iterations).
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
from ..backend.kept import Kept
from ..backend.petsc import PETSc
from .callbacks import Workspace
from .step_record import end_step, take_steps
from .time_scheme import TimeScheme

STAGE_ROUND_OFF = 1e-9
"""Size of a Newton step, relative to the motion, at which stagnation is rounding and not failure."""
FIRST_SHARE = 1e-3
"""First step in units of the duration, where none is given."""
MOST_TIME_STEPS = 100_000
MOST_REJECTIONS, MOST_FAILED_STAGES = 30, 1_000_000
"""Rejections of one step in a row, and failures of Newton's method in a run."""
RELAXATION = TimeScheme("beuler", "", tolerance=1e-3, prefix="cycle_relaxation_")
RELAXATION_SHARE = 1e-3
"""How long a state is relaxed, in periods."""
MOST_KEPT = 8
"""Integrators kept for the next run on an equal mesh."""


class Ending(IntEnum):
    """How a run ended."""

    reached = 0
    stopped = 1
    left_the_model = 2
    too_many_steps = 3
    failed = 4


@dataclass(frozen=True, slots=True)
class Trajectory:
    """The steps of a run: times in tau2, (steps + 1,), states z, (steps + 1, unknowns), and how it ended."""

    ending: Ending
    times: Array
    states: Array
    message: str = ""


@dataclass(frozen=True, slots=True)
class RunLimit:
    """What ends a run before its time: after a step to z `reached(z)`, or the number of its steps."""

    reached: Callable[[Array], bool] | None = None
    most_steps: int = MOST_TIME_STEPS


UNLIMITED = RunLimit()


class Integrator:
    """One TS for one mesh and scheme; `run` may be called any number of times, for any rod."""

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
        database, prefix = PETSc.Options(), self.scheme.prefix
        ts = PETSc.TS().create(comm=PETSc.COMM_SELF)
        ts.setOptionsPrefix(prefix)
        ts.setProblemType(PETSc.TS.ProblemType.NONLINEAR)
        ts.setMaxStepRejections(MOST_REJECTIONS)
        ts.setMaxSNESFailures(MOST_FAILED_STAGES)
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
            ts.getSNES().getKSP().setFromOptions()  # which a SNES of type shell leaves out
        finally:
            for name in ours:  # what is left is the user's, and recorded as such
                database.delValue(name)
        self.workspace.attach(ts, self.matrix)
        return ts

    def _judge(self, ts: "PETSc.TS") -> None:
        """The post-step where a function given to the run may end it."""
        end_step.ctypes(ts.handle)
        if self._limit.reached is not None and self._limit.reached(self.vector.array_r.copy()):
            ts.setConvergedReason(PETSc.TS.ConvergedReason.CONVERGED_USER)

    def run(
        self, beam: Beam, z: Array, duration: float, step: float = 0.0, limit: RunLimit = UNLIMITED
    ) -> Trajectory:
        """From z, shape (unknowns,), at t = 0 to t = duration, or to the limit; failures are an ending.

        step: the first one, or with equal steps each. Tolerances are in units of the largest component of z,
        so that small motions are followed as well as large ones.
        """
        ts, scheme = self.ts, self.scheme
        self._limit = limit
        size = float(np.abs(z).max()) or 1.0
        self.vector.array_w[:] = z
        ts.setTolerances(rtol=0.0, atol=scheme.tolerance * size)
        self.workspace.prepare(beam, scheme.newton * scheme.tolerance * size, STAGE_ROUND_OFF * size)
        ts.setTime(0.0)
        ts.setStepNumber(0)
        ts.setMaxTime(duration)
        ts.setMaxSteps(limit.most_steps)
        ts.setTimeStep(step or FIRST_SHARE * duration)
        ts.restartStep()
        ts.setConvergedReason(PETSc.TS.ConvergedReason.CONVERGED_ITERATING)
        if limit.reached is None:
            call("TSSetPostStep", ts.handle, end_step.address)
        else:
            ts.setPostStep(self._judge)
        message = ""
        try:
            ts.solve(self.vector)
        except (PETSc.Error, SystemError) as error:
            message = str(error.__cause__ or error).splitlines()[-1]
            self.broken = True  # a PETSc object is not usable after an error inside it
        rows = np.concatenate([[np.append(0.0, z)], take_steps(self.workspace.context)])
        times, states = np.ascontiguousarray(rows[:, 0]), np.ascontiguousarray(rows[:, 1:])
        return Trajectory(self._ending(message, states[-1]), times, states, message)

    def _ending(self, message: str, end: Array) -> Ending:
        reason, reasons = self.ts.getConvergedReason(), PETSc.TS.ConvergedReason
        if message or reason < 0 or not np.isfinite(end).all():
            return Ending.failed
        if self.workspace.context["left"]:
            return Ending.left_the_model
        named = {reasons.CONVERGED_TIME: Ending.reached, reasons.CONVERGED_USER: Ending.stopped}
        return named.get(reason, Ending.too_many_steps)

    def destroy(self) -> None:
        """Gives the PETSc objects back: the TS refers to this object and this to the TS."""
        for held in (self.ts, self.workspace, self.matrix, self.vector):
            held.destroy()


_kept: Kept[tuple[Mesh, TimeScheme], Integrator] = Kept(lambda key: Integrator(*key), MOST_KEPT)


def integrator(mesh: Mesh, scheme: TimeScheme) -> Integrator:
    """The integrator for a mesh and a scheme, kept for the next point."""
    key = mesh, scheme
    if _kept.get(key).broken:
        _kept.drop(key)
    return _kept.get(key)


def forget_integrators() -> None:
    """Drops every kept integrator, after an error, or so that the next one hears of new options."""
    _kept.clear()


def relaxed(beam: Beam, z: Array, period: float) -> Array:
    """z, (unknowns,), after a thousandth of a period, its fast components decayed; z itself where that fails.

    A state that no run led to, as one scaled or interpolated, has rates of 1e10/tau2 in the components that
    k1, k2 and 1/gamma3 make fast. The first, explicit stage of ARKIMEX does not damp them, at no step length;
    backward Euler does within ten steps.
    """
    run = integrator(beam.mesh, RELAXATION).run(beam, z, RELAXATION_SHARE * period, period / 1e5)
    return run.states[-1] if run.ending == Ending.reached else z
