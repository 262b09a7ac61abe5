"""The dispersion relation of Sec. VI: the most amplified wave of an infinitely long rod.

A wave exp(i kappa u) with K = kappa^2 grows at the root w(K) of

    gamma3 c2 w^2 + [(c2 + gamma3) K + g nu] w + K^2 - F g K = 0.

The largest growth rate is used as a start of the search for eigenvalues of the finite rod, its wave number
for the choice of the mesh. Both numbers are estimates only.
"""

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from .material.build import Build, LocalCoefficients
from .rod import Rod

SAMPLE_COUNT = 64
"""Number of samples of K = kappa^2, with equal ratios of successive samples. A ratio of 1.15 suffices for an
estimate."""
SAMPLES_PER_INTERVAL = 33
"""Number of points between two neighbouring breaks of an arm's profile at which local waves are computed."""
CACHED_ARM_COUNT = 16
"""Maximum number of arms, and of builds, in the caches of this module."""
MIN_SQUARED_WAVE_NUMBER_RATIO = 1e-4
"""Ratio K/(F g) of the smallest sample of K = kappa^2. Every wave with K > F g decays."""
SQUARED_WAVE_NUMBER_RATIOS: Array = MIN_SQUARED_WAVE_NUMBER_RATIO ** (
    1 - np.arange(SAMPLE_COUNT) / SAMPLE_COUNT
)
"""Ratios K/(F g) of all samples of K = kappa^2, increasing, (SAMPLE_COUNT,)."""


def most_amplified_wave(rod: Rod) -> tuple[float, float]:
    """Returns (growth rate in 1/tau2, wave number in 1/L) of the most amplified wave; (0, 0) if all waves
    decay.

    The wave travels on an infinitely long rod with the coefficients of the uniform `rod`. The function is not
    compiled, so that `rodsweep check` need not load numba.
    """
    F, nu, c2, gamma3 = rod.coefficients
    top = F * rod.g
    if top <= 0:
        return 0.0, 0.0
    K, rates = _growth_rates(top, rod.g * nu, c2, gamma3)
    best = int(np.argmax(rates))
    return (float(rates[best]), float(np.sqrt(K[best]))) if rates[best] > 0 else (0.0, 0.0)


class SampledArm(NamedTuple):
    """Midpoints of short intervals of u along an arm, and the local coefficients at the midpoints.

    points: midpoints, (points,); no midpoint is a break of the profile. weights: interval lengths, (points,).
    local: coefficients at the midpoints.
    """

    points: Array
    weights: Array
    local: LocalCoefficients


@lru_cache(maxsize=CACHED_ARM_COUNT)
def sampled_arm(rod: Rod) -> SampledArm:
    """Sample points of the arm `rod` and the local coefficients at these points, cached."""
    points, weights = _interval_midpoints(rod.build)
    return SampledArm(points, weights, rod.local_coefficients(points))


@lru_cache(maxsize=CACHED_ARM_COUNT)
def _interval_midpoints(build: Build) -> tuple[Array, Array]:
    """Returns (midpoints, lengths) of short intervals of u between the breaks of a profile, (points,)
    each.
    """
    lengths = np.diff(build.breaks)
    inside = (np.arange(SAMPLES_PER_INTERVAL) + 0.5) / SAMPLES_PER_INTERVAL
    points = (build.breaks[:-1, None] + lengths[:, None] * inside).ravel()
    return points, np.repeat(lengths / SAMPLES_PER_INTERVAL, SAMPLES_PER_INTERVAL)


@lru_cache(maxsize=CACHED_ARM_COUNT)
def most_amplified_local_waves(rod: Rod) -> tuple[Array, Array]:
    """Returns (growth rates, wave numbers) of the most amplified wave at each point of `sampled_arm(rod)`,
    (points,) each.

    A local wave travels on an infinitely long uniform rod with the coefficients of the arm at the point. If
    all waves at a point decay, both numbers are 0.
    """
    nu, c2, c3, gamma2, gamma3, g = sampled_arm(rod).local
    top = np.maximum(rod.F * c3 * g, 0.0)
    _, rates = _growth_rates(*(x[:, None] for x in (top, g * nu, c2 / c3, gamma3 / gamma2)))
    largest = rates.max(axis=-1)
    wave = np.where(largest > 0, np.sqrt(top * SQUARED_WAVE_NUMBER_RATIOS[rates.argmax(axis=-1)]), 0.0)
    return largest / (gamma2 * c3), wave


def expected_unstable_count(rod: Rod) -> float:
    """Estimate of the number of unstable modes of an arm: the integral over the arm of the largest wave
    number that grows by the local dispersion relation, divided by pi.

    For 14 arms with 4 to 132 unstable modes the estimate was 0.9 to 1.9 times the true number.
    """
    _, weights, local = sampled_arm(rod)
    return float(weights @ np.sqrt(np.maximum(rod.F * local.c3 * local.g, 0.0))) / math.pi


def _growth_rates(top: Any, relaxation: Any, c2: Any, gamma3: Any) -> tuple[Array, Array]:
    """Returns (K, growth rates) of the sampled waves, (..., SAMPLE_COUNT) each, for k3 = gamma2 = 1.

    A decaying wave has the growth rate 0. top: F g. relaxation: g nu. c2, gamma3: shear compliance and
    rotational drag. All arguments are numbers, or arrays (n, 1) for n rods.
    """
    square = c2 * gamma3
    K = top * SQUARED_WAVE_NUMBER_RATIOS
    with np.errstate(all="ignore"):
        # Waves with K < F g grow.
        drive = K * (top - K)
        linear = (c2 + gamma3) * K + relaxation
        spread = np.sqrt(linear**2 + 4 * square * drive)
        # The positive root r of square r^2 + linear r = drive. Each of the two formulas is free of
        # cancellation for one sign of `linear`.
        rates = 2 * drive / (linear + spread)
        if not (linear > 0).all():
            slow = np.where(square > 0, (spread - linear) / (2 * square), 0.0)
            rates = np.where(linear > 0, rates, slow)
    return K, np.where(rates > 0, rates, 0.0)
