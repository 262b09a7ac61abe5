"""Where a branch changes: folds, torus points, broken symmetry, doubled periods, the end of the model.

Between two cycles of a branch a number changes its sign: at a fold how fast the parameter grows along the
branch; at a torus point the modulus of a complex pair of multipliers less 1; where the symmetry breaks the
multiplier of half a period and the reflection plus 1, and the same of a whole period where a cycle without
symmetry doubles its period; where the model ends the least stretch h1. The zero is
found by the secant method with a cycle solved at each place, on two fine meshes: what they differ by is the
error.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import IntEnum
from math import ceil, nan

import numpy as np

from ...arrays import Array
from ...discretization.periodic import maxima, samples_of
from ..cycle.measures import CyclePath
from ..cycle.newton import Converged
from ..cycle.orbit import Orbit
from ..cycle.orbit_mesh import OrbitMesh, mesh_of, stages_for
from ..point import Unsolvable
from .arc import ArcPoint, tangent_at
from .bordered import BorderedMatrix, bordered, moved

REAL = 1e-7
"""Imaginary part of a multiplier, relative, below which it is real."""
NEAR_ONE = 3e-3
"""Distance of a multiplier from 1 within which rounding may put it on the other side; a fold has two."""
MOST_HALVINGS = 7
"""Of a step between two cycles in which more than one thing happens."""
ACCURACY = 1e-9
"""Relative, to which the parameter at a special point is located, where the branch is no more accurate."""
MESH_SHARE = 0.1
"""Share of it that the first of the two meshes is chosen for."""
TOLERANCE = 1e-10
"""To which a cycle is solved on the way: the square of it is left."""
MOST_SECANTS, STALLED = 12, 1e-6
"""Steps of the secant method, and the length, in units of the step of the branch, from which a step that is
no shorter than half of the one before is rounding."""
ZERO, ZERO_OF_A_FOLD = 1e-9, 1e-5
"""Last step of the secant method in units of the step of the branch: beside a fold the parameter changes with
the square of the distance."""
MATRIX_SHARE = 1e-2
"""Relative distance of a matrix from its cycle, in units of the step that led there, for a test function that
tells the next step to two digits."""
MOST_ENCLOSINGS, ROUGHLY = 30, 1e-3
"""Steps by which a zero is enclosed, and the value that ends them in units of those at the ends."""
MOST_PAIRS, MORE_ORDERS, MORE_INTERVALS, SAFETY = 4, 4, 1.3, 3.0
ROUNDING = 1e-13
PLACES = 8
"""Places in a node's neighbourhood at which the least stretch is looked for."""
SAFE_STRETCH = 0.2
"""Least h1 at the nodes above which it is positive between them too."""


Step = Callable[[ArcPoint, float], ArcPoint]
"""The point at a length from another one; raises Unsolvable."""


class SpecialKind(IntEnum):
    """What happens at a special point of a branch."""

    hopf = 1
    fold = 2
    torus = 3
    symmetry_breaking = 4
    left_the_model = 5
    end = 6
    period_doubling = 7


class EndReason(IntEnum):
    """Why a branch ends where it does; the first two are its ends, the others are not."""

    range_end = 1
    crushed = 2
    no_cycle_found = 3
    list_full = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class SpecialPoint:
    """A special point: the parameter's value there, the cycle's period in tau2 and largest tip y in L.

    error: absolute, of the parameter's value; period_error, size_error: relative, of the period and the
    largest tip y at the special point itself. after: the place on its branch of the last cycle before it, -1
    for none. reason: of an end. message: why no cycle was found, or why the error is large. orbit: of a point
    that was located, the cycle.
    """

    kind: SpecialKind
    at: float
    period: float
    tip_y_max: float
    error: float
    period_error: float = nan
    size_error: float = nan
    after: int = -1
    reason: EndReason | None = None
    message: str = ""
    orbit: Orbit | None = field(default=None, repr=False, compare=False)
    amplitude_coefficient: float = nan
    """At a Hopf point how fast the amplitude grows from there."""
    coefficient_error: float = nan
    """Relative, of amplitude_coefficient."""


