"""An a-priori box that contains every transverse eigenvalue of a uniform rod with Re w >= -depth.

The inner product of the eigenproblem of Sec. VI with the eigenfunction, weighted by 1 for y and rho > 0 for
theta, gives, with the shear stress s, g = nu + F c2 and N^2 = |y|^2 + rho gamma3 |theta|^2 (L2 norms over the
rod),

    w N^2 = -c2 |s|^2 - rho |theta'|^2 + (rho g - nu) <theta, s> - F <y, theta'>.

With n^2 = (c2 |s|^2 + rho |theta'|^2)/N^2 the last two terms are at most a n N^2 in modulus, where a^2 =
max(F^2/rho, (rho g - nu)^2/(c2 rho gamma3)), so that

    Re w <= a n - n^2 <= a^2/4,   |Im w| <= a n,   and Re w >= -depth forces n^2 <= a n + depth.

The weight rho is free; the best rho makes both entries of the maximum equal.

No eigenvalue lies on the imaginary axis close to w = 0: |E(z)| <= exp(Re sqrt z)/2 bounds D - 1 for small
|w|, with E of `rodsweep.determinant.value`.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import exp, inf, log, sqrt

from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants
from ...model.rod import Coefficients, Rod
from ..parameter_path import ParameterPath, coefficients_at, dispersion_coefficient_derivatives


@dataclass(frozen=True, slots=True, kw_only=True)
class BoxSettings(KernelConstants):
    """Settings for the a-priori box of all eigenvalues, and for the disc about w = 0 without a zero of D."""

    padding_over_depth: float = 0.01
    """This fraction of `depth` is added to both bounds of the box of the eigenvalues with Re w >= -depth."""
    min_padding: float = 1e-6
    """Length added to both bounds of the box, in 1/tau2; far below the smallest |w| of a rod without load,
    12."""
    relative_bound_excess: float = 0.01
    """Every bound is enlarged by this fraction, to cover the rounding errors of the bound itself."""
    max_D_deviation_from_one: float = 0.5
    """Bound of |D - 1| in the disc about w = 0. Any bound below 1 excludes zeros of D."""


BOX_SETTINGS = BoxSettings()


def box_of_all_eigenvalues(rod: Rod, depth: float = 0.0) -> tuple[float, float]:
    """Bounds (max Re w, max |Im w|), in 1/tau2, of all eigenvalues with Re w >= -depth, depth >= 0; inf if
    no bound exists."""
    return box_from_sqrt_frequency_bound(sqrt(frequency_bound(rod)), depth)


@compiled
def box_from_sqrt_frequency_bound(a: float, depth: float) -> tuple[float, float]:
    """Bounds (max Re w, max |Im w|) of all w with Re w >= -depth, in 1/tau2; a: sqrt of `frequency_bound`."""
    n = (a + sqrt(a * a + 4 * depth)) / 2
    # Without the padding, F = 0 would make the box empty.
    padding = BOX_SETTINGS.padding_over_depth * depth + BOX_SETTINGS.min_padding
    return (1 + BOX_SETTINGS.relative_bound_excess) * a * a / 4 + padding, (
        1 + BOX_SETTINGS.relative_bound_excess
    ) * a * n + padding


@lru_cache(maxsize=1)
def frequency_bound(rod: Rod) -> float:
    """Upper bound of |Im w| of all eigenvalues with Re w >= 0, in 1/tau2; inf if no bound exists. It is the
    smallest a^2 of the module docstring over all weights rho.

    With g = nu + F c2 >= 0 it is F^2 g/(nu + |F| sqrt(c2 gamma3)), also for c2 = 0 or gamma3 = 0. For g < 0
    (a pull beyond the shear stiffness) the larger entry of the maximum is minimised over rho; c2 gamma3 = 0
    then gives no bound.
    """
    drag = rod.c2 * rod.base_rotational_drag
    drag_term = abs(rod.F) * sqrt(drag)
    if rod.g >= 0:
        return rod.F**2 * rod.g / (rod.nu + drag_term)
    if drag == 0:
        return inf
    # For g < 0 the smallest maximum of two bounds lies where both are equal or where the second is smallest.
    weights = [rod.nu / -rod.g] + ([(drag_term - rod.nu) / -rod.g] if drag_term > rod.nu else [])
    return min(max(rod.F**2 / rho, (rho * rod.g - rod.nu) ** 2 / (drag * rho)) for rho in weights)


def frequency_bound_on_path(path: ParameterPath, p_start: float, p_stop: float) -> float:
    """An upper bound of `frequency_bound` over a path with p from p_start to p_stop; inf if no bound is
    known."""
    ends = [coefficients_at(p, path.origin, path.direction) for p in (p_start, p_stop)]
    return frequency_bound_between_rods(ends[0], ends[1])


@compiled
def frequency_bound_between_rods(first: Coefficients, last: Coefficients) -> float:
    """An upper bound of `frequency_bound` over all rods between two rods of a path; inf if no bound is known.
    Every factor of the bound is monotone along a path, so its extremes are at the two rods. The product nu g,
    g = nu + F c2, is not monotone and not used."""
    load = max(abs(first.F), abs(last.F))
    # F passes 0 between loads of opposite signs.
    least_load = 0.0 if first.F * last.F < 0 else min(abs(first.F), abs(last.F))
    weak_weight = 1.0
    for rod in (first, last):
        if rod.c2 > 0:
            # The weight rho = 1 gives this bound; it needs no sign of g, but rotational drag.
            weak_weight = max(weak_weight, rod.c2 / rod.gamma3 if rod.gamma3 > 0 else inf)
    g_first = first.nu + first.F * first.c2
    g_last = last.nu + last.F * last.c2
    root_of_drag = min(sqrt(first.c2 * first.gamma3), sqrt(last.c2 * last.gamma3))
    denominator = min(first.nu, last.nu) + least_load * root_of_drag
    strong_weight = inf
    if min(g_first, g_last) >= 0 and denominator > 0:
        strong_weight = max(g_first, g_last) / denominator
    bound = min(weak_weight, strong_weight)
    return load**2 * bound if bound < inf else inf


def zero_free_radius(path: ParameterPath, p_start: float, p_stop: float, max_radius: float) -> float:
    """A radius r <= max_radius with |D(i eta) - 1| < 1/2 for |eta| <= r and every p of a path from p_start to
    p_stop; 0 if r underflows."""
    ends = [coefficients_at(p, path.origin, path.direction) for p in (p_start, p_stop)]
    max_T = max(c2 + gamma3 for *_, c2, gamma3 in ends)
    max_X = max(c2 * gamma3 for *_, c2, gamma3 in ends)
    derivatives = [dispersion_coefficient_derivatives(c, path.direction) for c in ends]
    # A function lies within (stop - start)^2/8 times its curvature of the chord between its ends.
    curvature_factor = (p_stop - p_start) ** 2 / 8
    max_G = max(abs(nu * (nu + F * c2)) for F, nu, c2, _ in ends) + curvature_factor * max(
        abs(b.G_pp) for b in derivatives
    )
    max_pull = max(
        max(-F * (nu + F * c2) for F, nu, c2, _ in ends)
        + curvature_factor * max(abs(b.N_pp) for b in derivatives),
        0.0,
    )
    if all(F >= 0 and nu + F * c2 >= 0 for F, nu, c2, _ in ends):
        max_pull = 0.0  # -F g is negative at the ends, and F and g are linear in p or constant
    return _zero_free_radius(max_radius, max_T, max_X, max_G, max_pull)


def zero_free_radius_of_rod(coefficients: Coefficients, max_radius: float) -> float:
    """A radius r <= max_radius with |D(i eta) - 1| < 1/2 for |eta| <= r and a single rod; 0 on underflow."""
    F, nu, c2, gamma3 = coefficients
    g = nu + F * c2
    return _zero_free_radius(max_radius, c2 + gamma3, c2 * gamma3, abs(g * nu), max(-F * g, 0.0))


def _zero_free_radius(radius: float, T: float, X: float, G: float, max_pull: float) -> float:
    """The first of r, r/2, r/4, ... such that |D(i eta) - 1| < 1/2 for |eta| <= r; 0 if r underflows. T, X,
    G: bounds of c2 + gamma3, c2 gamma3 and |g nu|, g = nu + F c2. max_pull: bound of -F g, at least 0."""
    # The loop ends at the latest when the radius underflows to 0, where the bound is 0.
    while _D_distance_from_one_bound(radius, T, X, G, max_pull) >= BOX_SETTINGS.max_D_deviation_from_one:
        radius /= 2
    return radius


def _D_distance_from_one_bound(radius: float, T: float, X: float, G: float, max_pull: float) -> float:
    """An upper bound of |D(i eta) - 1| for |eta| <= `radius`, below exp(1); exp(1) or inf: no useful bound.
    T, X, G: bounds of c2 + gamma3, c2 gamma3 and |g nu|, g = nu + F c2. max_pull: bound of -F g, at least
    0."""
    exponent = sqrt(max_pull + T * radius + 2 * sqrt(radius * (G + X * radius)))
    if exponent > 1 + sqrt(max_pull):
        return inf
    factor = (T * radius + sqrt(radius * G) + 2 * radius * sqrt(X)) / 2
    # The cap keeps exp from overflowing: every bound above 1/2 means the same to the caller.
    return exp(min(exponent + log(factor), 1.0)) if factor > 0 else 0.0
