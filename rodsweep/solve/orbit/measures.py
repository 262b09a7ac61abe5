"""Measures of a cycle: extrema, harmonics, energy budget, path of the tip and shapes of the rod.

Mesh time is a variable in which the time intervals have equal lengths, except the last two (`TimeGrading`).
The starts of all time intervals except the last are therefore equidistant in mesh time. At these starts
strains and strain rates have the full order of the collocation. The trigonometric polynomial in mesh time
through strains and strain rates converges spectrally; extrema are computed from this polynomial. Means are
integrals by the quadrature of the collocation.
"""

from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from math import nan

import numpy as np

from ...arrays import Array, Complex, list_of
from ...discretization.elements.elements import ELEMENT_SETTINGS
from ...discretization.elements.mesh import Mesh, shape_from_strains
from ...discretization.elements.quadrature import lobatto_points
from ...discretization.elements.trigonometric import (
    fourier_coefficients,
    hermite_fourier_coefficients,
    hermite_fourier_coefficients_of_columns,
    series_samples,
    time_of_rise_through_mean,
)
from ...discretization.stress.tip_motion import tip_matrices
from .compiled_measures import REFLECTION_SIGNS, tip_path, write_powers
from .least_stretch import least_stretch_between_nodes
from .orbit import Orbit
from .time_grading import fourier_coefficients_in_time, samples_in_time


@dataclass(frozen=True, eq=False, kw_only=True)
class CycleMeasures:
    """Scalar measures and harmonics of a cycle, with the names in the result file; NaN if unknown.

    period: in tau2. frequency: 2 pi/period. tip_...: extrema of the tip's x, y, in L; tip_theta_max: largest
    |theta|, in rad, which is equal for a cycle and its mirror image. harmonic_amplitude: amplitudes of the
    harmonics of the tip's y from the first, (harmonics,), in L. injection_..., dissipation_...: mean of the
    power, and rms of its fluctuation, in k3/(L tau2). energy_imbalance: mean injection/mean dissipation - 1.
    least_stretch: smallest h1 at the nodes; if it is small, also between the nodes
    (`least_stretch_between_nodes`)."""

    period: float = nan
    frequency: float = nan
    tip_x_min: float = nan
    """Smallest x of the tip over the period, in L."""
    tip_x_max: float = nan
    """Largest x of the tip over the period, in L."""
    tip_y_max: float = nan
    """Largest y of the tip over the period, in L."""
    tip_y_min: float = nan
    """Smallest y of the tip over the period, in L."""
    tip_theta_max: float = nan
    harmonic_amplitude: Array = field(default_factory=lambda: np.array(nan))
    injection_mean: float = nan
    """Mean power of the follower force over the period, in k3/(L tau2)."""
    injection_rms: float = nan
    """Rms of the fluctuation of the power of the follower force about its mean, in k3/(L tau2)."""
    dissipation_mean: float = nan
    """Mean power lost by drag over the period, in k3/(L tau2)."""
    dissipation_rms: float = nan
    """Rms of the fluctuation of the power lost by drag about its mean, in k3/(L tau2)."""
    energy_imbalance: float = nan
    least_stretch: float = nan


