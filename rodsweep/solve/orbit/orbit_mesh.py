"""Meshes of an orbit in space and time."""

from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace
from math import ceil

import numpy as np

from ...arrays import Array, list_of
from ...discretization.elements.elements import element_orders, halved_element_edges
from ...discretization.elements.mesh import Mesh, mesh_with_edges
from ...discretization.elements.node_spacing import node_spacing_ratios_of_halves
from ...discretization.elements.resolution import RESOLUTION_SETTINGS
from ...discretization.state_layout import plane_layout
from ..unsolvable import MeshLimitReached
from .matrix.workspace import WORKSPACE_SETTINGS, factors_size_in_doubles, require_enough_stages
from .orbit import Orbit, TimeMesh
from .time_grading import UNIFORM_TIME_GRADING, TimeGrading


@dataclass(frozen=True, slots=True, kw_only=True)
class OrbitMeshSettings:
    """Settings for the choice of the mesh of an orbit in space and time."""

    space_error_per_squared_tail: float = 5.0
    """Predicted error of period and extrema due to the mesh in space, divided by the squared tail in space:
    last Legendre coefficients over the largest. With `space_error_per_squared_tail` and
    `time_error_per_squared_tail` the first mesh suffices for five rods in six, and costs a fifth more than
    necessary."""
    time_error_per_squared_tail: float = 3.0
    """Predicted error of period and extrema due to the mesh in time, divided by the squared tail in time:
    last coefficient in an interval over the largest value."""
    min_coefficient_tail: float = 1e-15
    """Tails (last coefficients over the largest) below this are rounding errors and are replaced by it."""
    accuracy_fraction_in_space_or_time: float = 1 / 3
    """The mesh in space and the mesh in time are each chosen for this fraction of the requested accuracy."""
    min_element_order_change: int = 2
    """Smallest change of the order of each element from a mesh to a mesh with another largest order. With
    one order less or more the error of an element may stay the same, by parity: with a change of 1, errors of
    arms and cones exceeded their estimates by up to 2.4 times."""
    element_order_decrease_of_coarser_mesh: int = 2
    """Decrease of the element order from a mesh to its `coarser_mesh`, whose errors are about ten times
    larger."""
    interval_count_ratio_of_coarser_mesh: float = 0.6
    """Number of time intervals of the `coarser_mesh`, divided by the number of the mesh itself."""
    min_element_order: int = 8
    """Smallest element order of a chosen mesh."""
    min_time_interval_count: int = 4
    """Smallest number of time intervals of a chosen mesh."""
    max_time_interval_count: int = 256
    """Largest number of time intervals of an allowed mesh."""
    max_accuracies_for_more_stages: tuple[float, ...] = (2e-5, 3e-9, 3e-11)
    """Largest relative accuracies at which four, five and six collocation stages cost less than three, four
    and five stages."""
    min_stage_count: int = 3
    """Number of collocation stages at accuracies above the largest of `max_accuracies_for_more_stages`."""
    max_element_order_increase: int = 12
    """Largest increase of the element order in one choice of a mesh; the tail cannot be extrapolated to
    higher orders."""
    max_time_interval_count_ratio: int = 4
    """Largest ratio of the new number of time intervals to the current number; the tail cannot be
    extrapolated to larger ratios."""
    max_regraded_interval_count_ratio: float = 0.9
    """A mesh gets a new grading of the time intervals only if the new grading needs at most this fraction of
    the present number of intervals."""
    interval_count_ratio_of_finer_mesh: float = 1.2
    """Factor on the number of time intervals, for `finer_mesh`, and for the next mesh if the mesh chosen from
    the tails is not finer than the current mesh."""
    element_order_ratio_after_halving: float = 0.6
    """Element order after all elements are halved, divided by the order before, for equal errors."""
    doubles_per_vector_register: int = 8
    """Number of doubles in a vector register. The computing time of matrix products depends on the number of
    unknowns rounded up to a multiple of this number."""
    max_unknown_count: int = 400
    """Largest number of unknowns of a state on an allowed mesh; with more unknowns a Newton step takes more
    than a second."""

    def __post_init__(self) -> None:
        require_enough_stages(self.min_stage_count)


ORBIT_MESH_SETTINGS = OrbitMeshSettings()


