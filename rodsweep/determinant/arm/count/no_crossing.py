"""Whether no unknown eigenvalue lies on a vertical line, for any arm of an interval of a parameter p.

If all eigenvalues right of the line are known at one arm of the interval, and no unknown eigenvalue lies on
the line for any arm, then all eigenvalues right of the line are known at every arm. The upper half of the
line inside the hull of the spectrum suffices, because eigenvalues come in conjugate pairs.

Discs about nodes w0 cover the line. For each disc, the known eigenvalues w_n(p) near it are divided out:

    f(v, p) = D(v, p)/prod (v - w_n(p)) exp(-h(v, p)),

with h as in `rodsweep.determinant.arm.count.phase_node`, but with Phi(v, p) of each arm. On the circle, f is
compared with f(w0, q), q: p of the middle arm. If |f(v, p) - f(w0, q)| < |f(w0, q)|, f has no zero in the
disc, by the maximum principle. This is an estimate: f is evaluated at `CONTOUR_SETTINGS.circle_point_count`
points of the circle and at a few arms, with one safety factor for values between the points and one for the
arms between these arms."""

import cmath
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array, Complex, list_of
from ....model.compiled.compilation import compiled
from ....model.rod import Rod
from ..arm_family import ArmFamily
from ..arm_family_values import W_and_propagators_at
from ..completeness import is_real_or_conjugate_known
from ..determinant import ArmDeterminant, coefficient_samples, elements_for
from ..elements.propagators import element_propagators
from ..hull.region import EigenvalueHull, PathHulls
from ..local_waves import ExponentSamples, mean_wave_number_and_w_scale
from ..value import determinant_from_propagators, scaled_determinant_from_propagators
from .dominant_wave import dominant_exponent_slope, dominant_wave_exponent
from .settings import CONTOUR_SETTINGS, NO_CROSSING_SETTINGS


class SampledArmsOfInterval(NamedTuple):
    """Some arms of an interval: the middle arm, then the arms at both ends, then further arms.

    known_eigenvalues, known_errors: m eigenvalues followed through the n arms, and their errors, (n, m) each.
    squared_exponent_coefficients, quadrature_weights: as in `ExponentSamples`, (n, 4, points) and (points,).
    largest_w, propagators: W, and the propagators of the arms for |w| <= W, (n, elements, terms,
    PROPAGATOR_LENGTH).
    """

    known_eigenvalues: Complex
    known_errors: Array
    squared_exponent_coefficients: Array
    quadrature_weights: Array
    largest_w: float
    propagators: Array


class LineNode(NamedTuple):
    """The node w0 of a disc, with values of the middle arm. w: w0. D: D(w0) exp(-S), S = `log_scale`.
    log_derivative: D'/D, with the eigenvalues divided out. divided_out_indices: indices of the known
    eigenvalues that are divided out, (k,). dominant_exponent_and_slope: (Phi, dPhi/dw), Phi: exponent of the
    dominant wave, if the factor exp(h) that is divided out of D contains this wave; else (0, 0)."""

    w: complex
    D: complex
    log_scale: float
    log_derivative: complex
    divided_out_indices: NDArray[np.int64]
    dominant_exponent_and_slope: tuple[complex, complex]


