"""Search by Newton's method for the stable cycle near a motion: when Newton's method starts, and its
failures."""

from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.orbit import Orbit
from ...unsolvable import Unsolvable
from ..accuracy.refined_cycle import RefinedCycle
from ..accuracy.refinement import refined_cycle
from .transient_settings import TRANSIENT_SETTINGS


class CycleSearch:
    """Attempts of Newton's method to find the cycle near one motion. accuracy: requested relative accuracy of
    the cycle. parameter_name: parameter along which the tangent of the cycle is computed, or None.
    unstable_cycle: unstable cycle found or known near the motion, or None. attempt_count: number of attempts
    so far; attempts after `max_newton_start_tightenings` are not counted. min_returns: number of returns of
    the motion before the next attempt. successive_failures: number of attempts that failed since the last
    success."""

    def __init__(
        self,
        accuracy: float,
        parameter_name: str | None,
        unstable_cycle: RefinedCycle | None,
        workspace: NewtonWorkspace,
    ) -> None:
        self.accuracy = accuracy
        self.parameter_name = parameter_name
        self.unstable_cycle = unstable_cycle
        self.workspace = workspace
        self.attempt_count = self.min_returns = self.successive_failures = 0

    def max_return_distance(self, may_settle: bool) -> float:
        """Newton's method starts if the relative distance between two returns is below this number.
        may_settle: whether the path of the motion is stored and shall show how the motion settles, for which
        Newton's method starts later."""
        settings = TRANSIENT_SETTINGS
        divisor = settings.return_distance_divisor_per_attempt**self.attempt_count
        limit = settings.max_return_distance_for_newton / divisor
        return min(limit, settings.max_newton_return_distance_if_stored) if may_settle else limit

    def count_attempt(self, returns: int) -> None:
        """Records an attempt after `returns` returns, and sets `min_returns` of the next attempt; the number
        of returns between two attempts doubles each time."""
        self.min_returns = returns + TRANSIENT_SETTINGS.returns_per_run * 2**self.attempt_count
        self.attempt_count = min(self.attempt_count + 1, TRANSIENT_SETTINGS.max_newton_start_tightenings)

    def stable_cycle_near(self, orbit: Orbit) -> RefinedCycle | None:
        """The stable cycle near the approximate orbit `orbit`. None if Newton's method fails, if the cycle is
        not proved stable, or if it belongs to a family of periodic orbits of any amplitude. An unstable cycle
        is stored in `unstable_cycle`."""
        try:
            cycle = refined_cycle(orbit, self.accuracy, self.workspace, self.parameter_name)
        except Unsolvable:
            self.successive_failures += 1
            return None
        self.successive_failures = 0
        if cycle.is_stable is False:
            self.unstable_cycle = cycle
        # If the largest multiplier is 1 to rounding error, periodic orbits of any amplitude form a family.
        is_isolated = 1 - cycle.largest_multiplier_modulus >= TRANSIENT_SETTINGS.min_unit_circle_distance
        return cycle if cycle.is_stable and is_isolated else None
