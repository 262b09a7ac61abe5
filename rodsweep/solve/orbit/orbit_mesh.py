"""Meshes of an orbit in space and time, and the one that an accuracy needs.

How fine a mesh must be is judged by the last coefficients of the orbit's polynomials, its tails. Their
squares are what period and largest deflection follow: these converge twice as fast as states do.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from math import ceil, log

import numpy as np
from numpy.polynomial import legendre

from ...arrays import Array
from ...discretization.collocation import radau
from ...discretization.mesh import Mesh, mesh
from ...discretization.resolution import LARGEST_ORDER
from ...discretization.state_layout import COMPONENTS, plane_layout, stress_place
from ...model.compilation import compiled_for_vectors
from .orbit import Orbit

SPACE_FACTOR, TIME_FACTOR = 5.0, 1.5
"""Largest errors of period and extrema that are stated, in units of the squared tails, as a coarse mesh's
predict these: with them the mesh is fine enough for five rods in six, and costs a fifth more than need be."""
EXPECTED_SHARE = 1 / 3
"""Share of the accuracy that a mesh is chosen for, in space and in time each."""
COARSER_ORDER, COARSER_SHARE = 2, 0.6
"""The coarser mesh has so much less order in each element and this share of the intervals: its errors are
then some ten times as large."""
LEAST_ORDER, LEAST_INTERVALS, MOST_INTERVALS = 8, 4, 256
LEAST_DECAY, LARGEST_DECAY = 0.2, 1.2
"""Bounds of the decay of the coefficients in space, per order, natural logarithm."""
LASTING = 4
"""Coefficients at the end whose size changes smoothly from one orbit to the next."""
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


@dataclass(frozen=True, slots=True)
class Tails:
    """The last coefficients of the polynomials in space and in time in units of the largest ones.

    decay: of those in space, per order, natural logarithm.
    """

    space: float
    time: float
    decay: float


def tails_of(orbit: Orbit) -> Tails:
    """The tails of an orbit."""
    c = _space_coefficients(orbit)
    last = np.hypot(c[:, -1], c[:, -2]) / np.maximum(c.max(axis=1), 1e-300)
    return Tails(float(last.max()), _tail_in_time(orbit), _decay(c))


@compiled_for_vectors
def _decay(c: Array) -> float:
    """The mean slope of the envelope of coefficients, (fields, p + 1), over their upper half."""
    fields, size = c.shape
    middle, highest = (size - 1) / 2 + (size // 2) / 2, 1e-16
    along, squares = 0.0, 0.0
    for k in range(size - 1, size // 2 - 1, -1):
        for a in range(fields):
            highest = max(highest, c[a, k] / max(c[a].max(), 1e-300))
        along += (k - middle) * np.log(highest)
        squares += (k - middle) ** 2
    return min(max(-along / squares, LEAST_DECAY), LARGEST_DECAY)


def _space_coefficients(orbit: Orbit) -> Array:
    """The largest Legendre coefficients of n1, n2 and m3 at the ends of the intervals, (3, p + 1)."""
    grid, ends = orbit.form.mesh, np.ascontiguousarray(orbit.states[:, -1])
    return largest_coefficients(ends, grid.elements, _analysis_on_element(grid.order))


@lru_cache(maxsize=64)
def _analysis_on_element(order: int) -> Array:
    """Matrix, applied from the right, from an element's nodes to Legendre coefficients, (p + 1, p + 1)."""
    return np.ascontiguousarray(legendre_analysis(2 * mesh(1, order).positions - 1).T)


@compiled_for_vectors
def largest_coefficients(states: Array, elements: int, analysis: Array) -> Array:
    """The largest moduli of the coefficients of n1, n2, m3, (3, p + 1), of states (m, n) in all elements."""
    size = len(analysis)
    nodes = elements * (size - 1)
    largest, c = np.zeros((COMPONENTS, size)), np.empty(size)
    for k in range(len(states)):
        for a in range(COMPONENTS):
            for e in range(elements):
                first = stress_place(a, e * (size - 1), nodes)
                known = size if e < elements - 1 else size - 1  # at the tip stresses vanish
                c[:] = 0.0
                for j in range(known):
                    stress = states[k, first + j]
                    for i in range(size):
                        c[i] += stress * analysis[j, i]
                for i in range(size):
                    largest[a, i] = max(largest[a, i], abs(c[i]))
    return largest


