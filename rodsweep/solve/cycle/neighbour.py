"""From a neighbour's cycle to that of the next point of a sweep: the tangent predicts, Newton corrects.

A neighbour hands on its cycle with its tangent along the axis; the polynomial through it and those before it
is mostly so near to the next that one elimination gives the cycle and its multipliers. Where the step is too
long for Newton's method it is divided, on a coarser mesh. The mesh goes on too, and what is known of its
errors. All of it follows from the neighbour alone, so that a chain of points has the same content however
often it was interrupted.
"""

from dataclasses import dataclass
from math import inf, nan

import numpy as np

from ...arrays import Array
from ...discretization.stress_form import StressForm
from ...model.parameters import PARAMETERS
from ...model.rod import Rod
from ..orbit.newton import Converged, at_orbit, newton
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
from .along_parameter import Followed, followed_from, in_steps, near_prediction, relative_distance

ENOUGH = 0.9
"""Share of the accuracy that a cycle's error may have for its neighbour to take over the mesh."""
WORTHWHILE, WELL_WORTHWHILE = 0.8, 0.5
"""Share of its cost that another mesh may have to be taken instead: where nothing else is lost, and where a
calibration is, which costs as much as three cycles."""
UNKNOWN = complex(nan, nan)
HEAD = len(PARAMETERS) + 4
"""Numbers at the head of a packed neighbour: rod, symmetry, places, leading eigenvalue."""


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
        found = near_prediction(neighbour.branch.on(aim).at(form, name), tolerance, name)
    except Unsolvable:
        start = in_steps(neighbour.branch.on(aim.coarser), form, name, tolerance)
        found = newton(aim.carry(start.orbit), tolerance, name)
    return at_orbit(found, matrix_distance(accuracy), name)
