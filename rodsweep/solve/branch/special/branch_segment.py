"""Segment of a branch between two successive cycles, on which a special point is located."""

from ....arrays import Array
from ...orbit.newton import ConvergedOrbit
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import mesh_of_orbit
from ...unsolvable import Unsolvable
from ..arc_length_step import BranchCycle, arc_length_between
from ..bordered.border_condition import moved_orbit
from ..bordered.corrected_linearisation import nearby_bordered_matrix
from ..bordered.matrix import BorderedMatrix
from ..branch_prediction import parameter_change_polynomial
from .augmented.fold_and_torus_test_functions import FoldTestFunction, correct_until_converged
from .special_point import SPECIAL_POINT_SETTINGS


class BranchSegment:
    """Segment of a branch from the cycle `start` to the next cycle `end`, on which cycles are solved at any
    arc length. mesh: mesh on which `cycle_at` solves cycles, at first the mesh of `end`; it may be changed.
    The first cycle on a mesh is predicted from the last cycle on the previous mesh; on the first mesh, by the
    polynomial through the cycles up to `end`."""

    def __init__(self, start: BranchCycle, end: BranchCycle) -> None:
        self.start = start
        self.end = end
        self.mesh = mesh_of_orbit(end.orbit)
        self.length = arc_length_between(start, end)
        self._length_along_end_tangent = float(
            end.unit_tangent @ (end.scale.components(end.orbit) - end.scale.components(start.orbit))
        )
        self._last_solved: tuple[float, Orbit, Array] | None = None
        self._matrix: BorderedMatrix | None = None

    def predicted_orbit(self, length: float) -> Orbit:
        """Predicted orbit at the arc length `length` from `start`, on the mesh of `end`, by the
        polynomial through the cycles up to `end`."""
        # This polynomial passes through both cycles; its variable is the arc length along the tangent at
        # `end`.
        return self.end.predicted_orbit(-self._length_along_end_tangent * (1 - length / self.length))

    def predicted_fold_length_and_slope(self) -> tuple[float, float]:
        """Returns (arc length from `start`, slope of `parameter_per_arc_length` there) of the fold of the
        polynomial through the cycles up to `end`; raises Unsolvable if it has not exactly one fold between
        `start` and `end`."""
        ends = (-self._length_along_end_tangent, 0.0)
        rate = parameter_change_polynomial(self.end.tangent, self.end.earlier_cycles, ends).deriv()
        roots = rate.roots()
        folds = roots.real[(roots.imag == 0) & (roots.real > ends[0]) & (roots.real < 0)]
        if len(folds) != 1:
            raise Unsolvable("the prediction has no single fold between the two cycles")
        # From the arc length along the tangent at `end` to the arc length along the tangent at `start`.
        ratio = self._length_along_end_tangent / self.length
        slope = float(rate.deriv()(folds[0])) * ratio**2 / self.start.scale.coordinate_unit
        return self.length + float(folds[0]) / ratio, slope

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
            start = (
                predicted
                if mesh_of_orbit(predicted) == self.mesh
                else self.mesh.interpolated_orbit(predicted)
            )
        condition = self.start.arc_length_condition(length)
        workspace = self.start.workspace
        solved = condition.solve_cycle(
            start,
            SPECIAL_POINT_SETTINGS.relative_cycle_tolerance,
            workspace,
            SPECIAL_POINT_SETTINGS.max_distance_from_matrix_orbit,
            self._nearby_matrix(start),
        )
        self._matrix = nearby_bordered_matrix(solved)
        # The tangent is corrected with the factors of the nearby cycle, so no second matrix is factorised.
        function = FoldTestFunction(self._matrix, self.start.unit_tangent, False)
        correct_until_converged(function, solved.orbit)
        self._last_solved = length, solved.orbit, function.null_vectors
        return solved

    def matrix_at(self, orbit: Orbit) -> BorderedMatrix:
        """Newton's matrix at `orbit`; the next cycle is solved with its factors if the cycle is near."""
        self._matrix = BorderedMatrix(orbit, self.start.scale, self.start.workspace)
        return self._matrix

    def _nearby_matrix(self, orbit: Orbit) -> BorderedMatrix | None:
        """The last matrix of this segment if its factors are still valid and it was assembled on the same
        mesh near `orbit`; otherwise None."""
        matrix = self._matrix
        if (
            matrix is None
            or not matrix.has_valid_factors
            or mesh_of_orbit(matrix.orbit) != mesh_of_orbit(orbit)
        ):
            return None
        is_near = (
            matrix.relative_distance_to_orbit(orbit) <= SPECIAL_POINT_SETTINGS.max_distance_from_matrix_orbit
        )
        return matrix if is_near else None

    @property
    def last_arc_length_cycle_and_tangent(self) -> tuple[float, Orbit, Array]:
        """(arc length from `start`, orbit, derivative of orbit values and parameter coordinate with respect
        to arc length, (N + 1,)) of the last cycle that `cycle_at` solved; raises ValueError if no cycle was
        solved."""
        if self._last_solved is None:
            raise ValueError("no cycle was solved on this segment and mesh yet")
        return self._last_solved

    def parameter_per_arc_length(self) -> float:
        """Derivative of the parameter coordinate (1/k for a stiffness k), in units of the scale at `start`,
        with respect to arc length, at the last cycle that `cycle_at` solved."""
        return float(self.last_arc_length_cycle_and_tangent[2][-1]) / self.start.scale.coordinate_unit
