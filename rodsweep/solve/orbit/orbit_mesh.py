"""Meshes of an orbit in space and time, and the choice of the mesh for a requested accuracy from the
coefficient tails of a nearby orbit (`tails`)."""

from dataclasses import dataclass, replace
from math import ceil, log

import numpy as np

from ...arrays import Array
from ...discretization.elements.elements import halve_elements
from ...discretization.elements.mesh import Mesh, mesh_with_edges
from ...discretization.elements.resolution import RESOLUTION_SETTINGS
from ...discretization.state_layout import plane_layout
from .orbit import Orbit
from .tails import tails_of


@dataclass(frozen=True, slots=True, kw_only=True)
class OrbitMeshSettings:
    """Settings for the choice of the mesh of an orbit in space and time."""

    space_factor: float = 5.0
    """Predicted error of period and extrema due to the mesh in space, divided by the squared tail in space.
    With `space_factor` and `time_factor` the first mesh suffices for five rods in six, and costs a fifth more
    than necessary."""
    time_factor: float = 1.5
    """Predicted error of period and extrema due to the mesh in time, divided by the squared tail in time."""
    smallest_tail: float = 1e-15
    """Lower limit of the tails from which a mesh is chosen; smaller tails are rounding errors."""
    accuracy_share: float = 1 / 3
    """The mesh in space and the mesh in time are each chosen for this fraction of the requested accuracy."""
    coarser_order: int = 2
    """Decrease of the element order from a mesh to its `coarser` mesh, whose errors are about ten times
    larger."""
    coarser_share: float = 0.6
    """Number of time intervals of the `coarser` mesh, divided by the number of the mesh itself."""
    min_order: int = 8
    """Smallest element order of a chosen mesh."""
    min_intervals: int = 4
    """Smallest number of time intervals of a chosen mesh."""
    max_intervals: int = 256
    """Largest number of time intervals of an allowed mesh."""
    stage_accuracies: tuple[float, ...] = (2e-5, 3e-9, 3e-11)
    """Largest relative accuracies at which four, five and six collocation stages cost less than three, four
    and five stages."""
    fewest_stages: int = 3
    """Number of collocation stages at accuracies above the largest of `stage_accuracies`."""
    max_more_orders: int = 12
    """Largest increase of the element order in one choice of a mesh; the tail cannot be extrapolated to
    higher orders."""
    max_interval_ratio: int = 4
    """Largest ratio of the new number of time intervals to the present number; the tail cannot be
    extrapolated to larger ratios."""
    more_intervals: float = 1.2
    """Factor on the number of time intervals if the mesh chosen from the tails is not finer than the present
    mesh."""
    halved_order: float = 0.6
    """Ratio of the element order after all elements are halved to the order before, for equal errors."""
    simd_doubles: int = 8
    """Number of doubles in a vector register. The computing time of matrix products depends on the number of
    unknowns rounded up to a multiple of this number."""
    max_unknowns: int = 400
    """Largest number of unknowns of a state on an allowed mesh; with more unknowns a Newton step takes more
    than a second."""


ORBIT_MESH_SETTINGS = OrbitMeshSettings()


