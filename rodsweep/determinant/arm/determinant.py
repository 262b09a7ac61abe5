"""D(w) of one arm that varies along its length, from elements whose length depends on |w|.

The propagators of an element are polynomials in w/W that are valid for |w| <= W. Every bound W has its own
elements, made at first use. Elements are so short that the fastest local exponential grows at most by
exp(`ARM_ELEMENT_SETTINGS.max_exponent`) over an element, and that the Gauss points resolve the coefficients.
Elements end at every break of the profile."""

from functools import cached_property, lru_cache
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...model.dispersion import sampled_arm
from ...model.local_coefficients import local_coefficient_array
from ...model.material.rod_material import LocalCoefficients
from ...model.rod import Rod
from ..value import DeterminantValue, root_error_w_scale_and_wave_number
from .elements.edges import edges_with_coarse_elements_halved, element_edges, two_sum
from .elements.propagators import element_propagators, gauss_method
from .elements.settings import ARM_ELEMENT_SETTINGS
from .local_waves import ExponentSamples, exponent_samples, mean_wave_number_and_w_scale
from .value import determinant_from_propagators

PropagatorsUpToW = tuple[float, Array]
"""(W, propagators that are valid for |w| <= W, (elements, terms, PROPAGATOR_LENGTH))."""


class ArmDeterminant:
    """Characteristic determinant D(w) of one arm. Propagators for |w| <= W are made once and reused.
    propagator_set: (W, propagators) of this arm made earlier. Values raise FloatingPointError if
    `max_elements` elements do not resolve the arm."""

    def __init__(self, rod: Rod, propagator_set: PropagatorsUpToW | None = None):
        self.rod = rod
        self._known_propagators: list[PropagatorsUpToW] = [] if propagator_set is None else [propagator_set]
        points, weights, coefficients = sampled_arm(rod)
        self.samples = exponent_samples(float(rod.F), coefficients, weights)
        with_arm_dimension = LocalCoefficients(*(x[None] for x in coefficients))
        # The mean of c2 gamma2 + c3 gamma3 is the square of an exponent per w: a large drag slows all motion.
        mean_drag = float(self.samples.squared_exponent_coefficients[0] @ weights)
        self._smallest_W = ARM_ELEMENT_SETTINGS.min_W / max(1.0, mean_drag)
        self._coefficient_samples = CoefficientSamples(
            points, with_arm_dimension, self.samples.squared_exponent_coefficients[:, None]
        )

    def value(self, w: complex) -> DeterminantValue:
        """D and D' = dD/dw at w, times exp(-S), S = `log_scale` of the result."""
        W, polynomials = self.propagators_for(abs(w))
        return determinant_from_propagators(complex(w), W, polynomials)

    def value_on_finer_elements(self, w: complex, w_factor: float) -> DeterminantValue:
        """`value` at w, from elements made for w_factor * |w|, w_factor >= 1. The differences between values
        for several factors show the rounding error of D."""
        W, polynomials = self.propagators_for(
            w_factor * abs(w), ARM_ELEMENT_SETTINGS.max_reused_W_over_w_in_comparisons
        )
        return determinant_from_propagators(complex(w), W, polynomials)

    def mean_wave_number_bound(self, w: complex) -> float:
        """Mean along the arm of the local bounds of |q| in the exponentials exp(+-q u) at w, in 1/L."""
        return mean_wave_number_and_w_scale(w, self.samples)[0]

    def w_scale(self, w: complex) -> float:
        """Change of w, in 1/tau2, over which an exponent of D, integrated along the arm, changes by about
        1."""
        return mean_wave_number_and_w_scale(w, self.samples)[1]

    @cached_property
    def exponent_samples_at_gauss_points(self) -> ExponentSamples:
        """Coefficients of the local exponents of the arm at the Gauss points of each interval between breaks
        of the profile."""
        points, _, weights = gauss_method(ARM_ELEMENT_SETTINGS.stage_count)
        lengths = np.diff(self.rod.material.breaks)[:, None]
        coefficients = self.rod.local_coefficients(
            (self.rod.material.breaks[:-1, None] + lengths * points).ravel()
        )
        return exponent_samples(float(self.rod.F), coefficients, (lengths * weights).ravel())

    def propagators_for(self, min_W: float, max_ratio: float | None = None) -> PropagatorsUpToW:
        """Returns (W, propagators that are valid for |w| <= W, (elements, terms, PROPAGATOR_LENGTH)) with W
        >= min_W. Existing propagators with the smallest such W are reused if W <= max_ratio * min_W;
        otherwise new propagators are made. max_ratio: by default
        `ARM_ELEMENT_SETTINGS.max_reused_W_over_w`."""
        max_ratio = ARM_ELEMENT_SETTINGS.max_reused_W_over_w if max_ratio is None else max_ratio
        min_W = max(min_W, self._smallest_W)
        for known_set in self._known_propagators:
            if min_W <= known_set[0] <= max_ratio * min_W:
                return known_set
        W = ARM_ELEMENT_SETTINGS.W_over_w * min_W
        elements = elements_for([self.rod], self._coefficient_samples, W)
        propagator_set = (
            W,
            element_propagators([self.rod.F], elements.local_coefficients, elements.lengths, W)[0],
        )
        self._known_propagators = sorted([*self._known_propagators, propagator_set], key=itemgetter(0))
        return propagator_set