def unstable_returns(point: ArcPoint) -> int:
    """How many multipliers lie outside the circle."""
    return int((np.abs(point.returns) > 1).sum())


def changes_between(here: ArcPoint, there: ArcPoint) -> tuple[list[SpecialKind], bool]:
    """(what happens between two cycles of a branch, whether that explains the multipliers that change)."""
    found = []
    if here.rises * there.rises < 0:
        found.append(SpecialKind.fold)
    if (_beyond_minus_one(here) - _beyond_minus_one(there)) % 2:
        found.append(through_minus_one(here.orbit))
    change = abs(unstable_returns(there) - unstable_returns(here))
    slack = 1 if _near_one(here) or _near_one(there) else 0
    if not found and change - slack > 1:
        return [SpecialKind.torus], change == 2 and all(map(_has_pair, (here, there)))
    return found, len(found) <= 1 and abs(change - len(found)) <= slack


def through_minus_one(orbit: Orbit) -> SpecialKind:
    """What a multiplier of the map over what is solved means that passes -1."""
    return SpecialKind.symmetry_breaking if orbit.symmetric else SpecialKind.period_doubling


def _beyond_minus_one(point: ArcPoint) -> int:
    """Real multipliers below -1."""
    h = point.returns
    return int(((h.real < -1) & (np.abs(h.imag) <= REAL * np.abs(h))).sum())


def _near_one(point: ArcPoint) -> bool:
    return bool((np.abs(point.returns - 1) < NEAR_ONE).any())


def _has_pair(point: ArcPoint) -> bool:
    h = point.returns
    return bool((np.abs(h.imag) > REAL * np.abs(h)).any())


def special_points(
    here: ArcPoint,
    there: ArcPoint,
    step: Step,
    accuracy: float,
    depth: int = 0,
) -> tuple[list[SpecialPoint], bool]:
    """(the special points between two cycles, whether they explain all), in their order along the branch.

    accuracy: of the branch.
    """
    kinds, explained = changes_between(here, there)
    if not explained and depth < MOST_HALVINGS:
        length = arc_between(here, there)
        try:
            middle = step(here, length / 2)
        except Unsolvable:
            pass
        else:
            first, known = special_points(here, middle, step, accuracy, depth + 1)
            second, also = special_points(middle, there, step, accuracy, depth + 1)
            return first + second, known and also
    return [located(kind, here, there, accuracy) for kind in kinds], explained


def arc_between(here: ArcPoint, there: ArcPoint) -> float:
    """The length from one cycle to another one, as steps have it."""
    return float(here.ahead @ (here.scale.place(there.orbit) - here.scale.place(here.orbit)))


class Segment:
    """The branch from one cycle to the next, on any mesh."""

    def __init__(self, here: ArcPoint, there: ArcPoint) -> None:
        self.here, self.there = here, there
        self.length = arc_between(here, there)
        self._back = float(there.ahead @ (there.scale.place(there.orbit) - there.scale.place(here.orbit)))
        self._known: tuple[float, Orbit, Array] | None = None

    def predicted(self, length: float) -> Orbit:
        """What the cubic through both predicts at a length from `here`, on the mesh of `there`."""
        return self.there.predicted(-self._back * (1 - length / self.length))

    def start_on(self, mesh: OrbitMesh) -> None:
        """What follows is on a mesh, from what was found last."""
        self.mesh, self._known = mesh, None

    def at(self, length: float, distance: float = TOLERANCE) -> Converged:
        """The cycle at a length from `here`, with a matrix at a relative distance; raises Unsolvable."""
        scale, name = self.here.scale, self.here.scale.name
        if self._known is None:
            start = self.mesh.carry(self.predicted(length))
        else:
            last, orbit, tangent = self._known
            start = moved(orbit, name, (length - last) * tangent)
        found = self.here.condition(length).solved(start, TOLERANCE, distance)
        tangent = tangent_at(found.orbit, scale, self.here.ahead, bordered(found))
        rate = float(scale.moved(found.orbit, tangent) @ self.here.ahead)
        self._known = length, found.orbit, tangent / rate
        return found

    def rises(self) -> float:
        """How fast the parameter grows at the cycle that was found last."""
        if self._known is None:
            raise ValueError("nothing is found yet")
        return float(self._known[2][-1]) / self.here.scale.coordinate


