"""Settings for solving a cycle to a requested accuracy (`refinement`)."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class RefinementSettings:
    """Settings for meshes, tolerances and matrices of a cycle of a requested accuracy."""

    newton_tolerance_ratio: float = 1e-2
    """Relative tolerance of Newton's method for a cycle, divided by the requested accuracy."""
    min_newton_tolerance: float = 1e-13
    """Smallest relative tolerance of Newton's method for a cycle: some hundred rounding errors."""
    undecided_accuracy_divisor: float = 100.0
    """A cycle whose largest nontrivial multiplier has modulus 1 within its error is solved again with the
    accuracy divided by this number."""
    matrix_distance_ratio: float = 3.0
    """Largest relative distance between a cycle and the orbit whose matrix gives its multipliers, divided by
    the accuracy."""
    min_matrix_distance: float = 1e-7
    """Lower limit of the relative distance that `allowed_matrix_distance` returns: multipliers need no more
    digits."""
    max_matrix_distance: float = 1e-5
    """Upper limit of the relative distance that `allowed_matrix_distance` returns."""
    multiplier_error_factor: float = 10.0
    """Relative error of the multipliers divided by the sum of two numbers: the relative distance between the
    cycle and the orbit at which the matrix was assembled, and the error of the trivial multiplier."""
    min_accuracy: float = 1e-12
    """Smallest relative accuracy for which a mesh is chosen; smaller errors are rounding errors."""
    min_first_mesh_accuracy: float = 1e-7
    """Smallest relative accuracy for which a first mesh is chosen from the coefficient tails of a nearby
    orbit."""
    nearby_orbit_tolerance: float = 1e-3
    """Relative tolerance of Newton's method for the nearby orbit whose coefficient tails determine the first
    mesh."""
    retry_accuracy_factor: float = 1e-3
    """If a mesh is so coarse that the rod has no cycle on this mesh, the next mesh is chosen for the accuracy
    times this factor."""
    max_retry_mesh_cost: float = 1e8
    """After a mesh without a cycle, a finer mesh is tried only if its number of time intervals times its
    cubed number of unknowns is at most this number. Cycles near a Hopf point need fewer than 20 intervals and
    150 unknowns; without this limit, a motion that never repeats costs a minute."""
    first_mesh_accuracy_ratio: float = 0.5
    """Accuracy for which the first mesh of a single cycle is chosen, divided by the requested accuracy: a
    second mesh costs more than a finer first mesh."""
    min_intervals_for_prediction: int = 6
    """Smallest number of time intervals of a fine mesh whose cycle coarser meshes predict. With 5 intervals,
    the coarser meshes would have 4 and 5 intervals, where errors in time do not decrease as a power yet: the
    error of the largest y was four times its estimate."""
    max_prediction_distance_ratio: float = 30.0
    """Predicted errors are accepted if the relative distance of a cycle from its prediction by coarser
    meshes, divided by the accuracy, is at most this number; the largest observed ratio was 4.4."""
    min_prediction_distance: float = 1e-9
    """Predicted errors are always accepted if the relative distance of a cycle from its prediction is at most
    this, because of rounding errors."""
    min_size_ratio: float = 0.2
    """Smallest size of a solved orbit divided by the size of Newton's start; a smaller orbit is a different
    motion."""
    max_size_ratio: float = 5.0
    """Largest size of a solved orbit divided by the size of Newton's start; a larger orbit is a different
    motion."""
    max_error_increase: float = 10.0
    """Refinement ends if the error estimate increases by more than this factor on a finer mesh; a smaller
    increase may be a coincidence."""
    max_meshes: int = 8
    """Maximum number of meshes tried for one cycle."""


REFINEMENT_SETTINGS = RefinementSettings()
