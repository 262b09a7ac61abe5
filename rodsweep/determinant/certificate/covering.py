"""All crossings of the imaginary axis along a path of uniform rods, with a proof of completeness.

Along a path p -> rod a pair crosses where D(i eta; p) = 0, two real equations in (eta, p). The a-priori
bounds leave a finite region of the (eta, p) plane (`first_crossing_boxes`), which is divided into boxes until
each box is

* empty: with the centre c and half-widths (h_w, h_p) of the box, f = D exp(-L dw - K dp) is at most M in the
  bidisc of radii (h_w, h_p)/t. Cauchy's estimate on complex lines gives

      |f - f(c) - f'(c)(dw, dp)| <= M t^2/(1 - t)   in the box,

  which is less than the distance of the parallelogram f(c) + f'(c)(box) from zero; or
* regular: Cauchy's estimate of the second derivatives shows that the doubled box contains at most one
  zero, and Newton's method finds the zero; or
* open: as small as rounding allows, near the meeting of two crossings.

(L, K) is either the logarithmic derivative of D, for which f'(c) vanishes, or the mean growth rate of the
exponentials in D, which stays bounded near a zero of D.
"""

import cmath
import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants
from ...model.rod import Coefficients
from ..exponents import EXPONENT_SETTINGS
from ..parameter_path import coefficients_at, determinant_value_on_path, dispersion_coefficient_derivatives
from ..roots.newton import FAILED_EIGENVALUE, LocatedEigenvalue, crossing_by_newton
from .discs import DISC_BOUND_SETTINGS, BidiscCentre, DerivativePair, bidisc_centre, bound_on_bidisc


@dataclass(frozen=True, slots=True, kw_only=True)
class BoxProofSettings(KernelConstants):
    """Settings for the proofs about one box of the (eta, p) plane, and for the number of boxes."""

    first_half_width_over_radius: float = 0.45
    """First trial ratio t of the half-width of a box to the radius of the bidisc on which D is bounded."""
    half_width_over_radius_factor: float = 0.6
    """The next trial ratio is this number times the previous trial ratio t."""
    max_half_width_over_radius_trials: int = 30
    """Maximum number of trial ratios of half-width to bidisc radius; the last ratio is 2e-7."""
    min_half_width_over_centre: float = 1e-9
    """An undecided box is left open if its half-widths are below this number times eta and times |p|."""
    max_boxes: int = 1_000_000
    """After this number of examined boxes, further undecided boxes are left open, not divided."""
    max_known_zero_distance_in_half_widths: float = 1.5
    """If the doubled box contains at most one zero of D (a regular box), a known zero at most this far from
    the centre of the box, in half-widths, is that zero."""
    neighbour_zero_distance_in_half_widths: float = 0.01
    """If the zero of a regular box (at most one zero in the doubled box) lies outside the box by more than
    this distance, in half-widths, it is counted in the neighbouring box that contains it."""
    field_ranges: ClassVar = {
        "first_half_width_over_radius": (0.0, 1.0),
        "half_width_over_radius_factor": (0.0, 1.0),
        "max_known_zero_distance_in_half_widths": (1.0, 2.0),
    }


BOX_PROOF_SETTINGS = BoxProofSettings()

ZERO_FREE_BOX = 0
BOX_WITH_AT_MOST_ONE_ZERO = 1
UNDECIDED_BOX = 2
"""Outcomes of `box_outcome_and_costs`. ZERO_FREE_BOX: D has no zero in the box. BOX_WITH_AT_MOST_ONE_ZERO: D
has at most one zero in the doubled box. UNDECIDED_BOX: neither is proved."""


class CrossingBox(NamedTuple):
    """A rectangle of the (eta, p) plane: frequency eta on the imaginary axis, path variable p."""

    eta_from: float
    """Smallest frequency eta of the box, in 1/tau2."""
    eta_to: float
    """Largest frequency eta of the box, in 1/tau2."""
    p_from: float
    """Smallest path variable p of the box."""
    p_to: float
    """Largest path variable p of the box."""


@compiled
def distance_from_zero_bound(value: complex, a: complex, b: complex) -> float:
    """A lower bound of |value + x a + y b| over all real x, y in [-1, 1]; 0 if no positive bound is found."""
    bound = 0.0
    # The set is a parallelogram; a separating line is parallel to a side, or across the value.
    for normal in (value, 1j * a, 1j * b):
        size = abs(normal)
        if size > 0:
            u = normal.conjugate() / size
            bound = max(bound, abs((u * value).real) - abs((u * a).real) - abs((u * b).real))
    return bound


