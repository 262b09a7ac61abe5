"""An orbit's values in units of its size: what is smooth in a parameter up to a Hopf point and through it.

The values that the reflection reverses go as the root of the distance from a Hopf point. In units of the
moment's size at t = 0 they do not, and the square of this size goes as the distance itself. No parameter
enters that size, so that it depends on one by way of the state alone.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...discretization.elements.mesh import Mesh
from ...discretization.state_layout import StateLayout
from ...model.compiled.compilation import compiled_for_vectors
from .orbit import Orbit
from .symmetry import REFLECTION


class Reflected(NamedTuple):
    """Of a state, (n,): 1 where the reflection reverses it and 0 elsewhere, and the weights of m3^2."""

    reversed: Array
    weights: Array


def reflected(orbit: Orbit) -> Reflected:
    """That of an orbit's states."""
    return _reflected(orbit.form.layout, orbit.form.mesh)


@lru_cache(maxsize=64)
def _reflected(layout: StateLayout, mesh: Mesh) -> Reflected:
    return Reflected(REFLECTION.reversed(layout), layout.row({"m3": mesh.quadrature[:-1]}))


def normalised(orbit: Orbit) -> Array:
    """Its values, those that the reflection reverses in units of the size, and the size squared, (N + 1,)."""
    values: Array = normalised_values(orbit.values, reflected(orbit))
    return values


def normalised_tangent(orbit: Orbit, tangent: Array) -> Array:
    """The derivative of the normalised values where that of the values is (N,), (N + 1,)."""
    slopes: Array = normalised_slopes(orbit.values, tangent, reflected(orbit))
    return slopes


@compiled_for_vectors
def normalised_values(values: Array, r: Reflected) -> Array:
    """`normalised` of values, (N,)."""
    squared = squared_size(values, values, r)
    out = np.empty(len(values) + 1)
    out[:-1], out[-1] = values, squared
    _scale_reversed(out, squared**-0.5, r)
    return out


@compiled_for_vectors
def values_of(normalised: Array, r: Reflected) -> Array:
    """The reverse of `normalised_values`, from (N + 1,), whose last one is positive, to (N,)."""
    out = normalised[:-1].copy()
    _scale_reversed(out, normalised[-1] ** 0.5, r)
    return out


@compiled_for_vectors
def polynomial_weights(places: Array, orders: Array, step: float) -> Array:
    """Of data at places, (m,), in what a polynomial through them adds from 0 to a step, (m,).

    orders: 1 where a datum is a slope, 0 where it is a value less the one at 0.
    """
    m, unit = len(places), np.abs(places).max()
    unit = unit if unit > 0 else 1.0
    columns, right = np.empty((m, m)), np.empty(m)
    for power in range(1, m + 1):
        right[power - 1] = (step / unit) ** power
        for i in range(m):
            at = places[i] / unit
            slope = power * at ** (power - 1) / unit
            columns[power - 1, i] = slope if orders[i] == 1 else at**power
    return np.linalg.solve(columns, right)


@compiled_for_vectors
def combined(values: Array, data: Array, orders: Array, weights: Array) -> Array:
    """Values, (N + 1,), and what weights, (m,), add of the slopes and other values in data, (m, N + 1)."""
    out, rest = np.zeros(len(values)), 1.0
    for k in range(len(weights)):
        rest -= weights[k] if orders[k] == 0 else 0.0
        for i in range(len(values)):
            out[i] += weights[k] * data[k, i]
    for i in range(len(values)):
        out[i] += rest * values[i]
    return out


@compiled_for_vectors
def normalised_slopes(values: Array, tangent: Array, r: Reflected) -> Array:
    """`normalised_tangent` of values and their tangent, (N,)."""
    squared, change = squared_size(values, values, r), 2 * squared_size(values, tangent, r)
    out, share = np.empty(len(values) + 1), change / (2 * squared)
    for i in range(len(values)):
        out[i] = tangent[i]
    for first in range(0, len(values) - 1, len(r.reversed)):
        for i in range(len(r.reversed)):
            out[first + i] -= share * r.reversed[i] * values[first + i]
    out[-1] = change
    _scale_reversed(out, squared**-0.5, r)
    return out


@compiled_for_vectors
def squared_size(values: Array, others: Array, r: Reflected) -> float:
    """Of the moment at t = 0, the integral of m3^2, or of its product with that of other values; all (N,)."""
    total = 0.0
    for i in range(len(r.weights)):
        total += r.weights[i] * values[i] * others[i]
    return total


@compiled_for_vectors
def _scale_reversed(values: Array, factor: float, r: Reflected) -> None:
    """What the reflection reverses of the states at the front of values times a factor, in place."""
    n = len(r.reversed)
    for first in range(0, len(values) - n + 1, n):
        for i in range(n):
            values[first + i] *= factor if r.reversed[i] else 1.0
