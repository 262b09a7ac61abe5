"""Settings for the elements of arms, on which minors of two solutions are integrated."""

import math
from dataclasses import dataclass
from typing import ClassVar

from ....model.compiled.settings import CompiledSettings

MINORS = 5
"""Number of minors of two solutions that are independent."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmElementSettings(CompiledSettings):
    """Settings for the elements of an arm and for the propagators that are kept."""

    longest: float = 3.2
    """Largest |q1 +- q2| h of an element, the exponents of minors: twelve stages integrate exp(3.2) to 1e-19,
    and rounding errors are those of elements half as long."""
    to_apex: float = 0.5
    """Longest element in units of its distance from the apex of the cone, where stiffnesses vanish."""
    largest_tail: float = 1e-9
    """Relative tail of the coefficients' Legendre series above which an element is halved. The error of a
    Gauss method is about the square of the tail."""
    max_halvings: int = 12
    """Maximum number of halvings of an element, down to 2e-4 of the first length."""
    smallest_level: float = 16.0
    """Smallest W: for smaller |w| the load and the taper limit the elements."""
    headroom: float = 1.1
    """W of new elements in units of the |w| they are made for, so that they serve close ones too."""
    highest: float = 1e3
    """Largest W, in units of |w|, of existing elements that serve in place of new ones: making elements costs
    as much as some thirty evaluations on twice as many."""
    highest_compared: float = 1.5
    """As `highest`, for elements on which D is compared with D on others, and which must not be the same."""
    max_elements: int = 4000
    """Maximum number of elements of an arm; an arm that needs more counts as unresolved."""
    stages: int = 12
    """Gauss points of an element. Eleven integrate exp(3.2) to 3e-17, twelve to 1e-19: the twelfth allows for
    coefficients that vary. A multiple of 4, as sums take four at a time."""
    lanes: int = 4
    """Number of elements that are solved together."""
    max_terms: int = 28
    """Largest number of powers of w; 24 are enough for exp(3.2)."""
    negligible: float = 1e-18
    """Size of a term, relative to the first term, at which the polynomial is truncated."""
    arms_kept: int = 16
    """Arms whose propagators are kept: a bound of memory, which changes no number."""

    ranges: ClassVar = {"headroom": (1.0, math.inf)}

    @property
    def width(self) -> int:
        """Number of initial values of all lanes: the length of the last axis of arrays over elements."""
        return MINORS * self.lanes

    @property
    def largest_of_terms(self) -> tuple[float, ...]:
        """The largest |z| at which the first n powers of z are enough, for n = 0, 1, 2, ...

        At |z| = R > 1 the exponents of an element are at most q sqrt(R), q = `longest`. By Cauchy's bound
        with the best R, term n of the propagator is at most (e q/(2 n))^(2 n) |z|^n. From n on, such a term
        of the derivative is at most `negligible`, and each term at most half of the one before.
        """
        factors = [(math.e * self.longest / (2 * n)) ** 2 for n in range(2, self.max_terms)]
        sizes = [
            min((self.negligible / (n * factor**n)) ** (1 / (n - 1)), 1 / (3 * factor))
            for n, factor in enumerate(factors, start=2)
        ]
        return (0.0, 0.0, *sizes)

    def __post_init__(self) -> None:
        CompiledSettings.__post_init__(self)
        if self.stages % 4:
            raise ValueError(f"{self.stages} stages are no multiple of 4")


ARM_ELEMENTS = ArmElementSettings()