@compiled
def modulus_weighted_exponent_slopes(centre: BidiscCentre) -> DerivativePair:
    """(L, K): the slopes d sqrt(z)/dw and d sqrt(z)/dp of the exponents, z = z+ and z-, averaged over the two
    exponentials of D with their moduli as weights."""
    root_plus = cmath.sqrt(centre.z_plus)
    root_minus = cmath.sqrt(centre.z_minus)
    # Removing the mean growth of the exponentials leaves a function that hardly changes over the box.
    size_plus = math.exp(root_plus.real - centre.log_scale)
    size_minus = math.exp(root_minus.real - centre.log_scale)
    a = size_plus / (size_plus + size_minus)
    b = size_minus / (size_plus + size_minus)
    w_rate = a * centre.z_plus_slopes[0] / (2 * root_plus) + b * centre.z_minus_slopes[0] / (2 * root_minus)
    return w_rate, a * centre.z_plus_slopes[1] / (2 * root_plus) + b * centre.z_minus_slopes[1] / (
        2 * root_minus
    )


@compiled
def is_taylor_remainder_below(
    centre: BidiscCentre, rates: DerivativePair, half: tuple[float, float], margin: float, power: int
) -> bool:
    """Whether the Taylor remainder M t^2/(1 - t)^power of D exp(-L dw - K dp) over a box is proved to be
    below `margin`. t: half-widths of the box divided by the radii of the bidisc on which M bounds the
    function; several t are tried. rates: (L, K). half: half-widths of the box."""
    t = BOX_PROOF_SETTINGS.first_half_width_over_radius
    previous_remainder = math.inf
    for _ in range(BOX_PROOF_SETTINGS.max_half_width_over_radius_trials):
        M = bound_on_bidisc(centre, rates, (half[0] / t, half[1] / t))
        remainder = M * t * t / (1 - t) ** power
        if remainder < margin:
            return True
        # The bound has a single minimum in t.
        if remainder > previous_remainder:
            return False
        previous_remainder = remainder
        t *= BOX_PROOF_SETTINGS.half_width_over_radius_factor
    return False


@compiled
def box_outcome_and_costs(
    w: complex, coefficients: Coefficients, direction: Coefficients, half: tuple[float, float]
) -> tuple[int, float, float]:
    """Returns (outcome, cost in eta, cost in p) for the box about w = i eta with half-widths `half`.

    outcome: ZERO_FREE_BOX, BOX_WITH_AT_MOST_ONE_ZERO or UNDECIDED_BOX. cost: change of the exponents of D
    across an undecided box in eta or in p, 0 for other boxes; the variable with the higher cost is divided.
    coefficients, direction: coefficients at the centre and their derivative by p.
    """
    D, D_w, D_p, S, rounding_error = determinant_value_on_path(w, coefficients, direction)
    centre = bidisc_centre(w, coefficients, dispersion_coefficient_derivatives(coefficients, direction), S)
    mean = modulus_weighted_exponent_slopes(centre)
    rounding = DISC_BOUND_SETTINGS.rounding_safety_factor * rounding_error
    if abs(D) > 2 * rounding:
        # The logarithmic derivatives are best where one exponential dominates, the mean where both matter.
        for rates in ((D_w / D, D_p / D), mean):
            a = 1j * (D_w - rates[0] * D) * half[0]
            b = (D_p - rates[1] * D) * half[1]
            margin = DISC_BOUND_SETTINGS.max_D_change_ratio * distance_from_zero_bound(D, a, b) - rounding
            if margin > 0 and is_taylor_remainder_below(centre, rates, half, margin, 1):
                return ZERO_FREE_BOX, 0.0, 0.0
    # In the doubled box each derivative of f changes by at most 3 M t^2/(1 - t)^2.
    a = 2j * (D_w - mean[0] * D) * half[0]
    b = 2 * (D_p - mean[1] * D) * half[1]
    if abs(D) < 2 * (abs(a) + abs(b)):
        # The smallest singular value of the linear map is at least |det| over the sum of its columns: at most
        # one zero.
        min_singular_value = abs((a * b.conjugate()).imag) / (abs(a) + abs(b))
        margin = (DISC_BOUND_SETTINGS.max_D_change_ratio * min_singular_value - rounding) / 3
        doubled_half_widths = (2 * half[0], 2 * half[1])
        if margin > 0 and is_taylor_remainder_below(centre, mean, doubled_half_widths, margin, 2):
            return BOX_WITH_AT_MOST_ONE_ZERO, 0.0, 0.0
    cost_eta, cost_p = exponent_changes(centre, half)
    return UNDECIDED_BOX, cost_eta, cost_p


