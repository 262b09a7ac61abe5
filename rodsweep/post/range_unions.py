"""Ranges of a parameter, their unions and intersections."""

from collections.abc import Iterable

ParameterRange = tuple[float, float]
"""(smallest, largest) value of the followed parameter."""
RANGE_GAP_TOLERANCE = 1e-9
"""Two ranges are joined if the relative gap between the ranges is at most this number."""


def union_of_ranges(ranges: Iterable[ParameterRange]) -> list[ParameterRange]:
    """Union of ranges, in increasing order. Ranges that overlap or touch are joined."""
    union: list[ParameterRange] = []
    for low, high in sorted((float(start), float(end)) for start, end in ranges):
        if union and low - union[-1][1] <= RANGE_GAP_TOLERANCE * abs(low):
            union[-1] = union[-1][0], max(high, union[-1][1])
        else:
            union.append((low, high))
    return union


def intersection_of_ranges(first: list[ParameterRange], second: list[ParameterRange]) -> list[ParameterRange]:
    """Intersection of two unions of ranges, each given as a list; ranges of zero length are left out."""
    overlaps = [(max(low1, low2), min(high1, high2)) for low1, high1 in first for low2, high2 in second]
    return [(low, high) for low, high in overlaps if high - low > RANGE_GAP_TOLERANCE * abs(low)]
