"""Convex regions, bounded by a parabola, that contain the spectrum of an arm."""

from dataclasses import dataclass
from math import inf, isfinite, sqrt
from typing import NamedTuple

from ....arrays import Array
from ....model.compiled.compilation import compiled
from ....model.compiled.settings import CompiledSettings
from ...certificate.box import BOX


@dataclass(frozen=True, slots=True, kw_only=True)
class HullSettings(CompiledSettings):
    """Settings for the points and weights from which a region is computed."""

    points: int = 25
    """Chebyshev points of each smooth piece, where coefficients are looked up and alpha is differentiated."""
    margin: float = 0.05
    """Relative excess of a, for extremes between the points and for rounding."""
    inside: float = 1e-9
    """Distance of the first and last point from the ends of a piece, in units of the piece's length."""
    least_remainder: float = 0.1
    """Least 1 - c: the region grows beyond use where c approaches 1."""
    wide: float = 0.15
    """Smallest c of a region that counts as wide for every a."""
    weights: int = 41
    """Number of constant weights alpha to try, between the smallest and the largest g/nu."""
    least_ratio: float = 1e-3
    """Smallest |g/nu| that is tried as a constant weight."""
    directions: int = 48
    """Number of normals of the region to try for the distance of a point."""
    builds_kept: int = 16
    """Builds whose points are kept: a bound of memory, which changes no number."""
    middles: tuple[float, ...] = (0.0, 0.5, 1.0)
    """Trial factors of |F| sqrt(c2 c3 gamma3/gamma2) in alpha."""


HULL = HullSettings()


class Hull(NamedTuple):
    """Parabolic region that contains all eigenvalues: Re w <= a n - (1 - c) n^2, |Im w| <= a n + c n^2 for
    some n >= 0.

    a = inf if no bound is known.
    """

    a: float
    c: float

    def box(self, depth: float = 0.0) -> tuple[float, float]:
        """(max Re w, max |Im w|) of the eigenvalues with Re w >= -depth, depth >= 0."""
        a = self.a
        b = 1 - self.c
        if not isfinite(a):
            return inf, inf
        n = (a + sqrt(a * a + 4 * b * depth)) / (2 * b)
        # A pad in proportion to the depth keeps the box open where F = 0 makes the bound vanish.
        pad = BOX.padding * depth + BOX.least_padding
        return a * a / (4 * b) + pad, a * n + self.c * n * n + pad


NO_BOUND = Hull(inf, 0.0)
"""The whole plane, when no bound applies."""


@compiled
def clearance(w: complex, a: float, c: float) -> tuple[float, complex]:
    """(distance, normal): lower bound of the distance of w, Im w >= 0, from the hull; unit normal towards w.

    The distance is at most 0 for w inside. <normal, w - v> >= distance for every v in the hull.
    """
    b = 1 - c
    best = -inf
    normal = 1 + 0j
    for k in range(HULL.directions):
        # Close to the imaginary axis the support function grows without bound.
        T = (k / (HULL.directions - k)) ** 2
        if not c * T < b:
            break
        size = sqrt(1 + T * T)
        support = a * a * (1 + T) * (1 + T) / (4 * (b - c * T))
        distance = (w.real + T * w.imag - support) / size
        if distance > best:
            best = distance
            normal = complex(1 / size, T / size)
    return best, normal


class PathHulls(NamedTuple):
    """Regions for all arms of a path, one region for each interval between neighbouring places.

    places: increasing values of the path variable, (k,). a, c: constants of `Hull` for each interval, (k -
    1,).
    """

    places: Array
    a: Array
    c: Array


@compiled
def hull_at(hulls: PathHulls, p: float) -> Hull:
    """The region for the arm at p, between the first and the last place."""
    i = 0
    while i < len(hulls.a) - 1 and p > hulls.places[i + 1]:
        i += 1
    return Hull(hulls.a[i], hulls.c[i])
