"""Cycles of a branch in the order of the steps; errors are measured at some and interpolated between."""

from dataclasses import dataclass, replace
from math import nan

import numpy as np

from ..point import Unsolvable
from .arc import ArcPoint
from .bordered import Condition
from .branch_curve import BranchCurve, BranchEnd, BranchPoint
from .settling import settled
from .special.point import EndReason, SpecialKind, SpecialPoint


@dataclass(frozen=True, slots=True, kw_only=True)
class EndingSettings:
    """Ends of a branch: at a Hopf point, at a symmetry breaking, at an end of the parameter's range."""

    small_cycle: float = 0.06
    """Largest tip y, in L, of a cycle from which the branch may step across a Hopf point where it ends."""
    small_asymmetry: float = 0.2
    """Largest asymmetry, in units of the largest moment, from which a branch may step across the symmetric
    cycle at its end."""
    min_asymmetry: float = 0.02
    """Asymmetry, in units of the largest moment, below which shorter steps identify the symmetric cycle no
    better."""
    lost_asymmetry: float = 0.1
    """A step that reduces the asymmetry below this fraction has passed a symmetric cycle or reached one."""
    asymmetry_ratios: tuple[float, float] = 0.5, 2.0
    """Allowed range of the asymmetry found, in units of the predicted asymmetry."""
    place_share: float = 0.3
    """Tolerance for the extrapolated place of a Hopf point or a symmetry breaking, in units of the last
    cycle's distance from it."""
    min_place_tolerance: float = 1e-6
    """Smallest relative tolerance for the extrapolated place; the accuracy counts if larger."""
    period_tolerance: float = 1e-3
    """Relative tolerance for the extrapolated period; at a symmetry breaking the accuracy counts if
    larger."""
    range_end_bracket: float = 1e-6
    """Fraction of a step to which the range's end is predicted; Newton's method then places the cycle on
    it."""
    range_end_error: float = 1e-15
    """Relative error of the parameter at an end of the range."""


ENDINGS = EndingSettings()


def end_at(point: ArcPoint, reason: EndReason, message: str = "") -> SpecialPoint:
    """The end of a branch at a cycle; the error of the parameter is still nan."""
    measures = point.cycle.measures
    at = getattr(point.orbit.form.rod, point.scale.name)
    return SpecialPoint(
        kind=SpecialKind.end,
        at=at,
        period=measures.period,
        tip_y_max=measures.tip_y_max,
        error=nan,
        reason=reason,
        message=message,
    )


class Trail:
    """Cycles of a branch in the order of the steps. A cycle waits until errors are measured at it or beyond
    it."""

    def __init__(self, curve: BranchCurve, accuracy: float, first: ArcPoint) -> None:
        """first: the first cycle, with measured errors."""
        self.curve = curve
        self.accuracy = accuracy
        self._measured = first
        self._waiting: list[ArcPoint] = []
        curve.points.append(BranchPoint.of(first, accuracy))

    def append(self, point: ArcPoint) -> None:
        """Appends a cycle whose errors are not measured yet."""
        self._waiting.append(point)
        self.curve.points.append(BranchPoint.of(point, self.accuracy))

    def settle(self, condition: Condition | None = None) -> ArcPoint:
        """Gives errors to the waiting cycles and returns the last cycle. Raises Unsolvable.

        condition: holds for the last cycle on every mesh; by default its arc length along the branch is kept.
        """
        if self._waiting:
            points = settled(self._measured, self._waiting, self.accuracy, condition)
            self.curve.judge([BranchPoint.of(point, self.accuracy) for point in points])
            self._measured = points[-1]
            self._waiting = []
        return self._measured

    def end(self, end: BranchEnd) -> None:
        """Ends the branch. If the errors of the waiting cycles cannot be measured, the branch ends before
        these."""
        curve = self.curve
        try:
            self.settle()
        except Unsolvable as why:
            curve.cut(len(self._waiting))
            message = f"the errors of the cycles beyond cannot be measured: {why}"
            special = end_at(self._measured, EndReason.no_cycle_found, message)
            end = replace(end, special=special, complete=False)
        special = end.special
        last = curve.points[-1]
        if np.isnan(special.error):
            special = replace(special, error=last.at_error * abs(special.at))
        if np.isnan(special.period_error):  # the end is the last cycle
            errors = last.errors
            special = replace(special, period_error=errors.period_error, size_error=errors.amplitude_error)
        curve.end(replace(end, special=special))