@dataclass(frozen=True, slots=True)
class OrbitMesh:
    """Mesh of an orbit. edges: edges of the elements in space, from 0 to 1. order: order of all elements.
    intervals: number of time intervals. stages: number of Radau stages of each interval."""

    edges: tuple[float, ...]
    order: int
    intervals: int
    stages: int

    @property
    def elements(self) -> int:
        """Number of elements."""
        return len(self.edges) - 1

    @property
    def full_intervals(self) -> int:
        """Solved duration divided by the length of a full interval; the last two intervals have half this
        length."""
        return self.intervals - 1

    @property
    def grid(self) -> Mesh:
        return mesh_with_edges(self.edges, self.order)

    @property
    def unknowns(self) -> int:
        """Number of unknowns of a state."""
        return plane_layout(self.elements * self.order).unknowns

    @property
    def as_array(self) -> Array:
        """The mesh as one array for storage, (elements + 4,): order, intervals, stages, edges."""
        return np.array([self.order, self.intervals, self.stages, *self.edges])

    @classmethod
    def from_array(cls, numbers: Array) -> "OrbitMesh":
        """The mesh from the array that the property `as_array` returns, (elements + 4,)."""
        order, intervals, stages = map(int, numbers[:3])
        return cls(tuple(numbers[3:].tolist()), order, intervals, stages)

    @property
    def coarser(self) -> "OrbitMesh":
        """Mesh coarser than this mesh, for the first steps along a branch to a cycle that will be solved on
        this mesh."""
        order = max(
            ORBIT_MESH_SETTINGS.min_order - ORBIT_MESH_SETTINGS.coarser_order,
            self.order - ORBIT_MESH_SETTINGS.coarser_order,
        )
        intervals = max(
            ORBIT_MESH_SETTINGS.min_intervals - 1, round(ORBIT_MESH_SETTINGS.coarser_share * self.intervals)
        )
        return replace(self, order=order, intervals=intervals)

    @property
    def finer(self) -> "OrbitMesh":
        """Mesh finer than this mesh in space and time, used if no error estimate is available."""
        more = int(ORBIT_MESH_SETTINGS.more_intervals * self.intervals) + 1
        return replace(self.finer_in_space, intervals=more)

    @property
    def finer_in_space(self) -> "OrbitMesh":
        """This mesh with an order increased by 2, or with twice as many elements of lower order if the order
        would exceed its maximum."""
        if self.order + 2 <= RESOLUTION_SETTINGS.max_order:
            return replace(self, order=self.order + 2)
        return replace(
            self, edges=halve_elements(self.edges), order=ceil(ORBIT_MESH_SETTINGS.halved_order * self.order)
        )

    @property
    def is_allowed(self) -> bool:
        return (
            self.unknowns <= ORBIT_MESH_SETTINGS.max_unknowns
            and self.intervals <= ORBIT_MESH_SETTINGS.max_intervals
        )

    @property
    def cost(self) -> float:
        """Relative cost of the elimination of Newton's matrix; the number of unknowns is rounded up to a
        multiple of `ORBIT_MESH_SETTINGS.vector`."""
        unknowns = ORBIT_MESH_SETTINGS.simd_doubles * ceil(self.unknowns / ORBIT_MESH_SETTINGS.simd_doubles)
        return float(unknowns**3 * self.intervals * self.stages**2)

    def interpolated_orbit(self, orbit: Orbit) -> Orbit:
        """The orbit `orbit` interpolated to this mesh."""
        return orbit.on_mesh(self.grid, self.intervals, self.stages)


def mesh_of(orbit: Orbit) -> OrbitMesh:
    """The mesh in space and time on which `orbit` is represented."""
    grid = orbit.form.mesh
    return OrbitMesh(grid.edges, grid.order, orbit.intervals, orbit.stages)


def cheapest_stage_count(accuracy: float) -> int:
    """Number of collocation stages with the smallest cost for the relative accuracy `accuracy`."""
    return ORBIT_MESH_SETTINGS.fewest_stages + sum(
        accuracy <= limit for limit in ORBIT_MESH_SETTINGS.stage_accuracies
    )


def mesh_from_tails(orbit: Orbit, accuracy: float, stages: int) -> OrbitMesh:
    """The coarsest mesh with `stages` stages that is expected to reach the relative accuracy `accuracy`, from
    the tails of the nearby orbit `orbit`; finer than the mesh of `orbit` at most by `max_more_orders` and
    `max_interval_ratio`."""
    present = mesh_of(orbit)
    tails = tails_of(orbit)
    aim_space = (ORBIT_MESH_SETTINGS.accuracy_share * accuracy / ORBIT_MESH_SETTINGS.space_factor) ** 0.5
    aim_time = (ORBIT_MESH_SETTINGS.accuracy_share * accuracy / ORBIT_MESH_SETTINGS.time_factor) ** 0.5
    # Below `smallest_tail` a tail is rounding error.
    order = present.order + ceil(
        log(max(tails.space, ORBIT_MESH_SETTINGS.smallest_tail) / aim_space) / tails.decay / present.elements
    )
    edges = present.edges
    while order > RESOLUTION_SETTINGS.max_order:
        order = ceil(ORBIT_MESH_SETTINGS.halved_order * order)
        edges = halve_elements(edges)
    # A tail is proportional to intervals**-stages. For a different number of stages the tail on the present
    # number of intervals is about a power of the known tail.
    tail = max(tails.time, ORBIT_MESH_SETTINGS.smallest_tail) ** (stages / present.stages)
    intervals = ceil(present.intervals * (tail / aim_time) ** (1 / stages))
    order = min(
        max(order, ORBIT_MESH_SETTINGS.min_order), present.order + ORBIT_MESH_SETTINGS.max_more_orders
    )
    intervals = min(
        max(intervals, ORBIT_MESH_SETTINGS.min_intervals),
        ORBIT_MESH_SETTINGS.max_interval_ratio * present.intervals,
    )
    return OrbitMesh(edges, order, intervals, stages)


def finer_mesh(mesh: OrbitMesh, target: OrbitMesh) -> OrbitMesh:
    """A mesh that is at least as fine as `target` and finer than the present mesh `mesh`."""
    order = max(target.order, mesh.order) if target.edges == mesh.edges else target.order
    intervals = max(target.intervals, mesh.intervals)
    stages = max(target.stages, mesh.stages)
    finer = replace(target, order=order, intervals=intervals, stages=stages)
    if finer != mesh:
        return finer
    return replace(mesh.finer_in_space, intervals=ceil(ORBIT_MESH_SETTINGS.more_intervals * mesh.intervals))
