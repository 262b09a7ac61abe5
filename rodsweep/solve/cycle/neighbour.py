"""From a neighbour's cycle to that of the next point of a sweep: the tangent predicts, Newton corrects.

A neighbour hands on its cycle with its tangent along the axis; the polynomial through it and those before it
is mostly so near to the next that one elimination gives the cycle and its multipliers. Where the step is too
long for Newton's method it is divided, on a coarser mesh. The mesh goes on too, and what is known of its
errors. All of it follows from the neighbour alone, so that a chain of points has the same content however
often it was interrupted.
"""

from dataclasses import dataclass
from math import inf, nan
from typing import Any

import numpy as np

from ...arrays import Array
from ...discretization.stress.form import StressForm
from ...model.parameters import PARAMETERS
from ...model.rod import Rod
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.newton import Converged, at_orbit, newton
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import OrbitMesh, mesh_of
from ..orbit.symmetry import NONE, REFLECTION
from ..point import Unsolvable
from .accuracy.calibration import Calibration
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
Arrays = dict[str, Array]


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

    def arrays(self) -> Arrays:
        """All of it as named arrays: orbit (N,), data (m, N + 1), places and orders (m,), and numbers."""
        branch, orbit = self.branch, self.branch.orbit
        return {
            "rod": np.array(list(orbit.form.rod.values.values())),
            "symmetric": np.array(orbit.symmetric),
            "mesh": np.array(mesh_of(orbit).numbers),
            "orbit": orbit.values,
            "places": branch.places,
            "orders": branch.orders,
            "data": branch.data,
            "next_mesh": np.array(self.next_mesh.numbers),
            "leading": np.array(self.leading),
        } | self.calibration.arrays()

    @classmethod
    def from_arrays(cls, arrays: Arrays) -> "Neighbour":
        """The reverse of `arrays`, of the shapes given there."""
        here, there = (OrbitMesh(*map(int, arrays[name])) for name in ("mesh", "next_mesh"))
        parameters: dict[str, Any] = dict(zip(PARAMETERS, map(float, arrays["rod"]), strict=True))
        rod = Rod(**parameters)
        symmetry = REFLECTION if arrays["symmetric"] else NONE
        form = StressForm(rod, here.grid)
        orbit = Orbit(form, symmetry, here.intervals, here.stages, arrays["orbit"])
        branch = Followed(orbit, *(arrays[name] for name in ("places", "orders", "data")))
        return cls(branch, there, Calibration.from_arrays(arrays), complex(arrays["leading"]))


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


def followed_cycle(
    neighbour: Neighbour, form: StressForm, name: str, accuracy: float, workspace: NewtonWorkspace
) -> RefinedCycle:
    """The cycle of a rod that differs from the neighbour's in one parameter; raises Unsolvable.

    form: the rod, on any mesh; workspace: memory of the matrices.
    """
    if form.omega_unknown != neighbour.branch.orbit.form.omega_unknown:
        raise Unsolvable("the neighbour has other unknowns")
    found = _converged(neighbour, form, name, accuracy, workspace)
    known = neighbour.calibration.at(found.orbit, relative_distance(neighbour.branch.orbit.form, form, name))
    if known.holds:
        cycle = judged_by(known, found, accuracy)
        if cycle.errors.largest <= accuracy:
            return cycle
    return calibrated_cycle(found, known, accuracy, name)


def _converged(
    neighbour: Neighbour, form: StressForm, name: str, accuracy: float, workspace: NewtonWorkspace
) -> Converged:
    """The cycle on the mesh that the neighbour says, with its tangent and its multipliers."""
    tolerance, aim = newton_tolerance(accuracy), neighbour.next_mesh
    try:
        found = near_prediction(neighbour.branch.on(aim).at(form, name), tolerance, workspace, name)
    except Unsolvable:
        start = in_steps(neighbour.branch.on(aim.coarser), form, name, tolerance, workspace)
        found = newton(aim.carry(start.orbit), tolerance, workspace, name)
    return at_orbit(found, matrix_distance(accuracy), name)
