"""Ends of curves of folds and torus points in their plane: whether two curves agree, and whether one leaves
the range of the rows."""

from ....determinant.parameter_plane import PlaneAxis
from .curve_ends import END_SETTINGS
from .special_curves import CURVE_IDENTITY_SETTINGS, CurveEndReason, SpecialPointCurve


def are_identical_curves(first: SpecialPointCurve, second: SpecialPointCurve, line_axis: PlaneAxis) -> bool:
    """Whether two curves are identical: kinds agree, and their ends coincide within a tolerance. line_axis:
    axis of the parameter along a row."""
    pairs = zip(_ends(first, line_axis), _ends(second, line_axis), strict=True)
    distances = (abs(a - b) for p, q in pairs for a, b in zip(p, q, strict=True))
    return first.kind == second.kind and all(
        distance <= CURVE_IDENTITY_SETTINGS.max_end_distance for distance in distances
    )


def leaves_range(curve: SpecialPointCurve, line_axis: PlaneAxis) -> bool:
    """Whether a curve ends at an edge of the plane across the rows. line_axis: axis along the rows."""
    positions = (line_axis.coordinate(curve.points[i].parameter_value) for i in (0, -1))
    return any(
        end is CurveEndReason.edge and min(abs(position), abs(1 - position)) <= END_SETTINGS.max_edge_distance
        for end, position in zip(curve.ends, positions, strict=True)
    )


def _ends(curve: SpecialPointCurve, line_axis: PlaneAxis) -> list[tuple[float, float]]:
    """Both ends of a curve, each as (row coordinate, position along the row), from 0 to 1, in ascending
    order."""
    ends = curve.points[0], curve.points[-1]
    # Ordered, because two traces of one curve may run in opposite directions.
    return sorted((p.row_coordinate, line_axis.coordinate(p.parameter_value)) for p in ends)
