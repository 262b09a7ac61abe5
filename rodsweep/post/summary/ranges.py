"""Numbers with errors, and ranges of numbers, as written by `rodsweep show`.

The error beside a number includes the rounding of the number: the true value lies within the error. In a
range, without errors, the error is at most half a unit of the last digit.
"""

from collections.abc import Mapping, Sequence
from math import ceil, floor, inf, isfinite, isnan, log10

import numpy as np

MAX_DIGITS = 15
"""Largest number of digits of a number, however small the error."""
RANGE_DIGITS = 6
"""Largest number of digits of the ends of a range; larger errors leave fewer."""
END_DIGITS = 9
"""Largest number of digits of the end of a range that is a single number, such as a fold."""
PLAIN_EXPONENTS = range(-4, MAX_DIGITS)
"""Decimal exponents of numbers written without an exponent."""
ROUNDING_EXCESS = 1e-9
"""Relative excess of an error over a digit that is rounding, and does not raise the digit."""
MIN_ERROR = 1e-300
"""Smallest error rounded up to a digit; for smaller errors the unit of the digit would underflow."""
NONE = "none"
"""Text for a missing number or range."""


def span(values: np.ndarray, errors: np.ndarray | None = None, most: int = RANGE_DIGITS) -> str:
    """Range of the finite values, of any shape, as text; NONE without a finite value.

    errors: absolute errors, of the shape of the values, which limit the number of digits, at most `most`.
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
    """Ranges of a parameter as text, or NONE. errors: absolute errors of ends that are not exact."""
    ends = [[_rounded(end, 2 * errors.get(end, 0.0), END_DIGITS) for end in ends] for ends in ranges]
    return ", ".join(" to ".join(pair) for pair in ends) or NONE


def to_error(value: float, error: float) -> str:
    """A number to the first digit reached by the absolute error, with the error.

    The number has six digits if the error is unknown. NaN becomes NONE, and 0 is written without error.
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
    """(number to the first digit reached by the error, error with one digit), for the cells of a table.

    The error is empty if it is not known, and then the number has six digits. 0 and inf have no error.
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
    """(number to the first digit reached by the error, error including the rounding of the number)."""
    text = _rounded(value, error / 10, MAX_DIGITS)
    return text, error + abs(float(text) - value)


def error_text(error: float) -> str:
    """An error with one digit, rounded up; inf and nan as they are."""
    if not MIN_ERROR < error < inf:
        return f"{error:.0e}"
    unit = 10.0 ** floor(log10(error))
    return f"{ceil(error / unit * (1 - ROUNDING_EXCESS)) * unit:.0e}"


def rounded(value: float, error: float, most: int = RANGE_DIGITS) -> str:
    """A number with at most `most` digits, and an error of at most half a unit of the last digit."""
    return _rounded(float(value), 2 * float(error), most) if isfinite(value) else NONE


def _rounded(value: float, error: float, most: int) -> str:
    """A finite number with digits larger than the error: at least one digit, at most `most`."""
    if value == 0:
        return "0"
    size = floor(log10(abs(value)))
    last = floor(log10(error)) if error > 0 and isfinite(error) else size - most
    digits = min(max(size - last, 1), most)
    if most < MAX_DIGITS and digits == most:
        return f"{value:.{most}g}"
    short = f"{value:.{digits - 1}e}"
    return f"{float(short):.{max(digits - 1 - size, 0)}f}" if size in PLAIN_EXPONENTS else short
