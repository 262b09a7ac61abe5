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
from ...discretization.elements.collocation import radau_method
from ...discretization.elements.elements import ELEMENT_SETTINGS
from ...discretization.elements.mesh import uniform_mesh
from ...discretization.state_layout import PLANE_COMPONENT_COUNT, stress_index
from ...discretization.stresses_at_jumps import stresses_by_element
from ...model.compiled.compilation import compiled_for_vectors
from ...model.compiled.settings import CompiledSettings
from .orbit import Orbit


@dataclass(frozen=True, slots=True, kw_only=True)
class CoefficientTailSettings(CompiledSettings):
    """Settings for the tails of an orbit and for the decay of its coefficients."""

    min_decay: float = 0.2
    """Lower limit of the measured decay of the coefficients in space, as the natural logarithm per order."""
    max_decay: float = 1.2
    """Upper limit of the measured decay of the coefficients in space, as the natural logarithm per order."""
    rounding: float = 1e-16
    """Coefficients smaller than this number times the largest coefficient are replaced by this limit in the
    measurement of the decay."""
    last_coefficients: int = 4
    """Number of last coefficients in space whose norm is the tail of `smooth_tails`; the norm of this many
    coefficients changes smoothly along a branch."""


COEFFICIENT_TAIL_SETTINGS = CoefficientTailSettings()


@dataclass(frozen=True, slots=True)
class Tails:
    """Tails of an orbit. space: size of the last Legendre coefficients in space, divided by the largest
    coefficient. time: size of the last coefficient in time, divided by the largest value. space_decay:
    decrease of the natural logarithm of the coefficients in space per order."""

    space: float
    time: float
    space_decay: float


def tails_of(orbit: Orbit) -> Tails:
    """Tails of `orbit` in space and in time, and decay of its coefficients in space."""
    c = _space_coefficients(orbit)
    # Two coefficients, because the last coefficient may vanish by parity.
    last = np.hypot(c[:, -1], c[:, -2]) / np.maximum(c.max(axis=1), EXPONENT_SETTINGS.least_divisor)
    return Tails(float(last.max()), _tail_in_time(orbit), _coefficient_decay(c))


