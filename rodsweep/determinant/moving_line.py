"""Proof that no eigenvalue crosses a vertical line that moves while the rod changes along a path.

The line Re w = l(p) < 0 is straight in p. All eigenvalues right of it lie in the a-priori box of the whole
interval of p, so that their number is the same for every p in it where D has no zero on

    w = l(p) + i y,   0 <= y <= the height of that box,

D being real on the real axis. The strip is walked upwards in rectangles of (y, p), each proved to be free of
zeros as the boxes of `rodsweep.determinant.certificate.covering` are, with the displacement
dw = i dy + l' dp, at most hypot(h_y, l' h_p), in the place of i dy.
"""

import math
from typing import NamedTuple

from ..model.compiled.compilation import compiled
from ..model.rod import Coefficients
from .certificate.box import MARGIN, box_of, squared_amplification_between
from .certificate.covering import costs, distance, mean_rates, remainder
from .certificate.discs import CLEARANCE, ROUNDING_OF_D, centre_at
from .parameter_path import changes, determinant_along

FIRST_HEIGHT = 0.35
"""Half the height of the first rectangle tried, in units of the line's distance."""
GROWTH = 1.6
"""Half the height of the next rectangle tried, in units of that of one that was proved."""
LARGEST_HEIGHT = 0.6
"""Largest half of a height, in units of |w| at the lower edge: the discs have to keep off w = 0."""
OVERLAP = 1 + 1e-7
"""Factor on the half-widths of every rectangle, so that rounding leaves no gap between two."""
SMALLEST_SHARE = 1e-6
"""Half-widths, in units of the interval of p and of the line's distance, below which nothing is divided."""


class End(NamedTuple):
    """One end of an interval of a path: p, the rod there, and where the line is."""

    p: float
    coefficients: Coefficients
    line: float


class Strip(NamedTuple):
    """What is open of the strip: shares of the interval of p, from which y on, half of the height to try."""

    start: float
    stop: float
    y: float
    half_y: float


@compiled
def end_between(share: float, first: End, last: End) -> End:
    """What lies at a share of the way from one end to the other; nothing cancels between 0 and 1."""
    a, b = 1 - share, share
    F, nu, c2, gamma3 = first.coefficients
    F_last, nu_last, c2_last, gamma3_last = last.coefficients
    there = Coefficients(
        a * F + b * F_last, a * nu + b * nu_last, a * c2 + b * c2_last, a * gamma3 + b * gamma3_last
    )
    return End(a * first.p + b * last.p, there, a * first.line + b * last.line)


@compiled
def free_of_zeros(
    at: End, y: float, direction: Coefficients, half: tuple[float, float], tilt: float
) -> tuple[bool, float, float]:
    """(whether D has no zero on the rectangle about l(p) + i y, costs in y and in p as in the covering).

    half: half-widths in y and p; tilt: dl/dp. Raises ValueError for half-widths that are not positive.
    """
    half_y, half_p = half
    if not (half_y > 0 and half_p > 0):  # every bound below would hold of negative ones, and prove nothing
        raise ValueError("a rectangle without an inside")
    w = complex(at.line, y)
    D, D_w, D_p, S, noise = determinant_along(w, at.coefficients, direction)
    rounding = ROUNDING_OF_D * noise
    centre = centre_at(w, at.coefficients, changes(at.coefficients, direction), S)
    radii = (math.hypot(half_y, tilt * half_p), half_p)
    if abs(D) > 2 * rounding:
        if remainder(centre, (D_w / D, D_p / D), radii, CLEARANCE * abs(D) - rounding, 1):
            return True, 0.0, 0.0
        mean = mean_rates(centre)
        in_w, in_p = D_w - mean[0] * D, D_p - mean[1] * D
        room = CLEARANCE * distance(D, 1j * in_w * half_y, (tilt * in_w + in_p) * half_p) - rounding
        if room > 0 and remainder(centre, mean, radii, room, 1):
            return True, 0.0, 0.0
    cost_y, cost_p = costs(centre, half)
    return False, cost_y, max(cost_p, costs(centre, (abs(tilt) * half_p, half_p))[0])


@compiled
def none_crosses(first: End, last: End, direction: Coefficients, most: int) -> tuple[bool, int]:
    """(whether it is proved that none crosses the line between two ends, rectangles examined, up to `most`).

    direction: d(F, nu, c2, gamma3)/dp. The ends may come in either order; equal ones prove nothing, nor does
    a line that is not left of the imaginary axis.
    """
    if first.p > last.p:
        first, last = last, first
    depth = -min(first.line, last.line)
    a = math.sqrt(MARGIN * squared_amplification_between(first.coefficients, last.coefficients))
    if not (first.p < last.p and max(first.line, last.line) < 0 and a < math.inf):
        return False, 0
    top = box_of(a, depth)[1]
    width = last.p - first.p
    tilt = (last.line - first.line) / width
    examined = 0
    stack = [Strip(0.0, 1.0, 0.0, FIRST_HEIGHT * depth)]
    while len(stack) > 0:
        start, stop, y, half_y = stack.pop()
        at = end_between((start + stop) / 2, first, last)
        half_p = width * (stop - start) / 2
        while y < top:
            if examined >= most or half_y < SMALLEST_SHARE * depth or stop - start < SMALLEST_SHARE:
                return False, examined
            examined += 1
            middle = y + half_y if y > 0 else 0.0
            half = (OVERLAP * half_y, OVERLAP * half_p)
            proved, cost_y, cost_p = free_of_zeros(at, middle, direction, half, tilt)
            if proved:
                y = middle + half_y
                half_y = min(GROWTH * half_y, LARGEST_HEIGHT * math.hypot(at.line, y))
            elif cost_p > cost_y:
                stack.append(Strip((start + stop) / 2, stop, y, half_y))
                stack.append(Strip(start, (start + stop) / 2, y, half_y))
                break
            else:
                half_y /= 2
    return True, examined