def mesh_limit_error() -> MeshLimitReached:
    """The exception for a cycle that needs a mesh of more than the allowed size; names the limits."""
    return MeshLimitReached(
        f"no mesh of at most {ORBIT_MESH_SETTINGS.max_unknown_count} unknowns and "
        f"{ORBIT_MESH_SETTINGS.max_time_interval_count} time intervals, with at most "
        f"{8e-9 * WORKSPACE_SETTINGS.max_buffer_size:.1f} GB for its matrix, reaches the requested accuracy"
    )


@dataclass(frozen=True, slots=True)
class OrbitMesh:
    """Mesh of an orbit. element_edges: edges of the elements in space, from 0 to 1. order: largest order of
    an element. order_ratios: order of each element divided by `order`; empty if all orders are equal.
    interval_count: number of time intervals. stage_count: number of Radau stages of each interval. grading:
    grading of the time intervals. spacing_ratios: `node_spacing_ratios` of `Elements`."""

    element_edges: tuple[float, ...]
    order: int
    interval_count: int
    stage_count: int
    order_ratios: tuple[float, ...] = ()
    grading: TimeGrading = UNIFORM_TIME_GRADING
    spacing_ratios: tuple[float, ...] = ()

    @property
    def element_count(self) -> int:
        """Number of elements."""
        return len(self.element_edges) - 1

    def has_same_edges_and_order_ratios(self, other: "OrbitMesh") -> bool:
        """Whether both meshes have the same element edges, order ratios and spacing ratios; the largest order
        and the time intervals may differ."""
        elements = self.element_edges, self.order_ratios, self.spacing_ratios
        return elements == (other.element_edges, other.order_ratios, other.spacing_ratios)

    @property
    def time_mesh(self) -> TimeMesh:
        """Number of time intervals, number of stages of each, and grading."""
        return self.interval_count, self.stage_count, self.grading

    @property
    def solved_duration_in_full_intervals(self) -> int:
        """Solved duration divided by the length of a full interval; the last two intervals have half this
        length."""
        return self.interval_count - 1

    @property
    def space_mesh(self) -> Mesh:
        return mesh_with_edges(self.element_edges, self.order, self.order_ratios, self.spacing_ratios)

    @property
    def unknown_count(self) -> int:
        """Number of unknowns of a state."""
        return plane_layout(sum(self.orders)).unknown_count

    @property
    def orders(self) -> tuple[int, ...]:
        """Order of each element."""
        return element_orders(self.element_count, self.order, self.order_ratios)

    @property
    def as_array(self) -> Array:
        """The mesh as one array for storage, (3 elements + 7,): largest order, numbers of intervals and
        stages, three numbers of the grading, edges, ratios of the orders, spacing ratios."""
        ones = (1.0,) * self.element_count
        ratios = *(self.order_ratios or ones), *(self.spacing_ratios or ones)
        counts = self.order, self.interval_count, self.stage_count
        return np.array([*counts, *astuple(self.grading), *self.element_edges, *ratios])

    @classmethod
    def from_array(cls, numbers: Array) -> "OrbitMesh":
        """The mesh from the array that the property `as_array` returns, (3 elements + 7,)."""
        counts, amplitudes, (harmonic,), positions = np.split(numbers, [3, 5, 6])
        order, interval_count, stage_count = map(int, counts)
        grading = TimeGrading(float(amplitudes[0]), float(amplitudes[1]), int(harmonic))
        edges = tuple(list_of(positions[: -2 * (len(positions) // 3)]))
        ratios = (tuple(list_of(part)) for part in np.split(positions[len(edges) :], 2))
        # Ratios that are all 1 are stored as no ratios, because equal meshes must compare equal.
        order_ratios, spacing_ratios = (() if set(part) == {1.0} else part for part in ratios)
        return cls(edges, order, interval_count, stage_count, order_ratios, grading, spacing_ratios)

    @property
    def coarser_mesh(self) -> "OrbitMesh":
        """Mesh coarser than this mesh in space and time, for the intermediate orbits on the way to a cycle
        that will be solved on this mesh."""
        settings = ORBIT_MESH_SETTINGS
        order = max(settings.min_element_order, self.order) - settings.element_order_decrease_of_coarser_mesh
        interval_count = round(settings.interval_count_ratio_of_coarser_mesh * self.interval_count)
        interval_count = max(settings.min_time_interval_count - 1, interval_count)
        return replace(self, order=order, interval_count=interval_count)

    def with_order(self, order: int) -> "OrbitMesh":
        """This mesh with another largest order, `order`. The order of every element changes by at least the
        smaller of `min_element_order_change` and the change of the largest order. The difference between
        cycles on both meshes then contains the errors of every element."""
        if order == self.order or not self.order_ratios:
            return replace(self, order=order)
        scaled_orders = element_orders(self.element_count, order, self.order_ratios)
        change = min(ORBIT_MESH_SETTINGS.min_element_order_change, abs(order - self.order))
        if order > self.order:
            orders = [max(p + change, q) for p, q in zip(self.orders, scaled_orders, strict=True)]
        else:
            orders = [min(max(p - change, 1), q) for p, q in zip(self.orders, scaled_orders, strict=True)]
        return self.with_orders(orders)

    def with_orders(self, orders: Sequence[int]) -> "OrbitMesh":
        """This mesh with elements of the orders `orders`, (elements,)."""
        order = max(orders)
        # Half an order less, because `element_orders` rounds up: no rounding error can add an order.
        ratios = tuple(1.0 if p == order else (p - 1 / 2) / order for p in orders)
        return replace(self, order=order, order_ratios=ratios)

    @property
    def finer_mesh(self) -> "OrbitMesh":
        """Mesh finer than this mesh in space and time, used if no allowed mesh is predicted to suffice."""
        interval_count = int(ORBIT_MESH_SETTINGS.interval_count_ratio_of_finer_mesh * self.interval_count) + 1
        return replace(self.mesh_finer_in_space, interval_count=interval_count)

    @property
    def mesh_finer_in_space(self) -> "OrbitMesh":
        """This mesh with an order increased by 2, or `with_halved_elements` if the order would exceed its
        maximum."""
        finer = self.with_order(self.order + 2)
        return finer if finer.order <= RESOLUTION_SETTINGS.max_order else self.with_halved_elements

    @property
    def with_halved_elements(self) -> "OrbitMesh":
        """This mesh with twice as many elements, of lower order."""
        return replace(
            self,
            element_edges=halved_element_edges(self.element_edges),
            order=ceil(ORBIT_MESH_SETTINGS.element_order_ratio_after_halving * self.order),
            order_ratios=tuple(ratio for ratio in self.order_ratios for _ in range(2)),
            spacing_ratios=node_spacing_ratios_of_halves(self.spacing_ratios),
        )

    @property
    def is_allowed(self) -> bool:
        """Whether unknowns and time intervals are within `ORBIT_MESH_SETTINGS`, and the memory of Newton's
        matrix is within `WORKSPACE_SETTINGS`."""
        return (
            self.unknown_count <= ORBIT_MESH_SETTINGS.max_unknown_count
            and self.interval_count <= ORBIT_MESH_SETTINGS.max_time_interval_count
            and factors_size_in_doubles(self.interval_count, self.stage_count, self.unknown_count)
            <= WORKSPACE_SETTINGS.max_buffer_size
        )

    @property
    def elimination_cost(self) -> float:
        """Relative cost of the elimination of Newton's matrix; the number of unknowns is rounded up to a
        multiple of `ORBIT_MESH_SETTINGS.doubles_per_vector_register`."""
        padded_unknown_count = ORBIT_MESH_SETTINGS.doubles_per_vector_register * ceil(
            self.unknown_count / ORBIT_MESH_SETTINGS.doubles_per_vector_register
        )
        return float(padded_unknown_count**3 * self.interval_count * self.stage_count**2)

    def interpolated_orbit(self, orbit: Orbit) -> Orbit:
        """The orbit `orbit` interpolated to this mesh."""
        return orbit.on_mesh(self.space_mesh, *self.time_mesh)


def mesh_of_orbit(orbit: Orbit) -> OrbitMesh:
    """The mesh in space and time on which `orbit` is represented."""
    mesh = orbit.form.mesh
    K, s, grading = orbit.time_mesh
    return OrbitMesh(mesh.edges, mesh.order, K, s, mesh.order_ratios, grading, mesh.node_spacing_ratios)
