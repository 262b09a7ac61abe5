"""Planes of rods: two parameters vary, each along a linear or logarithmic axis that is scaled to [0, 1]."""

from dataclasses import dataclass
from functools import cached_property
from math import exp, inf, log
from typing import NamedTuple

from ..model.parameters import FORCE_AND_STRETCH_STIFFNESS, PARAMETERS
from ..model.rod import Rod
from .arm.determinant import arm_determinant
from .exponents import MACHINE_EPSILON
from .parameter_path import PathDeterminantValue, determinant_value_on_path
from .value import DeterminantValue, scaled_determinant


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaneDifferenceSettings:
    """Settings for derivatives of D by differences along the scaled axes of a plane."""

    axis_end_tolerance: float = 1e-12
    """A coordinate beyond an end of a scaled axis by less than this, a rounding error, is moved to the
    end."""
    max_difference_step: float = 1e-3
    """Largest step of differences along a scaled axis, which has length 1."""
    max_step_over_crushing_distance: float = 0.01
    """Largest step of a difference, as a fraction of the distance along the axis to a crushed rod."""


PLANE_DIFFERENCE_SETTINGS = PlaneDifferenceSettings()


FOURTH_ORDER_CENTRAL_STENCIL = ((-2, 1 / 12), (-1, -8 / 12), (1, 8 / 12), (2, -1 / 12))
"""Central difference of fourth order for a first derivative: pairs (offset in steps, weight times step)."""
FOURTH_ORDER_ONE_SIDED_STENCIL = ((0, -25 / 12), (1, 4.0), (2, -3.0), (3, 4 / 3), (4, -1 / 4))
"""One-sided difference of fourth order for a derivative, as pairs (offset in steps, weight times step)."""


@dataclass(frozen=True, slots=True)
class PlaneAxis:
    """One axis of a plane: the parameter `parameter_name` from `start` to `stop`, finite, linear or
    logarithmic."""

    parameter_name: str
    start: float
    stop: float
    is_logarithmic: bool = False

    def value(self, x: float) -> float:
        """The parameter at the scaled coordinate x, which is 0 at `start` and 1 at `stop`; an x just beyond
        an end is moved to the end."""
        settings = PLANE_DIFFERENCE_SETTINGS
        if -settings.axis_end_tolerance < x < 0 or 1 < x < 1 + settings.axis_end_tolerance:
            x = round(x)
        if self.is_logarithmic:
            return exp(log(self.start) + x * (log(self.stop) - log(self.start)))
        return self.start + x * (self.stop - self.start)

    def scaled_coordinate(self, value: float) -> float:
        """The scaled coordinate x at which the parameter has `value`."""
        if self.is_logarithmic:
            return (log(value) - log(self.start)) / (log(self.stop) - log(self.start))
        return (value - self.start) / (self.stop - self.start)

    def parameter_per_scaled_coordinate(self, value: float) -> float:
        """d(parameter)/dx where the parameter has `value`."""
        return value * (log(self.stop) - log(self.start)) if self.is_logarithmic else self.stop - self.start

    def path_variable_per_scaled_coordinate(self, value: float) -> float:
        """dp/dx where the parameter has `value`, p: 1/k for a stiffness k, else the parameter."""
        parameter_rate = self.parameter_per_scaled_coordinate(value)
        return (
            -parameter_rate / value**2
            if PARAMETERS[self.parameter_name].has_inverse_coordinate
            else parameter_rate
        )


class PlaneDeterminantValue(NamedTuple):
    """D and the derivatives of D by w, x and y, all times exp(-S), S = `log_scale`. rounding_error: rounding
    error of D exp(-S), including the effect of rounding in w, x and y."""

    D: complex
    D_w: complex
    """dD/dw exp(-S)."""
    D_x: complex
    """dD/dx exp(-S), x: scaled coordinate along the first axis of the plane."""
    D_y: complex
    """dD/dy exp(-S), y: scaled coordinate along the second axis of the plane."""
    log_scale: float
    rounding_error: float


