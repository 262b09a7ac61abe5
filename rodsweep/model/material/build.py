"""Build of an arm: constitutive law, taper and profile, and the coefficients along u that follow."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from .laws import LINEAR, Law, law_of
from .profile import FACTORS, RADIUS_POWERS, Profile


class LocalCoefficients(NamedTuple):
    """Coefficients of the transverse operator at points of an arm, arrays of one shape.

    nu: stretch at rest; c2, c3: compliances of shear and bending; gamma2, gamma3: drags; g = nu + F c2.
    """

    nu: Array
    c2: Array
    c3: Array
    gamma2: Array
    gamma3: Array
    g: Array


@dataclass(frozen=True)
class Build:
    """Law, taper and profile of an arm. Compares and hashes by its values.

    law, section: a key of `LAWS`. taper: tip radius over base radius of a circular cone. profile: factors of
    stiffnesses and drags along the arm, or None. Raises ValueError for an unknown law and for a taper that is
    no finite number above 0.
    """

    law: str = LINEAR.law
    section: str = LINEAR.section
    taper: float = 1.0
    profile: Profile | None = None

    def __post_init__(self) -> None:
        law_of(self.law, self.section)
        if not 0 < self.taper < inf:
            raise ValueError(f"taper = {self.taper} is not a finite number above 0")

    @cached_property
    def uniform(self) -> bool:
        """Whether stiffnesses and drags are constant along the arm."""
        return self.taper == 1 and self.profile is None

    @cached_property
    def continuous(self) -> bool:
        """Whether no coefficient jumps along the arm."""
        return self.profile is None or len(self.profile.breaks) == len(self.profile.u)

    @cached_property
    def standard(self) -> bool:
        """Whether the arm is uniform and of linear material, so that D has its closed form."""
        return self.uniform and self.constitutive_law is LINEAR

    @property
    def constitutive_law(self) -> Law:
        """The law that `law` and `section` name."""
        return law_of(self.law, self.section)

    @cached_property
    def crushing_share(self) -> float:
        """The force that crushes the weakest section, in units of k1 at the base; inf if no force does.

        A lower bound for an arm with a taper and a profile.
        """
        weakest = min(1.0, self.taper**2)
        if self.profile is not None:
            weakest *= min(row[FACTORS.index("k1")] for row in self.profile.rows)
        return self.constitutive_law.largest_load * weakest

    @cached_property
    def breaks(self) -> Array:
        """The u between which all coefficients are smooth, increasing, both ends included, (breaks,)."""
        return np.array([0.0, 1.0]) if self.profile is None else self.profile.breaks

    def local(self, F: float, at_base: Mapping[str, float], u: Array) -> LocalCoefficients:
        """Coefficients at points u, any shape (...,), under the force F; at_base: parameters at u = 0.

        No point may be a break of the profile.
        """
        ones: Array = np.ones((len(FACTORS), *u.shape))
        factors = dict(zip(FACTORS, ones if self.profile is None else self.profile.factors(u), strict=True))
        radius = 1 - (1 - self.taper) * u
        for name, power in RADIUS_POWERS.items():
            factors[name] = factors[name] * radius**power
        law = self.constitutive_law
        nu = 1 - law.shortening(F / (at_base["k1"] * factors["k1"]))
        c2 = 1 / (at_base["k2"] * factors["k2"])
        c3 = 1 / (factors["k3"] * law.bending(nu))
        gamma3 = at_base["gamma3"] * factors["gamma3"]
        return LocalCoefficients(nu, c2, c3, factors["gamma2"], gamma3, nu + F * c2)


STANDARD = Build()
"""The uniform arm of linear material."""
