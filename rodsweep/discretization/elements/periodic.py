"""The trigonometric polynomial through equidistant samples of one period.

Samples are at the times k/N, k = 0 ... N - 1, in periods: what follows the last is the first. Everything is
exact to the spectral accuracy of the samples. Where N is even, the highest harmonic is a cosine.
"""

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...model.compiled.compilation import compiled_for_vectors

EXTREMUM_STEPS = 8
"""Newton steps from the largest sample to the maximum."""
EXTREMUM_FOUND = 1e-9
"""Largest last step, in periods, of a converged search; the error of the maximum is about its square."""
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
    flat, rates = (np.ascontiguousarray(f).reshape(len(f), -1) for f in (values, slopes))
    c: Complex = hermite_columns(flat, rates, np.zeros(flat.shape[1]))
    return c.reshape(len(c), *values.shape[1:])


@compiled_for_vectors
def hermite_columns(values: Array, slopes: Array, signs: Array) -> Complex:
    """`hermite_coefficients` of columns, (m + 1, columns), given over half a period or the whole.

    values, slopes: (nodes, columns); signs: what a column is multiplied with half a period later, or 0 where
    the nodes are those of the whole period, (columns,). With the sums S_k of values and D_k of slopes over
    the nodes, times exp(-2 pi i k j/m), c_k = 2/m ((1 - k/m) S_k + D_k/(2 pi i m)).
    """
    nodes, columns = values.shape
    m = 2 * nodes if signs[0] != 0 else nodes
    turns, cos, sin = _waves(m), np.empty(nodes), np.empty(nodes)
    f, df, c = values.T.copy(), slopes.T.copy(), np.zeros((m + 1, columns), np.complex128)
    for k in range(m + 1):
        at = 0
        for j in range(nodes):
            cos[j], sin[j] = turns[0, at], turns[1, at]
            at += k if at + k < m else k - m
        for a in range(columns):
            # The other half of the period doubles a harmonic or cancels it.
            factor = 2 * (1 + signs[a] * (1 - 2 * (k % 2))) / m
            if factor == 0:
                continue
            S, iS, D, iD = 0.0, 0.0, 0.0, 0.0
            for j in range(nodes):
                S += cos[j] * f[a, j]
                iS -= sin[j] * f[a, j]
                D += cos[j] * df[a, j]
                iD -= sin[j] * df[a, j]
            share, by_slope = 1 - k / m, 1 / (2 * np.pi * m)
            c[k, a] = complex(factor * (share * S + by_slope * iD), factor * (share * iS - by_slope * D))
    for a in range(columns):  # the mean and the last, which shows in the slopes only, as a sine
        c[0, a], c[m, a] = c[0, a].real / 2, c[m, a] / 2
    return c


@compiled_for_vectors
def _waves(count: int) -> Array:
    """Cosine and sine at `count` equidistant times of a period, (2, count)."""
    waves = np.empty((2, count))
    for i in range(count):
        turn = 2 * np.pi * i / count
        waves[0, i], waves[1, i] = np.cos(turn), np.sin(turn)
    return waves


def samples_of(c: Complex, count: int) -> Array:
    """Re sum_k c_k exp(2 pi i k t) at `count` equidistant times from 0, shape (count, ...)."""
    samples: Array = sampled_columns(np.ascontiguousarray(c).reshape(len(c), -1), count)
    return samples.reshape(count, *c.shape[1:])


@compiled_for_vectors
def sampled_columns(c: Complex, count: int) -> Array:
    """`samples_of` columns, (count, columns), of coefficients (harmonics, columns).

    Half a period later the even harmonics are the same and the odd ones reversed.
    """
    harmonics, columns = c.shape
    order = np.append(np.arange(0, harmonics, 2), np.arange(1, harmonics, 2))
    odd, steps, at = (harmonics + 1) // 2, order % count, np.zeros(harmonics, np.int64)
    turns, cos, sin = _waves(count), np.empty(harmonics), np.empty(harmonics)
    real, imaginary = np.empty((columns, harmonics)), np.empty((columns, harmonics))
    for a in range(columns):
        for k in range(harmonics):
            real[a, k], imaginary[a, k] = c[order[k], a].real, c[order[k], a].imag
    samples, later = np.empty((count, columns)), count // 2 if count % 2 == 0 else count
    for i in range(later):
        for k in range(harmonics):
            cos[k], sin[k] = turns[0, at[k]], turns[1, at[k]]
            at[k] += steps[k] if at[k] + steps[k] < count else steps[k] - count
        for a in range(columns):
            same, other = 0.0, 0.0
            for k in range(odd):
                same += cos[k] * real[a, k] - sin[k] * imaginary[a, k]
            for k in range(odd, harmonics):
                other += cos[k] * real[a, k] - sin[k] * imaginary[a, k]
            samples[i, a] = same + other
            if later < count:
                samples[i + later, a] = same - other
    return samples


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
def minima(c: Complex, samples: Array) -> Array:
    """The minima, as `maxima`, (m,)."""
    return -maxima(-c, -samples)


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
