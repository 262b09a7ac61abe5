"""Folds and torus points of cycles as curves over two parameters, continued from one that was located.

The cycles near a special point are a family of two numbers: a length along the branch on which it lies, as
`bordered` has it, and the place on the axis of the rows. In these two the special points are the zeros of one
function on a smooth curve, also where both parameters turn back, at a cusp. It is followed by its length: a
polynomial through the points before predicts cycle and place; the secant method across the curve corrects,
a cycle solved by the bordered Newton method at each step, on two meshes whose difference is the error. How
the function and the cycles change across the curve is known from the point before, and from mesh to mesh.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, nan
from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....determinant.parameter_plane import PlaneAxis
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, lasting_tails, mesh_of, stages_for
from ...point import Unsolvable
from ..arc import tangent_at
from ..beginning import LEAST_UNIT, MOMENT
from ..bordered import BorderedMatrix, Condition, Scale, moment_of, moved
from .augmented import SHARE, TOLERANCE, FoldFunction, NearbyCycles, TorusFunction
from .point import SpecialKind, SpecialPoint

ACCURACY = 1e-7
"""Relative, of the line's parameter on a curve; that of the special points of rows is 1e-9."""
ORDER_SHARE, INTERVAL_SHARE = 0.6, 0.5
"""Of the mesh of a special point's 1e-9, with which a curve starts."""
SMALL = 0.05
"""Largest tip y, in L, of cycles whose folds are told from their Hopf point by a division by the moment."""
FIRST_SECANT, FARTHEST, MOST_SECANTS = 1e-3, 0.1, 12
"""First step of the secant method across a curve where its rate is unknown, and the longest one."""
LINEAR, LINEAR_HERE, LINEAR_BEFORE = 1e-9, 1e-6, 1e-7
"""The last step is taken along a line, without a solution at its end: along that through the last two cycles,
where its product with their distance is so small; with the rates between other cycles at the same point, on
this mesh or another, which are known to 1e-3; or with those at the point before, to a tenth.
The test function is known to some 1e-8."""
ALIKE = 0.9
"""Least cosine of the angle between two ways across for which the rates of one serve the other."""
LEAST_SPAN = 1e-6
"""Least distance of two cycles that tell the rates across the curve: the test function is known to 1e-8."""
SAFETY, LOCATED = 3.0, 3e-9
"""Of the difference of two meshes, and relative error of the line's value beside it."""
MORE_ORDERS, MORE_INTERVALS, MOST_FINER_MESHES = 2, 1.2, 5
MOST_UNMEASURED = 3
"""Points from one whose error is measured to the next."""


@dataclass(frozen=True, eq=False)
class Across:
    """How the cycles of a family change across its curve, by the length across.

    way: across, along the branch and along the rows, (2,). test: of what is zero on the curve. orbit: of
    values and the line's coordinate, (N + 1,); mesh: theirs. span: length between the cycles that tell them. contraction:
    of corrections, as `NearbyCycles` has it.
    """

    way: Array
    test: float
    orbit: Array
    mesh: OrbitMesh
    span: float
    contraction: float = math.inf


class _Tried(NamedTuple):
    """A cycle at a length across a curve, with the test function there."""

    orbit: Orbit
    vectors: Array
    test: float
    at: float


@dataclass(frozen=True, eq=False)
class CurveErrors:
    """The error of a point of a curve, relative, of the line's value, which is the squared tails' times as large.

    tails: of the orbit where it was measured, in space and in time, (2,); mesh: the orbit's; age: points since.
    """

    measured: float
    tails: Array
    mesh: OrbitMesh
    age: int = 0

    def at(self, point: "OnCurve") -> float:
        """The absolute error of another point near by on this mesh."""
        growth = float((lasting_tails(point.orbit) / self.tails).max()) ** 2
        return max(growth, 1.0) * self.measured * abs(point.at)

    def tells(self, point: "OnCurve") -> bool:
        """Whether they tell that of the next point."""
        recent = self.age < MOST_UNMEASURED - 1 and mesh_of(point.orbit) == self.mesh
        return recent and self.at(point) <= ACCURACY * abs(point.at)

    @property
    def carried(self) -> "CurveErrors":
        """The same, known at the next point."""
        return replace(self, age=self.age + 1)


