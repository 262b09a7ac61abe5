"""Boundaries between the elements of arms: elements so short that they resolve waves and coefficients."""

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....model.compiled.compilation import compiled
from ...exponents import EXPONENT_SETTINGS
from .settings import ARM_ELEMENT_SETTINGS


@compiled
def element_edges(W: float, squares: Array, tapers: Array, points: Array, breaks: Array) -> Array:
    """Boundaries of elements for |w| <= W, increasing from 0 to 1. The elements between two breaks have equal
    integrals of `_elements_per_length`.

    squares: products of coefficients c2 gamma2 + c3 gamma3, F c3 g, g nu gamma2 c3 and c2 c3 gamma2 gamma3 of
    n arms, (4, n, points), with g = nu + F c2 and c3 = 1/k3. tapers: tapers of the arms, (n,). points:
    midpoints of equal parts of the intervals between breaks, (points,). breaks: breaks of the profile,
    (pieces + 1,). If an interval needs more than `max_elements` elements, or W is not finite, max_elements +
    1 boundaries are returned, all 0.
    """
    density = _elements_per_length(W, squares, tapers, points)
    intervals = len(breaks) - 1
    parts = len(points) // intervals
    edges = [0.0]
    for interval in range(intervals):
        start = breaks[interval]
        part = (breaks[interval + 1] - start) / parts
        interval_density = density[interval * parts : (interval + 1) * parts]
        mass = interval_density.sum() * part
        if not (
            math.inf > W and mass <= ARM_ELEMENT_SETTINGS.max_elements
        ):  # a count of inf or nan is undefined
            return np.zeros(ARM_ELEMENT_SETTINGS.max_elements + 1)
        count = max(1, math.ceil(mass))
        integral = 0.0
        k = 0
        for edge in range(1, count):
            target = mass * edge / count
            while k < parts - 1 and integral + interval_density[k] * part < target:
                integral += interval_density[k] * part
                k += 1
            # The minimum is needed where rounding puts the target just beyond the last part.
            edges.append(start + part * (k + min((target - integral) / (interval_density[k] * part), 1.0)))
        # Exactly on the break: beyond it the coefficients jump.
        edges.append(breaks[interval + 1])
    return np.array(edges)


@compiled
def _elements_per_length(W: float, squares: Array, tapers: Array, points: Array) -> Array:
    """Number of elements per length that the local exponents and the taper require, at the points of n arms,
    (points,). At each point the result is the largest number of all arms. squares: products of coefficients,
    as in `element_edges`, (4, n, points). tapers: (n,). points: (points,)."""
    density = np.empty(len(points))
    for i in range(len(points)):
        waves = 0.0  # an upper bound of |q| for all |w| <= W
        for arm in range(squares.shape[1]):
            drag, load, rate, bend = squares[:, arm, i]
            waves = max(waves, drag * W + abs(load) + 2 * math.sqrt(W * (abs(rate) + bend * W)))
        density[i] = math.sqrt(waves) / ARM_ELEMENT_SETTINGS.max_exponent
        # The smallest taper has the apex nearest to the tip, the largest the apex nearest to the clamp.
        for taper in (tapers.min(), tapers.max()):
            if taper != 1:
                apex_position = 1 / (1 - taper)
                density[i] = max(
                    density[i],
                    1 / (ARM_ELEMENT_SETTINGS.max_length_over_apex_distance * abs(apex_position - points[i])),
                )
    return density


@compiled
def two_sum(a: Array, b: Array) -> tuple[Array, Array]:
    """Returns (a + b rounded to doubles, rounding error of this sum); the two numbers add up to a + b exactly
    (Knuth's two-sum). a, b: of any shapes that broadcast. Near a thin tip the rounding of u alone would
    change the radius, and with it D, by more than all later rounding errors."""
    total = a + b
    rounded_b = total - a
    return total, (a - (total - rounded_b)) + (b - rounded_b)


def edges_with_coarse_elements_halved(edges: Array, W: float, forces: Array, coefficients: Array) -> Array:
    """Boundaries after halving every element that does not resolve the coefficients or, for |w| <= W, the
    exponentials of an arm; `edges` itself if none is halved. forces: F of n arms, (n,). coefficients:
    `LocalCoefficients` of the arms at the Gauss points, (6, n, elements, stages)."""
    stages = ARM_ELEMENT_SETTINGS.stage_count
    is_coarse = _is_coarse_or_exceeds_max_exponent(
        edges,
        W,
        forces,
        coefficients,
        (_highest_legendre_coefficients_matrix(stages), _weights_of_mean(stages)),
    )
    if not is_coarse.any():
        return edges
    midpoints = (edges[:-1] + edges[1:])[is_coarse] / 2
    return np.sort(np.append(edges, midpoints))


