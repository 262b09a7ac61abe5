"""Compiled functions of the states along an orbit: strains, motion of the tip, mean powers. K: number of
solved states or intervals, s: stages of an interval, n: unknowns of a state."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...arrays import Array, Complex
from ...discretization.element_strains import write_element_strain_rates, write_element_strains
from ...discretization.elements.trigonometric import (
    hermite_fourier_coefficients_of_columns,
    series_maxima,
    series_minima,
    series_samples_of_columns,
)
from ...discretization.nodal_rod import NodalRod
from ...discretization.plane_equations import write_balance
from ...discretization.state_layout import stress_index
from ...discretization.stress.tip_motion import TipMatrices, write_tip_motion
from ...model.compiled.compilation import compiled_with_reordered_sums
from ...model.compiled.kernel_constants import KernelConstants
from ...model.material.jump import LawUnknowns, unknowns_before_jump, unknowns_behind_jump
from .equations import OrbitEquations

REFLECTION_SIGNS = np.array([1.0, -1.0, -1.0])
"""Signs of (x, y, theta), and of the strains (h1, h2, bending strain), under the reflection: half a period
later, a symmetric orbit has the values multiplied by these signs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TipExtremumSettings(KernelConstants):
    """Settings for the extrema of the tip's coordinates over a period."""

    samples_per_time_node: int = 4
    """Number of samples per time node from which the extrema are computed."""


TIP_EXTREMUM_SETTINGS = TipExtremumSettings()


class TipPath(NamedTuple):
    """Path of the tip over a period, and strains, as trigonometric polynomials in the mesh time through the
    states at the time nodes.

    strains_and_rates: strains (h1, h2, bending strain) at the nodes of every element, and the derivatives of
    these strains with respect to the mesh time in periods, for the solved states, (2, 3, K, nodes +
    elements). tip_coefficients: Fourier coefficients of (x, y, theta) of the tip, (count, 3). tip_samples:
    (x, y, theta) at equidistant mesh times of the period, (`TIP_EXTREMUM_SETTINGS.samples_per_time_node`
    (count - 1), 3). least_tip_values, largest_tip_values: smallest and largest (x, y, theta), (3,).
    """

    strains_and_rates: Array
    tip_coefficients: Complex
    tip_samples: Array
    least_tip_values: Array
    largest_tip_values: Array


class MeanPowersAndLeastStretch(NamedTuple):
    """Means and rms fluctuations of the powers over a period, and the smallest h1; names
    and units as in `CycleMeasures`."""

    injection_mean: float
    """Mean power of the follower force over the period, in k3/(L tau2)."""
    injection_rms: float
    """Rms of the fluctuation of the power of the follower force about its mean, in k3/(L tau2)."""
    dissipation_mean: float
    """Mean power lost by drag over the period, in k3/(L tau2)."""
    dissipation_rms: float
    """Rms of the fluctuation of the power lost by drag about its mean, in k3/(L tau2)."""
    least_stretch: float
    """Smallest axial stretch h1 at the nodes, over the states at the stages."""


@compiled_with_reordered_sums
def tip_path(states: Array, time_scales: Array, p: OrbitEquations, m: TipMatrices) -> TipPath:
    """Path of the tip. states: states at equidistant mesh times of the solved part of the period, (K, n):
    half the period for a symmetric orbit, otherwise the period. time_scales: derivatives of the time, in
    tau2, with respect to the mesh time in periods at these states, (K,). p: equations of the orbit. m: result
    of `tip_matrices`."""
    size = len(p.node_matrices.quadrature_weights)
    strains = np.empty((2, 3, len(states), len(m.element_node_indices)))
    tip = np.empty((len(states), 3))
    velocity = np.empty((len(states), 3))
    S = np.empty((3, len(states), size))
    rates = np.empty((3, len(states), size))
    write_node_stresses(states, S)
    write_node_strain_rates(states, rates, p)
    # The series is in the mesh time in periods, so dE/dt is multiplied by dt/dtau.
    for a in range(len(rates)):
        for k in range(len(states)):
            for i in range(size):
                rates[a, k, i] *= time_scales[k]
    write_element_strains(S, p.rod, m.element_node_indices, strains[0])
    write_element_strain_rates(S, rates, p.rod, m.element_node_indices, strains[1])
    write_tip_motion(strains[0], strains[1], m, tip, velocity)
    # For an orbit without symmetry the signs are 0, because its values cover the whole period.
    c = hermite_fourier_coefficients_of_columns(
        tip, velocity, REFLECTION_SIGNS * (p.solved_parts_per_period - 1)
    )
    samples = series_samples_of_columns(c, TIP_EXTREMUM_SETTINGS.samples_per_time_node * (len(c) - 1))
    return TipPath(strains, c, samples, series_minima(c, samples), series_maxima(c, samples))


