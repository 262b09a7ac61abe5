"""Choice of the mesh of an arm: edges and order of its elements."""

from dataclasses import dataclass
from functools import lru_cache
from math import ceil, hypot, log, pi

import numpy as np
from numpy.polynomial.legendre import legvander

from ...arrays import Array, list_of
from ...model.dispersion import (
    fastest_growing_wave_numbers_at_ends,
    most_amplified_local_waves,
    sampled_arm,
)
from ...model.material.rod_material import RodMaterial
from ...model.rod import Rod
from ..elements.elements import ELEMENT_SETTINGS, Elements
from ..elements.quadrature import gauss_legendre_rule
from ..elements.resolution import (
    RESOLUTION_SETTINGS,
    first_excessive_element_count,
    required_element_count,
    required_order,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmResolutionSettings:
    """Settings for the mesh of an arm that varies along its length."""

    max_element_radius_ratio: float = 2.2
    """Maximum ratio of the radii at both ends of a cone's element, at which order 12 gives eigenvalues to
    1e-4."""
    profile_order_increase: int = 2
    """Increase of the order if coefficients vary within an element."""
    graded_element_length_ratio: float = 3.0
    """Length of an element divided by the length of the next element, nearer to an end of the arm at which a
    wave grows."""
    last_coefficient_count: int = 3
    """Number of the last Legendre coefficients whose size is that of the terms omitted after them; a single
    coefficient may be 0 by symmetry."""
    max_unknowns_of_halved_elements: int = 1100
    """Elements are not halved where the coefficients vary quickly if the mesh would have more unknowns; dense
    linear algebra on a larger mesh takes seconds."""


ARM_RESOLUTION_SETTINGS = ArmResolutionSettings()


class ArmMesh(Elements):
    """Elements for an `ArmPencil`; an edge must lie at every jump of a coefficient of the arm."""

    @property
    def unknown_count(self) -> int:
        """Total number of unknowns y, theta and s."""
        return 3 * self.node_count


def arm_mesh(rod: Rod, mode_count: int, accuracy: float) -> ArmMesh:
    """The mesh expected to give `mode_count` leading eigenvalues of the arm `rod` to the relative
    `accuracy`."""
    weights = sampled_arm(rod).interval_lengths
    _, amplified_q = most_amplified_local_waves(rod)
    unloaded_q = (mode_count - RESOLUTION_SETTINGS.mode_number_offset) * pi * _wave_number_over_mean(rod)
    wave_numbers = np.hypot(RESOLUTION_SETTINGS.amplified_wave_safety_factor * amplified_q, unloaded_q)
    order_increase = (
        0 if rod.material.is_piecewise_constant(rod.taper) else ARM_RESOLUTION_SETTINGS.profile_order_increase
    )
    elements = _elements_for_wave(
        rod, wave_numbers * weights, accuracy, RESOLUTION_SETTINGS.max_order, order_increase
    )
    return _cached_mesh(elements.edges, elements.order)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _cached_mesh(edges: tuple[float, ...], order: int) -> ArmMesh:
    """The `ArmMesh` with these edges and this order, cached with its computed properties."""
    return ArmMesh(edges, order)


def graded_towards_ends(rod: Rod, mesh: ArmMesh) -> ArmMesh:
    """The mesh with elements graded towards each end of the arm at which the fastest growing local wave is
    too short for `mesh`; `mesh` itself if there is no such end. The leading eigenfunctions of an arm with a
    thin end, where g < 0, are confined to a small fraction of the last element."""
    wave_numbers = fastest_growing_wave_numbers_at_ends(rod)
    edges = np.array(mesh.edges)
    first = _end_element_division_distances(float(edges[1]), mesh.order, float(wave_numbers[0]))
    last = _end_element_division_distances(float(edges[-1] - edges[-2]), mesh.order, float(wave_numbers[1]))
    if not len(first) and not len(last):
        return mesh
    return ArmMesh((0.0, *first, *mesh.edges[1:-1], *(1 - last[::-1]), 1.0), mesh.order)


def _end_element_division_distances(length: float, order: int, wave_number: float) -> Array:
    """Distances from an end of the arm, increasing, of the points at which the element at this end is
    divided, (n,). length, order: of this element. wave_number: in 1/L. Empty if the element resolves this
    wave number."""
    ratio = ARM_RESOLUTION_SETTINGS.graded_element_length_ratio
    wave_count = wave_number * length / (RESOLUTION_SETTINGS.max_wave_number_per_node * order)
    count = ceil(log(max(wave_count, 1.0), ratio))
    return length * ratio ** -np.arange(count, 0, -1.0)


def arm_elements(rod: Rod, wave_number: float, accuracy: float, max_order: int | None = None) -> Elements:
    """Elements that resolve a field along an arm with the mean wave number `wave_number`, in 1/L, to a
    relative accuracy. max_order: maximum order of an element before `profile_order_increase` is added, by
    default `RESOLUTION_SETTINGS.max_order`."""
    wave_numbers = wave_number * _wave_number_over_mean(rod)
    return _elements_for_wave(
        rod,
        wave_numbers * sampled_arm(rod).interval_lengths,
        accuracy,
        max_order or RESOLUTION_SETTINGS.max_order,
        # Deformation varies the field's coefficients in pieces with constant stiffnesses too.
        0 if rod.is_uniform else ARM_RESOLUTION_SETTINGS.profile_order_increase,
    )


def _wave_number_over_mean(rod: Rod) -> Array:
    """Wave number at each sample of an arm, divided by the mean wave number, (points,), for a bending wave of
    the same frequency along the arm."""
    _, weights, coefficients = sampled_arm(rod)
    wave_number: Array = (coefficients.gamma2 * coefficients.c3) ** 0.25
    return wave_number / (weights @ wave_number)


def _elements_for_wave(
    rod: Rod, phases: Array, accuracy: float, max_order: int, order_increase: int
) -> Elements:
    """Elements that resolve a wave along an arm to a relative accuracy. phases: phase of the wave over each
    sample interval, |q| times length, (n,). max_order: maximum order of an element before `order_increase` is
    added. order_increase: number added to the order that an arm with constant coefficients would need."""
    intervals = len(rod.material.breaks) - 1
    interval_phases = list_of(phases.reshape(intervals, -1).sum(axis=1))
    min_counts = tuple(required_element_count(phase, accuracy, max_order) for phase in interval_phases)
    edges, counts = _edges_and_counts(rod.material, rod.taper, min_counts)
    if max(min_counts) == first_excessive_element_count(max_order):
        return Elements(edges, max_order)  # more unknowns than allowed, whatever the order
    max_phase = max(phase / count for phase, count in zip(interval_phases, counts, strict=True))
    order = max(RESOLUTION_SETTINGS.min_order, ceil(required_order(hypot(max_phase, 1.0), accuracy)))
    return Elements(edges, order + order_increase)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_mesh_pairs)
