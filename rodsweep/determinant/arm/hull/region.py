"""The hull of an arm: a convex region of w, bounded by a parabola, that contains all eigenvalues."""

from dataclasses import dataclass
from math import inf, isfinite, sqrt
from typing import NamedTuple

from ....arrays import Array
from ....model.compiled.compilation import compiled
from ....model.compiled.kernel_constants import KernelConstants
from ...certificate.box_of_all_eigenvalues import BOX_SETTINGS


@dataclass(frozen=True, slots=True, kw_only=True)
class HullSettings(KernelConstants):
    """Settings for the points and the weights alpha from which a hull is computed."""

    points_per_interval: int = 25
    """Number of Chebyshev points of each interval between breaks of the profile, where coefficients are
    evaluated and alpha is differentiated."""
    enlargement_fraction: float = 0.05
    """The constants of a hull are enlarged by this fraction, for extremes between points and for rounding."""
    end_point_distance_over_interval: float = 1e-9
    """Distance of the first and last Chebyshev point from the ends of an interval between breaks, divided by
    the length of the interval, so that no point lies on a jump."""
    min_one_minus_c: float = 0.1
    """Hulls with 1 - c below this number are not used: they are too large to be useful."""
    c_at_doubled_measure: float = 0.15
    """Hulls are compared by the measure a^2 (1 + (c/c_at_doubled_measure)^4): this c doubles the measure. The
    smallest hull has the least measure."""
    constant_weight_count: int = 41
    """Number of constant weights alpha tried, from smallest to largest |g/nu| along the arm, besides 1."""
    min_constant_weight: float = 1e-3
    """Smallest constant weight alpha tried, if |g/nu| is smaller somewhere."""
    supporting_line_count: int = 48
    """Number of supporting lines of the hull tried for the distance of a point w from the hull."""
    max_cached_materials: int = 16
    """Maximum number of materials whose points are cached: it bounds the memory and changes no number."""
    load_term_factors: tuple[float, ...] = (0.0, 0.5, 1.0)
    """The varying weights alpha = g/(nu + f |F| sqrt(c2 c3 gamma3/gamma2)) are tried for these values of
    f."""


HULL_SETTINGS = HullSettings()


class EigenvalueHull(NamedTuple):
    """Region that contains all eigenvalues: Re w <= a n - (1 - c) n^2 and |Im w| <= a n + c n^2 for some n >=
    0. n is the weighted norm of an eigenfunction's stresses divided by the weighted norm of its
    displacements, see `rodsweep.determinant.arm.hull.hull`. a = inf if no bound exists."""

    a: float
    """Coefficient of n in the bounds of Re w and |Im w|, in 1/sqrt(tau2); inf without a bound."""
    c: float
    """Coefficient of n^2 in the bound of |Im w|; the damping in the bound of Re w is (1 - c) n^2."""

    def box(self, depth: float = 0.0) -> tuple[float, float]:
        """Bounds (max Re w, max |Im w|), in 1/tau2, of the part Re w >= -depth of the hull, depth >= 0; inf
        if unbounded."""
        a = self.a
        b = 1 - self.c
        if not isfinite(a):
            return inf, inf
        n = (a + sqrt(a * a + 4 * b * depth)) / (2 * b)
        # A pad in proportion to the depth keeps the box open where F = 0 makes the bound vanish.
        padding = BOX_SETTINGS.padding_over_depth * depth + BOX_SETTINGS.min_padding
        return a * a / (4 * b) + padding, a * n + self.c * n * n + padding


UNBOUNDED_HULL = EigenvalueHull(inf, 0.0)
"""The whole plane of w, for an arm whose eigenvalues have no a-priori bound."""


@compiled
def hull_distance_and_normal(w: complex, a: float, c: float) -> tuple[float, complex]:
    """Returns (distance, normal) for w with Im w >= 0 and the hull with the constants a, c. distance: lower
    bound of the distance of w from the hull, at most 0 if w lies inside. normal: unit vector towards w.
    <normal, w - v> >= distance for every v in the hull."""
    b = 1 - c
    largest_distance = -inf
    normal = 1 + 0j
    for k in range(HULL_SETTINGS.supporting_line_count):
        # Slopes T of the normals from 0 up, as many below 1 as above. For steep normals the support function
        # grows without bound.
        T = (k / (HULL_SETTINGS.supporting_line_count - k)) ** 2
        if not c * T < b:
            break
        size = sqrt(1 + T * T)
        support = a * a * (1 + T) * (1 + T) / (4 * (b - c * T))
        distance = (w.real + T * w.imag - support) / size
        if distance > largest_distance:
            largest_distance = distance
            normal = complex(1 / size, T / size)
    return largest_distance, normal


class PathHulls(NamedTuple):
    """Hulls of all arms of a path: hull number i is valid for every p between p[i] and p[i + 1]. p:
    increasing values of the path variable, (k,). a, c: constants of `EigenvalueHull`, (k - 1,)."""

    p: Array
    a: Array
    c: Array


@compiled
def hull_at(hulls: PathHulls, p: float) -> EigenvalueHull:
    """The hull of the arm at p, which lies between the first and the last of `hulls.p`."""
    i = 0
    while i < len(hulls.a) - 1 and p > hulls.p[i + 1]:
        i += 1
    return EigenvalueHull(hulls.a[i], hulls.c[i])
