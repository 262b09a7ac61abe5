"""The cycles of a branch as they are found: errors are measured at some, the others wait for these."""

from dataclasses import replace
from math import nan

import numpy as np

from ..point import Unsolvable
from .arc import ArcPoint
from .bordered import Condition
from .branch_curve import BranchCurve, BranchEnd, BranchPoint
from .settling import settled
from .special.point import EndReason, SpecialKind, SpecialPoint


def end_at(point: ArcPoint, reason: EndReason, message: str = "") -> SpecialPoint:
    """The end of a branch at a cycle, whose errors may not be known yet."""
    measures, at = point.cycle.measures, getattr(point.orbit.form.rod, point.scale.name)
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
    """The cycles of a branch as they are found: errors are measured at some, the others wait for these."""

    def __init__(self, curve: BranchCurve, accuracy: float, first: ArcPoint) -> None:
        """first: the first cycle, whose errors are measured."""
        self.curve, self.accuracy = curve, accuracy
        self._measured, self._waiting = first, list[ArcPoint]()
        curve.points.append(BranchPoint.of(first, accuracy))

    def append(self, point: ArcPoint) -> None:
        """The next cycle, whose errors are not measured."""
        self._waiting.append(point)
        self.curve.points.append(BranchPoint.of(point, self.accuracy))

    def settle(self, condition: Condition | None = None) -> ArcPoint:
        """Gives the waiting cycles their errors; returns the last one. Raises Unsolvable.

        condition: what holds for the last one on every mesh; without it the place on the branch.
        """
        if self._waiting:
            points = settled(self._measured, self._waiting, self.accuracy, condition)
            self.curve.judge([BranchPoint.of(point, self.accuracy) for point in points])
            self._measured, self._waiting = points[-1], []
        return self._measured

    def end(self, end: BranchEnd) -> None:
        """The end of the branch; where waiting cycles have no errors it ends before them."""
        curve = self.curve
        try:
            self.settle()
        except Unsolvable as why:
            curve.cut(len(self._waiting))
            message = f"the errors of the cycles beyond cannot be measured: {why}"
            special = end_at(self._measured, EndReason.no_cycle_found, message)
            end = replace(end, special=special, complete=False)
        special, last = end.special, curve.points[-1]
        if np.isnan(special.error):
            special = replace(special, error=last.at_error * abs(special.at))
        if np.isnan(special.period_error):  # the end is the last cycle
            errors = last.errors
            special = replace(special, period_error=errors.period_error, size_error=errors.amplitude_error)
        curve.end(replace(end, special=special))
