"""The rod: all parameters of the table, and the numbers that the equations contain of them.

`Rod` is the only description of a rod. Equations read its `coefficients` and its `material`, never a
stiffness or a drag by the name of a parameter: other parameters may multiply it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any, NamedTuple, TypeVar

import numpy as np

from .balance import Material, first_component
from .parameters import FACTORS_OF, LINEAR_PARAMETERS, PARAMETERS, STIFFNESSES

Decorated = TypeVar("Decorated")


class Crushed(ValueError):
    """The refusal of a rod whose force is not below its stretch stiffness."""


class Coefficients(NamedTuple):
    """All that the transverse operator contains, as compiled functions take it."""

    F: float
    nu: float
    c2: float
    gamma3: float


def coefficients_of(values: Mapping[str, Any]) -> Coefficients:
    """The coefficients of parameters by name: floats, or arrays for many rods, (n,). Checks no range."""
    F, k1 = _product("F", values), _product("k1", values)
    return Coefficients(F, _compression(F, k1), 1 / _product("k2", values), _product("gamma3", values))


def _product(name: str, values: Mapping[str, Any], without: str = "") -> Any:
    """A load, a stiffness or a drag as the product of parameters, but for one of them."""
    product: Any = 1.0
    for factor in FACTORS_OF[name]:
        if factor != without:
            product = product * values[factor]
    return product


def _compression(F: Any, k1: Any) -> Any:
    """nu = 1 - F/k1 without cancellation where F is close to k1; floats or arrays."""
    if isinstance(k1, np.ndarray):
        with np.errstate(invalid="ignore"):  # inf/inf where k1 = inf
            return np.where(np.isinf(k1), 1.0, (k1 - F) / k1)
    return (k1 - F) / k1 if k1 < inf else 1.0


def with_parameters(cls: type[Decorated]) -> type[Decorated]:
    """Gives a class all parameters of the table as fields, in its order and with its defaults."""
    own = dict(cls.__annotations__)
    cls.__annotations__ = dict.fromkeys(PARAMETERS, float) | {
        n: a for n, a in own.items() if n not in PARAMETERS
    }
    for name, parameter in PARAMETERS.items():
        if parameter.default is not None:
            setattr(cls, name, parameter.default)
    return cls


@dataclass(frozen=True, slots=True, kw_only=True)
@with_parameters
class Rod:
    """A rod under its follower force: one point of parameter space, with every parameter of the table.

    The annotations are those that code asks for by name; the others are fields too. Raises ValueError for a
    parameter outside the range that the table states, Crushed for F >= k1.
    """

    F: float
    k1: float
    k2: float
    gamma3: float
    gamma1: float = PARAMETERS["gamma1"].neutral
    coefficients: Coefficients = field(init=False, repr=False, compare=False)
    """What the transverse operator contains of this rod, as floats."""

    def __post_init__(self) -> None:
        values = {}
        for name, parameter in PARAMETERS.items():
            values[name] = getattr(self, name)
            parameter.require(values[name])
        coefficients = coefficients_of(values)
        if not coefficients.nu > 0:
            raise Crushed(f"F = {self.F} is not below k1 = {self.k1}")
        object.__setattr__(self, "coefficients", coefficients)

    @property
    def values(self) -> dict[str, float]:
        """All parameters by name."""
        return {name: getattr(self, name) for name in PARAMETERS}

    @property
    def linear(self) -> "Rod":
        """The rod with the same straight state: parameters that only cycles depend on have their defaults."""
        return Rod(**{name: getattr(self, name) for name in LINEAR_PARAMETERS})

    def coordinate(self, name: str) -> float:
        """Where the rod stands along a parameter: 1/k of a stiffness k, or the value."""
        return float(PARAMETERS[name].coordinate(getattr(self, name)))

    def with_coordinate(self, name: str, coordinate: float) -> "Rod":
        """The rod elsewhere along a parameter; ValueError where the model has none."""
        return self.changed(**{name: PARAMETERS[name].value(coordinate)})

    def changed(self, **values: float) -> "Rod":
        """The rod with other values of some parameters; ValueError where the model has none."""
        others: Any = values
        return replace(self, **others)

    @property
    def stretch_stiffness(self) -> float:
        """The force in k3/L^2 that would crush the rod; inf for an inextensible one."""
        return float(_product("k1", self.values))

    @property
    def c1(self) -> float:
        """Stretch compliance; 0 for an inextensible rod."""
        return 1 / self.stretch_stiffness

    @property
    def c2(self) -> float:
        """Shear compliance; 0 for an unshearable rod."""
        return self.coefficients.c2

    @property
    def nu(self) -> float:
        """Compression of the straight state, nu = 1 - F c1 (Sec. V)."""
        return self.coefficients.nu

    @property
    def g(self) -> float:
        """Coupling of shear and rotation, g = nu + F c2 = mu/k2 (Sec. V)."""
        return self.nu + self.F * self.c2

    @property
    def rotational_drag(self) -> float:
        """Drag on the angular velocity, in gamma2 L^2."""
        return self.coefficients.gamma3

    @property
    def axial_drag(self) -> float:
        """Drag on the axial velocity, in gamma2."""
        return float(_product("gamma1", self.values))

    def direction(self, name: str) -> Coefficients:
        """The derivative of the coefficients by the coordinate of a parameter, the same all along it."""
        F, c1 = self._slope("F", name), self._slope("k1", name)
        nu = 0.0 - (F * self.c1 + self.F * c1)
        return Coefficients(F, nu, self._slope("k2", name), self._slope("gamma3", name))

    @property
    def material(self) -> Material:
        """Compliances, drags, force and straight state of the rod that moves in the plane."""
        compliance = np.array([self.c1, self.c2, 1.0])
        drag = np.array([self.axial_drag, 1.0, self.rotational_drag])
        return Material(compliance, drag, self.F, first_component(self.nu, 3))

    def material_in_space(self, twist_stiffness: float, twist_drag: float) -> Material:
        """The material of the rod that moves in space; twist stiffness in k3, twist drag in gamma2 L^2."""
        (c1, c2, bending), (axial, normal, rotational) = self.material.compliance, self.material.drag
        compliance = np.array([c1, c2, c2, 1 / twist_stiffness, bending, bending])
        drag = np.array([axial, normal, normal, twist_drag, rotational, rotational])
        return Material(compliance, drag, self.F, first_component(self.nu, 6))

    def material_change(self, name: str) -> Material:
        """The derivative of the material by the coordinate of a parameter."""
        F, nu, c2, gamma3 = self.direction(name)
        compliance = np.array([self._slope("k1", name), c2, 0.0])
        drag = np.array([self._slope("gamma1", name), 0.0, gamma3])
        return Material(compliance, drag, F, first_component(nu, 3))

    def _slope(self, of: str, name: str) -> float:
        """The derivative of a load, a compliance or a drag by the coordinate of a parameter."""
        if name not in FACTORS_OF[of]:
            return 0.0
        others = _product(of, self.values, without=name)
        return float(1 / others if of in STIFFNESSES else others)
