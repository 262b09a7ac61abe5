"""Settings for a limit cycle by time integration alone (`by_integration`)."""

from dataclasses import dataclass

from ..orbit.matrix.workspace import require_enough_stages


@dataclass(frozen=True, slots=True, kw_only=True)
class IntegrationSettings:
    """Settings for a limit cycle by time integration alone: tolerances, convergence to the cycle, comparison
    of two integrations."""

    local_tolerance_per_accuracy: float = 0.01
    """Local tolerance of the integrator divided by the requested accuracy; the errors of a cycle reach ten
    times the local tolerance."""
    successive_tolerance_ratio: float = 0.2
    """Local tolerance of an integration divided by the tolerance of the previous integration."""
    element_order_increase: int = 2
    """Increase of the element order from an integration to the next, finer integration."""
    max_integration_comparisons: int = 3
    """Maximum number of comparisons of two successive integrations of increasing accuracy."""
    settled_distance_over_accuracy: float = 0.1
    """A motion has settled if its relative distance from the cycle is at most this fraction of the
    accuracy."""
    return_error_over_tolerance: float = 10.0
    """Relative distance between two returns that integration errors alone may cause, divided by the local
    tolerance."""
    min_count_of_distances_below_error: int = 3
    """The integration errors are smaller than assumed if this many successive distances between returns are
    below the distance that integration errors may cause (`return_error_over_tolerance`)."""
    max_ratio_due_to_integration_error: float = 3.0
    """Distances between returns that no longer decrease are integration errors if they are at most this
    factor times the distance that integration errors were assumed to cause; 2.0 was measured at an accuracy
    of 1e-2. The integration is then continued with a smaller local tolerance
    (`successive_tolerance_ratio`)."""
    difference_safety_factor: float = 2.0
    """Safety factor: error estimate divided by the difference between the results of two integrations."""
    max_nearby_rod_error_over_accuracy: float = 0.5
    """For a limiting rod, such as a rod with k1 = inf, integrations are refined until their error is at most
    this fraction of the accuracy; the rest of the accuracy is left for the error of integrating a nearby
    rod."""
    second_rod_limit_distance_ratio: float = 2.0
    """A limiting rod, such as a rod with k1 = inf, is replaced by a nearby rod, whose motion is integrated.
    For the error estimate a second rod is integrated, farther from the limit by this factor. Cycles change in
    proportion to the distance from the limit; with the factor 2 the difference of the two cycles is therefore
    the error of the first."""
    max_local_tolerance_of_measured_run: float = 2e-8
    """Largest local tolerance of the integration from which the cycle is measured. With a larger tolerance,
    the time steps (20 per period at an accuracy of 1e-3) are too long for cubic interpolation: time
    derivatives had errors of 1 to 5 % (`test_marched.py`)."""
    measurement_stage_count: int = 3
    """Number of collocation stages per interval of the orbit from which the cycle is measured."""
    measurement_intervals_per_return: int = 48
    """Number of time intervals, per return of the tip, of the orbit from which the first cycle is
    measured."""
    measurement_interval_growth_factor: int = 2
    """Factor by which the number of time intervals per return grows from a measured cycle to the next, finer
    one, so that the difference of the two cycles contains the error of the measurement."""

    def __post_init__(self) -> None:
        require_enough_stages(self.measurement_stage_count)


INTEGRATION_SETTINGS = IntegrationSettings()
