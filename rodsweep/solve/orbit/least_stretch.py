"""Smallest axial stretch h1 of a cycle over the whole rod and period; the model is valid only for h1 > 0."""

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Array, Complex
from ...discretization.element_strains import index_before_jump
from ...discretization.elements.periodic import series_maxima, series_samples

if TYPE_CHECKING:
    from .measures import CyclePath


@dataclass(frozen=True, slots=True, kw_only=True)
class LeastStretchSettings:
    """Settings for the search for the smallest stretch h1 of a cycle."""

    positions_per_node: int = 8
    """Number of sampled positions on the rod per node of the mesh."""
    times_per_harmonic: int = 8
    """Number of sampled times per harmonic, for the smallest stretch at one position on the rod."""
    position_tolerance: float = 1e-9
    """Tolerance of the position of the smallest stretch, in L. The error of the stretch is of second order in
    this tolerance."""
    safe_nodal_stretch: float = 0.2
    """If h1 exceeds this number at all nodes, h1 is also positive between the nodes, where no search is then
    made."""
    safe_sampled_stretch: float = 0.02
    """If h1 exceeds this number at all sampled positions, h1 is also positive between the positions, because
    a resolved polynomial varies by less than this number; no search is then made there."""


LEAST_STRETCH_SETTINGS = LeastStretchSettings()


def least_stretch_between_nodes(path: "CyclePath", at_nodes: float) -> float:
    """Smallest h1 of a cycle over rod and period: the smallest nodal value `at_nodes` if it exceeds
    `safe_nodal_stretch`, else the smallest sampled value if it exceeds `safe_sampled_stretch`, else the
    minimum found by a search around the position of the smallest sampled value.
    """
    if not at_nodes <= LEAST_STRETCH_SETTINGS.safe_nodal_stretch:
        return at_nodes
    return min(at_nodes, least_stretch(path, LEAST_STRETCH_SETTINGS.safe_sampled_stretch))


def least_stretch(path: "CyclePath", enough: float = inf) -> float:
    """Smallest h1 of a cycle over the whole rod and the whole period. enough: a smallest sampled value above
    `enough` is returned without a search between the sampled positions."""
    from scipy.optimize import minimize_scalar  # slow import: 0.1 s, for few runs

    form = path.orbit.form
    mesh = form.mesh
    c = path.strain_coefficients[:, 0]

    def least_of(coefficients: Complex) -> Array:
        at = -np.ascontiguousarray(coefficients)
        return -series_maxima(at, series_samples(at, LEAST_STRETCH_SETTINGS.times_per_harmonic * len(c)))

    def least(u: Array) -> Array:
        return least_of(c @ mesh.element_evaluation_matrix(u).T)

    before = [index_before_jump(int(node), mesh.element_nodes) for node in form.nodal_rod.jumps]
    at_jumps = float(least_of(c[:, before + [index + 1 for index in before]]).min(initial=inf))
    places = np.linspace(0.0, 1.0, LEAST_STRETCH_SETTINGS.positions_per_node * len(mesh.node_positions))
    values = least(places)
    best = int(np.argmin(values))
    rough = min(float(values[best]), at_jumps)
    if rough > enough:
        return rough
    ends = places[max(best - 1, 0)], places[min(best + 1, len(places) - 1)]
    tolerance = {"xatol": LEAST_STRETCH_SETTINGS.position_tolerance}
    found = minimize_scalar(
        lambda u: float(least(np.array([u]))[0]), bounds=ends, method="bounded", options=tolerance
    )
    return min(rough, float(found.fun))
