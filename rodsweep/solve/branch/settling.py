"""Measurement of the errors of the cycles of a branch, and choice of the mesh from these errors.

Errors are measured at every third cycle or so (`errors`) and interpolated at the cycles between.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ...arrays import Array
from ..cycle.accuracy.refinement import matrix_distance, newton_tolerance, with_calibrated_errors
from ..orbit.newton import ConvergedOrbit, multipliers_of
from ..orbit.orbit_mesh import OrbitMesh, finer_mesh, mesh_of
from ..point import Unsolvable
from .arc import ARC_STEPS, ArcPoint, cycle_place, tangent_at
from .bordered.condition import BorderCondition
from .bordered.matrix import bordered
from .bordered.scale import Scale
from .errors import BranchCalibration, measured_errors, slope_at


@dataclass(frozen=True, slots=True, kw_only=True)
class SettlingSettings:
    """Settings for the choice of the meshes of a branch, and of the cycles at which errors are measured."""

    max_meshes: int = 8
    """Maximum number of meshes tried for one cycle."""
    cheaper_cost: float = 0.5
    """A cheaper mesh is taken if its cost is below this fraction of the present cost."""
    planned_share: float = 0.5
    """Fraction of the accuracy for which a mesh is planned, so that the mesh serves the next cycles too."""
    min_rate_share: float = 0.7
    """Smallest rate of the parameter along the branch, in units of the slower rate at the two measured
    cycles, for interpolated errors: beside a fold the rate is smaller, and the measured errors are no
    bound."""
    max_tail_growth: float = 2.0
    """Largest growth of the estimated errors since either measured cycle for interpolated errors."""
    max_unmeasured: int = 3
    """Errors are measured at least at every third cycle."""
    remeasure_growth: float = 4.0
    """Errors are measured anew once the coefficient tails suggest growth by this factor."""


SETTLING = SettlingSettings()


def first_point(found: ConvergedOrbit, scale: Scale, side: Array, born: float, accuracy: float) -> ArcPoint:
    """The first cycle of a branch with its errors, on a finer mesh if necessary; raises Unsolvable.

    side: direction in which the branch goes on, (3,). born: distance from the point of birth, in the scale;
    parameter and multipliers are quadratic in this distance.
    """
    place = cycle_place(found, scale, tangent_at(found.orbit, scale, side, bordered(found)))
    multipliers = multipliers_of(found)[0]
    lost = abs(multipliers[0] - 1) if len(multipliers) else 0.0
    # From the Hopf point, where rate and lost multiplier vanish: one is linear in the deflection, the other
    # quadratic.
    place = replace(place, curvature=place.rate / born, multiplier_rate=2 * lost / born)
    calibration = measured_errors(found, place, accuracy, None)
    cycle = with_calibrated_errors(calibration.known, found, accuracy)
    return refined(
        ArcPoint(cycle=cycle, place=place, length=ARC_STEPS.first, calibration=calibration), accuracy
    )


def measurement_due(point: ArcPoint) -> bool:
    """Whether the errors of a cycle must be measured."""
    growth = float(point.calibration.known.on_branch(point.orbit).growth.max())
    return point.unmeasured >= SETTLING.max_unmeasured or growth > SETTLING.remeasure_growth


def measured(point: ArcPoint, accuracy: float) -> ArcPoint:
    """The cycle with errors measured at it; raises Unsolvable."""
    before = point.calibration.known
    return with_calibration(point, measured_errors(point.cycle.fine, point.place, accuracy, before), accuracy)


def with_calibration(point: ArcPoint, calibration: BranchCalibration, accuracy: float) -> ArcPoint:
    """The cycle with errors from a calibration."""
    cycle = with_calibrated_errors(calibration.known, point.cycle.fine, accuracy)
    return replace(point, cycle=cycle, calibration=calibration, unmeasured=0, arc_since_measured=0.0)


def refined(point: ArcPoint, accuracy: float, condition: BorderCondition | None = None) -> ArcPoint:
    """The cycle with measured errors within the accuracy, on the cheapest mesh found; raises Unsolvable
    without one.

    condition: holds on every mesh; by default the arc length along the branch is kept. A much cheaper mesh
    replaces a mesh that is too fine.
    """
    condition = condition or point.condition(0.0)
    finest = False
    for _ in range(SETTLING.max_meshes):
        if point.unmeasured:
            point = measured(point, accuracy)
        known = point.calibration
        enough = known.largest(accuracy) <= accuracy
        planned = known.planned(SETTLING.planned_share * accuracy)
        # A mesh that is good enough is left only for a much cheaper one, and never once it was too coarse
        # before.
        if enough and (finest or planned.cost > SETTLING.cheaper_cost * known.mesh.cost):
            return point
        if not enough:
            finest = True
            planned = finer_mesh(known.mesh, planned)
        if not planned.allowed:
            break
        point = on_mesh(point, planned, condition, accuracy)
    raise Unsolvable("no mesh of allowed size reaches the requested accuracy")


def on_mesh(point: ArcPoint, mesh: OrbitMesh, condition: BorderCondition, accuracy: float) -> ArcPoint:
    """The cycle on another mesh, without measured errors; raises Unsolvable."""
    found = condition.on(mesh, point.cycle.fine, newton_tolerance(accuracy), matrix_distance(accuracy))
    tangent = tangent_at(found.orbit, point.scale, point.ahead, bordered(found))
    known = point.place
    place = replace(
        cycle_place(found, point.scale, tangent),
        curvature=known.curvature,
        multiplier_rate=known.multiplier_rate,
    )
    return replace(
        point,
        cycle=with_calibrated_errors(point.calibration.known, found, accuracy),
        place=place,
        unmeasured=1,
    )


def settled(
    last: ArcPoint, points: Sequence[ArcPoint], accuracy: float, condition: BorderCondition | None
) -> list[ArcPoint]:
    """The cycles after a measured one, all with errors within the accuracy; raises Unsolvable.

    condition: holds for the last cycle on every mesh; by default its arc length is kept. Errors are measured
    at the last cycle and interpolated between; a cycle that is too inaccurate is solved again on the mesh of
    the last cycle.
    """
    *between, end = points
    whole = end.arc_since_measured
    end = measured(end, accuracy)
    known = [
        _with_errors_between(last, point, end, point.arc_since_measured / whole, accuracy)
        for point in between
    ]
    # Only after the errors between were interpolated, since those belong to the old mesh.
    end = refined(end, accuracy, condition)
    again = [
        point if point.calibration.largest(accuracy) <= accuracy else _on_mesh_of(end, point, accuracy)
        for point in known
    ]
    return [*again, end]


def _on_mesh_of(end: ArcPoint, point: ArcPoint, accuracy: float) -> ArcPoint:
    """A cycle solved on the mesh of a later cycle, with errors of that cycle; raises Unsolvable."""
    solved = on_mesh(point, mesh_of(end.orbit), point.condition(0.0), accuracy)
    # With the errors of the end, on whose mesh the cycle now is.
    solved = _with_errors_between(end, solved, end, 1.0, accuracy)
    return refined(solved, accuracy)


def _with_errors_between(
    last: ArcPoint, point: ArcPoint, end: ArcPoint, share: float, accuracy: float
) -> ArcPoint:
    """A cycle at a share of the way between two on the same mesh, with interpolated errors.

    Its errors are measured instead if its coefficient tails are larger, or if the parameter changes more
    slowly, as beside a fold: the errors at the ends are then no bound. Raises Unsolvable.
    """
    ends = (last, end)
    slow = abs(point.rises) < SETTLING.min_rate_share * min(abs(one.rises) for one in ends)
    grown = min(one.calibration.known.on_branch(point.orbit).growth.max() for one in ends)
    if slow or float(grown) > SETTLING.max_tail_growth:
        return measured(point, accuracy)
    known = last.calibration.towards(end.calibration, share, slope_at(point.cycle.path, point.place))
    return with_calibration(point, known, accuracy)
