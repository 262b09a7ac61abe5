"""Where each field of a flat state lies: stresses at the nodes but the tip, then unknown velocities.

Nobody else counts places in a state. Python asks a `StateLayout`, compiled code `stress_place` and
`velocity_place`: numbers, for a view costs it as much as a sum over the nodes.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..model.balance import Values
from ..model.compiled.compilation import compiled_for_vectors

FIELDS = {3: ("n1", "n2", "m3"), 6: ("n1", "n2", "n3", "m1", "m2", "m3")}
"""Names of the stresses in the plane and in space."""
COMPONENTS, BENDING = 3, 2
"""How many the plane has, and which of them is m3, for compiled code."""


@dataclass(frozen=True, slots=True)
class StateLayout:
    """Of states (..., unknowns): components of a stress, nodes without the tip, unknown components of V.

    Each velocity has a value at the tip, too.
    """

    components: int
    nodes: int
    kept: tuple[int, ...] = ()

    @property
    def unknowns(self) -> int:
        return self.components * self.nodes + len(self.kept) * (self.nodes + 1)

    def field(self, x: Values, name: str) -> Values:
        """One stress of states x at the nodes but the tip, a view of the shape (..., nodes)."""
        first = self.place(name)
        return x[..., first : first + self.nodes]

    def place(self, name: str, node: int = 0) -> int:
        """Which of the unknowns a stress at a node is; node 0 is the clamp."""
        return FIELDS[self.components].index(name) * self.nodes + node

    def at(self, x: Values, name: str, node: int = 0) -> Values:
        """One stress of states x at one node, shape (...)."""
        at: Values = x[..., self.place(name, node)]
        return at

    def transverse(self, x: Values) -> Values:
        """All of states x in the plane but n1: what is 0 while the rod is straight, a view."""
        return x[..., self.nodes :]

    def stresses(self, x: Values) -> Values:
        """All stresses of states x at all nodes, 0 at the tip, shape (components, ..., nodes + 1)."""
        S = np.zeros((self.components, *x.shape[:-1], self.nodes + 1), x.dtype)
        known = x[..., : self.components * self.nodes].reshape(*x.shape[:-1], self.components, self.nodes)
        S[..., :-1] = np.moveaxis(known, -2, 0)
        return S

    def velocities(self, x: Values) -> Values:
        """The unknown components of V of states x at all nodes, shape (kept, ..., nodes + 1)."""
        known = x[..., self.components * self.nodes :]
        return np.moveaxis(known.reshape(*x.shape[:-1], len(self.kept), self.nodes + 1), -2, 0)

    def state(self, S: Values, V: Values) -> Values:
        """States (..., unknowns) of stresses and of all of V at all nodes, (components, ..., nodes + 1) each.

        What a stress has at the tip does not count, nor does what of V is no unknown.
        """
        return np.concatenate([*S[..., :-1], *(V[a] for a in self.kept)], axis=-1)

    def carried(self, x: Array, E: Array) -> Array:
        """States x on another mesh; E: from all nodes to all there, (nodes there + 1, nodes + 1)."""
        split = self.components * self.nodes
        places = [slice(first, first + self.nodes) for first in range(0, split, self.nodes)]
        parts = [x[..., here] @ E[:-1, :-1].T for here in places]
        return np.concatenate([*parts, *(self.velocities(x) @ E.T if self.kept else ())], axis=-1)

    def row(self, values: dict[str, Array]) -> Array:
        """A row (unknowns,) with these numbers, (nodes,), where a stress lies and 0 elsewhere."""
        row = np.zeros(self.unknowns)
        for name, numbers in values.items():
            self.field(row, name)[:] = numbers
        return row


def plane_layout(nodes: int, kept: tuple[int, ...] = ()) -> StateLayout:
    """Of a rod in the plane."""
    return StateLayout(COMPONENTS, nodes, kept)


@compiled_for_vectors
def stress_place(a: int, node: int, nodes: int) -> int:
    """Which of the unknowns component a of the stress at a node is."""
    return a * nodes + node


@compiled_for_vectors
def velocity_place(k: int, node: int, components: int, nodes: int) -> int:
    """Which of the unknowns the k-th of the velocities that are unknown is at a node."""
    return components * nodes + k * (nodes + 1) + node
