"""Compiled position and velocity of the tip from strains and strain rates.

The tip has the angle theta(1) = int Pi and the position r(1) = int R(theta) (h1, h2), where R(theta) is the
rotation by theta; its velocity is the time derivative of both integrals. Positions of all nodes are computed
in `elements.mesh`.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled_with_reordered_sums
from ..elements.elements import ELEMENT_SETTINGS, Elements
from ..elements.mesh import SHAPE_QUADRATURE_SETTINGS, shape_integration_matrices
from ..nodal_rod import IntegerArray


class TipMatrices(NamedTuple):
    """Matrices that integrate strains to the position of the tip, with each element mapped to [0, 1]. m:
    number of nodes of all elements, where a node between two elements counts twice; g: number of Gauss points
    of every element.

    interpolation_to_gauss_points: interpolation from the nodes of an element to its Gauss points, (m, g).
    nodal_integrals_to_gauss_points: integrals of nodal polynomials from 0 to the Gauss points, (m, g).
    gauss_weights: Gauss weights of each element, (elements, g). nodal_polynomial_integrals: integrals of
    nodal polynomials over the element, (m,). element_lengths: lengths of all elements, (elements,).
    element_node_indices: index of the node of the mesh at each node of every element, (m,).
    element_start_indices: index, among the m nodes, of the first node of each element, then m, (elements +
    1,)."""

    interpolation_to_gauss_points: Array
    nodal_integrals_to_gauss_points: Array
    gauss_weights: Array
    nodal_polynomial_integrals: Array
    element_lengths: Array
    element_node_indices: IntegerArray
    element_start_indices: IntegerArray


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def tip_matrices(mesh: Elements) -> TipMatrices:
    """The `TipMatrices` of a mesh, cached."""
    points = mesh.order + SHAPE_QUADRATURE_SETTINGS.extra_point_count
    matrices = [
        shape_integration_matrices(order, points, s)
        for order, s in zip(mesh.orders, mesh.node_spacing_ratio_of_elements, strict=True)
    ]
    return TipMatrices(
        interpolation_to_gauss_points=np.concatenate([m.interpolation_to_gauss_points for m in matrices]),
        nodal_integrals_to_gauss_points=np.concatenate([m.nodal_integrals_to_gauss_points for m in matrices]),
        # Integrals from 0 to the last node span the whole element: they are the Gauss weights.
        gauss_weights=np.array([m.gauss_integrals_to_nodes[:, -1] for m in matrices]),
        nodal_polynomial_integrals=np.concatenate([m.nodal_integrals_to_nodes[:, -1] for m in matrices]),
        element_lengths=np.ascontiguousarray(mesh.lengths),
        element_node_indices=mesh.element_node_indices,
        element_start_indices=np.append(0, np.cumsum([order + 1 for order in mesh.orders])),
    )


@compiled_with_reordered_sums
def write_tip_motion(strains: Array, rates: Array, m: TipMatrices, tip: Array, velocity: Array) -> None:
    """Writes (x, y, theta) of the tip, in L and rad, into tip, and the time derivative of (x, y, theta) into
    velocity. strains: (h1, h2, Pi) at the nodes of every element, (3, states, m). rates: time derivatives of
    the strains, of the same shape. tip, velocity: (states, 3). The rod is clamped at the origin along e_x."""
    points = m.gauss_weights.shape[1]
    fields = np.empty((6, points))  # h1, h2, theta and their rates at the Gauss points
    for k in range(strains.shape[1]):
        x = 0.0
        y = 0.0
        theta = 0.0
        dx = 0.0
        dy = 0.0
        angle_rate = 0.0
        for e in range(len(m.element_lengths)):
            length = m.element_lengths[e]
            _write_fields_at_gauss_points(strains[:, k], m, e, theta, fields[:3])
            _write_fields_at_gauss_points(rates[:, k], m, e, angle_rate, fields[3:])
            for g in range(points):
                cos = np.cos(fields[2, g])
                sin = np.sin(fields[2, g])
                w = length * m.gauss_weights[e, g]
                u = w * (cos * fields[0, g] - sin * fields[1, g])
                v = w * (sin * fields[0, g] + cos * fields[1, g])
                x = x + u
                y = y + v
                # d/dt of R(theta) h: R(theta) times the rate of h, plus the rotation of (u, v) with the
                # angular velocity dtheta/dt.
                dx += w * (cos * fields[3, g] - sin * fields[4, g]) - v * fields[5, g]
                dy += w * (sin * fields[3, g] + cos * fields[4, g]) + u * fields[5, g]
            for j in range(m.element_start_indices[e], m.element_start_indices[e + 1]):
                theta += length * m.nodal_polynomial_integrals[j] * strains[2, k, j]
                angle_rate += length * m.nodal_polynomial_integrals[j] * rates[2, k, j]
        tip[k, 0] = x
        tip[k, 1] = y
        tip[k, 2] = theta
        velocity[k, 0] = dx
        velocity[k, 1] = dy
        velocity[k, 2] = angle_rate


@compiled_with_reordered_sums
def _write_fields_at_gauss_points(
    strains: Array, m: TipMatrices, e: int, start_angle: float, fields: Array
) -> None:
    """Writes h1, h2 and theta at the Gauss points of element e into fields, (3, g). strains: (h1, h2, Pi) at
    the nodes of all elements, (3, m). start_angle: theta at the left end of the element."""
    fields[:2] = 0.0
    fields[2] = start_angle
    length = m.element_lengths[e]
    for j in range(m.element_start_indices[e], m.element_start_indices[e + 1]):
        h1 = strains[0, j]
        h2 = strains[1, j]
        Pi = strains[2, j]
        for g in range(m.gauss_weights.shape[1]):
            fields[0, g] += h1 * m.interpolation_to_gauss_points[j, g]
            fields[1, g] += h2 * m.interpolation_to_gauss_points[j, g]
            fields[2, g] += length * Pi * m.nodal_integrals_to_gauss_points[j, g]