def lasting_tails(orbit: Orbit) -> Array:
    """Tails in space and in time that change as smoothly as an orbit does, (2,); in units of largest values.

    A last coefficient alone comes and goes: in space the last LASTING of all points stand for their envelope.
    """
    grid = orbit.form.mesh
    end = largest_end(orbit.points, grid.elements, _lasting_on_element(grid.order))
    return np.array([end, _tail_in_time(orbit)])


@lru_cache(maxsize=64)
def _lasting_on_element(order: int) -> Array:
    """The last LASTING columns of `_analysis_on_element`, (p + 1, LASTING)."""
    return np.ascontiguousarray(_analysis_on_element(order)[:, -LASTING:])


@compiled_for_vectors
def largest_end(points: Array, elements: int, analysis: Array) -> float:
    """The largest end of the coefficients in an element of n1, n2 or m3, in units of its largest value.

    points: (m, n); analysis: from an element's nodes to the coefficients at the end, (p + 1, count).
    """
    size, count = analysis.shape
    nodes, c, worst = elements * (size - 1), np.empty(count), 0.0
    for a in range(COMPONENTS):
        largest, end = 0.0, 0.0
        for k in range(len(points)):
            for e in range(elements):
                first = stress_place(a, e * (size - 1), nodes)
                known = size if e < elements - 1 else size - 1  # at the tip stresses vanish
                c[:] = 0.0
                for j in range(known):
                    stress = points[k, first + j]
                    largest = max(largest, abs(stress))
                    for i in range(count):
                        c[i] += stress * analysis[j, i]
                end = max(end, (c * c).sum())
        worst = max(worst, np.sqrt(end) / max(largest, 1e-300))
    return worst


def _tail_in_time(orbit: Orbit) -> float:
    """Of n1, n2 and m3 the worst."""
    return largest_tail(orbit.points, _last_in_interval(orbit.stages), orbit.form.mesh.nodes)


@lru_cache(maxsize=16)
def _last_in_interval(stages: int) -> Array:
    """Row from the values at an interval's start and stages to the last Legendre coefficient, (s + 1,)."""
    nodes: Array = np.append(0.0, radau(stages).nodes)
    row: Array = legendre_analysis(2 * nodes - 1)[-1]
    return row


@compiled_for_vectors
def largest_tail(points: Array, row: Array, nodes: int) -> float:
    """The largest last coefficient of n1, n2, m3 in an interval, in units of the largest value of each.

    points: start and stages one after the other, (1 + K s, n); row: from an interval's values to that
    coefficient, (s + 1,). Sizes are those of the vectors of a stress at all nodes.
    """
    s, worst = len(row) - 1, 0.0
    for a in range(COMPONENTS):
        largest, tail = 0.0, 0.0
        for m in range(len(points)):
            size = 0.0
            for i in range(nodes):
                size += points[m, stress_place(a, i, nodes)] ** 2
            largest = max(largest, size)
        for k in range(0, len(points) - 1, s):
            size = 0.0
            for i in range(nodes):
                top = 0.0
                for j in range(s + 1):
                    top += row[j] * points[k + j, stress_place(a, i, nodes)]
                size += top**2
            tail = max(tail, size)
        worst = max(worst, np.sqrt(tail / max(largest, 1e-300)))
    return float(worst)


def legendre_analysis(nodes: Array) -> Array:
    """Matrix from values at nodes in [-1, 1], (n,), to Legendre coefficients, (n, n)."""
    return np.linalg.inv(legendre.legvander(nodes, len(nodes) - 1))


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
