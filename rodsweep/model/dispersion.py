"""The dispersion relation of Sec. VI: the wave that an endless rod would amplify most.

A wave exp(i kappa u) with K = kappa^2 grows at the root w(K) of

    gamma3 c2 w^2 + [(c2 + gamma3) K + g nu] w + K^2 - F g K = 0.

No eigenvalue of the finite rod is claimed to be near; its largest growth rate and the wave number
tell where to look for eigenvalues and how fine a mesh will be needed.
"""

import numpy as np

from ..arrays import Array
from .rod import Rod

SAMPLES = 64
LOWEST = 1e-4
"""K is sampled from LOWEST F g to F g in equal ratios; the answer need not be sharper."""


def most_amplified_wave(rod: Rod) -> tuple[float, float]:
    """(growth rate in 1/tau2, wave number in 1/L) of the most amplified wave; (0, 0) if all decay.

    Not compiled: `check` needs it, and would load numba for nothing else.
    """
    rates, numbers = most_amplified_waves(*(np.array([value]) for value in rod.coefficients))
    return float(rates[0]), float(numbers[0])


def local_growth(rod: Rod, u: Array) -> tuple[Array, Array]:
    """`most_amplified_wave` at points of an arm, (n,), as if the arm were uniform there."""
    nu, c2, c3, gamma2, gamma3, _ = rod.local(u)
    rates, numbers = most_amplified_waves(rod.F * c3, nu, c2 / c3, gamma3 / gamma2)
    return rates / (gamma2 * c3), numbers


def most_amplified_waves(F: Array, nu: Array, c2: Array, gamma3: Array) -> tuple[Array, Array]:
    """(growth rates, wave numbers) of the most amplified waves of n rods with k3 = gamma2 = 1, all (n,)."""
    g, square = nu + F * c2, (c2 * gamma3)[:, None]
    top = np.where(F * g > 0, F * g, 0.0)[:, None]
    K = top * LOWEST ** (1 - np.arange(SAMPLES) / SAMPLES)
    with np.errstate(all="ignore"):
        drive = K * (top - K)
        linear = (c2 + gamma3)[:, None] * K + (g * nu)[:, None]
        spread = np.sqrt(linear**2 + 4 * square * drive)
        slow = np.where(square > 0, (spread - linear) / (2 * square), 0.0)
        rates = np.where(linear > 0, 2 * drive / (linear + spread), slow)
    rates = np.where(rates > 0, rates, 0.0)
    best = np.argmax(rates, axis=1)
    every = np.arange(len(best))
    largest = rates[every, best]
    return largest, np.where(largest > 0, np.sqrt(K[every, best]), 0.0)
