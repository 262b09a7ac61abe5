"""Material of a rod: constitutive law and profile, and the resulting coefficients as functions of u."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from .factors import factors_along, smallest_factor_along
from .laws import LAWS, LINEAR_CONSTITUTIVE_LAW, Law, law_of
from .profile import RADIUS_POWERS, Profile, relative_radius


class LocalCoefficients(NamedTuple):
    """Coefficients of the transverse operator at points of an arm; all arrays have the shape of the points.
    nu: stretch of the straight arm under its force. c2, c3: compliances of shear and bending. gamma2, gamma3:
    normal and rotational drag. g = nu + F c2."""

    nu: Array
    c2: Array
    c3: Array
    gamma2: Array
    gamma3: Array
    g: Array


class CrossSections(NamedTuple):
    """Properties of the cross-sections at points of an arm, for motion in the plane, or derivatives of these
    properties. compliance: of stretching, shear and bending, (3, points). drag: axial, normal and rotational
    drag, (3, points). nu: stretch of the straight arm under its force, (points,)."""

    compliance: Array
    drag: Array
    nu: Array


@dataclass(frozen=True)
class RodMaterial:
    """Constitutive law, section and profile of a rod; compared and hashed by value.
    (law, section): a key of `LAWS`. profile: factors of stiffnesses and drags along the arm; None for
    constant stiffnesses and drags. Raises ValueError for an unknown law."""

    law: str = LINEAR_CONSTITUTIVE_LAW.law_name
    section: str = LINEAR_CONSTITUTIVE_LAW.section_name
    profile: Profile | None = None

    def __post_init__(self) -> None:
        law_of(self.law, self.section)

    @cached_property
    def is_uniform_and_linear(self) -> bool:
        """Whether the material is linear and constant along the arm."""
        return self.profile is None and self.constitutive_law is LINEAR_CONSTITUTIVE_LAW

    def is_piecewise_constant(self, taper: float) -> bool:
        """Whether all coefficients of an arm with the taper `taper` are constant between `breaks`."""
        return taper == 1 and (self.profile is None or self.profile.is_piecewise_constant)

    @property
    def constitutive_law(self) -> Law:
        """The `Law` with the key (law, section) in `LAWS`."""
        return law_of(self.law, self.section)

    @property
    def json_text(self) -> str:
        """The material as JSON text, the input of `from_json_text`."""
        profile = None if self.profile is None else [self.profile.u, self.profile.rows]
        # A list has a fixed order, so equal materials have equal texts.
        return json.dumps([self.law, self.section, profile])

    @classmethod
    def from_json_text(cls, text: str) -> "RodMaterial":
        """The material from a JSON text of the property `json_text`."""
        law, section, profile = json.loads(text)
        if profile is None:
            return cls(law, section)
        u, rows = profile
        return cls(law, section, Profile(tuple(u), tuple(map(tuple, rows))))

    @property
    def law_number(self) -> int:
        """Number of the law in compiled code, see `stress_strain`."""
        # Compiled code compares integers; texts are slow there.
        return list(LAWS).index((self.law, self.section))

    @cached_property
    def jump_positions(self) -> tuple[float, ...]:
        """The u at which factors of the profile jump: the profile has two rows for such a u."""
        u = () if self.profile is None else self.profile.u
        return tuple(a for a, b in zip(u[:-1], u[1:], strict=True) if a == b)

    @cached_property
    def breaks(self) -> Array:
        """Ends of the intervals of u on which coefficients are smooth, increasing from 0 to 1, (breaks,)."""
        return np.array([0.0, 1.0]) if self.profile is None else self.profile.breaks

    def crushing_force_over_k1(self, taper: float) -> float:
        """Force that crushes the weakest section of an arm, divided by k1 at the base; inf if no force
        crushes the arm. taper: taper of the arm."""
        return self.constitutive_law.crushing_load * smallest_factor_along(self.profile, taper, "k1")

    def refuse_extreme_load(self, forces: Array | float, k1: float, taper: float) -> None:
        """Raises ValueError if a force compresses the weakest section beyond the law's
        `largest_accurate_load`, or stretches it beyond the law's `largest_pull_without_overflow`. forces: a
        number, or numbers, (n,). k1: stretch stiffness at the base. taper: tip radius over base radius."""
        law = self.constitutive_law
        weakest_k1 = smallest_factor_along(self.profile, taper, "k1") * k1
        low, high = -law.largest_pull_without_overflow * weakest_k1, law.largest_accurate_load * weakest_k1
        if (F := np.max(forces)) > high:
            raise ValueError(
                f"F = {F:.15g} is above {high:.15g}, {law.largest_accurate_load:g} times the stretch "
                "stiffness of the weakest section; rubber this compressed cannot be computed, so give a "
                "smaller force"
            )
        if (F := np.min(forces)) < low:
            raise ValueError(
                f"F = {F:.15g} is below {low:.15g}; the stretch of swelling rubber under such a pull "
                "overflows, so give a weaker pull"
            )

    def force_over_crushing_force(self, F: float, k1: float, taper: float) -> float:
        """F divided by the force that crushes the weakest section; 0 if no force crushes the arm. k1: stretch
        stiffness at the base. taper: tip radius over base radius."""
        return F / (k1 * self.crushing_force_over_k1(taper))

    def relative_least_rotational_drag(self, taper: float) -> float:
        """Smallest rotational drag along an arm with the taper `taper`, divided by the drag at the base."""
        return smallest_factor_along(self.profile, taper, "gamma3")

    @cached_property
    def relative_least_axial_drag(self) -> float:
        """Smallest axial drag along an arm, divided by the drag at the base; the same for all tapers."""
        return smallest_factor_along(self.profile, 1.0, "gamma1")

    def crushing_forces_over_k1(self, tapers: Array) -> Array:
        """Result of `crushing_force_over_k1` for each of `tapers`, (...,), as an array of the same shape."""
        # One at a time, because each result is cached by its taper.
        forces = [self.crushing_force_over_k1(taper) for taper in tapers.ravel().tolist()]
        return np.array(forces).reshape(tapers.shape)

    def local_coefficients(
        self, F: float, at_base: Mapping[str, float], u: Array, remainder: Array | None = None
    ) -> LocalCoefficients:
        """Coefficients at points u, (...,), under the force F. No point may be a break of the profile.
        at_base: stiffnesses and drags at u = 0, and taper, by name. remainder: exact coordinates of the
        points minus u; None: u is exact."""
        factors = factors_along(self.profile, at_base["taper"], u, remainder)
        law = self.constitutive_law
        # No load acts along the arm, so the force in every section is F.
        nu = 1 - law.shortening(F / (at_base["k1"] * factors["k1"]))
        c2 = 1 / (at_base["k2"] * factors["k2"])
        # With a fixed section the bending factor is 1; a product with an array of ones would take time.
        c3 = 1 / (factors["k3"] if law.section_name == "fixed" else factors["k3"] * law.bending_factor(nu))
        gamma3 = at_base["gamma3"] * factors["gamma3"]
        # A copy, because the factors are cached.
        return LocalCoefficients(nu, c2, c3, factors["gamma2"].copy(), gamma3, nu + F * c2)

    def cross_sections_at(self, F: float, at_base: Mapping[str, float], u: Array) -> CrossSections:
        """Properties of the cross-sections at points u, (points,), under the tip force F. No point may be a
        break of the profile. The compliances belong to the undeformed arm. at_base: stiffnesses and drags at
        u = 0, and taper, by name."""
        factors = factors_along(self.profile, at_base["taper"], u)
        # k3 and gamma2 at the base are the units, and have no entry.
        stiffness = {name: at_base.get(name, 1.0) * factors[name] for name in ("k1", "k2", "k3")}
        drag = [at_base.get(name, 1.0) * factors[name] for name in ("gamma1", "gamma2", "gamma3")]
        nu = 1 - self.constitutive_law.shortening(F / stiffness["k1"])
        return CrossSections(np.array([1 / k for k in stiffness.values()]), np.array(drag), nu)

    def relative_compliances(self, taper: float, u: Array) -> Array:
        """Compliances of stretching, shear and bending at points u, (points,), of an arm with the taper
        `taper`, divided by the compliances at the base, (3, points). The ratio is also defined if a
        compliance is 0."""
        factors = factors_along(self.profile, taper, u)
        # A ratio of compliances at an infinite stiffness would be 0/0, but the factors alone give it.
        return np.array([1 / factors[name] for name in ("k1", "k2", "k3")])

    def cross_section_derivatives(
        self, sections: CrossSections, F: float, taper: float, slopes: Mapping[str, float], u: Array
    ) -> CrossSections:
        """Derivatives of the properties of cross-sections at points u, (points,), with respect to a
        parameter. sections: result of `cross_sections_at` for F and u. slopes: derivatives of F, of the
        taper, and of compliances and drags at the base with respect to the parameter, by name; the derivative
        of a missing name is 0."""
        factors = factors_along(self.profile, taper, u)
        compliance = np.zeros((3, *u.shape))
        drag = np.zeros((3, *u.shape))
        for i, name in enumerate(("k1", "k2", "k3")):
            if name in slopes:
                compliance[i] = slopes[name] / factors[name]
        for i, name in enumerate(("gamma1", "gamma2", "gamma3")):
            if name in slopes:
                drag[i] = slopes[name] * factors[name]
        if "taper" in slopes:
            # Derivative of log(radius).
            growth = slopes["taper"] * u / relative_radius(taper, u)
            for i, name in enumerate(("k1", "k2", "k3")):
                compliance[i] -= sections.compliance[i] * RADIUS_POWERS.get(name, 0) * growth
            for i, name in enumerate(("gamma1", "gamma2", "gamma3")):
                drag[i] += sections.drag[i] * RADIUS_POWERS.get(name, 0) * growth
        load_derivative = slopes.get("F", 0.0) * sections.compliance[0] + F * compliance[0]
        # W'(nu) = -F c1, so the change of nu is minus the change of F c1, divided by W''(nu).
        return CrossSections(
            compliance, drag, -load_derivative / self.constitutive_law.stiffness(sections.nu)
        )


DEFAULT_MATERIAL = RodMaterial()
"""Material of a uniform rod with a linear constitutive law."""
