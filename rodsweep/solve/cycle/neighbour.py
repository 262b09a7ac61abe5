"""From a neighbour's cycle to that of the next point of a sweep: the tangent predicts, Newton corrects.

A neighbour hands on its cycle on both meshes, each with its tangent along the axis. The coarse mesh is solved
first; by what it moves the prediction on it, the prediction on the fine mesh is moved too, and is then so
near that one elimination gives the cycle and its multipliers. Where the step is too long for Newton's method
it is divided, on the coarse mesh. All of it follows from the neighbour alone, so that a chain of points has
the same content however often it was interrupted.
"""

from dataclasses import dataclass, replace
from math import inf
from typing import Any

import numpy as np

from ...arrays import Array
from ...discretization.mesh import mesh
from ...discretization.stress_form import StressForm
from ...model.parameters import PARAMETERS
from ...model.rod import Rod
from ..point import Unsolvable
from .orbit import Change, Converged, Orbit, at_orbit, coordinate, newton, relative_change
from .refinement import (
    OrbitMesh,
    RefinedCycle,
    fine_cycle,
    judged,
    mesh_by_error,
    mesh_of,
    refined_from,
)

FARTHEST = 0.3
"""Relative distance of a cycle from its prediction beyond which it may be another one."""
MOST_HALVINGS, MOST_STEPS = 6, 100
"""Of a step along the axis, and steps in all."""
LONGER_STEP = 1.5
"""By how much a step that succeeded is followed by a longer one."""
GENEROUS, ENOUGH = 25.0, 0.6
"""How much more accurate than asked for a neighbour may be before the mesh is coarser; share of the accuracy
that its error may have before it is finer."""
HEAD, PART_HEAD = 7, 5
"""Numbers at the head of a packed neighbour, and for each of its two orbits."""
COARSE_DISTANCE = 1e-4
"""Relative distance of the coarse matrix from its orbit: its multipliers only tell the error of others."""


@dataclass(frozen=True, eq=False)
class Followed:
    """An orbit and the coefficients of its Taylor polynomial in the coordinate of a parameter, from the
    first.

    One coefficient is the tangent alone; three make the cubic through two orbits and their tangents.
    """

    orbit: Orbit
    taylor: tuple[Change, ...]

    def at(self, form: StressForm, name: str) -> Orbit:
        """The prediction at another value of the parameter, for the rod `form`, whatever its mesh."""
        step, moved = coordinate_of(form, name) - coordinate_of(self.orbit.form, name), self.orbit
        for power, coefficient in enumerate(self.taylor):
            moved = moved.moved(coefficient, step ** (power + 1))
        return replace(moved, form=replace(form, mesh=self.orbit.form.mesh))

    def on(self, target: OrbitMesh) -> "Followed":
        """The same on another mesh."""
        if target == mesh_of(self.orbit):
            return self
        orbit = target.carry(self.orbit)
        ahead = (target.carry(self.orbit.moved(coefficient)) for coefficient in self.taylor)
        return Followed(orbit, tuple(difference(orbit, end) for end in ahead))


def followed_from(found: Converged, before: Followed | None, name: str) -> Followed:
    """An orbit that was solved with its tangent; before: the one before it on the branch."""
    orbit, tangent = found.orbit, found.matrix.tangent
    if tangent is None:
        raise ValueError("the orbit was solved without its tangent")
    last = before.on(mesh_of(orbit)) if before else None
    step = coordinate_of(orbit.form, name) - coordinate_of(last.orbit.form, name) if last else 0.0
    if last is None or step == 0:
        return Followed(orbit, (tangent,))
    back = difference(orbit.moved(tangent, -step), last.orbit)
    turned = tangent.plus(last.taylor[0], -1.0)
    # With s = 0 here and -step there: A = q - r step, B = q - 3/2 r step for x + t s + q s^2 + r s^3.
    A, B = back.times(step**-2), turned.times(0.5 / step)
    bend = A.plus(B, -1.0)
    return Followed(orbit, (tangent, A.plus(bend, 2.0), bend.times(2 / step)))


def coordinate_of(form: StressForm, name: str) -> float:
    """Where a rod stands along a parameter."""
    return coordinate(name, value_of(form, name))


def difference(start: Orbit, end: Orbit) -> Change:
    """What moves the one orbit to the other, on the same mesh."""
    return Change(end.start - start.start, end.states - start.states, end.period - start.period)


def value_of(form: StressForm, name: str) -> float:
    """A parameter of a rod by its name."""
    return float(form.gamma1 if name == "gamma1" else getattr(form.rod, name))


