"""Curves and special points of a phase diagram, and where the symbols of the curves stand."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.text import Annotation
from numpy.typing import NDArray

from ....arrays import Array
from ....results.file.view import ResultView
from ....results.layouts.branch import SPECIAL_KINDS
from ...plane_curves import PlaneParameters, curve_paths, is_stability_boundary_by_curve
from ..style import GREEN, TEX_SYMBOLS
from .criticality_curves import draw_hopf_curves_by_criticality
from .regions import DrawnPlane

CHORD_ROUNDING = 1e-6
"""Relative tolerance for the rounding error of the position of a vertex on a chord of its curve."""
LABEL_FONTSIZE = 8
"""Font size of a curve's symbol, in points."""
OTHER_LABEL_POSITIONS = (0.5, 0.3, 0.7, 0.9)
"""Fractions of the visible length at which a symbol is placed if it would overlap another symbol at its own
position, in order of preference."""
LABEL_BOX_FACTOR = 1.5
"""Factor by which the boxes of two symbols are enlarged before they are compared."""


def parts_at_lowest_force(paths: list[Array], force: int) -> list[Array]:
    """Parts of the curves `paths`, (n, 2) each, that have the smallest F of all curves. force: index of the
    column with F."""
    starts = np.concatenate([path[:-1] for path in paths])
    ends = np.concatenate([path[1:] for path in paths])
    y0 = starts[:, 1 - force]
    y1 = ends[:, 1 - force]
    parts = []
    for path in paths:
        y = path[:, 1 - force, None]
        edge_fraction = (y - y0) / np.where(y1 == y0, np.inf, y1 - y0)
        crosses = (np.minimum(y0, y1) <= y) & (y <= np.maximum(y0, y1))
        forces = starts[:, force] + edge_fraction * (ends[:, force] - starts[:, force])
        lowest = np.where(crosses, forces, np.inf).min(axis=1, initial=np.inf)
        parts.append(path[path[:, force] <= lowest * (1 + CHORD_ROUNDING)])
    return parts


def label_longest_curve(axes: Axes, paths: list[Array], name: str, length_fraction: float) -> None:
    """Writes the symbol `name` next to the path with the greatest visible length, at the fraction
    `length_fraction` of this length. paths: curves, (points, 2) each."""
    lengths = []
    seen = []
    for path in paths:
        places = axes.transAxes.inverted().transform(axes.transData.transform(path))
        is_inside = ((places >= 0) & (places <= 1)).all(axis=1)
        steps = np.linalg.norm(np.diff(places[is_inside], axis=0), axis=1)
        seen.append(path[is_inside])
        lengths.append(np.append(0.0, np.cumsum(steps)) if is_inside.any() else np.zeros(1))
    longest_index = max(range(len(paths)), key=lambda i: lengths[i][-1])
    if not lengths[longest_index][-1] > 0:
        return
    other_labels = [child for child in axes.get_children() if isinstance(child, Annotation)]
    for fraction in (length_fraction, *OTHER_LABEL_POSITIONS):
        vertex_index = int(np.searchsorted(lengths[longest_index], fraction * lengths[longest_index][-1]))
        place: dict[str, Any] = {"xytext": (4, -2), "textcoords": "offset points"}
        label = axes.annotate(name, seen[longest_index][vertex_index], size=LABEL_FONTSIZE, va="top", **place)
        if not any(_do_overlap(label, other) for other in other_labels):
            return
        label.remove()
    axes.annotate(name, seen[longest_index][0], size=LABEL_FONTSIZE, va="top", **place)


def _do_overlap(label: Annotation, other: Annotation) -> bool:
    """Whether two labels overlap, with a margin of half of their size, because panels shrink later."""
    first_box, second_box = (
        annotation.get_window_extent().expanded(LABEL_BOX_FACTOR, LABEL_BOX_FACTOR)
        for annotation in (label, other)
    )
    return bool(first_box.overlaps(second_box))


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
    axes: Axes, view: ResultView, parameters: PlaneParameters, hopf_only: bool
) -> list[Line2D]:
    """Draws boundary curves and folds; if `hopf_only`, only Hopf curves. Returns legend entries."""
    variables = view.variables
    has_criticality = "curve_criticality" in variables
    handles = draw_hopf_curves_by_criticality(axes, view, parameters) if has_criticality else []
    curve_looks = {0: DOUBLE_EIGENVALUE_LOOK} if has_criticality else CURVE_LOOKS
    for number, (word, width, style) in curve_looks.items():
        if hopf_only and number == 0:
            continue
        curves = curve_paths(view, parameters, "curve", number)
        for path in curves.values():
            axes.plot(*path.T, style, color="k", lw=width)
        if curves:
            handles.append(Line2D([], [], color="k", lw=width, ls=style, label=word))
        if curves and not has_criticality:
            paths = labelled_curve_paths(view, number, parameters)
            if paths and "F" in parameters:
                paths = parts_at_lowest_force(paths, 0 if parameters.line == "F" else 1)
            symbol, position = CURVE_SYMBOLS[number]
            if paths:
                label_longest_curve(axes, paths, symbol + plane_force_text(view, parameters), position)
    return handles if hopf_only else handles + _mark_curve_folds(axes, view, parameters)


