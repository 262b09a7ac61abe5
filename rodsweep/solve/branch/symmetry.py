"""Symmetry breaking of cycles, and the branch of asymmetric cycles born there.

A symmetric cycle equals its own mirror image half a period later. Where a multiplier of the half-period map
composed with the reflection is -1, a branch of asymmetric cycles crosses. Its two sides are mirror images of
each other, shifted by half a period; one side is followed, over the whole period. Near the crossing the
deflection at t = 0 is linear in the asymmetry, parameter and period are quadratic. A branch that returns
to such a crossing continues on its mirror image, as a branch does at a Hopf point.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Array
from ..cycle.accuracy.refinement import matrix_distance, newton_tolerance
from ..cycle.accuracy.refinement_settings import REFINEMENT
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.measures import CyclePath
from ..orbit.newton import relative_change
from ..orbit.orbit import Orbit, node_times
from ..orbit.orbit_mesh import stages_for, wanted_mesh
from ..orbit.symmetry import NO_SYMMETRY
from ..point import Unsolvable
from .arc import ARC_STEPS, ArcPoint, arc_between
from .beginning import DEFLECTION
from .bordered.condition import BorderCondition, moved
from .bordered.matrix import BorderedMatrix
from .bordered.scale import Scale, deflection_of
from .settling import first_point
from .special.point import SpecialKind, SpecialPoint


@dataclass(frozen=True, slots=True, kw_only=True)
class EndingSettings:
    """Settings for the ends of a branch: at a Hopf point, at a symmetry breaking, at an end of the
    parameter's range.
    """

    small_cycle: float = 0.06
    """Largest tip y, in L, of a cycle from which the branch may step across a Hopf point where it ends."""
    small_asymmetry: float = 0.2
    """Largest asymmetry, in units of the largest moment, from which a branch may step across the symmetric
    cycle at its end."""
    min_asymmetry: float = 0.02
    """Asymmetry, in units of the largest moment, below which shorter steps identify the symmetric cycle no
    better."""
    lost_asymmetry: float = 0.1
    """A step that reduces the asymmetry below this fraction has reached or passed a symmetric cycle."""
    asymmetry_ratios: tuple[float, float] = 0.5, 2.0
    """Allowed range of the asymmetry found, in units of the predicted asymmetry."""
    place_share: float = 0.3
    """Tolerance for the extrapolated place of a Hopf point or a symmetry breaking, in units of the last
    cycle's distance from it."""
    min_place_tolerance: float = 1e-6
    """Smallest relative tolerance for the extrapolated place; the accuracy counts if larger."""
    period_tolerance: float = 1e-3
    """Relative tolerance for the extrapolated period; at a symmetry breaking the accuracy counts if
    larger."""
    range_end_bracket: float = 1e-6
    """Fraction of a step to which the range's end is predicted; Newton's method then places the cycle on
    it."""
    range_end_error: float = 1e-15
    """Relative error of the parameter at an end of the range."""
    same_maximum: float = 0.05
    """Fraction of a period between the largest y of two cycles beyond which these are different maxima."""
    largest_hidden_corner: float = 0.02
    """Arc length before the end of the range within which a corner of the largest y is not resolved."""


ENDINGS = EndingSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class AsymmetricStartSettings:
    """Settings for the first asymmetric cycle beside a symmetry breaking."""

    first_changes: tuple[float, ...] = (0.03, 0.01, 0.1)
    """Relative change from the symmetric cycle to the first asymmetric cycle; tried in this order."""


ASYMMETRIC_START = AsymmetricStartSettings()


@dataclass(frozen=True, slots=True)
class SymmetryBreaking:
    """A symmetry breaking: number of its branch, from 1, and index among the special points of the branch."""

    branch: int
    place: int
    point: SpecialPoint


def breakings_of(branches: Sequence[Sequence[SpecialPoint]]) -> list[SymmetryBreaking]:
    """Symmetry breakings among the special points of branches, if their cycle is known."""
    return [
        SymmetryBreaking(number, place, point)
        for number, special in enumerate(branches, 1)
        for place, point in enumerate(special)
        if point.kind == SpecialKind.symmetry_breaking and point.orbit is not None
    ]


def over_whole_period(orbit: Orbit) -> Orbit:
    """A symmetric orbit extended to its whole period by the symmetry, on twice as many intervals."""
    intervals = 2 * orbit.intervals
    times = 2 * node_times(intervals, orbit.stages)
    later = times > 1
    points = orbit.at(np.where(later, times - 1, times))
    # The second half of the period is the mirror image of the first.
    points[later] = orbit.symmetry.of(points[later], orbit.form.layout)
    values = np.append(points.ravel(), orbit.period)
    return replace(orbit, symmetry=NO_SYMMETRY, intervals=intervals, values=values)


def asymmetry(orbit: Orbit) -> Array:
    """Sum of the bending moments at t = 0 and half a period later, (nodes,): 0 for a symmetric orbit."""
    return _moments(orbit.start, orbit) + _moments(orbit.at(np.array([0.5]))[0], orbit)


def _moments(states: Array, orbit: Orbit) -> Array:
    """Bending moments of states, (..., n), at the nodes of an orbit's mesh, (..., nodes)."""
    return orbit.form.layout.field(states, "m3")