@compiled_for_vectors
def _coefficient_decay(c: Array) -> float:
    """Decay of coefficients: minus the slope, per order, of the natural logarithm of their envelope, fitted
    over the upper half of the orders and limited to `COEFFICIENT_TAIL_SETTINGS.min_decay` ...
    `COEFFICIENT_TAIL_SETTINGS.max_decay`. c: moduli of the coefficients of orders 0 to p, (fields, p + 1)."""
    fields, size = c.shape
    middle = (size - 1) / 2 + (size // 2) / 2
    highest = COEFFICIENT_TAIL_SETTINGS.rounding
    along = 0.0
    squares = 0.0
    # From the last coefficient down: `highest` is an envelope, on which single zeros have no effect.
    for k in range(size - 1, size // 2 - 1, -1):
        for a in range(fields):
            highest = max(highest, c[a, k] / max(c[a].max(), EXPONENT_SETTINGS.least_divisor))
        along += (k - middle) * np.log(highest)
        squares += (k - middle) ** 2
    # Slope of the least-squares line through the logarithms.
    return min(
        max(-along / squares, COEFFICIENT_TAIL_SETTINGS.min_decay), COEFFICIENT_TAIL_SETTINGS.max_decay
    )


def _space_coefficients(orbit: Orbit) -> Array:
    """Largest moduli of the Legendre coefficients in space of n1, n2 and m3, over all elements and the ends
    of all time intervals, (3, p + 1), p: order of the elements."""
    mesh = orbit.form.mesh
    ends = np.ascontiguousarray(orbit.stage_states[:, -1])
    if not orbit.form.has_continuous_stresses:
        c = np.abs(_stresses_by_element(orbit, ends) @ _analysis_matrix_on_element(mesh.order))
        largest: Array = c.max(axis=(1, 2))
        return largest
    return largest_coefficients(ends, mesh.element_count, _analysis_matrix_on_element(mesh.order))


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _analysis_matrix_on_element(order: int) -> Array:
    """Matrix, (p + 1, p + 1): a row of values at the nodes of an element of order p times this matrix is the
    row of Legendre coefficients."""
    return np.ascontiguousarray(legendre_analysis_matrix(2 * uniform_mesh(1, order).node_positions - 1).T)


@compiled_for_vectors
def largest_coefficients(states: Array, elements: int, analysis: Array) -> Array:
    """Largest moduli of the Legendre coefficients in space of n1, n2 and m3, (3, p + 1), p: order of the
    elements, over all elements and all `states`, (m, n). elements: number of elements. analysis: as returned
    by `_analysis_matrix_on_element`."""
    size = len(analysis)
    nodes = elements * (size - 1)
    largest = np.zeros((PLANE_COMPONENT_COUNT, size))
    c = np.empty(size)
    for k in range(len(states)):
        for a in range(PLANE_COMPONENT_COUNT):
            for e in range(elements):
                first = stress_index(a, e * (size - 1), nodes)
                known = size if e < elements - 1 else size - 1  # at the tip stresses vanish
                c[:] = 0.0
                for j in range(known):
                    stress = states[k, first + j]
                    for i in range(size):
                        c[i] += stress * analysis[j, i]
                for i in range(size):
                    largest[a, i] = max(largest[a, i], abs(c[i]))
    return largest


def smooth_tails(orbit: Orbit) -> Array:
    """Tails in space and in time, (2,), each divided by the largest value of the field. These tails change
    smoothly along a branch, because the tail in space is the norm of
    `COEFFICIENT_TAIL_SETTINGS.last_coefficients` coefficients: a single coefficient may vanish."""
    mesh = orbit.form.mesh
    if not orbit.form.has_continuous_stresses:
        fields = _stresses_by_element(orbit, orbit.all_states)
        ends = np.linalg.norm(fields @ _last_columns_of_analysis_matrix(mesh.order), axis=-1).max(axis=(1, 2))
        largest = np.maximum(np.abs(fields).max(axis=(1, 2, 3)), EXPONENT_SETTINGS.least_divisor)
        in_space = float((ends / largest).max())
    else:
        in_space = largest_tail_in_space(
            orbit.all_states, mesh.element_count, _last_columns_of_analysis_matrix(mesh.order)
        )
    return np.array([in_space, _tail_in_time(orbit)])


def _stresses_by_element(orbit: Orbit, states: Array) -> Array:
    """n1, n2 and m3 at the nodes of each element, (3, m, elements, p + 1), p: order. states: states of
    `orbit`, (m, n)."""
    form = orbit.form
    return stresses_by_element(form.nodal_rod, form.mesh, form.stresses(states))


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _last_columns_of_analysis_matrix(order: int) -> Array:
    """Last columns of `_analysis_matrix_on_element`, (p + 1,
    `COEFFICIENT_TAIL_SETTINGS.last_coefficients`)."""
    return np.ascontiguousarray(
        _analysis_matrix_on_element(order)[:, -COEFFICIENT_TAIL_SETTINGS.last_coefficients :]
    )


@compiled_for_vectors
def largest_tail_in_space(points: Array, elements: int, analysis: Array) -> float:
    """Largest relative tail in space of n1, n2 and m3: 2-norm of the last coefficients of a field in an
    element, divided by the largest modulus of this field.

    points: states, (m, n). elements: number of elements. analysis: matrix from values at the nodes of an
    element to its last coefficients, (p + 1, count), p: order of the elements.
    """
    size, count = analysis.shape
    nodes = elements * (size - 1)
    c = np.empty(count)
    worst = 0.0
    for a in range(PLANE_COMPONENT_COUNT):
        largest = 0.0
        end = 0.0
        for k in range(len(points)):
            for e in range(elements):
                first = stress_index(a, e * (size - 1), nodes)
                known = size if e < elements - 1 else size - 1  # at the tip stresses vanish
                c[:] = 0.0
                for j in range(known):
                    stress = points[k, first + j]
                    largest = max(largest, abs(stress))
                    for i in range(count):
                        c[i] += stress * analysis[j, i]
                end = max(end, (c * c).sum())
        worst = max(worst, np.sqrt(end) / max(largest, EXPONENT_SETTINGS.least_divisor))
    return worst


def _tail_in_time(orbit: Orbit) -> float:
    """Largest relative tail in time of n1, n2 and m3 (see `largest_tail_in_time`)."""
    return largest_tail_in_time(
        orbit.all_states, _last_coefficient_weights(orbit.stage_count), orbit.form.mesh.node_count
    )


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_pencils)
def _last_coefficient_weights(stages: int) -> Array:
    """Weights, (s + 1,), with which the values at the start and the stages of an interval give its last
    Legendre coefficient."""
    nodes: Array = np.append(0.0, radau_method(stages).nodes)
    row: Array = legendre_analysis_matrix(2 * nodes - 1)[-1]
    return row


@compiled_for_vectors
def largest_tail_in_time(points: Array, row: Array, nodes: int) -> float:
    """Largest relative tail in time of n1, n2 and m3: last Legendre coefficient of a field in a time
    interval, divided by the largest value of this field. Coefficients and values are measured by their 2-norm
    over all nodes.

    points: states at the start and at all stages, (1 + K s, n). row: as returned by
    `_last_coefficient_weights`, (s + 1,). nodes: number of nodes without the tip."""
    s = len(row) - 1
    worst = 0.0
    for a in range(PLANE_COMPONENT_COUNT):
        largest = 0.0
        tail = 0.0
        for m in range(len(points)):
            size = 0.0
            for i in range(nodes):
                size += points[m, stress_index(a, i, nodes)] ** 2
            largest = max(largest, size)
        for k in range(0, len(points) - 1, s):
            size = 0.0
            for i in range(nodes):
                top = 0.0
                for j in range(s + 1):
                    top += row[j] * points[k + j, stress_index(a, i, nodes)]
                size += top**2
            tail = max(tail, size)
        worst = max(worst, np.sqrt(tail / max(largest, EXPONENT_SETTINGS.least_divisor)))
    return float(worst)


def legendre_analysis_matrix(nodes: Array) -> Array:
    """Matrix, (n, n), that maps values at `nodes`, (n,), in [-1, 1] to Legendre coefficients."""
    return np.linalg.inv(legendre.legvander(nodes, len(nodes) - 1))
