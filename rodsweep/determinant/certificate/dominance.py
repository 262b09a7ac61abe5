"""Discs of w in which one exponential of D dominates, so that D has no zero and the phase of D is known.

With sqrt(z+) the root of larger real part, D (`rodsweep.determinant.value`) is

    D = A (1 + e),   A = w z+' exp(sqrt z+)/(4 z+),
    A e = 1 + (w z+'/(4 z+)) (exp(-sqrt z+) - 2) + (w/2) z-' E(z-), E(z) = (cosh sqrt(z) - 1)/z.

Over a disc |dw| <= rho with |e| < 1 and Re sqrt(z+) > Re sqrt(z-) the phase of D is arg A + arg(1 + e). The
term arg(1 + e) stays within a right angle and is needed only at the two ends of a chain of such discs. All
bounds are relative to exp(L dw), L = z+'/(2 sqrt z+), as in `rodsweep.determinant.certificate.discs`.
Eigenvalues lie near the negative real axis; far from this axis the radius may be a quarter of |w|.
"""

import cmath
import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants
from ...model.rod import Coefficients
from ..value import exponent_derivatives, scaled_determinant
from .discs import DISC_BOUND_SETTINGS, entire_cosh_bounds_on_bidisc, nonlinear_sqrt_change_bound


@dataclass(frozen=True, slots=True, kw_only=True)
class DominanceSettings(KernelConstants):
    """Settings for discs in which one exponential of D dominates."""

    first_radius_over_branch_point_distance: float = 0.25
    """Radius of the first trial disc divided by the distance of the start of the step from a branch point of
    z+-."""
    max_halvings: int = 2
    """The proved part of the segment ends where a trial disc, halved this many times, still does not prove
    that one exponential dominates D."""
    enlargement_fraction_for_overlap: float = 1e-3
    """The radius of a disc exceeds half the step that the disc covers by this fraction, so that rounding
    leaves no gap between discs."""
    segment_end_tolerance: float = 1e-15
    """A step ends at the end of the segment if the distance to the end, divided by the length of the segment,
    is at most this number, the size of rounding errors."""
    max_dominant_factor_change: float = 0.5
    """Dominance is proved only on discs over which no factor of the dominant term A of D changes by more than
    this fraction; the phase of each factor then changes by less than a right angle."""
    field_ranges: ClassVar = {
        "first_radius_over_branch_point_distance": (0.0, 1.0),
        "max_dominant_factor_change": (0.0, 1.0),
    }
    """Exclusive bounds (lower, upper) of fields, by name, that the proofs require; see `KernelConstants`."""


DOMINANCE_SETTINGS = DominanceSettings()


class SquaredExponent(NamedTuple):
    """One of the exponents z+ and z- of D (`rodsweep.determinant.value`) at a point w: z, slope dz/dw, and
    root sqrt(z)."""

    z: complex
    slope: complex
    sqrt_z: complex


@compiled
def _dominant_and_recessive(
    w: complex, coefficients: Coefficients
) -> tuple[complex, SquaredExponent, SquaredExponent]:
    """Returns (P, dominant exponent, recessive exponent) at w, with P from z+- = M +- 2 P
    (`rodsweep.determinant.value`). The dominant exponent is the one of z+ and z- with the larger Re
    sqrt(z)."""
    P, P_w, _, plus, minus = exponent_derivatives(w, coefficients)
    drag = coefficients.c2 + coefficients.gamma3
    plus_exponent = SquaredExponent(plus, drag + 2 * P_w, cmath.sqrt(plus))
    minus_exponent = SquaredExponent(minus, drag - 2 * P_w, cmath.sqrt(minus))
    if plus_exponent.sqrt_z.real >= minus_exponent.sqrt_z.real:
        return P, plus_exponent, minus_exponent
    return P, minus_exponent, plus_exponent


@compiled
def _nonlinear_change_bounds(
    w: complex, rho: float, P: complex, coefficients: Coefficients
) -> tuple[float, float]:
    """Returns upper bounds (nonlinear part of the change of z+-, change of dz+-/dw) over the disc |dw| <= rho
    about w; inf if the disc is too large. Of z+- = T w - F g +- 2 P, with T = c2 + gamma3, g = nu + F c2 and
    P^2 = w (g nu + c2 gamma3 w), only the term 2 P is nonlinear in w; 2 - sqrt(1 - e) majorises sqrt(1 +
    e)."""
    F, nu, c2, gamma3 = coefficients
    X = c2 * gamma3
    gn = (nu + F * c2) * nu
    e1 = rho / abs(w)
    e2 = 0.0
    if X > 0:
        e2 = X * rho / abs(gn + X * w)
    if (
        e1 > DOMINANCE_SETTINGS.max_dominant_factor_change
        or e2 > DOMINANCE_SETTINGS.max_dominant_factor_change
    ):
        return math.inf, math.inf
    min_factor = math.sqrt((1 - e1) * (1 - e2))
    numerator = abs(gn + 2 * X * w)
    nonlinear_change = 2 * abs(P) * ((2 - math.sqrt(1 - e1)) * (2 - math.sqrt(1 - e2)) - 1 - (e1 + e2) / 2)
    return nonlinear_change, ((numerator + 2 * X * rho) / min_factor - numerator) / abs(P)


