"""How fine is enough: the order and number of elements for a wave number and an accuracy.

Measured on 300 random rods (k1, k2 from 20 to inf, gamma3 from 0 to 3, F to 2000), for two to twelve
leading modes: the smallest order of a single element that reaches a relative accuracy 10^-d grows
linearly with the largest |q| of the wanted modes, exp(q u), with the intercept and the slope below.
"""

from dataclasses import dataclass
from math import ceil, hypot, log10, pi

ORDER_INTERCEPT, ORDER_SLOPE = 4.0, 0.49
DIGIT_INTERCEPT, DIGIT_SLOPE, DIGIT_SLOPE_END = 0.7, 0.02, 35.0
BASE_DIGITS = 4
WAVE_FACTOR, MODE_OFFSET = 1.4, 0.3
START_ACCURACY = 1e-4
"""Relative accuracy of a mesh whose eigenvalues are refined on D."""
LARGEST_ORDER = 32
"""Largest order of an element; beyond this order a further element costs less than a higher order."""
SMALLEST_ORDER = 6
MOST_UNKNOWNS = 10_000
"""Largest number of unknowns, some seconds with a sparse factorisation; a point that needs more fails."""


@dataclass(frozen=True, slots=True)
class Resolution:
    """Number of equal elements and their order."""

    elements: int
    order: int

    @property
    def unknowns(self) -> int:
        return 3 * self.elements * self.order


def expected_wave_number(modes: int, most_amplified: float) -> float:
    """An estimate from above of max |q| over the leading modes, from the most amplified wave.

    The n-th mode at rest has q near (n - 1/2) pi; under load the leading modes gather round the
    most amplified wave. Within [0.95, 1.37] of the truth on the rods above.
    """
    return hypot(WAVE_FACTOR * most_amplified, (modes - MODE_OFFSET) * pi)


def mesh_accuracy(accuracy: float, vectors: bool) -> float:
    """Relative accuracy of the eigenvalues that a mesh is chosen for.

    A vector is the mesh's own, and its error is the square root of it. Eigenvalues alone only begin on
    the mesh and are refined on D, whatever their accuracy.
    """
    return accuracy**2 if vectors else START_ACCURACY


def required_order(wave_number: float, accuracy: float) -> float:
    """Order of a single element that resolves exp(+-q u) to the relative accuracy, before rounding."""
    digits = max(-log10(accuracy), BASE_DIGITS)
    per_digit = DIGIT_INTERCEPT + DIGIT_SLOPE * min(wave_number, DIGIT_SLOPE_END)
    return ORDER_INTERCEPT + ORDER_SLOPE * wave_number + (digits - BASE_DIGITS) * per_digit


def resolution_for(wave_number: float, accuracy: float, largest_order: int = LARGEST_ORDER) -> Resolution:
    """The smallest resolution: one element up to the largest order, then equal elements that share q."""
    most = MOST_UNKNOWNS // (3 * largest_order) + 2  # more is given up anyway
    elements = 1
    while elements < most and required_order(wave_number / elements, accuracy) > largest_order:
        elements += 1
    if elements == most:
        return Resolution(elements, largest_order)
    order = max(SMALLEST_ORDER, ceil(required_order(wave_number / elements, accuracy)))
    return Resolution(elements, order + (1 if elements > 1 else 0))


def finer(resolution: Resolution) -> Resolution:
    """The next resolution after one that proved too coarse: a third more unknowns."""
    order = ceil(resolution.order * 4 / 3)
    if order <= LARGEST_ORDER:
        return Resolution(resolution.elements, order)
    elements = ceil(resolution.elements * 4 / 3)
    return Resolution(elements, ceil(4 / 3 * resolution.elements * resolution.order / elements))
