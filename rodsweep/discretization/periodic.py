"""The trigonometric polynomial through equidistant samples of one period.

Samples are at the times k/N, k = 0 ... N - 1, in periods: what follows the last is the first. Everything is
exact to the spectral accuracy of the samples. Where N is even, the highest harmonic is a cosine.
"""

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Complex

EXTREMUM_STEPS = 8
"""Newton steps from the largest sample to the maximum."""
BISECTIONS = 50


def coefficients(samples: Array) -> Complex:
    """c, shape (N // 2 + 1, ...), with Re sum_k c_k exp(2 pi i k t) through the samples, shape (N, ...)."""
    n = len(samples)
    c: Complex = np.fft.rfft(samples, axis=0) / n
    c[1 : (n + 1) // 2] *= 2  # each stands for its conjugate too, but for the mean and an even N's last
    return c


def resampled(samples: Array, at: NDArray[np.floating]) -> Array:
    """The polynomial through samples, shape (N, ...), at the times `at` in periods, (m,): shape (m, ...)."""
    c = coefficients(samples)
    waves = np.exp(2j * np.pi * np.outer(at, np.arange(len(c))))
    return (waves @ c.reshape(len(c), -1)).real.reshape(len(at), *samples.shape[1:])


def derivative(samples: Array) -> Array:
    """The derivative of the polynomial by the time in periods, at the samples, shape (N, ...)."""
    n = len(samples)
    k = 2j * np.pi * np.arange(n // 2 + 1)
    if n % 2 == 0:
        k[-1] = 0.0  # a cosine that is sampled at its extrema only
    return np.fft.irfft(k.reshape(-1, *(1,) * (samples.ndim - 1)) * np.fft.rfft(samples, axis=0), n, axis=0)


def maximum(samples: Array) -> float:
    """The maximum of the polynomial through samples of shape (N,)."""
    n, c = len(samples), coefficients(samples)
    k = 2j * np.pi * np.arange(len(c))
    t = int(np.argmax(samples)) / n
    for _ in range(EXTREMUM_STEPS):
        e = c * np.exp(k * t)
        first, second = (k * e).sum().real, (k * k * e).sum().real
        t -= float(np.clip(first / second, -1 / n, 1 / n)) if second < 0 else 0.0
    return float((c * np.exp(k * t)).sum().real)


def rise_through_mean(samples: Array) -> float:
    """When the polynomial through samples, (N,), rises through its mean after its minimum, in periods."""
    n = len(samples)
    deviation = samples - samples.mean()
    after = (int(np.argmin(deviation)) + np.arange(n + 1)) % n
    k = int(np.argmax(deviation[after] >= 0))
    low, high = (after[k] - 1) / n, after[k] / n
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        below = resampled(deviation, np.array([middle]))[0] < 0
        low, high = (middle, high) if below else (low, middle)
    return float(low)
