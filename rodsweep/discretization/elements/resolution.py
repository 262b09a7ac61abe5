"""Choice of the resolution: order and number of elements for a wave number and an accuracy.

The constants are fits to 300 random rods (k1, k2 from 20 to inf, gamma3 from 0 to 3, F to 2000) with two to
twelve leading modes. The smallest order of a single element that reaches a relative accuracy 10^-d grows
linearly with the largest |q| of the wanted modes exp(q u).
"""

from dataclasses import dataclass
from math import ceil, hypot, log10, pi

BASE_DIGITS = 4
"""Digits of accuracy for which the order is ORDER_INTERCEPT + ORDER_SLOPE |q|."""
ORDER_INTERCEPT = 4.0
"""Order for `BASE_DIGITS` digits at |q| = 0."""
ORDER_SLOPE = 0.49
"""Order for `BASE_DIGITS` digits, per unit of |q|."""
DIGIT_INTERCEPT = 0.7
"""Further order for each further digit, at |q| = 0."""
DIGIT_SLOPE = 0.02
"""Further order for each further digit, per unit of |q|."""
DIGIT_SLOPE_END = 35.0
"""The |q| above which the further order for a digit is constant."""
WAVE_FACTOR = 1.4
"""Factor on the wave number of the most amplified wave, for an upper estimate."""
MODE_OFFSET = 0.3
"""Mode n at rest has |q| near (n - 1/2) pi; (n - MODE_OFFSET) pi is an upper estimate."""
START_ACCURACY = 1e-4
"""Relative accuracy of a mesh whose eigenvalues are refined to roots of D."""
LARGEST_ORDER = 32
"""Largest order of an element; beyond this order a further element costs less than a higher order."""
SMALLEST_ORDER = 6
"""Smallest order of an element."""
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
    """An upper estimate of max |q| over the leading modes; most_amplified: |q| of the most amplified wave.

    The n-th mode at rest has q near (n - 1/2) pi; under load the leading modes approach the most amplified
    wave. The estimate is 0.95 to 1.37 times the true maximum for the random rods above.
    """
    return hypot(WAVE_FACTOR * most_amplified, (modes - MODE_OFFSET) * pi)


def mesh_accuracy(accuracy: float, vectors: bool) -> float:
    """Relative accuracy of a mesh's eigenvalues, for results of relative accuracy `accuracy`.

    vectors: whether eigenvectors are needed. The error of an eigenvector of the mesh is the square root of
    the eigenvalue's error. Eigenvalues alone are refined to roots of D, so a coarse mesh suffices.
    """
    return accuracy**2 if vectors else START_ACCURACY


def required_order(wave_number: float, accuracy: float) -> float:
    """Order of a single element that resolves exp(+-q u) to the relative accuracy; not rounded up."""
    digits = max(-log10(accuracy), BASE_DIGITS)
    per_digit = DIGIT_INTERCEPT + DIGIT_SLOPE * min(wave_number, DIGIT_SLOPE_END)
    return ORDER_INTERCEPT + ORDER_SLOPE * wave_number + (digits - BASE_DIGITS) * per_digit


def resolution_for(wave_number: float, accuracy: float, largest_order: int = LARGEST_ORDER) -> Resolution:
    """The smallest sufficient resolution: one element up to the largest order, otherwise equal elements."""
    max_elements = MOST_UNKNOWNS // (3 * largest_order) + 2  # more unknowns fail anyway
    elements = 1
    while elements < max_elements and required_order(wave_number / elements, accuracy) > largest_order:
        elements += 1
    if elements == max_elements:
        return Resolution(elements, largest_order)
    order = max(SMALLEST_ORDER, ceil(required_order(wave_number / elements, accuracy)))
    return Resolution(elements, order + (1 if elements > 1 else 0))


def finer(resolution: Resolution) -> Resolution:
    """The next finer resolution, with a third more unknowns."""
    order = ceil(resolution.order * 4 / 3)
    if order <= LARGEST_ORDER:
        return Resolution(resolution.elements, order)
    elements = ceil(resolution.elements * 4 / 3)
    return Resolution(elements, ceil(4 / 3 * resolution.elements * resolution.order / elements))