class CycleMotion:
    """Motion of `orbit` over its whole period, as trigonometric polynomials. tip_samples: (x, y, theta) of
    the tip at equidistant times of the period, (m, 3). last_tip_coefficients: all Fourier coefficients of the
    tip's (x, y, theta) in mesh time, a variable in which the time intervals have equal lengths
    (`TimeGrading`), (count, 3); the size of the last of them measures the error of the polynomials."""

    def __init__(self, orbit: Orbit) -> None:
        self.orbit = orbit
        mesh = orbit.form.mesh
        self._equidistant_states = np.ascontiguousarray(orbit.states_equidistant_in_mesh_time)
        matrices = tip_matrices(mesh)
        self._time_scales = orbit.period * orbit.time_slopes_by_mesh_time
        self._path = tip_path(self._equidistant_states, self._time_scales, orbit.orbit_equations, matrices)
        self.last_tip_coefficients = self._path.tip_coefficients
        self.tip_samples = (
            self._path.tip_samples
            if orbit.grading.is_uniform
            else samples_in_time(self._path.tip_coefficients, orbit.grading, self._solved_parts_per_period)
        )

    @property
    def _solved_parts_per_period(self) -> int:
        return self.orbit.symmetry.solved_parts_per_period

    def _coefficients_in_time(self, c: Complex) -> Complex:
        """Fourier coefficients in time, (count, ...), from Fourier coefficients c in mesh time, (count, ...).
        Mesh time: variable in which the time intervals have equal lengths (`TimeGrading`)."""
        return fourier_coefficients_in_time(c, self.orbit.grading, self._solved_parts_per_period)

    @cached_property
    def tip_coefficients(self) -> Complex:
        """Fourier coefficients in time of the tip's (x, y, theta), the mean first, (count, 3)."""
        if self.orbit.grading.is_uniform:
            return self._path.tip_coefficients
        return fourier_coefficients(self.tip_samples)

    @cached_property
    def strain_coefficients(self) -> Complex:
        """Fourier coefficients in time of (h1, h2, Pi) at the nodes of every element, the mean first, (count,
        3, nodes + elements)."""
        K, size = self._path.strains_and_rates.shape[2:]
        values, slopes = self._path.strains_and_rates.swapaxes(1, 2).reshape(2, K, 3 * size)
        signs = np.repeat(REFLECTION_SIGNS if self.orbit.is_symmetric else np.zeros(3), size)
        c = self._coefficients_in_time(hermite_fourier_coefficients_of_columns(values, slopes, signs))
        return c.reshape(len(c), 3, size)

    @property
    def tip_angle_harmonic_sizes(self) -> Array:
        """Amplitude, in rad, of each harmonic of the tip's theta, from the first harmonic on, (count - 1,),
        count: number of Fourier coefficients with the mean."""
        sizes: Array = np.abs(self.tip_coefficients[1:, 2])
        return sizes

    @cached_property
    def curvature_harmonic_sizes(self) -> Array:
        """Size of each harmonic of the curvature Pi, from the first harmonic on, (count - 1,), count: number
        of Fourier coefficients with the mean. Size: square root of the sum of squared moduli over the nodes
        of all elements."""
        values, slopes = self._path.strains_and_rates[:, 2]
        signs = np.full(values.shape[1], REFLECTION_SIGNS[2] * self.orbit.is_symmetric)
        c = self._coefficients_in_time(hermite_fourier_coefficients_of_columns(values, slopes, signs))
        sizes: Array = np.linalg.norm(c[1:], axis=1)
        return sizes

    def tip_x_y_theta_from_orbit_start(self, sample_count: int) -> Array:
        """(x, y, theta) of the tip at `sample_count` equidistant times of a period from the start of the
        orbit, (samples, 3)."""
        return series_samples(self.tip_coefficients, sample_count)

    @cached_property
    def tip_extrema(self) -> dict[str, float]:
        """Extrema of the tip over the period: tip_x_min, tip_x_max, tip_y_max and tip_theta_max, by name."""
        minima = list_of(self._path.least_tip_values)
        maxima = list_of(self._path.largest_tip_values)
        return {
            "tip_x_min": minima[0],
            "tip_x_max": maxima[0],
            "tip_y_max": maxima[1],
            # In a symmetric orbit both sides have the same largest angle up to rounding.
            "tip_theta_max": maxima[2] if self.orbit.is_symmetric else max(maxima[2], -minima[2]),
        }

    @cached_property
    def measures(self) -> "CycleMeasures":
        """Result of `measures_of` for this motion. The computation of the smallest stretch may take as long
        as a whole step along a branch."""
        return measures_of(self)

    @property
    def tip_y_min(self) -> float:
        """Smallest y of the tip, in L; for a symmetric orbit minus the largest y."""
        return (
            -self.tip_extrema["tip_y_max"]
            if self.orbit.is_symmetric
            else float(self._path.least_tip_values[1])
        )

    @property
    def time_of_largest_y(self) -> float:
        """Time of the largest sample of the tip's y, counted from the start of the orbit, in periods."""
        return int(self.tip_samples[:, 1].argmax()) / len(self.tip_samples)

    @cached_property
    def tip_y_mean_crossing_time(self) -> float:
        """Time at which the tip's y rises through its mean, counted from the start of the orbit, in
        periods."""
        return time_of_rise_through_mean(self.tip_samples[:, 1])

    def tip_x_y_theta_from_mean_crossing(self, sample_count: int) -> Array:
        """(x, y, theta) of the tip at `sample_count` equidistant times of a period from
        `tip_y_mean_crossing_time`, (3, samples)."""
        return self._series_from_mean_crossing(self.tip_coefficients, sample_count).T

    def energy_and_powers_from_mean_crossing(self, sample_count: int) -> Array:
        """(elastic energy U in k3/L, injected power, dissipated power, both in k3/(L tau2)) at `sample_count`
        equidistant times of a period from `tip_y_mean_crossing_time`, (3, samples)."""
        period = self.orbit.period
        # Factors of the time derivative of Fourier coefficients.
        derivative_factors = 2j * np.pi / period * np.arange(len(self.tip_coefficients))
        theta = self.tip_x_y_theta_from_mean_crossing(sample_count)[2]
        dx, dy, _ = self._series_from_mean_crossing(
            derivative_factors[:, None] * self.tip_coefficients, sample_count
        ).T
        # Power of the follower force: F along -e1 of the tip, times the tip's velocity.
        injection = -self.orbit.form.rod.F * (np.cos(theta) * dx + np.sin(theta) * dy)
        U = self.orbit.form.elastic_energy(self._equidistant_states)
        powers = np.empty((2, len(self._equidistant_states)))
        write_powers(self._equidistant_states, powers, self.orbit.orbit_equations)
        energy_rates = (powers[0] - powers[1]) * self._time_scales
        if self.orbit.is_symmetric:
            # Energy and power are even under the reflection, so they repeat after half a period.
            U = np.tile(U, 2)
            energy_rates = np.tile(energy_rates, 2)
        c = self._coefficients_in_time(hermite_fourier_coefficients(U, energy_rates))
        U, energy_rate = self._series_from_mean_crossing(
            np.stack([c, derivative_factors[: len(c)] * c], axis=1), sample_count
        ).T
        # The energy balance holds to rounding error: dissipation is injection minus dU/dt.
        return np.stack([U, injection, injection - energy_rate])

    def shapes_from_mean_crossing(self, time_count: int, node_count: int) -> Array:
        """(x, y, theta) of the rod at `time_count` equidistant times of a period from
        `tip_y_mean_crossing_time` and at `node_count` Lobatto nodes, (3, times, nodes)."""
        strains = self._series_from_mean_crossing(self.strain_coefficients, time_count).swapaxes(0, 1)
        mesh = self.orbit.form.mesh
        return shape_from_strains(
            mesh, np.ascontiguousarray(strains), np.zeros(3)
        ) @ _matrix_to_lobatto_nodes(mesh, node_count)

    def _series_from_mean_crossing(self, c: Complex, sample_count: int) -> Array:
        """Re sum_k c_k exp(2 pi i k t) at `sample_count` equidistant times t of a period from
        `tip_y_mean_crossing_time`, (samples, ...). c: Fourier coefficients c_k, (coefficients, ...)."""
        phase_factors = np.exp(2j * np.pi * self.tip_y_mean_crossing_time * np.arange(len(c)))
        return series_samples(c * phase_factors.reshape(-1, *(1,) * (c.ndim - 1)), sample_count)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _matrix_to_lobatto_nodes(mesh: Mesh, node_count: int) -> Array:
    """Matrix, (nodes of `mesh`, nodes): values at all nodes of the mesh `mesh` times this matrix are the
    values at `node_count` Lobatto nodes of the rod."""
    return mesh.evaluation_matrix(lobatto_points(node_count)).T


def measures_of(motion: CycleMotion) -> CycleMeasures:
    """Scalar measures and harmonics of the orbit of `motion`."""
    orbit = motion.orbit
    tip_y_coefficients = motion.tip_coefficients[:, 1]
    means = orbit.mean_powers_and_least_stretch
    return CycleMeasures(
        period=orbit.period,
        frequency=2 * np.pi / orbit.period,
        **motion.tip_extrema,
        tip_y_min=motion.tip_y_min,
        harmonic_amplitude=np.abs(tip_y_coefficients[1:]),
        energy_imbalance=means.injection_mean / means.dissipation_mean - 1,
        **(means._asdict() | {"least_stretch": least_stretch_between_nodes(motion, means.least_stretch)}),
    )


def least_stretch_of_orbit(orbit: Orbit) -> float:
    """Smallest h1 of an orbit over rod and period; if it is small at the nodes, also between the nodes."""
    return least_stretch_between_nodes(CycleMotion(orbit), orbit.form.least_stretch(orbit.all_states))