@compiled
def has_dominant_exponential(w: complex, rho: float, coefficients: Coefficients) -> bool:
    """Whether it is proved that in the disc of radius rho about w one of the exponentials exp(sqrt z+),
    exp(sqrt z-) dominates D: D = A (1 + e) with |e| < 1."""
    P, (z, slope, root), (z_other, slope_other, root_other) = _dominant_and_recessive(w, coefficients)
    if P == 0 or root.real <= root_other.real:
        return False
    nonlinear_change, slope_change = _nonlinear_change_bounds(w, rho, P, coefficients)
    total_change = abs(slope) * rho + nonlinear_change
    x = total_change / abs(z)
    if (
        x > DOMINANCE_SETTINGS.max_dominant_factor_change
        or slope_change > DOMINANCE_SETTINGS.max_dominant_factor_change * abs(slope)
    ):
        return False
    L = slope / (2 * root)
    change_by_L = abs(L) * rho
    curvature = nonlinear_sqrt_change_bound(root, nonlinear_change, x)
    # Exponents are compared by their rates if the recessive exponent changes little, otherwise by extremes.
    lowest_dominant = root.real - change_by_L - curvature
    other_change = abs(slope_other) * rho + nonlinear_change
    highest_recessive = math.sqrt(max((abs(z_other) + z_other.real) / 2 + other_change, 0.0))
    if other_change < DOMINANCE_SETTINGS.max_dominant_factor_change * abs(z_other):
        other_root_change = nonlinear_sqrt_change_bound(
            root_other, nonlinear_change, other_change / abs(z_other)
        )
        relative_change = abs(slope_other / (2 * root_other) - L) * rho + other_root_change
        if not root.real - curvature > root_other.real + relative_change:
            return False
    elif not lowest_dominant > highest_recessive:
        return False
    # D = A (1 + e) with A the part of the dominant exponential; |e| < 1 turns the phase of D into that of A.
    S = root.real
    max_w = abs(w) + rho
    A = (abs(w) - rho) * (abs(slope) - slope_change) / (4 * (abs(z) + total_change)) * math.exp(-curvature)
    constant_bound = math.exp(change_by_L - S)
    remainder = constant_bound + max_w * (abs(slope) + slope_change) / (4 * (abs(z) - total_change)) * (
        2 * constant_bound + math.exp(2 * change_by_L + curvature - 2 * S)
    )
    E = entire_cosh_bounds_on_bidisc(z_other, (slope_other, 0j), (L, 0j), (rho, 0.0), nonlinear_change, S)[0]
    remainder += max_w / 2 * (abs(slope_other) + slope_change) * E
    return remainder < DISC_BOUND_SETTINGS.max_D_change_ratio * A


@compiled
def dominant_prefactor_and_exponent(w: complex, coefficients: Coefficients) -> tuple[complex, complex]:
    """Returns (w z'/z, sqrt z) at w for the dominant exponent z; the dominant term of D is A = (w z'/z)
    exp(sqrt z)/4."""
    _, dominant, _ = _dominant_and_recessive(w, coefficients)
    return w * dominant.slope / dominant.z, dominant.sqrt_z


@compiled
def _phase_minus_dominant_phase(
    w: complex, factors: tuple[complex, complex], coefficients: Coefficients
) -> float:
    """arg(D/A), the phase of D minus the phase of its dominant term A. factors: result of
    `dominant_prefactor_and_exponent` at w."""
    D, _, _, _ = scaled_determinant(w, coefficients)
    factor, root = factors
    # Only the phase is wanted, so both moduli, which may overflow, are left out.
    return cmath.phase(D / (factor * cmath.exp(complex(0.0, root.imag))))


@compiled
def phase_over_dominated_segment(
    start: complex, direction: complex, length: float, coefficients: Coefficients
) -> tuple[float, float, int]:
    """Returns (length, change, number of examined discs). length: length of the segment from `start` on which
    one exponential is proved to dominate D, at most the argument `length`. change: change of arg D over this
    part of the segment. direction: unit vector of the segment."""
    F, nu, c2, gamma3 = coefficients
    X = c2 * gamma3
    gn = (nu + F * c2) * nu
    w = start
    t = 0.0
    change = 0.0
    disc_count = 0
    wave = (0j, 0j)
    first_wave = (0j, 0j)
    while t < length:
        rho = DOMINANCE_SETTINGS.first_radius_over_branch_point_distance * abs(w)
        if X > 0:
            rho = min(rho, DOMINANCE_SETTINGS.first_radius_over_branch_point_distance * abs(gn + X * w) / X)
        # A disc covers the step with its diameter.
        rho = min(rho, (length - t) / 2)
        proved = False
        for _ in range(DOMINANCE_SETTINGS.max_halvings + 1):
            disc_count += 1
            # The disc is a little wider than the step, so that rounding leaves no gap between discs.
            radius = (1 + DOMINANCE_SETTINGS.enlargement_fraction_for_overlap) * rho
            if has_dominant_exponential(w + direction * rho, radius, coefficients):
                proved = True
                break
            rho /= 2
        if not proved:
            break
        # Most trials prove no disc at all, so the first wave is computed only after a proof.
        if t == 0.0:
            wave = dominant_prefactor_and_exponent(w, coefficients)
            first_wave = wave
        # A remainder of the size of rounding would leave a last disc of radius 0.
        t = length if t + 2 * rho >= length * (1 - DOMINANCE_SETTINGS.segment_end_tolerance) else t + 2 * rho
        w = start + direction * t
        next_wave = dominant_prefactor_and_exponent(w, coefficients)
        # The change of arg A over the step, in closed form; it may exceed 2 pi.
        change += (next_wave[1] - wave[1]).imag + cmath.phase(next_wave[0] / wave[0])
        wave = next_wave
    if t > 0.0:
        change += _phase_minus_dominant_phase(w, wave, coefficients) - _phase_minus_dominant_phase(
            start, first_wave, coefficients
        )
    return t, change, disc_count
