"""From a start to the neighbourhood of a cycle, or to the straight rod: before Newton's method takes over.

The motion is followed from return to return (`returns`). Two returns that agree to a tenth go to Newton's
method. Slow motions about the straight rod are not waited for: their state is scaled to where their amplitude
equation predicts them (`amplitude_equation`). A motion whose path is stored is never scaled, but waited for.

A rod that is unstable when straight does not stay straight. Where its swinging dies out nevertheless, as it
does while a large stretch relaxes slowly, it starts again from a small deflection in its leading mode.
"""

from collections import deque
from dataclasses import dataclass

import numpy as np

from ....arrays import Array
from ....discretization.beam import Beam
from ....discretization.stress.form import StressForm
from ....watch import Whereabouts, report
from ...motion.integrator import RELAXATION_SHARE, Ending, Trajectory, integrator, relaxed
from ...motion.leading_mode import leading_mode
from ...motion.time_scheme import TimeScheme
from ...orbit.matrix.workspace import NewtonWorkspace
from ...point import Unsolvable
from ..accuracy.refinement import RefinedCycle, refined_cycle
from ..cycle import CycleRequest
from ..status import CycleStatus
from ..straight_rod import StraightRod, straight_rod
from .amplitude_equation import SLOW_GROWTH, AmplitudeEquation
from .from_motion import orbit_from_motion
from .returns import (
    LONGEST_ORBIT,
    STRAIGHT_SIZE,
    angle_weights,
    repetition,
    section_crossings,
    trouble,
    until_returns,
)
from .stepped_rod import near_rod
from .trace import TipTrace

TRANSIENT = TimeScheme("arkimex", "4", tolerance=1e-5)
"""The way to a cycle needs no accuracy: Newton's method supplies it."""
QUICK = TimeScheme("arkimex", "4", tolerance=1e-4)
"""The first returns of what grows fast: nothing is judged by its growth, and it has mostly closed then."""
CAREFUL = TimeScheme("arkimex", "5", tolerance=1e-9)
"""Where the growth per period is small its sign has to be right, and a path that is stored has to be."""

CHUNK, FIRST_CHUNK = 5, 3
"""Returns to the section per run; then the sequence is judged. After the first run only whether the motion
has closed already, as one does that grows fast."""
NEWTON_DISTANCE = 0.1
"""Relative distance of two returns from which Newton's method starts; a tenth after each failure."""
SHOWN_DISTANCE = 1e-3
"""The same for a path that is stored, in the first half of the wait: it is to show how the motion settles."""
MOST_NEWTON_FAILURES = 5
"""Failures of Newton's method, after each of which twice as many chunks are waited for the next."""
FAINT = 0.01
"""Linear growth per period below which the integration is a careful one."""
NOISE, CAREFUL_NOISE = 1e-3, 1e-5
"""Growth per period that the integrator may add: 3e-4 and 8e-6 were seen."""
MOST_JUMPS = 60
DEPARTURE = 1e-3
"""Tip deflection, in L, with which an unstable straight rod is left: the square of it is the relative change
of the linear growth."""
NEUTRAL = 3e-8
"""Distance of the largest multiplier from 1 below which a closed orbit says nothing of its amplitude."""
MOST_RETURNS = 400
"""That are kept, of which a torus is known."""


@dataclass(frozen=True, eq=False)
class TransientOutcome:
    """What became of the rod, and the cycle if there is one; periods: returns that were waited for.

    around: the unstable cycle that a torus surrounds.
    """

    status: CycleStatus
    message: str
    periods: int
    found: RefinedCycle | None = None
    around: RefinedCycle | None = None


