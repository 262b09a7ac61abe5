"""What happens at a special point of a branch, and what is known of it."""

from dataclasses import dataclass, field
from enum import IntEnum
from math import nan

from ...orbit.orbit import Orbit


class SpecialKind(IntEnum):
    """What happens at a special point of a branch."""

    hopf = 1
    fold = 2
    torus = 3
    symmetry_breaking = 4
    left_the_model = 5
    end = 6
    period_doubling = 7


class EndReason(IntEnum):
    """Why a branch ends where it does; the first two are its ends, the others are not."""

    range_end = 1
    crushed = 2
    no_cycle_found = 3
    list_full = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class SpecialPoint:
    """A special point: the parameter's value there, the cycle's period in tau2 and largest tip y in L.

    error: absolute, of the parameter's value; period_error, size_error: relative, of the period and the
    largest tip y at the special point itself. after: the place on its branch of the last cycle before it, -1
    for none. reason: of an end. message: why no cycle was found, or why the error is large. orbit: of a point
    that was located, the cycle.
    """

    kind: SpecialKind
    at: float
    period: float
    tip_y_max: float
    error: float
    period_error: float = nan
    size_error: float = nan
    after: int = -1
    reason: EndReason | None = None
    message: str = ""
    orbit: Orbit | None = field(default=None, repr=False, compare=False)
    amplitude_coefficient: float = nan
    """At a Hopf point how fast the amplitude grows from there."""
    coefficient_error: float = nan
    """Relative, of amplitude_coefficient."""
