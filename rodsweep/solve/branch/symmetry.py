"""Where cycles lose their mirror symmetry, and the branch of cycles without it that is born there.

A symmetric cycle is its own mirror image half a period later. Where a multiplier of half a period and the
reflection is -1 it meets a branch of cycles that are not: to either side of it one is the mirror image of the
other, half a period later, and one of both is followed, over the whole period. About that point the asymmetry
goes with the moment at the clamp at t = 0, the parameter and the period with its square. A branch
that comes to such a point again goes through it to its mirror image, as one does at a Hopf point.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Array
from ..cycle.accuracy.refinement import FIRST_ACCURACY, NEAR, matrix_distance, newton_tolerance
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.measures import CyclePath
from ..orbit.newton import relative_change
from ..orbit.orbit import Orbit, node_times
from ..orbit.orbit_mesh import stages_for, wanted_mesh
from ..orbit.symmetry import NONE
from ..point import Unsolvable
from .arc import STEPS, ArcPoint, arc_between
from .beginning import MOMENT
from .bordered import BorderedMatrix, Condition, Scale, moment_of, moved
from .settling import first_point
from .special.point import SpecialKind, SpecialPoint

SHARES = (0.03, 0.01, 0.1)
"""Relative change from the symmetric cycle to the first one without symmetry, tried one after the other."""
SLIGHT, SLIGHTEST = 0.2, 0.02
"""Asymmetry, in units of the moments, from which a branch may step to the symmetric cycle where it ends, and
from which no shorter step is tried to see which it is."""
LOST = 0.1
"""Asymmetry left after a step, in units of that before it, below which a symmetric cycle lies between, or the
step has come to symmetric ones."""
WITHIN, CLOSE_PLACE, CLOSE_PERIOD = 0.3, 1e-6, 1e-3
"""Distance of a symmetry breaking from where the asymmetry vanishes, in units of the last cycle's, and
relative ones of the parameter and the period that need not be less; nor need they than the accuracy."""
SAME_MOTION = 0.5, 2.0
"""Of the asymmetry that is found in units of what was predicted."""


@dataclass(frozen=True, slots=True)
class Breaking:
    """A symmetry breaking: the number of its branch, from 1, its place among that one's special points."""

    branch: int
    place: int
    point: SpecialPoint


def breakings_of(branches: Sequence[Sequence[SpecialPoint]]) -> list[Breaking]:
    """Those of branches with their special points, of which the cycle is known."""
    return [
        Breaking(number, place, point)
        for number, special in enumerate(branches, 1)
        for place, point in enumerate(special)
        if point.kind == SpecialKind.symmetry_breaking and point.orbit is not None
    ]


def over_whole_period(orbit: Orbit) -> Orbit:
    """A symmetric orbit over its whole period, as its polynomials have it, on twice the intervals."""
    intervals = 2 * orbit.intervals
    times = 2 * node_times(intervals, orbit.stages)
    later = times > 1
    points = orbit.at(np.where(later, times - 1, times))
    points[later] = orbit.symmetry.of(points[later], orbit.form.layout)
    values = np.append(points.ravel(), orbit.period)
    return replace(orbit, symmetry=NONE, intervals=intervals, values=values)


def asymmetry(orbit: Orbit) -> Array:
    """By how much the bending moments half a period apart are not opposite, (nodes,), linear in states."""
    return _moments(orbit.start, orbit) + _moments(orbit.at(np.array([0.5]))[0], orbit)


def _moments(states: Array, orbit: Orbit) -> Array:
    """The bending moments of states, (..., n), of an orbit's mesh, (..., nodes)."""
    return orbit.form.layout.field(states, "m3")


def beginning_without_symmetry(
    breaking: Breaking, name: str, accuracy: float, workspace: NewtonWorkspace
) -> ArcPoint:
    """The first cycle of the branch from a symmetry breaking along a parameter; raises Unsolvable.

    workspace: memory of the branch's matrices. Of the two cycles that are mirror images it is the
    one whose tip goes further to y > 0.
    """
    if breaking.point.orbit is None:
        raise Unsolvable("the cycle at which the symmetry breaks is not known")
    whole = over_whole_period(breaking.point.orbit)
    scale = Scale.of(whole, name, 0.0)
    matrix = BorderedMatrix(whole, scale, workspace)
    way = matrix.other_way()
    way = way / relative_change(whole, way[:-1])
    for share in SHARES:
        try:
            ways = [moved(whole, name, sign * share * way) for sign in (1, -1)]
            start = max(ways, key=lambda orbit: CyclePath(orbit).extrema["tip_y_max"])
            return _first_cycle(start, matrix, moment_of(start) - moment_of(whole), accuracy)
        except Unsolvable as error:
            why = error
    raise Unsolvable(f"no cycle is found beside the symmetry breaking: {why}") from why


