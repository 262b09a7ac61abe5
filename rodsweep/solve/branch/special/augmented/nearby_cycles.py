"""Cycles near a cycle whose Newton matrix is factorised, corrected together with a test function from the
module `fold_and_torus_test_functions`. A new matrix is assembled only if the corrections converge slowly."""

from typing import TYPE_CHECKING

from .....solve_progress import report
from ....orbit.orbit import Orbit
from ....unsolvable import Unsolvable
from ...bordered.border_condition import BorderCondition, moved_orbit
from ...bordered.matrix import BorderedMatrix
from .fold_and_torus_test_functions import MINIMALLY_AUGMENTED_SETTINGS

if TYPE_CHECKING:
    from ..cycle_family import CycleFamily  # for annotations only: the module imports this one


class NearbyCycleSolver:
    """Solver for the cycles near an orbit whose Newton matrix is factorised, and for the values of the test
    function at these cycles. The family defines the rods, the units of arc length and the test function."""

    def __init__(self, family: "CycleFamily", start: Orbit, contraction: float) -> None:
        """family: defines rods and test function of the cycles. start: orbit at which the first matrix is
        assembled. contraction: initial value of `contraction_rate`, measured at earlier cycles of the family;
        inf if unknown."""
        self._family = family
        self.contraction_rate = contraction
        """Assumed contraction rate: ratio of successive corrections of a cycle, divided by the relative
        distance of the cycle from the orbit at which the matrix was assembled. Each solved cycle updates the
        rate, unless the cycles are small (`CycleFamily.has_small_cycles`)."""
        self._assemble_matrix(start)

    def _assemble_matrix(self, orbit: Orbit) -> None:
        """Assembles and factorises a new matrix at an orbit, with a new test function. Sets
        `distance_from_matrix_orbit`, the relative distance of the current cycle from this orbit, to 0."""
        self.matrix = BorderedMatrix(orbit, self._family.scale, self._family.workspace)
        self.distance_from_matrix_orbit = 0.0
        self.test_function = self._family.test_function(self.matrix)

    def cycle_and_test_value(
        self, orbit: Orbit, condition: BorderCondition, slope: float, tolerance: float
    ) -> tuple[Orbit, float]:
        """Returns (cycle near `orbit` that fulfils `condition`, value of its test function); raises
        Unsolvable.

        condition: equation that selects one of the nearby cycles. slope: approximate modulus of the
        derivative of the test function across the curve. tolerance: relative tolerance of cycle and test
        function; far from the curve, where the test function is not near 0, a multiple of that distance is
        enough (`MINIMALLY_AUGMENTED_SETTINGS.cycle_tolerance_over_curve_distance`)."""
        previous_change = 0.0
        for _ in range(MINIMALLY_AUGMENTED_SETTINGS.max_corrections_per_cycle):
            report()
            orbit, change = self._corrected_orbit_and_change(orbit, condition)
            distance = self.distance_from_matrix_orbit
            previous_value = self.test_function.value(orbit)
            self.test_function.correct_null_vectors(orbit)
            # Cycle and test function are corrected in turn: at a wrong cycle the exact function has no use.
            value = self.test_function.value(orbit)
            # The change of the test function, divided by `slope`, is a distance across the curve.
            change_after_step = max(change, abs(value - previous_value) / slope)
            # At the first correction the ratio is estimated from the distance to the cycle of the matrix.
            correction_ratio = (
                change_after_step / previous_change
                if previous_change
                else min(1.0, self.contraction_rate * distance)
            )
            # Divided by a small deflection, the test function changes for reasons other than the matrix.
            if previous_change and not self._family.has_small_cycles:
                contraction = (
                    MINIMALLY_AUGMENTED_SETTINGS.contraction_safety_factor * correction_ratio / distance
                )
                min_rate = MINIMALLY_AUGMENTED_SETTINGS.min_assumed_contraction_rate
                self.contraction_rate = max(min_rate, contraction)
            # The product predicts the next change, that is the error left after this correction.
            if change_after_step * min(correction_ratio, 1.0) <= max(
                tolerance,
                MINIMALLY_AUGMENTED_SETTINGS.cycle_tolerance_over_curve_distance * abs(value) / slope,
            ):
                return orbit, value
            if (
                previous_change
                and correction_ratio > MINIMALLY_AUGMENTED_SETTINGS.max_successive_correction_ratio
            ):
                # Corrections that stall at this size are rounding, which a new matrix would not reduce.
                if change_after_step <= MINIMALLY_AUGMENTED_SETTINGS.max_relative_correction_by_rounding:
                    return orbit, value
                self._assemble_matrix(orbit)
                # With a new matrix no ratio to the last change is known.
                change_after_step = 0.0
            previous_change = change_after_step
        raise Unsolvable(
            f"Newton's method for the cycle does not converge: its last relative step is {change:.0e}"
        )

    def _corrected_orbit_and_change(self, orbit: Orbit, condition: BorderCondition) -> tuple[Orbit, float]:
        """(orbit after one correction under `condition` with the current matrix, relative change of the
        orbit); raises Unsolvable."""
        step = self.matrix.newton_step_at_nearby_orbit(orbit, condition.border, condition.residual(orbit))
        change = condition.require_small_relative_change(orbit, step)
        self.distance_from_matrix_orbit += change
        return moved_orbit(orbit, condition.scale.parameter_name, step), change
