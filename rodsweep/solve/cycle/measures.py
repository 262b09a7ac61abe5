"""What is measured on a cycle: extrema, harmonics, energy budget, trajectories and shapes.

At the starts of the intervals, equidistant in time, strains and their rates are known to the full order of
the collocation. The trigonometric polynomial through both has spectral accuracy, so that extrema need no
event located. Means are integrals by the method's own quadrature over its stages.
"""

from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from math import nan

import numpy as np

from ...arrays import Array, Complex
from ...discretization.mesh import Mesh, configuration
from ...discretization.periodic import (
    hermite_coefficients,
    maxima,
    rise_through_mean,
    samples_of,
)
from ...discretization.quadrature import lobatto_points
from ...discretization.tip_motion import tip_matrices
from .compiled_measures import means, node_motion
from .condensation import powers
from .orbit import Orbit

OVERSAMPLING = 4
"""Samples for each node in time, of which extrema are sought."""
REFLECTION = np.array([1.0, -1.0, -1.0])
"""Signs of (x, y, theta) and (h1, h2, Pi) half a period later where the orbit is symmetric."""


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
    tip_y_min: float = nan
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
        self.orbit, grid = orbit, orbit.form.mesh
        self._ends = np.ascontiguousarray(orbit.regular_states)
        K = len(self._ends)
        self._nodes = np.empty((2, 3, K, grid.nodes + 1))
        tip = np.empty((2, K, 3))
        node_motion(self._ends, orbit.semidiscrete, tip_matrices(grid.elements, grid.order), self._nodes, tip)
        if orbit.symmetric:
            tip = np.concatenate([tip, tip * REFLECTION], axis=1)
        self.tip_coefficients = hermite_coefficients(tip[0], tip[1] * orbit.period)

    def _series(self, strains: slice) -> Complex:
        """Coefficients over the period, (count, strains, nodes + 1), of some of (h1, h2, Pi)."""
        values, rates = self._nodes[:, strains].swapaxes(1, 2)
        if self.orbit.symmetric:
            signs = REFLECTION[strains, None]
            values, rates = (np.concatenate([f, signs * f]) for f in (values, rates))
        return hermite_coefficients(values, rates * self.orbit.period)

    @cached_property
    def strain_coefficients(self) -> Complex:
        """Of (h1, h2, Pi) at all nodes, shape (count, 3, nodes + 1)."""
        return self._series(slice(0, 3))

    @cached_property
    def bending_harmonics(self) -> Array:
        """The size of Pi's harmonics from the first, sums of squares over all nodes, shape (count - 1,)."""
        parts = self._series(slice(2, 3))[1:, 0].view(float)
        return np.sqrt(np.einsum("ki,ki->k", parts, parts))

    @cached_property
    def tip_samples(self) -> Array:
        """(x, y, theta) of the tip at equidistant times, shape (count, 3)."""
        return samples_of(self.tip_coefficients, OVERSAMPLING * (len(self.tip_coefficients) - 1))

    def resampled_tip(self, count: int) -> Array:
        """`tip_samples` at another number of times, shape (count, 3)."""
        return samples_of(self.tip_coefficients, count)

    @cached_property
    def extrema(self) -> dict[str, float]:
        """The tip's extrema as `Measures` names them."""
        c, samples = self.tip_coefficients, self.tip_samples
        x_max, y_max, theta_max = maxima(c, samples).tolist()
        x_min = -float(maxima(-c[:, :1], -samples[:, :1])[0])
        return {"tip_x_min": x_min, "tip_x_max": x_max, "tip_y_max": y_max, "tip_theta_max": theta_max}

    @cached_property
    def tip_y_min(self) -> float:
        """The smallest y of the tip: the largest with the other sign where the orbit is symmetric."""
        if self.orbit.symmetric:
            return -self.extrema["tip_y_max"]
        return -float(maxima(-self.tip_coefficients[:, 1:2], -self.tip_samples[:, 1:2])[0])

    @cached_property
    def beginning(self) -> float:
        """When the tip's y rises through its mean, in periods."""
        return rise_through_mean(self.tip_samples[:, 1])

    def tip(self, samples: int) -> Array:
        """(x, y, theta) of the tip at equidistant times from `beginning`, (3, samples)."""
        return self._sampled(self.tip_coefficients, samples).T

    def energy(self, samples: int) -> Array:
        """(U, injection, dissipation) at equidistant times from `beginning`, (3, samples)."""
        period = self.orbit.period
        times = 2j * np.pi / period * np.arange(len(self.tip_coefficients))
        theta = self.tip(samples)[2]
        dx, dy, _ = self._sampled(times[:, None] * self.tip_coefficients, samples).T
        injection = -self.orbit.form.rod.F * (np.cos(theta) * dx + np.sin(theta) * dy)
        U, power = self.orbit.form.energy(self._ends), np.empty((2, len(self._ends)))
        powers(self._ends, power, self.orbit.semidiscrete)
        rates = (power[0] - power[1]) * period
        if self.orbit.symmetric:
            U, rates = np.tile(U, 2), np.tile(rates, 2)
        c = hermite_coefficients(U, rates)
        U, change = self._sampled(np.stack([c, times[: len(c)] * c], axis=1), samples).T
        return np.stack([U, injection, injection - change])

    def shapes(self, count: int, nodes: int) -> Array:
        """(x, y, theta) at `count` equidistant times on `nodes` Lobatto nodes, shape (3, count, nodes)."""
        strains = self._sampled(self.strain_coefficients, count).swapaxes(0, 1)
        grid = self.orbit.form.mesh
        return configuration(grid, np.ascontiguousarray(strains), np.zeros(3)) @ _at_lobatto(grid, nodes)

    def _sampled(self, c: Complex, count: int) -> Array:
        """Re sum_k c_k exp(2 pi i k t) at equidistant times from `beginning`, shape (count, ...)."""
        turns = np.exp(2j * np.pi * self.beginning * np.arange(len(c)))
        return samples_of(c * turns.reshape(-1, *(1,) * (c.ndim - 1)), count)


@lru_cache(maxsize=64)
def _at_lobatto(grid: Mesh, nodes: int) -> Array:
    """Matrix, applied from the right, from values at all nodes of a mesh to Lobatto nodes of the rod."""
    return grid.evaluation(lobatto_points(nodes)).T


def measures_of(path: CyclePath) -> Measures:
    """The measures of an orbit."""
    orbit, y = path.orbit, path.tip_coefficients[:, 1]
    mean = means(np.ascontiguousarray(orbit.states), orbit.method.weights, orbit.semidiscrete)
    return Measures(
        period=orbit.period,
        frequency=2 * np.pi / orbit.period,
        **path.extrema,
        tip_y_min=path.tip_y_min,
        harmonic_amplitude=np.abs(y[1:]),
        energy_imbalance=mean.injection_mean / mean.dissipation_mean - 1,
        **mean._asdict(),
    )