@dataclass(frozen=True, eq=False, kw_only=True)
class OnCurve:
    """A point of a curve: a cycle with its values of the line's and the rows' parameter.

    place: on the rows' axis, scaled. ahead: direction of its branch in `Scale.place`, (3,). error: absolute,
    of the line's value on the curve. period in tau2, tip_y_max in L. rates: across the curve, where known.
    """

    orbit: Orbit
    scale: Scale
    ahead: Array
    place: float
    at: float
    row: float
    error: float = nan
    errors: CurveErrors | None = None
    rates: Across | None = None

    @property
    def tip_y_max(self) -> float:
        return abs(float(self.orbit.form.tip(self.orbit.start)[1]))

    def step_from(self, other: "OnCurve") -> Array:
        """From another point to this one: in `Scale.place`, and along the rows, (4,)."""
        moved = self.scale.place(self.orbit) - self.scale.place(other.orbit)
        return np.append(moved, self.place - other.place)

    def across(self, step: Array) -> Array:
        """Square to a step, (4,), along the branch and along the rows, (2,)."""
        way = np.array([float(self.ahead @ step[:3]), step[3]])
        return np.array([-way[1], way[0]]) / np.linalg.norm(way)


@dataclass(frozen=True, slots=True)
class CycleFamily:
    """The cycles about a point of a curve of a kind: border, (3,), is the direction of its branch in a scale.

    small: whether cycles are so small that Hopf points count as folds unless these are divided out.
    """

    kind: SpecialKind
    rows: PlaneAxis
    scale: Scale
    border: Array
    small: bool

    @classmethod
    def about(cls, kind: SpecialKind, rows: PlaneAxis, point: OnCurve) -> "CycleFamily":
        """The cycles about a point."""
        small = kind == SpecialKind.fold and point.tip_y_max < SMALL
        return cls(kind, rows, point.scale, point.ahead, small)

    def placed(self, orbit: Orbit, place: float) -> Orbit:
        """The values of an orbit for the rod at a place on the rows' axis; raises Unsolvable."""
        return with_parameters(orbit, {self.rows.name: self.rows.value(place)})

    def nearest(
        self, start: Orbit, place: float, across: Array, rates: Across | None = None, same: bool = False
    ) -> OnCurve:
        """The point of the curve near an orbit at a place, across the curve in a direction, (2,).

        rates: about those across the curve; same: whether they are of this very point, on another mesh.
        Raises Unsolvable.
        """
        length = float(self.border @ self.scale.place(start))
        at, before = 0.0, None
        if rates and rates.way @ across < ALIKE:
            rates = None
        orbit = self.placed(start, place)
        near = NearbyCycles(orbit, self.scale, self.border, self._function)
        if not self.small:  # beside a Hopf point no correction tells how good the next one is
            near.contraction, near.learns = rates.contraction if rates else math.inf, True
        for _ in range(MOST_SECANTS):
            condition = Condition(self.scale, self.border, length + at * float(across[0]))
            orbit = self.placed(orbit, place + at * float(across[1]))
            slope, rough = (abs(rates.test), TOLERANCE) if rates else (1.0, SHARE * FIRST_SECANT)
            orbit, test = near.solved(orbit, condition, slope, rough)
            vectors = near.function.vectors
            here = _Tried(orbit, vectors, test, at)
            own = self._rates(across, before, here) if before else None
            rates, same = own or rates, same or own is not None
            step = -test / rates.test if rates else FIRST_SECANT
            if not abs(step) <= FARTHEST:
                raise Unsolvable("the secant method leaves the curve")
            enough = LINEAR / own.span if own else LINEAR_HERE if same else LINEAR_BEFORE
            if rates and abs(step) <= enough:
                return self._point(orbit, near.matrix, place + at * float(across[1]), step, across, replace(rates, contraction=near.contraction))
            if before:
                near.function.vectors = vectors + step / (at - before.at) * (vectors - before.vectors)
            before = here
            if rates:
                orbit = moved(orbit, self.scale.name, step * _on(rates, orbit))
            at += step
        raise Unsolvable("the secant method does not settle")

    def _function(self, matrix: BorderedMatrix) -> "FoldFunction | TorusFunction":
        """What is zero at special points of the kind."""
        if self.kind == SpecialKind.fold:
            return FoldFunction(matrix, self.border, self.small)
        return TorusFunction(matrix)

    def _rates(self, way: Array, before: _Tried, here: _Tried) -> Across | None:
        """The rates across the curve between two cycles on one mesh; None where they are too near."""
        name, span = self.scale.name, here.at - before.at
        if abs(span) < LEAST_SPAN or here.test == before.test:
            return None
        one, other = before.orbit, here.orbit
        change = other.form.rod.coordinate(name) - one.form.rod.coordinate(name)
        orbit = np.append(other.values - one.values, change) / span
        return Across(way, (here.test - before.test) / span, orbit, mesh_of(one), abs(span))

    def _point(
        self, orbit: Orbit, matrix: BorderedMatrix, place: float, step: float, across: Array, rates: Across
    ) -> OnCurve:
        """The point of the curve a short step across from a cycle that was just found."""
        tangent = tangent_at(matrix.orbit, self.scale, self.border, matrix)
        place += step * float(across[1])
        orbit = self.placed(moved(orbit, self.scale.name, step * _on(rates, orbit)), place)
        scale = Scale.of(orbit, self.scale.name, self.scale.least)
        ahead = scale.moved(orbit, tangent)
        return OnCurve(
            orbit=orbit,
            scale=scale,
            ahead=ahead / np.linalg.norm(ahead),
            place=place,
            at=getattr(orbit.form.rod, scale.name),
            row=getattr(orbit.form.rod, self.rows.name),
            rates=rates,
        )

    def point(
        self,
        start: Orbit,
        place: float,
        across: Array,
        slope: float = 0.0,
        rates: Across | None = None,
        before: OnCurve | None = None,
    ) -> OnCurve:
        """The same with its error, on a finer mesh if need be; raises Unsolvable.

        slope: d(line's value)/d(place) of the curve, so that what moves along it is no error. before: the point
        before, by whose errors this one's may be told.
        """
        last = self.nearest(start, place, across, rates)
        if before and before.errors and before.errors.tells(last):
            return replace(last, errors=before.errors.carried)
        for _ in range(MOST_FINER_MESHES):
            mesh = mesh_of(last.orbit)
            longer = ceil(MORE_INTERVALS * mesh.intervals)
            finer = replace(mesh, order=mesh.order + MORE_ORDERS, intervals=longer)
            if not finer.allowed:
                break
            here = self.nearest(finer.carry(last.orbit), last.place, across, last.rates, same=True)
            off = abs(here.at - last.at - slope * (here.place - last.place))
            error = SAFETY * off + LOCATED * abs(here.at)
            if error <= ACCURACY * abs(here.at):
                return replace(last, errors=CurveErrors(error / abs(last.at), lasting_tails(last.orbit), mesh))
            last = here
        raise Unsolvable("no mesh is fine enough")


