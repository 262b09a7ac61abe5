"""A point of a curve of special points: its cycle, its error, and how cycles change across the curve."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, nan

import numpy as np

from ....arrays import Array
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, mesh_of
from ...orbit.tails import lasting_tails
from ...point import Unsolvable
from ..bordered import Scale

ACCURACY = 1e-7
"""Relative, of the line's parameter on a curve; that of the special points of rows is 1e-9."""
MOST_UNMEASURED = 3
"""Points from one whose error is measured to the next."""


@dataclass(frozen=True, eq=False)
class Across:
    """How the cycles of a family change across its curve, by the length across.

    way: across, along the branch and along the rows, (2,). test: of what is zero on the curve. orbit: of
    values and the line's coordinate, (N + 1,); mesh: theirs. span: length between the cycles that tell them.
    contraction: of corrections, as `NearbyCycles` has it.
    """

    way: Array
    test: float
    orbit: Array
    mesh: OrbitMesh
    span: float
    contraction: float = inf

    def on(self, orbit: Orbit) -> Array:
        """How an orbit changes across its curve on its own mesh, (N + 1,)."""
        mesh = mesh_of(orbit)
        if mesh == self.mesh:
            return self.orbit
        there = replace(self.mesh.carry(orbit), values=self.orbit[:-1])
        return np.append(mesh.carry(there).values, self.orbit[-1])


@dataclass(frozen=True, eq=False)
class CurveErrors:
    """The relative error of the line's value at a point of a curve; it grows as the squared tails do.

    tails: of the orbit where it was measured, in space and time, (2,); mesh: the orbit's; age: points since.
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


def errors_between(points: Sequence[OnCurve]) -> list[OnCurve]:
    """Points of a curve in order, with the larger of the errors that the measured ones beside tell."""
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


def with_parameters(orbit: Orbit, changed: dict[str, float]) -> Orbit:
    """The values of an orbit for the rod with other values of some parameters; raises Unsolvable."""
    try:
        form = replace(orbit.form, rod=orbit.form.rod.changed(**changed))
    except (ValueError, ZeroDivisionError) as error:
        raise Unsolvable(f"the curve leaves the rods: {error}") from error
    if form.omega_unknown != orbit.form.omega_unknown:
        raise Unsolvable(f"gamma3 = {form.rod.gamma3:.3g} needs other unknowns")
    return replace(orbit, form=form)
