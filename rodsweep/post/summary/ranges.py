"""How `rodsweep show` writes a number with its error, and a range of numbers.

A number is written to the last digit that its error leaves, and an error is rounded up: the true number lies
within the error that stands beside it, but for half a unit of the last digit.
"""

from collections.abc import Sequence
from math import ceil, floor, isfinite, isnan, log10

import numpy as np

MOST_DIGITS_SHOWN = 15
"""Digits of a number whose error says that all are known."""
DIGITS_OF_RANGE = 6
"""Digits of the ends of a range, where their errors leave so many."""
PLAIN = range(-4, MOST_DIGITS_SHOWN)
"""Decimal exponents of numbers that are written without an exponent."""
UNDER = 1e-9
"""Relative excess over a digit that rounding makes, and which does not raise an error to the next digit."""
LEAST_ERROR = 1e-300
"""Errors below are written as they are: no number has so small a unit."""
NONE = "none"


def span(values: np.ndarray, errors: np.ndarray | None = None) -> str:
    """The range of the finite values, of any shape, as words; "none" where there are none.

    errors: absolute ones, of the same shape, which leave out digits that are not known.
    """
    values = np.asarray(values, dtype=float)
    there = np.isfinite(values)
    if not there.any():
        return NONE
    known = np.zeros_like(values) if errors is None else np.asarray(errors, dtype=float)
    flat, known = values[there], np.nan_to_num(known[there], nan=0.0)
    ends = (int(flat.argmin()), int(flat.argmax()))
    low, high = (_rounded(float(flat[i]), float(known[i]), DIGITS_OF_RANGE) for i in ends)
    return low if low == high else f"{low} to {high}"


def listed(ranges: Sequence[tuple[float, float]]) -> str:
    """Ranges of a parameter as words; "none" where there are none."""
    return ", ".join(f"{a:.9g} to {b:.9g}" for a, b in ranges) or NONE


def to_error(value: float, error: float) -> str:
    """A number to the last digit that its absolute error leaves, and the error.

    Six digits are given where the error is not known; "none" where there is no number, "0" where it is exact.
    """
    value, error = float(value), float(error)
    if not isfinite(value):
        return NONE if isnan(value) else f"{value}"
    if value == 0:
        return "0"
    if not isfinite(error):
        return f"{value:.6g} (error not known)"
    return f"{_rounded(value, error, MOST_DIGITS_SHOWN)} (+- {error_text(error)})"


def error_text(error: float) -> str:
    """An error to one digit, rounded up."""
    if not error > LEAST_ERROR:
        return f"{error:.0e}"
    unit = 10.0 ** floor(log10(error))
    return f"{ceil(error / unit * (1 - UNDER)) * unit:.0e}"


def rounded(value: float, error: float) -> str:
    """A number to the last digit that its absolute error leaves, at most six."""
    return _rounded(float(value), float(error), DIGITS_OF_RANGE) if isfinite(value) else NONE


def _rounded(value: float, error: float, most: int) -> str:
    """A finite number to the last digit that its error leaves, at most so many digits, at least one."""
    if value == 0:
        return "0"
    size = floor(log10(abs(value)))
    last = floor(log10(error)) if error > 0 and isfinite(error) else size - most
    digits = min(max(size - last, 1), most)
    if most == DIGITS_OF_RANGE and digits == most:
        return f"{value:.{most}g}"
    return f"{value:.{max(digits - 1 - size, 0)}f}" if size in PLAIN else f"{value:.{digits - 1}e}"
