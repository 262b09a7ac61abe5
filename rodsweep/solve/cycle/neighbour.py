"""From a neighbour's cycle to that of the next point of a sweep: the tangent predicts, Newton corrects.

A neighbour hands on its cycle with its tangent along the axis; the polynomial through it and those before it
is mostly so near to the next that one elimination gives the cycle and its multipliers. Where the step is too
long for Newton's method it is divided, on a coarser mesh. The mesh goes on too, and what is known of its
errors. All of it follows from the neighbour alone, so that a chain of points has the same content however
often it was interrupted.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, nan

import numpy as np

from ...arrays import Array
from ...discretization.stress_form import StressForm
from ...model.parameters import PARAMETERS
from ...model.rod import Rod
from ..continuation.follower import StepControl, Stepped, advance
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
from ..orbit.symmetry import NONE, REFLECTION
from ..point import Unsolvable
from .accuracy.calibration import LENGTH, Calibration
from .accuracy.refinement import (
    RefinedCycle,
    calibrated_cycle,
    judged_by,
    matrix_distance,
    newton_tolerance,
)

FARTHEST = 0.3
"""Relative distance of a cycle from its prediction beyond which it may be another one."""
STEPS = StepControl(
    first=0.5, longest=1.0, shortest=2.0**-6, aim=0.15, order=3, sharpest=inf, growth=3.0, most=100
)
"""Shares of the way to a cycle that is too far for one step; the aim is what Newton's method takes two
matrices for. What is far off is told by `_near`."""
TANGENT_DISTANCE = 1e-2
"""Relative distance from its orbit of a matrix whose tangent is good enough for a step of many."""
ENOUGH = 0.9
"""Share of the accuracy that a cycle's error may have for its neighbour to take over the mesh."""
WORTHWHILE, WELL_WORTHWHILE = 0.8, 0.5
"""Share of its cost that another mesh may have to be taken instead: where nothing else is lost, and where a
calibration is, which costs as much as three cycles."""
MOST_BEHIND, SLOPELESS = 4, 3
"""Orbits before the last one that the prediction goes through, and how many of them it takes to be better
without the slope at one of them."""
UNKNOWN = complex(nan, nan)
HEAD = len(PARAMETERS) + 4
"""Numbers at the head of a packed neighbour: rod, symmetry, places, leading eigenvalue."""


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


