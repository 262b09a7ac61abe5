"""Straight paths through the coefficients (F, nu, c2, gamma3), and how D changes along them.

One parameter varies and the other three stay. The path variable p is the parameter in which the
coefficients are linear: F, c1 = 1/k1, c2 = 1/k2 or gamma3.
"""

import math
from dataclasses import dataclass
from math import inf

from ..model.compilation import compiled
from ..model.parameters import LINEAR_PARAMETERS, PARAMETERS
from ..model.rod import Coefficients, Rod
from .even_parts import even_parts

Changes = tuple[float, float, float, float, float, float, float]
"""First and second derivatives along a path, as `changes` orders them."""


@dataclass(frozen=True, slots=True)
class Path:
    """All rods that differ from `rod` in the parameter `name` only."""

    rod: Rod
    name: str

    @property
    def inverse(self) -> bool:
        """Whether the path variable is the compliance 1/k instead of the parameter itself."""
        return PARAMETERS[self.name].by_compliance

    @property
    def direction(self) -> Coefficients:
        """d(F, nu, c2, gamma3)/dp, the same everywhere on the path."""
        return direction_of(self.rod, self.name)

    @property
    def origin(self) -> Coefficients:
        """(F, nu, c2, gamma3) at p = 0."""
        rod = self.rod
        return {
            "F": (0.0, 1.0, rod.c2, float(rod.gamma3)),
            "k1": (float(rod.F), 1.0, rod.c2, float(rod.gamma3)),
            "k2": (float(rod.F), rod.nu, 0.0, float(rod.gamma3)),
            "gamma3": (float(rod.F), rod.nu, rod.c2, 0.0),
        }[self.name]

    def variable(self, value: float) -> float:
        """The path variable p at a value of the parameter, and the other way round."""
        if self.inverse:
            return 1 / value if value else inf
        return value

    def at(self, p: float) -> Rod:
        """The rod at p; ValueError where the model has none."""
        parameters = {name: getattr(self.rod, name) for name in LINEAR_PARAMETERS}
        return Rod(**parameters | {self.name: self.variable(p)})


def direction_of(rod: Rod, name: str) -> Coefficients:
    """d(F, nu, c2, gamma3)/dp at a rod, where p is F, c1, c2 or gamma3 as `name` says."""
    return {
        "F": (1.0, -rod.c1, 0.0, 0.0),
        "k1": (0.0, -float(rod.F), 0.0, 0.0),
        "k2": (0.0, 0.0, 1.0, 0.0),
        "gamma3": (0.0, 0.0, 0.0, 1.0),
    }[name]


@compiled
def coefficients_at(p: float, origin: Coefficients, direction: Coefficients) -> Coefficients:
    """The coefficients at p."""
    return (
        origin[0] + p * direction[0],
        origin[1] + p * direction[1],
        origin[2] + p * direction[2],
        origin[3] + p * direction[3],
    )


@compiled
def changes(coefficients: Coefficients, direction: Coefficients) -> Changes:
    """(T', N', N'', G', G'', X', X'') along the path, where D depends on w and on

    T = c2 + gamma3, N = F g, G = g nu, X = c2 gamma3 alone. Of F and c2 only one may vary.
    """
    F, nu, c2, gamma3 = coefficients
    F1, nu1, c21, gamma31 = direction
    g = nu + F * c2
    g1 = nu1 + F1 * c2 + F * c21
    return (
        c21 + gamma31,
        F1 * g + F * g1,
        2 * F1 * g1,
        g1 * nu + g * nu1,
        2 * g1 * nu1,
        c21 * gamma3 + c2 * gamma31,
        2 * c21 * gamma31,
    )


@compiled
def root_changes(
    w: complex, P: complex, P1: complex, coefficients: Coefficients, change: Changes
) -> tuple[complex, complex, complex, complex]:
    """(dz+/dp, dz-/dp, dP/dp, d2P/dw dp) at w, from P and P' there."""
    T1, N1, _, G1, _, X1, _ = change
    Pp, P1p = 0j, 0j
    if P != 0:
        Pp = w * (G1 + X1 * w) / (2 * P)
        P1p = ((G1 + 2 * X1 * w) / 2 - P1 * Pp) / P
    return T1 * w - N1 + 2 * Pp, T1 * w - N1 - 2 * Pp, Pp, P1p


@compiled
def determinant_along(
    w: complex, coefficients: Coefficients, direction: Coefficients
) -> tuple[complex, complex, complex, float, float]:
    """(D, dD/dw, dD/dp, S, noise) at w != 0, the first three times exp(-S); noise as that of D."""
    F, nu, c2, gamma3 = coefficients
    S, noise, first, s, d, s1, d1, dd = even_parts(w, coefficients)
    T1, N1, _, G1, _, X1, _ = changes(coefficients, direction)
    T, X = c2 + gamma3, c2 * gamma3
    N = (nu + F * c2) * nu + 2 * X * w
    second = T * (T * s1 + 8 * N * d1) + 8 * X * d + 16 * N * N * dd
    M1, square1 = T1 * w - N1, w * (G1 + X1 * w)
    along = T1 * s + 4 * (G1 + 2 * X1 * w) * d
    along += M1 * (T * s1 + 4 * N * d1) + 4 * square1 * (T * d1 + 4 * N * dd)
    return math.exp(-S) + w / 2 * first, (first + w * second) / 2, w / 2 * along, S, noise
