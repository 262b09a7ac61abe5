"""Grading of the time intervals of an orbit: a smooth map from a mesh time, in which the intervals have equal
lengths, to the time.

Near the turning points of the tip an orbit changes faster than elsewhere. A smooth map keeps the spectral
accuracy of trigonometric polynomials through the states at the starts of the intervals: these polynomials are
functions of the mesh time.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ...arrays import Array, Complex
from ...discretization.elements.elements import ELEMENT_SETTINGS
from ...discretization.elements.trigonometric import fourier_coefficients


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeGradingSettings:
    """Settings for the grading of the time intervals of an orbit."""

    grading_amplitude_step: float = 0.05
    """The two amplitudes of a grading are multiples of this step, so that similar orbits share their
    meshes."""
    max_grading_amplitude: float = 0.6
    """Largest amplitude of the grading dt/dtau - 1, t: time, tau: mesh time. The longest interval is then at
    most four times as long as the shortest."""
    min_interval_tail_ratio: float = 1e-4
    """The tail of an interval (its last coefficient in time), divided by the largest tail, is raised to this
    lower limit: smaller tails may be rounding errors, and have little effect on a smooth grading."""
    samples_per_time_node: int = 4
    """Number of equidistant times per node at which a function of the mesh time is evaluated to find its
    harmonics in time. A function of the time has fewer harmonics than the same function of the mesh time."""
    inversion_bisection_count: int = 8
    """Number of bisections that invert the map with an error of 0.002, from which Newton's method
    converges."""
    newton_step_count: int = 4
    """Number of Newton steps that invert the map after the bisections; the third reaches rounding error."""


TIME_GRADING_SETTINGS = TimeGradingSettings()


@dataclass(frozen=True, slots=True)
class TimeGrading:
    """Map from the mesh time tau to the time t, both as fractions of the solved part of the period:

    dt/dtau = 1 + cosine_amplitude cos(2 pi harmonic tau) + sine_amplitude sin(2 pi harmonic tau),  t(0) = 0.
    """

    cosine_amplitude: float = 0.0
    sine_amplitude: float = 0.0
    harmonic: int = 1

    @property
    def is_uniform(self) -> bool:
        """Whether mesh time and time are equal."""
        return self.cosine_amplitude == 0 and self.sine_amplitude == 0

    @property
    def over_two_solved_parts(self) -> "TimeGrading":
        """The grading over two solved parts of the period."""
        return replace(self, harmonic=2 * self.harmonic)

    def times(self, mesh_times: Array) -> Array:
        """Times at `mesh_times`; arrays of a common shape."""
        if self.is_uniform:
            return mesh_times
        k = 2 * np.pi * self.harmonic
        angles = k * mesh_times
        times: Array = (
            mesh_times
            + (self.cosine_amplitude * np.sin(angles) + self.sine_amplitude * (1 - np.cos(angles))) / k
        )
        return times

    def time_slopes(self, mesh_times: Array) -> Array:
        """dt/dtau at `mesh_times`; arrays of a common shape."""
        angles = 2 * np.pi * self.harmonic * mesh_times
        rates: Array = 1 + self.cosine_amplitude * np.cos(angles) + self.sine_amplitude * np.sin(angles)
        return rates

    def mesh_times(self, times: Array) -> Array:
        """Mesh times at `times` in [0, 1]; arrays of a common shape."""
        if self.is_uniform:
            return times
        lower = np.zeros_like(times)
        upper = np.ones_like(times)
        # After a few bisections Newton's method converges for every allowed amplitude.
        for _ in range(TIME_GRADING_SETTINGS.inversion_bisection_count):
            middle = (lower + upper) / 2
            is_below = self.times(middle) < times
            lower = np.where(is_below, middle, lower)
            upper = np.where(is_below, upper, middle)
        middles: Array = (lower + upper) / 2
        for _ in range(TIME_GRADING_SETTINGS.newton_step_count):
            middles = middles - (self.times(middles) - times) / self.time_slopes(middles)
        return middles


UNIFORM_TIME_GRADING = TimeGrading()
"""Intervals of equal length."""


def fitted_grading(tails: Array, edges: Array, stage_count: int, harmonic: int) -> TimeGrading:
    """The grading for which the tails of all intervals are as equal as possible. tails: last Legendre
    coefficients in the intervals of an orbit, (K,). edges: times of the ends of these intervals, as
    fractions of the solved part of the period, (K + 1,). stage_count: number of stages of an interval.
    harmonic: `TimeGrading.harmonic` of the result."""
    lengths = np.diff(edges)
    limited_tails = np.maximum(tails, TIME_GRADING_SETTINGS.min_interval_tail_ratio * tails.max())
    # A coefficient of degree s in an interval of length h, over h^(s + 1), is a measure of the error density.
    increments = limited_tails ** (1 / (stage_count + 1))
    mesh_time_ends = np.cumsum(increments) / increments.sum()
    angles = 2 * np.pi * harmonic * (mesh_time_ends - increments / (2 * increments.sum()))
    # With equal tails tau grows by the increments; these are the Fourier coefficients of dt/dtau.
    cosine = 2 * float(lengths @ np.cos(angles))
    sine = 2 * float(lengths @ np.sin(angles))
    amplitude = float(np.hypot(cosine, sine))
    max_amplitude = TIME_GRADING_SETTINGS.max_grading_amplitude
    amplitude_factor = max_amplitude / amplitude if amplitude > max_amplitude else 1.0
    step = TIME_GRADING_SETTINGS.grading_amplitude_step
    return TimeGrading(
        step * round(amplitude_factor * cosine / step), step * round(amplitude_factor * sine / step), harmonic
    )


def fourier_coefficients_in_time(c: Complex, grading: TimeGrading, part_count: int) -> Complex:
    """Fourier coefficients in time, from the mean upwards, (harmonics + 1, ...), of the function Re sum_k c_k
    exp(2 pi i k tau) of the mesh time tau in periods. c: (k, ...); returned unchanged for a uniform grading.
    part_count: number of solved parts in a period."""
    if grading.is_uniform:
        return c
    return fourier_coefficients(samples_in_time(c, grading, part_count))


def samples_in_time(c: Complex, grading: TimeGrading, part_count: int) -> Array:
    """Values, (samples, ...), of the function in `fourier_coefficients_in_time`, with the same arguments, at
    equidistant times of the period, `samples_per_time_node` of them per coefficient beyond the first."""
    cosines, sines = _mesh_time_waves_at_equal_times(len(c), grading, part_count)
    columns = c.reshape(len(c), -1)
    samples: Array = cosines @ columns.real - sines @ columns.imag
    return samples.reshape(len(samples), *c.shape[1:])


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _mesh_time_waves_at_equal_times(
    coefficient_count: int, grading: TimeGrading, part_count: int
) -> tuple[Array, Array]:
    """Cosines and sines of 2 pi k tau, (samples, `coefficient_count`) each, k from 0 to `coefficient_count` -
    1, at the mesh times tau of equidistant times of the period; the number of samples is
    `samples_per_time_node` (`coefficient_count` - 1). part_count: number of solved parts in a period."""
    sample_count = TIME_GRADING_SETTINGS.samples_per_time_node * (coefficient_count - 1)
    part, times = np.divmod(part_count * np.arange(sample_count), sample_count)
    mesh_times = (part + grading.mesh_times(times / sample_count)) / part_count
    angles = 2 * np.pi * np.outer(mesh_times, np.arange(coefficient_count))
    return np.cos(angles), np.sin(angles)
