"""Text of numbers with errors, and of ranges of numbers, in summaries.

A printed error includes the rounding error of the printed number: the true value lies within the printed
error. The ends of a range have no printed errors; these ends are accurate to half a unit of the last digit.
"""

from collections.abc import Mapping, Sequence
from math import ceil, floor, inf, isfinite, isnan, log10

import numpy as np

MAX_DIGITS = 15
"""Largest number of significant digits of a number with an error."""
MAX_RANGE_END_DIGITS = 6
"""Largest number of significant digits of an end of a range; a large error reduces this number."""
MAX_LOCATED_END_DIGITS = 9
"""Largest number of significant digits of an end of a range, if the end is a located point such as a fold."""
PLAIN_EXPONENTS = range(-4, MAX_DIGITS)
"""Numbers with these decimal exponents are written without an exponent."""
MAX_ROUNDING_EXCESS_OF_ERROR = 1e-9
"""An error that exceeds a one-digit number by at most this relative amount (rounding error) is not rounded up
further."""
MIN_ROUNDED_UP_ERROR = 1e-300
"""Smaller errors are not rounded up, because the unit of their digit would underflow."""
MISSING_VALUE_TEXT = "none"
"""Text for a missing number or an empty range."""


def value_range_text(
    values: np.ndarray, errors: np.ndarray | None = None, max_digits: int = MAX_RANGE_END_DIGITS
) -> str:
    """Range of the finite `values`, of any shape, as text; MISSING_VALUE_TEXT if no value is finite.

    errors: absolute errors, of the shape of the values, which limit the number of digits. max_digits: largest
    number of significant digits.
    """
    values = np.asarray(values, dtype=float)
    is_finite = np.isfinite(values)
    if not is_finite.any():
        return MISSING_VALUE_TEXT
    known_errors = np.zeros_like(values) if errors is None else np.asarray(errors, dtype=float)
    finite_values = values[is_finite]
    known_errors = np.nan_to_num(known_errors[is_finite], nan=0.0)
    ends = (int(finite_values.argmin()), int(finite_values.argmax()))
    low, high = (rounded_text(finite_values[i], known_errors[i], max_digits) for i in ends)
    return low if low == high else f"{low} to {high}"


def axis_values_text(values: np.ndarray) -> str:
    """Range of the values of a parameter, of any shape, as text: "10 to 1000", or "10 to 1000 and inf"."""
    is_finite = np.isfinite(values)
    finite = [value_range_text(values)] if is_finite.any() else []
    return " and ".join([*finite, *(["inf"] if np.isinf(values).any() else [])]) or MISSING_VALUE_TEXT


def parameter_ranges_text(ranges: Sequence[tuple[float, float]], errors: Mapping[float, float]) -> str:
    """Ranges of a parameter as text; MISSING_VALUE_TEXT for an empty list. errors: absolute errors of ends of
    ranges, by end; other ends are exact. Each end is rounded so that its error is at most half a unit of the
    last digit, to MAX_LOCATED_END_DIGITS digits at most."""
    ends = [
        [_rounded_to_error(end, 2 * errors.get(end, 0.0), MAX_LOCATED_END_DIGITS) for end in ends]
        for ends in ranges
    ]
    return ", ".join(" to ".join(pair) for pair in ends) or MISSING_VALUE_TEXT


def number_with_error_text(value: float, error: float) -> str:
    """A number with its absolute error, as text: "1.234 (+- 2e-03)". The last printed digit of the number has
    the decimal place of the error.

    If the error is not finite, the number has six digits. NaN gives MISSING_VALUE_TEXT, and 0 has no error.
    """
    value = float(value)
    error = float(error)
    if not isfinite(value):
        return MISSING_VALUE_TEXT if isnan(value) else f"{value}"
    if value == 0:
        return "0"
    if not isfinite(error):
        return f"{value:.6g} (error not known)"
    text, rounded_error = rounded_number_and_total_error(value, error)
    return f"{text} (+- {error_text(rounded_error)})"


def number_and_error_texts(value: float, error: float) -> tuple[str, str]:
    """Returns (number, error with one digit) as text. The last printed digit of the number has the decimal
    place of the error.

    The text of the error is empty for a value of 0, inf or NaN, for an error of 0 (the number then has 15
    digits), and for an error that is not finite (six digits).
    """
    if value == 0 or not isfinite(value):
        return f"{value + 0.0:g}", ""
    if error == 0:
        return f"{value:.{MAX_DIGITS}g}", ""
    if not isfinite(error):
        return f"{value:.{MAX_RANGE_END_DIGITS}g}", ""
    if error >= abs(value):  # not even the first digit is known
        exponent = floor(log10(error))
        text = f"{round(value, -exponent) + 0.0:.{max(-exponent, 0)}f}"
        return text, error_text(error + abs(float(text) - value))
    text, rounded_error = rounded_number_and_total_error(value, error)
    return text, error_text(rounded_error)


def rounded_number_and_total_error(value: float, error: float) -> tuple[str, float]:
    """Returns (number as text, rounded at the decimal place of `error`; sum of `error` and the rounding
    error)."""
    text = _rounded_to_error(value, error / 10, MAX_DIGITS)
    return text, error + abs(float(text) - value)


def error_text(error: float) -> str:
    """An error as text with one significant digit, rounded up; "inf" or "nan" for an error that is not
    finite."""
    if not MIN_ROUNDED_UP_ERROR < error < inf:
        return f"{error:.0e}"
    unit = 10.0 ** floor(log10(error))
    return f"{ceil(error / unit * (1 - MAX_ROUNDING_EXCESS_OF_ERROR)) * unit:.0e}"


def rounded_text(value: float, error: float, max_digits: int = MAX_RANGE_END_DIGITS) -> str:
    """A number as text with at most `max_digits` significant digits, chosen such that `error` is at most half
    a unit of the last digit; MISSING_VALUE_TEXT for a number that is not finite."""
    return (
        _rounded_to_error(float(value), 2 * float(error), max_digits)
        if isfinite(value)
        else MISSING_VALUE_TEXT
    )


def _rounded_to_error(value: float, error: float, max_digits: int) -> str:
    """A finite number as text with at least one and at most `max_digits` significant digits. The unit of the
    last digit is the smallest power of ten above `error`, if these limits allow."""
    if value == 0:
        return "0"
    size = floor(log10(abs(value)))
    last_exponent = floor(log10(error)) if error > 0 and isfinite(error) else size - max_digits
    digits = min(max(size - last_exponent, 1), max_digits)
    if max_digits < MAX_DIGITS and digits == max_digits:
        return f"{value:.{max_digits}g}"
    shortest = f"{value:.{digits - 1}e}"
    return f"{float(shortest):.{max(digits - 1 - size, 0)}f}" if size in PLAIN_EXPONENTS else shortest
