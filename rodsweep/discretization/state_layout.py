"""Indices of the fields in a flat state: stresses at all nodes except the tip, then unknown velocities.

Other modules take indices into a state from this module. Python code uses a `StateLayout`. Compiled code uses
`stress_index` and `velocity_index`, because an array view costs as much as a sum over the nodes.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..model.balance import Values
from ..model.compiled.compilation import compiled_with_reordered_sums

STRESS_NAMES = {3: ("n1", "n2", "m3"), 6: ("n1", "n2", "n3", "m1", "m2", "m3")}
"""Names of the stress components, by the number of components: 3 in the plane, 6 in space."""
SE2_DIMENSION = 3
BENDING_INDEX = 2
"""SE2_DIMENSION: number of components of the stress, of the velocity and of the strain in the plane.
BENDING_INDEX: index of the component m3. Both constants are for compiled code."""


@dataclass(frozen=True, slots=True)
class StateLayout:
    """Order of the unknowns in states of the shape (..., unknowns). component_count: number of stress
    components. node_count: number of nodes without the tip. unknown_velocity_components: indices of the
    components of V that are unknowns. Velocities at the tip are unknowns, stresses at the tip are 0."""

    component_count: int
    node_count: int
    unknown_velocity_components: tuple[int, ...] = ()

    @property
    def unknown_count(self) -> int:
        """Number of unknowns in a state."""
        return self.component_count * self.node_count + len(self.unknown_velocity_components) * (
            self.node_count + 1
        )

    def stress_field(self, x: Values, name: str) -> Values:
        """The stress `name` of states x at all nodes except the tip: a view, (..., nodes)."""
        first = self.stress_index(name)
        return x[..., first : first + self.node_count]

    def stress_index(self, name: str, node: int = 0) -> int:
        """Index in a state of the stress `name` at a node; node 0 is the clamp."""
        return STRESS_NAMES[self.component_count].index(name) * self.node_count + node

    def transverse_unknowns(self, x: Values) -> Values:
        """All unknowns of planar states x except the axial stress n1, a view; all these unknowns are 0 for a
        straight rod."""
        return x[..., self.node_count :]

    def stresses(self, x: Values) -> Values:
        """Stresses of states x at all nodes, (components, ..., nodes + 1); stresses at the tip are 0."""
        S = np.zeros((self.component_count, *x.shape[:-1], self.node_count + 1), x.dtype)
        unknown_stresses = x[..., : self.component_count * self.node_count].reshape(
            *x.shape[:-1], self.component_count, self.node_count
        )
        S[..., :-1] = np.moveaxis(unknown_stresses, -2, 0)
        return S

    def velocities(self, x: Values) -> Values:
        """The unknown components of V of states x at all nodes, (unknown_velocities, ..., nodes + 1)."""
        unknown_velocities = x[..., self.component_count * self.node_count :]
        return np.moveaxis(
            unknown_velocities.reshape(
                *x.shape[:-1], len(self.unknown_velocity_components), self.node_count + 1
            ),
            -2,
            0,
        )

    def state(self, S: Values, V: Values) -> Values:
        """States (..., unknowns) from stresses S and velocities V, (components, ..., nodes + 1) each.
        Stresses at the tip and the components of V outside `unknown_velocity_components` are ignored."""
        return np.concatenate([*S[..., :-1], *(V[a] for a in self.unknown_velocity_components)], axis=-1)

    def interpolate(self, x: Array, E: Array) -> Array:
        """States x interpolated to another mesh. E: interpolation matrix from all nodes of the current mesh
        to all nodes of the other mesh, (nodes of the other mesh + 1, nodes + 1)."""
        unknown_stress_count = self.component_count * self.node_count
        slices = [
            slice(first, first + self.node_count) for first in range(0, unknown_stress_count, self.node_count)
        ]
        # Stresses at the tip are 0 on both meshes, so the row and the column of the tip are left out.
        stresses = [x[..., stress] @ E[:-1, :-1].T for stress in slices]
        return np.concatenate(
            [*stresses, *(self.velocities(x) @ E.T if self.unknown_velocity_components else ())], axis=-1
        )

    def state_with_stresses(self, values_by_name: dict[str, Array]) -> Array:
        """A state (unknowns,) with the given stresses by name, (nodes,) each; all other entries are 0."""
        vector = np.zeros(self.unknown_count)
        for name, values in values_by_name.items():
            self.stress_field(vector, name)[:] = values
        return vector


def plane_layout(node_count: int, unknown_velocities: tuple[int, ...] = ()) -> StateLayout:
    """Layout of the states of a rod in the plane. node_count: number of nodes without the tip.
    unknown_velocities: indices of the components of V that are unknowns."""
    return StateLayout(SE2_DIMENSION, node_count, unknown_velocities)


@compiled_with_reordered_sums
def stress_index(a: int, node: int, nodes: int) -> int:
    """Index in a state of stress component a at a node; nodes: number of nodes without the tip."""
    return a * nodes + node


@compiled_with_reordered_sums
def velocity_index(k: int, node: int, components: int, nodes: int) -> int:
    """Index in a state of the k-th unknown velocity component at a node. components: number of stress
    components. nodes: number of nodes without the tip."""
    return components * nodes + k * (nodes + 1) + node
