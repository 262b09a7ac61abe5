"""The first cycle of a branch of asymmetric cycles, from the symmetry breaking where the branch starts.

Near the symmetry breaking the asymmetry t grows along the null vector of the linearised equations, and the
parameter is an even function of t, p0 + A t^2 + B t^4. If A and B have opposite signs, the branch has a fold
at t^2 = -A/(2B). The first cycle lies before such a fold, so that the fold is found on a later step.
"""

from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from ....arrays import Array
from ...cycle.accuracy.newton_tolerances import allowed_distance_from_matrix_orbit
from ...cycle.accuracy.settings import REFINEMENT_SETTINGS
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.measures import CycleMotion
from ...orbit.mesh_choice import cheapest_stage_count, mesh_from_coefficient_tails
from ...orbit.newton import relative_change
from ...orbit.orbit import Orbit
from ...unsolvable import Unsolvable
from ..arc_length_step import BranchCycle, branch_derivatives, tangent_at
from ..bordered.border_condition import BorderCondition, moved_orbit
from ..bordered.corrected_linearisation import linearisation_of
from ..bordered.matrix import BorderedMatrix
from ..bordered.scale import ArcLengthScale, deflection_at_time_zero
from ..branch_errors import branch_newton_tolerance
from ..branch_mesh_choice import first_cycle_with_measured_errors
from ..settings import BRANCH_END_SETTINGS
from ..symmetry_breaking import SymmetryBreaking, bending_moment_asymmetry, extended_to_whole_period
from .first_cycle import DEFLECTION_UNIT_VECTOR


@dataclass(frozen=True, slots=True, kw_only=True)
class AsymmetricStartSettings:
    """Settings for the first asymmetric cycle near a symmetry breaking."""

    first_cycle_relative_distances: tuple[float, ...] = (0.03, 0.01, 0.1)
    """Relative differences between the predicted first asymmetric cycle and the symmetric cycle, tried in
    this order."""
    max_accuracy: float = 1e-4
    """Largest relative accuracy of asymmetric cycles: a coarser mesh does not separate asymmetric cycles from
    the symmetric cycles nearby. At an accuracy of 1e-3 Newton's method converges to symmetric cycles for 4 of
    6 rods, at 3e-4 for none."""
    newton_tolerance_for_fold_search: float = 1e-9
    """Tolerance of Newton's method for the cycles at which the derivative of the parameter along the branch
    is computed; these derivatives show whether a fold lies before the first cycle."""
    max_accuracy_beside_fold: float = 1e-6
    """Largest relative accuracy of the cycles of a branch with a fold before the first cycle. On a coarser
    mesh the fold may be missing: at an accuracy of 1e-5, a fold at a relative distance of 7e-7 from the
    symmetry breaking was missing."""
    first_over_fold_asymmetry: float = 0.5
    """If the branch has a fold before the first cycle, the asymmetry of the first cycle is reduced to this
    fraction of the asymmetry at the fold."""


ASYMMETRIC_START_SETTINGS = AsymmetricStartSettings()


def first_asymmetric_cycle(
    breaking: SymmetryBreaking,
    name: str,
    accuracy: float,
    workspace: NewtonWorkspace,
    min_coordinate_unit: float = 0.0,
) -> tuple[BranchCycle, float]:
    """Returns (cycle, relative accuracy): the first asymmetric cycle of the branch from the symmetry breaking
    `breaking` along the parameter `name`, and its relative accuracy, which is `accuracy`, or a smaller number
    if a fold lies close to the symmetry breaking. Raises Unsolvable. Of a cycle and its mirror image, the
    cycle with the larger maximum of the tip's y is returned. min_coordinate_unit: lower limit of the unit in
    which the parameter coordinate enters the arc length (`ArcLengthScale`)."""
    if breaking.special_point.orbit is None:
        raise Unsolvable("the cycle at which the symmetry breaks is not known")
    full_orbit = extended_to_whole_period(breaking.special_point.orbit)
    scale = ArcLengthScale.at_orbit(full_orbit, name, 0.0, min_coordinate_unit)
    matrix = BorderedMatrix(full_orbit, scale, workspace)
    # At the symmetry breaking the linearised equations at a fixed parameter have an asymmetric solution.
    null_vector = matrix.approximate_null_vector()
    # With this norm a multiple of the vector is the relative distance that the settings give.
    null_vector = null_vector / relative_change(full_orbit, null_vector[:-1])
    first_distance = ASYMMETRIC_START_SETTINGS.first_cycle_relative_distances[0]
    # The two signs give mirror images. The cycle with the larger y is followed, so that the result does not
    # depend on the sign of the null vector.
    directions = [_AsymmetricCycles(full_orbit, matrix, sign * null_vector, accuracy) for sign in (1, -1)]
    cycles = max(
        directions, key=lambda one: CycleMotion(one.predicted_orbit(first_distance)).tip_extrema["tip_y_max"]
    )
    for distance in ASYMMETRIC_START_SETTINGS.first_cycle_relative_distances:
        try:
            allowed_distance = cycles.distance_before_fold(distance)
            if allowed_distance < distance:
                # On a coarse mesh the fold beside the symmetry breaking may not exist.
                finer_accuracy = min(accuracy, ASYMMETRIC_START_SETTINGS.max_accuracy_beside_fold)
                cycles = replace(cycles, accuracy=finer_accuracy)
            return cycles.first_cycle(allowed_distance), cycles.accuracy
        except Unsolvable as error:
            reason = error
    raise Unsolvable(f"no cycle is solved near the symmetry breaking: {reason}") from reason


