"""Record of the cycles of a branch during the continuation; errors are measured at some cycles and
interpolated at the remaining cycles."""

from dataclasses import replace
from math import nan

import numpy as np

from ..unsolvable import Unsolvable
from .arc_length_step import BranchCycle
from .bordered.border_condition import BorderCondition
from .branch_curve import BranchCurve, BranchEnd, StoredBranchCycle
from .branch_mesh_choice import cycles_with_errors_within_accuracy
from .special.special_point import SpecialPoint, SpecialPointKind
from .status import BranchEndReason, reason_of_failure


def branch_end_point(point: BranchCycle, reason: BranchEndReason, message: str = "") -> SpecialPoint:
    """The special point for the end of a branch at its last cycle `point`; the errors are NaN, to be set by
    the caller. reason: why the branch ends. message: cause of a failure."""
    measures = point.cycle.measures
    value = getattr(point.orbit.form.rod, point.scale.parameter_name)
    return SpecialPoint(
        kind=SpecialPointKind.end,
        parameter_value=value,
        period=measures.period,
        tip_y_max=measures.tip_y_max,
        error=nan,
        end_reason=reason,
        message=message,
    )


class BranchRecord:
    """Record of the cycles of a branch during the continuation. The errors of a cycle are final after errors
    have been measured at this cycle or at a later cycle."""

    def __init__(self, curve: BranchCurve, accuracy: float, first_cycle: BranchCycle) -> None:
        """curve: the branch, to which cycles are appended. accuracy: relative accuracy. first_cycle: the
        first cycle, with measured errors."""
        self.curve = curve
        self.accuracy = accuracy
        self._last_measured = first_cycle
        self._unmeasured: list[BranchCycle] = []
        curve.stored_cycles.append(StoredBranchCycle.from_cycle(first_cycle, accuracy))

    def append(self, point: BranchCycle) -> None:
        """Appends the cycle `point`, whose errors are not measured."""
        self._unmeasured.append(point)
        self.curve.stored_cycles.append(StoredBranchCycle.from_cycle(point, self.accuracy))

    def bring_errors_within_accuracy(self, condition: BorderCondition | None = None) -> BranchCycle:
        """Measures or interpolates the errors of all cycles appended since the last measurement, and solves
        cycles again on other meshes until all errors are within the accuracy. Returns the last cycle; raises
        Unsolvable.

        condition: equation that defines the last cycle on every mesh; by default the condition that the arc
        length of this cycle is unchanged.
        """
        if self._unmeasured:
            points = cycles_with_errors_within_accuracy(
                self._last_measured, self._unmeasured, self.accuracy, condition
            )
            self.curve.stored_cycles[-len(points) :] = [
                StoredBranchCycle.from_cycle(point, self.accuracy) for point in points
            ]
            self._last_measured = points[-1]
            self._unmeasured = []
        return self._last_measured

    def append_end(self, end: BranchEnd) -> None:
        """Appends the end of the branch, with errors. If the errors of the last cycles cannot be brought
        within the accuracy, these cycles are removed and the branch ends at the last measured cycle."""
        curve = self.curve
        try:
            self.bring_errors_within_accuracy()
        except Unsolvable as reason:
            curve.remove_last_cycles(len(self._unmeasured))
            message = f"the errors of the next cycles cannot be measured: {reason}"
            special = branch_end_point(self._last_measured, reason_of_failure(reason), message)
            end = replace(end, special_point=special, is_complete=False)
        special = end.special_point
        last_point = curve.stored_cycles[-1]
        if np.isnan(special.error):
            special = replace(special, error=last_point.parameter_value_error * abs(special.parameter_value))
        if np.isnan(special.period_error):  # the end is the last cycle
            errors = last_point.errors
            special = replace(
                special, period_error=errors.period_error, tip_y_max_error=errors.amplitude_error
            )
        curve.append_end(replace(end, special_point=special))