def test_function(kind: SpecialKind, segment: Segment, found: Converged) -> float:
    """What is zero at a special point of a kind, at a cycle that was just found; raises Unsolvable."""
    if kind == SpecialKind.fold:
        return segment.rises()
    if kind == SpecialKind.left_the_model:
        return least_stretch(CyclePath(found.orbit))
    h = BorderedMatrix(found.orbit, segment.here.scale).returns
    real = np.abs(h.imag) <= REAL * np.abs(h)
    if kind == through_minus_one(found.orbit):
        # Its sign is that of det(h + 1): it tells the one that crosses from others that are nearer elsewhere.
        return float((-1) ** (h[real].real < -1).sum() * np.abs(h + 1).min())
    if kind == SpecialKind.torus and not real.all():
        beyond = np.abs(h[~real]) - 1
        return float(beyond[np.argmin(np.abs(beyond))])
    raise Unsolvable("the multiplier that crosses the circle is lost")


def located(kind: SpecialKind, here: ArcPoint, there: ArcPoint, accuracy: float) -> SpecialPoint:
    """The special point of a kind between two cycles; where it is not found, the error says between which."""
    aim = min(accuracy, ACCURACY)
    try:
        segment = Segment(here, there)
        segment.start_on(mesh_of(there.orbit))
        length, slope = _enclosed(kind, segment)
        mesh = there.calibration.planned_for_parameter(MESH_SHARE * aim)
        mesh = replace(mesh, stages=max(mesh.stages, stages_for(aim)))
        last, point = None, None
        for _ in range(MOST_PAIRS + 1):
            segment.start_on(mesh)
            length, found, slope = _zero(kind, segment, length, slope)
            last, point = point, _point_at(kind, found)
            if last is not None:
                point = _with_errors(point, last, here, there)
                if point.error <= aim * abs(point.at):
                    break
            mesh = replace(
                mesh, order=mesh.order + MORE_ORDERS, intervals=ceil(MORE_INTERVALS * mesh.intervals)
            )
            if not mesh.allowed:
                break
        if point is None or np.isnan(point.error):
            raise Unsolvable("no mesh is fine enough")
    except Unsolvable as why:
        return _between(kind, here, there, f"the {kind.name} is not located: {why}")
    return point


def _with_errors(point: SpecialPoint, last: SpecialPoint, here: ArcPoint, there: ArcPoint) -> SpecialPoint:
    """A special point with its errors: by how much it differs from that on a coarser mesh.

    The place on the branch is known to the last step of the secant method, and period and size as well.
    """
    place = ZERO_OF_A_FOLD if point.kind is SpecialKind.fold else ZERO
    one, other = here.cycle.measures, there.cycle.measures
    period = SAFETY * abs(point.period - last.period) + place * abs(one.period - other.period)
    size = SAFETY * abs(point.tip_y_max - last.tip_y_max) + place * abs(one.tip_y_max - other.tip_y_max)
    return replace(
        point,
        error=SAFETY * abs(point.at - last.at) + ROUNDING * abs(point.at),
        period_error=period / point.period + ROUNDING,
        size_error=size / point.tip_y_max + ROUNDING,
    )


def _point_at(kind: SpecialKind, found: Converged) -> SpecialPoint:
    path, name = CyclePath(found.orbit), bordered(found).scale.name
    return SpecialPoint(
        kind=kind,
        at=getattr(found.orbit.form.rod, name),
        period=found.orbit.period,
        tip_y_max=path.extrema["tip_y_max"],
        error=nan,
        orbit=found.orbit,
    )


