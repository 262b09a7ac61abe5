"""How `rodsweep show` writes a number with its error, and a range of numbers."""

from math import floor, isfinite, isnan, log10

import numpy as np


def span(values: np.ndarray) -> str:
    """The range of the finite values, of any shape, as words; "none" where there are none."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return "none"
    low, high = finite.min(), finite.max()
    return f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"


MOST_DIGITS_SHOWN = 15
"""Digits of a number whose error says that all are known."""


def to_error(value: float, error: float) -> str:
    """A number to the last digit that its absolute error leaves, and the error.

    Six digits are given where the error is not known; "none" where there is no number, "0" where it is exact.
    """
    value, error = float(value), float(error)
    if not isfinite(value):
        return "none" if isnan(value) else f"{value}"
    if value == 0:
        return "0"
    if not isfinite(error):
        return f"{value:.6g} (error not known)"
    size = floor(log10(abs(value)))
    last = floor(log10(error)) if error > 0 else size - MOST_DIGITS_SHOWN
    digits = min(max(size - last, 1), MOST_DIGITS_SHOWN)
    plain = -5 < size < MOST_DIGITS_SHOWN
    text = f"{value:.{max(digits - 1 - size, 0)}f}" if plain else f"{value:.{digits - 1}e}"
    return f"{text} (+- {error:.0e})"
