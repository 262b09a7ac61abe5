"""Values of an orbit divided by its size, which are smooth functions of a parameter up to and through a Hopf
point.

The values that change sign under the reflection grow as the square root of the distance from a Hopf point.
Divided by the size of the orbit these values are smooth; the squared size grows linearly. The size is the
norm of the bending moment at t = 0, and its definition contains no parameter. N: number of orbit values. r:
arrays of the normalisation (`normalisation_arrays`).
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...discretization.elements.elements import ELEMENT_SETTINGS
from ...discretization.elements.mesh import Mesh
from ...discretization.state_layout import StateLayout
from ...model.compiled.compilation import compiled_with_reordered_sums
from .orbit import Orbit
from .symmetry import REFLECTION


class NormalisationArrays(NamedTuple):
    """Arrays for the normalisation of orbits. reversal_mask: 1 for components of a state that change sign
    under the reflection, 0 for all other components, (n,). moment_quadrature_weights: quadrature weights of
    m3^2 in the squared size, (n,)."""

    reversal_mask: Array
    moment_quadrature_weights: Array


def normalisation_arrays(orbit: Orbit) -> NormalisationArrays:
    """Arrays for the normalisation of `orbit`."""
    return _cached_normalisation_arrays(orbit.form.layout, orbit.form.mesh)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _cached_normalisation_arrays(layout: StateLayout, mesh: Mesh) -> NormalisationArrays:
    return NormalisationArrays(
        REFLECTION.reversal_mask(layout), layout.state_with_stresses({"m3": mesh.quadrature_weights[:-1]})
    )


def normalised_orbit_values(orbit: Orbit) -> Array:
    """Normalised values of an orbit, (N + 1,): the orbit values, in which all components that change sign
    under the reflection are divided by the size of the orbit; at the end, the squared size."""
    values: Array = compiled_normalised_orbit_values(orbit.values, normalisation_arrays(orbit))
    return values


def tangent_of_normalised_orbit(orbit: Orbit, tangent: Array) -> Array:
    """Derivative of `normalised_orbit_values`, (N + 1,), with respect to a parameter; last entry: derivative
    of the squared size. tangent: derivative of the orbit values, (N,)."""
    slopes: Array = compiled_tangent_of_normalised_orbit(orbit.values, tangent, normalisation_arrays(orbit))
    return slopes


@compiled_with_reordered_sums
def compiled_normalised_orbit_values(values: Array, r: NormalisationArrays) -> Array:
    """Compiled `normalised_orbit_values`: normalised values, (N + 1,), of the orbit with the given `values`,
    (N,). r: result of `normalisation_arrays`."""
    squared = start_bending_moment_inner_product(values, values, r)
    out = np.empty(len(values) + 1)
    out[:-1] = values
    out[-1] = squared
    _scale_reversed_components(out, squared**-0.5, r)
    return out


@compiled_with_reordered_sums
def values_from_normalised(normalised: Array, r: NormalisationArrays) -> Array:
    """Values of an orbit, (N,), from its normalised values, (N + 1,), whose last entry must be positive. r:
    result of `normalisation_arrays`."""
    out = normalised[:-1].copy()
    _scale_reversed_components(out, normalised[-1] ** 0.5, r)
    return out


@compiled_with_reordered_sums
def extrapolated_change_weights(arguments: Array, orders: Array, step: float) -> Array:
    """Weights, (m,): p(step) - p(0) is the sum of weights times data, p: interpolation polynomial through m
    data.

    arguments: argument of each datum, (m,). orders: 1 if the datum is a slope p', 0 if it is a difference p -
    p(0), (m,). step: argument at which the polynomial is evaluated.
    """
    m = len(arguments)
    # Arguments are divided by the largest modulus, so that the Vandermonde matrix is well conditioned.
    unit = np.abs(arguments).max()
    unit = unit if unit > 0 else 1.0
    columns = np.empty((m, m))
    right_side = np.empty(m)
    for power in range(1, m + 1):
        right_side[power - 1] = (step / unit) ** power
        for i in range(m):
            scaled_argument = arguments[i] / unit
            # The weights reproduce each monomial; there is no constant term, because the result is a
            # difference.
            slope = power * scaled_argument ** (power - 1) / unit
            columns[power - 1, i] = slope if orders[i] == 1 else scaled_argument**power
    return np.linalg.solve(columns, right_side)


@compiled_with_reordered_sums
def predicted_normalised_values(values: Array, data: Array, orders: Array, weights: Array) -> Array:
    """Predicted normalised values, (N + 1,): normalised values of the current orbit plus a weighted sum of
    data. A datum is a slope, or the difference of another orbit's normalised values from the current values.

    values: normalised values of the current orbit, (N + 1,). data: slopes, or normalised values of other
    orbits, (m, N + 1). orders: 1 for a slope, 0 for values, (m,). weights: weight of each datum in the
    interpolation polynomial, (m,).
    """
    out = np.zeros(len(values))
    weight_of_values = 1.0
    for k in range(len(weights)):
        # The weights of all values, with the weight of the current values, add up to 1.
        weight_of_values -= weights[k] if orders[k] == 0 else 0.0
        for i in range(len(values)):
            out[i] += weights[k] * data[k, i]
    for i in range(len(values)):
        out[i] += weight_of_values * values[i]
    return out


@compiled_with_reordered_sums
def compiled_tangent_of_normalised_orbit(values: Array, tangent: Array, r: NormalisationArrays) -> Array:
    """Compiled `tangent_of_normalised_orbit`: derivative of the normalised values, (N + 1,). values, tangent:
    orbit values and derivative of the orbit values, (N,)."""
    squared = start_bending_moment_inner_product(values, values, r)
    change = 2 * start_bending_moment_inner_product(values, tangent, r)
    # d(v/size) = dv/size - v d(size^2)/(2 size^3), for the reversed components only.
    relative_rate = change / (2 * squared)
    out = np.empty(len(values) + 1)
    for i in range(len(values)):
        out[i] = tangent[i]
    for first in range(0, len(values) - 1, len(r.reversal_mask)):
        for i in range(len(r.reversal_mask)):
            out[first + i] -= relative_rate * r.reversal_mask[i] * values[first + i]
    out[-1] = change
    _scale_reversed_components(out, squared**-0.5, r)
    return out


@compiled_with_reordered_sums
def start_bending_moment_inner_product(values: Array, other_values: Array, r: NormalisationArrays) -> float:
    """Integral over the rod of m3 m3' at t = 0, m3 and m3' from the orbit values `values` and `other_values`,
    (N,). With equal arguments this is the squared size. r: result of `normalisation_arrays`."""
    total = 0.0
    for i in range(len(r.moment_quadrature_weights)):
        total += r.moment_quadrature_weights[i] * values[i] * other_values[i]
    return total


@compiled_with_reordered_sums
def _scale_reversed_components(values: Array, factor: float, r: NormalisationArrays) -> None:
    """Multiplies by `factor`, in place, the components that change sign under the reflection, in all states
    of `values`: orbit values, (N,), or normalised values, (N + 1,). r: marks these components."""
    n = len(r.reversal_mask)
    for first in range(0, len(values) - n + 1, n):
        for i in range(n):
            values[first + i] *= factor if r.reversal_mask[i] else 1.0
