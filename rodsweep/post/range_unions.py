"""Ranges of a parameter, their unions and intersections."""

from collections.abc import Iterable

ParameterRange = tuple[float, float]
"""(smallest, largest) value of the followed parameter."""
RANGE_GAP_TOLERANCE = 1e-9
"""Two ranges are joined if the relative gap between the ranges is at most this number."""


def union_of_ranges(ranges: Iterable[ParameterRange]) -> list[ParameterRange]:
    """Union of ranges, in increasing order. Ranges that overlap or touch are joined."""
    found: list[ParameterRange] = []
    for low, high in sorted((float(a), float(b)) for a, b in ranges):
        if found and low <= found[-1][1] * (1 + RANGE_GAP_TOLERANCE):
            found[-1] = found[-1][0], max(high, found[-1][1])
        else:
            found.append((low, high))
    return found


def intersection_of_ranges(first: list[ParameterRange], second: list[ParameterRange]) -> list[ParameterRange]:
    """Intersection of two unions of ranges; ranges of zero length are left out."""
    common = [(max(a, c), min(b, d)) for a, b in first for c, d in second]
    return [(low, high) for low, high in common if high > low * (1 + RANGE_GAP_TOLERANCE)]