@dataclass(frozen=True, eq=False)
class Neighbour:
    """A cycle on a fine and on a coarse mesh, as the next point takes it; error: the larger of its two."""

    fine: Followed
    coarse: Followed
    error: float

    @classmethod
    def of(cls, found: RefinedCycle, before: "Neighbour | None", name: str) -> "Neighbour":
        """From a cycle that was solved with tangents; before: its own neighbour."""
        last = (before.fine, before.coarse) if before else (None, None)
        parts = (found.fine, found.coarse)
        fine, coarse = (followed_from(*pair, name) for pair in zip(parts, last, strict=True))
        return cls(fine, coarse, found.errors.largest)

    def pack(self) -> Array:
        """All of it as one flat array, shape (length,)."""
        orbit = self.fine.orbit
        rod, parts = orbit.form.rod, list[Any]()
        head = [rod.F, rod.k1, rod.k2, rod.gamma3, orbit.form.gamma1, float(orbit.symmetric), self.error]
        for followed in (self.fine, self.coarse):
            orbit, m = followed.orbit, mesh_of(followed.orbit)
            head += [m.elements, m.order, m.intervals, m.stages, len(followed.taylor)]
            parts += [[orbit.period], orbit.start, orbit.states.ravel()]
            for part in followed.taylor:
                parts += [[part.period], part.start, part.states.ravel()]
        return np.concatenate([head, *parts])

    @classmethod
    def unpack(cls, flat: Array) -> "Neighbour":
        """The reverse of `pack`, from its array, shape (length,)."""
        F, k1, k2, gamma3, gamma1, symmetric, error = map(float, flat[:HEAD])
        rod, rest = Rod(F, k1, k2, gamma3), flat[HEAD + 2 * PART_HEAD :]
        pair = []
        for first in (HEAD, HEAD + PART_HEAD):
            elements, order, intervals, stages, terms = map(int, flat[first : first + PART_HEAD])
            form = StressForm(rod, gamma1, mesh(elements, order))
            n, changes = form.unknowns, []
            for _ in range(1 + terms):
                count = 1 + n + intervals * stages * n
                states = rest[1 + n : count].reshape(intervals, stages, n).copy()
                changes.append(Change(rest[1 : 1 + n].copy(), states, float(rest[0])))
                rest = rest[count:]
            here, *taylor = changes
            orbit = Orbit(form, bool(symmetric), here.period, here.start, here.states)
            pair.append(Followed(orbit, tuple(taylor)))
        fine, coarse = pair
        return cls(fine, coarse, error)


def followed_cycle(neighbour: Neighbour, form: StressForm, name: str, accuracy: float) -> RefinedCycle:
    """The cycle of a rod that differs from the neighbour's in one parameter; raises Unsolvable.

    form: the rod, on any mesh.
    """
    if form.omega_unknown != neighbour.fine.orbit.form.omega_unknown:
        raise Unsolvable("the neighbour has other unknowns")
    tolerance = max(1e-2 * accuracy, 1e-13)
    aim = _next_mesh(neighbour, accuracy)
    fine, coarse = neighbour.fine.on(aim), neighbour.coarse.on(aim.coarser)
    predicted = coarse.at(form, name)
    try:
        found = _near(predicted, tolerance, name)
        moved = aim.carry(found.orbit), aim.carry(predicted)
        guess = fine.at(form, name).moved(difference(moved[1], moved[0]))
    except Unsolvable:
        found = in_steps(coarse, form, name, tolerance)
        guess = aim.carry(found.orbit)
    cycle = judged(at_orbit(found, COARSE_DISTANCE, name), fine_cycle(guess, tolerance, name))
    return cycle if cycle.errors.largest <= accuracy else refined_from(cycle, accuracy, name)


def _near(predicted: Orbit, tolerance: float, name: str) -> Converged:
    """The orbit at a prediction; Unsolvable where it is not near."""
    found = newton(predicted, tolerance, name)
    if relative_change(predicted, difference(predicted, found.orbit)) > FARTHEST:
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
        followed = followed_from(at_orbit(found, COARSE_DISTANCE, name), followed, name)
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


def _next_mesh(neighbour: Neighbour, accuracy: float) -> OrbitMesh:
    """The neighbour's mesh, as long as it is fine enough and not far too fine."""
    if accuracy / GENEROUS <= neighbour.error <= ENOUGH * accuracy:
        return mesh_of(neighbour.fine.orbit)
    return mesh_by_error(neighbour.fine.orbit, neighbour.error, accuracy)
