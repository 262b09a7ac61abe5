"""Upper bounds of |D(w, p) exp(-L (w - c) - K (p - p_c))| over a bidisc about (c, p_c), for Cauchy's
estimate.

p is the path variable (`parameter_path`); for a single rod the disc of p has radius 0. L and K are
logarithmic growth rates of D by w and by p, which are split off.
"""

import cmath
import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants
from ...model.rod import Coefficients
from ..exponents import EXPONENT_SETTINGS
from ..parameter_path import DispersionCoefficientDerivatives, squared_exponent_slopes_by_p
from ..value import exponent_derivatives


@dataclass(frozen=True, slots=True, kw_only=True)
class DiscBoundSettings(KernelConstants):
    """Settings for upper bounds of D over discs in w and bidiscs in (w, p)."""

    rounding_safety_factor: float = 4.0
    """|rounding error of D| <= this number times `DeterminantValue.rounding_error`; the largest ratio of
    20,000 unfavourable values was 0.7."""
    max_D_change_ratio: float = 0.9
    """A proof needs a change of D over the disc below this number times |D|; it is below 1, so that D has no
    zero in the disc."""
    max_relative_z_change_for_expansion: float = 0.5
    """sqrt(z) is expanded about the centre of a disc if the relative change x of z over the disc is below
    this number. The remainder is proportional to x^2/(1 - x)."""
    max_relative_P_factor_change: float = 0.98
    """If either factor of P^2 = w (g nu + c2 gamma3 w) changes over a disc by more than this fraction, the
    bound is inf."""
    field_ranges: ClassVar = {
        "max_D_change_ratio": (0.0, 1.0),
        "max_relative_z_change_for_expansion": (0.0, 1.0),
        "max_relative_P_factor_change": (0.0, 1.0),
    }
    """Exclusive bounds (lower, upper) of fields, by name, that the proofs require; see `KernelConstants`."""


DISC_BOUND_SETTINGS = DiscBoundSettings()


DerivativePair = tuple[complex, complex]
"""(derivative by w, derivative by p)."""
BidiscRadii = tuple[float, float]
"""(radius in w, radius in p) of a bidisc; also used for a pair of real bounds."""


class BidiscCentre(NamedTuple):
    """The centre (w, p) of a bidisc, with the exponents of D at the centre. coefficients: (F, nu, c2, gamma3)
    at p. dispersion_coefficient_derivatives: first and second derivatives by p of T = c2 + gamma3, N = F g, G
    = g nu and X = c2 gamma3. log_scale: S, the logarithm of the scale of D. P, z_plus, z_minus: P, z+ and z-.
    z_plus_slopes, z_minus_slopes: (dz/dw, dz/dp) of z+ and of z-."""

    w: complex
    coefficients: Coefficients
    dispersion_coefficient_derivatives: DispersionCoefficientDerivatives
    log_scale: float
    P: complex
    z_plus: complex
    z_minus: complex
    z_plus_slopes: DerivativePair
    z_minus_slopes: DerivativePair


@compiled
def bidisc_centre(
    w: complex,
    coefficients: Coefficients,
    dispersion_coefficient_derivatives: DispersionCoefficientDerivatives,
    S: float,
) -> BidiscCentre:
    """The centre of a bidisc at w. dispersion_coefficient_derivatives: first and second derivatives by p of T
    = c2 + gamma3, N = F g, G = g nu and X = c2 gamma3. S: logarithm of the scale of D at w."""
    exponents = exponent_derivatives(w, coefficients)
    p_slope_plus, p_slope_minus = squared_exponent_slopes_by_p(
        w, exponents, dispersion_coefficient_derivatives
    )
    drag = coefficients.c2 + coefficients.gamma3
    z_plus_slopes = (drag + 2 * exponents.P_w, p_slope_plus)
    z_minus_slopes = (drag - 2 * exponents.P_w, p_slope_minus)
    return BidiscCentre(
        w,
        coefficients,
        dispersion_coefficient_derivatives,
        S,
        exponents.P,
        exponents.z_plus,
        exponents.z_minus,
        z_plus_slopes,
        z_minus_slopes,
    )


@compiled
def nonlinear_sqrt_change_bound(root: complex, nonlinear_change: float, x: float) -> float:
    """Bound of the nonlinear part of the change of sqrt(z) = `root`. x: bound of the total change of z over
    |z|. nonlinear_change: bound of the nonlinear part of the change of z."""
    return nonlinear_change / (2 * abs(root)) + abs(root) * x * x / (8 * (1 - x))


