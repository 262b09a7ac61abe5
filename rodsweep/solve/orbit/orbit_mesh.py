"""Meshes of an orbit in space and time, and the one that an accuracy needs.

How fine a mesh must be is judged by the tails of an orbit near by (`tails`).
"""

from dataclasses import dataclass, replace
from math import ceil, log

from ...discretization.elements.mesh import Mesh, mesh
from ...discretization.elements.resolution import LARGEST_ORDER
from ...discretization.state_layout import plane_layout
from .orbit import Orbit
from .tails import tails_of

SPACE_FACTOR, TIME_FACTOR = 5.0, 1.5
"""Largest errors of period and extrema that are stated, in units of the squared tails, as a coarse mesh's
predict these: with them the mesh is fine enough for five rods in six, and costs a fifth more than need be."""
EXPECTED_SHARE = 1 / 3
"""Share of the accuracy that a mesh is chosen for, in space and in time each."""
COARSER_ORDER, COARSER_SHARE = 2, 0.6
"""The coarser mesh has so much less order in each element and this share of the intervals: its errors are
then some ten times as large."""
LEAST_ORDER, LEAST_INTERVALS, MOST_INTERVALS = 8, 4, 256
MOST_STATE_UNKNOWNS = 400
"""Unknowns of a state beyond which a cycle is given up: a second for each of Newton's steps."""


@dataclass(frozen=True, slots=True)
class OrbitMesh:
    """Equal elements of an order in space, intervals with Radau stages in time."""

    elements: int
    order: int
    intervals: int
    stages: int

    @property
    def grid(self) -> Mesh:
        return mesh(self.elements, self.order)

    @property
    def unknowns(self) -> int:
        """Stresses of a state."""
        return plane_layout(self.elements * self.order).unknowns

    @property
    def numbers(self) -> tuple[int, int, int, int]:
        """By which it is stored and made anew."""
        return self.elements, self.order, self.intervals, self.stages

    @property
    def coarser(self) -> "OrbitMesh":
        """A mesh on which a branch is followed in steps to a place where this one is wanted."""
        order = max(LEAST_ORDER - COARSER_ORDER, self.order - COARSER_ORDER)
        intervals = max(LEAST_INTERVALS - 1, round(COARSER_SHARE * self.intervals))
        return replace(self, order=order, intervals=intervals)

    @property
    def finer(self) -> "OrbitMesh":
        """The mesh that is tried where nothing tells which one is enough."""
        return replace(self, order=self.order + 2, intervals=self.intervals * 6 // 5 + 1)

    @property
    def allowed(self) -> bool:
        return self.unknowns <= MOST_STATE_UNKNOWNS and self.intervals <= MOST_INTERVALS

    @property
    def cost(self) -> float:
        """Of an elimination, in any unit; processors and their BLAS take numbers in eights."""
        unknowns = 8 * ceil(self.unknowns / 8)
        return float(unknowns**3 * self.intervals * self.stages**2)

    def carry(self, orbit: Orbit) -> Orbit:
        """The orbit's polynomials on this mesh."""
        return orbit.on(self.grid, self.intervals, self.stages)


def mesh_of(orbit: Orbit) -> OrbitMesh:
    """The mesh of an orbit."""
    grid = orbit.form.mesh
    return OrbitMesh(grid.elements, grid.order, orbit.intervals, orbit.stages)


def stages_for(accuracy: float) -> int:
    """Stages of the method in time with which an accuracy costs least."""
    return 3 if accuracy > 2e-5 else 4 if accuracy > 3e-9 else 5 if accuracy > 3e-11 else 6


def wanted_mesh(orbit: Orbit, accuracy: float, stages: int) -> OrbitMesh:
    """The smallest mesh that is expected to reach an accuracy, by the tails of an orbit near by."""
    here, tails = mesh_of(orbit), tails_of(orbit)
    aim_space = (EXPECTED_SHARE * accuracy / SPACE_FACTOR) ** 0.5
    aim_time = (EXPECTED_SHARE * accuracy / TIME_FACTOR) ** 0.5
    order = here.order + ceil(log(max(tails.space, 1e-15) / aim_space) / tails.decay / here.elements)
    elements = here.elements
    while order > LARGEST_ORDER:
        order, elements = ceil(0.6 * order), 2 * elements
    # A tail falls as the power `stages` of the intervals; of other stages' tails little more is known.
    tail = max(tails.time, 1e-15) ** (stages / here.stages)
    intervals = ceil(here.intervals * (tail / aim_time) ** (1 / stages))
    order = min(max(order, LEAST_ORDER), here.order + 12)
    intervals = min(max(intervals, LEAST_INTERVALS), 4 * here.intervals)
    return OrbitMesh(elements, order, intervals, stages)


def finer_mesh(mesh: OrbitMesh, wanted: OrbitMesh) -> OrbitMesh:
    """At least the wanted mesh, and finer than the present one."""
    order = max(wanted.order, mesh.order) if wanted.elements == mesh.elements else wanted.order
    intervals, stages = max(wanted.intervals, mesh.intervals), max(wanted.stages, mesh.stages)
    finer = replace(wanted, order=order, intervals=intervals, stages=stages)
    if finer != mesh:
        return finer
    return replace(mesh, order=mesh.order + 2, intervals=ceil(1.2 * mesh.intervals))
