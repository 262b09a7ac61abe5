"""The trigonometric polynomial through equidistant samples of one period.

Samples are at the times k/N, k = 0 ... N - 1, in periods: what follows the last is the first. Everything is
exact to the spectral accuracy of the samples. Where N is even, the highest harmonic is a cosine.
"""

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Complex

EXTREMUM_STEPS = 8
"""Newton steps from the largest sample to the maximum."""
EXTREMUM_FOUND = 1e-9
"""Last step in periods; what it leaves of the maximum is its square."""
BISECTIONS = 50


def coefficients(samples: Array) -> Complex:
    """c, shape (N // 2 + 1, ...), with Re sum_k c_k exp(2 pi i k t) through the samples, shape (N, ...)."""
    n = len(samples)
    c: Complex = np.fft.rfft(samples, axis=0) / n
    c[1 : (n + 1) // 2] *= 2  # each stands for its conjugate too, but for the mean and an even N's last
    return c


def hermite_coefficients(values: Array, slopes: Array) -> Complex:
    """c, shape (m + 1, ...), with Re sum_k c_k exp(2 pi i k t) through values and slopes at k/m, (m, ...).

    slopes: by the time in periods. The slopes tell harmonic k from harmonic m - k, which look alike in the
    values: twice as many harmonics are resolved as by values alone.
    """
    m = len(values)
    k = np.arange(m).reshape(-1, *(1,) * (values.ndim - 1))
    sums = np.fft.fft(values, axis=0) / m  # c_k + c_(k - m), of the series over k = -m ... m - 1
    rates = np.fft.fft(slopes, axis=0) / (2j * np.pi * m)  # k c_k + (k - m) c_(k - m)
    below = (k * sums - rates) / m
    c: Complex = np.zeros((m + 1, *values.shape[1:]), complex)
    c[:m] = sums - below
    c[1:] += np.conj(below[::-1])
    c[0] = sums[0]  # the harmonic m shows in the slopes only: it is a sine
    return c


def samples_of(c: Complex, count: int) -> Array:
    """Re sum_k c_k exp(2 pi i k t) at `count` equidistant times, shape (count, ...), more than 2 len(c)."""
    half = c * (count / 2)
    half[0] *= 2
    return np.fft.irfft(half, count, axis=0)


def resampled(samples: Array, at: NDArray[np.floating]) -> Array:
    """The polynomial through samples, shape (N, ...), at the times `at` in periods, (m,): shape (m, ...)."""
    return sampled_at(coefficients(samples), at)


def sampled_at(c: Complex, at: NDArray[np.floating]) -> Array:
    """Re sum_k c_k exp(2 pi i k t) at the times `at` in periods, (m,): shape (m, ...)."""
    waves = np.exp(2j * np.pi * np.outer(at, np.arange(len(c))))
    return (waves @ c.reshape(len(c), -1)).real.reshape(len(at), *c.shape[1:])


def derivative(samples: Array) -> Array:
    """The derivative of the polynomial by the time in periods, at the samples, shape (N, ...)."""
    n = len(samples)
    k = 2j * np.pi * np.arange(n // 2 + 1)
    if n % 2 == 0:
        k[-1] = 0.0  # a cosine that is sampled at its extrema only
    return np.fft.irfft(k.reshape(-1, *(1,) * (samples.ndim - 1)) * np.fft.rfft(samples, axis=0), n, axis=0)


def maxima(c: Complex, samples: Array) -> Array:
    """The maxima, (m,), of Re sum_k c_k exp(2 pi i k t), (count, m), near those of its samples, (n, m)."""
    n = len(samples)
    k = 2j * np.pi * np.arange(len(c))[:, None]
    t = np.argmax(samples, axis=0) / n
    for _ in range(EXTREMUM_STEPS):
        e = c * np.exp(k * t)
        slope, curvature = (k * e).sum(axis=0).real, (k * k * e).sum(axis=0).real
        curved = curvature < 0
        step = np.where(curved, np.clip(slope / np.where(curved, curvature, 1.0), -1 / n, 1 / n), 0.0)
        t = t - step
        if np.abs(step).max() < EXTREMUM_FOUND:
            break
    highest: Array = (c * np.exp(k * t)).sum(axis=0).real
    return highest


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
