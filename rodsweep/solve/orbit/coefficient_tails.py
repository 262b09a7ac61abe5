"""Tails of an orbit: sizes of its last Legendre coefficients in space and in time, which measure the
truncation error.

The errors of period and largest deflection are of the order of the squared tails, because these two
quantities converge twice as fast as the states.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from ...arrays import Array
from ...determinant.exponents import EXPONENT_SETTINGS
from ...discretization.elements.elements import ELEMENT_SETTINGS
from ...discretization.elements.mesh import uniform_mesh
from ...discretization.elements.time_collocation import radau_method
from ...discretization.state_layout import SE2_DIMENSION, stress_index
from ...discretization.stresses_at_jumps import stresses_by_element
from ...model.compiled.compilation import compiled_with_reordered_sums
from ...model.compiled.kernel_constants import KernelConstants
from .orbit import Orbit


@dataclass(frozen=True, slots=True, kw_only=True)
class CoefficientTailSettings(KernelConstants):
    """Settings for the tails of an orbit and for the decay of its coefficients."""

    min_log_decay_per_order: float = 0.2
    """Lower limit of the measured decay of the coefficients in space, as the natural logarithm per order."""
    max_log_decay_per_order: float = 1.2
    """Upper limit of the measured decay of the coefficients in space, as the natural logarithm per order."""
    min_coefficient_ratio: float = 1e-16
    """Coefficients smaller than this number times the largest coefficient are replaced by this limit in the
    measurement of the decay."""
    last_coefficient_count: int = 4
    """Number of last coefficients in space whose norm is the tail of `smooth_space_and_time_tails`; the norm
    of this many coefficients changes smoothly along a branch."""


COEFFICIENT_TAIL_SETTINGS = CoefficientTailSettings()


@dataclass(frozen=True, slots=True)
class CoefficientTails:
    """Tails of an orbit. space_tail: size of the last Legendre coefficients in space, divided by the largest
    coefficient. time_tail: size of the last coefficient in time, divided by the largest value.
    log_coefficient_decay_per_order: decrease of the natural logarithm of the coefficients in space per
    order."""

    space_tail: float
    time_tail: float
    log_coefficient_decay_per_order: float


def coefficient_tails_of(orbit: Orbit) -> CoefficientTails:
    """Tails of `orbit` in space and in time, and decay of its coefficients in space."""
    coefficients = largest_coefficients_of_elements(orbit)
    scales = np.max([c.max(axis=1) for c in coefficients], axis=0)
    # Two coefficients, because the last coefficient may vanish by parity.
    end_norms = np.max([np.hypot(c[:, -1], c[:, -2]) for c in coefficients], axis=0)
    last_coefficients = end_norms / np.maximum(scales, EXPONENT_SETTINGS.min_divisor)
    # Only elements of the full order have coefficients of all orders.
    highest_order_coefficients = np.array(
        [c for c in coefficients if c.shape[1] == orbit.form.mesh.order + 1]
    ).max(axis=0)
    return CoefficientTails(
        float(last_coefficients.max()),
        float(time_tails_of_intervals(orbit).max()),
        _coefficient_log_decay_per_order(highest_order_coefficients),
    )


@compiled_with_reordered_sums
def _coefficient_log_decay_per_order(c: Array) -> float:
    """Decay of coefficients: minus the slope, per order, of the natural logarithm of their envelope, fitted
    over the upper half of the orders and limited to `COEFFICIENT_TAIL_SETTINGS.min_log_decay_per_order` ...
    `COEFFICIENT_TAIL_SETTINGS.max_log_decay_per_order`. c: moduli of the coefficients of orders 0 to p,
    (fields, p + 1)."""
    fields, size = c.shape
    middle = (size - 1) / 2 + (size // 2) / 2
    envelope = COEFFICIENT_TAIL_SETTINGS.min_coefficient_ratio
    slope_sum = 0.0
    squares = 0.0
    # From the last coefficient down: `envelope` is the running maximum, on which single zeros have no effect.
    for k in range(size - 1, size // 2 - 1, -1):
        for a in range(fields):
            envelope = max(envelope, c[a, k] / max(c[a].max(), EXPONENT_SETTINGS.min_divisor))
        slope_sum += (k - middle) * np.log(envelope)
        squares += (k - middle) ** 2
    # Slope of the least-squares line through the logarithms.
    return min(
        max(-slope_sum / squares, COEFFICIENT_TAIL_SETTINGS.min_log_decay_per_order),
        COEFFICIENT_TAIL_SETTINGS.max_log_decay_per_order,
    )


def largest_coefficients_of_elements(orbit: Orbit) -> list[Array]:
    """For each element, the Legendre coefficients in space of n1, n2 and m3: the largest moduli over the ends
    of all time intervals, (3, p + 1), p: order of the element."""
    end_states = np.ascontiguousarray(orbit.stage_states[:, -1])
    return [
        largest_coefficients_over_states(values, _analysis_matrix_on_element(values.shape[2] - 1))
        for values in _stresses_of_elements(orbit, end_states)
    ]


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _analysis_matrix_on_element(order: int) -> Array:
    """Matrix, (p + 1, p + 1): a row of values at the nodes of an element of order p times this matrix is the
    row of Legendre coefficients."""
    return np.ascontiguousarray(legendre_analysis_matrix(2 * uniform_mesh(1, order).node_positions - 1).T)


@compiled_with_reordered_sums
def largest_coefficients_over_states(values: Array, analysis: Array) -> Array:
    """Largest moduli of the coefficients of each field in one element over all states, (3, c). values: fields
    at the nodes of the element, (3, m, p + 1), for m states. analysis: matrix from values at the nodes to
    coefficients, (p + 1, c)."""
    components, states, size = values.shape
    count = analysis.shape[1]
    moduli = np.zeros((components, count))
    c = np.empty(count)
    for a in range(components):
        for k in range(states):
            c[:] = 0.0
            for j in range(size):
                for i in range(count):
                    c[i] += values[a, k, j] * analysis[j, i]
            for i in range(count):
                moduli[a, i] = max(moduli[a, i], abs(c[i]))
    return moduli


def smooth_space_and_time_tails(orbit: Orbit) -> Array:
    """The largest of the tails in space and the tail in time, (2,), from `smooth_element_and_time_tails`."""
    tails = smooth_element_and_time_tails(orbit)
    return np.array([tails[:-1].max(), tails[-1]])


def smooth_element_and_time_tails(orbit: Orbit) -> Array:
    """Tail in space of each element, then the tail in time, (elements + 1,), each divided by the largest
    value of the field. These tails change smoothly along a branch, because a tail in space is the norm of
    `COEFFICIENT_TAIL_SETTINGS.last_coefficient_count` coefficients: a single coefficient may vanish."""
    stresses = _stresses_of_elements(orbit, orbit.all_states)
    max_stress = np.max([np.abs(values).max(axis=(1, 2)) for values in stresses], axis=0)
    end_norms = np.array(
        [
            largest_coefficient_norms(values, _last_columns_of_analysis_matrix(values.shape[2] - 1))
            for values in stresses
        ]
    )
    space_tails = (end_norms / np.maximum(max_stress, EXPONENT_SETTINGS.min_divisor)).max(axis=1)
    return np.append(space_tails, time_tails_of_intervals(orbit).max())


def _stresses_of_elements(orbit: Orbit, states: Array) -> list[Array]:
    """n1, n2 and m3 at the nodes of each element, (3, m, p + 1) each, p: order of the element. states: states
    of `orbit`, (m, n)."""
    form = orbit.form
    S = form.stresses(states)
    if form.has_continuous_stresses:
        return [np.ascontiguousarray(S[..., nodes]) for nodes in form.mesh.node_ranges]
    fields = stresses_by_element(form.nodal_rod, form.mesh, S)
    return [
        np.ascontiguousarray(fields[..., nodes.start + e : nodes.stop + e])
        for e, nodes in enumerate(form.mesh.node_ranges)
    ]


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _last_columns_of_analysis_matrix(order: int) -> Array:
    """Last columns of `_analysis_matrix_on_element`, (p + 1,
    `COEFFICIENT_TAIL_SETTINGS.last_coefficient_count`)."""
    return np.ascontiguousarray(
        _analysis_matrix_on_element(order)[:, -COEFFICIENT_TAIL_SETTINGS.last_coefficient_count :]
    )


@compiled_with_reordered_sums
def largest_coefficient_norms(values: Array, analysis: Array) -> Array:
    """Largest 2-norm of the coefficients of each field in one element over all states, (3,). values: fields
    at the nodes of the element, (3, m, p + 1), for m states. analysis: matrix from values at the nodes to
    coefficients, (p + 1, c)."""
    components, states, size = values.shape
    norms = np.zeros(components)
    c = np.empty(analysis.shape[1])
    for a in range(components):
        for k in range(states):
            c[:] = 0.0
            for j in range(size):
                for i in range(len(c)):
                    c[i] += values[a, k, j] * analysis[j, i]
            norms[a] = max(norms[a], (c * c).sum())
    return np.sqrt(norms)


def time_tails_of_intervals(orbit: Orbit) -> Array:
    """Largest relative tail in time of n1, n2 and m3 in each time interval, (K,) (see
    `relative_tails_in_time`)."""
    tails: Array = relative_tails_in_time(
        orbit.all_states, _last_coefficient_weights(orbit.stage_count), orbit.form.mesh.node_count
    )
    return tails


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_pencils)
def _last_coefficient_weights(stage_count: int) -> Array:
    """Weights, (s + 1,), s = `stage_count`, with which the values at the start and the stages of an interval
    give its last Legendre coefficient."""
    nodes: Array = np.append(0.0, radau_method(stage_count).nodes)
    row: Array = legendre_analysis_matrix(2 * nodes - 1)[-1]
    return row


@compiled_with_reordered_sums
def relative_tails_in_time(points: Array, row: Array, nodes: int) -> Array:
    """Largest relative tail of n1, n2 and m3 in each time interval, (K,): last Legendre coefficient of a
    field in time, divided by the largest value of this field. Coefficients and values are measured by their
    2-norm over all nodes.

    points: states at the start and at all stages, (1 + K s, n). row: as returned by
    `_last_coefficient_weights`, (s + 1,). nodes: number of nodes without the tip."""
    s = len(row) - 1
    tails = np.zeros((len(points) - 1) // s)
    for a in range(SE2_DIMENSION):
        max_value = EXPONENT_SETTINGS.min_divisor
        for m in range(len(points)):
            size = 0.0
            for i in range(nodes):
                size += points[m, stress_index(a, i, nodes)] ** 2
            max_value = max(max_value, size)
        for k in range(len(tails)):
            size = 0.0
            for i in range(nodes):
                top = 0.0
                for j in range(s + 1):
                    top += row[j] * points[k * s + j, stress_index(a, i, nodes)]
                size += top**2
            tails[k] = max(tails[k], np.sqrt(size / max_value))
    return tails


def legendre_analysis_matrix(nodes: Array) -> Array:
    """Matrix, (n, n), that maps values at `nodes`, (n,), in [-1, 1] to Legendre coefficients."""
    return np.linalg.inv(legendre.legvander(nodes, len(nodes) - 1))
