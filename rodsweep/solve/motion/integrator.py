"""Time evolution of one rod by PETSc TS: a run from one state, its steps and how it ended.

The default is ARKIMEX of order 5 with everything implicit, chosen by measurement. What makes it fast:
compiled callbacks; stages extrapolated from the last step; Newton's test tied to the step's tolerance; one
Jacobian a step, that of the state expected half-way (at its start it costs a quarter more iterations).
"""

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ...arrays import Array
from ...discretization.beam import Beam, Mesh
from ..backend.petsc import PETSc
from .callbacks import Workspace
from .context import AT_BASE
from .time_scheme import TimeScheme

STAGE_ROUND_OFF = 1e-9
"""Size of a Newton step, relative to the motion, at which stagnation is rounding and not failure."""
FIRST_SHARE = 1e-3
"""First step in units of the duration, where none is given."""
MOST_TIME_STEPS = 100_000
MOST_REJECTIONS, MOST_FAILED_STAGES = 30, 1_000_000
"""Rejections of one step in a row, and failures of Newton's method in a run."""
RELAXATION = TimeScheme("beuler", "", tolerance=1e-3, prefix="cycle_relaxation_")
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
        self.vector = PETSc.Vec().createSeq(mesh.unknowns, comm=PETSc.COMM_SELF)
        self.matrix = PETSc.Mat().createDense((mesh.unknowns, mesh.unknowns), comm=PETSc.COMM_SELF)
        self.matrix.setUp()
        self.matrix.assemble()
        self.ts = self._create()
        self.middle = 0.5 if self.ts.getType() == "arkimex" else 0.0
        self._times: list[float] = []
        self._states: list[Array] = []
        self._left = self.broken = False
        self._limit = UNLIMITED
        self._beam: Beam | None = None

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
        ts.setPreStep(self._start)
        ts.setPostStep(self._record)
        try:
            ts.setFromOptions()
        finally:
            for name in ours:  # what is left is the user's, and recorded as such
                database.delValue(name)
        self.workspace.attach(ts, self.matrix)
        return ts

    def _start(self, ts: "PETSc.TS") -> None:
        """The matrix of the step is that of the state half-way, extrapolated from the last step."""
        base, states, times = self.workspace.base, self._states, self._times
        base[:] = states[-1]
        if len(times) > 1 and self.middle:
            ahead = self.middle * ts.getTimeStep() / (times[-1] - times[-2])
            base += (states[-1] - states[-2]) * ahead
        self.workspace.context["matrix_due"] = AT_BASE

    def _record(self, ts: "PETSc.TS") -> None:
        z = self.vector.array_r.copy()
        self._times.append(ts.getTime())
        self._states.append(z)
        self._left = self._beam is not None and self._beam.least_stretch(z) <= 0
        if self._left or (self._limit.reached is not None and self._limit.reached(z)):
            ts.setConvergedReason(PETSc.TS.ConvergedReason.CONVERGED_USER)

    def run(
        self, beam: Beam, z: Array, duration: float, step: float = 0.0, limit: RunLimit = UNLIMITED
    ) -> Trajectory:
        """From z, shape (unknowns,), at t = 0 to t = duration, or to the limit; failures are an ending.

        step: the first one, or with equal steps each. Tolerances are in units of the largest component of z,
        so that small motions are followed as well as large ones.
        """
        ts, scheme = self.ts, self.scheme
        self._times, self._states, self._left = [0.0], [z.copy()], False
        self._beam, self._limit = beam, limit
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
        message = ""
        try:
            ts.solve(self.vector)
        except (PETSc.Error, SystemError) as error:
            message = str(error.__cause__ or error).splitlines()[-1]
            self.broken = True  # a PETSc object is not usable after an error inside it
        return Trajectory(
            ending=self._ending(message),
            times=np.array(self._times),
            states=np.array(self._states),
            message=message,
        )

    def _ending(self, message: str) -> Ending:
        reason, reasons = self.ts.getConvergedReason(), PETSc.TS.ConvergedReason
        if message or reason < 0 or not np.isfinite(self._states[-1]).all():
            return Ending.failed
        if self._left:
            return Ending.left_the_model
        named = {reasons.CONVERGED_TIME: Ending.reached, reasons.CONVERGED_USER: Ending.stopped}
        return named.get(reason, Ending.too_many_steps)

    def destroy(self) -> None:
        """Gives the PETSc objects back: the TS refers to this object and this to the TS."""
        for held in (self.ts, self.matrix, self.vector):
            held.destroy()


_kept: OrderedDict[tuple[int, int, TimeScheme], Integrator] = OrderedDict()


def integrator(mesh: Mesh, scheme: TimeScheme) -> Integrator:
    """The integrator for a mesh and a scheme, kept for the next point."""
    key = mesh.elements, mesh.order, scheme
    if key in _kept and _kept[key].broken:
        _kept.pop(key).destroy()
    if key not in _kept:
        if len(_kept) >= MOST_KEPT:
            _kept.popitem(last=False)[1].destroy()
        _kept[key] = Integrator(mesh, scheme)
    _kept.move_to_end(key)
    return _kept[key]


def forget_integrators() -> None:
    """Drops every kept integrator, after an error, or so that the next one hears of new options."""
    while _kept:
        _kept.popitem()[1].destroy()


def relaxed(beam: Beam, z: Array, period: float) -> Array:
    """z, (unknowns,), after a thousandth of a period, its fast components decayed; z itself where that fails.

    A state that no run led to, as one scaled or interpolated, has rates of 1e10/tau2 in the components that
    k1, k2 and 1/gamma3 make fast. The first, explicit stage of ARKIMEX does not damp them, at no step length;
    backward Euler does within ten steps.
    """
    run = integrator(beam.mesh, RELAXATION).run(beam, z, period / 1000, period / 1e5)
    return run.states[-1] if run.ending == Ending.reached else z
