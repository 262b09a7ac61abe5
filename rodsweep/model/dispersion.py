"""The dispersion relation of Sec. VI: the most amplified wave of an infinitely long rod.

A wave exp(i kappa u) with K = kappa^2 grows at the root w(K) of

    gamma3 c2 w^2 + [(c2 + gamma3) K + g nu] w + K^2 - F g K = 0.

The largest growth rate suggests where to search for eigenvalues of the finite rod; the wave number suggests
the mesh. Neither claims that an eigenvalue of the finite rod is near.
"""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from .material.build import Build, LocalCoefficients
from .rod import Rod

SAMPLE_COUNT = 64
"""Number of samples of K in geometric progression; the ratio 1.15 is fine enough for an estimate."""
SAMPLES_PER_INTERVAL = 33
"""Number of points, per interval of u on which coefficients are smooth, at which local waves are evaluated.
"""
CACHED_ARM_COUNT = 16
"""Number of arms whose samples are cached."""
MIN_K_FRACTION = 1e-4
"""Smallest sample of K, in units of F g. Every wave with K > F g decays."""
K_FRACTIONS: Array = MIN_K_FRACTION ** (1 - np.arange(SAMPLE_COUNT) / SAMPLE_COUNT)
"""Samples of K = kappa^2, in units of F g, (SAMPLE_COUNT,)."""


def most_amplified_wave(rod: Rod) -> tuple[float, float]:
    """(growth rate in 1/tau2, wave number in 1/L) of the most amplified wave; (0, 0) if all waves decay.

    Not compiled, so that `check` need not load numba.
    """
    F, nu, c2, gamma3 = rod.coefficients
    top = F * rod.g
    if top <= 0:
        return 0.0, 0.0
    K, rates = _growth_rates(top, rod.g * nu, c2, gamma3)
    best = int(np.argmax(rates))
    return (float(rates[best]), float(np.sqrt(K[best]))) if rates[best] > 0 else (0.0, 0.0)


class SampledArm(NamedTuple):
    """Sample points of an arm in u, their quadrature weights (lengths), and the local coefficients.

    points, weights: (points,).
    """

    points: Array
    weights: Array
    local: LocalCoefficients


@lru_cache(maxsize=CACHED_ARM_COUNT)
def sampled(rod: Rod) -> SampledArm:
    """Sample points, weights and local coefficients of an arm; cached."""
    points, weights = _points_of(rod.build)
    return SampledArm(points, weights, rod.local(points))


@lru_cache(maxsize=CACHED_ARM_COUNT)
def _points_of(build: Build) -> tuple[Array, Array]:
    """`points` and `weights` of `SampledArm` for the arms of a build."""
    lengths = np.diff(build.breaks)
    inside = (np.arange(SAMPLES_PER_INTERVAL) + 0.5) / SAMPLES_PER_INTERVAL
    points = (build.breaks[:-1, None] + lengths[:, None] * inside).ravel()
    return points, np.repeat(lengths / SAMPLES_PER_INTERVAL, SAMPLES_PER_INTERVAL)


@lru_cache(maxsize=CACHED_ARM_COUNT)
def local_growth(rod: Rod) -> tuple[Array, Array]:
    """Growth rates and wave numbers of the most amplified waves at the samples u of an arm, both (points,).

    Each point is treated as a uniform rod with the local coefficients.
    """
    nu, c2, c3, gamma2, gamma3, g = sampled(rod).local
    top = np.maximum(rod.F * c3 * g, 0.0)
    _, rates = _growth_rates(*(x[:, None] for x in (top, g * nu, c2 / c3, gamma3 / gamma2)))
    largest = rates.max(axis=-1)
    wave = np.where(largest > 0, np.sqrt(top * K_FRACTIONS[rates.argmax(axis=-1)]), 0.0)
    return largest / (gamma2 * c3), wave


def _growth_rates(top: Any, relaxation: Any, c2: Any, gamma3: Any) -> tuple[Array, Array]:
    """(K, growth rates) of the sampled waves, (..., SAMPLE_COUNT), at k3 = gamma2 = 1; 0: decaying.

    top: F g. relaxation: g nu. All arguments are numbers, or arrays (n, 1) for n rods.
    """
    square = c2 * gamma3
    K = top * K_FRACTIONS
    with np.errstate(all="ignore"):
        # Growth rates as functions of K = q^2: waves with K < F g grow.
        drive = K * (top - K)
        linear = (c2 + gamma3) * K + relaxation
        spread = np.sqrt(linear**2 + 4 * square * drive)
        # The root of square r^2 + linear r = drive; each formula is free of cancellation for one sign of
        # `linear`.
        rates = 2 * drive / (linear + spread)
        if not (linear > 0).all():
            slow = np.where(square > 0, (spread - linear) / (2 * square), 0.0)
            rates = np.where(linear > 0, rates, slow)
    return K, np.where(rates > 0, rates, 0.0)
