"""Criterion by which an integrated motion has settled on a cycle, the settled motion, and the exception for a
motion without a cycle."""

from dataclasses import dataclass
from math import isnan, nan

from ...arrays import Array
from .marching_settings import MARCHING_SETTINGS
from .status import MarchedStatus


@dataclass(frozen=True, eq=False)
class SettledMotion:
    """A motion that has settled on a cycle. state: present state of the beam, (unknowns,).
    returns_per_period: number of returns of the tip to theta = 0 per period. last_time_step: last time step,
    in tau2."""

    state: Array
    returns_per_period: int
    last_time_step: float


class NoCycleFound(Exception):
    """Raised if the motion does not settle on a cycle. status, message: outcome of the motion."""

    def __init__(self, status: MarchedStatus, message: str) -> None:
        super().__init__(message)
        self.status = status
        self.message = message


def max_settled_distance(accuracy: float) -> float:
    """Largest relative distance of a settled motion from its cycle, for a requested relative accuracy."""
    return MARCHING_SETTINGS.settled_distance_ratio * accuracy


class SettlingCriterion:
    """Criterion by which one integrated motion has settled, tested after every
    `MARCHING_SETTINGS.returns_per_test` returns.

    distance: relative distance between the last two returns one period apart, at the last test; NaN before
    the first test. contraction_rate: estimated ratio of two such distances one period apart, at most 1.
    """

    def __init__(self, accuracy: float, local_tolerance: float) -> None:
        """accuracy: requested relative accuracy of the cycle. local_tolerance: tolerance of the
        integrator."""
        self.distance = nan
        self.contraction_rate = 0.0
        self._limit = max_settled_distance(accuracy)
        self._noise = MARCHING_SETTINGS.return_noise_ratio * local_tolerance

    def is_settled(self, distance: float, returns_per_period: int) -> bool:
        """Whether the distance of the motion from its cycle is at most `max_settled_distance`. distance:
        relative distance between the last two returns one period apart. The method is called once a test."""
        # Below the noise the quotient of two distances is not the contraction rate.
        if self.distance > self._noise:
            ratio = min(max(distance, self._noise) / self.distance, 1.0)
            self.contraction_rate = ratio ** (returns_per_period / MARCHING_SETTINGS.returns_per_test)
        elif isnan(self.distance):
            self.contraction_rate = 0.0 if distance <= self._noise else 1.0
        self.distance = distance
        # For distances in a geometric sequence, the distance from the cycle is distance/(1 - rate).
        return distance <= self._limit * (1 - self.contraction_rate)
