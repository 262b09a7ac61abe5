"""The four parameters of the linear problem, what they may be, and what follows from them."""

from dataclasses import dataclass
from math import inf, isfinite, isnan
from typing import NamedTuple


class Coefficients(NamedTuple):
    """All that the transverse operator contains, as compiled functions take it."""

    F: float
    nu: float
    c2: float
    gamma3: float


PARAMETERS = ("F", "k1", "k2", "gamma3")
"""Names of the parameters of the linear problem, in the order used everywhere."""

ALLOWED = {
    "F": "a finite number below k1 (negative values pull)",
    "k1": "a number above 0, or inf for an inextensible rod",
    "k2": "a number above 0, or inf for an unshearable rod",
    "gamma3": "a finite number, 0 or above",
    "gamma1": "a finite number above 0",
}
"""What each parameter may be, as a phrase for the user."""


def admissible(name: str, value: float) -> bool:
    """Whether `value` lies in the range of parameter `name` (Table I); F < k1 is `Rod`'s to check."""
    if isnan(value):
        return False
    if name in ("k1", "k2"):
        return value > 0 and (value == inf or isfinite(1 / value))
    if name == "gamma1":
        return 0 < value < inf
    if name == "gamma3":
        return 0 <= value < inf
    return isfinite(value)


@dataclass(frozen=True, slots=True)
class Rod:
    """A straight rod under its follower force: one point of parameter space.

    Raises ValueError for a parameter outside the range that `ALLOWED` states.
    """

    F: float
    k1: float
    k2: float
    gamma3: float

    def __post_init__(self) -> None:
        for name in PARAMETERS:
            if not admissible(name, getattr(self, name)):
                raise ValueError(f"{name} = {getattr(self, name)} is not {ALLOWED[name]}")
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
