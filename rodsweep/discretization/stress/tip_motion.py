"""Compiled position and velocity of the tip from strains and strain rates.

theta(1) = int Pi, r(1) = int R(theta) (h1, h2), where R(theta) is the rotation by theta, and the time
derivatives of both integrals. Positions of all nodes are computed in `elements.mesh`.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled_for_vectors
from ..elements.elements import ELEMENT_SETTINGS, Elements
from ..elements.mesh import shape_integration_matrices


class TipMatrices(NamedTuple):
    """Matrices that integrate strains to the position of the tip, on one element [0, 1] with p + 1 nodes.

    values_at_gauss_points: interpolation from nodes to g Gauss points, (p + 1, g). angles_at_gauss_points:
    integrals of nodal polynomials from 0 to the Gauss points, (p + 1, g). gauss_weights: Gauss weights, (g,).
    element_integrals: integrals of nodal polynomials over the element, (p + 1,). element_lengths: lengths of
    all elements, (elements,)."""

    values_at_gauss_points: Array
    angles_at_gauss_points: Array
    gauss_weights: Array
    element_integrals: Array
    element_lengths: Array


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def tip_matrices(grid: Elements) -> TipMatrices:
    """The `TipMatrices` of a mesh, cached."""
    m = shape_integration_matrices(grid.order)
    parts = (
        m.values_at_gauss_points,
        m.angles_at_gauss_points,
        m.integrals_to_nodes[:, -1],
        m.angles_at_nodes[:, -1],
        grid.lengths,
    )
    return TipMatrices(*map(np.ascontiguousarray, parts))


@compiled_for_vectors
def write_tip_motion(strains: Array, rates: Array, m: TipMatrices, tip: Array, velocity: Array) -> None:
    """Writes (x, y, theta) of the tip, in L and rad, into tip, and the time derivative of (x, y, theta) into
    velocity.

    strains: (h1, h2, Pi) at the nodes of every element, (3, states, elements (p + 1)). rates: time
    derivatives of the strains, of the same shape. tip, velocity: (states, 3). The rod is clamped at the
    origin along e_x.
    """
    size = len(m.element_integrals)
    points = len(m.gauss_weights)
    fields = np.empty((6, points))  # h1, h2, theta and their rates at the Gauss points
    for k in range(strains.shape[1]):
        x = 0.0
        y = 0.0
        theta = 0.0
        dx = 0.0
        dy = 0.0
        turn = 0.0
        for e in range(len(m.element_lengths)):
            first = e * size
            length = m.element_lengths[e]
            here = slice(first, first + size)
            _write_fields_at_gauss_points(strains[:, k, here], m, length, theta, fields[:3])
            _write_fields_at_gauss_points(rates[:, k, here], m, length, turn, fields[3:])
            for g in range(points):
                cos = np.cos(fields[2, g])
                sin = np.sin(fields[2, g])
                w = length * m.gauss_weights[g]
                u = w * (cos * fields[0, g] - sin * fields[1, g])
                v = w * (sin * fields[0, g] + cos * fields[1, g])
                x = x + u
                y = y + v
                # d/dt of R(theta) h: R(theta) times the rate of h, plus the rotation of (u, v) with the
                # angular velocity dtheta/dt.
                dx += w * (cos * fields[3, g] - sin * fields[4, g]) - v * fields[5, g]
                dy += w * (sin * fields[3, g] + cos * fields[4, g]) + u * fields[5, g]
            for j in range(size):
                theta += length * m.element_integrals[j] * strains[2, k, first + j]
                turn += length * m.element_integrals[j] * rates[2, k, first + j]
        tip[k, 0] = x
        tip[k, 1] = y
        tip[k, 2] = theta
        velocity[k, 0] = dx
        velocity[k, 1] = dy
        velocity[k, 2] = turn


@compiled_for_vectors
def _write_fields_at_gauss_points(
    nodal: Array, m: TipMatrices, length: float, start: float, fields: Array
) -> None:
    """Writes h1, h2 and theta at the Gauss points of one element into fields, (3, g).

    nodal: (h1, h2, Pi) at the nodes of the element, (3, p + 1). length: length of the element. start: theta
    at the left end of the element.
    """
    fields[:2] = 0.0
    fields[2] = start
    for j in range(len(m.element_integrals)):
        h1 = nodal[0, j]
        h2 = nodal[1, j]
        Pi = nodal[2, j]
        for g in range(len(m.gauss_weights)):
            fields[0, g] += h1 * m.values_at_gauss_points[j, g]
            fields[1, g] += h2 * m.values_at_gauss_points[j, g]
            fields[2, g] += length * Pi * m.angles_at_gauss_points[j, g]
