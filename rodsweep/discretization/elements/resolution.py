"""Choice of the resolution: order and number of elements for a wave number and an accuracy.

The constants are fits to 300 random rods (k1, k2 from 20 to inf, gamma3 from 0 to 3, F to 2000) with two to
twelve leading modes. The smallest order of a single element that reaches a relative accuracy 10^-d grows
linearly with the largest |q| of the wanted modes exp(q u).
"""

from dataclasses import dataclass
from math import ceil, hypot, log10, pi


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolutionSettings:
    """Order and number of elements for a wave number and an accuracy; fits to the random rods above."""

    base_digits: int = 4
    """Digits of accuracy for which the order is order_intercept + order_slope |q|."""
    order_intercept: float = 4.0
    """Order for `base_digits` digits at |q| = 0."""
    order_slope: float = 0.49
    """Order for `base_digits` digits, per unit of |q|."""
    digit_intercept: float = 0.7
    """Further order for each further digit, at |q| = 0."""
    digit_slope: float = 0.02
    """Further order for each further digit, per unit of |q|."""
    digit_slope_end: float = 35.0
    """The |q| above which the further order for a digit is constant."""
    wave_factor: float = 1.4
    """Factor on the wave number of the most amplified wave, for an upper estimate."""
    mode_offset: float = 0.3
    """Mode n at rest has |q| near (n - 1/2) pi; (n - mode_offset) pi is an upper estimate."""
    start_accuracy: float = 1e-4
    """Relative accuracy of a mesh whose eigenvalues are refined to roots of D."""
    largest_order: int = 32
    """Largest order of an element; beyond this order a further element costs less than a higher order."""
    smallest_order: int = 6
    """Smallest order of an element."""
    most_unknowns: int = 10_000
    """Largest number of unknowns, some seconds with a sparse factorisation; a point that needs more fails."""
    refinement: float = 4 / 3
    """Ratio of the numbers of unknowns of a finer mesh and its predecessor."""


RESOLUTION = ResolutionSettings()


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
    return hypot(RESOLUTION.wave_factor * most_amplified, (modes - RESOLUTION.mode_offset) * pi)


def mesh_accuracy(accuracy: float, vectors: bool) -> float:
    """Relative accuracy of a mesh's eigenvalues, for results of relative accuracy `accuracy`.

    vectors: whether eigenvectors are needed. The error of an eigenvector of the mesh is the square root of
    the eigenvalue's error. Eigenvalues alone are refined to roots of D, so a coarse mesh suffices.
    """
    return accuracy**2 if vectors else RESOLUTION.start_accuracy


def required_order(wave_number: float, accuracy: float) -> float:
    """Order of a single element that resolves exp(+-q u) to the relative accuracy; not rounded up."""
    fit = RESOLUTION
    further_digits = max(-log10(accuracy), fit.base_digits) - fit.base_digits
    per_digit = fit.digit_intercept + fit.digit_slope * min(wave_number, fit.digit_slope_end)
    return fit.order_intercept + fit.order_slope * wave_number + further_digits * per_digit


def resolution_for(wave_number: float, accuracy: float, largest_order: int | None = None) -> Resolution:
    """The smallest sufficient resolution: one element up to the largest order, otherwise equal elements."""
    largest_order = largest_order or RESOLUTION.largest_order
    max_elements = RESOLUTION.most_unknowns // (3 * largest_order) + 2  # more unknowns fail anyway
    elements = 1
    while elements < max_elements and required_order(wave_number / elements, accuracy) > largest_order:
        elements += 1
    if elements == max_elements:
        return Resolution(elements, largest_order)
    order = max(RESOLUTION.smallest_order, ceil(required_order(wave_number / elements, accuracy)))
    return Resolution(elements, order + (1 if elements > 1 else 0))


def finer(resolution: Resolution) -> Resolution:
    """The next finer resolution, with a third more unknowns."""
    order = ceil(resolution.order * RESOLUTION.refinement)
    if order <= RESOLUTION.largest_order:
        return Resolution(resolution.elements, order)
    elements = ceil(resolution.elements * RESOLUTION.refinement)
    nodes = RESOLUTION.refinement * resolution.elements * resolution.order
    return Resolution(elements, ceil(nodes / elements))
