"""Special points of a branch: kinds and stored numbers."""

from dataclasses import dataclass, field
from enum import IntEnum
from math import nan

from ...orbit.orbit import Orbit


class SpecialKind(IntEnum):
    """Kind of a special point of a branch."""

    hopf = 1
    fold = 2
    torus = 3
    symmetry_breaking = 4
    left_the_model = 5
    end = 6
    period_doubling = 7


class EndReason(IntEnum):
    """Reason for the end of a branch: the first two are true ends, the others are failures."""

    range_end = 1
    crushed = 2
    no_cycle_found = 3
    list_full = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class SpecialPoint:
    """A special point: value of the parameter, period in tau2 and largest tip y in L of its cycle.

    error: absolute, of the parameter. period_error, size_error: relative, of the period and the largest tip y
    at the special point itself. after: index of the last cycle before it on its branch, -1 for none. reason:
    for an end. message: why no cycle was found, or why the error is large. orbit: the cycle of a located
    point.
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
    """At a Hopf point: largest tip y in L over the square root of the relative distance of the parameter, as
    in `HopfBirth`."""
    coefficient_error: float = nan
    """Relative error of amplitude_coefficient."""