def errors_between(points: Sequence[OnCurve]) -> list[OnCurve]:
    """Points of a curve in order, with the larger of the errors that those measured before and behind tell."""
    found: list[OnCurve] = []
    behind: CurveErrors | None = None
    for point in reversed(points):
        if point.errors is None:
            raise ValueError("the point was located without error")
        told = [point.errors]
        if point.errors.age == 0:
            behind = point.errors
        elif behind and behind.mesh == mesh_of(point.orbit):
            told.append(behind)
        found.append(replace(point, error=max(errors.at(point) for errors in told)))
    return found[::-1]


def _on(rates: Across, orbit: Orbit) -> Array:
    """How an orbit changes across its curve on its own mesh, (N + 1,)."""
    mesh = mesh_of(orbit)
    if mesh == rates.mesh:
        return rates.orbit
    there = replace(rates.mesh.carry(orbit), values=rates.orbit[:-1])
    return np.append(mesh.carry(there).values, rates.orbit[-1])


def with_parameters(orbit: Orbit, changed: dict[str, float]) -> Orbit:
    """The values of an orbit for the rod with other values of some parameters; raises Unsolvable."""
    try:
        form = replace(orbit.form, rod=orbit.form.rod.changed(**changed))
    except (ValueError, ZeroDivisionError) as error:
        raise Unsolvable(f"the curve leaves the rods: {error}") from error
    if form.omega_unknown != orbit.form.omega_unknown:
        raise Unsolvable(f"gamma3 = {form.rod.gamma3:.3g} needs other unknowns")
    return replace(orbit, form=form)


def first_on_curve(special: SpecialPoint, line: str, rows: PlaneAxis, row: float) -> OnCurve:
    """A special point that was located on a row as the first point of a curve; raises Unsolvable."""
    orbit = special.orbit
    if orbit is None:
        raise Unsolvable(special.message or "the special point has no cycle")
    mesh = mesh_of(orbit)
    rough = replace(
        mesh,
        order=ceil(ORDER_SHARE * mesh.order),
        intervals=ceil(INTERVAL_SHARE * mesh.intervals),
        stages=stages_for(ACCURACY),
    )
    orbit = rough.carry(orbit)
    scale = Scale.of(orbit, line, abs(moment_of(orbit)) * LEAST_UNIT / special.tip_y_max)
    ahead = scale.moved(orbit, tangent_at(orbit, scale, MOMENT, BorderedMatrix(orbit, scale)))
    place = rows.scaled(row)
    start = OnCurve(
        orbit=orbit, scale=scale, ahead=ahead / np.linalg.norm(ahead), place=place, at=special.at, row=row
    )
    return CycleFamily.about(special.kind, rows, start).point(orbit, place, np.array([1.0, 0.0]))