@compiled
def entire_cosh_bounds_on_bidisc(
    z: complex,
    slopes: DerivativePair,
    rates: DerivativePair,
    radii: BidiscRadii,
    nonlinear_change: float,
    S: float,
) -> BidiscRadii:
    """Bounds of |E| and |dE/dz|, E = (cosh sqrt(z) - 1)/z, over a bidisc, times |exp(-L dw - K dp)| exp(-S).
    slopes: (dz/dw, dz/dp). rates: (L, K). nonlinear_change: bound of the nonlinear change of z. S: logarithm
    of the scale of D. The exponents +-sqrt(z) - L dw - K dp are bounded by means of |sqrt(z)| and, away from
    z = 0, by the Taylor polynomial of sqrt(z); the smaller bound is used. Then |E| <= exp(Re sqrt z)/2 and
    |dE/dz| <= cosh(Re sqrt z)/24; closed forms give smaller bounds for large z.
    """
    root = cmath.sqrt(z)
    rate_change = abs(rates[0]) * radii[0] + abs(rates[1]) * radii[1]
    change = abs(slopes[0]) * radii[0] + abs(slopes[1]) * radii[1] + nonlinear_change
    # Re sqrt(z) = sqrt((|z| + Re z)/2), which a change of z raises by no more than this.
    simple_bound = math.sqrt(max((abs(z) + z.real) / 2 + change, 0.0)) + rate_change
    growing_exponent = simple_bound
    decaying_exponent = simple_bound
    if change < DISC_BOUND_SETTINGS.max_relative_z_change_for_expansion * abs(z):
        w_slope = slopes[0] / (2 * root)
        p_slope = slopes[1] / (2 * root)
        nonlinear_root_change = nonlinear_sqrt_change_bound(root, nonlinear_change, change / abs(z))
        growing_change = abs(w_slope - rates[0]) * radii[0] + abs(p_slope - rates[1]) * radii[1]
        decaying_change = abs(w_slope + rates[0]) * radii[0] + abs(p_slope + rates[1]) * radii[1]
        growing_exponent = min(growing_exponent, root.real + growing_change + nonlinear_root_change)
        decaying_exponent = min(decaying_exponent, -root.real + decaying_change + nonlinear_root_change)
    max_exponent = EXPONENT_SETTINGS.max_exponent
    exponentials = math.exp(min(growing_exponent - S, max_exponent)) + math.exp(
        min(decaying_exponent - S, max_exponent)
    )
    # The -1 of E = (cosh - 1)/z and its derivative.
    exponentials += 2 * math.exp(min(rate_change - S, max_exponent))
    # These bounds hold near z = 0 too, unlike bounds by 1/|z|: E(0) = 1/2 is an eighth of four exponentials.
    E = 1 / 8
    E1 = 1 / 48
    if abs(z) > change:
        m = abs(z) - change
        E = min(E, 1 / (2 * m))
        E1 = min(E1, 1 / (4 * m * math.sqrt(m)) + 1 / (2 * m * m))
    return E * exponentials, E1 * exponentials


@compiled
def bound_for_equal_exponents(centre: BidiscCentre, rates: DerivativePair, radii: BidiscRadii) -> float:
    """`bound_on_bidisc` for nearly equal z+ and z-, from |E(z+) - E(z-)| <= 4 |P| max |dE/dz|, E(z) = (cosh
    sqrt(z) - 1)/z."""
    w = centre.w
    S = centre.log_scale
    F, nu, c2, gamma3 = centre.coefficients
    T_p, N_p, N_pp, G_p, G_pp, X_p, X_pp = centre.dispersion_coefficient_derivatives
    rho, sigma = radii
    g = nu + F * c2
    X = c2 * gamma3
    T = c2 + gamma3
    max_w = abs(w) + rho
    dG = (abs(G_p) + abs(G_pp) / 2 * sigma) * sigma
    dX = (abs(X_p) + abs(X_pp) / 2 * sigma) * sigma
    max_squared_P = max_w * (abs(g * nu + X * w) + dG + X * rho + dX * max_w)
    nonlinear_change = abs(T_p) * sigma * rho + abs(N_pp) / 2 * sigma * sigma + 2 * math.sqrt(max_squared_P)
    E, E1 = entire_cosh_bounds_on_bidisc(
        T * w - F * g, (complex(T), T_p * w - N_p), rates, radii, nonlinear_change, S
    )
    rate_change = abs(rates[0]) * rho + abs(rates[1]) * sigma
    slope_bound = abs(g * nu + 2 * X * w) + dG + 2 * (X * rho + dX * max_w)
    constant_bound = math.exp(min(rate_change - S, EXPONENT_SETTINGS.max_exponent))
    return constant_bound + max_w * ((T + abs(T_p) * sigma) * E + 2 * slope_bound * E1)


