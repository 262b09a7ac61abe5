"""Along a branch of cycles: from one to the next by a step of some length; errors measured, mesh chosen.

The cubic through two cycles and their tangents predicts, Newton's method corrects with the length of the arc
held (`bordered`). Steps are as long as the prediction is good and the branch bends little. Errors are
measured at every third cycle or so (`errors`), and the mesh is changed where they ask for it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...arrays import Array, Complex
from ..cycle.neighbour import carried
from ..cycle.newton import Converged, multiplier_change, multipliers_of, relative_change
from ..cycle.orbit import Orbit
from ..cycle.orbit_mesh import OrbitMesh, finer_mesh, mesh_of
from ..cycle.refinement import RefinedCycle, judged_by, matrix_distance, newton_tolerance
from ..point import Unsolvable
from .bordered import BorderedMatrix, Condition, Scale, bordered, moment_of, moved
from .errors import BranchCalibration, Place, measured_errors, slope_at

LONGEST, SHORTEST = 0.25, 1e-5
"""Steps in units of the scale."""
STRAIGHT = 0.9
"""Least cosine of the angle between the tangents at the ends of a step."""
GOOD_PREDICTION, FAR = 5e-4, 0.1
"""Relative distance of a cycle from its prediction that the next step is chosen for, and beyond which it may
be of another branch."""
LONGER, SHORTER = 2.0, 0.5
"""By how much a step may differ from the one before."""
MOST_MESHES = 8
CHEAPER = 0.5
"""Cost of another mesh, in units of the present one's, for which it is taken."""
MARGIN = 0.3
"""Share of the accuracy that a mesh is chosen for, so that it serves the cycles that follow."""
SLOWER, SIMILAR = 0.7, 2.0
"""Rate of the parameter at a cycle between two, in units of the smaller one of theirs, below which their
errors do not bound its own, and growth of the errors since one of them beyond which they do not."""
MOST_UNMEASURED = 3
"""Cycles from one whose errors are measured to the next."""
LARGEST_GROWTH = 4.0
"""Growth of the errors, as the orbits' tails tell it, from which they are measured anew."""


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


def first_point(
    found: Converged, scale: Scale, side: Array, born: float, accuracy: float, step: float
) -> ArcPoint:
    """The first cycle of a branch with its errors, on a finer mesh if need be; raises Unsolvable.

    side: on which the branch goes on, (3,); born: distance of the place where it is born, in the scale, about
    which parameter and multipliers go with the square of the distance; step: length of the next.
    """
    place = _place(found, scale, tangent_at(found.orbit, scale, side, bordered(found)))
    multipliers = multipliers_of(found)[0]
    lost = abs(multipliers[0] - 1) if len(multipliers) else 0.0
    place = replace(place, curvature=place.rate / born, multiplier_rate=2 * lost / born)
    calibration = measured_errors(found, place, accuracy, None)
    cycle = judged_by(calibration.known, found, accuracy)
    return refined(ArcPoint(cycle=cycle, place=place, length=step, calibration=calibration), accuracy)


def _place(found: Converged, scale: Scale, tangent: Array) -> Place:
    """Where a cycle stands on its branch, with its tangent, (N + 1,), of any length."""
    own = Scale.of(found.orbit, scale.name, scale.least)
    ahead = own.moved(found.orbit, tangent)
    unit = float(np.linalg.norm(ahead))
    return Place(own, tangent / unit, ahead / unit, 0.0, 0.0)


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
    found = condition.solved(predicted, newton_tolerance(accuracy), matrix_distance(accuracy))
    off = relative_change(predicted, found.orbit.values - predicted.values)
    if off > FAR:
        raise Unsolvable("the cycle is far from its prediction")
    tangent = tangent_at(found.orbit, here.scale, here.ahead, bordered(found))
    if here.scale.moved(found.orbit, tangent) @ here.ahead < STRAIGHT:  # both are of unit length
        raise Unsolvable("the branch bends")
    factor = (GOOD_PREDICTION / max(off, 1e-9)) ** 0.25 if here.before is not None else 1.0
    ahead = length * float(np.clip(factor, SHORTER, LONGER))
    return there_from(here, found, tangent, length, ahead, accuracy)


def there_from(
    here: ArcPoint, found: Converged, tangent: Array, length: float, ahead: float, accuracy: float
) -> ArcPoint:
    """A cycle at a length from another one, its errors not measured.

    tangent: of the branch there, (N + 1,); ahead: length of the next step.
    """
    cycle = judged_by(here.calibration.known, found, accuracy)
    place = _place(found, here.scale, tangent)
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


