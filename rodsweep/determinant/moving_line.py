"""Proof that no eigenvalue crosses a vertical line that moves while the rod changes along a path.

The line is Re w = l(p) < 0, with l linear in p. All eigenvalues right of the line lie in the a-priori box for
the whole interval of p. Their number is constant over the interval if D has no zero on

    w = l(p) + i y,   0 <= y <= height of the box,

since D is real on the real axis. Rectangles of (y, p) cover this strip from y = 0 upwards. Each rectangle is
proved to be free of zeros like the boxes of `rodsweep.determinant.certificate.covering`, with the
displacement dw = i dy + l' dp, at most hypot(h_y, l' h_p), instead of i dy.
"""

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from ..model.compiled.compilation import compiled
from ..model.compiled.kernel_constants import KernelConstants
from ..model.rod import Coefficients
from .certificate.box_of_all_eigenvalues import (
    BOX_SETTINGS,
    box_from_sqrt_frequency_bound,
    frequency_bound_between_rods,
)
from .certificate.covering import (
    distance_from_zero_bound,
    exponent_changes,
    is_taylor_remainder_below,
    modulus_weighted_exponent_slopes,
)
from .certificate.discs import DISC_BOUND_SETTINGS, bidisc_centre
from .parameter_path import determinant_value_on_path, dispersion_coefficient_derivatives


@dataclass(frozen=True, slots=True, kw_only=True)
class MovingLineSettings(KernelConstants):
    """Settings for the rectangles that prove that no eigenvalue crosses a moving line."""

    first_half_height_over_line_distance: float = 0.35
    """Half-height (in y) of the first rectangle, divided by the largest distance of the line from the
    imaginary axis."""
    half_height_growth_factor: float = 1.6
    """After a proved rectangle, the half-height of the next rectangle is larger by this factor."""
    max_half_height_over_w: float = 0.6
    """Largest half-height of a rectangle divided by |w| at its lower edge. The discs about the centre of the
    rectangle must not contain w = 0."""
    rectangle_enlargement_fraction: float = 1e-7
    """The half-widths of every rectangle are enlarged by this fraction, so that rounding leaves no gap."""
    min_rectangle_fraction: float = 1e-6
    """The proof fails if a rectangle is needed whose width in p is below this fraction of the interval of p,
    or whose half-height is below this fraction of the line's largest distance from the imaginary axis."""
    field_ranges: ClassVar = {
        "half_height_growth_factor": (1.0, math.inf),
        "max_half_height_over_w": (0.0, 1.0),
    }
    """Exclusive bounds (lower, upper) of fields, by name, that the proofs require; see `KernelConstants`."""


MOVING_LINE_SETTINGS = MovingLineSettings()


class RodAndLineAtEnd(NamedTuple):
    """An end of an interval of a path: p, coefficients of the rod at p, and `line`: Re w of the line at p."""

    p: float
    coefficients: Coefficients
    line: float


class UnprovedStrip(NamedTuple):
    """The part above y = `y_start` of the strip over a subinterval of p; D may still have zeros in this part.
    start_fraction, stop_fraction: ends of the subinterval, as fractions of the whole interval of p.
    next_rectangle_half_height: half the height of the next rectangle to try, in y."""

    start_fraction: float
    stop_fraction: float
    y_start: float
    """Lower end of the unproved part in y = Im w, in 1/tau2."""
    next_rectangle_half_height: float


@compiled
def interpolate_ends(fraction: float, first: RodAndLineAtEnd, last: RodAndLineAtEnd) -> RodAndLineAtEnd:
    """p, coefficients and line interpolated linearly between `first` (fraction = 0) and `last` (fraction =
    1). The interpolation has no cancellation."""
    a = 1 - fraction
    b = fraction
    F, nu, c2, gamma3 = first.coefficients
    F_last, nu_last, c2_last, gamma3_last = last.coefficients
    coefficients = Coefficients(
        a * F + b * F_last, a * nu + b * nu_last, a * c2 + b * c2_last, a * gamma3 + b * gamma3_last
    )
    return RodAndLineAtEnd(a * first.p + b * last.p, coefficients, a * first.line + b * last.line)


