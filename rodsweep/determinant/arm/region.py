"""Convex regions, bounded by a parabola, that contain the spectrum of an arm."""

from math import inf, isfinite, sqrt
from typing import NamedTuple

from ...arrays import Array
from ...model.compiled.compilation import compiled

DIRECTIONS = 48
"""Number of normals of the region to try for the distance of a point. Compiled functions read it."""


class Hull(NamedTuple):
    """The region Re w <= a n - (1 - c) n^2, |Im w| <= a n + c n^2, n >= 0; a = inf if no bound is known."""

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
        pad = 0.01 * depth + 1e-6
        return a * a / (4 * b) + pad, a * n + self.c * n * n + pad


UNKNOWN = Hull(inf, 0.0)
"""The whole plane, when no bound applies."""


@compiled
def clearance(w: complex, a: float, c: float) -> tuple[float, complex]:
    """(distance, normal): lower bound of the distance of w, Im w >= 0, from the hull; unit normal towards w.

    The distance is at most 0 for w inside. <normal, w - v> >= distance for every v in the hull.
    """
    b = 1 - c
    best = -inf
    normal = 1 + 0j
    for k in range(DIRECTIONS):
        # Close to the imaginary axis the support function grows without bound.
        T = (k / (DIRECTIONS - k)) ** 2
        if not c * T < b:
            break
        size = sqrt(1 + T * T)
        support = a * a * (1 + T) * (1 + T) / (4 * (b - c * T))
        distance = (w.real + T * w.imag - support) / size
        if distance > best:
            best = distance
            normal = complex(1 / size, T / size)
    return best, normal


class Hulls(NamedTuple):
    """Regions for the arms of a path between places, (k,), increasing: a and c of each interval, (k - 1,)."""

    places: Array
    a: Array
    c: Array


@compiled
def hull_at(hulls: Hulls, p: float) -> Hull:
    """The region for the arm at p, from the first place to the last."""
    i = 0
    while i < len(hulls.a) - 1 and p > hulls.places[i + 1]:
        i += 1
    return Hull(hulls.a[i], hulls.c[i])
