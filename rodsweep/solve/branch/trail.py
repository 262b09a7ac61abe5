"""Cycles of a branch in the order of the steps; errors are measured at some and interpolated between."""

from dataclasses import replace
from math import nan

import numpy as np

from ..point import Unsolvable
from .arc import ArcPoint
from .bordered.condition import BorderCondition
from .branch_curve import BranchCurve, BranchEnd, BranchPoint
from .settling import settled
from .special.point import EndReason, SpecialKind, SpecialPoint


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

    def settle(self, condition: BorderCondition | None = None) -> ArcPoint:
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
