"""The trigonometric polynomial through equidistant samples of one period: values, slopes and extrema.

Samples are at the times k/N, k = 0 ... N - 1, in periods. All functions have the spectral accuracy of the
samples. For even N the highest harmonic is a cosine.

Compiled kernels may sum in any order; a changed order of their statements changes the last bit of results.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...model.compiled.compilation import compiled_with_reordered_sums
from ...model.compiled.kernel_constants import KernelConstants


@dataclass(frozen=True, slots=True, kw_only=True)
class TrigonometricMaximumSettings(KernelConstants):
    """Settings for maxima and zeros of trigonometric polynomials."""

    max_steps: int = 8
    """Maximum number of Newton steps from the largest sample to the maximum."""
    converged_step: float = 1e-9
    """Newton's method stops when |step| < converged_step, in periods; the error is about the squared step."""
    bisection_count: int = 50
    """Number of bisections of the interval between two samples around a zero, down to rounding error."""


TRIGONOMETRIC_MAXIMUM_SETTINGS = TrigonometricMaximumSettings()


def fourier_coefficients(samples: Array) -> Complex:
    """Coefficients c, (N // 2 + 1, ...): Re sum_k c_k exp(2 pi i k t) interpolates samples, (N, ...)."""
    n = len(samples)
    c: Complex = np.fft.rfft(samples, axis=0) / n
    c[1 : (n + 1) // 2] *= 2  # conjugate harmonic; none for the mean, and for the last harmonic of an even N
    return c


def hermite_fourier_coefficients(values: Array, slopes: Array) -> Complex:
    """Coefficients c, (m + 1, ...): Re sum_k c_k exp(2 pi i k t) interpolates values and slopes at t = k/m.
    values, slopes: (m, ...); slopes are derivatives by the time in periods. The slopes distinguish the
    harmonics k and m - k, so twice as many harmonics are resolved as from values alone."""
    columns = np.ascontiguousarray(values).reshape(len(values), -1)
    rates = np.ascontiguousarray(slopes).reshape(len(slopes), -1)
    c: Complex = hermite_fourier_coefficients_of_columns(columns, rates, np.zeros(columns.shape[1]))
    return c.reshape(len(c), *values.shape[1:])


@compiled_with_reordered_sums
def hermite_fourier_coefficients_of_columns(values: Array, slopes: Array, signs: Array) -> Complex:
    """`hermite_fourier_coefficients`, (m + 1, columns), of several fields, one per column, given at times
    over half a period or a whole period.

    values, slopes: (nodes, columns). signs: (columns,); 1 or -1 if a field repeats or changes its sign after
    half a period and the nodes cover half a period; 0 if the nodes cover a whole period. c_k = 2/m ((1 - k/m)
    S_k + D_k/(2 pi i m)), S_k and D_k: sums over all m times j/m of value and slope times exp(-2 pi i k j/m).
    """
    nodes, columns = values.shape
    m = 2 * nodes if signs[0] != 0 else nodes
    waves = _cosine_sine_table(m)
    cos = np.empty(nodes)
    sin = np.empty(nodes)
    f = values.T.copy()
    df = slopes.T.copy()
    c = np.zeros((m + 1, columns), np.complex128)
    for k in range(m + 1):
        index = 0
        for j in range(nodes):
            cos[j] = waves[0, index]
            sin[j] = waves[1, index]
            # A table of angles by index keeps rounding errors from adding up over the harmonics.
            index += k if index + k < m else k - m
        for a in range(columns):
            # The second half of the period doubles or cancels the sum of a harmonic.
            factor = 2 * (1 + signs[a] * (1 - 2 * (k % 2))) / m
            # A field that repeats after half a period has even harmonics only, a field that changes its sign
            # odd harmonics only.
            if factor == 0:
                continue
            S = 0.0
            iS = 0.0
            D = 0.0
            iD = 0.0
            for j in range(nodes):
                S += cos[j] * f[a, j]
                iS -= sin[j] * f[a, j]
                D += cos[j] * df[a, j]
                iD -= sin[j] * df[a, j]
            # Harmonics k and k - m have equal values at the m times but different slopes.
            weight = 1 - k / m
            unit = 1 / (2 * np.pi * m)
            c[k, a] = complex(factor * (weight * S + unit * iD), factor * (weight * iS - unit * D))
    for a in range(columns):
        # The last harmonic is a sine with value 0 at all nodes; only slopes determine it.
        c[0, a], c[m, a] = c[0, a].real / 2, c[m, a] / 2
    return c


@compiled_with_reordered_sums
def _cosine_sine_table(count: int) -> Array:
    """Cosine and sine of 2 pi k/count for k = 0 ... count - 1, (2, count)."""
    waves = np.empty((2, count))
    for i in range(count):
        angle = 2 * np.pi * i / count
        waves[0, i] = np.cos(angle)
        waves[1, i] = np.sin(angle)
    return waves


def series_samples(c: Complex, count: int) -> Array:
    """Re sum_k c_k exp(2 pi i k t) at t = 0, 1/count, ..., 1 - 1/count, (count, ...); c: (harmonics, ...)."""
    samples: Array = series_samples_of_columns(np.ascontiguousarray(c).reshape(len(c), -1), count)
    return samples.reshape(count, *c.shape[1:])


@compiled_with_reordered_sums
def series_samples_of_columns(c: Complex, count: int) -> Array:
    """`series_samples` of columns, (count, columns), from coefficients c, (harmonics, columns). For an even
    count, sums of the first half of the period also give the second half: even harmonics are equal, odd
    harmonics have the opposite sign."""
    harmonics, columns = c.shape
    # Even harmonics come first, because odd harmonics change their sign after half a period.
    order = np.append(np.arange(0, harmonics, 2), np.arange(1, harmonics, 2))
    even_count = (harmonics + 1) // 2
    steps = order % count
    angles = np.zeros(harmonics, np.int64)
    waves = _cosine_sine_table(count)
    cos = np.empty(harmonics)
    sin = np.empty(harmonics)
    real = np.empty((columns, harmonics))
    imaginary = np.empty((columns, harmonics))
    for a in range(columns):
        for k in range(harmonics):
            real[a, k] = c[order[k], a].real
            imaginary[a, k] = c[order[k], a].imag
    samples = np.empty((count, columns))
    computed_count = count // 2 if count % 2 == 0 else count
    for i in range(computed_count):
        for k in range(harmonics):
            cos[k] = waves[0, angles[k]]
            sin[k] = waves[1, angles[k]]
            angles[k] += steps[k] if angles[k] + steps[k] < count else steps[k] - count
        for a in range(columns):
            even_sum = 0.0
            odd_sum = 0.0
            for k in range(even_count):
                even_sum += cos[k] * real[a, k] - sin[k] * imaginary[a, k]
            for k in range(even_count, harmonics):
                odd_sum += cos[k] * real[a, k] - sin[k] * imaginary[a, k]
            samples[i, a] = even_sum + odd_sum
            if computed_count < count:
                samples[i + computed_count, a] = even_sum - odd_sum
    return samples


def interpolate_samples(samples: Array, times: NDArray[np.floating]) -> Array:
    """The trigonometric interpolant, (m, ...), of samples, (N, ...), at `times`, (m,), in periods."""
    return series_values_at(fourier_coefficients(samples), times)


def series_values_at(c: Complex, times: NDArray[np.floating]) -> Array:
    """Re sum_k c_k exp(2 pi i k t), (m, ...), at `times` t, (m,), in periods; c: (harmonics, ...)."""
    waves = np.exp(2j * np.pi * np.outer(times, np.arange(len(c))))
    return (waves @ c.reshape(len(c), -1)).real.reshape(len(times), *c.shape[1:])


def time_derivative(samples: Array) -> Array:
    """Derivative of the interpolant of samples by the time in periods, at the sample times; both (N, ...)."""
    n = len(samples)
    k = 2j * np.pi * np.arange(n // 2 + 1)
    if n % 2 == 0:
        k[-1] = 0.0  # the sample times of this cosine are its extrema, where the derivative is 0
    return np.fft.irfft(k.reshape(-1, *(1,) * (samples.ndim - 1)) * np.fft.rfft(samples, axis=0), n, axis=0)


@compiled_with_reordered_sums
def series_maxima(c: Complex, samples: Array) -> Array:
    """Maxima, (m,), of m series Re sum_k c_k exp(2 pi i k t), by Newton's method from the largest samples. c:
    (harmonics, m). samples: equidistant over a period, (n, m)."""
    n, m = samples.shape
    maxima = np.empty(m)
    for column in range(m):
        t = float(np.argmax(samples[:, column])) / n
        for _ in range(TRIGONOMETRIC_MAXIMUM_SETTINGS.max_steps):
            _, slope, curvature = _series_value_slope_curvature(c[:, column], t)
            # Newton's method would converge to a minimum.
            if curvature >= 0:
                break
            # The distance of the maximum from the largest sample is at most the distance between samples.
            step = min(max(slope / curvature, -1 / n), 1 / n)
            t -= step
            if abs(step) < TRIGONOMETRIC_MAXIMUM_SETTINGS.converged_step:
                break
        maxima[column] = _series_value_slope_curvature(c[:, column], t)[0]
    return maxima


@compiled_with_reordered_sums
def series_minima(c: Complex, samples: Array) -> Array:
    """Minima, (m,), of Re sum_k c_k exp(2 pi i k t), like `series_maxima`; c: (harmonics, m)."""
    return -series_maxima(-c, -samples)


@compiled_with_reordered_sums
def _series_value_slope_curvature(c: Complex, t: float) -> tuple[float, float, float]:
    """Returns (value, slope, curvature) of Re sum_k c_k exp(2 pi i k t) at the time t; c: (harmonics,)."""
    angle = 2 * np.pi * t
    step = complex(np.cos(angle), np.sin(angle))
    wave = complex(1.0, 0.0)
    value = 0.0
    slope = 0.0
    curvature = 0.0
    for k in range(len(c)):
        term = c[k] * wave
        w = 2 * np.pi * k
        value += term.real
        slope -= w * term.imag
        curvature -= w * w * term.real
        # The recurrence needs one sine and one cosine for all harmonics.
        wave *= step
    return value, slope, curvature


def time_of_rise_through_mean(samples: Array) -> float:
    """Time, in periods, at which the interpolant of samples, (N,), rises through its mean after a minimum."""
    n = len(samples)
    deviation = samples - samples.mean()
    indices_after_minimum = (int(np.argmin(deviation)) + np.arange(n + 1)) % n
    # The series may cross its mean often; the first rise after the minimum is the same for every phase.
    k = int(np.argmax(deviation[indices_after_minimum] >= 0))
    return float(
        _bisect_rising_zero(
            fourier_coefficients(deviation), (indices_after_minimum[k] - 1) / n, indices_after_minimum[k] / n
        )
    )


@compiled_with_reordered_sums
def _bisect_rising_zero(c: Complex, low: float, high: float) -> float:
    """The zero of Re sum_k c_k exp(2 pi i k t) between t = low and t = high by bisection; c: (harmonics,)."""
    for _ in range(TRIGONOMETRIC_MAXIMUM_SETTINGS.bisection_count):
        middle = (low + high) / 2
        if _series_value_slope_curvature(c, middle)[0] < 0:
            low = middle
        else:
            high = middle
    return low
