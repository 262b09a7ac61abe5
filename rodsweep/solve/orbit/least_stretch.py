"""Smallest axial stretch h1 of a cycle over the whole rod and period; the model is valid only for h1 > 0."""

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Array, Complex
from ...discretization.element_strains import index_before_jump
from ...discretization.elements.trigonometric import series_maxima, series_samples

if TYPE_CHECKING:
    from .measures import CycleMotion


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
    """If h1 exceeds this number at all nodes, h1 is assumed to be positive between the nodes as well, and is
    not computed there."""
    safe_sampled_stretch: float = 0.02
    """If h1 exceeds this number at all sampled positions, h1 is also positive between the positions, because
    a resolved polynomial varies by less than this number; no search is then made there."""


LEAST_STRETCH_SETTINGS = LeastStretchSettings()


def least_stretch_between_nodes(motion: "CycleMotion", nodal_minimum: float) -> float:
    """Smallest h1 of a cycle over rod and period. nodal_minimum: smallest h1 at the nodes, which is returned
    if it exceeds `safe_nodal_stretch`. Otherwise h1 is sampled between the nodes; if the smallest sample is
    at most `safe_sampled_stretch`, a search around its position follows.
    """
    # Negated, so that nan is returned without a search.
    if not nodal_minimum <= LEAST_STRETCH_SETTINGS.safe_nodal_stretch:
        return nodal_minimum
    return min(nodal_minimum, least_stretch(motion, LEAST_STRETCH_SETTINGS.safe_sampled_stretch))


def least_stretch(motion: "CycleMotion", safe_stretch: float = inf) -> float:
    """Smallest h1 of a cycle over the whole rod and the whole period. safe_stretch: a smallest sampled value
    above `safe_stretch` is returned without a search between the sampled positions; by default the search is
    always made."""
    from scipy.optimize import minimize_scalar  # slow import: 0.1 s, for few runs

    form = motion.orbit.form
    mesh = form.mesh
    c = motion.strain_coefficients[:, 0]

    def least_of_series(coefficients: Complex) -> Array:
        negated = -np.ascontiguousarray(coefficients)
        return -series_maxima(
            negated, series_samples(negated, LEAST_STRETCH_SETTINGS.times_per_harmonic * len(c))
        )

    def least_at(u: Array) -> Array:
        return least_of_series(c @ mesh.one_sided_evaluation_matrix(u).T)

    # A position at a jump belongs to the element on its right, so both sides are taken from the nodes.
    left_indices = [
        index_before_jump(int(node), mesh.element_node_indices) for node in form.nodal_rod.jump_nodes
    ]
    jump_minimum = float(
        least_of_series(c[:, left_indices + [index + 1 for index in left_indices]]).min(initial=inf)
    )
    positions = np.linspace(0.0, 1.0, LEAST_STRETCH_SETTINGS.positions_per_node * len(mesh.node_positions))
    sampled_stretch = least_at(positions)
    best_index = int(np.argmin(sampled_stretch))
    sampled_minimum = min(float(sampled_stretch[best_index]), jump_minimum)
    if sampled_minimum > safe_stretch:
        return sampled_minimum
    search_interval = positions[max(best_index - 1, 0)], positions[min(best_index + 1, len(positions) - 1)]
    tolerance = {"xatol": LEAST_STRETCH_SETTINGS.position_tolerance}
    minimum = minimize_scalar(
        lambda u: float(least_at(np.array([u]))[0]),
        bounds=search_interval,
        method="bounded",
        options=tolerance,
    )
    return min(sampled_minimum, float(minimum.fun))
