"""The last cycle of a branch, at an end of the parameter range."""

import numpy as np

from ..continuation.follower import zero_along_step
from ..cycle.accuracy.refinement import max_matrix_distance, newton_tolerance
from .arc import BranchCycle, branch_cycle_with_calibrated_errors, tangent_at
from .bordered.condition import BorderCondition
from .bordered.matrix import bordered_matrix_of
from .special.segment import BranchSegment
from .symmetry import BRANCH_END_SETTINGS

ALONG_PARAMETER = np.array([0.0, 0.0, 1.0])
"""Unit vector along the parameter, (3,), in components (deflection, log period, parameter)."""


def range_end_condition(start: BranchCycle, limit: float) -> BorderCondition:
    """The condition that the parameter coordinate of a cycle equals `limit`, in the units of the cycle
    `start`."""
    return BorderCondition(start.scale, ALONG_PARAMETER, limit / start.scale.coordinate_unit)


def cycle_at_range_end(
    start: BranchCycle, end: BranchCycle, range_end: BorderCondition, accuracy: float
) -> BranchCycle:
    """The cycle at an end of the parameter range, between the cycles `start` and `end`, to a relative
    accuracy; raises Unsolvable. range_end: condition that the cycle lies at this end of the range."""
    scale = start.scale
    segment = BranchSegment(start, end)

    def beyond(length: float) -> float:
        # Evaluated on the predicted cubic; only the final cycle is solved, below.
        return -range_end.residual(segment.predicted_orbit(length))

    ends = beyond(0.0), beyond(segment.length)
    length = zero_along_step(beyond, ends, segment.length, 0.0, BRANCH_END_SETTINGS.range_end_tolerance)
    tolerance = newton_tolerance(accuracy)
    predicted = segment.predicted_orbit(length)
    found = range_end.solve_cycle(predicted, tolerance, start.workspace, max_matrix_distance(accuracy))
    tangent = tangent_at(found.orbit, scale, start.unit_tangent, bordered_matrix_of(found))
    return branch_cycle_with_calibrated_errors(start, found, tangent, length, length, accuracy)
