"""Interpolation and differentiation with Lagrange polynomials on given nodes, in barycentric form."""

from functools import cache

import numpy as np

from ...arrays import Array
from .quadrature import gauss_legendre_rule, gauss_lobatto_rule


def barycentric_weights(nodes: Array) -> Array:
    """Barycentric weights 1/prod_(j != i) (x_i - x_j) of nodes x, (n,), scaled to a largest modulus of 1."""
    difference = nodes[:, None] - nodes[None, :]
    np.fill_diagonal(difference, 1.0)
    # A product of many differences would underflow. Only ratios of weights are used, so the weights are
    # scaled.
    logarithm = -np.log(np.abs(difference)).sum(axis=1)
    return np.sign(difference).prod(axis=1) * np.exp(logarithm - logarithm.max())


def lagrange_interpolation_matrix(nodes: Array, points: Array) -> Array:
    """Matrix (m, n) from values at `nodes`, (n,), to values of the interpolant at `points`, (m,)."""
    difference = points[:, None] - nodes[None, :]
    coincides = difference == 0
    difference[coincides] = 1.0
    matrix = barycentric_weights(nodes) / difference
    # Second barycentric form: common factors cancel, and constants are reproduced exactly.
    matrix /= matrix.sum(axis=1, keepdims=True)
    is_node = coincides.any(axis=1)
    matrix[is_node] = coincides[is_node]
    return matrix


def differentiation_matrix(nodes: Array) -> Array:
    """Matrix (n, n) from values at `nodes`, (n,), to derivatives of the interpolant at the nodes; rows sum to
    0."""
    weights = barycentric_weights(nodes)
    difference = nodes[:, None] - nodes[None, :]
    np.fill_diagonal(difference, 1.0)
    matrix = weights[None, :] / weights[:, None] / difference
    np.fill_diagonal(matrix, 0.0)
    # With this diagonal the derivative of a constant is exactly 0; the formula for the diagonal has larger
    # rounding errors.
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return matrix


@cache
def lobatto_differentiation_matrix(order: int) -> Array:
    """The differentiation matrix of the Lobatto nodes of an element of order `order` on [-1, 1], (order + 1,
    order + 1)."""
    matrix = differentiation_matrix(gauss_lobatto_rule(order)[0])
    matrix.flags.writeable = False
    return matrix


@cache
def value_and_slope_at_gauss_points(order: int, point_count: int) -> tuple[Array, Array]:
    """Returns (value matrix, slope matrix), (points, order + 1) each: matrices from values at the Lobatto
    nodes of an element of order `order` on [-1, 1] to values and slopes at `point_count` Gauss points."""
    nodes, _ = gauss_lobatto_rule(order)
    value = lagrange_interpolation_matrix(nodes, gauss_legendre_rule(point_count)[0])
    slope = value @ lobatto_differentiation_matrix(order)
    value.flags.writeable = slope.flags.writeable = False
    return value, slope
