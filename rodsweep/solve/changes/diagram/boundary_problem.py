"""A curve in a plane of two parameters on which the straight rod has a Hopf point or a double real
eigenvalue, as a problem for `continuation.curve.follow_curve`.

Each point of the curve has a unit tangent. A curve ends at an edge of the plane, at a crushed rod, where it
closes, or where it cannot be followed.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....determinant.stability_boundary import BoundarySolution, StabilityBoundary
from ...continuation.curve import Curve, StepControl, StepResult, StopReason
from ...unsolvable import Unsolvable

BOUNDARY_STEP_CONTROL = StepControl(
    first_length=0.01,
    max_length=0.04,
    min_length=1e-9,
    target_angle=0.15,
    max_angle=0.3,
    max_successive_length_ratio=1.5,
    max_solutions=5000,
)
"""Control of the arc length of continuation steps; each axis of the plane has length 1. Steps are short
enough for a smooth drawn curve."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundaryCurveSettings:
    """Settings for points, ends and folds of a boundary curve."""

    max_distance_beyond_edge: float = 1e-9
    """Largest distance, in units of the length of an axis, by which a point on one edge of the plane may lie
    beyond another edge."""
    max_merged_distance: float = 1e-9
    """Two neighbouring points of a curve are merged if their distance, in units of the length of an axis, is
    at most this number, as at a start on an edge of the plane."""
    fold_location_tolerance: float = 1e-13
    """Tolerance of the component of the tangent that vanishes at a fold, and of the position of the fold on a
    step, divided by the length of the step."""
    hopf_tangent_rounding_error: float = 1e-12
    """Rounding error of the unit tangent to a curve of Hopf points."""
    double_eigenvalue_tangent_error: float = 1e-11
    """Error of the unit tangent to a curve of double eigenvalues, from differences in the Jacobian of D_w."""
    arm_tangent_error: float = 3e-10
    """Error of the unit tangent to a curve of arms, from differences of D, which deviate from the closed form
    by up to 8e-11 for uniform rods."""
    min_loop_points: int = 4
    """Minimum number of points of a closed curve."""


BOUNDARY_CURVE_SETTINGS = BoundaryCurveSettings()
CRUSHED_MARGIN_INDEX = 4
"""Index of the entry of `margins_to_curve_end` that is negative for a crushed rod; the entries 0 to 3 are the
distances from the four edges of the plane."""


class BoundaryEndReason(IntEnum):
    """Reasons for the end of a boundary curve. none: the point is not an end. edge: edge of the plane.
    crushed: crushed rod. closed: the curve returns to its first point. not_followed: no further point was
    found. list_full: maximum number of points."""

    none = 0
    edge = 1
    crushed = 2
    closed = 3
    not_followed = 4
    list_full = 5


class BoundaryPoint(NamedTuple):
    """A point v = (x, y, h) of a curve, (3,), and the unit tangent in the direction of the curve, (3,). x, y:
    both parameters, scaled to 0 and 1 at the edges of the plane. h: log |eigenvalue|."""

    scaled_point: Array
    tangent: Array

    @classmethod
    def with_tangent_along(cls, solution: BoundarySolution, direction: Array) -> "BoundaryPoint":
        """The point `solution` of a boundary; its tangent points along `direction`, (3,)."""
        tangent = solution.tangent
        return cls(solution.v, tangent if tangent @ direction > 0 else -tangent)


