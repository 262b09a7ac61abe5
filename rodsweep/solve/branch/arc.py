"""Along a branch of cycles: from one to the next by a step of some length.

The cubic through two cycles and their tangents predicts, Newton's method corrects with the length of the arc
held (`bordered`). Steps are as long as the prediction is good and the branch bends little.
"""

from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from ...arrays import Array, Complex
from ..continuation.follower import StepControl, Stepped, advance
from ..cycle.accuracy.refinement import RefinedCycle, judged_by, matrix_distance, newton_tolerance
from ..cycle.along_parameter import carried
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.newton import Converged, multiplier_change, relative_change
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import mesh_of
from .bordered import BorderedMatrix, Condition, Scale, bordered, moment_of, moved
from .errors import BranchCalibration, Place

STEPS = StepControl(
    first=0.02,
    longest=0.25,
    shortest=5e-6,
    aim=5e-4,
    far=0.1,
    order=4,
    sharpest=0.45,
    growth=2.0,
)
"""Lengths in units of the scale: one of 0.1 changes the moment at the clamp, the period or the parameter by a
tenth, at most."""


@dataclass(frozen=True, eq=False)
class Passed:
    """An orbit of a branch, and its derivative along it in any unit, (N + 1,)."""

    orbit: Orbit
    tangent: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class ArcPoint:
    """A cycle of a branch. length: of the next step; before: the cycle before it; calibration: the errors,
    measured at this cycle if unmeasured is 0, else at the one so many cycles before it; way: length of the
    branch since then."""

    cycle: RefinedCycle
    place: Place
    length: float
    calibration: BranchCalibration
    unmeasured: int = 0
    way: float = 0.0
    before: Passed | None = None

    @property
    def scale(self) -> Scale:
        return self.place.scale

    @property
    def tangent(self) -> Array:
        """The place's, (N + 1,)."""
        return self.place.tangent

    @property
    def ahead(self) -> Array:
        """The place's, (3,)."""
        return self.place.ahead

    @property
    def orbit(self) -> Orbit:
        return self.cycle.orbit

    @property
    def workspace(self) -> NewtonWorkspace:
        """The solver's, in which the cycle's matrix was made."""
        return self.cycle.fine.workspace

    @property
    def at(self) -> float:
        """The parameter's coordinate."""
        return self.orbit.form.rod.coordinate(self.scale.name)

    @property
    def rises(self) -> float:
        """How fast the parameter's coordinate grows along the branch, of either sign; 0 at a fold."""
        return self.place.rate

    @property
    def moment(self) -> float:
        """At the clamp at t = 0."""
        return moment_of(self.orbit)

    @cached_property
    def returns(self) -> Complex:
        """Multipliers of half a period and the reflection, (rank - 1,), without the trivial one."""
        values = bordered(self.cycle.fine).returns
        return np.delete(values, int(np.argmin(np.abs(values - 1))))

    def condition(self, length: float) -> Condition:
        """What holds at a length ahead."""
        return Condition.at(self.scale, self.ahead, self.orbit, length)

    def predicted(self, length: float) -> Orbit:
        """What the cubic through this cycle and the one before predicts; raises Unsolvable."""
        change = length * self.tangent
        if self.before is not None:
            change = length ** np.arange(1, 4) @ self._taylor(self.before)
        return moved(self.orbit, self.scale.name, change)

    def _taylor(self, before: Passed) -> Array:
        """Coefficients of the cubic in the length, from the first, (3, N + 1)."""
        name, mesh = self.scale.name, mesh_of(self.orbit)
        last = mesh.carry(before.orbit)
        there = last.form.rod.coordinate(name)
        slope = np.append(carried(before.orbit, before.tangent[:-1], mesh), before.tangent[-1])
        step = float(self.ahead @ (self.scale.place(self.orbit) - self.scale.place(last)))
        rate = float(self.ahead @ self.scale.moved(last, slope))
        if not (step > 0 and rate > 0):
            return np.array([self.tangent, 0 * slope, 0 * slope])
        apart = np.append(last.values - self.orbit.values, there - self.at)
        A = (apart + step * self.tangent) * step**-2
        B = (self.tangent - slope / rate) * (0.5 / step)
        return np.array([self.tangent, 3 * A - 2 * B, (A - B) * (2 / step)])


def placed(found: Converged, scale: Scale, tangent: Array) -> Place:
    """Where a cycle stands on its branch, with its tangent, (N + 1,), of any length."""
    own = Scale.of(found.orbit, scale.name, scale.least)
    ahead = own.moved(found.orbit, tangent)
    unit = float(np.linalg.norm(ahead))
    return Place(own, tangent / unit, ahead / unit, 0.0, 0.0)


def tangent_at(orbit: Orbit, scale: Scale, side: Array, matrix: BorderedMatrix) -> Array:
    """The tangent of the branch at an orbit on a side, (3,), by its matrix, (N + 1,)."""
    tangent = matrix.direction(side)
    return tangent if scale.moved(orbit, tangent) @ side > 0 else -tangent


def next_point(here: ArcPoint, accuracy: float) -> ArcPoint:
    """The next point of a branch; raises Unsolvable where there is none."""
    there, length = advance(partial(_stepped, here, accuracy), here.length, STEPS)
    return replace(there.solution, length=STEPS.next_length(length, there, STEPS.order))


def point_at(here: ArcPoint, length: float, accuracy: float) -> ArcPoint:
    """The point at some length of the arc from another one; raises Unsolvable where it is no step from it."""
    return STEPS.accepted(_stepped(here, accuracy, length)).solution


def _stepped(here: ArcPoint, accuracy: float, length: float) -> Stepped[ArcPoint]:
    """The point at some length of the arc from another one, with a step as long behind it.

    Raises Unsolvable.
    """
    condition, predicted = here.condition(length), here.predicted(length)
    tolerance, distance = newton_tolerance(accuracy), matrix_distance(accuracy)
    found = condition.solved(predicted, tolerance, here.workspace, distance)
    off = relative_change(predicted, found.orbit.values - predicted.values)
    if here.before is None and off <= STEPS.far:
        off = STEPS.aim  # a tangent alone does not tell how good a cubic would be
    tangent = tangent_at(found.orbit, here.scale, here.ahead, bordered(found))
    cosine = float(here.scale.moved(found.orbit, tangent) @ here.ahead)  # both are of unit length
    return Stepped(there_from(here, found, tangent, length, length, accuracy), off, cosine)


def arc_between(here: ArcPoint, there: ArcPoint) -> float:
    """The length from one cycle to another one, as steps have it."""
    return float(here.ahead @ (here.scale.place(there.orbit) - here.scale.place(here.orbit)))


def there_from(
    here: ArcPoint, found: Converged, tangent: Array, length: float, ahead: float, accuracy: float
) -> ArcPoint:
    """A cycle at a length from another one, its errors not measured.

    tangent: of the branch there, (N + 1,); ahead: length of the next step.
    """
    cycle = judged_by(here.calibration.known, found, accuracy)
    place = placed(found, here.scale, tangent)
    curvature = (place.rate - here.rises) / length
    changed = multiplier_change(cycle.multipliers, here.cycle.multipliers) / length
    return ArcPoint(
        cycle=cycle,
        place=replace(place, curvature=curvature, multiplier_rate=changed),
        length=ahead,
        calibration=here.calibration,
        unmeasured=here.unmeasured + 1,
        way=here.way + length,
        before=Passed(here.orbit, here.tangent),
    )
