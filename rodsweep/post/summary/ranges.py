"""How `rodsweep show` writes a number with its error, and a range of numbers.

Where an error stands beside a number the true one lies within it, the rounding of both included. Where none
does, as in a range, the error is at most half a unit of the last digit.
"""

from collections.abc import Mapping, Sequence
from math import ceil, floor, isfinite, isnan, log10

import numpy as np

MAX_DIGITS_SHOWN = 15
"""Digits of a number whose error says that all are known."""
DIGITS_OF_RANGE = 6
"""Digits of the ends of a range, where their errors leave so many."""
DIGITS_OF_END = 9
"""Digits of the end of a range that is one number, such as a fold."""
PLAIN = range(-4, MAX_DIGITS_SHOWN)
"""Decimal exponents of numbers that are written without an exponent."""
UNDER = 1e-9
"""Relative excess over a digit that rounding makes, and which does not raise an error to the next digit."""
MIN_ERROR = 1e-300
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
    low, high = (rounded(flat[i], known[i]) for i in ends)
    return low if low == high else f"{low} to {high}"


def listed(ranges: Sequence[tuple[float, float]], errors: Mapping[float, float]) -> str:
    """Ranges of a parameter as words; "none" where there are none.

    errors: absolute ones of those ends that are not exact.
    """
    ends = [[_rounded(end, 2 * errors.get(end, 0.0), DIGITS_OF_END) for end in ends] for ends in ranges]
    return ", ".join(" to ".join(pair) for pair in ends) or NONE


def to_error(value: float, error: float) -> str:
    """A number to the first digit that its absolute error reaches, and the error.

    Six digits are given where the error is not known; "none" where there is no number, "0" where it is exact.
    """
    value, error = float(value), float(error)
    if not isfinite(value):
        return NONE if isnan(value) else f"{value}"
    if value == 0:
        return "0"
    if not isfinite(error):
        return f"{value:.6g} (error not known)"
    text, stated = stated_error(value, error)
    return f"{text} (+- {error_text(stated)})"


def stated_error(value: float, error: float) -> tuple[str, float]:
    """(a number to the first digit that its error reaches, its error with that of rounding the number)."""
    text = _rounded(value, error / 10, MAX_DIGITS_SHOWN)
    return text, error + abs(float(text) - value)


def error_text(error: float) -> str:
    """An error to one digit, rounded up."""
    if not error > MIN_ERROR:
        return f"{error:.0e}"
    unit = 10.0 ** floor(log10(error))
    return f"{ceil(error / unit * (1 - UNDER)) * unit:.0e}"


def rounded(value: float, error: float, most: int = DIGITS_OF_RANGE) -> str:
    """A number to the last digit of which its absolute error is at most a half, so many digits at most."""
    return _rounded(float(value), 2 * float(error), most) if isfinite(value) else NONE


def _rounded(value: float, error: float, most: int) -> str:
    """A finite number to the last digit that is larger than its error: one at least, so many at most."""
    if value == 0:
        return "0"
    size = floor(log10(abs(value)))
    last = floor(log10(error)) if error > 0 and isfinite(error) else size - most
    digits = min(max(size - last, 1), most)
    if most < MAX_DIGITS_SHOWN and digits == most:
        return f"{value:.{most}g}"
    short = f"{value:.{digits - 1}e}"
    return f"{float(short):.{max(digits - 1 - size, 0)}f}" if size in PLAIN else short