@dataclass(frozen=True, slots=True)
class BoundaryCurveProblem:
    """A curve in a plane of two parameters on which the straight rod has a Hopf point or a double real
    eigenvalue, as a problem for `follow_curve`."""

    boundary: StabilityBoundary

    def step(self, previous: Sequence[BoundaryPoint], length: float) -> StepResult[BoundaryPoint]:
        """One continuation step: predicts a point at distance `length` along the last tangent and corrects it
        to the curve. previous: points solved so far. Raises Unsolvable."""
        v, tangent = previous[-1]
        point = BoundaryPoint.with_tangent_along(
            self.boundary_point_near(v + length * tangent, tangent), tangent
        )
        # The turn of the tangent alone controls the step length.
        return StepResult(point, 0.0, float(point.tangent @ tangent))

    def boundary_point_near(self, guess: Array, normal: Array) -> BoundarySolution:
        """The point of the boundary near `guess`, in the plane normal to `normal`, (3,); raises Unsolvable if
        no point is found."""
        solution = self.boundary.point_near(guess, normal)
        if solution is None:
            raise Unsolvable("Newton's method finds no point of the curve near the prediction")
        return solution

    def margins_to_curve_end(self, point: BoundaryPoint) -> Array:
        """Distances of a point from the four edges, and -1 for a crushed rod in the plane, else 1; (5,)."""
        x, y = map(float, point.scaled_point[:2])
        is_in_plane = 0 <= x <= 1 and 0 <= y <= 1
        # Outside the plane the parameters may be outside their allowed ranges.
        uncrushed_sign = 1.0 if not is_in_plane or self.boundary.plane.is_uncrushed_at(x, y) else -1.0
        return np.array([x, 1 - x, y, 1 - y, uncrushed_sign])

    def point_at_zero_margin(
        self, previous: Sequence[BoundaryPoint], outer: BoundaryPoint, margin: int
    ) -> BoundaryPoint | None:
        """The point on the edge with the index `margin` that is crossed by the step from the last of
        `previous` to `outer`; None if `margin` stands for a crushed rod. Raises Unsolvable if the point is
        not found or lies beyond a second edge."""
        if margin == CRUSHED_MARGIN_INDEX:
            return None
        # The margins are x, 1 - x, y and 1 - y: the quotient is the axis, the remainder the edge.
        axis, limit = divmod(margin, 2)
        inner = previous[-1].scaled_point
        fraction = (limit - inner[axis]) / (outer.scaled_point[axis] - inner[axis])
        solution = self.boundary.point_near(inner + fraction * (outer.scaled_point - inner), np.eye(3)[axis])
        tolerance = BOUNDARY_CURVE_SETTINGS.max_distance_beyond_edge
        if solution is None or not -tolerance <= solution.v[1 - axis] <= 1 + tolerance:
            raise Unsolvable("no point of the curve was found on the edge of the diagram")
        return BoundaryPoint.with_tangent_along(solution, previous[-1].tangent)

    def is_closed_by(self, previous: Sequence[BoundaryPoint], point: BoundaryPoint) -> bool:
        """Whether the curve has at least `min_loop_points` points and passes its first point, in the same
        direction, within the step from the last of `previous` to `point`."""
        first = previous[0]
        last = previous[-1]
        step_length = float(np.linalg.norm(point.scaled_point - last.scaled_point))
        is_near = float(np.linalg.norm(point.scaled_point - first.scaled_point)) < step_length
        return (
            len(previous) >= BOUNDARY_CURVE_SETTINGS.min_loop_points
            and is_near
            and float(point.tangent @ first.tangent) > 0
        )

    def end_reason_of(self, curve: Curve[BoundaryPoint]) -> BoundaryEndReason:
        """The reason for the end of a followed curve. If no further solution was found, the reason is `edge`
        if the last point lies on an edge, such as gamma3 = 0, `crushed` if a rod just beyond the last point
        is crushed, otherwise `not_followed`."""
        if curve.end_reason is StopReason.closed:
            return BoundaryEndReason.closed
        if curve.end_reason is StopReason.max_solutions:
            return BoundaryEndReason.list_full
        if curve.end_reason is StopReason.zero_margin:
            if curve.margin_index == CRUSHED_MARGIN_INDEX:
                return BoundaryEndReason.crushed
            return BoundaryEndReason.edge
        v, tangent = curve.solutions[-1]
        if (
            self.margins_to_curve_end(curve.solutions[-1])[:CRUSHED_MARGIN_INDEX].min()
            <= BOUNDARY_CURVE_SETTINGS.max_distance_beyond_edge
        ):
            return BoundaryEndReason.edge
        next_point = BoundaryPoint(v + 2 * BOUNDARY_STEP_CONTROL.min_length * tangent, tangent)
        is_crushed = self.margins_to_curve_end(next_point)[CRUSHED_MARGIN_INDEX] < 0
        return BoundaryEndReason.crushed if is_crushed else BoundaryEndReason.not_followed