def _require_predicted_asymmetry(orbit: Orbit, predicted: Orbit) -> None:
    """Raises Unsolvable if the asymmetry of `orbit` is far from the asymmetry of its prediction
    `predicted`."""
    expected_asymmetry = bending_moment_asymmetry(predicted)
    # Asymmetries are compared node by node, so both must have one mesh in space.
    orbit_on_mesh = orbit.on_mesh(predicted.form.mesh, orbit.interval_count, orbit.stage_count)
    ratio = float(bending_moment_asymmetry(orbit_on_mesh) @ expected_asymmetry) / float(
        expected_asymmetry @ expected_asymmetry
    )
    # A ratio near 0 is the symmetric cycle itself, which solves the same equations.
    min_ratio, max_ratio = BRANCH_END_SETTINGS.allowed_asymmetry_to_prediction_ratios
    if not min_ratio < ratio < max_ratio:
        raise Unsolvable("Newton's method converged to a cycle whose asymmetry is not the predicted one")


@dataclass(frozen=True, eq=False, slots=True)
class _AsymmetricCycles:
    """One half of a branch of asymmetric cycles, near the symmetric cycle at its symmetry breaking. A cycle
    is identified by its relative distance from the symmetric cycle."""

    symmetric_orbit: Orbit
    """The symmetric cycle at the symmetry breaking, over the whole period."""
    matrix: BorderedMatrix
    """Bordered matrix of the symmetric cycle; its `scale` contains the units of arc length."""
    null_vector: Array
    """Null vector of the linearised equations at the symmetric cycle, (N + 1,): change of orbit values and
    parameter coordinate for the relative distance 1."""
    accuracy: float
    """Relative accuracy of the cycles."""

    def predicted_orbit(self, distance: float) -> Orbit:
        """The prediction of the cycle at a relative distance; raises Unsolvable."""
        return moved_orbit(
            self.symmetric_orbit, self.matrix.scale.parameter_name, distance * self.null_vector
        )

    def distance_before_fold(self, distance: float) -> float:
        """`distance`, or a smaller relative distance from the symmetric cycle if the branch has a fold
        between the symmetric cycle and the cycle at `distance`; raises Unsolvable."""
        # The parameter is p0 + A t^2 + B t^4 with t = 1 at `distance`; its derivatives give A and B.
        parameter_rate = self._parameter_per_arc_length(distance)
        half_distance_rate = self._parameter_per_arc_length(distance / 2)
        # From p' = 2 A t + 4 B t^3 at t = 1 and t = 1/2; only the ratio A/B matters, not the scale.
        A = (8 * half_distance_rate - parameter_rate) / 6
        B = (parameter_rate - 2 * A) / 4
        # The parameter still moves as it started, so no fold lies between.
        if A * parameter_rate >= 0:
            return distance
        return distance * ASYMMETRIC_START_SETTINGS.first_over_fold_asymmetry * sqrt(-A / (2 * B))

    def _parameter_per_arc_length(self, distance: float) -> float:
        """Derivative of the scaled parameter coordinate with respect to arc length at the cycle at a relative
        distance; raises Unsolvable."""
        solved = self._predicted_deflection_condition(distance).solve_cycle(
            self.predicted_orbit(distance),
            ASYMMETRIC_START_SETTINGS.newton_tolerance_for_fold_search,
            self.matrix.workspace,
        )
        scale = self.matrix.scale
        tangent = tangent_at(solved.orbit, scale, self._border(distance), linearisation_of(solved))
        return branch_derivatives(solved, scale, tangent).parameter_per_arc_length

    def first_cycle(self, distance: float) -> BranchCycle:
        """The cycle at a relative distance, as the first cycle of a branch; raises Unsolvable."""
        start = self.predicted_orbit(distance)
        condition = self._predicted_deflection_condition(distance)
        solved = condition.solve_cycle(
            start, REFINEMENT_SETTINGS.nearby_orbit_newton_tolerance, self.matrix.workspace
        )
        near_orbit = solved.orbit
        _require_predicted_asymmetry(near_orbit, start)
        mesh_accuracy = max(self.accuracy, REFINEMENT_SETTINGS.min_first_mesh_accuracy)
        mesh = mesh_from_coefficient_tails(near_orbit, mesh_accuracy, cheapest_stage_count(self.accuracy))
        first = condition.solve_on_mesh(
            mesh,
            solved,
            branch_newton_tolerance(self.accuracy),
            allowed_distance_from_matrix_orbit(self.accuracy),
        )
        scale = self.matrix.scale
        arc_from_start = abs(self._predicted_deflection_change(distance)) / scale.deflection_unit
        cycle = first_cycle_with_measured_errors(
            first, scale, self._border(distance), arc_from_start, self.accuracy
        )
        # Again, because the correction on the final mesh may still fall onto the symmetric cycle.
        _require_predicted_asymmetry(cycle.orbit, start)
        return cycle

    def _predicted_deflection_change(self, distance: float) -> float:
        """Deflection of the prediction at a relative distance minus deflection of the symmetric cycle."""
        return deflection_at_time_zero(self.predicted_orbit(distance)) - deflection_at_time_zero(
            self.symmetric_orbit
        )

    def _border(self, distance: float) -> Array:
        return np.asarray(np.sign(self._predicted_deflection_change(distance)) * DEFLECTION_UNIT_VECTOR)

    def _predicted_deflection_condition(self, distance: float) -> BorderCondition:
        """The condition that a cycle has the deflection of the prediction at a relative distance."""
        return BorderCondition.at_arc_length(
            self.matrix.scale, self._border(distance), self.predicted_orbit(distance)
        )