@compiled_with_reordered_sums
def write_node_stresses(states: Array, out: Array) -> None:
    """Writes the stresses S at all nodes of `states`, (K, n), into `out`, (3, K, nodes + 1)."""
    n = out.shape[2] - 1
    for a in range(len(out)):
        for k in range(len(states)):
            for i in range(n):
                out[a, k, i] = states[k, stress_index(a, i, n)]
            # The stress at the tip is prescribed: its deviation from the straight rod is 0.
            out[a, k, n] = 0.0


@compiled_with_reordered_sums
def mean_powers_and_least_stretch(
    stages: Array, weights: Array, p: OrbitEquations
) -> MeanPowersAndLeastStretch:
    """Means and rms deviations of the powers over a period, and the smallest h1 at the nodes and stages.
    stages: states at the stages, (K, s, n). weights: quadrature weights of the stages, (s,). p: equations of
    the orbit."""
    K, s, n = stages.shape
    states = stages.reshape(K * s, n)
    nodes = len(p.node_matrices.quadrature_weights) - 1
    power = np.empty((2, K * s))
    mean = np.zeros(2)
    square = np.zeros(2)
    write_powers(states, power, p)
    for a in range(2):
        for i in range(K * s):
            mean[a] += weights[i % s] * p.time_interval_lengths[i // s] * power[a, i]
        for i in range(K * s):
            # In a second pass, because mean(P^2) - mean(P)^2 would cancel for a nearly constant power P.
            square[a] += weights[i % s] * p.time_interval_lengths[i // s] * (power[a, i] - mean[a]) ** 2
    stretch = p.rod.straight_state_strain[0, nodes]  # at the tip
    for i in range(K * s):
        for j in range(nodes):
            axial_stress = states[i, stress_index(0, j, nodes)]
            stretch = min(stretch, p.rod.straight_state_strain[0, j] + p.rod.compliance[0, j] * axial_stress)
        # At a jump the node has a mean strain; the smaller of the stretches on the two sides is used.
        for j in range(len(p.rod.jump_nodes)):
            stretch = min(
                stretch,
                _least_stretch_at_jump(
                    states[i], p.rod.jump_nodes[j], p.rod.jump_side_coefficients[j], p.rod
                ),
            )
    return MeanPowersAndLeastStretch(mean[0], np.sqrt(square[0]), mean[1], np.sqrt(square[1]), stretch)


@compiled_with_reordered_sums
def _least_stretch_at_jump(state: Array, node: int, sides: Array, rod: NodalRod) -> float:
    """The smaller h1 of the two sides of a jump of the material at the node with the index `node`. state:
    (n,). sides: material constants on the two sides, (2, 7). rod: material at the nodes."""
    n = rod.straight_state_strain.shape[1] - 1
    q = LawUnknowns(state[stress_index(0, node, n)], state[stress_index(2, node, n)])
    a = unknowns_before_jump(rod.law_number, sides, q)
    b = unknowns_behind_jump(sides, q, a)
    return min(sides[0, 0] + sides[0, 1] * a.q1, sides[1, 0] + sides[1, 1] * b.q1)


@compiled_with_reordered_sums
def write_node_strain_rates(states: Array, out: Array, p: OrbitEquations) -> None:
    """Writes the strain rates dE/dt at all nodes of `states`, (m, n), into `out`, (3, m, nodes + 1); at the
    tip 0 is written. p: equations of the orbit."""
    size = len(p.node_matrices.quadrature_weights)
    V = np.empty((3, size))
    G = np.empty((3, size))
    for k in range(len(states)):
        write_balance(states[k], V, G, p.rod, p.node_matrices)
        for a in range(3):
            for i in range(size - 1):
                out[a, k, i] = G[a, i] / p.node_matrices.quadrature_weights[i]
            # The strain at the tip is constant, as the stress there is prescribed.
            out[a, k, size - 1] = 0.0


@compiled_with_reordered_sums
def write_powers(states: Array, out: Array, p: OrbitEquations) -> None:
    """Writes two powers for `states`, (m, n), into `out`, (2, m): row 0, the power of the follower force,
    computed from the reaction at the tip; row 1, the power lost by drag. p: equations of the orbit."""
    size = len(p.node_matrices.quadrature_weights)
    V = np.empty((3, size))
    G = np.empty((3, size))
    c = p.rod
    for k in range(len(states)):
        write_balance(states[k], V, G, c, p.node_matrices)
        input_power = 0.0
        dissipated_power = 0.0
        for a in range(len(V)):
            input_power -= c.tip_stress[a] * G[a, size - 1]
            for i in range(size):
                dissipated_power += p.node_matrices.quadrature_weights[i] * c.drag[a, i] * V[a, i] ** 2
        out[0, k] = input_power
        out[1, k] = dissipated_power
