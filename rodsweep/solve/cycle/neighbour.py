"""From a neighbour's cycle to that of the next point of a sweep: the tangent predicts, Newton corrects.

A neighbour hands on its cycle on both meshes, each with its tangent along the axis. The coarse mesh is solved
first; by what it moves the prediction on it, the prediction on the fine mesh is moved too, and is then so
near that one elimination gives the cycle and its multipliers. Where the step is too long for Newton's method
it is divided, on the coarse mesh. All of it follows from the neighbour alone, so that a chain of points has
the same content however often it was interrupted.
"""

from dataclasses import astuple, dataclass, replace
from itertools import pairwise
from math import inf

import numpy as np

from ...arrays import Array
from ...discretization.stress_form import StressForm
from ...model.parameters import PARAMETERS
from ...model.rod import Rod
from ..point import Unsolvable
from .linearisation import coordinate
from .mesh_plan import planned_mesh
from .newton import Converged, at_orbit, newton, relative_change
from .orbit import Orbit
from .orbit_mesh import OrbitMesh, mesh_of
from .refinement import (
    COARSE_DISTANCE,
    RefinedCycle,
    judged,
    matrix_distance,
    newton_tolerance,
    refined_from,
)

FARTHEST = 0.3
"""Relative distance of a cycle from its prediction beyond which it may be another one."""
MOST_HALVINGS, MOST_STEPS = 6, 100
"""Of a step along the axis, and steps in all."""
LONGER_STEP = 1.5
"""By how much a step that succeeded is followed by a longer one."""
TANGENT_DISTANCE = 1e-4
"""Relative distance from its orbit of a matrix whose tangent is good enough for a step of many."""
ENOUGH, WORTHWHILE = 0.9, 0.9
"""Share of the accuracy that a cycle's error may have for its neighbour to take over the mesh; share of its
cost that another mesh may have to be taken instead."""
HEAD = 8
"""Numbers at the head of a packed neighbour: rod, symmetry, whether settled, Taylor terms."""


@dataclass(frozen=True, eq=False)
class Followed:
    """An orbit and the coefficients of its Taylor polynomial in the coordinate of a parameter, (terms, N),
    from the first.

    One coefficient is the tangent alone; three make the cubic through two orbits and their tangents.
    """

    orbit: Orbit
    taylor: Array

    def ahead(self, step: float) -> Array:
        """What is added to the orbit's values at a distance in the coordinate, (N,)."""
        change: Array = step ** np.arange(1, len(self.taylor) + 1) @ self.taylor
        return change

    def at(self, form: StressForm, name: str) -> Orbit:
        """The prediction at another value of the parameter, for the rod `form`, whatever its mesh."""
        step = coordinate_of(form, name) - coordinate_of(self.orbit.form, name)
        here = replace(form, mesh=self.orbit.form.mesh)
        return replace(self.orbit, form=here, values=self.orbit.values + self.ahead(step))

    def on(self, target: OrbitMesh) -> "Followed":
        """The same on another mesh."""
        if target == mesh_of(self.orbit):
            return self
        return Followed(
            target.carry(self.orbit), np.array([carried(self.orbit, term, target) for term in self.taylor])
        )


def carried(orbit: Orbit, change: Array, target: OrbitMesh) -> Array:
    """A change of an orbit, (N,), as one of the orbit on another mesh: to carry is linear."""
    return target.carry(replace(orbit, values=change)).values


def followed_from(found: Converged, before: Followed | None, name: str) -> Followed:
    """An orbit that was solved with its tangent; before: the one before it on the branch."""
    orbit, tangent = found.orbit, found.matrix.tangent
    if tangent is None:
        raise ValueError("the orbit was solved without its tangent")
    last = before.on(mesh_of(orbit)) if before else None
    step = coordinate_of(orbit.form, name) - coordinate_of(last.orbit.form, name) if last else 0.0
    if last is None or step == 0:
        return Followed(orbit, tangent[None])
    # With s = 0 here and -step there: A = q - r step, B = q - 3/2 r step for x + t s + q s^2 + r s^3.
    A = (last.orbit.values - orbit.values + step * tangent) * step**-2
    B = (tangent - last.taylor[0]) * (0.5 / step)
    return Followed(orbit, np.array([tangent, 3 * A - 2 * B, (A - B) * (2 / step)]))


def coordinate_of(form: StressForm, name: str) -> float:
    """Where a rod stands along a parameter."""
    return coordinate(name, value_of(form, name))


def value_of(form: StressForm, name: str) -> float:
    """A parameter of a rod by its name."""
    return float(form.gamma1 if name == "gamma1" else getattr(form.rod, name))


