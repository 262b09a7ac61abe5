"""Rounding of numbers and of ranges in sentences about an arm."""

from math import floor, log10

ROUNDING_TOLERANCE = 1e-12
"""Relative tolerance when rounding down. Without this tolerance, 4.7 could be printed as 4.69."""


def three_digit_text(value: float) -> str:
    """`value` as text with three significant digits; with an exponent only from a million and below 1e-4."""
    rounded = float(f"{value:.3g}")
    return f"{rounded:.0f}" if 1000 <= abs(rounded) < 1e6 else f"{rounded:g}"


def three_digit_text_rounded_down(value: float) -> str:
    """A positive `value` as text with three significant digits, rounded down."""
    unit = 10.0 ** (floor(log10(value)) - 2)
    return three_digit_text(floor(value / unit * (1 + ROUNDING_TOLERANCE)) * unit)


def three_digit_range_text(low: float, high: float) -> str:
    """The range from `low` to `high` as text, with three significant digits; a single number if both ends
    round to the same number."""
    ends = [three_digit_text(low), three_digit_text(high)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


def percent_range_text(low: float, high: float) -> str:
    """The range between the fractions `low` and `high` as text in percent, rounded to integers, or to one
    significant digit below 1 percent; a single number if both ends round to the same number."""
    percents = [100 * value for value in sorted((low, high))]
    ends = [f"{value:.0f}" if value >= 1 else f"{value:.1g}" for value in percents]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)
