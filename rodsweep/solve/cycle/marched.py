"""The limit cycle of one rod by time integration alone: ARKIMEX marches until the motion repeats.

Neither collocation nor D takes part, and no Floquet multiplier is known: that the motion settles shows that
the cycle is stable in the plane. Period and extrema are those of the motion, twice: the second time on a
finer mesh with a smaller tolerance. What the two differ by is the error. Near a Hopf point, where motions
settle slowly, the periods allowed may not be enough.
"""

from collections import deque
from dataclasses import dataclass, replace
from math import isnan, nan

import numpy as np
from scipy.interpolate import CubicSpline

from ...arrays import Array
from ...discretization.beam import Beam
from ...discretization.elements.mesh import mesh
from ...discretization.stress.form import StressForm
from ...model.parameters import PARAMETERS
from ...model.rod import Rod
from ...watch import Whereabouts, report
from ..motion.integrator import Ending, RunLimit, Trajectory, forget_integrators, integrator, relaxed
from ..motion.leading_mode import leading_mode
from ..motion.time_scheme import TimeScheme
from ..orbit.measures import CyclePath, measures_of
from ..orbit.orbit import Orbit, node_times
from ..orbit.symmetry import NONE
from ..point import solved
from .accuracy.cycle_errors import CycleErrors
from .cycle import Cycle, CycleRequest, measured
from .status import MarchedStatus
from .transient.from_motion import stressed
from .transient.returns import (
    LONGEST_ORBIT,
    STRAIGHT_SIZE,
    angle_weights,
    repetition,
    section_crossings,
    trouble,
    until_returns,
)
from .transient.stepped_rod import motion_resolution, near_rod

TOLERANCE = 0.01
"""Local tolerance of the integrator in units of the accuracy: errors of cycles are up to ten times it."""
TIGHTER, MORE_ORDERS = 0.2, 2
"""Tolerance of the second integration in units of the first's, and orders that its mesh has more."""
MOST_PAIRS = 3
"""Pairs of integrations, each with the smaller tolerance of the one before as its larger one."""
SETTLED = 0.1
"""What is left of the way to the cycle when a motion has settled, relative, in units of the accuracy."""
NOISE = 10.0
"""Distance of two returns, in units of the tolerance, that may be the integrator's error."""
CHUNK = 5
"""Returns of the tip from one judgement to the next."""
SAFETY = 2.0
"""Factor on what two integrations differ by."""
FARTHER = 2.0
"""A rod in a limit is replaced by one near it. The cycle of a rod so many times as far from the limit differs
from its cycle as that differs from the limit's, for cycles change in proportion."""
STAGES, INTERVALS = 3, 48
"""Of the orbit that is measured: times at which the motion is interpolated, for each return of the tip."""


@dataclass(frozen=True, eq=False)
class _Settled:
    """Where the motion is when it has settled: z, (unknowns,), and returns of the tip in a period."""

    z: Array
    turns: int
    step: float


class _Ended(Exception):
    """The motion ends otherwise than on a cycle."""

    def __init__(self, status: MarchedStatus, why: str) -> None:
        super().__init__(why)
        self.status, self.why = status, why


def solve_by_integration(rod: Rod, request: CycleRequest) -> Cycle:
    """The cycle that the rod reaches from its leading mode; failures are a status, never an exception."""

    def failed(cause: str) -> Cycle:
        forget_integrators()  # a PETSc object is not usable after an error inside it
        return Cycle(status=MarchedStatus.failed, message=cause)

    return solved(lambda: _Marching(rod, request).cycle(), failed)


