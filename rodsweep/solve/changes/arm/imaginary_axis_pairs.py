"""Pairs of eigenvalues near the imaginary axis, with their tangents along a path of arms."""

from dataclasses import dataclass
from typing import NamedTuple


@dataclass(frozen=True, slots=True, kw_only=True)
class ImaginaryAxisModeSettings:
    """Settings of the eigenvalues that are computed for selected arms during a search for crossings, and of
    the test whether a pair may cross the imaginary axis between two of these arms."""

    max_growing_count_for_leading_modes: float = 16.0
    """If a certificate is requested and more modes of an arm than this number are expected to grow, only the
    modes near the imaginary axis are computed."""
    max_computed_modes: int = 200
    """Maximum number of leading eigenvalues computed for one arm."""
    max_change_unexplained_by_slopes: float = 0.1
    """If the tangent of a pair meets the imaginary axis within an interval, the slopes must explain the
    change of growth rate and of frequency to this fraction; else both ends may show different pairs. Two
    different pairs, one at each end, agreed to 0.12 by chance."""
    max_growth_rate_per_frequency: float = 0.15
    """A growing pair at one end of an interval is expected among the growing pairs near the imaginary axis at
    the opposite end if its growth rate there, by its tangent, is positive and at most this multiple of its
    frequency."""
    max_relative_frequency_change: float = 0.3
    """A growing pair at one end of an interval and a pair at the opposite end are the same if their
    frequencies, the first extrapolated along its tangent, differ by at most this fraction."""


IMAGINARY_AXIS_MODE_SETTINGS = ImaginaryAxisModeSettings()


class PairNearImaginaryAxis(NamedTuple):
    """A pair of eigenvalues: distance from the imaginary axis and frequency, both in 1/tau2, with their
    derivatives (`distance_slope`, `frequency_slope`) with respect to the path variable p."""

    distance: float
    distance_slope: float
    frequency: float
    frequency_slope: float

    def min_distance_on_tangent(self, step: float) -> float:
        """Smallest distance from the imaginary axis on the tangent over a change `step` of p."""
        return self.distance + min(step * self.distance_slope, 0.0)

    def is_missing_in(self, pairs: "list[PairNearImaginaryAxis]", step: float) -> bool:
        """Whether this growing pair, by its tangent, is expected among `pairs`, the growing pairs after a
        change `step` of p, but has no counterpart there."""
        distance = self.distance + step * self.distance_slope
        frequency = self.frequency + step * self.frequency_slope
        settings = IMAGINARY_AXIS_MODE_SETTINGS
        return 0 < distance < settings.max_growth_rate_per_frequency * frequency and all(
            abs(pair.frequency - frequency) > settings.max_relative_frequency_change * frequency
            for pair in pairs
        )