def sampled_point_indices(first_index: int, last_index: int) -> list[int]:
    """Indices of `NO_CROSSING_SETTINGS.arm_count` of the points `first_index` to `last_index`, at whose arms
    D is evaluated: the middle point, both ends, and further points, in this order."""
    step_count = NO_CROSSING_SETTINGS.arm_count - 1
    further_indices = [
        first_index + (last_index - first_index) * k // step_count for k in range(1, step_count)
    ]
    middle = further_indices.pop(step_count // 2 - 1)
    # The middle comes first because all other arms are compared with it.
    return [middle, first_index, last_index, *further_indices]


def proves_no_crossing_of_arms(
    line: float,
    rods: list[Rod],
    p: Array,
    eigenvalues_and_errors: tuple[Complex, Array],
    family: ArmFamily,
    hulls: PathHulls,
) -> bool:
    """Whether no unknown eigenvalue lies on the line Re w = `line` for any arm of an interval.

    rods: arms of the interval in the order of `sampled_point_indices`; p: their path variables, (n,).
    eigenvalues_and_errors: m known eigenvalues, followed through the n arms, and their errors, (n, m) each.
    family, hulls: propagators and hulls of all arms of the path.
    """
    w, error = eigenvalues_and_errors
    overlaps = (hulls.p[:-1] <= p.max()) & (hulls.p[1:] >= p.min())
    intervals = zip(list_of(hulls.a[overlaps]), list_of(hulls.c[overlaps]), strict=True)
    # Largest |Im w| right of the line in the hulls of all arms.
    top = max(EigenvalueHull(a, c).box(max(-line, 0.0))[1] for a, c in intervals)
    # The upper half of the line suffices only if D stays real after the division by known eigenvalues.
    if not math.isfinite(top) or not all(is_real_or_conjugate_known(w_of_arm).all() for w_of_arm in w):
        return False
    samples = [ArmDeterminant(rod).exponent_samples_at_gauss_points for rod in rods]
    squares = np.array([exponent_samples.squared_exponent_coefficients for exponent_samples in samples])
    propagators = [W_and_propagators_at(family, p_of_arm)[1] for p_of_arm in list_of(p)]
    weights = samples[0].quadrature_weights
    arms = SampledArmsOfInterval(w, error, squares, weights, family.largest_w, np.array(propagators))
    scale = mean_wave_number_and_w_scale(complex(line, 0.0), samples[0])[1]
    first_radius = CONTOUR_SETTINGS.first_circle_radius_over_w_scale * scale
    min_radius = NO_CROSSING_SETTINGS.min_radius_over_w_scale * scale
    height, radius = covered_height(line, 0.0, top, (first_radius, min_radius), arms)
    # The family's propagators cost nothing here, but end at its W; arms with a higher line need others.
    if height < top and radius > 0:
        try:
            W = NO_CROSSING_SETTINGS.W_over_largest_w * abs(complex(line, top))
            elements = elements_for(rods, coefficient_samples(rods), W)
            forces = [rod.F for rod in rods]
            larger = element_propagators(forces, elements.local_coefficients, elements.lengths, W)
        except FloatingPointError:
            return False
        arms = arms._replace(largest_w=W, propagators=larger)
        height, _ = covered_height(line, height, top, (radius, min_radius), arms)
    return height >= top


@compiled
def covered_height(
    line: float, start: float, top: float, radii: tuple[float, float], arms: SampledArmsOfInterval
) -> tuple[float, float]:
    """Returns (height, radius). height: no unknown eigenvalue lies on the line between Im w = `start` and
    `height`, at any arm; at least `top` if discs cover the line up to `top`. radius: radius of the next disc;
    0 if a disc failed. radii: radius of the first disc, and radius below which a disc fails."""
    height = start
    radius, smallest = radii
    while height < top:
        max_valid_radius = (arms.largest_w - abs(complex(line, height))) / 2
        # Without the second limit, ever smaller discs would approach the largest |w| and never reach it.
        if max_valid_radius < max(NO_CROSSING_SETTINGS.min_radius_fraction_inside_W * radius, smallest):
            return height, radius
        radius = min(radius, max_valid_radius)
        w0 = complex(
            line, 0.0 if height == 0 else height + NO_CROSSING_SETTINGS.covered_length_over_radius * radius
        )
        if _is_zero_free(w0, radius, arms):
            height = w0.imag + NO_CROSSING_SETTINGS.covered_length_over_radius * radius
            radius *= NO_CROSSING_SETTINGS.radius_growth_factor
        else:
            radius /= NO_CROSSING_SETTINGS.radius_divisor_after_failure
            if not radius > smallest:
                return height, 0.0
    return height, radius


@compiled
def _is_zero_free(w0: complex, radius: float, arms: SampledArmsOfInterval) -> bool:
    """Whether the disc about w0 contains no unknown eigenvalue of any arm of the interval, by the estimate of
    the module docstring."""
    value = determinant_from_propagators(w0, arms.largest_w, arms.propagators[0])
    if not abs(value.D) > CONTOUR_SETTINGS.rounding_safety_factor * value.rounding_error:
        return False
    divided_out_indices = np.flatnonzero(
        np.abs(arms.known_eigenvalues[0] - w0)
        < NO_CROSSING_SETTINGS.max_divided_out_distance_over_radius * radius
    )
    L = value.D_w / value.D
    for n in divided_out_indices:
        if _is_too_close_to_divide(w0, arms.known_eigenvalues[0, n], arms.known_errors[0, n]):
            return False
        L -= 1 / (w0 - arms.known_eigenvalues[0, n])
    wave = (0j, 0j)
    if radius <= CONTOUR_SETTINGS.max_dominant_wave_radius_over_im_w * w0.imag:
        samples = ExponentSamples(arms.squared_exponent_coefficients[0], arms.quadrature_weights)
        wave = (dominant_wave_exponent(w0, samples), dominant_exponent_slope(w0, samples))
    node = LineNode(w0, value.D, value.log_scale, L, divided_out_indices, wave)
    number = len(arms.known_eigenvalues)
    is_free = True
    for k in range(1, number + 1):  # the ends before the middle arm, because f changes most at the ends
        is_free = is_free and _has_small_D_change(node, radius, k % number, arms)
    return is_free


@compiled
def _is_too_close_to_divide(v: complex, w: complex, error: float) -> bool:
    """Whether v is too close to the known eigenvalue w for an accurate D(v)/(v - w). error: error of w."""
    return not abs(v - w) > max(
        NO_CROSSING_SETTINGS.min_known_distance_over_w * abs(v),
        NO_CROSSING_SETTINGS.min_known_distance_over_error * error,
    )


@compiled
def _has_small_D_change(node: LineNode, radius: float, arm: int, arms: SampledArmsOfInterval) -> bool:
    """Whether |f(v, p)/f(w0, q) - 1| <= `NO_CROSSING_SETTINGS.max_D_change_ratio` at the points v of the
    circle, for arm number `arm` of `arms`; False if a point is too close to a known eigenvalue. f: see the
    module docstring. radius: radius of the circle about w0."""
    samples = ExponentSamples(arms.squared_exponent_coefficients[arm], arms.quadrature_weights)
    growth = 0.0
    if node.dominant_exponent_and_slope[0] == 0:
        # Phi has branch points on the real axis. Here only its change from arm to arm is used, off the axis.
        point_above = complex(node.w.real, radius / CONTOUR_SETTINGS.max_dominant_wave_radius_over_im_w)
        middle_exponent = dominant_wave_exponent(
            point_above, ExponentSamples(arms.squared_exponent_coefficients[0], arms.quadrature_weights)
        )
        growth = (dominant_wave_exponent(point_above, samples) - middle_exponent).real
    for direction in CONTOUR_SETTINGS.circle_directions:
        v = node.w + radius * direction
        D, S = scaled_determinant_from_propagators(v, arms.largest_w, arms.propagators[arm])
        h = (node.log_derivative - node.dominant_exponent_and_slope[1]) * (v - node.w) + growth
        if node.dominant_exponent_and_slope[0] != 0:
            h += dominant_wave_exponent(v, samples) - node.dominant_exponent_and_slope[0]
        # The logarithms are added before exp: each exponential alone may overflow.
        ratio = D / node.D * cmath.exp(S - node.log_scale - h)
        for n in node.divided_out_indices:
            if _is_too_close_to_divide(v, arms.known_eigenvalues[arm, n], arms.known_errors[arm, n]):
                return False
            ratio *= (node.w - arms.known_eigenvalues[0, n]) / (v - arms.known_eigenvalues[arm, n])
        if not abs(ratio - 1) <= NO_CROSSING_SETTINGS.max_D_change_ratio:
            return False
    return True
