"""From a neighbour's cycle to that of the next point of a sweep: the tangent predicts, Newton corrects.

A neighbour hands on its cycle with its tangent along the axis; the cubic through two of them is mostly so
near to the next that one elimination gives the cycle and its multipliers. Where the step is too long for
Newton's method it is divided, on a coarser mesh. The mesh goes on too, and what is known of its errors. All
of it follows from the neighbour alone, so that a chain of points has the same content however often it was
interrupted.
"""

from dataclasses import astuple, dataclass, replace
from math import inf, nan

import numpy as np

from ...arrays import Array
from ...discretization.stress_form import StressForm
from ...model.parameters import PARAMETERS
from ...model.rod import Rod
from ..point import Unsolvable
from .calibration import LENGTH, Calibration
from .linearisation import coordinate
from .newton import Converged, at_orbit, newton, relative_change
from .orbit import Orbit
from .orbit_mesh import OrbitMesh, mesh_of
from .refinement import (
    RefinedCycle,
    calibrated_cycle,
    judged_by,
    matrix_distance,
    newton_tolerance,
)

FARTHEST = 0.3
"""Relative distance of a cycle from its prediction beyond which it may be another one."""
MOST_HALVINGS, MOST_STEPS = 6, 100
"""Of a step along the axis, and steps in all."""
LONGER_STEP = 1.5
"""By how much a step that succeeded is followed by a longer one."""
TANGENT_DISTANCE = 1e-4
"""Relative distance from its orbit of a matrix whose tangent is good enough for a step of many."""
ENOUGH, WORTHWHILE = 0.9, 0.8
"""Share of the accuracy that a cycle's error may have for its neighbour to take over the mesh; share of its
cost that another mesh may have to be taken instead."""
UNKNOWN = complex(nan, nan)
HEAD = 9
"""Numbers at the head of a packed neighbour: rod, symmetry, Taylor terms, leading eigenvalue."""


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


def relative_distance(one: StressForm, other: StressForm, name: str) -> float:
    """Of two rods along a parameter: of its coordinates in units of the larger."""
    a, b = coordinate_of(one, name), coordinate_of(other, name)
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
        return cls(branch, *_next_mesh(found, accuracy), leading)

    def pack(self) -> Array:
        """All of it as one flat array, shape (length,)."""
        orbit, form = self.branch.orbit, self.branch.orbit.form
        rod, terms = form.rod, len(self.branch.taylor)
        head = [rod.F, rod.k1, rod.k2, rod.gamma3, form.gamma1, orbit.symmetric, terms]
        head += [self.leading.real, self.leading.imag]
        meshes = (mesh_of(orbit), self.next_mesh)
        known = self.calibration.pack()
        return np.concatenate([head, *map(astuple, meshes), known, orbit.values, self.branch.taylor.ravel()])

    @classmethod
    def unpack(cls, flat: Array) -> "Neighbour":
        """The reverse of `pack`, from its array, shape (length,)."""
        parts = np.split(flat.copy(), np.cumsum([HEAD, 4, 4, LENGTH]))
        F, k1, k2, gamma3, gamma1, symmetric, terms, real, imag = map(float, parts[0])
        here, there = (OrbitMesh(*map(int, part)) for part in parts[1:3])
        form = StressForm(Rod(F, k1, k2, gamma3), gamma1, here.grid)
        values = parts[4].reshape(1 + int(terms), -1)
        orbit = Orbit(form, bool(symmetric), here.intervals, here.stages, values[0])
        return cls(Followed(orbit, values[1:]), there, Calibration.unpack(parts[3]), complex(real, imag))


def _next_mesh(found: RefinedCycle, accuracy: float) -> tuple[OrbitMesh, Calibration]:
    """The mesh for the cycle after this one, and its calibration, or an outdated one."""
    here, known, errors = mesh_of(found.orbit), found.calibration, found.errors
    fits = errors.largest <= ENOUGH * accuracy
    if known.reach and not fits:
        return here, known.outdated
    if not fits or not known.reach:
        planned = known.planned(accuracy)
        if not fits or planned.cost <= WORTHWHILE * here.cost:
            return planned, known.outdated
    return here, known


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
