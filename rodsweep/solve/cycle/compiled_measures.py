"""What is measured state by state along an orbit, compiled: strains, the motion of the tip, mean powers."""

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...discretization.tip_motion import TipMatrices, tip_motion
from ...model.compilation import compiled_for_vectors
from .condensation import Semidiscrete, powers, strain_rates


class Means(NamedTuple):
    """Over an orbit, named and in units as in `Measures`."""

    injection_mean: float
    injection_rms: float
    dissipation_mean: float
    dissipation_rms: float
    least_stretch: float


@compiled_for_vectors
def node_motion(states: Array, p: Semidiscrete, m: TipMatrices, nodes: Array, tip: Array) -> None:
    """Strains and their rates into nodes, (2, 3, K, nodes + 1), the tip and its rate into tip, (2, K, 3).

    states: (K, n). Strains are (h1, h2, Pi), the tip is (x, y, theta), both as in `tip_motion`.
    """
    strains, c, size = nodes[0], p.parameters, len(p.matrices.weights)
    strain_rates(states, nodes[1], p)
    for a, base, compliance in ((0, c.nu, c.c1), (1, 0.0, c.c2), (2, 0.0, 1.0)):
        for k in range(len(states)):
            for i in range(size - 1):
                strains[a, k, i] = base + compliance * states[k, a * (size - 1) + i]
            strains[a, k, size - 1] = base
    tip_motion(strains, nodes[1], m, tip[0], tip[1])


@compiled_for_vectors
def means(stages: Array, weights: Array, p: Semidiscrete) -> Means:
    """The means over all stages, (K, s, n), with the weights of the method, (s,)."""
    K, s, n = stages.shape
    flat, nodes = stages.reshape(K * s, n), len(p.matrices.weights) - 1
    power, mean, square = np.empty((2, K * s)), np.zeros(2), np.zeros(2)
    powers(flat, power, p)
    for a in range(2):
        for i in range(K * s):
            mean[a] += weights[i % s] * p.lengths[i // s] * power[a, i]
        for i in range(K * s):
            square[a] += weights[i % s] * p.lengths[i // s] * (power[a, i] - mean[a]) ** 2
    least = 0.0  # of n1 + F, which vanishes at the tip
    for i in range(K * s):
        for j in range(nodes):
            least = min(least, flat[i, j])
    stretch = p.parameters.nu + p.parameters.c1 * least
    return Means(mean[0], np.sqrt(square[0]), mean[1], np.sqrt(square[1]), stretch)
