"""Model of the computing time along a branch, for the progress display only.

Near the Hopf point where the branch starts steps are short; far from it the mesh is fine. The model was
fitted to branches along F of ten random rods. A branch of the length D in F had used the fraction (d/D)^0.75
of its computing time at the distance d from the Hopf point, within a factor of two for d > D/10. The
computing times of the branches of one rod were proportional to sqrt(D).
"""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ComputingTimeModelSettings:
    """Exponents of the model of the computing time, fitted to measured times."""

    hopf_distance_exponent: float = 0.75
    """Exponent in (d/D)^exponent, the fraction of a branch's computing time used at the distance d from its
    Hopf point; D: length of the branch, both in the parameter coordinate."""
    branch_length_exponent: float = 0.5
    """Exponent of the length D of a branch, in the parameter coordinate, in its computing time."""


COMPUTING_TIME_MODEL_SETTINGS = ComputingTimeModelSettings()


ParameterCoordinateRange = tuple[float, float]
"""Smallest and largest coordinate of the continuation parameter."""


def fraction_done(start: float, current: float, expected_end: float) -> float:
    """Estimated fraction, from 0 to 1, of a branch's computing time that has been used when the parameter
    coordinate is `current`. start, expected_end: parameter coordinates at the start of the branch and at its
    expected end."""
    fraction = (current - start) / (expected_end - start) if expected_end != start else 1.0
    return min(max(fraction, 0.0), 1.0) ** COMPUTING_TIME_MODEL_SETTINGS.hopf_distance_exponent


def time_fractions_before_branches(
    starts: Sequence[float], parameter_range: ParameterCoordinateRange
) -> list[float]:
    """Estimated progress, as fractions of the computing time of all branches: entry i is the fraction that
    branches 0 to i - 1 need, so the last of the (branches + 1,) entries is 1. starts: parameter coordinates
    of the Hopf points where the branches start, in order. parameter_range: range of the parameter
    coordinate."""
    computing_times = [
        max(abs(end - start) for end in parameter_range)
        ** COMPUTING_TIME_MODEL_SETTINGS.branch_length_exponent
        for start in starts
    ]
    times_before = [sum(computing_times[:branch_index]) for branch_index in range(len(computing_times) + 1)]
    return [time / times_before[-1] if times_before[-1] else 1.0 for time in times_before]
