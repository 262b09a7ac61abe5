"""Lagrange polynomials on given nodes: interpolation and differentiation, in barycentric form."""

import numpy as np

from ...arrays import Array


def barycentric_weights(nodes: Array) -> Array:
    """Weights 1/prod_j (x_i - x_j), scaled to largest modulus 1; shape (n,)."""
    difference = nodes[:, None] - nodes[None, :]
    np.fill_diagonal(difference, 1.0)
    # A product of many differences would underflow; only ratios of weights count.
    logarithm = -np.log(np.abs(difference)).sum(axis=1)
    return np.sign(difference).prod(axis=1) * np.exp(logarithm - logarithm.max())


def interpolation(nodes: Array, points: Array) -> Array:
    """Matrix from values at `nodes` to values at `points`, shape (points, nodes)."""
    difference = points[:, None] - nodes[None, :]
    hit = difference == 0
    difference[hit] = 1.0
    matrix = barycentric_weights(nodes) / difference
    # Second barycentric form: common factors cancel, and constants are reproduced exactly.
    matrix /= matrix.sum(axis=1, keepdims=True)
    on_node = hit.any(axis=1)
    matrix[on_node] = hit[on_node]
    return matrix


def differentiation(nodes: Array) -> Array:
    """Matrix from values at `nodes` to derivatives at `nodes`, shape (n, n); rows sum to zero exactly."""
    weights = barycentric_weights(nodes)
    difference = nodes[:, None] - nodes[None, :]
    np.fill_diagonal(difference, 1.0)
    matrix = weights[None, :] / weights[:, None] / difference
    np.fill_diagonal(matrix, 0.0)
    # The derivative of a constant is 0 to the last bit, which loses less than the formula for the diagonal.
    np.fill_diagonal(matrix, -matrix.sum(axis=1))
    return matrix
