"""What is measured on a cycle: extrema, harmonics, energy budget, trajectories and shapes.

A cycle comes as N equal steps over one period, and every quantity is the trigonometric polynomial through
its N samples: means are sums, extrema and derivatives have spectral accuracy, and no event needs locating.
"""

from dataclasses import dataclass, field
from math import nan

import numpy as np

from ...arrays import Array
from ...discretization.beam import Beam
from ...discretization.periodic import derivative, maximum, resampled, rise_through_mean
from ...discretization.quadrature import lobatto_points
from ..motion.integrator import Trajectory


@dataclass(frozen=True, eq=False, kw_only=True)
class Measures:
    """Numbers of a cycle, named as in the file; NaN where there is none.

    period in tau2, frequency = 2 pi/period; tip in L and rad. harmonic_amplitude: in L, of the harmonics of
    the tip's y that the steps resolve, from the first. Injection and dissipation: mean and rms of the
    fluctuation, k3/(L tau2); energy_imbalance: mean injection over mean dissipation, less 1. least_stretch:
    min h1.
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


def measures_of(beam: Beam, run: Trajectory) -> Measures:
    """The measures of a run of equal steps over one period."""
    x, y, theta = beam.tip(run.states[:-1])
    powers, period = injection_and_dissipation(beam, run), float(run.times[-1])
    mean, rms = powers.mean(axis=1), powers.std(axis=1)
    return Measures(
        period=period,
        frequency=2 * np.pi / period,
        tip_x_min=-maximum(-x),
        tip_x_max=maximum(x),
        tip_y_max=maximum(y),
        tip_theta_max=maximum(theta),
        harmonic_amplitude=2 * np.abs(np.fft.rfft(y))[1 : (len(y) + 1) // 2] / len(y),
        injection_mean=float(mean[0]),
        injection_rms=float(rms[0]),
        dissipation_mean=float(mean[1]),
        dissipation_rms=float(rms[1]),
        energy_imbalance=float(mean[0] / mean[1] - 1),
        least_stretch=beam.least_stretch(run.states),
    )


def injection_and_dissipation(beam: Beam, run: Trajectory) -> Array:
    """-F v1(1) and <Gamma V, V> of the moving shape at the steps, shape (2, N).

    V = R(theta)^T dr/dt and dtheta/dt are differentiated in time; from the forces they would carry the
    error of z times k1.
    """
    x, y, theta = beam.shape(run.states[:-1])
    dx, dy, spin = (derivative(values) / run.times[-1] for values in (x, y, theta))
    cos, sin = np.cos(theta), np.sin(theta)
    v1, v2 = cos * dx + sin * dy, cos * dy - sin * dx
    density = beam.gamma1 * v1**2 + v2**2 + beam.rod.gamma3 * spin**2
    return np.stack([-beam.rod.F * v1[:, -1], density @ beam.mesh.quadrature])


def traces(beam: Beam, run: Trajectory, samples: int) -> tuple[Array, Array]:
    """(x, y, theta) of the tip and (U, injection, dissipation) at equidistant times, each (3, samples).

    Time starts where the tip's y rises through its mean.
    """
    tip = beam.tip(run.states[:-1])
    energy = np.vstack([beam.energy(run.states[:-1]), injection_and_dissipation(beam, run)])
    at = rise_through_mean(tip[1]) + np.arange(samples) / samples
    return resampled(tip.T, at).T, resampled(energy.T, at).T


def shapes(beam: Beam, run: Trajectory, count: int, nodes: int) -> Array:
    """(x, y, theta) at `count` equidistant times on `nodes` Lobatto nodes, shape (3, count, nodes)."""
    states = run.states[:-1]
    at = rise_through_mean(beam.tip(states)[1]) + np.arange(count) / count
    return beam.shape(resampled(states, at)) @ beam.mesh.evaluation(lobatto_points(nodes)).T