@dataclass(frozen=True, eq=False)
class Neighbour:
    """A cycle on a fine and on a coarse mesh, and the mesh on which the next point is solved.

    drift: the derivative, by the coordinate, of what the coarse orbit differs by from the fine one carried to
    its mesh, (N of the coarse,). settled: the mesh was planned for a cycle before this one and holds.
    """

    fine: Followed
    coarse: Orbit
    drift: Array
    next_mesh: OrbitMesh
    settled: bool

    @classmethod
    def of(cls, found: RefinedCycle, before: "Neighbour | None", name: str, accuracy: float) -> "Neighbour":
        """From a cycle that was solved with its tangent; before: its own neighbour."""
        fine, coarse = followed_from(found.fine, before.fine if before else None, name), found.coarse.orbit
        drift = np.zeros(len(coarse.values))
        step = coordinate_of(coarse.form, name) - coordinate_of(before.coarse.form, name) if before else 0.0
        if before and step and mesh_of(before.fine.orbit) == mesh_of(fine.orbit):
            moved = carried(fine.orbit, fine.orbit.values - before.fine.orbit.values, mesh_of(coarse))
            drift = (coarse.values - before.coarse.values - moved) / step
        here, fits = mesh_of(fine.orbit), found.errors.largest <= ENOUGH * accuracy
        if before and fits and (before.settled or here != before.next_mesh):
            return cls(fine, coarse, drift, here, True)
        planned = planned_mesh(coarse, fine.orbit, accuracy)
        settled = before is not None and fits and planned.cost > WORTHWHILE * here.cost
        return cls(fine, coarse, drift, here if settled else planned, settled)

    def pack(self) -> Array:
        """All of it as one flat array, shape (length,)."""
        orbit, form = self.fine.orbit, self.fine.orbit.form
        rod, terms = form.rod, len(self.fine.taylor)
        head = [rod.F, rod.k1, rod.k2, rod.gamma3, form.gamma1, orbit.symmetric, self.settled, terms]
        meshes = (mesh_of(orbit), mesh_of(self.coarse), self.next_mesh)
        parts = [orbit.values, self.fine.taylor.ravel(), self.coarse.values, self.drift]
        return np.concatenate([head, *map(astuple, meshes), *parts])

    @classmethod
    def unpack(cls, flat: Array) -> "Neighbour":
        """The reverse of `pack`, from its array, shape (length,)."""
        F, k1, k2, gamma3, gamma1, symmetric, settled, terms = map(float, flat[:HEAD])
        ends = [HEAD + 4 * k for k in range(4)]
        meshes = [OrbitMesh(*map(int, flat[a:b])) for a, b in pairwise(ends)]
        rod, rest = Rod(F, k1, k2, gamma3), flat[ends[-1] :].copy()
        orbits = []
        for m, parts in zip(meshes[:2], (1 + int(terms), 2), strict=True):
            form = StressForm(rod, gamma1, m.grid)
            length = (1 + m.intervals * m.stages) * form.unknowns + 1
            values, rest = rest[: parts * length].reshape(parts, length), rest[parts * length :]
            orbits.append((Orbit(form, bool(symmetric), m.intervals, m.stages, values[0]), values[1:]))
        (fine, taylor), (coarse, drift) = orbits
        return cls(Followed(fine, taylor), coarse, drift[0], meshes[2], bool(settled))

    def predicted(self, form: StressForm, name: str) -> tuple[Orbit, Orbit]:
        """The predictions for another rod on the fine and the coarse mesh of the next point."""
        fine = self.fine.on(self.next_mesh)
        ahead, target = fine.at(form, name), self.next_mesh.coarser
        there = target.carry(ahead)
        if target != mesh_of(self.coarse):
            return ahead, there
        step = coordinate_of(form, name) - coordinate_of(self.coarse.form, name)
        moved = there.values - target.carry(fine.orbit).values + step * self.drift
        return ahead, replace(there, values=self.coarse.values + moved)


def followed_cycle(neighbour: Neighbour, form: StressForm, name: str, accuracy: float) -> RefinedCycle:
    """The cycle of a rod that differs from the neighbour's in one parameter; raises Unsolvable.

    form: the rod, on any mesh.
    """
    if form.omega_unknown != neighbour.fine.orbit.form.omega_unknown:
        raise Unsolvable("the neighbour has other unknowns")
    tolerance, aim = newton_tolerance(accuracy), neighbour.next_mesh
    guess, predicted = neighbour.predicted(form, name)
    try:
        found = _near(predicted, tolerance)
        guess = guess.moved(carried(predicted, found.orbit.values - predicted.values, aim))
    except Unsolvable:
        coarse = neighbour.fine.on(aim.coarser)
        found = newton(in_steps(coarse, form, name, tolerance).orbit, tolerance)
        guess = aim.carry(found.orbit)
    fine = at_orbit(newton(guess, tolerance, name), matrix_distance(accuracy), name)
    cycle = judged(at_orbit(found, COARSE_DISTANCE), fine, accuracy)
    return cycle if cycle.errors.largest <= accuracy else refined_from(cycle, accuracy, name)


def _near(predicted: Orbit, tolerance: float, name: str | None = None) -> Converged:
    """The orbit at a prediction; Unsolvable where it is not near."""
    found = newton(predicted, tolerance, name)
    if relative_change(predicted, found.orbit.values - predicted.values) > FARTHEST:
        raise Unsolvable("the cycle is far from its prediction")
    return found


def in_steps(start: Followed, form: StressForm, name: str, tolerance: float) -> Converged:
    """The orbit at the end of steps that Newton's method can follow."""
    here, there = coordinate_of(start.orbit.form, name), coordinate_of(form, name)
    share, step = 0.0, 0.5
    followed = start
    for _ in range(MOST_STEPS):
        step = min(step, 1.0 - share)
        if step < 2.0**-MOST_HALVINGS and share + step < 1.0:
            raise Unsolvable("the branch of cycles cannot be followed: it ends or turns")
        end = share + step >= 1.0
        between = form if end else with_coordinate(form, name, here + (share + step) * (there - here))
        try:
            found = _near(followed.at(between, name), tolerance, name)
        except Unsolvable:
            step /= 2
            continue
        if end:
            return found
        followed = followed_from(at_orbit(found, TANGENT_DISTANCE, name), followed, name)
        share, step = share + step, LONGER_STEP * step
    raise Unsolvable("the branch of cycles cannot be followed in so many steps")


def with_coordinate(form: StressForm, name: str, at: float) -> StressForm:
    """The rod with another value of a parameter, given by its coordinate."""
    value = at
    if PARAMETERS[name].by_compliance:
        value = 1 / at if at else inf
    if name == "gamma1":
        return replace(form, gamma1=value)
    return replace(form, rod=replace(form.rod, **{name: value}))
