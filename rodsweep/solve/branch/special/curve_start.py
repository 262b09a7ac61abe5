"""The first point of a curve of special points in a parameter plane, from a special point located on a
row."""

from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from ....determinant.parameter_plane import PlaneAxis
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.mesh_choice import cheapest_stage_count
from ...orbit.orbit_mesh import mesh_of_orbit
from ...unsolvable import Unsolvable
from ..arc_length_step import tangent_at
from ..bordered.matrix import BorderedMatrix
from ..bordered.scale import ArcLengthScale, deflection_at_time_zero
from ..settings import BRANCH_START_SETTINGS
from ..start.first_cycle import DEFLECTION_UNIT_VECTOR
from .cycle_family import CycleFamily
from .solved_curve_point import CURVE_SECANT_SETTINGS, SEARCH_LINE_ALONG_BRANCH, SolvedCurvePoint
from .special_point import SpecialPoint


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveStartSettings:
    """Settings for the first mesh on a curve of special points."""

    element_order_ratio: float = 0.62
    """Ratio of the order of the first mesh on a curve to the order of the mesh on which the special point was
    located with a relative accuracy of 1e-9."""
    time_interval_count_ratio: float = 0.5
    """Ratio of the number of time intervals of the first mesh on a curve to the number on the mesh on which
    the special point was located."""


CURVE_START_SETTINGS = CurveStartSettings()


def first_point_of_curve(
    special: SpecialPoint, line_name: str, row_axis: PlaneAxis, row: float, workspace: NewtonWorkspace
) -> SolvedCurvePoint:
    """The first point of a curve of special points, from the point `special` located on a row; raises
    Unsolvable.

    line_name: name of the parameter along a row. row_axis: axis of the row parameter. row: value of the row
    parameter. workspace: memory of Newton's matrices.
    """
    orbit = special.orbit
    if orbit is None:
        raise Unsolvable(special.message or "the cycle of the special point is not known")
    mesh = mesh_of_orbit(orbit)
    # The special point was located to 1e-9; a curve needs less accuracy, and its error is measured anew.
    first_point = replace(
        mesh,
        order=ceil(CURVE_START_SETTINGS.element_order_ratio * mesh.order),
        interval_count=ceil(CURVE_START_SETTINGS.time_interval_count_ratio * mesh.interval_count),
        stage_count=cheapest_stage_count(CURVE_SECANT_SETTINGS.relative_parameter_accuracy),
    )
    orbit = first_point.interpolated_orbit(orbit)
    min_deflection_unit = (
        abs(deflection_at_time_zero(orbit))
        * BRANCH_START_SETTINGS.amplitude_of_min_deflection_unit
        / special.tip_y_max
    )
    scale = ArcLengthScale.at_orbit(orbit, line_name, min_deflection_unit)
    matrix = BorderedMatrix(orbit, scale, workspace)
    derivative = scale.directional_derivative(orbit, tangent_at(orbit, scale, DEFLECTION_UNIT_VECTOR, matrix))
    row_coordinate = row_axis.scaled_coordinate(row)
    start = SolvedCurvePoint(
        orbit=orbit,
        scale=scale,
        branch_direction=derivative / np.linalg.norm(derivative),
        row_coordinate=row_coordinate,
        branch_parameter_value=special.parameter_value,
        row_parameter_value=row,
    )
    family = CycleFamily.near_point(special.kind, row_axis, start, workspace)
    # Along the branch, because the row is fixed at the first point.
    return family.corrected_point_with_error(orbit, row_coordinate, SEARCH_LINE_ALONG_BRANCH)
