"""Text of numbers with errors, and of ranges of numbers, in summaries.

A printed error includes the rounding of its number: the true value lies within the error. The ends of a
range, which have no printed errors, are exact to half a unit of the last digit.
"""

from collections.abc import Mapping, Sequence
from math import ceil, floor, inf, isfinite, isnan, log10

import numpy as np

MAX_DIGITS = 15
"""Largest number of significant digits of a number, however small its error."""
RANGE_DIGITS = 6
"""Largest number of significant digits of an end of a range; larger errors leave fewer."""
END_DIGITS = 9
"""Largest number of significant digits of an end of a range that is a single located value, such
as a fold."""
PLAIN_EXPONENTS = range(-4, MAX_DIGITS)
"""Decimal exponents of numbers that are written without an exponent."""
ROUNDING_EXCESS = 1e-9
"""Relative amount by which rounding may lift an error above a digit without raising the digit."""
MIN_ERROR = 1e-300
"""Smallest error that is rounded up to one digit. For a smaller error the unit of the digit would
underflow."""
NONE = "none"
"""Text for a missing number or an empty range."""


def span(values: np.ndarray, errors: np.ndarray | None = None, most: int = RANGE_DIGITS) -> str:
    """Range of the finite `values`, of any shape, as text; NONE if no value is finite.

    errors: absolute errors, of the shape of the values. They limit the number of digits, which is at most
    `most`.
    """
    values = np.asarray(values, dtype=float)
    is_finite = np.isfinite(values)
    if not is_finite.any():
        return NONE
    known = np.zeros_like(values) if errors is None else np.asarray(errors, dtype=float)
    flat = values[is_finite]
    known = np.nan_to_num(known[is_finite], nan=0.0)
    ends = (int(flat.argmin()), int(flat.argmax()))
    low, high = (rounded(flat[i], known[i], most) for i in ends)
    return low if low == high else f"{low} to {high}"


def listed(ranges: Sequence[tuple[float, float]], errors: Mapping[float, float]) -> str:
    """Ranges of a parameter as text; NONE for an empty list. errors: absolute error of each end that is not
    exact, by end.
    """
    ends = [[_rounded(end, 2 * errors.get(end, 0.0), END_DIGITS) for end in ends] for ends in ranges]
    return ", ".join(" to ".join(pair) for pair in ends) or NONE


def to_error(value: float, error: float) -> str:
    """A number with its absolute error as text. The last digit of the number is the first digit that the
    error reaches.

    If the error is unknown, the number has six digits. NaN gives NONE, and 0 has no error.
    """
    value = float(value)
    error = float(error)
    if not isfinite(value):
        return NONE if isnan(value) else f"{value}"
    if value == 0:
        return "0"
    if not isfinite(error):
        return f"{value:.6g} (error not known)"
    text, stated = stated_error(value, error)
    return f"{text} (+- {error_text(stated)})"


def number_and_error(value: float, error: float) -> tuple[str, str]:
    """(number, error with one digit) as text. The last digit of the number is the first digit that the error
    reaches.

    If the error is unknown, its text is empty and the number has six digits. 0 and inf have no error.
    """
    if value == 0 or not isfinite(value):
        return f"{value + 0.0:g}", ""
    if error == 0:
        return f"{value:.{MAX_DIGITS}g}", ""
    if not isfinite(error):
        return f"{value:.{RANGE_DIGITS}g}", ""
    if error >= abs(value):  # not even the first digit is known
        place = floor(log10(error))
        text = f"{round(value, -place) + 0.0:.{max(-place, 0)}f}"
        return text, error_text(error + abs(float(text) - value))
    text, stated = stated_error(value, error)
    return text, error_text(stated)


def stated_error(value: float, error: float) -> tuple[str, float]:
    """(number as text, error). The error includes the rounding of the number to the first digit that `error`
    reaches.
    """
    text = _rounded(value, error / 10, MAX_DIGITS)
    return text, error + abs(float(text) - value)


def error_text(error: float) -> str:
    """An error as text with one significant digit, rounded up; inf and nan stay as they are."""
    if not MIN_ERROR < error < inf:
        return f"{error:.0e}"
    unit = 10.0 ** floor(log10(error))
    return f"{ceil(error / unit * (1 - ROUNDING_EXCESS)) * unit:.0e}"


def rounded(value: float, error: float, most: int = RANGE_DIGITS) -> str:
    """A number as text with at most `most` significant digits, so that its error is at most half a unit of
    the last digit.
    """
    return _rounded(float(value), 2 * float(error), most) if isfinite(value) else NONE


def _rounded(value: float, error: float, most: int) -> str:
    """A finite number as text, with as many significant digits as its error allows: at least one, at most
    `most`.
    """
    if value == 0:
        return "0"
    size = floor(log10(abs(value)))
    last = floor(log10(error)) if error > 0 and isfinite(error) else size - most
    digits = min(max(size - last, 1), most)
    if most < MAX_DIGITS and digits == most:
        return f"{value:.{most}g}"
    short = f"{value:.{digits - 1}e}"
    return f"{float(short):.{max(digits - 1 - size, 0)}f}" if size in PLAIN_EXPONENTS else short
