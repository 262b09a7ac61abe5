"""The first point of a curve of special points, from a special point located on a row."""

from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from ....determinant.parameter_plane import PlaneAxis
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.orbit_mesh import mesh_of, stages_for
from ...point import Unsolvable
from ..arc import tangent_at
from ..beginning import BEGINNING, DEFLECTION
from ..bordered.matrix import BorderedMatrix
from ..bordered.scale import Scale, deflection_of
from .family import CycleFamily
from .on_curve import ACROSS_CURVE, OnCurve
from .point import SpecialPoint


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveStartSettings:
    """Settings for the first mesh of a curve of special points."""

    order_share: float = 0.62
    """Order of a curve's first mesh, in units of the order that located the special point to 1e-9."""
    interval_share: float = 0.5
    """Intervals of a curve's first mesh, in units of the intervals that located the special point."""


CURVE_START = CurveStartSettings()


def first_on_curve(
    special: SpecialPoint, line: str, rows: PlaneAxis, row: float, workspace: NewtonWorkspace
) -> OnCurve:
    """The first point of a curve, from a special point located on a row; raises Unsolvable."""
    orbit = special.orbit
    if orbit is None:
        raise Unsolvable(special.message or "the special point has no cycle")
    mesh = mesh_of(orbit)
    rough = replace(
        mesh,
        order=ceil(CURVE_START.order_share * mesh.order),
        intervals=ceil(CURVE_START.interval_share * mesh.intervals),
        stages=stages_for(ACROSS_CURVE.accuracy),
    )
    orbit = rough.carry(orbit)
    least = abs(deflection_of(orbit)) * BEGINNING.min_deflection_amplitude / special.tip_y_max
    scale = Scale.of(orbit, line, least)
    matrix = BorderedMatrix(orbit, scale, workspace)
    ahead = scale.moved(orbit, tangent_at(orbit, scale, DEFLECTION, matrix))
    place = rows.scaled(row)
    start = OnCurve(
        orbit=orbit, scale=scale, ahead=ahead / np.linalg.norm(ahead), place=place, at=special.at, row=row
    )
    family = CycleFamily.about(special.kind, rows, start, workspace)
    return family.point(orbit, place, np.array([1.0, 0.0]))
