"""Secant method across a curve of special points, for one point of the curve.

All cycles and test functions are corrected with the matrix factors of one cycle (`augmented`). The first
derivatives across the curve come from the previous point. The last step is linear; its error follows from the
curvature of the test function, which is large near a generalised Hopf point. N is the number of orbit values.
"""

import math
from dataclasses import replace
from math import inf
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ....arrays import Array
from ....model.parameters import PARAMETERS
from ...orbit.newton import relative_change
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import mesh_of_orbit
from ...unsolvable import Unsolvable
from ..arc_length_step import tangent_at
from ..bordered.border_condition import BorderCondition, moved_orbit
from ..bordered.scale import ArcLengthScale
from .augmented.fold_and_torus_test_functions import MINIMALLY_AUGMENTED_SETTINGS
from .augmented.nearby_cycles import NearbyCycleSolver
from .solved_curve_point import CURVE_SECANT_SETTINGS, NormalDerivatives, SearchLine, SolvedCurvePoint

if TYPE_CHECKING:
    from .cycle_family import CycleFamily  # for annotations only: the module imports this one


class _SecantIterate(NamedTuple):
    """A cycle solved by the secant method. orbit: its orbit. null_vectors: null vectors of the test function:
    tangent (fold), (N + 1,), or eigenvector (torus), (2, N + 1). test_value: value of the test function.
    distance_across_curve: distance from the predicted point, in the direction across the curve."""

    orbit: Orbit
    null_vectors: Array
    test_value: float
    distance_across_curve: float