@compiled
def _is_coarse_or_exceeds_max_exponent(
    edges: Array, W: float, forces: Array, coefficients: Array, weights: tuple[Array, Array]
) -> NDArray[np.bool_]:
    """Mask of the elements, (elements,), that `_is_coarse` or `_exceeds_max_exponent` selects. edges:
    boundaries of the elements, (elements + 1,). weights: last arguments of `_is_coarse` and of
    `_exceeds_max_exponent`. Other arguments: as in `edges_with_coarse_elements_halved`."""
    is_coarse = _is_coarse(coefficients, weights[0])
    return is_coarse | _exceeds_max_exponent(edges[1:] - edges[:-1], W, forces, coefficients, weights[1])


@cache
def _weights_of_mean(stage_count: int) -> Array:
    """Weights of the mean over an element at its Gauss points, (stages,)."""
    return np.polynomial.legendre.leggauss(stage_count)[1] / 2


@compiled
def _exceeds_max_exponent(
    lengths: Array, W: float, forces: Array, coefficients: Array, weights: Array
) -> NDArray[np.bool_]:
    """Mask of the elements, (elements,), over which an exponent of an arm exceeds `max_exponent` by more than
    the factor `max_exponent_excess_factor`: between the points of `element_edges` an exponent may be much
    larger, as at a thin tip. lengths: lengths of the elements, (elements,). weights: weights of the mean over
    an element, (stages,). Other arguments: as in `edges_with_coarse_elements_halved`."""
    arms, elements, stages = coefficients.shape[1:]
    limit = ARM_ELEMENT_SETTINGS.max_exponent_excess_factor * ARM_ELEMENT_SETTINGS.max_exponent
    is_long = np.zeros(elements, np.bool_)
    for arm in range(arms):
        for e in range(elements):
            exponent = 0.0
            for i in range(stages):
                nu, c2, c3, gamma2, gamma3, g = coefficients[:, arm, e, i]
                drag = c2 * gamma2 + c3 * gamma3
                rate = abs(g * nu * gamma2 * c3) + c2 * c3 * gamma2 * gamma3 * W
                waves = drag * W + abs(forces[arm] * c3 * g) + 2 * math.sqrt(W * rate)
                exponent += lengths[e] * weights[i] * math.sqrt(waves)
            is_long[e] |= not exponent <= limit
    return is_long


@cache
def _highest_legendre_coefficients_matrix(stage_count: int) -> Array:
    """Matrix from values at the Gauss points to the two highest Legendre coefficients, (2, stages)."""
    x, weights = np.polynomial.legendre.leggauss(stage_count)
    last_coefficients = np.polynomial.legendre.legvander(x, stage_count - 1)[:, -2:] * (
        np.arange(stage_count)[-2:] + 0.5
    )
    return np.ascontiguousarray((weights[:, None] * last_coefficients).T)


@compiled
def _is_coarse(coefficients: Array, last_terms: Array) -> NDArray[np.bool_]:
    """Mask of the elements, (elements,), that do not resolve an arm: one of the last two Legendre
    coefficients of nu, c2, c3, gamma2 or gamma3 exceeds `max_coefficient_tail` times its largest value.

    coefficients: coefficients of n arms, (6, n, elements, stages). last_terms: result of
    `_highest_legendre_coefficients_matrix`.
    """
    quantities, arms, elements, stages = coefficients.shape
    is_coarse = np.zeros(elements, np.bool_)
    # The sixth coefficient, g, follows from the other coefficients and the force.
    for q in range(quantities - 1):
        for arm in range(arms):
            for e in range(elements):
                size = EXPONENT_SETTINGS.min_divisor  # a compliance or a drag may be 0
                next_to_last = 0.0
                last = 0.0
                for i in range(stages):
                    value = coefficients[q, arm, e, i]
                    size = max(size, abs(value))
                    next_to_last += value * last_terms[0, i]
                    last += value * last_terms[1, i]
                is_coarse[e] |= (
                    not max(abs(next_to_last), abs(last)) <= ARM_ELEMENT_SETTINGS.max_coefficient_tail * size
                )
    return is_coarse
