"""Curves and special points of a phase diagram."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path as CurvePath
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

from ....arrays import Array
from ....model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES
from ....results.file.view import ResultView
from ....results.layouts.branch import SPECIAL_KINDS
from ...plane_curves import PlaneParameters, points_by_curve
from ..style import GREEN, TEX_SYMBOLS, number_in_tex
from .regions import DrawnPlane

BOUNDARY_CURVE_LOOKS = {
    1: (rf"Hopf points (first: ${TEX_SYMBOLS['F']}_{{**}}$)", 1.4, "-"),
    0: (rf"double eigenvalue (first: ${TEX_SYMBOLS['F']}_*$)", 1.0, "--"),
}
"""(legend entry, width, style) of a boundary curve, by code of the kind in the file."""
CRITICALITY_LOOKS = {
    -1: ("supercritical Hopf points", 1.4, "-"),
    1: ("subcritical Hopf points", 1.4, "--"),
    0: ("Hopf points, criticality undecided", 0.6, "-"),
}
"""(legend entry, width, style) of parts of a Hopf curve, by sign of Re c (c: cubic coefficient of the normal
form)."""
DOUBLE_EIGENVALUE_LOOK = ("double eigenvalue", 1.0, ":")
"""(legend entry, width, style) of double eigenvalues in figures whose dashed curves are subcritical."""
CYCLE_CURVE_STYLES = {"fold": ("folds of cycles", "#9B1B30"), "torus": ("torus points of cycles", GREEN)}
"""(legend entry, colour) of curves of special points of cycles, by kind."""
SPECIAL_POINT_MARKS_ON_ROWS = {
    "fold": ("folds of cycles, on no curve", "s"),
    "torus": ("torus points of cycles, on no curve", "D"),
    "symmetry_breaking": ("symmetry breakings of cycles", "^"),
    "period_doubling": ("period doublings of cycles", "v"),
}
"""(legend entry, marker) of special points of cycles, by kind: points that were found on rows and lie on no
curve."""
POINT_ON_CURVE_TOLERANCE = 1e-3
"""A point lies on a curve if its distances from the curve along x and y, in fractions of the axes, are at
most this number."""


def draw_boundary_curves(axes: Axes, view: ResultView, parameters: PlaneParameters, hopf_only: bool) -> None:
    """Draws boundary curves, generalised Hopf points and folds; if `hopf_only`, only Hopf curves with their
    generalised Hopf points."""
    looks = BOUNDARY_CURVE_LOOKS
    if "curve_criticality" in view.variables:
        _draw_hopf_curves_by_criticality(axes, view, parameters)
        looks = {0: DOUBLE_EIGENVALUE_LOOK}
    for kind, (label, width, style) in looks.items():
        if kind == 1 or not hopf_only:
            for path in points_by_curve(view, parameters, "curve", kind).values():
                axes.plot(*path.T, style, color="k", lw=width, label=label)
    if not hopf_only:
        _mark_hopf_curve_folds(axes, view, parameters)
        _mark_fold_of_partial_beam_limit(axes, view, parameters)


def _draw_hopf_curves_by_criticality(axes: Axes, view: ResultView, parameters: PlaneParameters) -> None:
    """Draws Hopf curves with line styles by criticality, generalised Hopf points, and curves of such
    points."""
    variables = view.variables
    for curve in np.unique(variables["curve_number"][variables["curve_kind"] == 1]):
        for criticality, points in hopf_curve_parts_by_criticality(view, int(curve), parameters):
            label, width, style = CRITICALITY_LOOKS[criticality]
            axes.plot(*points.T, style, color="k", lw=width, label=label)
    line_symbol, row_symbol = (TEX_SYMBOLS[name] for name in parameters)
    for x, y in zip(*(variables[f"bautin_{name}"] for name in parameters), strict=True):
        label = rf"generalised Hopf point: ${line_symbol}$ = {x:.6g}, ${row_symbol}$ = {y:.6g}"
        axes.plot(x, y, "kD", mfc="white", ls="", ms=5, label=label)
    if "bautin_along_curve" in variables:
        _draw_bautin_curves(axes, view, parameters)


def _draw_bautin_curves(axes: Axes, view: ResultView, parameters: PlaneParameters) -> None:
    """Draws curves of generalised Hopf points over a third parameter."""
    variables = view.variables
    candidates = [name for name in NON_OPTIONAL_LINEAR_PARAMETER_NAMES if name not in parameters]
    third = next(name for name in candidates if f"bautin_along_{name}" in variables)
    numbers = variables["bautin_along_curve"]
    for number in np.unique(numbers):
        x, y, z = (variables[f"bautin_along_{name}"][numbers == number] for name in (*parameters, third))
        low, high = (number_in_tex(float(end), 3) for end in (z.min(), z.max()))
        label = rf"generalised Hopf points, ${TEX_SYMBOLS[third]}$ = ${low}$ to ${high}$"
        axes.plot(x, y, "-.", color="tab:red", lw=1.2, label=label)


def hopf_curve_parts_by_criticality(
    view: ResultView, curve: int, parameters: PlaneParameters
) -> list[tuple[int, Array]]:
    """(sign of Re c, points) of the parts, between generalised Hopf points, of the Hopf curve with the number
    `curve`. points: values of both `parameters`, in their order, (n, 2)."""
    variables = view.variables
    indices = np.flatnonzero(variables["curve_number"] == curve)
    bautin = np.flatnonzero(variables["bautin_curve"] == curve)
    places = np.searchsorted(indices, variables["bautin_curve_point"][bautin] - 1, side="right")
    points = np.column_stack(
        [
            np.insert(variables[f"curve_{name}"][indices], places, variables[f"bautin_{name}"][bautin])
            for name in parameters
        ]
    )
    criticality = np.insert(np.nan_to_num(variables["curve_criticality"][indices]), places, 0)
    # A segment has the sign of its ends; if the sign at one end is undecided, the sign of the other end.
    starts, ends = criticality[:-1], criticality[1:]
    signs = np.where(starts * ends < 0, 0, np.sign(starts + ends)).astype(int)
    parts = np.split(np.arange(len(signs)), np.flatnonzero(np.diff(signs)) + 1)
    return [(int(signs[part[0]]), points[part[0] : part[-1] + 2]) for part in parts if part.size]


def _mark_hopf_curve_folds(axes: Axes, view: ResultView, parameters: PlaneParameters) -> None:
    """Marks the folds of Hopf curves at which a window of flutter closes."""
    variables = view.variables
    closes_window = (variables["fold_kind"] == 1) & (variables["fold_of"] == 1)
    line_symbol, row_symbol = (TEX_SYMBOLS[name] for name in parameters)
    for x, y in zip(*(variables[f"fold_{name}"][closes_window] for name in parameters), strict=True):
        label = rf"fold ${line_symbol} = {x:.6g}$, ${row_symbol} = {y:.6g}$"
        axes.plot(x, y, "ko", ms=4, label=label)


def _mark_fold_of_partial_beam_limit(axes: Axes, view: ResultView, parameters: PlaneParameters) -> None:
    """Marks the fold in the partial beam limit, if it lies in the plane."""
    if "partial_beam_k1" not in view.variables:
        return
    F, k1 = float(view.variables["partial_beam_F"]), float(view.variables["partial_beam_k1"])
    x, y = (F if name == "F" else k1 for name in parameters)
    line = view.variables[parameters.line_parameter]
    rows = view.parameter_values[parameters.row_parameter]
    if line[0] <= x <= line[-1] and rows[0] <= y <= rows[-1]:
        label = rf"partial beam $2F_c = {F:.6g}$, $4F_c = {k1:.6g}$"
        axes.plot(x, y, "+", color="k", ls="", ms=10, mew=1.2, label=label)


def draw_cycle_curves(axes: Axes, view: ResultView, parameters: PlaneParameters) -> None:
    """Draws curves of folds and torus points of cycles, below marks and Hopf curves."""
    for kind, (label, colour) in CYCLE_CURVE_STYLES.items():
        for path in points_by_curve(view, parameters, "cycle_curve", SPECIAL_KINDS.index(kind)).values():
            axes.plot(*path.T, color=colour, lw=1.8, zorder=1.9, label=label)


def mark_special_points_on_rows(axes: Axes, view: ResultView, parameters: PlaneParameters) -> None:
    """Marks, on the rows, the special points of cycles that lie on no curve of their kind."""
    row_values = view.point_columns[parameters.row_parameter]
    kinds, positions = (
        view.flattened_by_point(f"cycle_special_{name}") for name in ("kind", parameters.line_parameter)
    )
    look: dict[str, Any] = {"color": "k", "mfc": "white", "ms": 3.5, "mew": 0.8}
    for kind, (label, marker) in SPECIAL_POINT_MARKS_ON_ROWS.items():
        code = SPECIAL_KINDS.index(kind)
        rows, items = np.nonzero(kinds == code)
        points = np.column_stack([positions[rows, items], row_values[rows]])
        points = points[~_is_on_curve(view, code, parameters, points)]
        if len(points):
            axes.plot(*points.T, marker, label=label, **look)


def _is_on_curve(
    view: ResultView, kind: int, parameters: PlaneParameters, points: Array
) -> NDArray[np.bool_]:
    """Mask, (n,), of the special points `points` that lie on a curve of the kind with the code `kind`.
    points: (parameter along a row, row parameter) of each point, (n, 2)."""
    is_near = np.zeros(len(points), dtype=bool)
    if "cycle_curve_number" not in view.variables:
        return is_near
    rows = view.point_columns[parameters.row_parameter]
    plane = DrawnPlane(view.variables[parameters.line_parameter], rows[np.isfinite(rows)])
    centres = plane.fractions_of_axes(*points.T)
    boxes = [
        Bbox([centre - POINT_ON_CURVE_TOLERANCE, centre + POINT_ON_CURVE_TOLERANCE]) for centre in centres
    ]
    for path in points_by_curve(view, parameters, "cycle_curve", kind).values():
        curve = CurvePath(plane.fractions_of_axes(*path.T))
        is_near |= [curve.intersects_bbox(box, filled=False) for box in boxes]
    return is_near


def unstored_crossings_text(view: ResultView) -> str:
    """Text above a figure whose curves pass only through some of the crossings of the rows, because the file
    has no room for all; else empty. Curves of crossings that are not stored are missing."""
    crossing_counts = view.variables["crossing_count"].clip(min=0)
    stored_counts = (view.variables["crossing_kind"] > 0).sum(axis=-1)
    if "curve_number" not in view.variables or not (crossing_counts > stored_counts).any():
        return ""
    counts_text = f"{int(stored_counts.sum())} of {int(crossing_counts.sum())}"
    return f"curves through {counts_text} crossings of the rows: raise crossings"
