"""What is measured on a cycle: extrema, harmonics, energy budget, trajectories and shapes.

At the starts of the intervals, equidistant in time, strains and their rates are known to the full order of
the collocation. The trigonometric polynomial through both has spectral accuracy, so that extrema need no
event located. Means are integrals by the method's own quadrature over its stages.
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import nan

import numpy as np

from ...arrays import Array, Complex
from ...discretization.mesh import configuration
from ...discretization.periodic import (
    hermite_coefficients,
    maxima,
    rise_through_mean,
    sampled_at,
    samples_of,
)
from ...discretization.quadrature import lobatto_points
from .condensation import powers, strain_rates
from .orbit import Orbit

OVERSAMPLING = 4
"""Samples for each node in time, of which extrema are sought."""
TINY = 1e-30
"""Complex step of a velocity."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Measures:
    """Numbers of a cycle, named as in the file; NaN where there is none.

    period in tau2, frequency = 2 pi/period; tip in L and rad. harmonic_amplitude: in L, of the harmonics of
    the tip's y, from the first. Injection and dissipation: mean and rms of the fluctuation, k3/(L tau2);
    energy_imbalance: mean injection over mean dissipation, less 1. least_stretch: min h1.
    """

    period: float = nan
    frequency: float = nan
    tip_x_min: float = nan
    tip_x_max: float = nan
    tip_y_max: float = nan
    tip_theta_max: float = nan
    harmonic_amplitude: Array = field(default_factory=lambda: np.array(nan))
    injection_mean: float = nan
    injection_rms: float = nan
    dissipation_mean: float = nan
    dissipation_rms: float = nan
    energy_imbalance: float = nan
    least_stretch: float = nan


class CyclePath:
    """An orbit over its whole period as trigonometric polynomials."""

    def __init__(self, orbit: Orbit) -> None:
        self.orbit, form = orbit, orbit.form
        ends = np.concatenate([orbit.start[None], orbit.states[:-1, -1]])
        self._rates = np.empty((3, len(ends), form.mesh.nodes + 1))
        strain_rates(ends, self._rates, orbit.semidiscrete)
        self._strains = form.strains(ends)
        steps = self._strains + 1j * TINY * self._rates
        tip = configuration(form.mesh, steps, np.zeros(3))[..., -1]
        self.tip_coefficients = self._series(tip.real, tip.imag / TINY)

    def _series(self, values: Array, rates: Array) -> Complex:
        """Coefficients over the period, (count, 3, ...), of (x, y, theta) or (h1, h2, Pi), (3, m, ...)."""
        if self.orbit.symmetric:
            signs = np.array([1.0, -1.0, -1.0]).reshape(3, *(1,) * (values.ndim - 1))
            values, rates = (np.concatenate([f, signs * f], axis=1) for f in (values, rates))
        slopes = rates * self.orbit.period
        return hermite_coefficients(values.swapaxes(0, 1), slopes.swapaxes(0, 1))

    @cached_property
    def strain_coefficients(self) -> Complex:
        """Of (h1, h2, Pi) at all nodes, shape (count, 3, nodes + 1)."""
        return self._series(self._strains, self._rates)

    @cached_property
    def tip_samples(self) -> Array:
        """(x, y, theta) of the tip at equidistant times, shape (count, 3)."""
        return samples_of(self.tip_coefficients, OVERSAMPLING * (len(self.tip_coefficients) - 1))

    def resampled_tip(self, count: int) -> Array:
        """`tip_samples` at another number of times, shape (count, 3)."""
        return samples_of(self.tip_coefficients, count)

    def extrema(self) -> dict[str, float]:
        """The tip's extrema as `Measures` names them."""
        columns, signs = [0, 0, 1, 2], np.array([-1.0, 1.0, 1.0, 1.0])
        c, samples = (f[:, columns] * signs for f in (self.tip_coefficients, self.tip_samples))
        x_min, x_max, y_max, theta_max = map(float, maxima(c, samples))
        return {"tip_x_min": -x_min, "tip_x_max": x_max, "tip_y_max": y_max, "tip_theta_max": theta_max}

    def beginning(self) -> float:
        """When the tip's y rises through its mean, in periods."""
        return rise_through_mean(self.tip_samples[:, 1])

    def tip(self, samples: int) -> Array:
        """(x, y, theta) of the tip at equidistant times from `beginning`, (3, samples)."""
        return sampled_at(self.tip_coefficients, self._times(samples)).T

    def energy(self, samples: int) -> Array:
        """(U, injection, dissipation) at equidistant times from `beginning`, (3, samples)."""
        at, period = self._times(samples), self.orbit.period
        times = 2j * np.pi * np.arange(len(self.tip_coefficients))
        x, y, theta = sampled_at(self.tip_coefficients, at).T
        dx, dy, _ = sampled_at(times[:, None] * self.tip_coefficients, at).T / period
        injection = -self.orbit.form.rod.F * (np.cos(theta) * dx + np.sin(theta) * dy)
        ends = np.concatenate([self.orbit.start[None], self.orbit.states[:-1, -1]])
        U, power = self.orbit.form.energy(ends), np.empty((2, len(ends)))
        powers(ends, power, self.orbit.semidiscrete)
        rates = (power[0] - power[1]) * period
        if self.orbit.symmetric:
            U, rates = np.tile(U, 2), np.tile(rates, 2)
        c = hermite_coefficients(U, rates)
        change = sampled_at(times[: len(c)] * c, at) / period
        return np.stack([sampled_at(c, at), injection, injection - change])

    def shapes(self, count: int, nodes: int) -> Array:
        """(x, y, theta) at `count` equidistant times on `nodes` Lobatto nodes, shape (3, count, nodes)."""
        strains = sampled_at(self.strain_coefficients, self._times(count)).swapaxes(0, 1)
        grid = self.orbit.form.mesh
        shape = configuration(grid, np.ascontiguousarray(strains), np.zeros(3))
        return shape @ grid.evaluation(lobatto_points(nodes)).T

    def _times(self, count: int) -> Array:
        return np.asarray(self.beginning() + np.arange(count) / count)


def measures_of(path: CyclePath) -> Measures:
    """The measures of an orbit."""
    orbit, y = path.orbit, path.tip_coefficients[:, 1]
    stages = orbit.states.reshape(-1, orbit.states.shape[-1])
    power = np.empty((2, len(stages)))
    powers(stages, power, orbit.semidiscrete)
    weights = np.tile(orbit.method.weights, len(orbit.states)) / len(orbit.states)
    mean = power @ weights
    rms = np.sqrt((power - mean[:, None]) ** 2 @ weights)
    return Measures(
        period=orbit.period,
        frequency=2 * np.pi / orbit.period,
        **path.extrema(),
        harmonic_amplitude=np.abs(y[1:]),
        injection_mean=float(mean[0]),
        injection_rms=float(rms[0]),
        dissipation_mean=float(mean[1]),
        dissipation_rms=float(rms[1]),
        energy_imbalance=float(mean[0] / mean[1] - 1),
        least_stretch=orbit.form.least_stretch(stages),
    )
