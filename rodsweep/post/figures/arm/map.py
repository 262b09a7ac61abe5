"""Figures over the quantities of an arm, in the units typed by the user: curves against one quantity, maps
over two quantities.

Each point of the file is the centre of a cell of a map. Cells are hatched where the model does not apply, and
grey where the rod model does not apply.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ....arrays import Array
from ....config.arm.status import CRUSHED, FLUTTER_UNKNOWN, NO_FLUTTER, NO_WALL, NOT_SLENDER
from ....model.arm.drag import DRAG_ESTIMATE_NAMES
from ....model.arm.neglected import Validity
from ....results.file.view import ResultView
from ...summary.arm.arm import quantity_words
from .. import style
from ..cycle.point_map import cell_edges
from ..request import FigureRequest
from .panels import PANEL_MAKERS, Panel
from .quantities import NO_BREAK_SPACE, constant_quantities_text, in_typed_unit, quantity_text

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
MAP_HATCH_COLOUR = "0.35"
"""Grey of hatches, and of the edges of covered cells."""


def draw_arm_map(request: FigureRequest) -> str:
    """Draws the main results of a task over one or two quantities of an arm, with a panel of lines or a map
    for each result; returns a sentence. Raises InputError for options that the task does not have, and if
    nothing can be drawn."""
    view = replace(request, what=None).only_view()
    varied_axis_names = [name for name in view.arm_axes if len(view.variables[name]) > 1]
    if DRAG_AXIS in varied_axis_names and varied_axis_names[1:]:  # drawn as a band, or for the likeliest drag
        varied_axis_names.remove(DRAG_AXIS)
    axes = sorted(varied_axis_names, key=lambda name: -len(view.variables[name]))[:2]
    x_name = next(name for name in view.arm_axes if name in axes)
    y_name = next((name for name in view.arm_axes if name in axes and name != x_name), "")
    indices = {name: 0 for name in view.arm_axes if name not in axes}
    if DRAG_AXIS in indices:  # the likeliest drag has the smallest number
        indices[DRAG_AXIS] = int(np.argmin(view.variables[DRAG_AXIS]))
    index = tuple(indices.get(name, slice(None)) for name in view.arm_axes)
    panels = PANEL_MAKERS[view.task](view)
    style.require_content(view, any(np.isfinite(panel.values[index]).any() for panel in panels), "number")
    figure, plots = _new_panels(len(panels), request.look.is_narrow, bool(y_name))
    handles: list[Artist] = []
    covers = []
    for subplot, panel in zip(plots, panels, strict=True):
        if y_name:
            handles += _draw_map(subplot, panel, view, (x_name, y_name), index)
        else:
            handles += _draw_curves(subplot, panel, view, x_name, index)
        covers.append(_cover_invalid_cells(subplot, view, panel, (x_name, y_name), index))
    handle_by_label = {
        str(handle.get_label()): handle for handle in reversed(handles)
    }  # first of equal entries
    style.draw_legend_below(figure, [*reversed(handle_by_label.values()), *covers[0]], column_count=3)
    band_axes = (
        [DRAG_AXIS] if not y_name and DRAG_AXIS in indices and len(view.variables[DRAG_AXIS]) > 1 else []
    )
    figure.suptitle(style.heading_text(view, constant_quantities_text(view, axes + band_axes)))
    labels = " and ".join(panel.label for panel in panels)
    constants = {name: place for name, place in indices.items() if name not in band_axes}
    constants_text = _section_text(view, constants)
    return request.write(figure, f"{labels} over {' and '.join(map(quantity_words, axes))}{constants_text}")


def _section_text(view: ResultView, indices: dict[str, int]) -> str:
    """Clause on the values at which a map is drawn of axes with several values, which it does not show; empty
    if there is no such axis."""
    texts = []
    for name, index in indices.items():
        values = view.variables[name]
        if len(values) > 1:
            texts.append(f"{quantity_text(view, name, float(values[index]))} (of {len(values)} values)")
    return f"; only for {' and '.join(texts).replace(NO_BREAK_SPACE, ' ')}" if texts else ""


def can_draw_arm_map(request: FigureRequest) -> bool:
    """Whether `draw_arm_map` draws the requested figure: quantities of the arm vary in the only file, and the
    user has not chosen another kind of figure."""
    view = request.views[0]
    has_other_options = request.what not in (None, *ARM_MAP_FIGURE_KINDS) or request.points or request.roots
    has_map = any(len(view.variables[name]) > 1 for name in view.arm_axes)
    return len(request.views) == 1 and has_map and view.task in PANEL_MAKERS and not has_other_options


def _typed_axis_values_and_label(view: ResultView, name: str) -> tuple[Array, str]:
    """Returns (values along the axis `name`, (n,), label of the axis), in the unit typed by the user."""
    values = view.variables[name]
    if name in style.LABELS:
        return values, style.LABELS[name]
    values, unit = in_typed_unit(view, name, values)
    return values, quantity_words(name) + (f" ({unit})" if unit else "")


def _new_panels(panel_count: int, is_narrow: bool, maps: bool) -> tuple[Figure, list[Axes]]:
    """Returns (figure, panels) with `panel_count` panels: side by side if `maps` and not `is_narrow`, else
    stacked."""
    is_one_row = maps and not is_narrow
    figure_size = (4.8 * panel_count, 4.4) if is_one_row else (4.6, 2.9 * panel_count)
    layout = ConstrainedLayoutEngine(wspace=0.06 if is_one_row else 0.0)  # room for the label of a colour bar
    figure = Figure(figsize=figure_size, layout=layout)
    grid_shape = (1, panel_count) if is_one_row else (panel_count, 1)
    return figure, list(figure.subplots(*grid_shape, sharex=True, sharey=maps, squeeze=False).ravel())


def _draw_map(axes: Axes, panel: Panel, view: ResultView, names: tuple[str, str], index: Any) -> list[Artist]:
    """Draws a panel as a map over two quantities; returns legend entries. names: quantities on x and y."""
    (x_values, x_label), (y_values, y_label) = (_typed_axis_values_and_label(view, name) for name in names)
    values = np.ma.masked_invalid(panel.values[index].T)
    style.draw_coloured_cells(
        axes, (cell_edges(x_values), cell_edges(y_values)), panel.values[index].T, panel.label
    )
    handles: list[Artist] = []
    if panel.zero_contour_label and values.min() < 0 < values.max():
        axes.contour(x_values, y_values, values, [0.0], colors="k", linewidths=1.4)
        handles.append(Line2D([], [], color="k", lw=1.4, label=panel.zero_contour_label))
    style.scale_axis(axes, "x", x_values)
    style.scale_axis(axes, "y", y_values)
    style.label_outer(axes, x_label, y_label)
    return handles


def _draw_curves(axes: Axes, panel: Panel, view: ResultView, name: str, index: Any) -> list[Artist]:
    """Draws a panel as curves against the quantity `name`; returns legend entries."""
    x_values, label = _typed_axis_values_and_label(view, name)
    colours = (style.VERMILION, style.BLUE, style.GREEN)
    handles: list[Artist] = []
    lines = panel.threshold_lines or {"": panel.values}
    for colour, (line, values) in zip(colours, lines.items(), strict=False):
        line_format = "o" if name == DRAG_AXIS else "-o"
        axes.plot(x_values, values[index], line_format, ms=2.5, lw=1.2, color=colour)
        handles += _draw_drag_band(axes, view, name, values, index, colour)
        if line and np.isfinite(values[index]).any():
            handles.append(Line2D([], [], color=colour, marker="o", ms=2.5, lw=1.2, label=line))
    style.scale_axis(axes, "x", x_values)
    if name == DRAG_AXIS:
        axes.set_xticks(
            x_values, [DRAG_ESTIMATE_NAMES[int(drag)].replace("_", "\n") for drag in x_values], rotation=90
        )
    has_several_lines = sum(isinstance(artist, Line2D) for artist in handles) > 1
    style.label_outer(axes, label, panel.lines_label if has_several_lines else panel.label)
    return handles


def _draw_drag_band(
    axes: Axes, view: ResultView, x_name: str, values: Array, index: Any, colour: str
) -> list[Artist]:
    """Draws the range of a result over the drags as a band of the colour `colour`; returns the legend entry
    as a list. x_name: name of the quantity on the horizontal axis. The list is empty if the drag does not
    vary, or is the quantity on the horizontal axis."""
    if DRAG_AXIS not in view.arm_axes or x_name == DRAG_AXIS or len(view.variables[DRAG_AXIS]) < 2:
        return []
    drag = view.arm_axes.index(DRAG_AXIS)
    values_by_drag = np.moveaxis(values, drag, -1)[(*index[:drag], *index[drag + 1 :])]
    bounds = (bound.reduce(values_by_drag, axis=-1) for bound in (np.fmin, np.fmax))
    x_values, _ = _typed_axis_values_and_label(view, x_name)
    axes.fill_between(x_values, *bounds, color=colour, alpha=BAND_OPACITY, lw=0, zorder=1)
    line_name = DRAG_ESTIMATE_NAMES[int(view.variables[DRAG_AXIS].min())].replace("_", " ")
    return [Patch(color="0.3", alpha=BAND_OPACITY, lw=0, label=f"range of drag (line: {line_name})")]


def _cover_invalid_cells(
    axes: Axes, view: ResultView, panel: Panel, names: tuple[str, str], index: Any
) -> list[Artist]:
    """Hatches the cells where the model does not apply, and fills the cells outside the rod model or without
    a value; returns legend entries. names: quantities on x and y."""
    x_name, y_name = names
    rods = view.variables["status"][index] < NOT_SLENDER
    empty = [(rods & np.isnan(panel.values[index]), panel.no_value_label, EMPTY_CELL_LOOK)] if y_name else []
    x_edges = cell_edges(_typed_axis_values_and_label(view, x_name)[0])
    limits = axes.get_ylim()
    y_edges = cell_edges(_typed_axis_values_and_label(view, y_name)[0]) if y_name else np.array(limits)
    handles: list[Artist] = []
    for variable, value, label, look in COVERED_CELL_LOOKS:
        is_covered = view.variables[variable][index] == value
        empty.append((is_covered if variable == "status" else is_covered & rods, label, look))
    for is_covered, label, look in empty:
        for i, j in np.argwhere(is_covered if y_name else is_covered[:, None]):
            corner = x_edges[[i, i + 1]], y_edges[[j, j + 1]]
            axes.fill_between(
                corner[0], *corner[1], ec=MAP_HATCH_COLOUR, lw=0, zorder=3 if y_name else 0, **look
            )
        if is_covered.any():
            handles.append(Patch(label=label, ec=MAP_HATCH_COLOUR, lw=0.5, **look))
    axes.set_xlim(x_edges[0], x_edges[-1])
    axes.set_ylim(y_edges[0], y_edges[-1]) if y_name else axes.set_ylim(limits)
    return handles