class _Marching:
    """The motion of one rod, on one mesh after the other."""

    def __init__(self, rod: Rod, request: CycleRequest) -> None:
        self.request, self.limit, self.rod = request, rod, near_rod(rod)
        self.resolution = motion_resolution(rod, request.accuracy)
        self.scheme = TimeScheme("arkimex", "5", tolerance=TOLERANCE * request.accuracy)
        self.beam = self._beam()
        self.mode = leading_mode(self.beam)
        self.waited = 0

    def cycle(self) -> Cycle:
        """The outcome."""
        known = Cycle(
            status=MarchedStatus.straight,
            linear_growth_rate=self.mode.w.real,
            linear_frequency=abs(self.mode.w.imag),
        )
        try:
            z = relaxed(self.beam, self.request.amplitude * self.mode.z.real, self.mode.period)
            settled = self._settled(z)
            path = self._path(settled)
            for _ in range(MOST_PAIRS):
                settled = self._refined(settled)
                before, path = path, self._path(settled)
                errors = _errors(before, path, SETTLED * self.request.accuracy)
                if errors.largest <= self.request.accuracy:
                    break
            if self.rod != self.limit:
                errors = self._errors_of_the_limit(settled, path, errors)
        except _Ended as end:
            return replace(known, status=end.status, message=end.why, periods=self.waited)
        return self._measured(known, path, errors)

    def _beam(self) -> Beam:
        return Beam(self.rod, mesh(self.resolution.elements, self.resolution.order))

    def _refined(self, settled: _Settled) -> _Settled:
        """The same motion on a finer mesh with a smaller tolerance, from where it has settled."""
        before = self.beam
        self.resolution = replace(self.resolution, order=self.resolution.order + MORE_ORDERS)
        self.scheme = replace(self.scheme, tolerance=TIGHTER * self.scheme.tolerance)
        self.beam = self._beam()
        stresses = before.stresses(settled.z) @ before.mesh.evaluation(self.beam.mesh.positions).T
        z = self.beam.scaled(stresses)
        return self._settled(relaxed(self.beam, z, self.mode.period))

    def _settled(self, z: Array) -> _Settled:
        """Where the motion from z, (unknowns,), has settled; raises _Ended."""
        past: deque[Array] = deque(maxlen=LONGEST_ORBIT + 1)
        row, step = angle_weights(self.beam), self.mode.period / 1000
        last, rate, most = nan, 0.0, self.request.most_periods
        while self.waited < most:
            report(lambda: Whereabouts(f"{self.waited} of at most {most} returns of the tip"))
            run = self._run(z, 3 * CHUNK * self.mode.period, step, until_returns(row, z, CHUNK))
            z, step = run.states[-1], float(run.times[-1] - run.times[-2])
            states = self._crossings(run)[1]
            past.extend(self.beam.layout.field(states, "m3"))
            self.waited += max(len(states), 1)
            if self.mode.w.real < 0 and np.linalg.norm(z) < STRAIGHT_SIZE:
                raise _Ended(MarchedStatus.straight, "decayed to rounding")
            if len(past) <= CHUNK:
                continue
            turns, distance = repetition(list(past))
            noise = NOISE * self.scheme.tolerance
            if last > noise:
                rate = min(max(distance, noise) / last, 1.0) ** (turns / CHUNK)
            elif isnan(last):
                rate = 0.0 if distance <= noise else 1.0
            last = distance
            if distance <= SETTLED * self.request.accuracy * (1 - rate):
                return _Settled(z, turns, step)
        why = f"{self.waited} returns of the tip, the last at a relative distance of {last:.1e}"
        raise _Ended(MarchedStatus.not_settled, why)

    def _run(self, z: Array, duration: float, step: float, limit: RunLimit) -> Trajectory:
        """A run that comes to its end; raises _Ended where it does not."""
        run = integrator(self.beam.mesh, self.scheme).run(self.beam, z, duration, step, limit)
        if why := trouble(self.beam, run, self.waited):
            left = run.ending == Ending.left_the_model
            raise _Ended(MarchedStatus.left_the_model if left else MarchedStatus.failed, why)
        return run

    def _crossings(self, run: Trajectory) -> tuple[Array, Array]:
        """Times, (k,), and states, (k, unknowns), at which theta of the tip rises through 0 on a run.

        Between two steps the cubic through them is less accurate than the steps, so each crossing is marched
        to from the step before it.
        """
        row, times = angle_weights(self.beam), section_crossings(self.beam, run)[0]
        states = np.empty((len(times), self.beam.unknowns))
        for i, rough in enumerate(times):
            before = int(np.searchsorted(run.times, rough, side="right")) - 1
            left = float(rough - run.times[before])
            z = run.states[before]
            if left > 0:
                z = self._run(z, left, left, RunLimit()).states[-1]
            rates = self.beam.rate(z[None])[0]
            late = float(row @ z) / float(row @ rates)
            times[i], states[i] = rough - late, z - late * rates
        return times, states

    def _path(self, settled: _Settled) -> CyclePath:
        """One period of the settled motion; raises _Ended."""
        returns = settled.turns + 2
        limit = until_returns(angle_weights(self.beam), settled.z, returns)
        run = self._run(settled.z, 3 * returns * self.mode.period, settled.step, limit)
        times = self._crossings(run)[0]
        if len(times) <= settled.turns:
            raise _Ended(MarchedStatus.not_settled, f"the tip does not return after {self.waited} returns")
        period = float(times[settled.turns] - times[0])
        spline = CubicSpline(run.times, run.states)
        states = spline(times[0] + period * node_times(INTERVALS * settled.turns, STAGES))
        form = StressForm(self.rod, self.beam.mesh)
        return CyclePath(Orbit.of(form, NONE, period, stressed(self.beam, form, states), STAGES))

    def _errors_of_the_limit(self, settled: _Settled, path: CyclePath, errors: CycleErrors) -> CycleErrors:
        """The errors with what the rod is off by that stands for a limit; raises _Ended."""
        known, limit = path.orbit.form.rod, self.limit
        in_limits = [name for name in PARAMETERS if known.values[name] != limit.values[name]]
        coordinates = {name: FARTHER * known.coordinate(name) for name in in_limits}
        self.rod = limit.changed(**{n: PARAMETERS[n].value(c) for n, c in coordinates.items()})
        self.beam = self._beam()
        more = _errors(path, self._path(self._settled(relaxed(self.beam, settled.z, self.mode.period))), 0.0)
        return CycleErrors(
            errors.period_error + more.period_error,
            errors.amplitude_error + more.amplitude_error,
            errors.extrema_error + more.extrema_error,
            nan,
        )

    def _measured(self, known: Cycle, path: CyclePath, errors: CycleErrors) -> Cycle:
        """The cycle with its numbers."""
        enough = errors.largest <= self.request.accuracy
        cycle = replace(
            known,
            status=MarchedStatus.cycle if enough else MarchedStatus.not_settled,
            message="" if enough else f"its errors are up to {errors.largest:.1e}",
            periods=self.waited,
        )
        return measured(cycle, self.request, path, measures_of(path), errors)


def _errors(one: CyclePath, other: CyclePath, share: float) -> CycleErrors:
    """Errors by what two integrations differ by, and a further share of each."""
    a, b = one.extrema, other.extrema
    size = abs(b["tip_y_max"])
    period = abs(one.orbit.period / other.orbit.period - 1)
    height = abs(a["tip_y_max"] - b["tip_y_max"]) / size
    worst = max(abs(a[name] - b[name]) for name in a) / size
    period, height, worst = (float(SAFETY * apart + share) for apart in (period, height, worst))
    return CycleErrors(period, height, worst, nan)
