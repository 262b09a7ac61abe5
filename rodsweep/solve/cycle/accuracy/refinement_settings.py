"""Numbers of the refinement of a cycle (`refinement`)."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class RefinementSettings:
    """Settings for the meshes and Newton tolerances for a cycle of a requested accuracy."""

    newton_share: float = 1e-2
    """Relative tolerance of Newton's method for a cycle, in units of the accuracy."""
    min_newton_tolerance: float = 1e-13
    """Smallest such tolerance: some hundred roundings."""
    undecided_divisor: float = 100.0
    """Divisor of the accuracy of a cycle whose largest multiplier is 1 within its error."""
    matrix_distance_share: float = 3.0
    """Relative distance of Newton's matrix for accurate multipliers, in units of the accuracy."""
    min_matrix_distance: float = 1e-7
    """Smallest such distance: multipliers need no more digits."""
    max_matrix_distance: float = 1e-5
    """Largest such distance."""
    multiplier_factor: float = 10.0
    """Error of the multipliers in units of the matrix's distance plus the trivial multiplier's error."""
    finest_accuracy: float = 1e-12
    """Finest accuracy for which a mesh is chosen by measured errors; smaller errors are rounding errors."""
    first_accuracy: float = 1e-7
    """Finest accuracy for which a mesh is chosen by the tails of a nearby orbit."""
    nearby_tolerance: float = 1e-3
    """Relative Newton tolerance of the nearby orbit, whose tails choose the mesh."""
    aim_factor: float = 1e-3
    """Factor on the accuracy where a mesh is so coarse that it has no cycle."""
    max_retry_work: float = 1e8
    """Intervals times unknowns cubed of the largest finer mesh that is tried for a start without a cycle. The
    cycles born at Hopf points that need one have less than 20 intervals and 150 unknowns; motions that never
    repeat, taken for long cycles, spent a minute there."""
    first_mesh_accuracy: float = 0.5
    """Relative accuracy of a single cycle's first mesh: a second round costs more than a finer first mesh."""
    min_predicted_intervals: int = 6
    """Smallest number of intervals of a predicted mesh. For 5, the prediction would use meshes with 4 and 5,
    where errors in time do not yet fall as a power (the largest y was off by four times its estimate)."""
    predicted_within: float = 30.0
    """Largest distance of a cycle from its prediction, in units of the accuracy, at which predicted errors
    hold: up to 4.4 was seen."""
    min_predicted_distance: float = 1e-9
    """Smallest bound on this distance, for rounding errors."""
    min_size: float = 0.2
    """Smallest size of a solution in units of the start's size: the motion must stay the same."""
    max_size: float = 5.0
    """Largest size of a solution in units of the start's size."""
    allowed_increase: float = 10.0
    """Factor by which an error may grow on a finer mesh, by coincidence."""
    max_rounds: int = 8
    """Maximum number of meshes tried."""


REFINEMENT = RefinementSettings()
