"""The trigonometric polynomial through equidistant samples of one period.

Samples are at the times k/N, k = 0 ... N - 1, in periods: what follows the last is the first. Everything is
exact to the spectral accuracy of the samples. Where N is even, the highest harmonic is a cosine.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Complex
from ..model.compilation import compiled_for_vectors

MOST_BY_MATRIX, MOST_SAMPLES_BY_MATRIX = 64, 1024
"""Harmonics and samples up to which one follows from the other by a matrix, which is kept, and beyond by FFT:
below it is the calls that cost."""

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
    if m > MOST_BY_MATRIX:
        return _hermite_by_fft(values, slopes)
    parts = hermite_matrix(m) @ np.concatenate([values, slopes]).reshape(2 * m, -1)
    c = np.empty((m + 1, parts.shape[1]), complex)
    c.real, c.imag = parts[: m + 1], parts[m + 1 :]
    return c.reshape(m + 1, *values.shape[1:])


@lru_cache(maxsize=64)
def hermite_matrix(m: int) -> Array:
    """Matrix from m values, then m slopes, to the real, then the imaginary parts, (2 m + 2, 2 m)."""
    unit, none = np.eye(m), np.zeros((m, m))
    c = np.concatenate([_hermite_by_fft(unit, none), _hermite_by_fft(none, unit)], axis=1)
    return np.concatenate([c.real, c.imag])


def _hermite_by_fft(values: Array, slopes: Array) -> Complex:
    """`hermite_coefficients` of any number of nodes."""
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
    """Re sum_k c_k exp(2 pi i k t) at `count` equidistant times from 0, shape (count, ...)."""
    few = len(c) <= MOST_BY_MATRIX + 1 and count <= MOST_SAMPLES_BY_MATRIX
    if few or count <= 2 * len(c):  # where an FFT would leave out the last harmonics
        flat = c.reshape(len(c), -1)
        samples: Array = sampling_matrix(len(c), count) @ np.concatenate([flat.real, flat.imag])
        return samples.reshape(count, *c.shape[1:])
    half = c * (count / 2)
    half[0] *= 2
    return np.ascontiguousarray(np.fft.irfft(half, count, axis=0))


@lru_cache(maxsize=64)
def sampling_matrix(harmonics: int, count: int) -> Array:
    """Matrix from real, then imaginary parts of coefficients to samples, shape (count, 2 harmonics)."""
    turns = np.outer(np.arange(count), np.arange(harmonics)) % count
    waves = np.exp(2j * np.pi / count * turns)
    return np.concatenate([waves.real, -waves.imag], axis=1)


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


@compiled_for_vectors
def maxima(c: Complex, samples: Array) -> Array:
    """The maxima, (m,), of Re sum_k c_k exp(2 pi i k t), (count, m), near those of its samples, (n, m)."""
    n, m = samples.shape
    highest = np.empty(m)
    for column in range(m):
        t = float(np.argmax(samples[:, column])) / n
        for _ in range(EXTREMUM_STEPS):
            _, slope, curvature = _expansion(c[:, column], t)
            if curvature >= 0:
                break
            step = min(max(slope / curvature, -1 / n), 1 / n)
            t -= step
            if abs(step) < EXTREMUM_FOUND:
                break
        highest[column] = _expansion(c[:, column], t)[0]
    return highest


@compiled_for_vectors
def _expansion(c: Complex, t: float) -> tuple[float, float, float]:
    """Value, slope and curvature of Re sum_k c_k exp(2 pi i k t), c of shape (count,)."""
    turn = 2 * np.pi * t
    step, wave = complex(np.cos(turn), np.sin(turn)), complex(1.0, 0.0)
    value, slope, curvature = 0.0, 0.0, 0.0
    for k in range(len(c)):
        term, w = c[k] * wave, 2 * np.pi * k
        value += term.real
        slope -= w * term.imag
        curvature -= w * w * term.real
        wave *= step
    return value, slope, curvature


def rise_through_mean(samples: Array) -> float:
    """When the polynomial through samples, (N,), rises through its mean after its minimum, in periods."""
    n = len(samples)
    deviation = samples - samples.mean()
    after = (int(np.argmin(deviation)) + np.arange(n + 1)) % n
    k = int(np.argmax(deviation[after] >= 0))
    return float(_rise(coefficients(deviation), (after[k] - 1) / n, after[k] / n))


@compiled_for_vectors
def _rise(c: Complex, low: float, high: float) -> float:
    """Where Re sum_k c_k exp(2 pi i k t), c of shape (count,), is 0 between two times, by bisection."""
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if _expansion(c, middle)[0] < 0:
            low = middle
        else:
            high = middle
    return low
