"""Along a branch of cycles: from one to the next by a step of some length, errors measured, mesh chosen.

The cubic through two cycles and their tangents predicts, Newton's method corrects with the length of the arc
held (`bordered`). Steps are as long as the prediction is good and the branch bends little. Errors are those
of `cycle.calibration`, for cycles that meet the same condition: at a fold those of the same parameter would
say nothing.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...arrays import Array, Complex
from ..cycle.calibration import Calibration, calibrated
from ..cycle.neighbour import carried, coordinate_of
from ..cycle.newton import Converged, relative_change
from ..cycle.orbit import Orbit
from ..cycle.orbit_mesh import finer_mesh, mesh_of
from ..cycle.refinement import RefinedCycle, judged_by, matrix_distance
from ..point import Unsolvable
from .bordered import BorderedMatrix, Condition, Scale, bordered, moment_of, moved

LONGEST, SHORTEST = 0.25, 1e-5
"""Steps in units of the scale."""
STRAIGHT = 0.9
"""Least cosine of the angle between the tangents at the ends of a step."""
GOOD_PREDICTION, FAR = 5e-4, 0.1
"""Relative distance of a cycle from its prediction that the next step is chosen for, and beyond which it may
be of another branch."""
LONGER, SHORTER = 2.0, 0.5
"""By how much a step may differ from the one before."""
MOST_MESHES = 6
CHEAPER = 0.5
"""Cost of another mesh, in units of the present one's, for which it is taken."""
MARGIN = 0.3
"""Share of the accuracy that a mesh is chosen for, so that it serves the cycles that follow."""
CHANGE = 0.3
"""Relative change of a parameter that is as far as an arc of length 1, for a calibration."""


@dataclass(frozen=True, eq=False)
class Passed:
    """An orbit of a branch, and its derivative along it in any unit, (N + 1,)."""

    orbit: Orbit
    tangent: Array


@dataclass(frozen=True, eq=False)
class ArcPoint:
    """A cycle of a branch. tangent: (N + 1,), of unit length in the place's scale; ahead: the same as the
    direction of the place, (3,); length: of the next step; before: the cycle before it."""

    cycle: RefinedCycle
    scale: Scale
    tangent: Array
    ahead: Array
    length: float
    before: Passed | None = None

    @property
    def orbit(self) -> Orbit:
        return self.cycle.orbit

    @property
    def at(self) -> float:
        """The parameter's coordinate."""
        return coordinate_of(self.orbit.form, self.scale.name)

    @property
    def rises(self) -> float:
        """How fast the parameter's coordinate grows along the branch, of either sign; 0 at a fold."""
        return float(self.ahead[2])

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
        there = coordinate_of(last.form, name)
        slope = np.append(carried(before.orbit, before.tangent[:-1], mesh), before.tangent[-1])
        step = float(self.ahead @ (self.scale.place(self.orbit) - self.scale.place(last)))
        rate = float(self.ahead @ self.scale.moved(last, slope))
        if not (step > 0 and rate > 0):
            return np.array([self.tangent, 0 * slope, 0 * slope])
        apart = np.append(last.values - self.orbit.values, there - self.at)
        A = (apart + step * self.tangent) * step**-2
        B = (self.tangent - slope / rate) * (0.5 / step)
        return np.array([self.tangent, 3 * A - 2 * B, (A - B) * (2 / step)])


def arc_point(
    cycle: RefinedCycle, scale: Scale, tangent: Array, length: float, before: Passed | None = None
) -> ArcPoint:
    """A cycle with the tangent of its branch, (N + 1,), of any length, and the length of the next step."""
    own = Scale.of(cycle.orbit, scale.name, scale.least)
    ahead = own.moved(cycle.orbit, tangent)
    unit = np.linalg.norm(ahead)
    return ArcPoint(cycle, own, tangent / unit, ahead / unit, length, before)


def tangent_at(orbit: Orbit, scale: Scale, side: Array, matrix: BorderedMatrix | None = None) -> Array:
    """The tangent of the branch at an orbit on a side, (3,), by the matrix made last or another, (N + 1,)."""
    matrix = matrix or BorderedMatrix(orbit, scale)
    tangent = matrix.direction(side)
    return tangent if scale.moved(orbit, tangent) @ side > 0 else -tangent


def next_point(here: ArcPoint, accuracy: float) -> ArcPoint:
    """The next point of a branch; raises Unsolvable where there is none."""
    length = min(here.length, LONGEST)
    while True:
        try:
            return point_at(here, length, accuracy)
        except Unsolvable:
            if length <= SHORTEST:
                raise
            length /= 2


def point_at(here: ArcPoint, length: float, accuracy: float) -> ArcPoint:
    """The point at some length of the arc from another one; raises Unsolvable where it is no step from it."""
    condition, predicted = here.condition(length), here.predicted(length)
    found = condition.solved(predicted, matrix_distance(accuracy))
    off = relative_change(predicted, found.orbit.values - predicted.values)
    if off > FAR:
        raise Unsolvable("the cycle is far from its prediction")
    tangent = tangent_at(found.orbit, here.scale, here.ahead, bordered(found))
    if here.scale.moved(found.orbit, tangent) @ here.ahead < STRAIGHT:  # both are of unit length
        raise Unsolvable("the branch bends")
    factor = (GOOD_PREDICTION / max(off, 1e-9)) ** 0.25 if here.before is not None else 1.0
    cycle = measured(found, here.cycle.calibration, condition, CHANGE * length, accuracy)
    if cycle.orbit is not found.orbit:
        tangent = tangent_at(cycle.orbit, here.scale, here.ahead)
    ahead = length * float(np.clip(factor, SHORTER, LONGER))
    return arc_point(cycle, here.scale, tangent, ahead, Passed(here.orbit, here.tangent))


def measured(
    found: Converged, known: Calibration | None, condition: Condition, change: float, accuracy: float
) -> RefinedCycle:
    """A cycle with its errors, on a finer mesh if need be; raises Unsolvable.

    known: of the cycle before, if there is one; change: relative, of the two.
    """
    tolerance = matrix_distance(accuracy)
    if known is not None:
        known = known.on_branch(found.orbit, change)
        if known.mesh == mesh_of(found.orbit) and known.holds:
            cycle = judged_by(known, found, accuracy)
            if cycle.errors.largest <= accuracy:
                return cycle
    for _ in range(MOST_MESHES):
        known = calibrated(found, accuracy, known, condition.on)
        cycle = judged_by(known, found, accuracy)
        planned, enough = known.planned(MARGIN * accuracy), cycle.errors.largest <= accuracy
        if enough and planned.cost > CHEAPER * known.mesh.cost:
            return cycle
        if not enough:
            planned = finer_mesh(known.mesh, planned)
        if not planned.allowed:
            break
        found = condition.on(planned, found.orbit, tolerance)
        known = replace(known, reach=np.inf)
    raise Unsolvable("no mesh is fine enough")
