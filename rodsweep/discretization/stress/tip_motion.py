"""Position and velocity of the tip by strains and their rates, compiled; `mesh.configuration` has all nodes.

theta(1) = int Pi, r(1) = int R(theta) (h1, h2), and the derivatives of both by the time.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled_for_vectors
from ..elements.mesh import reconstruction


class TipMatrices(NamedTuple):
    """Interpolation and quadrature on one element of a uniform mesh, with p + 1 nodes and g Gauss points.

    values: interpolation from the nodes to the Gauss points; angles: integrals of nodal polynomials from the
    element's start to the Gauss points; both (p + 1, g). weights: weights of the integral over the element
    at the Gauss points, (g,); ends: weights of this integral at the nodes, (p + 1,).
    """

    values: Array
    angles: Array
    weights: Array
    ends: Array


@lru_cache(maxsize=64)
def tip_matrices(elements: int, order: int) -> TipMatrices:
    """`TipMatrices` of the mesh of `elements` equal elements of order `order`."""
    values, angles, integrals, ends = reconstruction(order)
    parts = values, angles / elements, integrals[:, -1] / elements, ends[:, -1] / elements
    return TipMatrices(*map(np.ascontiguousarray, parts))


@compiled_for_vectors
def tip_motion(strains: Array, rates: Array, m: TipMatrices, tip: Array, velocity: Array) -> None:
    """(x, y, theta) of the tip and its rate into tip and velocity, (states, 3), in L and rad.

    strains, rates: (h1, h2, Pi) at all nodes and their derivatives by the time, (3, states, nodes + 1); the
    clamp is at 0 along e_x.
    """
    size, points = len(m.ends), len(m.weights)
    fields = np.empty((6, points))  # h1, h2, theta and their rates at the Gauss points
    for k in range(strains.shape[1]):
        x, y, theta, dx, dy, turn = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for first in range(0, strains.shape[2] - 1, size - 1):
            here = slice(first, first + size)
            _to_points(strains[:, k, here], m, theta, fields[:3])
            _to_points(rates[:, k, here], m, turn, fields[3:])
            for g in range(points):
                cos, sin, w = np.cos(fields[2, g]), np.sin(fields[2, g]), m.weights[g]
                u = w * (cos * fields[0, g] - sin * fields[1, g])
                v = w * (sin * fields[0, g] + cos * fields[1, g])
                x, y = x + u, y + v
                dx += w * (cos * fields[3, g] - sin * fields[4, g]) - v * fields[5, g]
                dy += w * (sin * fields[3, g] + cos * fields[4, g]) + u * fields[5, g]
            for j in range(size):
                theta += m.ends[j] * strains[2, k, first + j]
                turn += m.ends[j] * rates[2, k, first + j]
        tip[k, 0], tip[k, 1], tip[k, 2] = x, y, theta
        velocity[k, 0], velocity[k, 1], velocity[k, 2] = dx, dy, turn


@compiled_for_vectors
def _to_points(nodal: Array, m: TipMatrices, start: float, fields: Array) -> None:
    """h1, h2 and `start` plus the integral of Pi at the Gauss points, (3, g), from the nodes, (3, p + 1)."""
    fields[:2] = 0.0
    fields[2] = start
    for j in range(len(m.ends)):
        h1, h2, Pi = nodal[0, j], nodal[1, j], nodal[2, j]
        for g in range(len(m.weights)):
            fields[0, g] += h1 * m.values[j, g]
            fields[1, g] += h2 * m.values[j, g]
            fields[2, g] += Pi * m.angles[j, g]
