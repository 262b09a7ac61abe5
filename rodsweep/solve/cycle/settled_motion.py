"""Criterion by which an integrated motion has settled on a cycle, the settled motion, and the exception for a
motion without a cycle."""

from dataclasses import dataclass, replace
from math import isfinite, isnan, nan

from ...arrays import Array, list_of
from ..motion.time_scheme import TimeScheme
from .integration_settings import INTEGRATION_SETTINGS
from .status import IntegratedCycleStatus


@dataclass(frozen=True, eq=False)
class SettledMotion:
    """A motion that has settled on a cycle. state: current state of the system, (unknowns,).
    returns_per_period: number of returns of the tip to theta = 0 per period. last_time_step: last time step,
    in tau2."""

    state: Array
    returns_per_period: int
    last_time_step: float


def max_settled_distance_from_cycle(accuracy: float) -> float:
    """Largest relative distance of a settled motion from its cycle, for a requested relative accuracy."""
    return INTEGRATION_SETTINGS.settled_distance_over_accuracy * accuracy


def with_reduced_tolerance(scheme: TimeScheme) -> TimeScheme:
    """The time scheme `scheme` with the local tolerance multiplied by `successive_tolerance_ratio`."""
    return replace(scheme, tolerance=INTEGRATION_SETTINGS.successive_tolerance_ratio * scheme.tolerance)


class ReturnTimeEstimate:
    """Time between returns of the tip to theta = 0, over successive runs of one motion.

    shortest: smallest value of `time_per_return`, in tau2, the period of the leading mode. time_per_return:
    expected time per return, in tau2: the larger of `shortest` and the time between the last two returns. A
    slow-fast cycle may take many time constants of a leading mode that does not oscillate."""

    def __init__(self, shortest: float) -> None:
        self.shortest = self.time_per_return = shortest
        self._elapsed = 0.0
        self._last_return: float | None = None

    def record_run(self, times: Array, duration: float) -> None:
        """Updates `time_per_return` from a run that follows the earlier runs. times: times of the returns,
        (k,), and duration: length of the run, both from the start of the run, in tau2."""
        for time in list_of(self._elapsed + times):
            if self._last_return is not None:
                # Several returns within a period of the leading mode would make the runs too short.
                self.time_per_return = max(self.shortest, time - self._last_return)
            self._last_return = time
        self._elapsed += duration


class ReturnDistances:
    """Relative distances between the returns of a motion that approaches a cycle, measured at successive
    tests.

    integration_error: distance that integration errors alone may cause. are_integration_errors: whether the
    distances are near `integration_error` and no longer decrease. contraction_rate: upper estimate of
    the factor by which the distance from the cycle changes in one period. last: distance at the last test;
    NaN before the first test."""

    def __init__(self, local_tolerance: float) -> None:
        self.last = nan
        self.restart(local_tolerance)

    def restart(self, local_tolerance: float) -> None:
        """Starts the estimates again, for the new local tolerance `local_tolerance` of the integration."""
        self.integration_error = INTEGRATION_SETTINGS.return_error_over_tolerance * local_tolerance
        self.are_integration_errors = False
        self.contraction_rate = 0.0
        self._previous = nan
        self._last_above_error = nan
        self._below_error: list[float] = []
        self._near_error: list[float] = []

    def record_distance(self, distance: float, period_ratio: float) -> None:
        """Records the distance at a test. period_ratio: period divided by the time between two tests."""
        if self._previous > self.integration_error:
            # Below the integration error the quotient of two distances is not the contraction rate.
            self.contraction_rate = (
                min(max(distance, self.integration_error) / self._previous, 1.0) ** period_ratio
            )
        elif isnan(self._previous):
            # A single distance above the error gives no rate; 1 stands for an unknown distance.
            self.contraction_rate = 0.0 if distance <= self.integration_error else 1.0
        if distance > self.integration_error:
            self._last_above_error = distance
            self._below_error = []
        else:
            self._below_error.append(distance)
        last_distances = self._below_error[-INTEGRATION_SETTINGS.min_count_of_distances_below_error :]
        if len(last_distances) == INTEGRATION_SETTINGS.min_count_of_distances_below_error and isfinite(
            self._last_above_error
        ):
            # Distances that stay small are no coincidence, so the integration error is smaller than assumed.
            reduction = max(last_distances) / self._last_above_error
            rate = reduction ** (period_ratio / len(self._below_error))
            self.contraction_rate = min(self.contraction_rate, rate)
        limit = INTEGRATION_SETTINGS.max_ratio_due_to_integration_error * self.integration_error
        self._near_error = [*self._near_error, distance] if distance <= limit else []
        near = self._near_error[-INTEGRATION_SETTINGS.min_count_of_distances_below_error :]
        # The distances of a motion that approaches a cycle slowly decrease.
        self.are_integration_errors = (
            len(near) == INTEGRATION_SETTINGS.min_count_of_distances_below_error and near[-1] >= near[0]
        )
        self.last = self._previous = distance

    def have_settled(self, accuracy: float) -> bool:
        """Whether the motion is so near its cycle that it has settled, for a requested relative accuracy."""
        # For distances in a geometric sequence the distance from the cycle is distance/(1 - rate).
        return self.last <= max_settled_distance_from_cycle(accuracy) * (1 - self.contraction_rate)


class NoCycleFound(Exception):
    """Raised if the motion does not settle on a cycle. status, message: outcome of the motion."""

    def __init__(self, status: IntegratedCycleStatus, message: str) -> None:
        super().__init__(message)
        self.status = status
        self.message = message
