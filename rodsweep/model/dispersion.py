"""The dispersion relation of Sec. VI: the most amplified wave of an infinitely long rod.

A wave exp(i kappa u) with K = kappa^2 grows at the root w(K) of

    gamma3 c2 w^2 + [(c2 + gamma3) K + g nu] w + K^2 - F g K = 0.

Its largest growth rate is used as a start of the search for eigenvalues of the finite rod, its wave number
for the choice of the mesh. Both numbers are estimates only.
"""

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from .material.build import Build, LocalCoefficients
from .rod import Rod

SAMPLES_PER_INTERVAL = 33
"""Number of points between two neighbouring breaks of an arm's profile at which local waves are computed."""
CACHED_ARM_COUNT = 16
"""Maximum number of arms, and of builds, in the caches of this module."""


def most_amplified_wave(rod: Rod) -> tuple[float, float]:
    """Returns (growth rate in 1/tau2, wave number in 1/L) of the most amplified wave; (0, 0) if all waves
    decay.

    The wave travels on an infinitely long rod with the coefficients of the uniform `rod`. The function is not
    compiled, so that `rodsweep check` need not load numba.
    """
    F, nu, c2, gamma3 = rod.coefficients
    if not F * rod.g > 0:
        return 0.0, 0.0
    rate, wave_number = _largest_growth(F * rod.g, rod.g * nu, c2, gamma3)
    return float(rate), float(wave_number)


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
    rate, wave_number = _largest_growth(top, g * nu, c2 / c3, gamma3 / gamma2)
    return rate / (gamma2 * c3), wave_number


def expected_unstable_count(rod: Rod) -> float:
    """Estimate of the number of unstable modes of an arm: the integral over the arm of the largest wave
    number that grows by the local dispersion relation, divided by pi.

    For 14 arms with 4 to 132 unstable modes the estimate was 0.9 to 1.9 times the true number.
    """
    _, weights, local = sampled_arm(rod)
    return float(weights @ np.sqrt(np.maximum(rod.F * local.c3 * local.g, 0.0))) / math.pi


def _largest_growth(top: Any, relaxation: Any, c2: Any, gamma3: Any) -> tuple[Any, Any]:
    """Returns (growth rate, wave number) of the most amplified wave for k3 = gamma2 = 1; both are 0 if top is
    0, or if there is no largest growth rate.

    top: F g >= 0. relaxation: g nu, negative only for a pulled rod (F < 0). c2, gamma3: shear compliance and
    rotational drag. All arguments are numbers or arrays of one shape; the results have this shape.
    """
    # At the largest w the derivative of the dispersion relation with respect to K is 0:
    # (c2 + gamma3) w + 2 K = F g. Without K the relation is quadratic in w.
    total = c2 + gamma3
    product = c2 * gamma3
    with np.errstate(invalid="ignore", divide="ignore"):
        root = np.sqrt(product * top**2 + total * relaxation * top + relaxation**2)
        rate = top**2 / (total * top + 2 * relaxation + 2 * root)
        wave_number = np.sqrt(np.sqrt(rate * (product * rate + relaxation)))
        if np.min(relaxation) > 0:
            return rate, wave_number
        # Without a maximum at K > 0, the longest wave grows fastest: on the rod, a quarter of a wave.
        inside = (relaxation > 0) | (product * top + total * relaxation > 0)
        K = np.minimum((np.pi / 2) ** 2, top)
        linear = total * K + relaxation
        spread = np.sqrt(linear**2 + 4 * product * K * (top - K))
        longest = np.where((product > 0) & (linear < 0), (spread - linear) / (2 * product), 0.0)
    rate = np.where(inside, rate, longest)
    return rate, np.where(rate > 0, np.where(inside, wave_number, np.sqrt(K)), 0.0)
