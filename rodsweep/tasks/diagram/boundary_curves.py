"""Boundaries of stability of a phase diagram, their criticality, and curves of generalised Hopf points."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...config.axis import Axis
from ...results.file.view import ResultView
from ...results.layouts.variables import FilledVariable
from .curve_variables import bautin_curve_values

if TYPE_CHECKING:
    from ...determinant.parameter_plane import ParameterPlane
    from ...solve.changes.diagram.boundary_curves import BoundaryCurve
    from ...solve.continuation.curves_through_seeds import TracedCurves
    from ...solve.hopf.bautin_points import CurveCriticality


def boundary_curves(
    plane: "ParameterPlane", view: ResultView, rows: np.ndarray
) -> "TracedCurves[BoundaryCurve]":
    """Boundary curves through the crossings of the imaginary axis that were found on the rows. view: the file
    with all rows. rows: value of the row parameter of every row, (rows,); rows with an infinite value are
    left out.
    """
    from ...solve.changes.diagram.boundaries import boundary_curves_through, seed_of

    names = ("crossing_at", "crossing_kind", "crossing_frequency", "crossing_growth_rate")
    x, kind, frequency, growth_rate = map(view.flattened_by_point, names)
    seeds = [
        seed_of(
            (float(x[i, j]), float(rows[i])),
            int(kind[i, j]),
            float(frequency[i, j]),
            float(growth_rate[i, j]),
        )
        for i in np.flatnonzero(np.isfinite(rows))
        for j in np.flatnonzero(kind[i])
    ]
    traced = boundary_curves_through(plane, [seed for seed in seeds if seed is not None])
    # If a list is full, its last crossings are not stored, and no curve starts from them.
    unlisted = view.variables["crossing_count"].ravel() - np.count_nonzero(kind, axis=1)
    return replace(
        traced,
        untraced_seed_count=traced.untraced_seed_count + int(unlisted[np.isfinite(rows)].clip(min=0).sum()),
    )


def criticality_along(
    plane: "ParameterPlane", traced: "TracedCurves[BoundaryCurve]", accuracy: float
) -> "list[CurveCriticality]":
    """Criticality along each boundary curve of `traced`; NaN along curves that are not Hopf curves. accuracy:
    relative accuracy of eigenvalues and thresholds."""
    from ...solve.hopf.bautin_points import CurveCriticality, curve_criticality

    return [
        curve_criticality(plane, curve, accuracy)
        if curve.consists_of_hopf_points
        else CurveCriticality(np.full(len(curve.parameter_values), np.nan), (), 0)
        for curve in traced.curves
    ]


def generalised_hopf_curves(
    plane: "ParameterPlane",
    criticalities: Sequence["CurveCriticality"],
    third_axis: tuple[str, Axis],
    accuracy: float,
) -> list[FilledVariable]:
    """Curves of generalised Hopf points along a third parameter, as variables of the file. criticalities:
    criticality of each boundary curve of the plane. accuracy: relative accuracy of eigenvalues and
    thresholds. third_axis: name and values of the third parameter.
    """
    from ...determinant.parameter_plane import PlaneAxis
    from ...solve.hopf.bautin_curves import (
        BautinCurve,
        BautinProblem,
        bautin_curve,
        lies_on_curve,
    )

    name, axis = third_axis
    values = axis.array()
    value_in_plane = float(getattr(plane.rod, name))
    plane_axis = PlaneAxis(name, float(values[0]), float(values[-1]), axis.is_logarithmic)
    all_values = np.append(values, value_in_plane)
    space = BautinProblem(plane.rod, (*plane.axes, plane_axis), all_values, accuracy)
    curves: list[BautinCurve] = []
    points_of_plane = [point for curve in criticalities for point in curve.bautin_points]
    for start in [space.as_curve_point(point, 2, value_in_plane) for point in points_of_plane]:
        # A curve may return to the plane: its further points need no curve of their own.
        if not any(lies_on_curve(start, curve) for curve in curves):
            curves.append(bautin_curve(space, start))
    return bautin_curve_values(curves, (plane.axes[0].parameter_name, plane.axes[1].parameter_name), name)