class CoefficientSamples(NamedTuple):
    """Coefficients of n arms at points between the breaks of their profile. points: material coordinates u,
    (points,). local_coefficients: `LocalCoefficients` at the points, each (n, points).
    squared_exponent_coefficients: coefficients of the squared local exponents z+-(w), as in
    `ExponentSamples`, (4, n, points)."""

    points: Array
    local_coefficients: LocalCoefficients
    squared_exponent_coefficients: Array


class ElementsOfArms(NamedTuple):
    """Elements of n arms: their lengths, (elements,), and `LocalCoefficients` at their Gauss points,
    (6, n, elements, stages)."""

    lengths: Array
    local_coefficients: Array
    """`LocalCoefficients` of n arms at the Gauss points of the elements, (6, n, elements, stages)."""


def coefficient_samples(rods: list[Rod]) -> CoefficientSamples:
    """The `CoefficientSamples` of the arms `rods`, whose profiles have equal breaks."""
    # On a path of tapers the arm without taper has few points: the points of any other arm serve all.
    points, weights, _ = sampled_arm(min(rods, key=lambda rod: rod.material.is_piecewise_constant(rod.taper)))
    coefficients = LocalCoefficients(*local_coefficient_array(rods, points))
    forces = np.array([[rod.F] for rod in rods])
    return CoefficientSamples(
        points, coefficients, exponent_samples(forces, coefficients, weights).squared_exponent_coefficients
    )


def elements_for(rods: list[Rod], samples: CoefficientSamples, W: float) -> ElementsOfArms:
    """The elements that resolve every arm of `rods` for |w| <= W; all arms have the same material. samples:
    result of `coefficient_samples` for `rods`. Raises FloatingPointError if `max_elements` elements do not
    resolve an arm."""
    tapers = np.array([rod.taper for rod in rods])
    edges = element_edges(
        W, samples.squared_exponent_coefficients, tapers, samples.points, rods[0].material.breaks
    )
    forces = np.array([rod.F for rod in rods], float)
    points, _, _ = gauss_method(ARM_ELEMENT_SETTINGS.stage_count)
    for _ in range(ARM_ELEMENT_SETTINGS.max_halvings):
        if not len(edges) <= ARM_ELEMENT_SETTINGS.max_elements:
            break
        lengths = edges[1:] - edges[:-1]
        u, remainder = two_sum(edges[:-1, None], lengths[:, None] * points)
        coefficients = local_coefficient_array(rods, u, remainder)
        halved_edges = edges_with_coarse_elements_halved(edges, W, forces, coefficients)
        if halved_edges is edges:
            return ElementsOfArms(lengths, coefficients)
        edges = halved_edges
    max_elements = ARM_ELEMENT_SETTINGS.max_elements
    raise FloatingPointError(
        f"the determinant of this arm at |w| = {W:g} needs more than the maximum of {max_elements} elements"
    )


@lru_cache(maxsize=ARM_ELEMENT_SETTINGS.max_cached_arms)
def arm_determinant(rod: Rod) -> ArmDeterminant:
    """The determinant D of an arm, cached: propagators made for one w serve later calls."""
    return ArmDeterminant(rod)


def eigenfunction_wave_number(rod: Rod, w: complex) -> float:
    """Bound of |q| in the exponentials exp(+-q u) of the eigenfunction at w, in 1/L. For an arm that is not
    uniform or not of linear material the result is the mean along the arm of the local bounds, which is not a
    bound."""
    if rod.is_uniform_and_linear:
        return root_error_w_scale_and_wave_number(w, rod.coefficients)[2]
    return arm_determinant(rod).mean_wave_number_bound(w)


def forget_arm_determinants() -> None:
    """Empties the cache of `arm_determinant`. Propagators made earlier for a larger |w| change D by rounding
    errors; a point or a search that begins with an empty cache therefore has the same result in every
    process."""
    arm_determinant.cache_clear()
