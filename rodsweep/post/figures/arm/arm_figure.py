"""Figures over the quantities of an arm, in the units typed by the user: curves against one quantity, maps
over two quantities.

Each point of the file is the centre of a cell of a map. Cells are hatched where the model is doubtful or does
not apply, and grey where an arm corresponds to no rod.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ....arrays import Array
from ....config.arm.status import CRUSHED, FLUTTER_UNKNOWN, NO_FLUTTER, NO_WALL, NOT_SLENDER
from ....model.arm.drag import DRAG_ESTIMATE_NAMES
from ....model.arm.neglected import Validity
from ....results.file.view import ResultView
from ...summary.arm.arm_texts import printed_quantity_name
from .. import style
from ..cells import cell_edges, draw_coloured_cells, fill_cells, new_map_panels
from ..request import FigureRequest
from .panels import PANEL_MAKER_BY_TASK, Panel
from .quantities import NO_BREAK_SPACE, constant_quantities_text, quantity_text, values_and_label

ARM_MAP_FIGURE_KINDS = ("map", "maps")
"""Values of `--what` that request this figure."""
COVERED_CELL_LOOKS: tuple[tuple[str, int, str, dict[str, Any]], ...] = (
    ("model_applies", Validity.doubtful, "model doubtful", {"fc": "none", "hatch": "..."}),
    ("model_applies", Validity.does_not_apply, "model does not apply", {"fc": "none", "hatch": "////"}),
    ("status", NOT_SLENDER, "shorter than 10 radii", {"fc": "0.85", "hatch": ""}),
    ("status", CRUSHED, "crushed", {"fc": "0.65", "hatch": ""}),
    ("status", NO_FLUTTER, "no flutter", {"fc": "0.75", "hatch": ""}),
    ("status", FLUTTER_UNKNOWN, "flutter unknown", {"fc": "0.95", "hatch": "xx"}),
    ("status", NO_WALL, "no wall", {"fc": "0.45", "hatch": ""}),
)
"""(variable, value, legend entry, look) of covered cells of a map. Later entries are drawn over earlier
entries."""
DRAG_AXIS = "drag"
"""Name of the axis of drags. In a figure against another quantity, the range of a result over all drags is
drawn as a band."""
BAND_OPACITY = 0.25
"""Opacity of the band between the smallest and the largest value over all drags."""
EMPTY_CELL_LOOK: dict[str, Any] = {"fc": "#E8EDF2"}
"""Matplotlib style of cells whose arm corresponds to a rod but has no result, such as a rod without
flutter."""
LINE_COLOURS = (style.VERMILION, style.BLUE, style.GREEN)
"""Colours of the lines of a panel."""
MAP_HATCH_COLOUR = "0.35"
"""Grey of hatches, and of the edges of covered cells."""


def draw_arm_figure(request: FigureRequest) -> str:
    """Draws the main results of a task over one or two quantities of an arm, with a panel of lines or a map
    for each result; returns a description of the figure. Raises InputError for options that the task does not
    have, and if nothing can be drawn."""
    view = replace(request, what=None).require_single_view()
    names = _quantities_on_axes(view)
    indices = {
        # The likeliest drag has the smallest number.
        name: int(np.argmin(view.variables[name])) if name == DRAG_AXIS else 0
        for name in view.arm_axes
        if name not in names
    }
    index = tuple(indices.get(name, slice(None)) for name in view.arm_axes)
    panels = PANEL_MAKER_BY_TASK[view.task](view)
    style.require_content(view, any(np.isfinite(panel.values[index]).any() for panel in panels), "number")
    is_map = len(names) > 1
    is_stacked = request.look.is_narrow or not is_map
    figure, plots = new_map_panels(len(panels), is_stacked, shares_y=is_map)
    draw_panel = _draw_map if is_map else _draw_curves
    for axes, panel in zip(plots, panels, strict=True):
        draw_panel(axes, panel, view, names, index)
        _cover_invalid_cells(axes, view, panel, names, index)
    style.draw_shared_legend(figure, column_count=3)
    shown_names = [*names, DRAG_AXIS] if _shows_range_over_drags_as_band(view, names) else names
    figure.suptitle(style.heading_text(view, constant_quantities_text(view, shown_names)))
    labels = " and ".join(panel.label for panel in panels)
    constants = {name: place for name, place in indices.items() if name not in shown_names}
    axes_text = " and ".join(map(printed_quantity_name, names))
    return request.write(figure, f"{labels} over {axes_text}{_omitted_axes_clause(view, constants)}")


def _quantities_on_axes(view: ResultView) -> list[str]:
    """Names of the one or two quantities on the axes, x first: the quantities with the most values. If
    another quantity varies, the drag has no axis: results are drawn as a band over all drags, or for the
    likeliest drag."""
    varied = [name for name in view.arm_axes if len(view.variables[name]) > 1]
    candidates = [name for name in varied if name != DRAG_AXIS] or varied
    longest = sorted(candidates, key=lambda name: -len(view.variables[name]))[:2]
    return [name for name in view.arm_axes if name in longest]


def _shows_range_over_drags_as_band(view: ResultView, names: Sequence[str]) -> bool:
    """Whether the figure over the quantities `names` shows the range of a result over the drags as a band."""
    has_drags = DRAG_AXIS in view.arm_axes and len(view.variables[DRAG_AXIS]) > 1
    return has_drags and len(names) == 1 and DRAG_AXIS not in names


def _omitted_axes_clause(view: ResultView, indices: dict[str, int]) -> str:
    """Clause on the axes with several values that the figure does not show: the value of each axis at which
    the figure is drawn. Empty if there is no such axis. indices: index of this value, by name of the axis."""
    texts = []
    for name, index in indices.items():
        values = view.variables[name]
        if len(values) > 1:
            texts.append(f"{quantity_text(view, name, float(values[index]))} (of {len(values)} values)")
    return f"; only for {' and '.join(texts).replace(NO_BREAK_SPACE, ' ')}" if texts else ""


def can_draw_arm_figure(request: FigureRequest) -> bool:
    """Whether `draw_arm_figure` draws the requested figure: quantities of the arm vary in the only file, its
    task has such figures, and the user has not chosen points, roots or another kind of figure."""
    view = request.views[0]
    has_other_options = request.what not in (None, *ARM_MAP_FIGURE_KINDS) or request.points or request.roots
    has_map = any(len(view.variables[name]) > 1 for name in view.arm_axes)
    return len(request.views) == 1 and has_map and view.task in PANEL_MAKER_BY_TASK and not has_other_options


def _typed_axis_values_and_label(view: ResultView, name: str) -> tuple[Array, str]:
    """Returns (values along the axis `name`, (n,), label of the axis), in the unit typed by the user."""
    values = view.variables[name]
    if name in style.AXIS_LABELS:
        return values, style.AXIS_LABELS[name]
    return values_and_label(view, name, values)


def _draw_map(axes: Axes, panel: Panel, view: ResultView, names: Sequence[str], index: Any) -> None:
    """Draws a panel as a map over the two quantities `names`. index: index of the drawn values in the arrays
    of the file."""
    (x, x_label), (y, y_label) = (_typed_axis_values_and_label(view, name) for name in names)
    values = panel.values[index].T
    draw_coloured_cells(axes, (cell_edges(x), cell_edges(y)), values, panel.label)
    if panel.zero_contour_label and np.nanmin(values) < 0 < np.nanmax(values):
        axes.contour(x, y, np.ma.masked_invalid(values), [0.0], colors="k", linewidths=1.4)
        axes.plot([], [], color="k", lw=1.4, label=panel.zero_contour_label)
    style.scale_axis(axes, "x", x)
    style.scale_axis(axes, "y", y)
    style.label_outer_panels(axes, x_label, y_label)


def _draw_curves(axes: Axes, panel: Panel, view: ResultView, names: Sequence[str], index: Any) -> None:
    """Draws a panel as curves against the quantity `names[0]`, with bands of the range over the drags. index:
    as in `_draw_map`."""
    (name,) = names
    x, x_label = _typed_axis_values_and_label(view, name)
    lines = {
        label: values for label, values in panel.threshold_lines.items() if np.isfinite(values[index]).any()
    }
    for colour, (label, values) in zip(LINE_COLOURS, (lines or {"": panel.values}).items(), strict=False):
        line_format = "o" if name == DRAG_AXIS else "-o"
        axes.plot(x, values[index], line_format, ms=2.5, lw=1.2, color=colour, label=label)
        if _shows_range_over_drags_as_band(view, names):
            _draw_drag_band(axes, view, x, values, colour, index)
    style.scale_axis(axes, "x", x)
    if name == DRAG_AXIS:
        words = [DRAG_ESTIMATE_NAMES[int(drag)].replace("_", "\n") for drag in x]
        axes.set_xticks(x, words, rotation=90)
    style.label_outer_panels(axes, x_label, panel.threshold_axis_label if len(lines) > 1 else panel.label)


def _draw_drag_band(axes: Axes, view: ResultView, x: Array, values: Array, colour: str, index: Any) -> None:
    """Draws the range of a result over the drags as a band. x: values on the horizontal axis, (n,). values:
    result at all points of the file. index: as in `_draw_map`."""
    drag = view.arm_axes.index(DRAG_AXIS)
    values_by_drag = np.moveaxis(values, drag, -1)[(*index[:drag], *index[drag + 1 :])]
    bounds = (bound.reduce(values_by_drag, axis=-1) for bound in (np.fmin, np.fmax))
    line_name = DRAG_ESTIMATE_NAMES[int(view.variables[DRAG_AXIS].min())].replace("_", " ")
    look: dict[str, Any] = {"color": colour, "alpha": BAND_OPACITY, "lw": 0, "zorder": 1}
    axes.fill_between(x, *bounds, label=f"range of drag (line: {line_name})", **look)


def _cover_invalid_cells(
    axes: Axes, view: ResultView, panel: Panel, names: Sequence[str], index: Any
) -> None:
    """Hatches the cells where the model is doubtful or does not apply, and fills the cells of arms that
    correspond to no rod; in a map, also fills the cells without a value. index: as in `_draw_map`."""
    is_map = len(names) > 1
    edges = [cell_edges(_typed_axis_values_and_label(view, name)[0]) for name in names]
    y_limits = axes.get_ylim()
    x_edges, y_edges = edges if is_map else (edges[0], np.array(y_limits))
    rods = view.variables["status"][index] < NOT_SLENDER
    covers = [(rods & np.isnan(panel.values[index]), panel.no_value_label, EMPTY_CELL_LOOK)] if is_map else []
    for variable, value, label, look in COVERED_CELL_LOOKS:
        is_covered = view.variables[variable][index] == value
        covers.append((is_covered if variable == "status" else is_covered & rods, label, look))
    for is_covered, label, look in covers:
        look_of_all = {"ec": MAP_HATCH_COLOUR, "zorder": 3 if is_map else 0, "label": label}
        fill_cells(axes, (x_edges, y_edges), np.atleast_2d(is_covered.T), **look_of_all, **look)
    axes.set_xlim(x_edges[0], x_edges[-1])
    axes.set_ylim(y_edges[0], y_edges[-1])
