"""Settings for a limit cycle by time integration alone (`by_integration`)."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class MarchingSettings:
    """Settings for a limit cycle by time integration alone: tolerances, convergence to the cycle, comparison
    of two integrations."""

    local_tolerance: float = 0.01
    """Local tolerance of the integrator, in units of the accuracy; the errors of a cycle reach ten times this
    tolerance."""
    tolerance_ratio: float = 0.2
    """Local tolerance of the second integration, in units of the tolerance of the first integration."""
    order_increase: int = 2
    """Increase of the order of the elements in the second integration."""
    max_comparisons: int = 3
    """Maximum number of comparisons of two integrations; the finer integration of a comparison is the coarser
    integration of the next."""
    settled_distance: float = 0.1
    """Largest relative distance of a settled motion from the cycle, in units of the accuracy."""
    return_noise: float = 10.0
    """Relative distance of two returns that the error of the integrator may cause, in units of the local
    tolerance."""
    first_steps_per_period: int = 1000
    """Number of first time steps of a motion in a period of the leading mode."""
    max_run_duration: int = 3
    """Longest duration of a run, in units of the expected duration of its returns."""
    returns_per_test: int = 5
    """Number of returns of the tip between two tests whether the motion repeats."""
    pair_factor: float = 2.0
    """Safety factor on the difference between two integrations, which gives the error estimate."""
    pair_error_share_in_limit: float = 0.5
    """For a rod in a limit, such as k1 = inf, largest error by two integrations in units of the accuracy. The
    remaining error is due to the integrated rod, which is only near the limit."""
    limit_distance_ratio: float = 2.0
    """Ratio of the distances from a limit of two rods that approximate a rod in the limit. Cycles change in
    proportion to the distance, so the difference of the two cycles is the error of the rod nearer to the
    limit."""
    max_measured_tolerance: float = 2e-8
    """Largest local tolerance of the integration from which the cycle is measured. With a larger tolerance,
    the steps (20 a period at an accuracy of 1e-3) are too long for the cubic between them: rates had errors
    of 1 to 5 % (`test_marched.py`)."""
    measured_stages: int = 3
    """Number of collocation stages per interval of the orbit from which the cycle is measured."""
    measured_intervals: int = 48
    """Number of time intervals, per return of the tip, of the orbit from which the cycle is measured."""


MARCHING = MarchingSettings()
