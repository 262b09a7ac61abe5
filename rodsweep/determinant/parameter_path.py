"""Straight paths through the coefficients (F, nu, c2, gamma3) of uniform rods, and derivatives of D along a
path.

One parameter varies and all others are constant. The coefficients are affine in the path variable p, which is
F, gamma3, or a compliance c1 = 1/k1 or c2 = 1/k2.
"""

from dataclasses import dataclass
from typing import NamedTuple

from ..model.compiled.compilation import compiled
from ..model.parameters import PARAMETERS, Parameter
from ..model.rod import Coefficients, Rod, coefficients_of
from .even_sum import even_sum
from .value import ExponentDerivatives, determinant_from_even_sum


class DispersionCoefficientDerivatives(NamedTuple):
    """First and second derivatives by p of T = c2 + gamma3, N = F g, G = g nu and X = c2 gamma3, the
    coefficients of D(w), with g = nu + F c2. T is linear in p."""

    T_p: float
    """dT/dp, T = c2 + gamma3."""
    N_p: float
    """dN/dp, N = F g, g = nu + F c2."""
    N_pp: float
    """d^2N/dp^2, N = F g, g = nu + F c2."""
    G_p: float
    """dG/dp, G = g nu, g = nu + F c2."""
    G_pp: float
    """d^2G/dp^2, G = g nu, g = nu + F c2."""
    X_p: float
    """dX/dp, X = c2 gamma3."""
    X_pp: float
    """d^2X/dp^2, X = c2 gamma3."""


class PathDeterminantValue(NamedTuple):
    """D, D_w = dD/dw and D_p = dD/dp, all times exp(-S), S = `log_scale`. rounding_error: bound of the
    rounding error of D exp(-S)."""

    D: complex
    D_w: complex
    D_p: complex
    log_scale: float
    rounding_error: float


@dataclass(frozen=True, slots=True)
class ParameterPath:
    """All rods that differ from `rod` only in the parameter `parameter_name`."""

    rod: Rod
    parameter_name: str

    @property
    def parameter(self) -> Parameter:
        """The entry of the varying parameter in the table of parameters."""
        return PARAMETERS[self.parameter_name]

    @property
    def is_compliance_path(self) -> bool:
        """Whether the path variable p is the compliance 1/k of a varying stiffness k, not the parameter."""
        return self.parameter.has_inverse_coordinate

    @property
    def direction(self) -> Coefficients:
        """d(F, nu, c2, gamma3)/dp, the same for all rods of the path."""
        return self.rod.coefficient_derivative(self.parameter_name)

    @property
    def origin(self) -> Coefficients:
        """The coefficients (F, nu, c2, gamma3) extrapolated to p = 0, where the rod may be invalid."""
        return coefficients_of({**self.rod.values, self.parameter_name: self.parameter.value(0.0)})

    def coordinate(self, value: float) -> float:
        """The path variable p at which the varying parameter has the value `value`."""
        return self.parameter.coordinate(value)

    def value_and_error(self, p: float, p_error: float) -> tuple[float, float]:
        """Returns (value of the varying parameter at p, error of this value). p_error: error of p."""
        # k = 1/p, so dk = dp/p^2.
        return self.parameter.value(p), p_error / p**2 if self.is_compliance_path else p_error

    def rod_at(self, p: float) -> Rod:
        """The rod at p. Raises ValueError if the rod is invalid, for example crushed."""
        return self.rod.with_coordinate(self.parameter_name, p)

    def text_at(self, p: float) -> str:
        """Text with the value of the varying parameter at p, such as "F = 30"."""
        return f"{self.parameter_name} = {self.parameter.value(p):.9g}"


@compiled
def coefficients_at(p: float, origin: Coefficients, direction: Coefficients) -> Coefficients:
    """The coefficients origin + p direction of the rod at p."""
    return Coefficients(
        origin.F + p * direction.F,
        origin.nu + p * direction.nu,
        origin.c2 + p * direction.c2,
        origin.gamma3 + p * direction.gamma3,
    )


@compiled
def dispersion_coefficient_derivatives(
    coefficients: Coefficients, direction: Coefficients
) -> DispersionCoefficientDerivatives:
    """Derivatives of T, N, G and X by p at a rod; F and c2 must not both vary along the path."""
    F, nu, c2, gamma3 = coefficients
    F1, nu1, c21, gamma31 = direction
    g = nu + F * c2
    # Product rule; the second derivatives below are constants, because the coefficients are linear in p.
    g1 = nu1 + F1 * c2 + F * c21
    return DispersionCoefficientDerivatives(
        c21 + gamma31,
        F1 * g + F * g1,
        2 * F1 * g1,
        g1 * nu + g * nu1,
        2 * g1 * nu1,
        c21 * gamma3 + c2 * gamma31,
        2 * c21 * gamma31,
    )


@compiled
def squared_exponent_slopes_by_p(
    w: complex,
    exponents: ExponentDerivatives,
    dispersion_coefficient_derivatives: DispersionCoefficientDerivatives,
) -> tuple[complex, complex]:
    """(dz+/dp, dz-/dp) at w. exponents: result of `exponent_derivatives` at w."""
    P_p = 0j
    if exponents.P != 0:
        P_p = (
            w
            * (dispersion_coefficient_derivatives.G_p + dispersion_coefficient_derivatives.X_p * w)
            / (2 * exponents.P)
        )
    return (
        dispersion_coefficient_derivatives.T_p * w - dispersion_coefficient_derivatives.N_p + 2 * P_p,
        dispersion_coefficient_derivatives.T_p * w - dispersion_coefficient_derivatives.N_p - 2 * P_p,
    )


@compiled
def determinant_value_on_path(
    w: complex, coefficients: Coefficients, direction: Coefficients
) -> PathDeterminantValue:
    """D, dD/dw and dD/dp of a uniform rod on a path, at w != 0, times exp(-S), S = `log_scale` of the result.
    direction: d(F, nu, c2, gamma3)/dp."""
    F, nu, c2, gamma3 = coefficients
    parts = even_sum(w, coefficients)
    D, D_w, S, rounding_error = determinant_from_even_sum(w, coefficients, parts)
    even = parts[0]
    T_p, N_p, _, G_p, _, X_p, _ = dispersion_coefficient_derivatives(coefficients, direction)
    T = c2 + gamma3
    N = (nu + F * c2) * nu + 2 * (c2 * gamma3) * w
    M_p = T_p * w - N_p
    square_p = w * (G_p + X_p * w)
    p_derivative = T_p * even.s + 4 * (G_p + 2 * X_p * w) * even.d
    p_derivative += M_p * (T * even.ds_dM + 4 * N * even.dd_dM) + 4 * square_p * (
        T * even.dd_dM + 4 * N * even.quarter_of_dd_dP_squared
    )
    return PathDeterminantValue(D, D_w, w / 2 * p_derivative, S, rounding_error)
