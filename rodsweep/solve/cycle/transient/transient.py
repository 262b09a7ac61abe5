"""From a start to the neighbourhood of a cycle, or to the straight rod: before Newton's method takes over.

The motion is followed from return to return, theta of the tip rising through 0. Two returns that agree to a
tenth go to Newton's method. Slow motions about the straight rod are not waited for. Per period they grow by
g = g0 - c a^2 at amplitude a, with the exact linear growth g0, so that a cycle lies at a*^2 = g0/c and the
state is scaled to it; c is measured where it shows in g, which near a* may be lost in the integrator's error.
The linear growth of a rod near a limit differs from that of the limit: what is measured is corrected by the
difference. What decays slowly is scaled down until it decays at the linear rate; what grows slowly, and the
faster the larger it is (c < 0), is scaled up. A motion whose path is stored is never scaled, but waited for.

A rod that is unstable when straight does not stay straight. Where its swinging dies out nevertheless, as it
does while a large stretch relaxes slowly, it starts again from a small deflection in its leading mode.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isnan, nan
from operator import mul

import numpy as np

from ....arrays import Array
from ....discretization.beam import Beam
from ....discretization.stress_form import StressForm
from ....watch import Whereabouts, report
from ...motion.integrator import RELAXATION_SHARE, Ending, RunLimit, Trajectory, integrator, relaxed
from ...motion.leading_mode import leading_mode
from ...motion.time_scheme import TimeScheme
from ...point import Unsolvable
from ..accuracy.refinement import RefinedCycle, refined_cycle
from ..status import CycleStatus
from ..straight_rod import StraightRod, straight_rod
from .from_motion import orbit_from_motion
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
SLOW_GROWTH = 0.2
"""Linear growth per period below which an amplitude is predicted rather than waited for."""
FAINT = 0.01
"""Linear growth per period below which the integration is a careful one."""
NOISE, CAREFUL_NOISE = 1e-3, 1e-5
"""Growth per period that the integrator may add: 3e-4 and 8e-6 were seen."""
WELL_SHOWN = 10.0
"""What c must show in the growth, in units of that noise, to replace the c of a larger motion: a tenth of it
is noise then. In the noise itself c changes its sign."""
NEAR = 0.1
"""Relative distance from the predicted amplitude that is left to Newton's method."""
MOST_JUMPS, SHRINK, LARGEST_JUMP = 60, 0.7, 4.0
"""Jumps; the factor for what decays slowly (its inverse for what grows so), near enough to 1 to meet a cycle
on the way; the largest."""
LINEAR = 0.05
"""Relative distance from the linear decay rate and frequency at which a decaying rod is called straight."""
STRAIGHT_SIZE = 1e-6
"""Norm of z at which a rod that is stable when straight is called straight; of its part that bends and
shears, at which the rod no longer swings: numerical damping, not the rod, rules what is smaller."""
DEPARTURE = 1e-3
"""Tip deflection, in L, with which an unstable straight rod is left: the square of it is the relative change
of the linear growth."""
SAME_CROSSING = 0.03
"""Relative distance of two returns that are one and the same crossing of the orbit."""
LONGEST_ORBIT = 8
"""Returns to the section that one period may take."""
NEUTRAL = 3e-8
"""Distance of the largest multiplier from 1 below which a closed orbit says nothing of its amplitude."""
MOST_RETURNS = 400
"""That are kept, of which a torus is known."""
STEPS_PER_CHUNK = 20_000
CROSSING_BISECTIONS = 50


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


def angle_weights(beam: Beam) -> Array:
    """The row c, shape (unknowns,), with c z = theta of the tip."""
    return beam.layout.row({"m3": beam.mesh.quadrature[:-1]})


def hermite_weights(x: float) -> tuple[float, float, float, float]:
    """Of values and slopes at 0 and 1, (4,), in the value of their cubic at x."""
    rest = 1 - x
    return rest * rest * (1 + 2 * x), x * x * (3 - 2 * x), x * rest * rest, -x * x * rest


