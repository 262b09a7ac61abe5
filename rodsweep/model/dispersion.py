"""The dispersion relation of Sec. VI: the most amplified wave of an infinitely long rod.

A wave exp(i kappa u) with K = kappa^2 grows at the root w(K) of

    gamma3 c2 w^2 + [(c2 + gamma3) K + g nu] w + K^2 - F g K = 0.

Here g = nu + F c2. The largest growth rate is used as a start of the search for eigenvalues of the finite
rod, the wave number of this wave for the choice of the mesh. Both numbers are estimates only.
"""

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from .material.rod_material import LocalCoefficients, RodMaterial
from .rod import Rod

WAVE_NUMBER_SAMPLE_COUNT = 64
"""Number of samples of K = kappa^2, kappa: wave number, in geometric progression. A ratio of 1.15 suffices
for an estimate."""
SAMPLES_PER_INTERVAL = 33
"""Number of points between two neighbouring breaks of an arm's profile at which local waves are computed, if
the coefficients vary."""
MAX_CACHED_ARMS = 16
"""Maximum number of arms, and of materials, in the caches of this module."""
MIN_SQUARED_WAVE_NUMBER_RATIO = 1e-4
"""Ratio K/(F g) of the smallest sample of K = kappa^2, g = nu + F c2. Every wave with K > F g decays."""
SQUARED_WAVE_NUMBER_RATIOS: Array = MIN_SQUARED_WAVE_NUMBER_RATIO ** (
    1 - np.arange(WAVE_NUMBER_SAMPLE_COUNT) / WAVE_NUMBER_SAMPLE_COUNT
)
"""Ratios K/(F g) of all samples of K = kappa^2, g = nu + F c2, increasing, (WAVE_NUMBER_SAMPLE_COUNT,)."""


def largest_growth_and_wave_number(rod: Rod) -> tuple[float, float]:
    """Returns (growth rate in 1/tau2, wave number in 1/L) of the most amplified wave; (0, 0) if all waves
    decay. The wave travels on an infinitely long rod with the coefficients of the uniform `rod`. The function
    is not compiled, so that `rodsweep check` need not load numba."""
    F, nu, c2, gamma3 = rod.coefficients
    # The growth is positive only for K < F g, so without such K every wave decays; nan counts as none.
    if not F * rod.g > 0:
        return 0.0, 0.0
    rate, wave_number = _scaled_peak_growth_and_wave_number(F * rod.g, rod.g * nu, c2, gamma3)
    return float(rate), float(wave_number)


def growth_rate(rod: Rod, wave_number: float) -> float:
    """Growth rate, in 1/tau2, of the wave with `wave_number`, in 1/L, on an infinitely long rod with the
    coefficients of the uniform `rod`; 0 if the wave decays."""
    F, nu, c2, gamma3 = rod.coefficients
    K = np.float64(wave_number**2)
    return float(_growth_rates(K, F * rod.g, rod.g * nu, c2, gamma3))


class SampledArm(NamedTuple):
    """Midpoints of short intervals of u along an arm, and the local coefficients at the midpoints. points:
    midpoints, (points,); no midpoint is a break of the profile. interval_lengths: interval lengths,
    (points,). local_coefficients: coefficients at the midpoints."""

    points: Array
    interval_lengths: Array
    local_coefficients: LocalCoefficients


@lru_cache(maxsize=MAX_CACHED_ARMS)
def sampled_arm(rod: Rod) -> SampledArm:
    """Sample points of the arm `rod` and the local coefficients at these points, cached."""
    # Where the coefficients are constant a single sample is exact.
    points, weights = _interval_midpoints_and_lengths(
        rod.material, 1 if rod.material.is_piecewise_constant(rod.taper) else SAMPLES_PER_INTERVAL
    )
    return SampledArm(points, weights, rod.local_coefficients(points))


