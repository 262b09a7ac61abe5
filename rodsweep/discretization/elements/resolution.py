"""Choice of the mesh of a uniform rod: order and number of elements for a wave number and an accuracy.

The constants are fits to 300 random rods (k1, k2 from 20 to inf, gamma3 from 0 to 3, F to 2000) with two to
twelve leading modes. The smallest order of a single element that reaches a relative accuracy 10^-d grows
linearly with the largest wave number |q| of the wanted modes exp(q u).
"""

from dataclasses import dataclass
from math import ceil, hypot, log10, pi


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolutionSettings:
    """Constants of the order and number of elements, fitted to the random rods of the module, and limits of
    meshes.
    """

    base_digits: int = 4
    """Number of digits of accuracy for which the order is order_intercept + order_slope |q|."""
    order_intercept: float = 4.0
    """Order of a single element for `base_digits` digits at |q| = 0."""
    order_slope: float = 0.49
    """Increase of the order for `base_digits` digits per unit of |q|."""
    digit_intercept: float = 0.7
    """Increase of the order for each further digit, at |q| = 0."""
    digit_slope: float = 0.02
    """Increase of `digit_intercept` per unit of |q|."""
    digit_slope_max_wave_number: float = 35.0
    """|q| above which the increase of the order for each further digit is constant."""
    wave_factor: float = 1.4
    """Safety factor on the wave number of the most amplified wave, in the estimate of the largest |q|."""
    mode_offset: float = 0.3
    """Mode n of a rod at rest has |q| near (n - 1/2) pi; (n - mode_offset) pi is an upper estimate."""
    start_accuracy: float = 1e-4
    """Relative accuracy of a mesh whose eigenvalues are then refined to roots of D."""
    max_order: int = 32
    """Maximum order of an element; beyond it, one more element costs less than a higher order."""
    min_order: int = 6
    """Minimum order of an element."""
    max_unknowns: int = 10_000
    """Maximum number of unknowns of a mesh, which takes a few seconds with a sparse factorisation; a rod that
    needs more fails."""
    refinement_ratio: float = 4 / 3
    """Ratio of the number of unknowns of the next finer mesh to that of its predecessor."""


RESOLUTION = ResolutionSettings()


@dataclass(frozen=True, slots=True)
class Resolution:
    """Mesh of a uniform rod: number of equal elements, and their order."""

    elements: int
    order: int

    @property
    def unknowns(self) -> int:
        return 3 * self.elements * self.order


def expected_wave_number(modes: int, most_amplified: float) -> float:
    """An upper estimate of the largest wave number |q| of the leading modes, in 1/L.

    most_amplified: |q| of the most amplified wave. The n-th mode at rest has |q| near (n - 1/2) pi; under
    load the leading modes approach the most amplified wave. The estimate is 0.95 to 1.37 times the true
    maximum for the random rods of the module.
    """
    return hypot(RESOLUTION.wave_factor * most_amplified, (modes - RESOLUTION.mode_offset) * pi)


def mesh_accuracy(accuracy: float, vectors: bool) -> float:
    """Relative accuracy needed of a mesh's eigenvalues, for results of relative accuracy `accuracy`.

    vectors: whether eigenvectors are needed. The error of an eigenvector of the mesh is the square root of
    the eigenvalue's error. Eigenvalues alone are refined to roots of D, so a coarse mesh suffices.
    """
    return accuracy**2 if vectors else RESOLUTION.start_accuracy


def required_order(wave_number: float, accuracy: float) -> float:
    """Order, not rounded up, of a single element that resolves exp(+-q u), |q| = wave_number, to a relative
    accuracy.
    """
    fit = RESOLUTION
    further_digits = max(-log10(accuracy), fit.base_digits) - fit.base_digits
    per_digit = fit.digit_intercept + fit.digit_slope * min(wave_number, fit.digit_slope_max_wave_number)
    return fit.order_intercept + fit.order_slope * wave_number + further_digits * per_digit


def resolution_for(wave_number: float, accuracy: float, largest_order: int | None = None) -> Resolution:
    """The fewest elements, and then the lowest order, that resolve a wave number to a relative accuracy.

    largest_order: maximum order of an element, `RESOLUTION.max_order` by default.
    """
    largest_order = largest_order or RESOLUTION.max_order
    max_elements = RESOLUTION.max_unknowns // (3 * largest_order) + 2  # more unknowns fail anyway
    elements = 1
    while elements < max_elements and required_order(wave_number / elements, accuracy) > largest_order:
        elements += 1
    if elements == max_elements:
        return Resolution(elements, largest_order)
    order = max(RESOLUTION.min_order, ceil(required_order(wave_number / elements, accuracy)))
    return Resolution(elements, order + (1 if elements > 1 else 0))


def finer_resolution(resolution: Resolution) -> Resolution:
    """The next finer resolution, with a third more unknowns: a higher order or, beyond the largest order,
    more elements.
    """
    order = ceil(resolution.order * RESOLUTION.refinement_ratio)
    if order <= RESOLUTION.max_order:
        return Resolution(resolution.elements, order)
    elements = ceil(resolution.elements * RESOLUTION.refinement_ratio)
    nodes = RESOLUTION.refinement_ratio * resolution.elements * resolution.order
    return Resolution(elements, ceil(nodes / elements))
