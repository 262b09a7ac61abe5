"""The errors of a mesh, measured by two finer ones: one in space and one in time.

Two meshes of which one is coarser tell the fine one's error only by what it should be in units of the coarse
one's, which must be pessimistic. Two finer meshes measure it.
"""

from dataclasses import replace
from functools import cached_property
from math import ceil

import numpy as np

from ....arrays import Array, Complex
from ...orbit.measures import CyclePath
from ...orbit.newton import Converged, at_orbit, multiplier_change, multipliers_of, newton
from ...orbit.orbit_mesh import OrbitMesh, mesh_of
from ...orbit.path_differences import path_differences
from .calibration import Calibration, calibration_of

MORE_ORDERS, MORE_INTERVALS = 2, 1.4
"""What the finer meshes have more of."""
TOLERANCE, DISTANCE = 0.1, 1e-3
"""What Newton's method leaves on the other meshes, in units of the accuracy, and how far from the orbit the
matrix may be that their multipliers are of."""


def finer_meshes(mesh: OrbitMesh) -> tuple[tuple[OrbitMesh, OrbitMesh], float]:
    """Two meshes, finer in space and in time, and the share of the error in time that the second lacks."""
    longer = ceil(MORE_INTERVALS * mesh.intervals)
    share = 1 - ((mesh.intervals - 1) / (longer - 1)) ** (mesh.stages + 1)
    return (replace(mesh, order=mesh.order + MORE_ORDERS), replace(mesh, intervals=longer)), share


def calibrated(found: Converged, accuracy: float, before: Calibration | None) -> Calibration:
    """The calibration of the mesh of an orbit; raises Unsolvable.

    before: of an orbit near by, on this mesh or another, which tells how fast errors fall; without it the
    orbit does.
    """
    mesh, here = mesh_of(found.orbit), ComparedCycle(found)
    finer, share = finer_meshes(mesh)
    tolerance = TOLERANCE * accuracy
    others = (newton(target.carry(found.orbit), tolerance, found.workspace) for target in finer)
    space, time = (here.difference(ComparedCycle(other)) for other in others)
    time = time / share
    if before is not None and before.mesh == mesh:
        space, time = map(np.maximum, (space, time), before.least(found.orbit))
    return calibration_of(mesh, space, time, found.orbit, before)


class ComparedCycle:
    """Quantities of a cycle that are compared between meshes."""

    def __init__(self, found: Converged) -> None:
        self._found, self.orbit, self.path = found, found.orbit, CyclePath(found.orbit)

    @cached_property
    def multipliers(self) -> Complex:
        """All but the trivial one, (rank - 1,), by descending modulus."""
        return multipliers_of(at_orbit(self._found, DISTANCE))[0]

    def difference(self, fine: "ComparedCycle") -> Array:
        """By what the one on a finer mesh differs, as `Calibration.space` says, (5,)."""
        change = multiplier_change(self.multipliers, fine.multipliers)
        return np.append(path_differences(self.path, fine.path), change)