def due(point: ArcPoint) -> bool:
    """Whether the errors of a cycle should be measured, not only be taken from those before it."""
    known = point.calibration.known.on_branch(point.orbit, 0.0)
    return point.unmeasured >= MOST_UNMEASURED or float(known.growth.max()) > LARGEST_GROWTH


def measured(point: ArcPoint, accuracy: float) -> ArcPoint:
    """The same cycle with errors that are measured at it; raises Unsolvable."""
    found, before = point.cycle.fine, point.calibration
    return with_calibration(point, measured_errors(found, point.place, accuracy, before.known), accuracy)


def with_calibration(point: ArcPoint, calibration: BranchCalibration, accuracy: float) -> ArcPoint:
    """The same cycle with errors that are known."""
    cycle = judged_by(calibration.known, point.cycle.fine, accuracy)
    return replace(point, cycle=cycle, calibration=calibration, unmeasured=0, way=0.0)


def refined(point: ArcPoint, accuracy: float, condition: Condition | None = None) -> ArcPoint:
    """A cycle with measured errors on the mesh that they ask for; raises Unsolvable where none is allowed.

    condition: what holds on every mesh; without it the place on the branch.
    """
    condition = condition or point.condition(0.0)
    finest = False
    for _ in range(MOST_MESHES):
        if point.unmeasured:
            point = measured(point, accuracy)
        known = point.calibration
        enough, planned = known.largest(accuracy) <= accuracy, known.planned(MARGIN * accuracy)
        if enough and (finest or planned.cost > CHEAPER * known.mesh.cost):
            return point
        if not enough:
            finest, planned = True, finer_mesh(known.mesh, planned)
        if not planned.allowed:
            break
        point = on_mesh(point, planned, condition, accuracy)
    raise Unsolvable("no mesh is fine enough")


def on_mesh(point: ArcPoint, mesh: OrbitMesh, condition: Condition, accuracy: float) -> ArcPoint:
    """The same cycle on another mesh, its errors not measured; raises Unsolvable."""
    found = condition.on(mesh, point.orbit, newton_tolerance(accuracy), matrix_distance(accuracy))
    tangent = tangent_at(found.orbit, point.scale, point.ahead, bordered(found))
    known = point.place
    place = replace(
        _place(found, point.scale, tangent),
        curvature=known.curvature,
        multiplier_rate=known.multiplier_rate,
    )
    return replace(
        point, cycle=judged_by(point.calibration.known, found, accuracy), place=place, unmeasured=1
    )


def settled(
    last: ArcPoint, points: Sequence[ArcPoint], accuracy: float, condition: Condition | None
) -> list[ArcPoint]:
    """Cycles that follow one whose errors are measured, with errors within the accuracy; raises Unsolvable.

    condition: what holds for the last of them on every mesh; without it the place on the branch. Errors are
    measured at the last of them and interpolated at those between; what is too inaccurate is solved again, on
    the mesh that the last one asks for.
    """
    *between, end = points
    whole, end = end.way, measured(end, accuracy)
    known = [_with_errors_between(last, point, end, point.way / whole, accuracy) for point in between]
    end = refined(end, accuracy, condition)
    mesh = mesh_of(end.orbit)
    rough = [point.calibration.largest(accuracy) > accuracy for point in known]
    again = [
        refined(on_mesh(point, mesh, point.condition(0.0), accuracy), accuracy) if bad else point
        for point, bad in zip(known, rough, strict=True)
    ]
    return [*again, end]


def _with_errors_between(
    last: ArcPoint, point: ArcPoint, end: ArcPoint, share: float, accuracy: float
) -> ArcPoint:
    """A cycle at a share of the way between two on the same mesh, with errors between theirs or its own.

    Where its tails are larger than theirs, or where the parameter changes more slowly, as beside a fold, they
    do not bound its errors, which are measured. Raises Unsolvable.
    """
    ends = (last, end)
    slow = abs(point.rises) < SLOWER * min(abs(one.rises) for one in ends)
    grown = min(one.calibration.known.on_branch(point.orbit, 0.0).growth.max() for one in ends)
    if slow or float(grown) > SIMILAR:
        return measured(point, accuracy)
    known = last.calibration.towards(end.calibration, share, slope_at(point.cycle.path, point.place))
    return with_calibration(point, known, accuracy)
