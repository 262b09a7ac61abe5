"""The dispersion relation of Sec. VI: the wave that an endless rod would amplify most.

A wave exp(i kappa u) with K = kappa^2 grows at the root w(K) of

    gamma3 c2 w^2 + [(c2 + gamma3) K + g nu] w + K^2 - F g K = 0.

No eigenvalue of the finite rod is claimed to be near; its largest growth rate and the wave number
tell where to look for eigenvalues and how fine a mesh will be needed.
"""

import math

from .compilation import compiled
from .rod import Rod

SAMPLES = 64
LOWEST = 1e-4
"""K is sampled from LOWEST F g to F g in equal ratios; the answer need not be sharper."""


def most_amplified_wave(rod: Rod) -> tuple[float, float]:
    """(growth rate in 1/tau2, wave number in 1/L) of the most amplified wave; (0, 0) if all decay."""
    F, nu, c2, gamma3 = rod.coefficients
    return _peak(F * rod.g, c2 + gamma3, rod.g * nu, c2 * gamma3)


@compiled
def _peak(top: float, drag: float, stiffness: float, square: float) -> tuple[float, float]:
    best, at = 0.0, 0.0
    if top <= 0:
        return best, at
    for i in range(SAMPLES):
        K = top * LOWEST ** (1 - i / SAMPLES)
        drive = K * (top - K)
        linear = drag * K + stiffness
        spread = math.sqrt(linear * linear + 4 * square * drive)
        if linear > 0:
            rate = 2 * drive / (linear + spread)
        elif square > 0:
            rate = (spread - linear) / (2 * square)
        else:
            rate = 0.0
        if rate > best:
            best, at = rate, math.sqrt(K)
    return best, at
