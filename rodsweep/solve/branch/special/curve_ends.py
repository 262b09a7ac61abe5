"""Ends of a curve of folds or torus points: settings, the reason for each margin that becomes 0, and the
comparison of two curves by their ends."""

from dataclasses import dataclass

from ....determinant.parameter_plane import PlaneAxis
from .special_curves import CURVE_IDENTITY_SETTINGS, CurveEndReason, SpecialPointCurve


@dataclass(frozen=True, slots=True, kw_only=True)
class SpecialCurveEndSettings:
    """Settings for the ends of a curve of special points."""

    min_points_of_closed_curve: int = 5
    """Whether a curve closes is tested only after more than this number of points."""
    max_distance_from_plane_edge: float = 1e-8
    """Points at most this far from an edge of the plane lie on the edge; each axis has length 1."""
    zero_margin_tolerance: float = 1e-10
    """A margin (distance of a point from a reason for the curve's end, see `END_REASON_BY_MARGIN`) is 0
    within this tolerance; also the tolerance of the position at which a margin becomes 0, as a fraction of
    the step length."""
    crushing_margin: float = 1e-3
    """A curve ends where the relative distance of F from the force that crushes the arm is this number."""
    step_tolerance_before_crushing: float = 1e-6
    """Relative tolerance of the length of a step that is shortened to end at half of `crushing_margin`."""
    min_amplitude: float = 0.01
    """A curve ends, at an extrapolated Hopf point, where the largest tip y, in L, is below this number."""
    min_sine_at_resonance: float = 0.2
    """A curve of torus points that cannot be followed further has ended at a resonance (the complex pair
    becomes real) if the sine of the angle between its multiplier and the real axis is below this number."""


SPECIAL_CURVE_END_SETTINGS = SpecialCurveEndSettings()
ROW_EDGE_MARGIN_INDICES = (2, 3)
"""Indices, in `SpecialCurveProblem.margins_to_curve_end`, of the two edges that are parallel to the rows."""
END_REASON_BY_MARGIN = (
    *4 * (CurveEndReason.edge,),
    CurveEndReason.crushed,
    CurveEndReason.left_the_model,
    CurveEndReason.hopf,
)
"""Reason for the end of a curve, by the index of the margin that becomes 0; the first four margins are
distances from the edges of the plane."""


def are_identical_curves(first: SpecialPointCurve, second: SpecialPointCurve, line_axis: PlaneAxis) -> bool:
    """Whether the curves `first` and `second` are identical: their kinds agree, and their ends coincide
    within a tolerance. line_axis: axis of the parameter that varies along a row of the diagram."""
    pairs = zip(_curve_end_positions(first, line_axis), _curve_end_positions(second, line_axis), strict=True)
    distances = (abs(a - b) for p, q in pairs for a, b in zip(p, q, strict=True))
    return first.kind == second.kind and all(
        distance <= CURVE_IDENTITY_SETTINGS.max_end_distance for distance in distances
    )


def leaves_range_along_rows(curve: SpecialPointCurve, line_axis: PlaneAxis) -> bool:
    """Whether a curve ends at an edge of the plane at which the rows end. line_axis: axis along the rows."""
    positions = (line_axis.scaled_coordinate(curve.points[i].parameter_value) for i in (0, -1))
    return any(
        end is CurveEndReason.edge
        and min(abs(position), abs(1 - position)) <= SPECIAL_CURVE_END_SETTINGS.max_distance_from_plane_edge
        for end, position in zip(curve.end_reasons, positions, strict=True)
    )


def _curve_end_positions(curve: SpecialPointCurve, line_axis: PlaneAxis) -> list[tuple[float, float]]:
    """Both ends of a curve, each as (row coordinate, position on `line_axis`), both from 0 to 1, in ascending
    order. Row coordinate: position on the axis of the parameter that is constant on a row of the diagram.
    line_axis: axis of the parameter that varies along a row."""
    ends = curve.points[0], curve.points[-1]
    # Ordered, because two traces of one curve may run in opposite directions.
    return sorted((p.row_coordinate, line_axis.scaled_coordinate(p.parameter_value)) for p in ends)
