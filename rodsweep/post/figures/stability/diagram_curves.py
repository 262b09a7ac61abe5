"""Curves and special points of a phase diagram. line_parameter, row_parameter: parameters along a row, and
constant on a row."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from ....arrays import Array
from ....results.file.view import ResultView
from ....results.layouts.branch import SPECIAL_KINDS
from ...stability_curves import is_stability_boundary_by_curve
from ..style import GREEN, TEX_SYMBOLS
from .criticality_curves import draw_hopf_curves_by_criticality
from .curve_labels import label_longest_curve, parts_at_lowest_force
from .regions import DrawnPlane

CURVE_LOOKS = {1: ("Hopf points", 1.4, "-"), 0: ("double eigenvalue", 1.0, "--")}
"""(legend entry, width, style) of a boundary curve, by code of the kind in the file."""
CURVE_SYMBOLS = {1: (r"$\tilde F_{**}$", 0.85), 0: (r"$\tilde F_*$", 0.12)}
"""(symbol, position) of the symbol at the longest curve of a kind; position: fraction of the visible
length."""
CYCLE_MARKS = {
    "fold": ("folds of cycles, on no curve", "s"),
    "torus": ("torus points of cycles, on no curve", "D"),
    "symmetry_breaking": ("symmetry breakings of cycles", "^"),
    "period_doubling": ("period doublings of cycles", "v"),
}
"""(legend entry, marker) of special points of cycles on rows that lie on no curve, by kind."""
CURVE_TOLERANCE = 1e-3
"""A point lies on a curve if its distance from the chords, in fractions of the axes, is at most this
number."""
CYCLE_CURVE_STYLES = {"fold": ("folds of cycles", "#9B1B30"), "torus": ("torus points of cycles", GREEN)}
"""(legend entry, colour) of curves of special points of cycles, by kind."""
DOUBLE_EIGENVALUE_LOOK = "double eigenvalue", 1.0, ":"
"""(legend entry, width, style) of double eigenvalues in figures whose dashed curves are subcritical."""


def draw_boundary_curves(
    axes: Axes, view: ResultView, line_parameter: str, row_parameter: str, hopf_only: bool
) -> list[Line2D]:
    """Draws boundary curves and folds; if `hopf_only`, only Hopf curves. Returns legend entries."""
    variables = view.variables
    has_criticality = "curve_criticality" in variables
    handles = (
        draw_hopf_curves_by_criticality(axes, view, line_parameter, row_parameter) if has_criticality else []
    )
    curve_looks = {0: DOUBLE_EIGENVALUE_LOOK} if has_criticality else CURVE_LOOKS
    for number, (word, width, style) in curve_looks.items():
        mask = variables["curve_kind"] == number
        if hopf_only and number == 0:
            continue
        curves = [variables["curve_number"] == curve for curve in np.unique(variables["curve_number"][mask])]
        for curve in curves:
            axes.plot(
                variables[f"curve_{line_parameter}"][curve],
                variables[f"curve_{row_parameter}"][curve],
                style,
                color="k",
                lw=width,
            )
        if mask.any():
            handles.append(Line2D([], [], color="k", lw=width, ls=style, label=word))
        if mask.any() and not has_criticality:
            named = masks_of_labelled_curves(view, number, line_parameter, row_parameter)
            paths = [
                np.column_stack(
                    [variables[f"curve_{name}"][curve] for name in (line_parameter, row_parameter)]
                )
                for curve in named
            ]
            if paths and "F" in (line_parameter, row_parameter):
                paths = parts_at_lowest_force(paths, 0 if line_parameter == "F" else 1)
            symbol, position = CURVE_SYMBOLS[number]
            if paths:
                label_longest_curve(
                    axes, paths, symbol + plane_force_text(view, line_parameter, row_parameter), position
                )
    return handles if hopf_only else handles + _mark_curve_folds(axes, view, line_parameter, row_parameter)


def masks_of_labelled_curves(
    view: ResultView, kind: int, line_parameter: str, row_parameter: str
) -> list[NDArray[np.bool_]]:
    """Masks, (curve_point,), of the curves of the kind `kind` that are labelled with a symbol: all curves of
    kind 0 (onsets); of the Hopf curves only those that bound the region of stable straight rods (F**)."""
    variables = view.variables
    numbers = np.unique(variables["curve_number"][variables["curve_kind"] == kind])
    bounds = (
        is_stability_boundary_by_curve(view, line_parameter, row_parameter)
        if kind
        else dict.fromkeys(numbers.tolist(), True)
    )
    return [variables["curve_number"] == number for number in numbers if bounds[int(number)]]


def plane_force_text(view: ResultView, line_parameter: str, row_parameter: str) -> str:
    """Text " = 30" if F is 30 in the whole plane; empty if F is on an axis. line_parameter, row_parameter:
    see the module."""
    return "" if "F" in (line_parameter, row_parameter) else f" = {float(view.parameter_values['F'][0]):g}"


def _mark_curve_folds(axes: Axes, view: ResultView, line_parameter: str, row_parameter: str) -> list[Line2D]:
    """Marks the folds of Hopf curves, and the fold in the partial beam limit; returns legend entries."""
    variables = view.variables
    handles = []
    for i in range(len(variables["fold"])):
        if (
            variables["fold_kind"][i] == 1 and variables["fold_of"][i] == 1
        ):  # a window of flutter closes at this fold
            F = variables[f"fold_{line_parameter}"][i]
            row_value = variables[f"fold_{row_parameter}"][i]
            axes.plot(F, row_value, "ko", ms=4)
            label = (
                rf"fold ${TEX_SYMBOLS[line_parameter]} = {F:.6g}$, "
                rf"${TEX_SYMBOLS[row_parameter]} = {row_value:.6g}$"
            )
            handles.append(Line2D([], [], color="k", marker="o", ls="", ms=4, label=label))
    if "partial_beam_k1" in variables:
        F, row_value = float(variables["partial_beam_F"]), float(variables["partial_beam_k1"])
        x, y = (F, row_value) if line_parameter == "F" else (row_value, F)
        rows = view.parameter_values[row_parameter]
        if not (
            variables[line_parameter][0] <= x <= variables[line_parameter][-1] and rows[0] <= y <= rows[-1]
        ):
            return handles
        label = rf"partial beam $2F_c = {F:.6g}$, $4F_c = {row_value:.6g}$"
        handles += axes.plot(x, y, "+", color="k", ls="", ms=10, mew=1.2, label=label)
    return handles


def draw_cycle_curves(axes: Axes, view: ResultView, line_parameter: str, row_parameter: str) -> list[Line2D]:
    """Draws curves of folds and torus points of cycles; returns legend entries. line_parameter,
    row_parameter: see the module."""
    variables = view.variables
    handles = []
    for kind, (word, colour) in CYCLE_CURVE_STYLES.items():
        mask = variables["cycle_curve_kind"] == SPECIAL_KINDS.index(kind)
        for curve in np.unique(variables["cycle_curve_number"][mask]):
            curve_mask = variables["cycle_curve_number"] == curve
            points = (
                variables[f"cycle_curve_{line_parameter}"][curve_mask],
                variables[f"cycle_curve_{row_parameter}"][curve_mask],
            )
            axes.plot(*points, color=colour, lw=1.8, zorder=1.9)  # below marks and Hopf curves
        if mask.any():
            handles.append(Line2D([], [], color=colour, lw=1.8, label=word))
    return handles


def mark_cycles_on_rows(
    axes: Axes, view: ResultView, line_parameter: str, row_parameter: str
) -> list[Line2D]:
    """Marks the special points of cycles on rows that lie on no curve; returns legend entries."""
    handles: list[Line2D] = []
    row_values = view.point_columns[row_parameter]
    kinds, positions = (view.by_point(f"cycle_special_{name}") for name in ("kind", line_parameter))
    for kind, (word, marker) in CYCLE_MARKS.items():
        rows, items = np.nonzero(kinds == SPECIAL_KINDS.index(kind))
        x, y = positions[rows, items], row_values[rows]
        is_free = ~_is_on_curve(view, SPECIAL_KINDS.index(kind), line_parameter, row_parameter, x, y)
        if is_free.any():
            handles += axes.plot(
                x[is_free], y[is_free], marker, color="k", mfc="white", ms=3.5, mew=0.8, label=word
            )
    return handles


def _is_on_curve(
    view: ResultView, kind: int, line_parameter: str, row_parameter: str, x: Array, y: Array
) -> NDArray[np.bool_]:
    """Mask of the special points (x, y), (n,) each, that lie on a curve of their kind `kind`."""
    variables = view.variables
    is_near = np.zeros(len(x), dtype=bool)
    if "cycle_curve_number" not in variables:
        return is_near
    row_values = view.point_columns[row_parameter]
    plane = DrawnPlane(variables[line_parameter], row_values[np.isfinite(row_values)])
    points = plane.fractions_of_axes(x, y)
    for curve in np.unique(variables["cycle_curve_number"][variables["cycle_curve_kind"] == kind]):
        mask = variables["cycle_curve_number"] == curve
        vertices = plane.fractions_of_axes(
            *(variables[f"cycle_curve_{name}"][mask] for name in (line_parameter, row_parameter))
        )
        vertices = vertices[np.append(True, np.diff(vertices, axis=0).any(axis=1))]
        for start, chord in zip(vertices[:-1], np.diff(vertices, axis=0), strict=True):
            fractions = np.clip((points - start) @ chord / (chord @ chord), 0, 1)
            distances = np.linalg.norm(points - start - fractions[:, None] * chord, axis=1)
            is_near |= distances <= CURVE_TOLERANCE
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
