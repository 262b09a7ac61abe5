"""Build of an arm: constitutive law and profile, and the coefficients along u that follow."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from .laws import LINEAR, Law, law_of
from .profile import FACTORS, RADIUS_POWERS, Profile

AREA_SAMPLES = 256
"""Points between two rows of a profile at which the smallest area is looked up, beside the rows."""


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
    """Law and profile of an arm. Compares and hashes by its values.

    law, section: a key of `LAWS`. profile: factors of stiffnesses and drags along the arm, or None. Raises
    ValueError for an unknown law.
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
        """The law that `law` and `section` name."""
        return law_of(self.law, self.section)

    @cached_property
    def continuous(self) -> bool:
        """Whether no coefficient jumps along the arm."""
        return self.profile is None or len(self.profile.breaks) == len(self.profile.u)

    @cached_property
    def breaks(self) -> Array:
        """The u between which all coefficients are smooth, increasing, both ends included, (breaks,)."""
        return np.array([0.0, 1.0]) if self.profile is None else self.profile.breaks

    def crushing_share(self, taper: float) -> float:
        """The force that crushes the weakest section, in units of k1 at the base; inf if no force does."""
        return self.constitutive_law.largest_load * _smallest_area(self.profile, taper)

    def crushing_shares(self, tapers: Array) -> Array:
        """`crushing_share` of each taper, of the shape of `tapers`, (...,)."""
        shares = [self.crushing_share(taper) for taper in tapers.ravel().tolist()]
        return np.array(shares).reshape(tapers.shape)

    def local(self, F: float, at_base: Mapping[str, float], u: Array) -> LocalCoefficients:
        """Coefficients at points u, any shape (...,), under the force F; at_base: parameters at u = 0.

        No point may be a break of the profile.
        """
        ones: Array = np.ones((len(FACTORS), *u.shape))
        factors = dict(zip(FACTORS, ones if self.profile is None else self.profile.factors(u), strict=True))
        radius = 1 - (1 - at_base["taper"]) * u
        for name, power in RADIUS_POWERS.items():
            factors[name] = factors[name] * radius**power
        law = self.constitutive_law
        nu = 1 - law.shortening(F / (at_base["k1"] * factors["k1"]))
        c2 = 1 / (at_base["k2"] * factors["k2"])
        c3 = 1 / (factors["k3"] * law.bending(nu))
        gamma3 = at_base["gamma3"] * factors["gamma3"]
        return LocalCoefficients(nu, c2, c3, factors["gamma2"], gamma3, nu + F * c2)


@lru_cache(maxsize=1024)
def _smallest_area(profile: Profile | None, taper: float) -> float:
    """The smallest k1 along the arm, in units of that at the base."""
    ends = min(1.0, taper**2)
    if profile is None:
        return ends
    k1 = FACTORS.index("k1")
    rows = [(1 - (1 - taper) * u) ** 2 * row[k1] for u, row in zip(profile.u, profile.rows, strict=True)]
    inside = (np.arange(AREA_SAMPLES) + 0.5) / AREA_SAMPLES
    points = (profile.breaks[:-1, None] + np.diff(profile.breaks)[:, None] * inside).ravel()
    between = (1 - (1 - taper) * points) ** 2 * profile.factors(points)[k1]
    return min(*rows, float(between.min()))


STANDARD = Build()
"""Linear material that is the same all along the arm."""