def _between(kind: SpecialKind, here: ArcPoint, there: ArcPoint, message: str) -> SpecialPoint:
    """A special point of which only is known between which cycles it lies."""
    name, measures, before = here.scale.name, there.cycle.measures, here.cycle.measures
    at, other = (getattr(point.orbit.form.rod, name) for point in (there, here))
    return SpecialPoint(
        kind=kind,
        at=at,
        period=measures.period,
        tip_y_max=measures.tip_y_max,
        error=max(abs(at - other), ACCURACY * abs(at)),
        period_error=abs(before.period / measures.period - 1),
        size_error=abs(before.tip_y_max / measures.tip_y_max - 1),
        message=message,
    )


def _enclosed(kind: SpecialKind, segment: Segment) -> tuple[float, float]:
    """Where the test function of a kind is about zero, enclosed by the ends, and its slope.

    Raises Unsolvable.
    """
    rough = MATRIX_SHARE * ROUGHLY * segment.length

    def value(length: float) -> float:
        return test_function(kind, segment, segment.at(length, rough))

    a, b = 0.0, segment.length
    f_b, f_a = value(b), value(a)
    if not f_a * f_b < 0:
        raise Unsolvable("its test function has no change of sign between two cycles")
    least = ROUGHLY * min(abs(f_a), abs(f_b))
    for _ in range(MOST_ENCLOSINGS):
        middle = a + min(max(f_a / (f_a - f_b), 0.1), 0.9) * (b - a)
        f, slope = value(middle), (f_b - f_a) / (b - a)
        if f * f_a > 0:
            a, f_a = middle, f
        else:
            b, f_b = middle, f
        if abs(f) <= least:
            return middle, slope
    return a + f_a / (f_a - f_b) * (b - a), slope


def _zero(kind: SpecialKind, segment: Segment, guess: float, slope: float) -> tuple[float, Converged, float]:
    """Where the test function of a kind is zero near a guess, the cycle there, and the function's slope.

    slope: about its slope, as a coarser mesh has it. Raises Unsolvable.
    """
    enough = segment.length * (ZERO_OF_A_FOLD if kind == SpecialKind.fold else ZERO)
    at, step, before = guess, ROUGHLY * segment.length, None
    for _ in range(MOST_SECANTS):
        found = segment.at(at, max(TOLERANCE, MATRIX_SHARE * abs(step)))
        f = test_function(kind, segment, found)
        if before is not None and f != before[1]:
            slope = (f - before[1]) / (at - before[0])
        last, step = abs(step), -f / slope
        if not abs(step) < segment.length:
            raise Unsolvable("the secant method leaves the step")
        if abs(step) <= enough or last / 2 < abs(step) <= STALLED * segment.length:
            return at, found, slope
        before = at, f
        at += step
    raise Unsolvable("the secant method does not settle")


def stretch_at(point: ArcPoint) -> float:
    """The least h1 of a cycle in space and time, or of its nodes where that is far from 0."""
    rough = point.cycle.measures.least_stretch
    return rough if rough > SAFE_STRETCH else least_stretch(point.cycle.path)


def least_stretch(path: CyclePath) -> float:
    """The least h1 of a cycle over the whole rod and the whole period."""
    from scipy.optimize import minimize_scalar  # a tenth of a second of every start

    grid, c = path.orbit.form.mesh, path.strain_coefficients[:, 0]

    def least(u: Array) -> Array:
        at = -np.ascontiguousarray(c @ grid.evaluation(u).T)
        return -maxima(at, samples_of(at, 8 * len(c)))

    places = np.linspace(0.0, 1.0, PLACES * len(grid.positions))
    values = least(places)
    best = int(np.argmin(values))
    ends = places[max(best - 1, 0)], places[min(best + 1, len(places) - 1)]
    found = minimize_scalar(
        lambda u: float(least(np.array([u]))[0]), bounds=ends, method="bounded", options={"xatol": 1e-9}
    )
    return min(float(values[best]), float(found.fun))