@dataclass(frozen=True)
class ParameterPlane:
    """All rods that differ from `rod` only in the two parameters of `axes`."""

    rod: Rod
    axes: tuple[PlaneAxis, PlaneAxis]

    @cached_property
    def are_rods_uniform_and_linear(self) -> bool:
        """Whether all rods of the plane are uniform and of linear material, so that D has a closed form."""
        return self.rod.is_uniform_and_linear and all(axis.parameter_name != "taper" for axis in self.axes)

    def rod_at(self, x: float, y: float) -> Rod:
        """The rod at scaled coordinates (x, y); ValueError for an invalid rod, for example a crushed rod."""
        return self.rod.with_values(
            **{a.parameter_name: a.value(z) for a, z in zip(self.axes, (x, y), strict=True)}
        )

    def determinant(self, w: complex, x: float, y: float) -> PlaneDeterminantValue:
        """D and the derivatives of D by w, x and y, at w, for the rod at scaled coordinates (x, y)."""
        rod = self.rod_at(x, y)
        if self.are_rods_uniform_and_linear:
            (D, D_w, _, log_scale, rounding_error), D_x = self._determinant_and_coordinate_slope(
                w, rod, self.axes[0]
            )
            _, D_y = self._determinant_and_coordinate_slope(w, rod, self.axes[1])
        else:
            D, D_w, log_scale, rounding_error = self.determinant_value(w, x, y)
            D_x, D_y = self._slopes_of_arms(w, x, y, log_scale)
        # The rounding errors of w, x and y add to the rounding error of D.
        rounding = rounding_error + MACHINE_EPSILON * (abs(D_x) + abs(D_y) + abs(w * D_w))
        return PlaneDeterminantValue(D, D_w, D_x, D_y, log_scale, rounding)

    def determinant_value(self, w: complex, x: float, y: float) -> DeterminantValue:
        """D and dD/dw at w, for the rod at scaled coordinates (x, y)."""
        rod = self.rod_at(x, y)
        if self.are_rods_uniform_and_linear:
            return scaled_determinant(w, rod.coefficients)
        return arm_determinant(rod).value(w)

    def difference_stencil(
        self, x: float, y: float, axis_index: int
    ) -> tuple[tuple[tuple[float, float], ...], float]:
        """Returns (stencil, step) of a difference along axis number `axis_index`, 0 or 1, at scaled
        coordinates (x, y): `FOURTH_ORDER_CENTRAL_STENCIL`, or `FOURTH_ORDER_ONE_SIDED_STENCIL` if the rod two
        steps back is invalid."""
        step = self.difference_step_at(x, y, axis_index, PLANE_DIFFERENCE_SETTINGS.max_difference_step)
        # Forwards the step is short against the distance to crushing: only rods behind can be invalid.
        two_steps_back = (x - 2 * step, y) if axis_index == 0 else (x, y - 2 * step)
        return (
            FOURTH_ORDER_CENTRAL_STENCIL
            if self.is_valid_at(*two_steps_back)
            else FOURTH_ORDER_ONE_SIDED_STENCIL
        ), step

    def _slopes_of_arms(self, w: complex, x: float, y: float, log_scale: float) -> list[complex]:
        """Derivatives of D exp(-`log_scale`) by x and y, for arms without a closed form of D, by fourth-order
        differences."""
        slopes = []
        for axis_index in range(2):
            stencil, step = self.difference_stencil(x, y, axis_index)
            slope = 0j
            for offset, weight in stencil:
                neighbour = self.determinant_value(
                    w, *((x + offset * step, y) if axis_index == 0 else (x, y + offset * step))
                )
                slope += weight * neighbour.D * exp(neighbour.log_scale - log_scale) / step
            slopes.append(slope)
        return slopes

    @staticmethod
    def _determinant_and_coordinate_slope(
        w: complex, rod: Rod, axis: PlaneAxis
    ) -> tuple[PathDeterminantValue, complex]:
        """Returns (D with derivatives by w and the path variable of `axis`, derivative of D by the scaled
        coordinate of `axis`)."""
        value = determinant_value_on_path(
            w, rod.coefficients, rod.coefficient_derivative(axis.parameter_name)
        )
        return value, value.D_p * axis.path_variable_per_scaled_coordinate(getattr(rod, axis.parameter_name))

    def difference_step_at(self, x: float, y: float, axis_index: int, max_step: float) -> float:
        """A difference step along axis number `axis_index` at (x, y): the smaller of `max_step` and the
        fraction `max_step_over_crushing_distance` of the distance to a crushed rod. The step is `max_step` if
        no value on the axis crushes the rod."""
        rod = self.rod_at(x, y)
        axis = self.axes[axis_index]
        force = rod.crushing_force
        if force == inf or axis.parameter_name not in (*FORCE_AND_STRETCH_STIFFNESS, "taper"):
            return max_step
        # The crushing force is proportional to k1 and quadratic in the taper, like the area.
        rate = {"F": 1.0, "k1": force / rod.k1}.get(axis.parameter_name, 2 * force / rod.taper)
        slope = rate * axis.parameter_per_scaled_coordinate(getattr(rod, axis.parameter_name))
        return min(
            max_step, PLANE_DIFFERENCE_SETTINGS.max_step_over_crushing_distance * (force - rod.F) / slope
        )

    def is_valid_at(self, x: float, y: float) -> bool:
        """Whether the rod at scaled coordinates (x, y) is valid."""
        try:
            self.rod_at(x, y)
        except ValueError:
            return False
        return True

    def is_uncrushed_at(self, x: float, y: float) -> bool:
        """Whether the force at scaled coordinates (x, y) is below the force that crushes the rod."""
        # A crushed rod cannot be made, so its force is compared without making it.
        values = {**self.rod.values} | {
            a.parameter_name: a.value(v) for a, v in zip(self.axes, (x, y), strict=True)
        }
        return values["F"] < values["k1"] * self.rod.material.crushing_force_over_k1(values["taper"])
