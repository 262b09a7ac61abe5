"""Errors of the cycles of a branch are measured, and the mesh is chosen that they ask for.

They are measured at every third cycle or so (`errors`) and interpolated at those between.
"""

from collections.abc import Sequence
from dataclasses import replace

from ...arrays import Array
from ..cycle.accuracy.refinement import judged_by, matrix_distance, newton_tolerance
from ..orbit.newton import Converged, multipliers_of
from ..orbit.orbit_mesh import OrbitMesh, finer_mesh, mesh_of
from ..point import Unsolvable
from .arc import STEPS, ArcPoint, placed, tangent_at
from .bordered import Condition, Scale, bordered
from .errors import BranchCalibration, measured_errors, slope_at

MOST_MESHES = 8
CHEAPER = 0.5
"""Cost of another mesh, in units of the present one's, for which it is taken."""
MARGIN = 0.5
"""Share of the accuracy that a mesh is chosen for, so that it serves the cycles that follow."""
SLOWER, SIMILAR = 0.7, 2.0
"""Rate of the parameter at a cycle between two, in units of the smaller one of theirs, below which their
errors do not bound its own, and growth of the errors since one of them beyond which they do not."""
MOST_UNMEASURED = 3
"""Cycles from one whose errors are measured to the next."""
LARGEST_GROWTH = 4.0
"""Growth of the errors, as the orbits' tails tell it, from which they are measured anew."""


def first_point(found: Converged, scale: Scale, side: Array, born: float, accuracy: float) -> ArcPoint:
    """The first cycle of a branch with its errors, on a finer mesh if need be; raises Unsolvable.

    side: on which the branch goes on, (3,); born: distance of the place where it is born, in the scale, about
    which parameter and multipliers go with the square of the distance.
    """
    place = placed(found, scale, tangent_at(found.orbit, scale, side, bordered(found)))
    multipliers = multipliers_of(found)[0]
    lost = abs(multipliers[0] - 1) if len(multipliers) else 0.0
    place = replace(place, curvature=place.rate / born, multiplier_rate=2 * lost / born)
    calibration = measured_errors(found, place, accuracy, None)
    cycle = judged_by(calibration.known, found, accuracy)
    return refined(ArcPoint(cycle=cycle, place=place, length=STEPS.first, calibration=calibration), accuracy)


def due(point: ArcPoint) -> bool:
    """Whether the errors of a cycle should be measured, not only be taken from those before it."""
    known = point.calibration.known.on_branch(point.orbit)
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
    found = condition.on(mesh, point.cycle.fine, newton_tolerance(accuracy), matrix_distance(accuracy))
    tangent = tangent_at(found.orbit, point.scale, point.ahead, bordered(found))
    known = point.place
    place = replace(
        placed(found, point.scale, tangent),
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
    again = [
        point if point.calibration.largest(accuracy) <= accuracy else _on_mesh_of(end, point, accuracy)
        for point in known
    ]
    return [*again, end]


def _on_mesh_of(end: ArcPoint, point: ArcPoint, accuracy: float) -> ArcPoint:
    """A cycle that is too inaccurate on the mesh of a later one, by that one's errors; raises Unsolvable."""
    there = on_mesh(point, mesh_of(end.orbit), point.condition(0.0), accuracy)
    there = _with_errors_between(end, there, end, 1.0, accuracy)
    return refined(there, accuracy)


def _with_errors_between(
    last: ArcPoint, point: ArcPoint, end: ArcPoint, share: float, accuracy: float
) -> ArcPoint:
    """A cycle at a share of the way between two on the same mesh, with errors between theirs or its own.

    Where its tails are larger than theirs, or where the parameter changes more slowly, as beside a fold, they
    do not bound its errors, which are measured. Raises Unsolvable.
    """
    ends = (last, end)
    slow = abs(point.rises) < SLOWER * min(abs(one.rises) for one in ends)
    grown = min(one.calibration.known.on_branch(point.orbit).growth.max() for one in ends)
    if slow or float(grown) > SIMILAR:
        return measured(point, accuracy)
    known = last.calibration.towards(end.calibration, share, slope_at(point.cycle.path, point.place))
    return with_calibration(point, known, accuracy)
