"""Settings for the elements of an arm, over which the minors of two solutions are integrated."""

import math
from dataclasses import dataclass
from typing import ClassVar

from ....model.compiled.kernel_constants import KernelConstants

MINOR_COUNT = 5
"""Number of independent minors of two solutions of the transverse problem."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmElementSettings(KernelConstants):
    """Settings for the elements of an arm and for the cache of propagators."""

    max_exponent: float = 3.2
    """Largest |q1 +- q2| h of an element of length h, for solutions exp(+-q1 u), exp(+-q2 u) of the linear
    problem: their 2 x 2 minors grow like exp((q1 + q2) h). Twelve Gauss points integrate exp(3.2) to 1e-19,
    with rounding errors like those of elements half as long."""
    max_exponent_excess_factor: float = 1.1
    """An element is halved if its largest exponent, integrated at its Gauss points, exceeds `max_exponent` by
    more than this factor: `max_terms` powers of w and twelve Gauss points suffice up to about 3.7."""
    max_length_over_apex_distance: float = 0.5
    """Largest length of an element divided by the distance from the cone's apex, where stiffnesses vanish."""
    max_coefficient_tail: float = 1e-9
    """An element is halved if one of the last two Legendre coefficients of nu, c2, ... over the element
    exceeds this fraction of its largest value. The error of a Gauss method is about this fraction squared."""
    max_halvings: int = 28
    """Maximum number of halvings of an element, down to 4e-9 of the first length. If a factor of a profile
    grows a million times between two rows, a compliance, as a function of complex u, has a pole whose
    distance from the row with the small factor is only a millionth of the distance between the rows."""
    min_W: float = 16.0
    """Smallest W, the bound of |w| up to which elements are valid; for smaller |w| the load and the taper,
    not w, determine the length of elements. If the mean of c2 gamma2 + c3 gamma3 along the arm exceeds 1,
    this number is divided by the mean."""
    W_over_w: float = 1.1
    """New elements are valid up to W = W_over_w |w|: the reserve is for slightly larger |w|."""
    max_reused_W_over_w: float = 1e3
    """Existing elements are reused at w if their W is at most this number times |w|. Making new elements
    costs as much as thirty evaluations of D on twice as many elements."""
    max_reused_W_over_w_in_comparisons: float = 1.5
    """Value of `max_reused_W_over_w` for comparisons of D on different elements; near 1, so that the elements
    differ."""
    max_elements: int = 16000
    """Maximum number of elements of an arm. An arm that needs more elements is not resolved."""
    stage_count: int = 12
    """Number of Gauss points of an element. Eleven integrate exp(3.2) to 3e-17, twelve to 1e-19: the twelfth
    allows for coefficients that vary. A multiple of 4, so that rows are whole vector instructions."""
    lane_count: int = 4
    """Number of elements that are solved together by vector instructions."""
    max_terms: int = 28
    """Maximum number of powers of w in a propagator; 24 suffice for the largest exponent 3.2 of an
    element."""
    negligible_term_over_largest: float = 1e-18
    """The series of a propagator in w ends at the first term that is, in every entry of the propagator, below
    this fraction of the largest earlier term of the entry."""
    max_cached_arms: int = 16
    """Maximum number of arms whose propagators are cached. It limits the memory and changes no result."""

    field_ranges: ClassVar = {"W_over_w": (1.0, math.inf)}
    """Exclusive bounds (lower, upper) of fields, by name, that the proofs require; see `KernelConstants`."""

    @property
    def lane_axis_length(self) -> int:
        """Length of the last axis of arrays over elements: number of initial values times number of lanes."""
        return MINOR_COUNT * self.lane_count

    @property
    def largest_z_by_term_count(self) -> tuple[float, ...]:
        """The largest |z| at which the first n powers of z are enough, for n = 0, 1, 2, ...

        At |z| = R > 1 the exponents of an element are at most q sqrt(R), q = `max_exponent`. By Cauchy's
        bound with the best R, term n of the propagator is at most (e q/(2 n))^(2 n) |z|^n. From n on, such a
        term of the derivative is at most `negligible_term_over_largest`, and each term at most half of the
        previous term.
        """
        factors = [(math.e * self.max_exponent / (2 * n)) ** 2 for n in range(2, self.max_terms)]
        sizes = [
            min((self.negligible_term_over_largest / (n * factor**n)) ** (1 / (n - 1)), 1 / (3 * factor))
            for n, factor in enumerate(factors, start=2)
        ]
        return (0.0, 0.0, *sizes)

    def __post_init__(self) -> None:
        KernelConstants.__post_init__(self)
        if self.stage_count % 4:
            raise ValueError(f"stage_count = {self.stage_count} is not a multiple of 4")


ARM_ELEMENT_SETTINGS = ArmElementSettings()
