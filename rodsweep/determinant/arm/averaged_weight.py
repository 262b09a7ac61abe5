"""Regions that contain every eigenvalue of an arm with jumps, from weights averaged over a window.

The identity of `rodsweep.determinant.arm.hull` needs a continuous weight alpha. Best would be t = g/(nu + l)
with l = f |F| sqrt(c2 c3 gamma3/gamma2), which jumps with the material. With log alpha as the mean of log t
over [u - h, u + h], the slope of log alpha is (log t(u + h) - log t(u - h))/(2 h), and what is left of the
term with theta has two parts,

    g - alpha nu = (g - t nu) + (t - alpha) nu.

The first part is bounded by the rotational drag. The second differs from 0 near the jumps only and is bounded
by theta(0) = 0; or the drag bounds both.
"""

import math

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled

FACTORS = (0.0, 0.5, 1.0)
"""Trial f."""
HALF_WIDTHS = (0.01, 0.02, 0.04, 0.08, 0.16, 0.32)
"""Trial h, in L."""
TRIALS = 2 * len(FACTORS) * len(HALF_WIDTHS)
"""Number of trial regions: two for each f and h."""
CLOSE = 1e-6
"""Distance of two points, in L, below which they are the two sides of a jump."""
BESIDE = 1e-12
"""Distance from the places where a slope jumps, in L, of the points on both their sides."""


@compiled
def averaged_regions(u: Array, local: Array, F: float) -> Array:
    """(a, c) of each trial, (trials, 2), inf where it gives none.

    u: points of an arm from base to tip, (points,), two at a jump. local: the `LocalCoefficients` there, (6,
    points), with c2 > 0 and g > 0.
    """
    regions = np.full((TRIALS, 2), math.inf)
    row = 0
    for h in HALF_WIDTHS:
        points = _with_places_beside_jumps(u, h)
        there = np.empty((6, len(points)))
        for k in range(6):
            there[k] = np.interp(points, u, local[k])
        for f in FACTORS:
            _fill(regions[row : row + 2], points, there, (F, f, h))
            row += 2
    return regions


@compiled
def _with_places_beside_jumps(u: Array, h: float) -> Array:
    """The points u and, on both sides of each place at the distance h from a jump, two more, increasing."""
    points = np.empty(5 * len(u))
    count = len(u)
    points[:count] = u
    for i in range(len(u) - 1):
        if u[i + 1] - u[i] < CLOSE:
            for side in (-h, h):
                for at in (-BESIDE, BESIDE):
                    place = (u[i + 1] + u[i]) / 2 + side + at
                    if u[0] < place < u[-1]:
                        points[count] = place
                        count += 1
    return np.sort(points[:count])


@compiled
def _fill(regions: Array, u: Array, local: Array, trial: tuple[float, float, float]) -> None:
    """The two regions of a trial (F, f, h): (t - alpha) nu bounded by the clamp, and by the drag."""
    F, f, h = trial
    count = len(u)
    log_t = np.empty(count)
    integral = np.zeros(count)
    for i in range(count):
        nu, c2, c3, gamma2, gamma3, g = local[:, i]
        log_t[i] = math.log(g / (nu + f * abs(F) * math.sqrt(c2 * c3 * gamma3 / gamma2)))
        if i > 0:
            integral[i] = integral[i - 1] + (u[i] - u[i - 1]) * (log_t[i] + log_t[i - 1]) / 2
    ahead = np.interp(u + h, u, log_t)
    behind = np.interp(u - h, u, log_t)
    # Beyond its ends the arm continues with its end values, so that every window has the same width.
    means = np.interp(u + h, u, integral) + np.maximum(u + h - u[-1], 0.0) * log_t[-1]
    means -= np.interp(u - h, u, integral) - np.maximum(u[0] - (u - h), 0.0) * log_t[0]
    split = 0.0
    whole = 0.0
    bend = 0.0
    share = 0.0
    before = 0.0
    for i in range(count):
        nu, c2, c3, gamma2, gamma3, g = local[:, i]
        alpha = math.exp(means[i] / (2 * h))
        t = math.exp(log_t[i])
        A2 = ((ahead[i] - behind[i]) / (2 * h)) ** 2 / (gamma2 * c2)
        B2 = F * F * alpha * c3 / gamma2
        split = max(split, squared_norm(A2, B2, g - t * nu if f > 0 else 0.0, gamma3 * alpha * c2))
        whole = max(whole, squared_norm(A2, B2, g - alpha * nu, gamma3 * alpha * c2))
        if i > 0:
            # As theta(0) = 0, |theta(u)|^2 is at most int_0^u c3 du times int c3 |m|^2 du.
            bend += (u[i] - u[i - 1]) * (c3 + local[2, i - 1]) / 2
        here = ((t - alpha) * nu) ** 2 / (alpha * c2) * bend
        if i > 0:
            share += (u[i] - u[i - 1]) * (here + before) / 2
        before = here
    regions[0] = math.sqrt(split), math.sqrt(share) / 2
    regions[1] = math.sqrt(whole), 0.0


@compiled
def squared_norm(A2: float, B2: float, e: float, drag: float) -> float:
    """The squared norm of [[A, B], [e/sqrt(drag), 0]]; inf where there is no drag."""
    if e == 0:
        return A2 + B2
    if drag == 0:
        return math.inf
    C2 = e * e / drag
    total = A2 + B2 + C2
    return (total + math.sqrt(max(total * total - 4 * B2 * C2, 0.0))) / 2