@compiled
def rectangle_proof_and_costs(
    centre_end: RodAndLineAtEnd,
    y: float,
    direction: Coefficients,
    half_widths: tuple[float, float],
    line_slope: float,
) -> tuple[bool, float, float]:
    """Returns (proved, cost in y, cost in p). proved: whether D is proved to have no zero on the rectangle
    about w = l(p) + i y. cost: change of the exponents of D across an unproved rectangle in y or in p, 0 for
    a proved one.

    centre_end: p, coefficients and line at the centre. direction: d(F, nu, c2, gamma3)/dp. half_widths:
    half-widths of the rectangle in y and in p. line_slope: dl/dp. Raises ValueError for a half-width that is
    not positive.
    """
    half_y, half_p = half_widths
    if not (half_y > 0 and half_p > 0):  # negative half-widths would pass the tests and prove nothing
        raise ValueError("the half-widths of a rectangle must be above 0")
    w = complex(centre_end.line, y)
    D, D_w, D_p, S, rounding_error = determinant_value_on_path(w, centre_end.coefficients, direction)
    rounding = DISC_BOUND_SETTINGS.rounding_safety_factor * rounding_error
    centre = bidisc_centre(
        w, centre_end.coefficients, dispersion_coefficient_derivatives(centre_end.coefficients, direction), S
    )
    radii = (math.hypot(half_y, line_slope * half_p), half_p)
    if abs(D) > 2 * rounding:
        if is_taylor_remainder_below(
            centre, (D_w / D, D_p / D), radii, DISC_BOUND_SETTINGS.max_D_change_ratio * abs(D) - rounding, 1
        ):
            return True, 0.0, 0.0
        mean_rates = modulus_weighted_exponent_slopes(centre)
        w_slope = D_w - mean_rates[0] * D
        p_slope = D_p - mean_rates[1] * D
        max_remainder = (
            DISC_BOUND_SETTINGS.max_D_change_ratio
            * distance_from_zero_bound(D, 1j * w_slope * half_y, (line_slope * w_slope + p_slope) * half_p)
            - rounding
        )
        if max_remainder > 0 and is_taylor_remainder_below(centre, mean_rates, radii, max_remainder, 1):
            return True, 0.0, 0.0
    cost_y, cost_p = exponent_changes(centre, half_widths)
    return False, cost_y, max(cost_p, exponent_changes(centre, (abs(line_slope) * half_p, half_p))[0])


@compiled
def no_crossing_proof_and_count(
    first: RodAndLineAtEnd, last: RodAndLineAtEnd, direction: Coefficients, max_count: int
) -> tuple[bool, int]:
    """Returns (proved, number of rectangles examined). proved: whether it is proved that no eigenvalue
    crosses the moving line.

    first, last: ends of the interval, in either order. direction: d(F, nu, c2, gamma3)/dp. max_count:
    maximum number of rectangles. The proof fails if both ends have equal p, if the line is not left of the
    imaginary axis, or if no a-priori bound on the eigenvalues exists.
    """
    if first.p > last.p:
        first, last = last, first
    depth = -min(first.line, last.line)
    bound = frequency_bound_between_rods(first.coefficients, last.coefficients)
    a = math.sqrt((1 + BOX_SETTINGS.relative_bound_excess) * bound)
    if not (first.p < last.p and max(first.line, last.line) < 0 and a < math.inf):
        return False, 0
    top = box_from_sqrt_frequency_bound(a, depth)[1]
    width = last.p - first.p
    slope = (last.line - first.line) / width
    enlargement = 1 + MOVING_LINE_SETTINGS.rectangle_enlargement_fraction
    min_fraction = MOVING_LINE_SETTINGS.min_rectangle_fraction
    count = 0
    stack = [UnprovedStrip(0.0, 1.0, 0.0, MOVING_LINE_SETTINGS.first_half_height_over_line_distance * depth)]
    while len(stack) > 0:
        start, stop, y, half_y = stack.pop()
        middle = interpolate_ends((start + stop) / 2, first, last)
        half_p = width * (stop - start) / 2
        while y < top:
            if count >= max_count or half_y < min_fraction * depth or stop - start < min_fraction:
                return False, count
            count += 1
            # The first rectangle is centred on the real axis: the lower half plane mirrors the upper.
            centre_y = y + half_y if y > 0 else 0.0
            half = (enlargement * half_y, enlargement * half_p)
            proved, cost_y, cost_p = rectangle_proof_and_costs(middle, centre_y, direction, half, slope)
            if proved:
                y = centre_y + half_y
                max_half = MOVING_LINE_SETTINGS.max_half_height_over_w * math.hypot(middle.line, y)
                half_y = min(MOVING_LINE_SETTINGS.half_height_growth_factor * half_y, max_half)
            elif cost_p > cost_y:
                # Split in p from the height y upwards: the strip below y is already proved for both halves.
                stack.append(UnprovedStrip((start + stop) / 2, stop, y, half_y))
                stack.append(UnprovedStrip(start, (start + stop) / 2, y, half_y))
                break
            else:
                half_y /= 2
    return True, count
