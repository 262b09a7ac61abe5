"""Build of an arm: constitutive law and profile, and the resulting coefficients along u."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from .laws import LAWS, LINEAR, Law, law_of
from .profile import FACTORS, RADIUS_POWERS, Profile

FACTOR_SAMPLE_COUNT = 256
"""Number of points between neighbouring u of a profile at which the smallest factor is searched for."""


class LocalCoefficients(NamedTuple):
    """Coefficients of the transverse operator at points of an arm; all arrays have the shape of the points.

    nu: stretch of the straight state. c2, c3: compliances of shear and bending. gamma2, gamma3: normal and
    rotational drag. g = nu + F c2.
    """

    nu: Array
    c2: Array
    c3: Array
    gamma2: Array
    gamma3: Array
    g: Array


class Sections(NamedTuple):
    """Properties of the cross-sections at points of an arm, for motion in the plane, or their derivatives.

    compliance: of stretching, shear and bending, (3, points). drag: axial, normal and rotational,
    (3, points). nu: stretch of the straight loaded arm, (points,).
    """

    compliance: Array
    drag: Array
    nu: Array


@dataclass(frozen=True)
class Build:
    """Constitutive law and profile of an arm, together called its build; compared and hashed by value.

    (law, section): a key of `LAWS`. profile: factors of stiffnesses and drags along the arm, None for an arm
    without profile. Raises ValueError for an unknown law.
    """

    law: str = LINEAR.law
    section: str = LINEAR.section
    profile: Profile | None = None

    def __post_init__(self) -> None:
        law_of(self.law, self.section)

    @cached_property
    def standard(self) -> bool:
        """Whether the material is linear and the same all along the arm."""
        return self.profile is None and self.constitutive_law is LINEAR

    @property
    def constitutive_law(self) -> Law:
        """The `Law` whose key in `LAWS` is (law, section)."""
        return law_of(self.law, self.section)

    @property
    def text(self) -> str:
        """The build as JSON text, which `from_text` reads."""
        profile = None if self.profile is None else [self.profile.u, self.profile.rows]
        return json.dumps([self.law, self.section, profile])

    @classmethod
    def from_text(cls, text: str) -> "Build":
        """The build from the JSON text that `text` returns."""
        law, section, profile = json.loads(text)
        if profile is None:
            return cls(law, section)
        u, rows = profile
        return cls(law, section, Profile(tuple(u), tuple(map(tuple, rows))))

    @property
    def law_number(self) -> int:
        """Integer that stands for the law in compiled code, see `response`."""
        return list(LAWS).index((self.law, self.section))

    @cached_property
    def continuous(self) -> bool:
        """Whether no coefficient jumps along the arm."""
        return not self.jumps

    @cached_property
    def jumps(self) -> tuple[float, ...]:
        """The u at which the profile has two rows, where factors jump."""
        u = () if self.profile is None else self.profile.u
        return tuple(a for a, b in zip(u[:-1], u[1:], strict=True) if a == b)

    @cached_property
    def breaks(self) -> Array:
        """Ends of the intervals of u on which coefficients are smooth, increasing from 0 to 1, (breaks,)."""
        return np.array([0.0, 1.0]) if self.profile is None else self.profile.breaks

    def relative_crushing_force(self, taper: float) -> float:
        """Force that crushes the weakest section of an arm of the taper `taper`, divided by k1 at the base.

        inf if no force crushes the arm.
        """
        return self.constitutive_law.largest_load * _smallest_factor(self.profile, taper, "k1")

    def relative_least_drag(self, taper: float) -> float:
        """Smallest rotational drag along an arm of the taper `taper`, divided by its value at the base."""
        return _smallest_factor(self.profile, taper, "gamma3")

    def relative_crushing_forces(self, tapers: Array) -> Array:
        """`relative_crushing_force` for each value in `tapers`, of the shape of `tapers`, (...,)."""
        shares = [self.relative_crushing_force(taper) for taper in tapers.ravel().tolist()]
        return np.array(shares).reshape(tapers.shape)

    def local(self, F: Any, at_base: Mapping[str, Any], u: Array) -> LocalCoefficients:
        """Coefficients at points u, any shape (...,), under the force F.

        at_base: parameters at u = 0, by name. No point may be a break of the profile. Force and parameters
        are numbers, or arrays for n arms, (n, 1, ...).
        """
        factors = self._factors(at_base["taper"], u)
        law = self.constitutive_law
        # No load acts along the arm, so every section carries the whole force F.
        nu = 1 - law.shortening(F / (at_base["k1"] * factors["k1"]))
        c2 = 1 / (at_base["k2"] * factors["k2"])
        c3 = 1 / (factors["k3"] * law.bending(nu))
        gamma3 = at_base["gamma3"] * factors["gamma3"]
        return LocalCoefficients(nu, c2, c3, factors["gamma2"], gamma3, nu + F * c2)

    def sections(self, F: float, at_base: Mapping[str, float], u: Array) -> Sections:
        """Properties of the cross-sections at points u, (points,), none of them a break of the profile.

        Compliances are those of the undeformed arm. F: tip force. at_base: parameters at u = 0, by name.
        """
        factors = self._factors(at_base["taper"], u)
        stiffness = {name: at_base.get(name, 1.0) * factors[name] for name in ("k1", "k2", "k3")}
        drag = [at_base.get(name, 1.0) * factors[name] for name in ("gamma1", "gamma2", "gamma3")]
        nu = 1 - self.constitutive_law.shortening(F / stiffness["k1"])
        return Sections(np.array([1 / k for k in stiffness.values()]), np.array(drag), nu)

    def relative_compliances(self, taper: float, u: Array) -> Array:
        """Compliances of stretching, shear and bending at points u, (points,), divided by those at the base.

        Shape (3, points). The ratio is defined for a rigid rod too, whose compliances are 0.
        """
        factors = self._factors(taper, u)
        return np.array([1 / factors[name] for name in ("k1", "k2", "k3")])

    def section_changes(
        self, at: Sections, F: float, taper: float, slopes: Mapping[str, float], u: Array
    ) -> Sections:
        """Derivatives with respect to a parameter of the cross-sections `at` at points u, (points,).

        slopes: derivatives of F, taper, and the compliances and drags at the base with respect to the
        parameter, by name; missing names have derivative 0.
        """
        factors = self._factors(taper, u)
        # d log(radius)/d taper.
        growth = slopes.get("taper", 0.0) * u / (1 - (1 - taper) * u)
        compliance = np.zeros((3, *u.shape))
        drag = np.zeros((3, *u.shape))
        for i, name in enumerate(("k1", "k2", "k3")):
            own = slopes.get(name, 0.0) / factors[name]
            compliance[i] = own - at.compliance[i] * RADIUS_POWERS.get(name, 0) * growth
        for i, name in enumerate(("gamma1", "gamma2", "gamma3")):
            own = slopes.get(name, 0.0) * factors[name]
            drag[i] = own + at.drag[i] * RADIUS_POWERS.get(name, 0) * growth
        load = slopes.get("F", 0.0) * at.compliance[0] + F * compliance[0]
        # n1(nu) = -F c1 in units of k1: the shortening changes by the change of the load over the tangent
        # stiffness.
        return Sections(compliance, drag, -load / self.constitutive_law.stiffness(at.nu))

    def _factors(self, taper: Any, u: Array) -> dict[str, Array]:
        """Stiffnesses and drags at points u, divided by those at the base, by name; all of the shape of u."""
        if self.profile is None:
            factors = dict.fromkeys(FACTORS, np.ones(u.shape))
        else:
            factors = dict(zip(FACTORS, self.profile.factors(u), strict=True))
        if isinstance(taper, np.ndarray) or taper != 1:
            radius = 1 - (1 - taper) * u
            square = radius * radius  # a power of NumPy takes as long as ten products
            powers = {2: square, 4: square * square}
            for name, power in RADIUS_POWERS.items():
                factors[name] = factors[name] * powers[power] if self.profile else powers[power]
        return factors


@lru_cache(maxsize=1024)
def _smallest_factor(profile: Profile | None, taper: float, name: str) -> float:
    """Smallest k1 or gamma3, as `name` says, along an arm, divided by the value at the base."""
    power = RADIUS_POWERS[name]
    # Both radius and power are monotone, so a cone has its extreme at an end.
    ends = min(1.0, taper**power)
    if profile is None:
        return ends
    column = FACTORS.index(name)
    rows = [
        (1 - (1 - taper) * u) ** power * row[column] for u, row in zip(profile.u, profile.rows, strict=True)
    ]
    inside = (np.arange(FACTOR_SAMPLE_COUNT) + 0.5) / FACTOR_SAMPLE_COUNT
    points = (profile.breaks[:-1, None] + np.diff(profile.breaks)[:, None] * inside).ravel()
    between = (1 - (1 - taper) * points) ** power * profile.factors(points)[column]
    return min(*rows, float(between.min()))


STANDARD = Build()
"""Build of a uniform arm of linear material."""
