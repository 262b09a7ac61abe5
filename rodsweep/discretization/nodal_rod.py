"""One rod at the nodes of a mesh: compliances and drags as arrays over the nodes, for compiled functions."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..model.balance import BalanceCoefficients
from ..model.material.jump import JUMP_SIDE_COLUMNS
from .elements.elements import ELEMENT_SETTINGS
from .elements.mesh import Mesh

IntegerArray = NDArray[np.int64]


class NodalRod(NamedTuple):
    """A rod with d stress components at all nodes of a mesh, tip included: an argument of compiled functions.

    tip_stress: stress Sigma(1), (d,). straight_state_strain: E0, the strain of the straight rod under its
    force, (d, nodes + 1). compliance, drag: (d, nodes + 1). mobility: 1/drag, but 0 for the components of V
    that are unknowns, (d, nodes + 1). mobility_laplacian: -D^T W mobility D with the differentiation matrix D
    and the quadrature weights W, (d, nodes + 1, nodes + 1). unknown_velocity_components: indices of the
    components of V that are unknowns. law_number: number of the constitutive law, see
    `rodsweep.model.material.stress_strain`. jump_nodes: nodes at which the material jumps, increasing, (k,).
    jump_side_coefficients: the material on both sides of each jump, (k, 2, 7), see
    `rodsweep.model.material.jump`.
    """

    tip_stress: Array
    straight_state_strain: Array
    compliance: Array
    drag: Array
    mobility: Array
    mobility_laplacian: Array
    unknown_velocity_components: IntegerArray
    law_number: int
    jump_nodes: IntegerArray
    jump_side_coefficients: Array


class Jumps(NamedTuple):
    """Nodes at which the material jumps, (k,), and the material on both sides of each jump, (k, 2, 7), with
    the columns `JUMP_SIDE_COLUMNS`."""

    jump_nodes: IntegerArray
    """Indices of the nodes at which the material jumps, increasing, (k,)."""
    jump_side_coefficients: Array
    """Material on both sides of each jump, (k, 2, 7), with the columns `JUMP_SIDE_COLUMNS`."""


NO_JUMPS = Jumps(np.zeros(0, np.int64), np.zeros((0, 2, len(JUMP_SIDE_COLUMNS))))
"""Jumps of a rod with a continuous material: arrays of length 0."""
NO_JUMP_DERIVATIVE = np.zeros((0, 2, 3))
"""Derivatives of the material on both sides of jumps, for a rod without jumps or of linear law: no rows."""


class NodalRodDerivative(NamedTuple):
    """Derivatives of fields of a `NodalRod`, of the same shapes, with respect to the coordinate of a
    parameter: 1/k for a stiffness k, else the value."""

    tip_stress: Array
    """Derivative of the stress Sigma(1) at the tip, (d,)."""
    straight_state_strain: Array
    """Derivative of the strain E0 of the straight rod under its force, (d, nodes + 1)."""
    compliance: Array
    """Derivative of the compliances, (d, nodes + 1)."""
    drag: Array
    """Derivative of the drags, (d, nodes + 1)."""
    jump_side_coefficients: Array
    """Derivatives of nu, c1 and c3 on both sides of each jump, (k, 2, 3)."""


def nodal_rod(
    coefficients: BalanceCoefficients,
    mesh: Mesh,
    unknown_velocity_components: tuple[int, ...] = (),
    law: int = 0,
    jumps: Jumps = NO_JUMPS,
) -> NodalRod:
    """The `NodalRod` of a rod on a mesh. coefficients: coefficients of the balance at the nodes.
    unknown_velocity_components: indices of the components of V that are unknowns. law: number of the
    constitutive law (`stress_strain`), 0 if linear. jumps: jumps of the material on this mesh."""
    node_count = mesh.node_count + 1
    rest_strain = _broadcast_to_nodes(coefficients.straight_state_strain, node_count)
    compliance = _broadcast_to_nodes(coefficients.compliance, node_count)
    drag_arrays = _cached_drag_arrays(
        coefficients.drag.tobytes(), coefficients.drag.shape, mesh, unknown_velocity_components
    )
    return NodalRod(coefficients.tip_stress, rest_strain, compliance, *drag_arrays, law, *jumps)


def nodal_rod_derivative(
    derivative: BalanceCoefficients, mesh: Mesh, jump_derivatives: Array = NO_JUMP_DERIVATIVE
) -> NodalRodDerivative:
    """The `NodalRodDerivative` of a mesh. derivative: derivative of the coefficients by a parameter.
    jump_derivatives: derivatives of nu, c1 and c3 on both sides of each jump, (k, 2, 3)."""
    arrays = derivative.straight_state_strain, derivative.compliance, derivative.drag
    rest_strain, compliance, drag = (_broadcast_to_nodes(values, mesh.node_count + 1) for values in arrays)
    return NodalRodDerivative(derivative.tip_stress, rest_strain, compliance, drag, jump_derivatives)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _cached_drag_arrays(
    drag_bytes: bytes, shape: tuple[int, ...], mesh: Mesh, unknown_velocity_components: tuple[int, ...]
) -> tuple[Array, Array, Array, IntegerArray]:
    """The result of `_drag_arrays`, cached by the bytes of the drag, because rods that differ only in F have
    equal drags. drag_bytes, shape: bytes and shape of the array of drags. unknown_velocity_components:
    indices of the components of V that are unknowns."""
    # Bytes can be a key of the cache, and the array is restored from the bytes.
    drags = np.frombuffer(drag_bytes).reshape(shape)
    return _drag_arrays(drags if len(shape) > 1 else drags[:, None], mesh, unknown_velocity_components)


def _drag_arrays(
    drag: Array, mesh: Mesh, unknown_velocity_components: tuple[int, ...]
) -> tuple[Array, Array, Array, IntegerArray]:
    """Returns (drag, mobility, mobility_laplacian, unknown_velocity_components), fields of a `NodalRod`.
    drag: drags of the components, (d, 1) or (d, nodes + 1)."""
    drag = _broadcast_to_nodes(drag, mesh.node_count + 1)
    mobility = np.zeros(drag.shape)
    known_velocities = [a for a in range(len(drag)) if a not in unknown_velocity_components]
    mobility[known_velocities] = 1 / drag[known_velocities]
    # The product of the two differentiations of the stress, D* and the weak D, does not depend on the state.
    laplacian = mesh.node_matrices.weak_derivative_matrix @ (
        mobility[:, :, None] * mesh.node_matrices.differentiation_matrix
    )
    return drag, mobility, laplacian, np.array(unknown_velocity_components, np.int64)


def _broadcast_to_nodes(values: Array, node_count: int) -> Array:
    """`values` as an array (d, node_count). values: (d, node_count), or one constant per component, (d,) or
    (d, 1)."""
    # A whole array even for constants, because compiled loops index every node.
    out = np.empty((len(values), node_count))
    out[:] = values.reshape(len(values), -1)
    return out
