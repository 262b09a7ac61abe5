"""Choice of the mesh of a uniform rod: order and number of elements for a wave number and an accuracy.

The constants are fits to 300 random rods (k1, k2 from 20 to inf, gamma3 from 0 to 3, F to 2000) with two to
twelve leading modes. The smallest order of a single element with the relative accuracy 10^-d grows linearly
with the largest wave number |q| of the requested modes exp(q u).
"""

from dataclasses import dataclass
from math import ceil, hypot, log10, pi


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolutionSettings:
    """Fitted constants of the order and number of elements (see the module docstring); limits of meshes."""

    reference_digits: int = 4
    """The order of a single element is order_intercept + order_slope |q| for this number of digits of
    accuracy, q: wave number in 1/L."""
    order_intercept: float = 4.0
    """Order of a single element for `reference_digits` digits of accuracy at the wave number |q| = 0."""
    order_slope: float = 0.49
    """Increase of the order per unit of the wave number |q| in 1/L, at `reference_digits` digits of
    accuracy."""
    order_per_digit_intercept: float = 0.7
    """Increase of the order for each digit of accuracy beyond `reference_digits`, at the wave number |q| =
    0."""
    order_per_digit_and_wave_number: float = 0.02
    """Increase of the order for each further digit of accuracy, per unit of the wave number |q| in 1/L; added
    to `order_per_digit_intercept`."""
    wave_number_of_max_order_per_digit: float = 35.0
    """The order grows, for each further digit of accuracy, by an amount that is linear in the wave number |q|
    up to this |q|, in 1/L, and constant beyond."""
    amplified_wave_safety_factor: float = 1.4
    """Safety factor on the wave number of the most amplified wave in the estimate of the largest |q|."""
    mode_number_offset: float = 0.3
    """Mode n of a rod without load has a wave number |q| near (n - 1/2) pi, in 1/L; (n - mode_number_offset)
    pi is used as an upper estimate."""
    accuracy_before_refinement: float = 1e-4
    """Relative accuracy of a mesh if its eigenvalues are then refined to roots of D."""
    max_wave_number_per_node: float = 2.0
    """A mesh represents eigenvalues whose wave number |q|, averaged along the rod, is at most this number
    times elements * order; an element represents |q| up to this number times order/length."""
    max_order: int = 32
    """Maximum order of an element. A further element costs less than a higher order."""
    min_order: int = 6
    """Minimum order of an element."""
    max_unknowns: int = 10_000
    """Maximum number of unknowns of a mesh; a sparse factorisation then takes a few seconds. A rod that needs
    more unknowns fails."""
    finer_over_current_unknowns: float = 4 / 3
    """Number of unknowns of the next finer mesh, divided by the number of unknowns of the current mesh."""


RESOLUTION_SETTINGS = ResolutionSettings()


@dataclass(frozen=True, slots=True)
class Resolution:
    """Mesh of a uniform rod: number of elements of equal length, and their order."""

    element_count: int
    """Number of elements of equal length."""
    order: int

    @property
    def unknown_count(self) -> int:
        """Number of unknowns y, theta and s on this mesh."""
        return 3 * self.element_count * self.order


def expected_wave_number(mode_count: int, amplified_wave_number: float) -> float:
    """Upper estimate of the largest wave number |q| of the leading modes, in 1/L.

    mode_count: number of leading modes. amplified_wave_number: |q| of the most amplified wave. Without load
    the n-th mode has |q| near (n - 1/2) pi; under load the leading modes approach the most amplified wave.
    For the random rods of the module docstring the estimate is 0.95 to 1.37 times the true maximum.
    """
    return hypot(
        RESOLUTION_SETTINGS.amplified_wave_safety_factor * amplified_wave_number,
        (mode_count - RESOLUTION_SETTINGS.mode_number_offset) * pi,
    )


def mesh_accuracy(accuracy: float, needs_vectors: bool) -> float:
    """Relative accuracy that the eigenvalues of a mesh need for results of relative accuracy `accuracy`.

    needs_vectors: whether eigenvectors are needed. The relative error of an eigenvector on a mesh is about
    the square root of the error of its eigenvalue. Without eigenvectors a mesh of the accuracy
    `RESOLUTION_SETTINGS.accuracy_before_refinement` suffices, because the eigenvalues are refined to roots of
    D.
    """
    return accuracy**2 if needs_vectors else RESOLUTION_SETTINGS.accuracy_before_refinement


def required_order(wave_number: float, accuracy: float) -> float:
    """Order, not rounded up, of a single element that resolves exp(+-q u), |q| = wave_number, to the relative
    accuracy `accuracy`."""
    settings = RESOLUTION_SETTINGS
    further_digits = max(-log10(accuracy), settings.reference_digits) - settings.reference_digits
    order_per_digit = settings.order_per_digit_intercept + settings.order_per_digit_and_wave_number * min(
        wave_number, settings.wave_number_of_max_order_per_digit
    )
    return settings.order_intercept + settings.order_slope * wave_number + further_digits * order_per_digit


def first_excessive_element_count(max_order: int) -> int:
    """A number of elements of the order `max_order` with more than `RESOLUTION_SETTINGS.max_unknowns`
    unknowns. It stands for all larger numbers, because no such mesh is solved."""
    return RESOLUTION_SETTINGS.max_unknowns // (3 * max_order) + 2


def required_element_count(phase: float, accuracy: float, max_order: int) -> int:
    """Number of elements of the order `max_order` that resolve an interval in which the phase of the wave
    grows by `phase`, to the relative accuracy `accuracy`. At most `first_excessive_element_count`, with which
    the mesh has too many unknowns."""
    count = 1
    max_count = first_excessive_element_count(max_order)
    while count < max_count and required_order(phase / count, accuracy) > max_order:
        count += 1
    return count


def resolution_for(wave_number: float, accuracy: float, max_order: int | None = None) -> Resolution:
    """The smallest number of elements, and then the lowest order (plus one for several elements), that
    resolve a wave to the relative accuracy `accuracy`.

    If this takes more than `RESOLUTION_SETTINGS.max_unknowns` unknowns, the result is a mesh with too many
    unknowns that need not resolve the wave. wave_number: in 1/L. max_order: maximum order of an element,
    `RESOLUTION_SETTINGS.max_order` by default.
    """
    max_order = max_order or RESOLUTION_SETTINGS.max_order
    element_count = required_element_count(wave_number, accuracy, max_order)
    if element_count == first_excessive_element_count(max_order):
        return Resolution(element_count, max_order)
    order = max(RESOLUTION_SETTINGS.min_order, ceil(required_order(wave_number / element_count, accuracy)))
    return Resolution(element_count, order + (1 if element_count > 1 else 0))


def finer_resolution(resolution: Resolution) -> Resolution:
    """The next finer resolution, with a third more unknowns: a higher order up to the maximum order, then
    more elements."""
    order = ceil(resolution.order * RESOLUTION_SETTINGS.finer_over_current_unknowns)
    if order <= RESOLUTION_SETTINGS.max_order:
        return Resolution(resolution.element_count, order)
    element_count = ceil(resolution.element_count * RESOLUTION_SETTINGS.finer_over_current_unknowns)
    node_count = RESOLUTION_SETTINGS.finer_over_current_unknowns * resolution.element_count * resolution.order
    return Resolution(element_count, ceil(node_count / element_count))