def beginning_without_symmetry(
    breaking: SymmetryBreaking, name: str, accuracy: float, workspace: NewtonWorkspace
) -> ArcPoint:
    """The first cycle of the asymmetric branch from a symmetry breaking along a parameter; raises Unsolvable.

    Of the two mirror images it is the one whose tip goes further to y > 0. workspace: memory of the branch's
    matrices.
    """
    if breaking.point.orbit is None:
        raise Unsolvable("the cycle at which the symmetry breaks is not known")
    whole = over_whole_period(breaking.point.orbit)
    scale = Scale.of(whole, name, 0.0)
    matrix = BorderedMatrix(whole, scale, workspace)
    # At the breaking a cycle at one parameter has a second direction, along which symmetry is lost.
    way = matrix.approximate_null_vector()
    way = way / relative_change(whole, way[:-1])
    for share in ASYMMETRIC_START.first_changes:
        try:
            ways = [moved(whole, name, sign * share * way) for sign in (1, -1)]
            # The two ways are mirror images; the one with the larger y is followed, so that answers do not
            # depend on a sign.
            start = max(ways, key=lambda orbit: CyclePath(orbit).extrema["tip_y_max"])
            return _first_cycle(start, matrix, deflection_of(start) - deflection_of(whole), accuracy)
        except Unsolvable as error:
            why = error
    raise Unsolvable(f"no cycle is found beside the symmetry breaking: {why}") from why


def _first_cycle(start: Orbit, whole: BorderedMatrix, change: float, accuracy: float) -> ArcPoint:
    """The cycle near a prediction; the branch goes on towards a larger deflection. Raises Unsolvable.

    whole: matrix of the symmetric cycle. change: change of the deflection from that cycle.
    """
    scale = whole.scale
    border = np.sign(change) * DEFLECTION
    condition = BorderCondition.at(scale, border, start)
    rough = condition.solved(start, REFINEMENT.nearby_tolerance, whole.workspace)
    near = rough.orbit
    expected = asymmetry(start)
    found = float(asymmetry(near) @ expected) / float(expected @ expected)
    if not ENDINGS.asymmetry_ratios[0] < found < ENDINGS.asymmetry_ratios[1]:
        raise Unsolvable("Newton's method fell back to symmetric cycles")
    aim = max(accuracy, REFINEMENT.first_accuracy)
    mesh = wanted_mesh(near, aim, stages_for(accuracy))
    first = condition.on(mesh, rough, newton_tolerance(accuracy), matrix_distance(accuracy))
    return first_point(first, scale, border, abs(change) / scale.deflection, accuracy)


def mirrored(start: ArcPoint, end: ArcPoint, known: Sequence[SymmetryBreaking], accuracy: float) -> bool:
    """Whether the asymmetry has changed sign between two cycles, or has almost vanished.

    On a mesh that lacks the symmetry of the cycle, the corner where the branches cross is rounded off: the
    parameter then turns back beside a known symmetry breaking before the asymmetry vanishes.
    """
    reference = asymmetry(start.orbit)
    other = end.orbit.on(start.orbit.form.mesh, end.orbit.intervals, end.orbit.stages)
    # The asymmetry changes sign where the branch passes a symmetric cycle, or falls steeply just before.
    if float(asymmetry(other) @ reference) < ENDINGS.lost_asymmetry * float(reference @ reference):
        return True
    return start.rises * end.rises < 0 and _nearly_symmetric(start) and _nearest(start, known, accuracy) >= 0


def _relative_asymmetry(start: ArcPoint) -> float:
    """Largest asymmetry of a cycle in units of its largest moment."""
    orbit = start.orbit
    return float(np.abs(asymmetry(orbit)).max() / np.abs(_moments(orbit.points, orbit)).max())


def _nearly_symmetric(start: ArcPoint) -> bool:
    return _relative_asymmetry(start) <= ENDINGS.small_asymmetry


def breaking_between(
    start: ArcPoint, end: ArcPoint, known: Sequence[SymmetryBreaking], accuracy: float
) -> int | None:
    """Index of the known symmetry breaking that lies between two cycles, -1 for none.

    None if the cycles are too far away to decide. Raises Unsolvable if no shorter step is allowed.
    """
    which = _nearest(start, known, accuracy) if _nearly_symmetric(start) else -1
    if which >= 0 or _relative_asymmetry(start) <= ENDINGS.min_asymmetry:
        return which
    if arc_between(start, end) / 2 < ARC_STEPS.shortest:
        raise Unsolvable("the cycle turns into its mirror image within the shortest step along the branch")
    return None


def _nearest(start: ArcPoint, known: Sequence[SymmetryBreaking], accuracy: float) -> int:
    """Index of the known symmetry breaking at the place where the asymmetry, extrapolated along the branch,
    vanishes; -1 for none.
    """
    orbit = start.orbit
    present = asymmetry(orbit)
    change = asymmetry(replace(orbit, values=start.tangent[:-1]))
    # Half the derivative of the squared asymmetry; it must fall for a symmetric cycle to lie ahead.
    falls = -float(present @ change)
    if falls <= 0:
        return -1
    # Parameter and period are quadratic in the asymmetry.
    period, at = (orbit.period, start.at) + float(present @ present) / falls / 2 * start.tangent[-2:]
    for which, breaking in enumerate(known):
        symmetric = breaking.point.orbit
        if symmetric is None:
            continue
        place = symmetric.form.rod.coordinate(start.scale.name)
        tolerance = ENDINGS.place_share * abs(start.at - place)
        tolerance += max(ENDINGS.min_place_tolerance, accuracy) * abs(place)
        period_tolerance = ENDINGS.place_share * abs(start.orbit.period - symmetric.period)
        period_tolerance += max(ENDINGS.period_tolerance, accuracy) * symmetric.period
        if abs(at - place) <= tolerance and abs(period - symmetric.period) <= period_tolerance:
            return which
    return -1
