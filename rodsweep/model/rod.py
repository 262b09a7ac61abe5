"""The rod: all parameters of the table, and the resulting coefficients of the equations.

Equations use `coefficients` and `material` of a `Rod`, never a stiffness or drag by the name of its
parameter, because other parameters may multiply the stiffness or drag.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from .balance import BalanceCoefficients, axial_vector
from .base_coefficients import stiffnesses_and_drags_at_base, stretch_of_straight_rod
from .material.rod_material import DEFAULT_MATERIAL, CrossSections, LocalCoefficients, RodMaterial
from .parameters import (
    PARAMETERS,
    RANGE_CHECKS,
    STIFFNESS_NAMES,
    TRANSVERSE_PARAMETER_NAMES,
    with_parameter_fields,
)


class Crushed(ValueError):
    """The follower force is not smaller than the force that crushes the rod."""


class NotUniform(ValueError):
    """A formula for uniform rods was applied to an arm that varies or has a nonlinear constitutive law."""


class Coefficients(NamedTuple):
    """Coefficients of the transverse operator of a uniform rod, as an argument of compiled functions. F:
    force in k3/L^2, positive if it compresses the rod. nu: stretch 1 - F/k1 of the straight rod. c2: shear
    compliance 1/k2, in L^2/k3. gamma3: rotational drag, in gamma2 L^2."""

    F: float
    nu: float
    c2: float
    gamma3: float


def coefficients_of(values: Mapping[str, Any]) -> Coefficients:
    """Coefficients for parameter values by name, floats or arrays (n,) for n rods. Ranges are not checked."""
    base_values = stiffnesses_and_drags_at_base(values)
    F = base_values["F"]
    k1 = base_values["k1"]
    return Coefficients(F, stretch_of_straight_rod(F, k1), 1 / base_values["k2"], base_values["gamma3"])


@dataclass(frozen=True, slots=True, kw_only=True)
@with_parameter_fields
class Rod:
    """A rod under its follower force, with every parameter of the table `PARAMETERS`, which states units.
    Every parameter is a field; annotations exist only for parameters that code uses by name: follower force F
    at the tip, stiffnesses k1 and k2 and drags gamma3 and gamma1 at the base, and taper, the tip radius over
    the base radius. material: constitutive law and profile. Raises ValueError for a parameter outside its
    range, and Crushed for a force that is not below `crushing_force`."""

    F: float
    k1: float
    k2: float
    gamma3: float
    gamma1: float = PARAMETERS["gamma1"].neutral_value
    taper: float = PARAMETERS["taper"].neutral_value
    material: RodMaterial = field(default=DEFAULT_MATERIAL, repr=False)
    values: Mapping[str, float] = field(init=False, repr=False, compare=False)
    """All parameters by name."""
    _coefficients: Coefficients | None = field(init=False, repr=False, compare=False)
    """The value of `coefficients`; None for an arm that varies or has a nonlinear law."""

    def __post_init__(self) -> None:
        values: dict[str, float] = {}
        for name, contains in RANGE_CHECKS:
            values[name] = value = getattr(self, name)
            if not contains(value):
                PARAMETERS[name].require_in_range(value)
        # The dataclass is frozen; computed fields are set here only.
        object.__setattr__(self, "values", values)
        coefficients = None
        if self.material.is_uniform_and_linear and self.taper == 1:
            # Kernels are compiled for floats; an int would cause another compilation.
            coefficients = Coefficients(*map(float, coefficients_of(values)))
        object.__setattr__(self, "_coefficients", coefficients)
        if coefficients is None and not self.crushing_force > self.F:
            raise Crushed(f"F = {self.F} is not below the crushing force {self.crushing_force:.15g}")
        if coefficients is not None and not coefficients.nu > 0:
            raise Crushed(f"F = {self.F} is not below k1 = {self.k1}")

    @property
    def coefficients(self) -> Coefficients:
        """Coefficients of the transverse operator. Raises NotUniform for a varying arm or a nonlinear law."""
        if self._coefficients is None:
            raise NotUniform(f"{self} is not a uniform rod of linear material")
        return self._coefficients

    def local_coefficients(self, u: Array, remainder: Array | None = None) -> LocalCoefficients:
        """`RodMaterial.local_coefficients` of this rod at points u, (...,), away from breaks. remainder:
        exact coordinates of the points minus u; None: u is exact."""
        at_base = stiffnesses_and_drags_at_base(self.values)
        return self.material.local_coefficients(self.F, at_base, u, remainder)

    @property
    def crushing_force(self) -> float:
        """The force that crushes the weakest section, in k3/L^2; inf if no force crushes the section."""
        return self.material.crushing_force_over_k1(self.taper) * self.base_stretch_stiffness

    @property
    def least_rotational_drag(self) -> float:
        """Smallest rotational drag along the arm, in gamma2 L^2."""
        if self.is_uniform_and_linear:
            return self.base_rotational_drag
        return self.material.relative_least_rotational_drag(self.taper) * self.base_rotational_drag

    @property
    def least_axial_drag(self) -> float:
        """Smallest axial drag along the arm, in gamma2."""
        return self.material.relative_least_axial_drag * self.base_axial_drag

    @property
    def is_uniform(self) -> bool:
        """Whether stiffnesses and drags are constant along the rod."""
        return self.taper == 1 and self.material.profile is None

    @property
    def is_uniform_and_linear(self) -> bool:
        """Whether the rod is uniform and of linear material; D then has a closed form."""
        return self._coefficients is not None

    @property
    def equivalent_linear_rod_and_rate_factor(self) -> tuple["Rod", float]:
        """Returns (linear rod, rate factor). The eigenvalues of this rod are the eigenvalues of the linear
        rod, times the factor. With the bending factor K = B(nu) of this rod's law, the linear rod has the
        coefficients (F/K, nu, c2 K, gamma3), and the factor is K. Raises NotUniform for an arm that
        varies."""
        if not self.is_uniform:
            raise NotUniform(f"{self} is not uniform")
        law = self.material.constitutive_law
        shortening = float(law.shortening(self.F * self.c1))
        # With the unit K k3 the bending stiffness is 1; the unit of time is then gamma2 L^4/(K k3).
        K = float(law.bending_factor(1 - shortening))
        F = self.F / K
        k1 = F / shortening if shortening else self.base_stretch_stiffness / K
        return Rod(F=F, k1=k1, k2=1 / (self.c2 * K) if self.c2 else inf, gamma3=self.base_rotational_drag), K

    @property
    def without_nonlinear_parameters(self) -> "Rod":
        """The rod with the same parameters of the linear problem, and default nonlinear parameters."""
        return Rod(**{name: self.values[name] for name in TRANSVERSE_PARAMETER_NAMES}, material=self.material)

    def coordinate(self, parameter_name: str) -> float:
        """Coordinate of a parameter of the rod: 1/k for a stiffness k, otherwise the value."""
        return float(PARAMETERS[parameter_name].coordinate(getattr(self, parameter_name)))

    def with_coordinate(self, parameter_name: str, coordinate: float) -> "Rod":
        """The rod with a new `coordinate` (1/k for a stiffness k) of a parameter; ValueError if invalid."""
        return self.with_values(**{parameter_name: PARAMETERS[parameter_name].value(coordinate)})

    def with_values(self, **values: float) -> "Rod":
        """The same rod with the given parameter values, by name. Raises ValueError for an invalid value."""
        # `dataclasses.replace` takes a third longer.
        return Rod(**{**self.values, **values}, material=self.material)

    @property
    def base_stretch_stiffness(self) -> float:
        """Stretch stiffness at the base, in k3/L^2; inf for an inextensible rod."""
        return float(stiffnesses_and_drags_at_base(self.values)["k1"])

    @property
    def c1(self) -> float:
        """Stretch compliance 1/k1 at the base, in L^2/k3; 0 for an inextensible rod."""
        return 1 / self.base_stretch_stiffness

    @property
    def c2(self) -> float:
        """Shear compliance 1/k2 at the base, in L^2/k3; 0 for an unshearable rod."""
        return 1 / float(stiffnesses_and_drags_at_base(self.values)["k2"])

    @property
    def nu(self) -> float:
        """Stretch of the straight rod, nu = 1 - F c1 (Sec. V). Raises NotUniform like `coefficients`."""
        return self.coefficients.nu

    @property
    def g(self) -> float:
        """Coupling of shear and rotation, g = nu + F c2 = mu/k2 (Sec. V). Raises NotUniform like `nu`."""
        return self.nu + self.F * self.c2

    @property
    def base_rotational_drag(self) -> float:
        """Rotational drag at the base, in gamma2 L^2."""
        return float(stiffnesses_and_drags_at_base(self.values)["gamma3"])

    @property
    def base_axial_drag(self) -> float:
        """Axial drag at the base, in gamma2."""
        return float(stiffnesses_and_drags_at_base(self.values)["gamma1"])

    def coefficient_derivative(self, parameter_name: str) -> Coefficients:
        """Derivative of `coefficients` with respect to the coordinate of a parameter (1/k for a stiffness k),
        in which the coefficients are affine."""
        slopes = self._derivatives_by_coordinate(parameter_name)
        F = slopes.get("F", 0.0)
        c1 = slopes.get("k1", 0.0)
        # 0.0 - x keeps a zero positive, where -x would be -0.0.
        nu = 0.0 - (F * self.c1 + self.F * c1) if F or c1 else 0.0
        return Coefficients(F, nu, slopes.get("k2", 0.0), slopes.get("gamma3", 0.0))

    @property
    def balance_coefficients(self) -> BalanceCoefficients:
        """Coefficients of the balance for motion in the plane. Raises NotUniform like `coefficients`."""
        compliance = np.array([self.c1, self.c2, 1.0])
        drag = np.array([self.base_axial_drag, 1.0, self.base_rotational_drag])
        return BalanceCoefficients(compliance, drag, self.F, axial_vector(self.nu, 3))

    def cross_sections_at(self, u: Array) -> CrossSections:
        """Compliances, drags and stretch at points u, (points,); no point may be a break of the profile."""
        return self.material.cross_sections_at(self.F, stiffnesses_and_drags_at_base(self.values), u)

    def cross_section_derivatives(
        self, parameter_name: str, u: Array, sections: CrossSections | None = None
    ) -> CrossSections:
        """Derivatives of `cross_sections_at(u)` by the coordinate (1/k for a stiffness k) of a parameter; u:
        (points,). sections: value of `cross_sections_at(u)`, if known."""
        slopes = self._derivatives_by_coordinate(parameter_name)
        known = self.cross_sections_at(u) if sections is None else sections
        return self.material.cross_section_derivatives(known, self.F, self.taper, slopes, u)

    def balance_coefficient_derivative(self, parameter_name: str) -> BalanceCoefficients:
        """Derivative of `balance_coefficients` by the coordinate (1/k for a stiffness k) of a parameter."""
        slopes = self._derivatives_by_coordinate(parameter_name)
        F, nu, c2, gamma3 = self.coefficient_derivative(parameter_name)
        compliance = np.array([slopes.get("k1", 0.0), c2, 0.0])
        drag = np.array([slopes.get("gamma1", 0.0), 0.0, gamma3])
        return BalanceCoefficients(compliance, drag, F, axial_vector(nu, 3))

    def _derivatives_by_coordinate(self, parameter_name: str) -> dict[str, float]:
        """Nonzero derivatives of force, compliances, drags and taper by the `coordinate` of a parameter.

        Keys are F, k1, k2, gamma1, gamma3, taper; keys of stiffnesses contain derivatives of compliances.
        Each quantity is a product of coordinates: a derivative is the product of all other factors."""
        unit_values = stiffnesses_and_drags_at_base({**self.values, parameter_name: 1.0})
        keys = PARAMETERS[parameter_name].scaled_coefficient_names or (parameter_name,)
        return {
            key: float(1 / unit_values[key] if key in STIFFNESS_NAMES else unit_values[key]) for key in keys
        }