@dataclass(frozen=True, eq=False)
class Neighbour:
    """A cycle, and the mesh on which the next point is solved.

    calibration: of that mesh, or outdated. leading: eigenvalue of the straight rod, 1/tau2, not below the
    real axis; NaN where it is not known.
    """

    branch: Followed
    next_mesh: OrbitMesh
    calibration: Calibration
    leading: complex = UNKNOWN

    @classmethod
    def of(
        cls,
        found: RefinedCycle,
        before: "Neighbour | None",
        name: str,
        accuracy: float,
        leading: complex = UNKNOWN,
    ) -> "Neighbour":
        """From a cycle that was solved with its tangent; before: its own neighbour."""
        branch = followed_from(found.fine, before.branch if before else None, name)
        return cls(branch, *_next_mesh(found, before, name, accuracy), leading)

    def pack(self) -> Array:
        """All of it as one flat array, shape (length,)."""
        orbit, form = self.branch.orbit, self.branch.orbit.form
        rod = form.rod
        head = [*rod.values.values(), orbit.symmetric]
        head += [len(self.branch.places), self.leading.real, self.leading.imag]
        meshes = (*mesh_of(orbit).numbers, *self.next_mesh.numbers)
        known = self.calibration.pack()
        branch = (self.branch.places, self.branch.orders, orbit.values, self.branch.data.ravel())
        return np.concatenate([head, meshes, known, *branch])

    @classmethod
    def unpack(cls, flat: Array) -> "Neighbour":
        """The reverse of `pack`, from its array, shape (length,)."""
        *numbers, symmetric, count, real, imag = map(float, flat[:HEAD])
        m = int(count)
        parts = np.split(flat.copy(), np.cumsum([HEAD, 4, 4, LENGTH, m, m]))
        here, there = (OrbitMesh(*map(int, part)) for part in parts[1:3])
        form = StressForm(Rod(**dict(zip(PARAMETERS, numbers, strict=True))), here.grid)
        # The values are one number fewer than each row of the data.
        values, data = np.split(parts[6], [len(parts[6]) // (1 + m)])
        orbit = Orbit(form, REFLECTION if symmetric else NONE, here.intervals, here.stages, values)
        branch = Followed(orbit, parts[4], parts[5], data.reshape(m, -1))
        return cls(branch, there, Calibration.unpack(parts[3]), complex(real, imag))


def _next_mesh(
    found: RefinedCycle, before: "Neighbour | None", name: str, accuracy: float
) -> tuple[OrbitMesh, Calibration]:
    """The mesh for the cycle after this one, and its calibration, or an outdated one."""
    here, known = mesh_of(found.orbit), found.calibration
    fits = found.errors.largest <= ENOUGH * accuracy
    if known.reach and not fits:
        return here, known.outdated
    share = inf if not fits else _share_of_cost(found, before, name)
    planned = known.planned(accuracy) if share else here
    return (planned, known.outdated) if share and planned.cost <= share * here.cost else (here, known)


def _share_of_cost(found: RefinedCycle, before: "Neighbour | None", name: str) -> float:
    """Share of its mesh's cost with which another one is taken for the cycle after this one; 0 for none."""
    if before is None:
        return WORTHWHILE  # the first mesh of a chain is no more than a guess
    if not found.calibration.reach:
        return WELL_WORTHWHILE
    step = relative_distance(before.branch.orbit.form, found.orbit.form, name)
    return 0.0 if found.calibration.lasts(step) else WORTHWHILE


def followed_cycle(neighbour: Neighbour, form: StressForm, name: str, accuracy: float) -> RefinedCycle:
    """The cycle of a rod that differs from the neighbour's in one parameter; raises Unsolvable.

    form: the rod, on any mesh.
    """
    if form.omega_unknown != neighbour.branch.orbit.form.omega_unknown:
        raise Unsolvable("the neighbour has other unknowns")
    found = _converged(neighbour, form, name, accuracy)
    known = neighbour.calibration.at(found.orbit, relative_distance(neighbour.branch.orbit.form, form, name))
    if known.holds:
        cycle = judged_by(known, found, accuracy)
        if cycle.errors.largest <= accuracy:
            return cycle
    return calibrated_cycle(found, known, accuracy, name)


def _converged(neighbour: Neighbour, form: StressForm, name: str, accuracy: float) -> Converged:
    """The cycle on the mesh that the neighbour says, with its tangent and its multipliers."""
    tolerance, aim = newton_tolerance(accuracy), neighbour.next_mesh
    try:
        found = _near(neighbour.branch.on(aim).at(form, name), tolerance, name)
    except Unsolvable:
        start = in_steps(neighbour.branch.on(aim.coarser), form, name, tolerance)
        found = newton(aim.carry(start.orbit), tolerance, name)
    return at_orbit(found, matrix_distance(accuracy), name)


def _near(predicted: Orbit, tolerance: float, name: str | None = None) -> Converged:
    """The orbit at a prediction; Unsolvable where it is not near."""
    found = newton(predicted, tolerance, name)
    if _distance(predicted, found) > FARTHEST:
        raise Unsolvable("the cycle is far from its prediction")
    return found


def _distance(predicted: Orbit, found: Converged) -> float:
    """Of an orbit from its prediction, relative."""
    return relative_change(predicted, found.orbit.values - predicted.values)


def in_steps(start: Followed, form: StressForm, name: str, tolerance: float) -> Converged:
    """The orbit at the end of steps that Newton's method can follow; raises Unsolvable."""
    here, there = start.orbit.form.rod.coordinate(name), form.rod.coordinate(name)
    share, length, followed = 0.0, STEPS.first, start

    def step(length: float) -> Stepped[Converged]:
        at = share + length
        between = form if at >= 1.0 else form.with_coordinate(name, here + at * (there - here))
        predicted = followed.at(between, name)
        found = _near(predicted, tolerance, name)
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
