"""Tolerances of Newton's method for a cycle of a requested accuracy, and a check of the size of its
solution."""

from ...orbit.newton import ConvergedOrbit
from ...unsolvable import Unsolvable
from .settings import REFINEMENT_SETTINGS


def newton_tolerance(accuracy: float) -> float:
    """Relative tolerance of Newton's method for a cycle of a given relative accuracy, at least
    `min_newton_tolerance`."""
    settings = REFINEMENT_SETTINGS
    return max(settings.newton_tolerance_per_accuracy * accuracy, settings.min_newton_tolerance)


def allowed_distance_from_matrix_orbit(accuracy: float) -> float:
    """Largest relative distance between a cycle and the orbit at which the matrix of the cycle was assembled,
    for multipliers and tangent of the relative accuracy `accuracy`; between `min_distance_from_matrix_orbit`
    and `max_distance_from_matrix_orbit` of `REFINEMENT_SETTINGS`."""
    settings = REFINEMENT_SETTINGS
    distance = settings.max_matrix_distance_over_accuracy * accuracy
    distance = max(distance, settings.min_distance_from_matrix_orbit)
    return min(distance, settings.max_distance_from_matrix_orbit)


def require_similar_size(solved: ConvergedOrbit, size: float) -> ConvergedOrbit:
    """The solved orbit `solved`; raises Unsolvable if its size divided by `size`, the size of the start, is
    not between `min_solved_to_start_size_ratio` and `max_solved_to_start_size_ratio`."""
    min_size = REFINEMENT_SETTINGS.min_solved_to_start_size_ratio * size
    max_size = REFINEMENT_SETTINGS.max_solved_to_start_size_ratio * size
    if not min_size < solved.orbit.max_energy_norm < max_size:
        raise Unsolvable("the orbit found by Newton's method is far larger or smaller than its start")
    return solved