@lru_cache(maxsize=MAX_CACHED_ARMS)
def _interval_midpoints_and_lengths(material: RodMaterial, count: int) -> tuple[Array, Array]:
    """Returns (midpoints, lengths) of `count` equal parts of each interval between breaks of a profile,
    (points,) each."""
    # Midpoints avoid the breaks, at which the factors have two values.
    lengths = np.diff(material.breaks)
    fractions = (np.arange(count) + 0.5) / count
    points = (material.breaks[:-1, None] + lengths[:, None] * fractions).ravel()
    return points, np.repeat(lengths / count, count)


@lru_cache(maxsize=MAX_CACHED_ARMS)
def most_amplified_local_waves(rod: Rod) -> tuple[Array, Array]:
    """Returns (growth rates in 1/tau2, wave numbers in 1/L) of the most amplified wave at each point of
    `sampled_arm(rod)`, (points,) each. A local wave travels on an infinitely long uniform rod with the
    coefficients of the arm at the point. If all waves at a point decay, both numbers are 0."""
    return _growths_and_wave_numbers(rod.F, sampled_arm(rod).local_coefficients)


def largest_growth_at_ends(rod: Rod) -> float:
    """The larger growth rate, in 1/tau2, of the most amplified local waves at the two ends of an arm. At a
    thin tip the points of `sampled_arm` are too far apart to show this rate."""
    return float(_growths_and_wave_numbers(rod.F, local_coefficients_at_ends(rod))[0].max())


def local_coefficients_at_ends(rod: Rod) -> LocalCoefficients:
    """Local coefficients at the clamp and at the tip of an arm, each (2,)."""
    return rod.local_coefficients(np.nextafter([0.0, 1.0], [1.0, 0.0]))


def local_wave_numbers(w: Any, F: float, coefficients: LocalCoefficients) -> Array:
    """Bound (|sqrt z+| + |sqrt z-|)/2, in 1/L, of |q1| and |q2| in the four exponentials exp(+-q1 u),
    exp(+-q2 u) of a uniform rod with the local coefficients at the rate w; z+- = (q1 +- q2)^2. w: rate in
    1/tau2. The shapes of w and of the coefficients broadcast."""
    nu, c2, c3, gamma2, gamma3, g = coefficients
    shear, rotation = c2 * gamma2, c3 * gamma3
    w = np.asarray(w, complex)
    P = np.sqrt(w * (g * nu * gamma2 * c3 + shear * rotation * w))
    middle = (shear + rotation) * w - F * c3 * g
    bound: Array = (np.sqrt(np.abs(middle + 2 * P)) + np.sqrt(np.abs(middle - 2 * P))) / 2
    return bound


def fastest_growing_wave_numbers_at_ends(rod: Rod) -> Array:
    """Bounds of the wave numbers |q|, in 1/L, of the solutions exp(+-q u) at the two ends of an arm, (2,):
    `local_wave_numbers` at the largest growth rate of the local waves at each end; 0 at an end at which all
    local waves decay."""
    coefficients = local_coefficients_at_ends(rod)
    growth, _ = _growths_and_wave_numbers(rod.F, coefficients)
    return np.where(growth > 0, local_wave_numbers(growth, rod.F, coefficients), 0.0)


def _growths_and_wave_numbers(F: float, coefficients: LocalCoefficients) -> tuple[Array, Array]:
    """Returns (growth rates, wave numbers) of the most amplified local waves, at the points of
    `coefficients`, see `most_amplified_local_waves`. F: follower force."""
    nu, c2, c3, gamma2, gamma3, g = coefficients
    # A local rod has its own units: the formula needs bending compliance and drag scaled to 1.
    rate, wave_number = _scaled_peak_growth_and_wave_number(
        np.maximum(F * c3 * g, 0.0), g * nu, c2 / c3, gamma3 / gamma2
    )
    # Rates return to the unit tau2 of the base; the wave number already is in 1/L.
    return rate / (gamma2 * c3), wave_number


