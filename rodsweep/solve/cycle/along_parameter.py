"""Cycles along one parameter: a polynomial through the last ones predicts the next, Newton's method corrects.

The polynomial goes through the normalised values of the orbits and their slopes. Where a step is too long for
Newton's method it is divided.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

import numpy as np

from ...arrays import Array
from ...discretization.stress.form import StressForm
from ..continuation.follower import StepControl, Stepped, advance
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.newton import Converged, at_orbit, newton, relative_change
from ..orbit.normalised import (
    combined,
    normalised,
    normalised_tangent,
    polynomial_weights,
    reflected,
    values_of,
)
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import OrbitMesh, mesh_of
from ..point import Unsolvable

FARTHEST = 0.3
"""Relative distance of a cycle from its prediction beyond which it may be another one."""
STEPS = StepControl(
    first=0.5, longest=1.0, shortest=2.0**-6, aim=0.15, order=3, sharpest=inf, growth=3.0, most=100
)
"""Shares of the way to a cycle that is too far for one step; the aim is what Newton's method takes two
matrices for. What is far off is told by `near_prediction`."""
TANGENT_DISTANCE = 1e-2
"""Relative distance from its orbit of a matrix whose tangent is good enough for a step of many."""
MOST_BEHIND, SLOPELESS = 4, 3
"""Orbits before the last one that the prediction goes through, and how many of them it takes to be better
without the slope at one of them."""


@dataclass(frozen=True, eq=False)
class Followed:
    """An orbit, and what a polynomial through it has at places on the branch, to predict others.

    places: differences of the coordinate of a parameter from the orbit's, (m,); the first is the orbit's own.
    orders: 0 where the polynomial has the value of an orbit, 1 where its slope, (m,); data: these, of
    `normalised` values, (m, N + 1).
    """

    orbit: Orbit
    places: Array
    orders: Array
    data: Array

    @property
    def tangent(self) -> Array:
        """The slope of the normalised values here, (N + 1,)."""
        return self.data[0]

    @cached_property
    def values(self) -> Array:
        """The orbit's normalised values, (N + 1,)."""
        return normalised(self.orbit)

    def weights(self, step: float) -> Array:
        """Of slopes, and of values less those here, in what is added at a distance on the branch, (m,)."""
        weights: Array = polynomial_weights(self.places, self.orders, step)
        return weights

    def at(self, form: StressForm, name: str) -> Orbit:
        """The prediction at another value of the parameter, for the rod `form`, whatever its mesh."""
        step = form.rod.coordinate(name) - self.orbit.form.rod.coordinate(name)
        values = combined(self.values, self.data, self.orders, self.weights(step))
        if not values[-1] > 0:
            raise Unsolvable("the branch is predicted to end")
        here = replace(form, mesh=self.orbit.form.mesh)
        return replace(self.orbit, form=here, values=values_of(values, reflected(self.orbit)))

    def on(self, target: OrbitMesh) -> "Followed":
        """The same on another mesh."""
        if target == mesh_of(self.orbit):
            return self
        data = [np.append(carried(self.orbit, row[:-1], target), row[-1]) for row in self.data]
        return replace(self, orbit=target.carry(self.orbit), data=np.array(data))


def carried(orbit: Orbit, change: Array, target: OrbitMesh) -> Array:
    """A change of an orbit, (N,), as one of the orbit on another mesh: to carry is linear."""
    return target.carry(replace(orbit, values=change)).values


def followed_from(found: Converged, before: Followed | None, name: str) -> Followed:
    """An orbit that was solved with its tangent; before: the one before it on the branch.

    A tangent is as wrong as its orbit was predicted, a value far less: where SLOPELESS values are known,
    errors grow the less without another slope. From mesh to mesh states differ by far more than period and
    largest y, their slopes do so less.
    """
    orbit = found.orbit
    if found.matrix.tangent is None:
        raise ValueError("the orbit was solved without its tangent")
    tangent = normalised_tangent(orbit, found.matrix.tangent)
    step = orbit.form.rod.coordinate(name) - before.orbit.form.rod.coordinate(name) if before else 0.0
    if before is None or step == 0:
        return Followed(orbit, np.zeros(1), np.ones(1), tangent[None])
    last = before.on(mesh_of(orbit))
    if last is not before:
        return Followed(orbit, np.array([0.0, -step]), np.ones(2), np.array([tangent, last.tangent]))
    older = np.flatnonzero(before.orders == 0)[: MOST_BEHIND - 1]
    places, data = [0.0, -step, *(before.places[older] - step)], [tangent, before.values, *before.data[older]]
    orders = [1.0] + [0.0] * (1 + len(older))
    if 1 + len(older) < SLOPELESS:
        places, orders, data = [*places, -step], [*orders, 1.0], [*data, before.tangent]
    return Followed(orbit, np.array(places), np.array(orders), np.array(data))


def relative_distance(one: StressForm, other: StressForm, name: str) -> float:
    """Of two rods along a parameter: of its coordinates in units of the larger."""
    a, b = one.rod.coordinate(name), other.rod.coordinate(name)
    return abs(a - b) / max(abs(a), abs(b)) if a != b else 0.0


def near_prediction(predicted: Orbit, tolerance: float, workspace: NewtonWorkspace, name: str) -> Converged:
    """The orbit at a prediction; Unsolvable where it is not near."""
    found = newton(predicted, tolerance, workspace, name)
    if _distance(predicted, found) > FARTHEST:
        raise Unsolvable("the cycle is far from its prediction")
    return found


def _distance(predicted: Orbit, found: Converged) -> float:
    """Of an orbit from its prediction, relative."""
    return relative_change(predicted, found.orbit.values - predicted.values)


def in_steps(
    start: Followed, form: StressForm, name: str, tolerance: float, workspace: NewtonWorkspace
) -> Converged:
    """The orbit at the end of steps that Newton's method can follow; raises Unsolvable.

    workspace: memory of the matrices.
    """
    here, there = start.orbit.form.rod.coordinate(name), form.rod.coordinate(name)
    share, length, followed = 0.0, STEPS.first, start

    def step(length: float) -> Stepped[Converged]:
        at = share + length
        between = form if at >= 1.0 else form.with_coordinate(name, here + at * (there - here))
        predicted = followed.at(between, name)
        found = near_prediction(predicted, tolerance, workspace, name)
        return Stepped(found, _distance(predicted, found), 1.0)

    for _ in range(STEPS.most):
        try:
            ahead, length = advance(step, min(length, 1.0 - share), STEPS)
        except Unsolvable as why:
            raise Unsolvable("the branch of cycles cannot be followed: it ends or turns") from why
        share += length
        if share >= 1.0:
            return ahead.solution
        followed = followed_from(at_orbit(ahead.solution, TANGENT_DISTANCE, name), followed, name)
        length = STEPS.next_length(length, ahead, STEPS.order)
    raise Unsolvable("the branch of cycles cannot be followed in so many steps")