class SecantSearch:
    """State of the secant method across a curve; all cycles are corrected with the matrix factors of one
    cycle. family, start, row_coordinate: the family of cycles, the orbit at which the search starts, and its
    row coordinate: position, from 0 to 1, of the second parameter on its axis. line: line of the search.
    derivatives: derivatives from an earlier search, or None. is_other_mesh: whether these derivatives were
    computed at the same point on another mesh. orbit: current cycle. distance: distance of this cycle from
    the start of the search along `line`. start_arc_length: arc length of this start along the branch."""

    def __init__(
        self,
        family: "CycleFamily",
        start: Orbit,
        row_coordinate: float,
        line: SearchLine,
        derivatives: NormalDerivatives | None,
        is_other_mesh: bool,
    ) -> None:
        self.family = family
        self.row_coordinate = row_coordinate
        self.line = line
        self.derivatives = derivatives
        self.orbit = family.unsolved_orbit_at_row(start, row_coordinate)
        self.distance = 0.0
        self.previous: _SecantIterate | None = None
        # All cycles of this search measure arc length along the border, from the same origin.
        self.start_arc_length = float(family.branch_direction @ family.scale.components(start))
        self.has_previous_point_derivatives = not is_other_mesh
        """Whether the derivatives come from the previous point of the curve."""
        self.measured_curvature = derivatives.relative_test_function_curvature if derivatives else inf
        self.curvature = CURVE_SECANT_SETTINGS.curvature_growth_factor * self.measured_curvature
        """Estimate of abs(f''/f') of the test function f along the search line; inf if unknown."""
        self.measured_slopes: list[tuple[float, float]] = []
        """Measured derivatives of the test function: (middle of the two cycles, derivative)."""
        contraction = derivatives.contraction_rate if derivatives and not family.has_small_cycles else inf
        self.nearby_solver = NearbyCycleSolver(family, self.orbit, contraction)

    def make_step(self) -> SolvedCurvePoint | None:
        """Makes one secant step. Returns the point of the curve if this step is accurate enough to be the
        last, otherwise None. Raises Unsolvable."""
        current = self._solve_at_distance()
        span = 0.0
        if measured_derivatives := self._derivatives_from_last_two_cycles(current):
            self.derivatives = measured_derivatives
            self.has_previous_point_derivatives = False
            span = measured_derivatives.difference_quotient_distance
        rates = self.derivatives
        settings = CURVE_SECANT_SETTINGS
        # Without derivatives any small step suffices: the two cycles then give derivatives.
        step = -current.test_value / rates.test_function_slope if rates else settings.first_secant_step
        # Negated, so that a step of nan is refused too.
        if not abs(step) <= settings.max_secant_step:
            raise Unsolvable(
                "the secant step to a point of the curve is too large: the cycle from which it starts is too "
                "far from the curve"
            )
        if rates:
            error = self._distance_from_curve_after_step(step, span)
            if self._is_accurate_enough(error):
                derivatives = replace(
                    rates,
                    contraction_rate=self.nearby_solver.contraction_rate,
                    relative_test_function_curvature=self.measured_curvature,
                )
                return self._curve_point(step, derivatives, error)
            min_distance = settings.min_cycle_distance_for_derivatives
            if self.has_previous_point_derivatives and abs(step) < min_distance:
                # Between closer cycles no derivative can be measured.
                step = math.copysign(2 * min_distance, step)
        if self.previous:  # the vectors are extrapolated along a line, like the cycle
            distance = current.distance_across_curve - self.previous.distance_across_curve
            change = (current.null_vectors - self.previous.null_vectors) / distance
            self.nearby_solver.test_function.null_vectors = current.null_vectors + step * change
        if rates:
            self.orbit = self._predicted_orbit(step, rates)
        self.previous = current
        self.distance += step
        return None

    def _distance_from_curve_after_step(self, step: float, span: float) -> float:
        """Estimated distance from the curve after a last, linear step of the signed length `step`. span:
        distance between the two cycles from which the derivative was measured at this step; 0 if none was
        measured."""
        if step == 0:
            return 0.0  # even if the curvature is unknown
        if span:
            # Remainder of linear interpolation through two values, extrapolated to their zero.
            return self.curvature * abs(step) * (abs(step) + span) / 2
        assert self.derivatives is not None
        slope_span = self.derivatives.difference_quotient_distance
        slope_error = CURVE_SECANT_SETTINGS.relative_slope_error + self.curvature * slope_span / 2
        if self.has_previous_point_derivatives:
            # Along the curve a derivative changes more where the curvature is large.
            slope_error = CURVE_SECANT_SETTINGS.relative_error_of_previous_slope * max(1.0, self.curvature)
        # A wrong slope can at most make the whole step wrong.
        return min(slope_error, 1.0) * abs(step)

    def _is_accurate_enough(self, error: float) -> bool:
        """Whether a point is accurate enough whose distance from the curve, along the search line, is
        estimated as `error`: within the tolerance of Newton's method for cycles, or with a displacement of
        the parameter within its accuracy."""
        if error <= MINIMALLY_AUGMENTED_SETTINGS.relative_cycle_tolerance:
            return True
        parameter = abs(getattr(self.orbit.form.rod, self.family.scale.parameter_name))
        settings = CURVE_SECANT_SETTINGS
        max_error = settings.max_secant_error_per_accuracy * settings.relative_parameter_accuracy * parameter
        is_near = error <= settings.max_distance_from_curve
        return is_near and self._parameter_error_at_distance(error) <= max_error

    def _solve_at_distance(self) -> _SecantIterate:
        """The cycle at the current distance along the line, with its test value; raises Unsolvable."""
        family = self.family
        rates = self.derivatives
        length = self.start_arc_length + self.distance * float(self.line.direction[0])
        row = self.row_coordinate + self.distance * float(self.line.direction[1])
        self.orbit = family.unsolved_orbit_at_row(self.orbit, row)
        slope = abs(rates.test_function_slope) if rates else 1.0
        settings = MINIMALLY_AUGMENTED_SETTINGS
        first_tolerance = (
            settings.cycle_tolerance_over_curve_distance * CURVE_SECANT_SETTINGS.first_secant_step
        )
        tolerance = settings.relative_cycle_tolerance if rates else first_tolerance
        condition = BorderCondition(family.scale, family.branch_direction, length)
        self.orbit, test_value = self.nearby_solver.cycle_and_test_value(
            self.orbit, condition, slope, tolerance
        )
        vectors = self.nearby_solver.test_function.null_vectors
        return _SecantIterate(self.orbit, vectors, test_value, self.distance)

    def _derivatives_from_last_two_cycles(self, current: _SecantIterate) -> NormalDerivatives | None:
        """Derivatives across the curve from the previous cycle and `current`; None if `current` is the first
        cycle, or if the two cycles are too close or have equal test functions."""
        previous = self.previous
        # Equal values would give a slope of 0, by which the next step is divided.
        if previous is None or current.test_value == previous.test_value:
            return None
        span = current.distance_across_curve - previous.distance_across_curve
        if abs(span) < CURVE_SECANT_SETTINGS.min_cycle_distance_for_derivatives:
            return None
        name = self.family.scale.parameter_name
        # The test function is nearly linear here, so that difference quotients are as good as derivatives.
        previous_orbit = previous.orbit
        current_orbit = current.orbit
        change = current_orbit.form.rod.coordinate(name) - previous_orbit.form.rod.coordinate(name)
        orbit_derivative = np.append(current_orbit.values - previous_orbit.values, change) / span
        test_slope = (current.test_value - previous.test_value) / span
        # A difference quotient is the derivative at the middle of its interval, to second order.
        middle = (current.distance_across_curve + previous.distance_across_curve) / 2
        self._update_relative_second_derivative(middle, test_slope)
        return NormalDerivatives(
            self.line.direction, test_slope, orbit_derivative, mesh_of_orbit(previous_orbit), abs(span)
        )

    def _update_relative_second_derivative(self, middle: float, slope: float) -> None:
        """Updates `curvature`, abs(f''/f') of the test function f along the search line, from the last two
        measured derivatives. middle: distance at which the derivative f' is `slope`."""
        self.measured_slopes.append((middle, slope))
        if len(self.measured_slopes) > 1:
            (previous_middle, previous_slope), (last_middle, last_slope) = self.measured_slopes[-2:]
            if last_middle != previous_middle:
                self.measured_curvature = self.curvature = abs(
                    (last_slope - previous_slope) / (last_middle - previous_middle) / last_slope
                )

    def _predicted_orbit(self, step: float, derivatives: NormalDerivatives) -> Orbit:
        """The current cycle, moved by `step` across the curve along `derivatives`."""
        change = step * derivatives.orbit_derivative_on_mesh_of(self.orbit)
        # The prediction also moves the cycle away from the orbit at which the matrix was assembled.
        self.nearby_solver.distance_from_matrix_orbit += relative_change(self.orbit, change[:-1])
        return moved_orbit(self.orbit, self.family.scale.parameter_name, change)

    def _curve_point(
        self, step: float, derivatives: NormalDerivatives, distance_error: float
    ) -> SolvedCurvePoint:
        """The point of the curve: the current cycle, moved by `step` across the curve along `derivatives`.
        distance_error: distance of this point from the curve."""
        family = self.family
        matrix = self.nearby_solver.matrix
        tangent = tangent_at(matrix.orbit, family.scale, family.branch_direction, matrix)
        row_coordinate = self.row_coordinate + (self.distance + step) * float(self.line.direction[1])
        orbit = family.unsolved_orbit_at_row(self._predicted_orbit(step, derivatives), row_coordinate)
        # The units follow the new orbit, but keep the lower limits that the family has.
        units = family.scale.min_deflection_unit, family.scale.min_coordinate_unit
        scale = ArcLengthScale.at_orbit(orbit, family.scale.parameter_name, *units)
        derivative = scale.directional_derivative(orbit, tangent)
        return SolvedCurvePoint(
            orbit=orbit,
            scale=scale,
            branch_direction=derivative / np.linalg.norm(derivative),
            row_coordinate=row_coordinate,
            branch_parameter_value=getattr(orbit.form.rod, scale.parameter_name),
            row_parameter_value=getattr(orbit.form.rod, family.row_parameter_axis.parameter_name),
            secant_parameter_error=self._parameter_error_at_distance(
                distance_error + MINIMALLY_AUGMENTED_SETTINGS.relative_cycle_tolerance
            ),
            normal_derivatives=derivatives,
        )

    def _parameter_error_at_distance(self, distance: float) -> float:
        """Displacement of the branch parameter, at a fixed second parameter, that corresponds to a `distance`
        from the curve."""
        rates = self.derivatives
        assert rates is not None
        parameter = PARAMETERS[self.family.scale.parameter_name]
        coordinate = self.orbit.form.rod.coordinate(self.family.scale.parameter_name)
        moved_coordinate = coordinate + distance * float(rates.orbit_derivative[-1])
        displacement = parameter.value(moved_coordinate) - parameter.value(coordinate)
        # A displacement along the chord leads to another point of the curve, and is not an error.
        return abs(displacement - distance * self.line.chord_slope * float(self.line.direction[1]))
