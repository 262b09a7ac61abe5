"""The dispersion relation of Sec. VI: the wave that an endless rod would amplify most.

A wave exp(i kappa u) with K = kappa^2 grows at the root w(K) of

    gamma3 c2 w^2 + [(c2 + gamma3) K + g nu] w + K^2 - F g K = 0.

No eigenvalue of the finite rod is claimed to be near; its largest growth rate and the wave number
tell where to look for eigenvalues and how fine a mesh will be needed.
"""

import numpy as np

from .rod import Rod

SAMPLES = np.geomspace(1e-4, 1.0, 64, endpoint=False)


def most_amplified_wave(rod: Rod) -> tuple[float, float]:
    """(growth rate in 1/tau2, wave number in 1/L) of the most amplified wave; (0, 0) if all decay."""
    top = rod.F * rod.g
    if top <= 0:
        return 0.0, 0.0
    K = top * SAMPLES
    drive = K * (top - K)
    drag = (rod.c2 + rod.gamma3) * K + rod.g * rod.nu
    square = rod.gamma3 * rod.c2
    spread = np.sqrt(drag**2 + 4 * square * drive)
    rate = np.zeros_like(K)
    np.divide(2 * drive, drag + spread, out=rate, where=drag > 0)
    if square > 0:
        np.divide(spread - drag, 2 * square, out=rate, where=drag <= 0)
    best = int(np.argmax(rate))
    return float(rate[best]), float(np.sqrt(K[best]))


def wave_numbers(w: complex, rod: Rod) -> tuple[float, float]:
    """|q| of the two pairs of exponents exp(+-q u) of an eigenfunction at w (Sec. VI)."""
    total = (rod.c2 + rod.gamma3) * w - rod.F * rod.g
    product = w * (rod.g * rod.nu + rod.c2 * rod.gamma3 * w)
    root = np.sqrt(total**2 - 4 * product + 0j)
    large = (total + root if abs(total + root) >= abs(total - root) else total - root) / 2
    small = product / large if large != 0 else 0.0
    return abs(large) ** 0.5, abs(small) ** 0.5
