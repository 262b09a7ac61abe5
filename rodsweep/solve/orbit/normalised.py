"""Values of an orbit in units of its size, which are smooth in a parameter up to and through a Hopf point.

The values that change their sign under reflection grow as the square root of the distance from a Hopf point.
In units of the orbit's size they are smooth, and the squared size grows linearly. The size is that of the
bending moment at t = 0; its definition contains no parameter.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...discretization.elements.elements import ELEMENTS
from ...discretization.elements.mesh import Mesh
from ...discretization.state_layout import StateLayout
from ...model.compiled.compilation import compiled_for_vectors
from .orbit import Orbit
from .symmetry import REFLECTION


class Reflected(NamedTuple):
    """Components of a state that the reflection reverses, and the weights of the norm that defines an orbit's
    size.

    reversed: 1 for components that the reflection reverses, 0 for all others, (n,). weights: quadrature
    weights of m3^2, (n,).
    """

    reversed: Array
    weights: Array


def reflected(orbit: Orbit) -> Reflected:
    """Reflection and weights for the states of `orbit`."""
    return _reflected(orbit.form.layout, orbit.form.mesh)


@lru_cache(maxsize=ELEMENTS.max_meshes)
def _reflected(layout: StateLayout, mesh: Mesh) -> Reflected:
    return Reflected(REFLECTION.reversed(layout), layout.vector({"m3": mesh.quadrature[:-1]}))


def normalised(orbit: Orbit) -> Array:
    """Normalised values of an orbit, (N + 1,): its values, with components that the reflection reverses
    divided by the orbit's size, and the squared size at the end.
    """
    values: Array = normalised_values(orbit.values, reflected(orbit))
    return values


def normalised_tangent(orbit: Orbit, tangent: Array) -> Array:
    """Derivative of an orbit's normalised values by a parameter, (N + 1,), from the derivative `tangent` of
    its values, (N,)."""
    slopes: Array = normalised_slopes(orbit.values, tangent, reflected(orbit))
    return slopes


@compiled_for_vectors
def normalised_values(values: Array, r: Reflected) -> Array:
    """Normalised values, (N + 1,), of an orbit with the values `values`, (N,); compiled."""
    squared = squared_size(values, values, r)
    out = np.empty(len(values) + 1)
    out[:-1] = values
    out[-1] = squared
    _scale_reversed(out, squared**-0.5, r)
    return out


@compiled_for_vectors
def values_of(normalised: Array, r: Reflected) -> Array:
    """Values of an orbit, (N,), from its normalised values, (N + 1,), whose last entry must be positive."""
    out = normalised[:-1].copy()
    _scale_reversed(out, normalised[-1] ** 0.5, r)
    return out


@compiled_for_vectors
def polynomial_weights(places: Array, orders: Array, step: float) -> Array:
    """Weights, (m,), with which m data give p(step) - p(0) for their interpolation polynomial p.

    places: argument of each datum, (m,). orders: 1 for a slope p', 0 for a difference p - p(0), (m,).
    """
    m = len(places)
    # Places in units of the largest keep the Vandermonde matrix well conditioned.
    unit = np.abs(places).max()
    unit = unit if unit > 0 else 1.0
    columns = np.empty((m, m))
    right = np.empty(m)
    for power in range(1, m + 1):
        right[power - 1] = (step / unit) ** power
        for i in range(m):
            at = places[i] / unit
            # Rows demand that the monomials without constant term are reproduced: the result is a change from
            # 0.
            slope = power * at ** (power - 1) / unit
            columns[power - 1, i] = slope if orders[i] == 1 else at**power
    return np.linalg.solve(columns, right)


@compiled_for_vectors
def with_weighted_data(values: Array, data: Array, orders: Array, weights: Array) -> Array:
    """Predictor: the normalised values of an orbit, (N + 1,), plus a weighted sum of slopes and of
    differences of other orbits' values from its values.

    data: slopes, or values of other orbits, (m, N + 1). orders: 1 for a slope, 0 for values, (m,). weights:
    (m,).
    """
    out = np.zeros(len(values))
    rest = 1.0
    for k in range(len(weights)):
        # Weights of values plus the weight of the present values add up to 1; slopes do not count.
        rest -= weights[k] if orders[k] == 0 else 0.0
        for i in range(len(values)):
            out[i] += weights[k] * data[k, i]
    for i in range(len(values)):
        out[i] += rest * values[i]
    return out


@compiled_for_vectors
def normalised_slopes(values: Array, tangent: Array, r: Reflected) -> Array:
    """Derivative of the normalised values, (N + 1,), from an orbit's values and their derivative, (N,) each;
    compiled.
    """
    squared = squared_size(values, values, r)
    change = 2 * squared_size(values, tangent, r)
    # d(v/size) = dv/size - v d(size^2)/(2 size^3), for the reversed components only.
    share = change / (2 * squared)
    out = np.empty(len(values) + 1)
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
    """Integral along the rod, at t = 0, of the product of m3 of the orbits with `values` and `others`, (N,)
    each."""
    total = 0.0
    for i in range(len(r.weights)):
        total += r.weights[i] * values[i] * others[i]
    return total


@compiled_for_vectors
def _scale_reversed(values: Array, factor: float, r: Reflected) -> None:
    """Multiplies the components that the reflection reverses, in all states in `values`, by `factor`, in
    place."""
    n = len(r.reversed)
    for first in range(0, len(values) - n + 1, n):
        for i in range(n):
            values[first + i] *= factor if r.reversed[i] else 1.0
