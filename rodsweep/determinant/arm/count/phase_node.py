"""Nodes on the contour of a count, each with a tangent of log D and the radius in which the tangent is valid.

The phase of D between two nodes follows from the tangents log D(w) + L (v - w), L = D'/D, at both nodes, if
the error of each tangent is below pi/2 at a common point between the nodes.

Outside the hull of the spectrum this condition is proved from D'/D alone. D is entire of order 1/2, so that D
= prod (1 - w/w_n), and with the distance d of w from the hull and the unit normal n towards w

    Re(n L) = sum <n, w - w_n>/|w - w_n|^2 >= d S,   S = sum 1/|w - w_n|^2,
    |log D(v) - log D(w) - L (v - w)| <= S r^2/2/(1 - r/d)^2,   r = |v - w|.

Inside the hull, f(v) = D(v) exp(-h(v)) has f'(w) = 0 with

    h(v) = L (v - w)   or   h(v) = Phi(v) - Phi(w) + (L - Phi'(w)) (v - w),

Phi the dominant wave (`rodsweep.determinant.arm.count.dominant_wave`). Cauchy's estimate with the maximum of
|f| on a circle bounds the change of f. The maximum is estimated from `CONTOUR_SETTINGS.circle_point_count`
points and a safety factor. Inside the hull the count is therefore an estimate; the rounding errors of D and
the errors of its elements are estimates everywhere."""

import math
from typing import NamedTuple

from ....arrays import Complex
from ....model.compiled.compilation import compiled
from ...exponents import EXPONENT_SETTINGS
from ...value import DeterminantValue
from ..determinant import PropagatorsUpToW
from ..hull.region import EigenvalueHull, hull_distance_and_normal
from ..local_waves import ExponentSamples
from ..value import determinant_from_propagators, log_modulus_from_propagators
from .dominant_wave import dominant_exponent_slope, dominant_wave_exponent
from .settings import CONTOUR_SETTINGS


class PhaseNode(NamedTuple):
    """A point w on the contour of a count, with a tangent h of log D.

    phase_factor, log_derivative: D/|D| and D'/D, with the known eigenvalues divided out of D.
    dominant_exponent_and_slope: (Phi, dPhi/dw) of the dominant wave exp(Phi) of D if h contains Phi, else (0,
    0). valid_radius: distance from w within which the error of h is below pi/2. circle_radius: radius of the
    circle from which `valid_radius` follows; 0 if the radius follows from the distance to the hull of the
    spectrum.
    """

    w: complex
    phase_factor: complex
    log_derivative: complex
    dominant_exponent_and_slope: tuple[complex, complex]
    valid_radius: float
    circle_radius: float


@compiled
def linearised_log_determinant(node: PhaseNode, v: complex, samples: ExponentSamples) -> complex:
    """The tangent h(v) of log D at `node`, without the constant log D(w), at a point v near w (see the module
    docstring). samples: the arm's coefficients at quadrature points, for the dominant wave."""
    Phi, slope = node.dominant_exponent_and_slope
    linear_change = (node.log_derivative - slope) * (v - node.w)
    return linear_change + dominant_wave_exponent(v, samples) - Phi if Phi != 0 else linear_change


@compiled
def phase_node(
    w: complex,
    known_w: Complex,
    trial_radii: tuple[float, float],
    hull: EigenvalueHull,
    arm: tuple[ExponentSamples, PropagatorsUpToW],
) -> PhaseNode:
    """The node at w, inside or outside the hull. known_w: eigenvalues to divide out of D, (n,). trial_radii:
    (distance over which an exponent of D changes by 1, largest radius of a circle). arm: samples of the arm,
    and the propagators for |v| <= W on the largest circle about w."""
    value = determinant_from_propagators(w, arm[1][0], arm[1][1])
    if not abs(value.D) > CONTOUR_SETTINGS.rounding_safety_factor * value.rounding_error:
        # The sign of D is rounding here. A valid radius of 0 makes the traversal give up at this node.
        return PhaseNode(w, value.D, 0j, (0j, 0j), 0.0, 0.0)
    direction = value.D / abs(value.D)
    L = value.D_w / value.D
    for n in range(len(known_w)):
        difference = w - known_w[n]
        # Multiplication by the conjugate of a unit vector divides by it.
        direction *= difference.conjugate() / abs(difference)
        L -= 1 / difference
    distance, normal = hull_distance_and_normal(complex(w.real, abs(w.imag)), hull.a, hull.c)
    reach = 0.0
    if distance > 0:
        # S is positive in exact arithmetic, but rounding of L can exceed it far away from all eigenvalues.
        S = max((normal * L).real, 0.0) / distance
        # The r at which the bound S r^2/2/(1 - r/d)^2 of the module docstring equals the allowed error.
        reach = 1 / (1 / distance + math.sqrt(S / (2 * CONTOUR_SETTINGS.max_tangent_phase_error)))
    node = PhaseNode(w, direction, L, (0j, 0j), reach, 0.0)
    # The radius from the hull is proved and needs no further value of D, so it is used if it is long enough.
    return (
        node if reach > trial_radii[0] else _node_inside_spectrum_hull(node, value, known_w, trial_radii, arm)
    )