def expected_unstable_count(rod: Rod) -> float:
    """Estimate of the number of unstable modes of an arm: the integral over the arm of the largest wave
    number that grows by the local dispersion relation, divided by pi. For 14 arms with 4 to 132 unstable
    modes the estimate was 0.9 to 1.9 times the true number."""
    _, weights, coefficients = sampled_arm(rod)
    # Half waves of the shortest growing wave, counted along the arm.
    return float(weights @ np.sqrt(np.maximum(rod.F * coefficients.c3 * coefficients.g, 0.0))) / math.pi


def _scaled_peak_growth_and_wave_number(
    max_K: Any, damping_at_0: Any, c2: Any, gamma3: Any
) -> tuple[Any, Any]:
    """Returns (growth rate, wave number) of the most amplified wave for k3 = gamma2 = 1; the rate is 0 if
    every wave decays.

    max_K: F g >= 0, g = nu + F c2; waves with a larger K = kappa^2 decay. damping_at_0: g nu, negative only
    for a pulled rod (F < 0). c2, gamma3: shear compliance and rotational drag. All arguments are numbers or
    arrays of one shape; the results have this shape.
    """
    # The closed formula needs a damped limit K = 0; a strongly pulled rod may not have one.
    if not np.min(damping_at_0) > 0:
        return _sampled_growth_and_wave_number(
            *(np.asarray(x)[..., None] for x in (max_K, damping_at_0, c2, gamma3))
        )
    # At the largest w the derivative of the dispersion relation with respect to K is 0:
    # (c2 + gamma3) w + 2 K = F g. Without K the relation is quadratic in w. In units of `unit` no allowed
    # force overflows.
    drag_sum = c2 + gamma3
    with np.errstate(over="ignore"):
        unit = np.maximum(max_K, damping_at_0)
        relative_max_K = max_K / unit
        damping = damping_at_0 / unit
        damping = damping + np.sqrt(
            c2 * gamma3 * relative_max_K * relative_max_K
            + drag_sum * damping * relative_max_K
            + damping * damping
        )
        denominator = drag_sum * relative_max_K + 2 * damping
        # As a quotient with a sum of positive terms, the largest rate has no cancellation.
        return max_K * relative_max_K / denominator, np.sqrt(max_K * (damping / denominator))


def _sampled_growth_and_wave_number(
    max_K: Any, damping_at_0: Any, c2: Any, gamma3: Any
) -> tuple[Array, Array]:
    """`_scaled_peak_growth_and_wave_number` by comparison of WAVE_NUMBER_SAMPLE_COUNT wave numbers, used if g
    = nu + F c2 <= 0 at any point: under such a pull the growth rate, as a function of the wave number, may
    have its maximum at 0, or no maximum. Arguments: as there, with the shape (..., 1)."""
    rates = _growth_rates(max_K * SQUARED_WAVE_NUMBER_RATIOS, max_K, damping_at_0, c2, gamma3)
    max_rate = rates.max(axis=-1)
    fractions = SQUARED_WAVE_NUMBER_RATIOS[rates.argmax(axis=-1)]
    return max_rate, np.where(max_rate > 0, np.sqrt(max_K[..., 0] * fractions), 0.0)


def _growth_rates(K: Any, max_K: Any, damping_at_0: Any, c2: Any, gamma3: Any) -> Array:
    """Growth rates of the waves with K = kappa^2, by the dispersion relation of the module; 0 if the wave
    decays. All arguments broadcast: as in `_scaled_peak_growth_and_wave_number`."""
    product = c2 * gamma3
    # Both branches of each `where` are evaluated, also where they divide by 0.
    with np.errstate(all="ignore"):
        constant = K * (max_K - K)
        damping = (c2 + gamma3) * K + damping_at_0
        root_of_discriminant = np.sqrt(damping**2 + 4 * product * constant)
        # The positive root r of product r^2 + damping r = constant. Each of the two formulas is free of
        # cancellation for one sign of `damping`.
        rates_if_damped = np.where(product > 0, (root_of_discriminant - damping) / (2 * product), 0.0)
        rates = np.where(damping > 0, 2 * constant / (damping + root_of_discriminant), rates_if_damped)
    # Also turns nan into a wave that does not grow.
    return np.where(rates > 0, rates, 0.0)