@compiled
def bound_on_bidisc(centre: BidiscCentre, rates: DerivativePair, radii: BidiscRadii) -> float:
    """An upper bound of |D exp(-L dw - K dp)| exp(-S) over the bidisc about `centre`; rates: (L, K). dw, dp:
    distances from the centre. S: `centre.log_scale`."""
    F, nu, c2, _ = centre.coefficients
    separate_bound = bound_for_distinct_exponents(centre, rates, radii)
    if F * (nu + F * c2) < 0:  # both exponentials grow at similar rates; separate bounds do not cancel
        return min(separate_bound, bound_for_equal_exponents(centre, rates, radii))
    return separate_bound


@compiled
def bound_for_distinct_exponents(centre: BidiscCentre, rates: DerivativePair, radii: BidiscRadii) -> float:
    """`bound_on_bidisc` for distinct z+ and z-, from separate bounds of E(z+) and E(z-), E(z) = (cosh sqrt(z)
    - 1)/z; inf if the bidisc is too large. Over the bidisc, w changes by a factor 1 + e1 and g nu + c2 gamma3
    w by a factor 1 + e2, with bounds of |e1| and |e2|; 2 - sqrt(1 - e) majorises sqrt(1 + e)."""
    w = centre.w
    S = centre.log_scale
    P = centre.P
    F, nu, c2, gamma3 = centre.coefficients
    T_p, _, N_pp, G_p, G_pp, X_p, X_pp = centre.dispersion_coefficient_derivatives
    rho, sigma = radii
    g = nu + F * c2
    X = c2 * gamma3
    modulus = abs(g * nu + X * w)
    dG = (abs(G_p) + abs(G_pp) / 2 * sigma) * sigma
    dX = (abs(X_p) + abs(X_pp) / 2 * sigma) * sigma
    # P = sqrt(w) sqrt(g nu + X w): relative changes of the two factors.
    e1 = rho / abs(w)
    max_change = dG + X * rho + dX * (abs(w) + rho)
    e2 = max_change / modulus if modulus > max_change else 1.0
    if e1 > DISC_BOUND_SETTINGS.max_relative_P_factor_change or (
        max_change > 0 and e2 > DISC_BOUND_SETTINGS.max_relative_P_factor_change
    ):
        return math.inf
    # If g nu and X are 0, the second factor is 0 on the whole bidisc and does not change.
    if max_change == 0:
        e2 = 0.0
    nonlinear_change = abs(T_p) * sigma * rho + abs(N_pp) / 2 * sigma * sigma
    slope_bound = c2 + gamma3 + abs(T_p) * sigma
    if P != 0:
        second_order = abs(G_pp) / 2 * sigma + abs(X_pp) / 2 * sigma * (abs(w) + rho) + abs(X_p) * rho
        # 2 - sqrt(1 - e) has the Taylor coefficients of sqrt(1 + e) in modulus, hence bounds the nonlinear
        # part of P.
        majorant = (2 - math.sqrt(1 - e1)) * (2 - math.sqrt(1 - e2)) - 1 - (e1 + e2) / 2
        nonlinear_change += 2 * abs(P) * (majorant + second_order * sigma / modulus / 2)
        min_P = abs(P) * math.sqrt((1 - e1) * (1 - e2))
        slope_bound += (abs(g * nu + 2 * X * w) + dG + 2 * (X * rho + dX * (abs(w) + rho))) / min_P
    terms = entire_cosh_bounds_on_bidisc(
        centre.z_plus, centre.z_plus_slopes, rates, radii, nonlinear_change, S
    )[0]
    terms += entire_cosh_bounds_on_bidisc(
        centre.z_minus, centre.z_minus_slopes, rates, radii, nonlinear_change, S
    )[0]
    rate_change = abs(rates[0]) * rho + abs(rates[1]) * sigma
    return (
        math.exp(min(rate_change - S, EXPONENT_SETTINGS.max_exponent))
        + (abs(w) + rho) / 2 * slope_bound * terms
    )
