"""A cycle by way of three coarser meshes, which say where it lies and how large its errors will be.

One is coarser in space, one in time, one in both. The orbits of the first two less that of the third are that
of the fine mesh but for a product of two small errors (the combination technique: Griebel, Schneider, Zenger
1992), so that one elimination there gives the cycle and its multipliers. By what they differ the errors of
the coarse meshes are known, and those of the fine one by how fast errors fall at least.
"""

from dataclasses import replace

import numpy as np

from ....arrays import Array
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.newton import multiplier_change, newton
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh
from ...orbit.path_differences import path_differences
from ...orbit.tails import tails_of
from .calibration import LARGEST_FALL, LEAST_FALL, Calibration, calibration_of
from .finer_meshes import TOLERANCE, ComparedCycle

ORDERS_LESS, TIMES_FEWER = 2, 1.4
"""Orders and intervals of the coarse mesh beside those of the fine one that it is made for."""
SERVED_ORDERS, SERVED_INTERVALS = 4, 2.0
"""Orders that a fine mesh may have more, and times how many intervals."""
SLOWEST_FALL = 1.2
"""Of errors in space per order, natural logarithm: the least, in units of the decay of the coefficients."""


class CoarserMeshes:
    """The cycle on a coarse mesh, and on those that are finer in space or in time alone."""

    def __init__(self, mesh: OrbitMesh, near: Orbit, accuracy: float, workspace: NewtonWorkspace) -> None:
        """mesh: the fine one; near: an orbit near by, on any mesh. Raises Unsolvable."""
        order, intervals = mesh.order - ORDERS_LESS, round((mesh.intervals - 1) / TIMES_FEWER) + 1
        self.mesh, self._tolerance = replace(mesh, order=order, intervals=intervals), TOLERANCE * accuracy
        self._workspace = workspace
        self._both = self._solved(self.mesh, near)
        self._finer: dict[OrbitMesh, ComparedCycle] = {}

    def serve(self, mesh: OrbitMesh) -> bool:
        """Whether they predict the cycle on a fine mesh."""
        few = (
            mesh.order - self.mesh.order <= SERVED_ORDERS and self._refined_in_time(mesh) <= SERVED_INTERVALS
        )
        return few and (mesh.elements, mesh.stages) == (self.mesh.elements, self.mesh.stages)

    def predicted(self, mesh: OrbitMesh) -> tuple[Orbit, Calibration]:
        """The orbit on a fine mesh, and the errors that it will have there; raises Unsolvable."""
        space, time = self._on(order=mesh.order), self._on(intervals=mesh.intervals)
        at = [mesh.carry(each.orbit) for each in (space, time, self._both)]
        orbit = replace(at[0], values=at[0].values + at[1].values - at[2].values)
        fall = min(max(SLOWEST_FALL * tails_of(space.orbit).decay, LEAST_FALL), LARGEST_FALL)
        by_orders = np.exp(fall * (mesh.order - self.mesh.order))
        by_intervals = self._refined_in_time(mesh) ** (mesh.stages + 1)
        # Each of these two has one of the two errors; those of the fine mesh are not said to be smaller.
        apart = multiplier_change(space.multipliers, time.multipliers)
        in_space = np.append(self._errors(space, by_orders), 0.0)
        in_time = np.append(self._errors(time, by_intervals), apart)
        return orbit, calibration_of(mesh, in_space, in_time, orbit, None)

    def _on(self, **finer: int) -> ComparedCycle:
        mesh = replace(self.mesh, **finer)
        if mesh not in self._finer:
            self._finer[mesh] = self._solved(mesh, self._both.orbit)
        return self._finer[mesh]

    def _solved(self, mesh: OrbitMesh, near: Orbit) -> ComparedCycle:
        return ComparedCycle(newton(mesh.carry(near), self._tolerance, self._workspace))

    def _errors(self, finer: ComparedCycle, factor: float) -> Array:
        """One part of the errors on a mesh where it is smaller than on the coarse one by a factor, (4,)."""
        errors: Array = path_differences(self._both.path, finer.path) / (factor - 1)
        return errors

    def _refined_in_time(self, mesh: OrbitMesh) -> float:
        return (mesh.intervals - 1) / (self.mesh.intervals - 1)