@compiled
def exponent_changes(centre: BidiscCentre, half: tuple[float, float]) -> tuple[float, float]:
    """Largest change of D's exponents, log w and log P^2: (if eta, if p changes by its half-width `half`)."""
    F, nu, c2, gamma3 = centre.coefficients
    size = abs(centre.w)
    root_plus = math.sqrt(max(abs(centre.z_plus), 1.0))
    root_minus = math.sqrt(max(abs(centre.z_minus), 1.0))
    plus = centre.z_plus_slopes
    minus = centre.z_minus_slopes
    w_change = max(abs(plus[0]) / root_plus, abs(minus[0]) / root_minus) * half[0] / 2
    p_change = max(abs(plus[1]) / root_plus, abs(minus[1]) / root_minus) * half[1] / 2
    stiffness = abs((nu + F * c2) * nu) + c2 * gamma3 * size
    # The bounds on the bidisc also need a small change of the radicand of P.
    factor = (
        abs(centre.dispersion_coefficient_derivatives.G_p)
        + abs(centre.dispersion_coefficient_derivatives.X_p) * size
    )
    return max(w_change, half[0] / size), max(
        p_change, factor * half[1] / max(stiffness, EXPONENT_SETTINGS.min_divisor)
    )


@compiled
def zeros_and_open_boxes_of_covering(
    first: Array, origin: Coefficients, direction: Coefficients
) -> tuple[list[LocatedEigenvalue], list[CrossingBox], int]:
    """Returns (zeros of D(i eta; p), boxes left open, number of examined boxes). first: boxes to search, (n,
    4), rows as `CrossingBox`. origin, direction: coefficients at p = 0 and their derivative by p."""
    stack = [CrossingBox(first[i, 0], first[i, 1], first[i, 2], first[i, 3]) for i in range(len(first))]
    # numba infers the type of an empty list from its element.
    zeros = [FAILED_EIGENVALUE for _ in range(0)]
    undecided = [CrossingBox(0.0, 0.0, 0.0, 0.0) for _ in range(0)]
    count = 0
    while len(stack) > 0:
        # The last box comes first (depth first), so that the stack stays short.
        box = stack.pop()
        eta = (box.eta_from + box.eta_to) / 2
        p = (box.p_from + box.p_to) / 2
        half = (box.eta_to - box.eta_from) / 2, (box.p_to - box.p_from) / 2
        count += 1
        coefficients = coefficients_at(p, origin, direction)
        outcome, cost_eta, cost_p = box_outcome_and_costs(complex(0.0, eta), coefficients, direction, half)
        if outcome == ZERO_FREE_BOX:
            continue
        if outcome == BOX_WITH_AT_MOST_ONE_ZERO:
            zero = crossing_by_newton(eta, p, origin, direction, half)
            distance = _distance_from_box_centre(zero, eta, p, half)
            if distance <= 2:  # false if Newton's method failed, which returns nan
                # A zero outside the box is found from a neighbouring box too.
                is_known = distance > 1 + BOX_PROOF_SETTINGS.neighbour_zero_distance_in_half_widths
                for other in zeros:  # the doubled box contains at most one zero
                    other_distance = _distance_from_box_centre(other, eta, p, half)
                    is_known |= other_distance <= BOX_PROOF_SETTINGS.max_known_zero_distance_in_half_widths
                if not is_known:
                    zeros.append(zero)
                continue
        min_half_width = BOX_PROOF_SETTINGS.min_half_width_over_centre
        if count > BOX_PROOF_SETTINGS.max_boxes or (
            half[0] < min_half_width * eta and half[1] < min_half_width * abs(p)
        ):
            undecided.append(box)
        elif cost_eta >= cost_p:
            stack.append(CrossingBox(box.eta_from, eta, box.p_from, box.p_to))
            stack.append(CrossingBox(eta, box.eta_to, box.p_from, box.p_to))
        else:
            stack.append(CrossingBox(box.eta_from, box.eta_to, box.p_from, p))
            stack.append(CrossingBox(box.eta_from, box.eta_to, p, box.p_to))
    return zeros, undecided, count


@compiled
def _distance_from_box_centre(
    zero: LocatedEigenvalue, eta: float, p: float, half: tuple[float, float]
) -> float:
    """Distance of a zero from the centre (eta, p) of a box: the larger of the distances in eta and p, in
    units of the half-widths `half`."""
    return max(abs(zero.eta_or_x - eta) / half[0], abs(zero.p - p) / half[1])
