"""Segment of a branch between two successive cycles, on which a special point is located."""

from ....arrays import Array
from ...orbit.newton import ConvergedOrbit
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, mesh_of
from ..arc_length_step import BranchCycle, arc_length_between
from ..bordered.condition import moved_orbit
from ..bordered.corrected_linearisation import bordered_matrix_of
from .augmented.fold_and_torus_functions import FoldFunction, correct_until_converged
from .special_point import SPECIAL_POINT_SETTINGS


class BranchSegment:
    """Segment of a branch from the cycle `start` to the next cycle `end`, on which cycles are solved at any
    arc length."""

    def __init__(self, start: BranchCycle, end: BranchCycle) -> None:
        self.start = start
        self.end = end
        self.length = arc_length_between(start, end)
        self._length_along_end_tangent = float(
            end.unit_tangent @ (end.scale.components(end.orbit) - end.scale.components(start.orbit))
        )
        self._last_solved: tuple[float, Orbit, Array] | None = None

    def predicted_orbit(self, length: float) -> Orbit:
        """Predicted orbit at the arc length `length` from `start`, on the mesh of `end`, by the cubic through
        the cycles `start` and `end`."""
        # The cubic of `end` passes through both cycles; its variable is the arc length along the tangent at
        # `end`.
        return self.end.predicted_orbit(-self._length_along_end_tangent * (1 - length / self.length))

    def set_mesh(self, mesh: OrbitMesh) -> None:
        """Sets the mesh on which `cycle_at` solves cycles. The first cycle on this mesh is predicted from the
        last cycle on the mesh before; on the first mesh, by the cubic."""
        self.mesh = mesh

    def cycle_at(self, length: float) -> ConvergedOrbit:
        """The cycle at the arc length `length` from `start`, with the matrix of a nearby orbit; raises
        Unsolvable."""
        if self._last_solved is None:
            start = self.mesh.interpolated_orbit(self.predicted_orbit(length))
        else:
            last_length, orbit, tangent = self._last_solved
            # Predicted from the last cycle along its tangent: a secant method changes the length only a
            # little.
            predicted = moved_orbit(orbit, self.start.scale.parameter_name, (length - last_length) * tangent)
            start = predicted if mesh_of(predicted) == self.mesh else self.mesh.interpolated_orbit(predicted)
        condition = self.start.arc_length_condition(length)
        workspace = self.start.workspace
        solved = condition.solve_cycle(
            start,
            SPECIAL_POINT_SETTINGS.cycle_tolerance,
            workspace,
            SPECIAL_POINT_SETTINGS.max_matrix_distance,
        )
        # The tangent is corrected with the factors of the nearby cycle, so no second matrix is factorised.
        function = FoldFunction(bordered_matrix_of(solved), self.start.unit_tangent, False)
        correct_until_converged(function, solved.orbit)
        self._last_solved = length, solved.orbit, function.null_vectors
        return solved

    @property
    def last_solved_cycle(self) -> tuple[float, Orbit, Array]:
        """(arc length from `start`, orbit, derivative of orbit values and parameter coordinate with respect
        to arc length, (N + 1,)) of the last cycle that `cycle_at` solved; raises ValueError if no cycle was
        solved."""
        if self._last_solved is None:
            raise ValueError("no cycle was solved on this segment and mesh yet")
        return self._last_solved

    def parameter_rate(self) -> float:
        """Derivative of the scaled parameter coordinate with respect to arc length, at the last cycle that
        `cycle_at` solved."""
        return float(self.last_solved_cycle[2][-1]) / self.start.scale.coordinate_unit
