"""Folds and torus points of cycles as curves over two parameters, continued from one that was located.

The cycles near a special point are a family of two numbers: a length along the branch on which it lies, as
`bordered` has it, and the place on the axis of the rows. In these two the special points are the zeros of one
function on a smooth curve, also where both parameters turn back, at a cusp. It is followed by its length: a
polynomial through the points before predicts cycle and place; the secant method across the curve corrects,
every cycle and the function's vectors with the factors of one elimination (`augmented`). How the function and
the cycles change across is known from the point before. What two meshes differ by is the error, at every
third point or so.
"""

from dataclasses import dataclass, replace
from math import ceil, inf
from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....determinant.parameter_plane import PlaneAxis
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import mesh_of, stages_for
from ...orbit.tails import lasting_tails
from ...point import Unsolvable
from ..arc import tangent_at
from ..beginning import LEAST_UNIT, MOMENT
from ..bordered import BorderedMatrix, Condition, Scale, moment_of, moved
from .augmented import SHARE, TOLERANCE, FoldFunction, NearbyCycles, TorusFunction
from .on_curve import ACCURACY, Across, CurveErrors, OnCurve, with_parameters
from .point import SpecialKind, SpecialPoint

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


class _Tried(NamedTuple):
    """A cycle at a length across a curve, with the vectors and the value of the function there."""

    orbit: Orbit
    vectors: Array
    test: float
    at: float