@compiled
def _node_inside_spectrum_hull(
    node: PhaseNode,
    value: DeterminantValue,
    known_w: Complex,
    trial: tuple[float, float],
    arm: tuple[ExponentSamples, PropagatorsUpToW],
) -> PhaseNode:
    """The node at w inside the hull of the spectrum, with the circle that gives the largest valid radius.
    value: D at the node. known_w: known eigenvalues, divided out of D. trial: (distance over which an
    exponent of D changes by about 1, largest radius of a circle). arm: (samples of the arm's coefficients,
    propagators for |w| <= W)."""
    w = node.w
    samples, (W, propagators) = arm
    slope = max(abs(node.log_derivative), EXPONENT_SETTINGS.min_divisor)
    unit = min(trial[0], CONTOUR_SETTINGS.max_log_D_change_over_radius / slope)
    min_rho = CONTOUR_SETTINGS.min_circle_radius_over_w_scale * unit
    rounding = CONTOUR_SETTINGS.rounding_safety_factor * value.rounding_error
    excess = CONTOUR_SETTINGS.max_D_change_ratio - rounding / abs(value.D)
    log_D = math.log(abs(value.D)) + value.log_scale - _log_of_distance_product(w, known_w)
    best, rho = node, max(trial[1], min_rho)
    while rho >= min_rho:
        wave = _dominant_exponent_and_slope(w, rho, samples)
        tried = PhaseNode(w, node.phase_factor, node.log_derivative, wave, 0.0, rho)
        # Smaller circles give at most this valid radius.
        target = max(best.valid_radius, _valid_radius(rho / 2, CONTOUR_SETTINGS.circle_safety_factor, excess))
        reach, log_max = math.inf, -math.inf  # log_max: log of the largest |f| at points of the circle
        for direction in CONTOUR_SETTINGS.circle_directions:
            v = w + rho * direction
            log_f = log_modulus_from_propagators(v, W, propagators) - _log_of_distance_product(v, known_w)
            log_max = max(log_max, log_f - linearised_log_determinant(tried, v, samples).real)
            growth = math.exp(min(log_max - log_D, EXPONENT_SETTINGS.max_exponent))
            reach = _valid_radius(rho, CONTOUR_SETTINGS.circle_safety_factor * growth, excess)
            min_reach = CONTOUR_SETTINGS.min_valid_over_circle_radius * rho if rho / 2 >= min_rho else 0.0
            if reach <= best.valid_radius or reach < min_reach:
                reach = 0.0
                break
        if reach > best.valid_radius:
            best = PhaseNode(w, node.phase_factor, node.log_derivative, wave, reach, rho)
        elif best.circle_radius > 0:
            # The valid radius has passed its maximum: smaller circles only make it smaller.
            break
        if best.circle_radius > 0 and best.valid_radius >= target:
            break
        rho /= 2
    return best


@compiled
def _dominant_exponent_and_slope(w: complex, rho: float, samples: ExponentSamples) -> tuple[complex, complex]:
    """(Phi, dPhi/dw) of the dominant wave at w if the radius rho of the circle about w is at most
    `max_dominant_wave_radius_over_im_w` Im w, else (0, 0)."""
    if rho <= CONTOUR_SETTINGS.max_dominant_wave_radius_over_im_w * w.imag:
        return dominant_wave_exponent(w, samples), dominant_exponent_slope(w, samples)
    return 0j, 0j


@compiled
def _valid_radius(rho: float, M: float, excess: float) -> float:
    """Distance from w within which f changes by less than `excess` |D(w)|, if |f| <= M |D(w)| on the circle
    of radius rho about w. f(v) = D(v) exp(-h(v)), with f'(w) = 0, see the module docstring."""
    # As f'(w) = 0, Cauchy's estimate is |f(v) - f(w)| <= M |D| r^2/(rho (rho - r)), solved here for r.
    q = excess / M
    return rho * (math.sqrt(q * q + 4 * q) - q) / 2 if q > 0 else 0.0


@compiled
def _log_of_distance_product(v: complex, known_w: Complex) -> float:
    """log prod |v - w_n| over the known eigenvalues w_n, (n,)."""
    total = 0.0
    for n in range(len(known_w)):
        total += math.log(max(abs(v - known_w[n]), EXPONENT_SETTINGS.min_divisor))
    return total
