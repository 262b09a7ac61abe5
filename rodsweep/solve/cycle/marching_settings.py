"""Numbers of a cycle by integration alone (`marched`)."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class MarchingSettings:
    """Settings for a cycle by integration alone."""

    local_tolerance: float = 0.01
    """Local tolerance of the integrator in units of the accuracy; a cycle's errors reach ten times as
    much."""
    tolerance_ratio: float = 0.2
    """Tolerance of the second integration in units of the first one's."""
    more_orders: int = 2
    """Additional orders of the mesh of the second integration."""
    max_comparisons: int = 3
    """Maximum number of comparisons; the finer integration of a pair is the coarser one of the next."""
    settled_distance: float = 0.1
    """Relative distance from the cycle, in units of the accuracy, at which a motion has settled."""
    return_noise: float = 10.0
    """Distance of two returns, in units of the tolerance, that the integrator's error may cause."""
    first_steps: int = 1000
    """Period of the leading mode in units of a motion's first time step."""
    longest_wait: int = 3
    """Longest duration of a run in units of the expected duration of its returns."""
    returns_per_test: int = 5
    """Returns of the tip between two tests for repetition."""
    pair_factor: float = 2.0
    """Safety factor on the difference of two integrations."""
    pair_share_in_limit: float = 0.5
    """Share of the accuracy for the error by two integrations, where the rod is in a limit; the rest is left
    for the distance of the integrated rod from the limit."""
    limit_distance_ratio: float = 2.0
    """Ratio of the distances from a limit of two rods that approximate a rod in the limit. Cycles change in
    proportion to the distance, so the cycles' difference is the error of the nearer approximation."""
    measured_tolerance: float = 2e-8
    """Largest local tolerance of the integration that is measured. The long steps of a larger tolerance, 20
    a period at an accuracy of 1e-3, are too few for the cubic between them: rates were 1 to 5 % off
    (`test_marched.py`)."""
    measured_stages: int = 3
    """Collocation stages of the measured orbit."""
    measured_intervals: int = 48
    """Intervals of the measured orbit per return of the tip."""


MARCHING = MarchingSettings()
