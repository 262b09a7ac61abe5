"""The dispersion relation of Sec. VI: the wave that an endless rod would amplify most.

A wave exp(i kappa u) with K = kappa^2 grows at the root w(K) of

    gamma3 c2 w^2 + [(c2 + gamma3) K + g nu] w + K^2 - F g K = 0.

No eigenvalue of the finite rod is claimed to be near; its largest growth rate and the wave number
tell where to look for eigenvalues and how fine a mesh will be needed.
"""

import numpy as np

from .rod import Rod

SAMPLES = 64
LOWEST = 1e-4
"""K is sampled from LOWEST F g to F g in equal ratios; the answer need not be sharper."""


def most_amplified_wave(rod: Rod) -> tuple[float, float]:
    """(growth rate in 1/tau2, wave number in 1/L) of the most amplified wave; (0, 0) if all decay.

    Not compiled: `check` needs it, and would load numba for nothing else.
    """
    F, nu, c2, gamma3 = rod.coefficients
    top, square = F * rod.g, c2 * gamma3
    if top <= 0:
        return 0.0, 0.0
    K = top * LOWEST ** (1 - np.arange(SAMPLES) / SAMPLES)
    with np.errstate(all="ignore"):
        drive = K * (top - K)
        linear = (c2 + gamma3) * K + rod.g * nu
        spread = np.sqrt(linear**2 + 4 * square * drive)
        slow = (spread - linear) / (2 * square) if square > 0 else 0.0
        rates = np.where(linear > 0, 2 * drive / (linear + spread), slow)
    best = int(np.argmax(np.where(rates > 0, rates, 0.0)))
    return (float(rates[best]), float(np.sqrt(K[best]))) if rates[best] > 0 else (0.0, 0.0)
