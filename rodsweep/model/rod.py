"""The rod of the linear problem: its four parameters, and what follows from them."""

from dataclasses import dataclass
from math import inf
from typing import NamedTuple

from .parameters import LINEAR_PARAMETERS, PARAMETERS


class Coefficients(NamedTuple):
    """All that the transverse operator contains, as compiled functions take it."""

    F: float
    nu: float
    c2: float
    gamma3: float


@dataclass(frozen=True, slots=True)
class Rod:
    """A straight rod under its follower force: one point of parameter space.

    Raises ValueError for a parameter outside the range that the table states.
    """

    F: float
    k1: float
    k2: float
    gamma3: float

    def __post_init__(self) -> None:
        for name in LINEAR_PARAMETERS:
            PARAMETERS[name].require(getattr(self, name))
        if not self.k1 > self.F:
            raise ValueError(f"F = {self.F} is not below k1 = {self.k1}")

    @property
    def c1(self) -> float:
        """Stretch compliance 1/k1; 0 for an inextensible rod."""
        return 1 / self.k1

    @property
    def c2(self) -> float:
        """Shear compliance 1/k2; 0 for an unshearable rod."""
        return 1 / self.k2

    @property
    def nu(self) -> float:
        """Compression of the straight state, nu = 1 - F/k1 (Sec. V)."""
        return (self.k1 - self.F) / self.k1 if self.k1 < inf else 1.0

    @property
    def g(self) -> float:
        """Coupling of shear and rotation, g = nu + F c2 = mu/k2 (Sec. V)."""
        return self.nu + self.F * self.c2

    @property
    def coefficients(self) -> Coefficients:
        """What the transverse operator contains of this rod, as floats."""
        return Coefficients(float(self.F), self.nu, self.c2, float(self.gamma3))