@dataclass(frozen=True, slots=True)
class CycleFamily:
    """The cycles about a point of a curve of a kind: border, (3,), is the direction of its branch in a scale.

    small: whether cycles are so small that Hopf points count as folds unless these are divided out.
    workspace: memory of the matrices.
    """

    kind: SpecialKind
    rows: PlaneAxis
    scale: Scale
    border: Array
    small: bool
    workspace: NewtonWorkspace

    @classmethod
    def about(
        cls, kind: SpecialKind, rows: PlaneAxis, point: OnCurve, workspace: NewtonWorkspace
    ) -> "CycleFamily":
        """The cycles about a point."""
        small = kind == SpecialKind.fold and point.tip_y_max < SMALL
        return cls(kind, rows, point.scale, point.ahead, small, workspace)

    def placed(self, orbit: Orbit, place: float) -> Orbit:
        """The values of an orbit for the rod at a place on the rows' axis; raises Unsolvable."""
        return with_parameters(orbit, {self.rows.name: self.rows.value(place)})

    def function(self, matrix: BorderedMatrix) -> FoldFunction | TorusFunction:
        """What is zero at special points of the kind, at the cycle of a matrix."""
        if self.kind == SpecialKind.fold:
            return FoldFunction(matrix, self.border, self.small)
        return TorusFunction(matrix)

    def nearest(
        self, start: Orbit, place: float, across: Array, rates: Across | None = None, same: bool = False
    ) -> OnCurve:
        """The point of the curve near an orbit at a place, across the curve in a direction, (2,).

        rates: about those across the curve; same: whether they are of this very point, on another mesh.
        Raises Unsolvable.
        """
        known = rates if rates and rates.way @ across >= ALIKE else None
        search = _SecantAcross(self, start, place, across, known, same)
        for _ in range(MOST_SECANTS):
            found = search.next()
            if found is not None:
                return found
        raise Unsolvable("the secant method does not settle")

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

        slope: d(line's value)/d(place) of the curve, so that what moves along it is no error. before: the
        point before, whose errors may tell this one's.
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
                return replace(
                    last, errors=CurveErrors(error / abs(last.at), lasting_tails(last.orbit), mesh)
                )
            last = here
        raise Unsolvable("no mesh is fine enough")


class _SecantAcross:
    """The secant method across a curve: each next cycle is corrected with the factors of the first one."""

    def __init__(
        self, family: CycleFamily, start: Orbit, place: float, way: Array, rates: Across | None, same: bool
    ) -> None:
        self.family, self.place, self.way, self.rates = family, place, way, rates
        self.orbit, self.at = family.placed(start, place), 0.0
        self.before: _Tried | None = None
        self.length = float(family.border @ family.scale.place(start))
        self.trusted = LINEAR_HERE if same else LINEAR_BEFORE
        """Longest step along a line by rates that are not of two cycles here."""
        contraction = rates.contraction if rates and not family.small else inf
        self.near = NearbyCycles(family, self.orbit, contraction)

    def next(self) -> OnCurve | None:
        """The point of the curve, if the next cycle tells it; raises Unsolvable."""
        here = self._tried()
        enough = self.trusted
        if own := self._rates_since(here):
            self.rates, self.trusted, enough = own, LINEAR_HERE, LINEAR / own.span
        rates = self.rates
        step = -here.test / rates.test if rates else FIRST_SECANT
        if not abs(step) <= FARTHEST:
            raise Unsolvable("the secant method leaves the curve")
        if rates and abs(step) <= enough:
            return self._point(step, replace(rates, contraction=self.near.contraction))
        if self.before:  # as the cycle, its vectors go on along a line
            change = (here.vectors - self.before.vectors) / (here.at - self.before.at)
            self.near.predict(here.vectors + step * change)
        if rates:
            self.orbit = self._moved(step, rates)
        self.before, self.at = here, self.at + step
        return None

    def _tried(self) -> _Tried:
        """The cycle at the present length across; raises Unsolvable."""
        family, rates = self.family, self.rates
        length = self.length + self.at * float(self.way[0])
        self.orbit = family.placed(self.orbit, self.place + self.at * float(self.way[1]))
        slope, enough = (abs(rates.test), TOLERANCE) if rates else (1.0, SHARE * FIRST_SECANT)
        condition = Condition(family.scale, family.border, length)
        self.orbit, test = self.near.solved(self.orbit, condition, slope, enough)
        return _Tried(self.orbit, self.near.function.vectors, test, self.at)

    def _rates_since(self, here: _Tried) -> Across | None:
        """The rates across between the last two cycles; None where they are too near, or there is one."""
        before = self.before
        if before is None or abs(here.at - before.at) < LEAST_SPAN or here.test == before.test:
            return None
        name, span = self.family.scale.name, here.at - before.at
        one, other = before.orbit, here.orbit
        change = other.form.rod.coordinate(name) - one.form.rod.coordinate(name)
        orbit = np.append(other.values - one.values, change) / span
        return Across(self.way, (here.test - before.test) / span, orbit, mesh_of(one), abs(span))

    def _moved(self, step: float, rates: Across) -> Orbit:
        """The last cycle moved a step across."""
        return moved(self.orbit, self.family.scale.name, step * rates.on(self.orbit))

    def _point(self, step: float, rates: Across) -> OnCurve:
        """The point of the curve a short step across from the last cycle."""
        family, matrix = self.family, self.near.matrix
        tangent = tangent_at(matrix.orbit, family.scale, family.border, matrix)
        place = self.place + (self.at + step) * float(self.way[1])
        orbit = family.placed(self._moved(step, rates), place)
        scale = Scale.of(orbit, family.scale.name, family.scale.least)
        ahead = scale.moved(orbit, tangent)
        return OnCurve(
            orbit=orbit,
            scale=scale,
            ahead=ahead / np.linalg.norm(ahead),
            place=place,
            at=getattr(orbit.form.rod, scale.name),
            row=getattr(orbit.form.rod, family.rows.name),
            rates=rates,
        )


def first_on_curve(
    special: SpecialPoint, line: str, rows: PlaneAxis, row: float, workspace: NewtonWorkspace
) -> OnCurve:
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
    matrix = BorderedMatrix(orbit, scale, workspace)
    ahead = scale.moved(orbit, tangent_at(orbit, scale, MOMENT, matrix))
    place = rows.scaled(row)
    start = OnCurve(
        orbit=orbit, scale=scale, ahead=ahead / np.linalg.norm(ahead), place=place, at=special.at, row=row
    )
    family = CycleFamily.about(special.kind, rows, start, workspace)
    return family.point(orbit, place, np.array([1.0, 0.0]))