class Transient:
    """The motion of one rod from a start; `follow` is called once.

    form: the rod whose cycle is wanted; beam: the rod as the time stepper sees it, on the same mesh, which
    differs in a limit only. straight: the stability of that rod when straight. along: the
    parameter along which the cycle's tangent is wanted. unstable: a cycle near by that is unstable.
    trace: the tip's path, where the request wants it. workspace: memory of Newton's matrices.
    """

    def __init__(
        self,
        form: StressForm,
        straight: StraightRod,
        request: CycleRequest,
        along: str | None,
        unstable: RefinedCycle | None,
        workspace: NewtonWorkspace,
    ) -> None:
        self.beam, self.form = Beam(near_rod(form.rod), form.mesh), form
        self.straight, self.along, self.workspace = straight, along, workspace
        self.accuracy, self.most_periods = request.accuracy, request.most_periods
        self.trace = TipTrace(self.beam) if request.transient else None
        self.unstable = unstable
        self.mode, self.row = leading_mode(self.beam), angle_weights(self.beam)
        rate, period = straight.growth_rate(self.mode.w.real), self.mode.period
        careful = abs(rate) * period < FAINT or request.transient > 0
        self.scheme, noise = (CAREFUL, CAREFUL_NOISE) if careful else (TRANSIENT, NOISE)
        self.first_scheme = QUICK if rate * period > SLOW_GROWTH and not careful else self.scheme
        self.small = AmplitudeEquation(period, rate, rate - self._rate_of_the_beam(rate), noise)
        self.step = period / 1000
        """With which the next chunk begins."""
        self.past: deque[tuple[float, Array]] = deque(maxlen=MOST_RETURNS)
        """Times and bending moments of the last returns of one motion."""
        self.clock = 0.0
        self.waited = self.jumps = self.failures = self.next_newton = 0

    def follow(self, z: Array) -> TransientOutcome:
        """Where the rod goes from z, shape (unknowns,)."""
        z, first = self._relaxed(z), True
        while self.waited < self.most_periods:
            report(lambda: Whereabouts(f"{self.waited} of at most {self.most_periods} returns of the tip"))
            run = self._chunk(z, first)
            if why := trouble(self.beam, run, self.waited):
                left = run.ending == Ending.left_the_model
                return self._ended(CycleStatus.left_the_model if left else CycleStatus.failed, why)
            z, (times, states) = run.states[-1], section_crossings(self.beam, run)
            self._remember(run, times, states)
            if self.straight.stable is not False and np.linalg.norm(z) < STRAIGHT_SIZE:
                return self._ended(CycleStatus.straight, "decayed to rounding")
            if self.straight.stable is False and not self._swings(z):
                if self.trace or self.jumps >= MOST_JUMPS:
                    break
                z = self._jumped(DEPARTURE * self.mode.z.real)
                continue
            early, first = first, False
            if len(times) < 3 or (early and self.small.slow(times, states)):
                continue
            if not early and self.small.decays_as_linear(times, states):
                return self._ended(CycleStatus.straight, "decays at the rate of the leading mode")
            factor = None if early or self.jumps >= MOST_JUMPS else self.small.jump(times, states)
            if factor is not None and self.trace:
                continue  # a path that is stored has no jumps
            if factor is not None:
                scaled = factor * z
                pull = self.beam.layout.field(scaled, "n1")
                pull *= factor  # the stretch is quadratic in the deflection
                z = self._jumped(scaled)
                continue
            cycle = None if self.small.decays_faster(times, states) else self._closed(run)
            if cycle is not None:
                return self._ended(*cycle.verdict(self.accuracy), cycle)
        return self._ended(CycleStatus.not_settled, self._not_settled(z))

    def _remember(self, run: Trajectory, times: Array, states: Array) -> None:
        """Counts the returns of a run, and keeps their times since the start and their bending moments."""
        self.waited += max(len(times), 1)
        moments = self.beam.layout.field(states, "m3")
        self.past.extend(zip(map(float, self.clock + times), moments, strict=True))
        self.clock += run.times[-1]

    def _jumped(self, z: Array) -> Array:
        """Where the motion goes on from a state that is no state of its own, (unknowns,)."""
        self.jumps += 1
        self.past.clear()
        return relaxed(self.beam, z, self.mode.period)

    def _not_settled(self, z: Array) -> str:
        """Why the motion that has come to z has no end."""
        if self._swings(z):
            return f"{self.waited} returns of the tip, none periodic"
        unstable = self.straight.stable is False
        why = "the straight rod is unstable" if unstable else "its stretch has not relaxed"
        return f"it swings no more after {self.waited} returns, but {why}"

    def _swings(self, z: Array) -> bool:
        """Whether more than rounding bends or shears the rod."""
        return bool(np.linalg.norm(self.beam.layout.transverse(z)) >= STRAIGHT_SIZE)

    def _rate_of_the_beam(self, rate: float) -> float:
        """Its linear growth rate, 1/tau2, by its spectrum; rate: that of the rod whose cycle is wanted.

        The mesh has it to 1e-10 per period; the eigenvalues of its matrix have rounding, 1e-4 for stiff rods.
        """
        if self.beam.rod == self.form.rod:
            return rate
        return straight_rod(self.beam.rod, self.straight.w).growth_rate(rate)

    def _relaxed(self, z: Array) -> Array:
        """What the start relaxes to, in a time that a stored path counts."""
        after = relaxed(self.beam, z, self.mode.period)
        if self.trace:
            self.clock = RELAXATION_SHARE * self.mode.period
            self.trace.begin(z, after, self.clock)
        return after

    def _ended(self, status: CycleStatus, why: str, found: RefinedCycle | None = None) -> TransientOutcome:
        return TransientOutcome(status, why, self.waited, found)

    def _chunk(self, z: Array, first: bool) -> Trajectory:
        """A run of some returns, or of three times the time they should take."""
        returns, scheme = (FIRST_CHUNK, self.first_scheme) if first else (CHUNK, self.scheme)
        limit = until_returns(self.row, z, returns)
        duration = 3 * returns * self.mode.period
        run = integrator(self.beam.mesh, scheme).run(self.beam, z, duration, self.step, limit)
        if len(run.times) > 2:
            self.step = run.times[-1] - run.times[-2]
        if self.trace:
            self.trace.add(run, self.clock)
        return run

    def _closed(self, run: Trajectory) -> RefinedCycle | None:
        """The stable cycle, if the returns repeat and Newton's method finds it from the end of the run."""
        turns, distance = repetition([state for _, state in self.past][-1 - LONGEST_ORBIT :])
        if distance >= self._near_enough() or self.waited < self.next_newton:
            return None
        self.next_newton = self.waited + CHUNK * 2**self.failures
        self.failures = min(self.failures + 1, MOST_NEWTON_FAILURES)
        return self._cycle_near(run, self.past[-1][0] - self.past[-1 - turns][0], turns)

    def _near_enough(self) -> float:
        """The distance of two returns below which Newton's method is tried."""
        distance = NEWTON_DISTANCE / 10**self.failures
        settles = self.trace and self.waited < self.most_periods // 2
        return min(distance, SHOWN_DISTANCE) if settles else distance

    def _cycle_near(self, run: Trajectory, period: float, turns: int) -> RefinedCycle | None:
        """The stable cycle near the end of a run, by Newton's method; None where there is none."""
        if run.times[-1] < period:
            run = integrator(self.beam.mesh, self.scheme).run(self.beam, run.states[-1], period, self.step)
            if run.ending != Ending.reached:
                return None
        orbit = orbit_from_motion(self.beam, self.form, run, period, turns)
        try:
            found = refined_cycle(orbit, self.accuracy, self.workspace, self.along)
        except Unsolvable:
            return None
        if found.stable is False:
            self.unstable = found
        return found if found.stable and 1 - found.largest_multiplier >= NEUTRAL else None