def labelled_curve_paths(view: ResultView, kind: int, parameters: PlaneParameters) -> list[Array]:
    """Points, (n, 2), of the curves of the kind `kind` that are labelled with a symbol: all curves of kind 0
    (onsets); of the Hopf curves only those that bound the region of stable straight rods (F**)."""
    curves = curve_paths(view, parameters, "curve", kind)
    bounds = is_stability_boundary_by_curve(view, parameters) if kind else dict.fromkeys(curves, True)
    return [path for number, path in curves.items() if bounds[number]]


def plane_force_text(view: ResultView, parameters: PlaneParameters) -> str:
    """Text " = 30" if F is 30 in the whole plane; empty if F is on an axis."""
    return "" if "F" in parameters else f" = {float(view.parameter_values['F'][0]):g}"


def _mark_curve_folds(axes: Axes, view: ResultView, parameters: PlaneParameters) -> list[Line2D]:
    """Marks the folds of Hopf curves, and the fold in the partial beam limit; returns legend entries."""
    variables = view.variables
    handles = []
    for i in range(len(variables["fold"])):
        # A window of flutter closes at a fold of this kind.
        if variables["fold_kind"][i] == 1 and variables["fold_of"][i] == 1:
            F, row_value = (variables[f"fold_{name}"][i] for name in parameters)
            axes.plot(F, row_value, "ko", ms=4)
            label = (
                rf"fold ${TEX_SYMBOLS[parameters.line]} = {F:.6g}$, "
                rf"${TEX_SYMBOLS[parameters.row]} = {row_value:.6g}$"
            )
            handles.append(Line2D([], [], color="k", marker="o", ls="", ms=4, label=label))
    if "partial_beam_k1" in variables:
        F, row_value = float(variables["partial_beam_F"]), float(variables["partial_beam_k1"])
        x, y = (F, row_value) if parameters.line == "F" else (row_value, F)
        rows = view.parameter_values[parameters.row]
        if not (
            variables[parameters.line][0] <= x <= variables[parameters.line][-1] and rows[0] <= y <= rows[-1]
        ):
            return handles
        label = rf"partial beam $2F_c = {F:.6g}$, $4F_c = {row_value:.6g}$"
        handles += axes.plot(x, y, "+", color="k", ls="", ms=10, mew=1.2, label=label)
    return handles


def draw_cycle_curves(axes: Axes, view: ResultView, parameters: PlaneParameters) -> list[Line2D]:
    """Draws curves of folds and torus points of cycles; returns legend entries."""
    handles = []
    for kind, (word, colour) in CYCLE_CURVE_STYLES.items():
        curves = curve_paths(view, parameters, "cycle_curve", SPECIAL_KINDS.index(kind))
        for path in curves.values():
            axes.plot(*path.T, color=colour, lw=1.8, zorder=1.9)  # below marks and Hopf curves
        if curves:
            handles.append(Line2D([], [], color=colour, lw=1.8, label=word))
    return handles


def mark_cycles_on_rows(axes: Axes, view: ResultView, parameters: PlaneParameters) -> list[Line2D]:
    """Marks the special points of cycles on rows that lie on no curve; returns legend entries."""
    handles: list[Line2D] = []
    row_values = view.point_columns[parameters.row]
    kinds, positions = (view.by_point(f"cycle_special_{name}") for name in ("kind", parameters.line))
    for kind, (word, marker) in CYCLE_MARKS.items():
        rows, items = np.nonzero(kinds == SPECIAL_KINDS.index(kind))
        x, y = positions[rows, items], row_values[rows]
        is_free = ~_is_on_curve(view, SPECIAL_KINDS.index(kind), parameters, x, y)
        if is_free.any():
            handles += axes.plot(
                x[is_free], y[is_free], marker, color="k", mfc="white", ms=3.5, mew=0.8, label=word
            )
    return handles


def _is_on_curve(
    view: ResultView, kind: int, parameters: PlaneParameters, x: Array, y: Array
) -> NDArray[np.bool_]:
    """Mask of the special points (x, y), (n,) each, that lie on a curve of their kind `kind`."""
    variables = view.variables
    is_near = np.zeros(len(x), dtype=bool)
    if "cycle_curve_number" not in variables:
        return is_near
    row_values = view.point_columns[parameters.row]
    plane = DrawnPlane(variables[parameters.line], row_values[np.isfinite(row_values)])
    points = plane.fractions_of_axes(x, y)
    for path in curve_paths(view, parameters, "cycle_curve", kind).values():
        vertices = plane.fractions_of_axes(*path.T)
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