def _edges_and_counts(
    material: RodMaterial, taper: float, min_counts: tuple[int, ...]
) -> tuple[tuple[float, ...], tuple[int, ...]]:
    """Returns (edges, counts). edges: edges of the elements of an arm, increasing. counts: number of elements
    of each interval between breaks of the profile: at least the number in `min_counts`, more if
    `max_element_radius_ratio` requires more."""
    edges = [0.0]
    counts = []
    for start, stop, min_count in zip(material.breaks[:-1], material.breaks[1:], min_counts, strict=True):
        radius_ratio = _relative_radius_at(taper, stop) / _relative_radius_at(taper, start)
        count = ceil(abs(log(radius_ratio)) / log(ARM_RESOLUTION_SETTINGS.max_element_radius_ratio))
        counts.append(max(1, count, min_count))
        edges += _graded_edges(taper, start, stop, counts[-1])
    return tuple(edges), tuple(counts)


def finer_arm_mesh(rod: Rod, mesh: ArmMesh) -> ArmMesh:
    """The next finer mesh of an arm: the order is multiplied by 4/3 or, if the result exceeds the maximum
    order, the number of elements by 2 and the order by 2/3."""
    order = ceil(mesh.order * RESOLUTION_SETTINGS.finer_over_current_unknowns)
    if order <= RESOLUTION_SETTINGS.max_order:
        return ArmMesh(mesh.edges, order)
    edges = [0.0]
    for start, stop in zip(mesh.edges[:-1], mesh.edges[1:], strict=True):
        edges += _graded_edges(rod.taper, start, stop, 2)
    return ArmMesh(tuple(edges), ceil(RESOLUTION_SETTINGS.finer_over_current_unknowns / 2 * mesh.order))


def halved_where_coefficients_vary(rod: Rod, mesh: ArmMesh, accuracy: float) -> ArmMesh:
    """The mesh with elements halved until the next higher order of a refinement represents every coefficient
    of the arm in every element to the relative `accuracy`. A strain is the product of a compliance and a
    smooth stress, and no polynomial is closer to it than to the compliance."""
    settings = ARM_RESOLUTION_SETTINGS
    order = ceil(RESOLUTION_SETTINGS.finer_over_current_unknowns * mesh.order)
    x, weights = gauss_legendre_rule(order)
    # Row n: weights of the values at the Gauss points in Legendre coefficient n.
    legendre_rows = (np.arange(order) + 0.5)[:, None] * (legvander(x, order - 1) * weights[:, None]).T
    last_rows = legendre_rows[-settings.last_coefficient_count :]
    halved_mesh = mesh
    while halved_mesh.unknown_count <= settings.max_unknowns_of_halved_elements:
        mesh = halved_mesh
        edges = np.array(mesh.edges)
        starts = edges[:-1, None]
        distances = mesh.lengths[:, None] * (x + 1) / 2
        points: Array = starts + distances
        # Rounded points of a short element give a noise that halving does not reduce.
        remainder = distances - (points - starts)
        coefficients = np.stack(np.broadcast_arrays(*rod.local_coefficients(points, remainder)))
        omitted = np.abs(coefficients @ last_rows.T).max(axis=2)
        is_halved = (omitted > accuracy * np.abs(coefficients).max(axis=2)).any(axis=0)
        if not is_halved.any():
            break
        middles = [_graded_edges(rod.taper, edges[e], edges[e + 1], 2)[0] for e in np.flatnonzero(is_halved)]
        halved_mesh = ArmMesh(tuple(list_of(np.sort(np.concatenate([edges, middles])))), mesh.order)
    return mesh


def _relative_radius_at(taper: float, u: float) -> float:
    """Radius of a cone at u, divided by the radius at the base."""
    return 1 - (1 - taper) * u


def _graded_edges(taper: float, start: float, stop: float, element_count: int) -> list[float]:
    """Edges of `element_count` elements from start to stop, without start. All elements have equal ratios of
    the radii at both ends."""
    if element_count == 1:
        return [float(stop)]
    if taper == 1:
        edges: Array = np.linspace(start, stop, element_count + 1)[1:]
    else:
        radii = np.geomspace(
            _relative_radius_at(taper, start), _relative_radius_at(taper, stop), element_count + 1
        )[1:]
        edges = (1 - radii) / (1 - taper)
    # The last edge is the break itself, unrounded, as it is compared exactly with the positions of jumps.
    return [*list_of(edges[:-1]), float(stop)]