def section_crossings(beam: Beam, run: Trajectory) -> tuple[Array, Array]:
    """Times, (k,), and states, (k, unknowns), at which theta of the tip rises through 0 between steps."""
    row = angle_weights(beam)
    angle = run.states @ row
    times: list[float] = []
    states: list[Array] = []
    for k in np.nonzero((angle[:-1] < 0) & (angle[1:] >= 0))[0]:
        h, ends = run.times[k + 1] - run.times[k], run.states[k : k + 2]
        cubic = np.concatenate((ends, h * beam.rate(ends)))
        angles = (cubic @ row).tolist()
        low, high = 0.0, 1.0
        for _ in range(CROSSING_BISECTIONS):
            middle = (low + high) / 2
            below = sum(map(mul, hermite_weights(middle), angles)) < 0
            low, high = (middle, high) if below else (low, middle)
        times.append(run.times[k] + h * low)
        states.append(np.array(hermite_weights(low)) @ cubic)
    return np.array(times), np.array(states).reshape(len(times), beam.layout.unknowns)


class Transient:
    """The motion of one rod from a start; `follow` is called once.

    beam: the rod as the time stepper sees it, form: the rod whose cycle is wanted; they differ in a limit
    only, which the time stepper comes near. straight: the stability of that rod when straight. along: the
    parameter along which the cycle's tangent is wanted. unstable: a cycle near by that is unstable.
    traced: whether `trace` is to hold the tip's path; without it that is None.
    """

    def __init__(  # noqa: PLR0913 - one motion and what is asked of it
        self,
        beam: Beam,
        form: StressForm,
        straight: StraightRod,
        accuracy: float,
        most_periods: int,
        along: str | None = None,
        *,
        traced: bool = False,
        unstable: RefinedCycle | None = None,
    ) -> None:
        self.beam, self.form, self.along = beam, form, along
        self.accuracy, self.most_periods = accuracy, most_periods
        self.mode, self.row = leading_mode(beam), angle_weights(beam)
        self.straight, self.linear_rate = straight, straight.growth_rate(self.mode.w.real)
        self.excess = self.linear_rate - self._rate_of_the_beam()
        """What the linear growth rate of the rod has more than that of the beam."""
        self.faint = abs(self.linear_rate) * self.mode.period < FAINT
        careful = self.faint or traced
        self.scheme, self.noise = (CAREFUL, CAREFUL_NOISE) if careful else (TRANSIENT, NOISE)
        grows_fast = self.linear_rate * self.mode.period > SLOW_GROWTH
        self.first_scheme = QUICK if grows_fast and not careful else self.scheme
        self.trace = TipTrace(beam) if traced else None
        self.bend = nan
        """c in g = g0 - c |z|^2, once it has shown."""
        self.step = self.mode.period / 1000
        """With which the next chunk begins."""
        self.past: deque[tuple[float, Array]] = deque(maxlen=MOST_RETURNS)
        """Times and bending moments of the last returns of one motion."""
        self.clock = 0.0
        self.last_run: Trajectory | None = None
        self.unstable = unstable
        self.waited = self.jumps = self.attempts = self.next_attempt = 0

    def follow(self, z: Array) -> TransientOutcome:
        """Where the rod goes from z, shape (unknowns,)."""
        z, first = self._relaxed(z), True
        while self.waited < self.most_periods:
            report(lambda: Whereabouts(f"{self.waited} of at most {self.most_periods} returns of the tip"))
            returns, scheme = (FIRST_CHUNK, self.first_scheme) if first else (CHUNK, self.scheme)
            run = self._chunk(z, returns, scheme)
            if self.trace:
                self.trace.add(run, self.clock)
            if run.ending not in (Ending.reached, Ending.stopped):
                return self._broken(run)
            z, (times, states) = run.states[-1], section_crossings(self.beam, run)
            self.waited += max(len(times), 1)
            moments = self.beam.layout.field(states, "m3")
            self.past.extend(zip(map(float, self.clock + times), moments, strict=True))
            self.clock += run.times[-1]
            if self.straight.stable is not False and np.linalg.norm(z) < STRAIGHT_SIZE:
                return self._ended(CycleStatus.straight, "decayed to rounding")
            if self.straight.stable is False and not self._swings(z):
                if self.trace or self.jumps >= MOST_JUMPS:
                    break
                z = self._jumped(DEPARTURE * self.mode.z.real)
                continue
            early, first = first, False
            if len(times) < 3 or (early and self._slow(times, *self._growth(times, states))):
                continue
            if not early and self._decays(times, states):
                return self._ended(CycleStatus.straight, "decays at the rate of the leading mode")
            factor = None if early else self._jump(times, states)
            if factor is not None and self.trace:
                continue  # a path that is stored has no jumps
            if factor is not None:
                scaled = factor * z
                pull = self.beam.layout.field(scaled, "n1")
                pull *= factor  # the stretch is quadratic in the deflection
                z = self._jumped(scaled)
                continue
            outcome = self._closed(z, times, states)
            if outcome is not None:
                return outcome
        return self._ended(CycleStatus.not_settled, self._not_settled(z))

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

    def _rate_of_the_beam(self) -> float:
        """Its linear growth rate, 1/tau2, by its spectrum.

        The mesh has it to 1e-10 per period; the eigenvalues of its matrix have rounding, 1e-4 for stiff rods.
        """
        if self.beam.rod == self.form.rod:
            return self.linear_rate
        return straight_rod(self.beam.rod, self.straight.w).growth_rate(self.linear_rate)

    def _relaxed(self, z: Array) -> Array:
        """What the start relaxes to, in a time that a stored path counts."""
        after = relaxed(self.beam, z, self.mode.period)
        if self.trace:
            self.clock = RELAXATION_SHARE * self.mode.period
            self.trace.begin(z, after, self.clock)
        return after

    def _ended(self, status: CycleStatus, why: str, found: RefinedCycle | None = None) -> TransientOutcome:
        return TransientOutcome(status, why, self.waited, found)

    def _broken(self, run: Trajectory) -> TransientOutcome:
        if run.ending == Ending.left_the_model:
            least = self.beam.least_stretch(run.states[-1])
            where = f"h1 = {least:.3g} somewhere, {self.waited} returns from the start"
            return self._ended(CycleStatus.left_the_model, where)
        why = run.message or ("too many steps" if run.ending == Ending.too_many_steps else "no step succeeds")
        return self._ended(CycleStatus.failed, why)

    def _chunk(self, z: Array, returns: int, scheme: TimeScheme) -> Trajectory:
        """A run of so many returns, or of three times the time they should take."""
        count, last = 0, float(self.row @ z)

        def enough(state: Array) -> bool:
            nonlocal count, last
            here = float(self.row @ state)
            count, last = count + int(last < 0 <= here), here
            return count >= returns

        period = self.mode.period
        stepper = integrator(self.beam.mesh, scheme)
        limit = RunLimit(enough, STEPS_PER_CHUNK)
        run = stepper.run(self.beam, z, 3 * returns * period, self.step, limit)
        if len(run.times) > 2:
            self.step = run.times[-1] - run.times[-2]
        self.last_run = run
        return run

    def _growth(self, times: Array, states: Array) -> tuple[float, float]:
        """(growth of |z| over the last return, that of the leading mode), of the rod and not of the mesh."""
        sizes, duration = np.linalg.norm(states[-2:], axis=1), float(times[-1] - times[-2])
        growth = float(np.log(sizes[1] / sizes[0]))
        return growth + self.excess * duration, self.linear_rate * duration

    def _decays(self, times: Array, states: Array) -> bool:
        """Whether the returns shrink steadily, at last as the leading mode does, or would but for noise."""
        growth, linear = self._growth(times, states)
        sizes, margin = np.linalg.norm(states, axis=1), LINEAR * abs(linear)
        falls = np.diff(np.log(sizes)) + self.excess * np.diff(times) < 0
        alike = bool(falls.all()) and abs(growth - linear) < margin
        faded = abs(self.bend) * sizes[-1] ** 2 < margin and growth - linear < margin + self.noise
        return linear < 0 and (alike or faded) and self._in_time(times)

    def _in_time(self, times: Array) -> bool:
        """Whether the tip returns as the leading mode does: elsewhere its growth predicts nothing."""
        return bool(abs((times[-1] - times[-2]) / self.mode.period - 1) < LINEAR)

    def _slow(self, times: Array, growth: float, linear: float) -> bool:
        """Whether the motion is a slowly growing or decaying leading mode."""
        return max(abs(linear), abs(growth)) <= SLOW_GROWTH and self._in_time(times)

    def _jump(self, times: Array, states: Array) -> float | None:
        """The factor to where the growth should vanish, or towards it; None if that is here, or not known."""
        growth, linear = self._growth(times, states)
        if not self._slow(times, growth, linear) or self.jumps >= MOST_JUMPS:
            return None
        size = float(np.linalg.norm(states[-1]))
        here = (linear - growth) / size**2
        if abs(linear - growth) > self.noise * (1 if isnan(self.bend) else WELL_SHOWN):
            self.bend = here
        bend = here if isnan(self.bend) else self.bend
        if isnan(self.bend) and linear > 0:
            factor = LARGEST_JUMP  # too small to feel what bends its growth
        elif linear > 0 and bend > 0:
            factor = float(np.clip(np.sqrt(linear / bend) / size, 1 / LARGEST_JUMP, LARGEST_JUMP))
        elif linear > 0 or (bend < 0 and growth > self.noise):
            factor = 1 / SHRINK  # it grows the faster the larger it is
        elif bend > 0 or growth < -self.noise:
            factor = SHRINK
        else:
            return None
        return factor if abs(factor - 1) >= NEAR else None

    def _closed(self, z: Array, times: Array, states: Array) -> TransientOutcome | None:
        """The cycle, if the returns repeat and Newton's method finds it from z, the end of the run."""
        growth, linear = self._growth(times, states)
        turns, distance = repetition([state for _, state in self.past][-1 - LONGEST_ORBIT :])
        known = self.bend > 0 and self._slow(times, growth, linear)
        decays = linear < 0 and growth < linear * (1 - SLOW_GROWTH) + (self.noise if known else 0)
        if decays or distance >= self._near_enough() or self.waited < self.next_attempt:
            return None
        self.next_attempt = self.waited + CHUNK * 2**self.attempts
        self.attempts = min(self.attempts + 1, MOST_NEWTON_FAILURES)
        found = self._cycle_near(z, self.past[-1][0] - self.past[-1 - turns][0], turns)
        return None if found is None else self._ended(*found.verdict(self.accuracy), found)

    def _near_enough(self) -> float:
        """The distance of two returns below which Newton's method is tried."""
        distance = NEWTON_DISTANCE / 10**self.attempts
        settles = self.trace and self.waited < self.most_periods // 2
        return min(distance, SHOWN_DISTANCE) if settles else distance

    def _cycle_near(self, z: Array, period: float, turns: int) -> RefinedCycle | None:
        """The stable cycle of the motion that has come to z, by Newton's method; None where there is none."""
        run = self.last_run
        if run is None or run.times[-1] < period:
            run = integrator(self.beam.mesh, self.scheme).run(self.beam, z, period, self.step)
            if run.ending != Ending.reached:
                return None
        orbit = orbit_from_motion(self.beam, self.form, run, period, turns)
        try:
            found = refined_cycle(orbit, self.accuracy, self.along)
        except Unsolvable:
            return None
        if found.stable is False:
            self.unstable = found
        return found if found.stable and 1 - found.largest_multiplier >= NEUTRAL else None


def repetition(moments: Sequence[Array]) -> tuple[int, float]:
    """(m, relative distance): after how many returns the last of some states comes closest to itself.

    moments: the bending moments at returns of the tip, (nodes,) each. What the interpolation between two
    steps misses of the stiff components, 1e-2 at k1 = 1e7, is no distance.
    """
    size = np.linalg.norm(moments[-1])
    if size < STRAIGHT_SIZE:  # what is left of them is rounding, which repeats nothing
        return 1, inf
    found = [(float(np.linalg.norm(moments[-1] - moments[-1 - m]) / size), m) for m in range(1, len(moments))]
    enough = max(2 * min(found)[0], SAME_CROSSING)
    return next((m, distance) for distance, m in found if distance <= enough)