def _first_cycle(start: Orbit, whole: BorderedMatrix, change: float, accuracy: float) -> ArcPoint:
    """The cycle near a prediction, with the branch on the side of its moment; raises Unsolvable.

    whole: the matrix of the symmetric cycle; change: of the moment since.
    """
    scale = whole.scale
    border = np.sign(change) * MOMENT
    condition = Condition.at(scale, border, start)
    rough = condition.solved(start, NEAR, whole.workspace)
    near = rough.orbit
    expected = asymmetry(start)
    found = float(asymmetry(near) @ expected) / float(expected @ expected)
    if not SAME_MOTION[0] < found < SAME_MOTION[1]:
        raise Unsolvable("Newton's method fell back to symmetric cycles")
    aim = max(accuracy, FIRST_ACCURACY)
    mesh = wanted_mesh(near, aim, stages_for(accuracy))
    first = condition.on(mesh, rough, newton_tolerance(accuracy), matrix_distance(accuracy))
    return first_point(first, scale, border, abs(change) / scale.moment, accuracy)


def mirrored(here: ArcPoint, there: ArcPoint, known: Sequence[Breaking], accuracy: float) -> bool:
    """Whether the asymmetry has changed its sign between two cycles, or has all but gone.

    Meshes that are not their own mirror image half a period later round off the corner where the branches
    meet: there the parameter turns back beside a known symmetry breaking before the asymmetry is gone.
    """
    start = asymmetry(here.orbit)
    other = there.orbit.on(here.orbit.form.mesh, there.orbit.intervals, there.orbit.stages)
    if float(asymmetry(other) @ start) < LOST * float(start @ start):
        return True
    return here.rises * there.rises < 0 and _slight(here) and _nearest(here, known, accuracy) >= 0


def _share(here: ArcPoint) -> float:
    """The asymmetry of a cycle in units of its largest moment."""
    orbit = here.orbit
    return float(np.abs(asymmetry(orbit)).max() / np.abs(_moments(orbit.points, orbit)).max())


def _slight(here: ArcPoint) -> bool:
    return _share(here) <= SLIGHT


def symmetric_end(here: ArcPoint, there: ArcPoint, known: Sequence[Breaking], accuracy: float) -> int | None:
    """Which of the known symmetry breakings lies between two cycles, -1 for none of them.

    None where the cycles are still too far from it to tell. Raises Unsolvable where no shorter step helps.
    """
    which = _nearest(here, known, accuracy) if _slight(here) else -1
    if which >= 0 or _share(here) <= SLIGHTEST:
        return which
    if arc_between(here, there) / 2 < STEPS.shortest:
        raise Unsolvable("the motion becomes its mirror image within a step")
    return None


def _nearest(here: ArcPoint, known: Sequence[Breaking], accuracy: float) -> int:
    """Which symmetry breaking is where the asymmetry vanishes ahead of a cycle, -1 for none."""
    orbit = here.orbit
    start, change = asymmetry(orbit), asymmetry(replace(orbit, values=here.tangent[:-1]))
    falls = -float(start @ change)
    if falls <= 0:
        return -1
    # Parameter and period go with the square of the asymmetry.
    period, at = (orbit.period, here.at) + float(start @ start) / falls / 2 * here.tangent[-2:]
    for which, breaking in enumerate(known):
        symmetric = breaking.point.orbit
        if symmetric is None:
            continue
        place = symmetric.form.rod.coordinate(here.scale.name)
        near = WITHIN * abs(here.at - place) + max(CLOSE_PLACE, accuracy) * abs(place)
        also = WITHIN * abs(here.orbit.period - symmetric.period)
        also += max(CLOSE_PERIOD, accuracy) * symmetric.period
        if abs(at - place) <= near and abs(period - symmetric.period) <= also:
            return which
    return -1
