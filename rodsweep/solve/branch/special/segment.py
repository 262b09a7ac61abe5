"""The part of a branch between two of its cycles, on which a special point is located."""

from ....arrays import Array
from ...orbit.newton import ConvergedOrbit
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh
from ..arc import ArcPoint, arc_between
from ..bordered.condition import moved
from ..bordered.matrix import bordered
from .augmented.functions import FoldFunction, correct_fully
from .point import LOCATING


class BranchSegment:
    """The part of a branch from one cycle to the next, solved on any mesh."""

    def __init__(self, start: ArcPoint, end: ArcPoint) -> None:
        self.start = start
        self.end = end
        self.length = arc_between(start, end)
        self._back = float(end.ahead @ (end.scale.place(end.orbit) - end.scale.place(start.orbit)))
        self._known: tuple[float, Orbit, Array] | None = None

    def predicted(self, length: float) -> Orbit:
        """Orbit at a length from `start`, on the cubic through both cycles and on the mesh of `end`."""
        # Backwards from the end, whose cubic passes through both cycles; lengths are measured along its
        # tangent.
        return self.end.predicted(-self._back * (1 - length / self.length))

    def start_on(self, mesh: OrbitMesh) -> None:
        """Continues on a different mesh, without a cycle to start from."""
        self.mesh = mesh
        self._known = None

    def at(self, length: float) -> ConvergedOrbit:
        """The cycle at a length from `start`, with a matrix nearby; raises Unsolvable."""
        if self._known is None:
            start = self.mesh.carry(self.predicted(length))
        else:
            last, orbit, tangent = self._known
            # From the last cycle along its tangent: successive lengths of a secant method are close.
            start = moved(orbit, self.start.scale.name, (length - last) * tangent)
        condition = self.start.condition(length)
        workspace = self.start.workspace
        found = condition.solved(start, LOCATING.cycle_tolerance, workspace, LOCATING.matrix_distance)
        function = FoldFunction(bordered(found), self.start.ahead, False)
        correct_fully(function, found.orbit)
        self._known = length, found.orbit, function.vectors
        return found

    @property
    def known(self) -> tuple[float, Orbit, Array]:
        """The last cycle found: its length, its orbit, and the derivative by the length, (N + 1,)."""
        if self._known is None:
            raise ValueError("nothing is found yet")
        return self._known

    def rises(self) -> float:
        """Derivative of the parameter along the branch at the last cycle found."""
        return float(self.known[2][-1]) / self.start.scale.coordinate
