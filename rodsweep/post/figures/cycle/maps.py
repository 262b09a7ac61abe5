"""Maps of limit cycles over two parameters: period, largest y of the tip, other statuses, and Hopf points.

Each point of the file is the centre of a cell. Only the lines of Hopf points are interpolated.
"""

from collections.abc import Iterator, Sequence
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from ....arrays import Array
from ....config.arm.axes import PARAMETER_CHANGED_ALONG
from ....results.file.view import ResultView
from ....results.layouts.limit_cycle import STATUS_NAMES_WITH_CYCLE
from ....sweep.points.points import ParameterLine
from ...located_thresholds import LocatedThreshold, StoredThresholds
from .. import style
from ..cells import (
    PointGrid,
    axis_coordinates_and_inverse,
    draw_coloured_cells,
    fill_cells,
    label_maps,
    new_map_panels,
    point_grid,
)
from .amplitudes.square_root_law import HOPF_SYMBOL
from .selection import shared_and_own_texts_of_arms
from .units_and_labels import units_of_files

STATUS_LOOKS = {
    "straight": ("#E8EDF2", ""),
    "missing": ("white", "...."),
    "not_settled": ("#C4C4C4", "////"),
    "left_the_model": ("#9A9A9A", "\\\\\\\\"),
    "failed": ("#6E6E6E", "xxxx"),
    "torus": ("#D9CBBF", "++++"),
}
"""(colour, hatch) of cells without a cycle, by status. The colours are greys, which the colour maps do not
contain."""
UNLISTED_STATUS_LOOKS = (("#BFA893", "----"), ("#8F7A68", "oooo"))
"""(colour, hatch) of cells with a status that is not in STATUS_LOOKS, in order of appearance."""
PANEL_WIDTH_POINTS = 250
"""Width of a panel, in points (1/72 inch)."""
MARKER_SIZE_LIMITS = 1.0, 4.0
"""Smallest and largest size, in points, of the open marker of an unstable cycle. Between these limits the
size is half a cell."""
CYCLE_MAP_GREY = "0.25"
"""Grey of the hatches of cells without a cycle, and of the markers of unstable cycles."""
MAX_LEGEND_ROW_ENTRIES = 6
"""Largest number of entries in one row of the legend."""
MAP_QUANTITIES = (("period", "viridis", True), ("tip_y_max", "plasma", False))
"""(variable, colour map, whether colours are logarithmic if the values span more than a decade) of each
panel."""


def draw_maps(view: ResultView, is_narrow: bool = False) -> tuple[Figure, str]:
    """Returns (figure, description). The figure has maps of the period and of the largest y of the tip, with
    Hopf points, unstable cycles, and the statuses of cells without a cycle. is_narrow: whether the maps are
    stacked. Raises InputError if no point has a cycle."""
    points = point_grid(view)
    statuses = view.status_names[points.point_indices]
    cycles = np.isin(statuses, STATUS_NAMES_WITH_CYCLE)
    style.require_content(view, cycles.any(), "cycle")
    figure, panels = new_map_panels(2, is_narrow)
    lines = hopf_lines(points, view)
    (units,) = units_of_files([view], [points.point_indices.ravel()])
    _, largest_y, period, _ = units.panel_labels
    for axes, label, (name, colours, ratios) in zip(panels, (period, largest_y), MAP_QUANTITIES, strict=True):
        converted = units.converted({name: view.variables[name].ravel()[points.point_indices.ravel()]})[name]
        values = np.where(cycles, converted.reshape(points.point_indices.shape), np.nan)
        draw_coloured_cells(axes, points.edges, values, label, colours, ratios)
        _draw_statuses(axes, points, statuses)
        _draw_hopf_lines(axes, points, lines)
        _mark_unstable(axes, points, statuses == "unstable")
    label_maps(panels, points)
    style.draw_shared_legend(figure, column_count=MAX_LEGEND_ROW_ENTRIES)
    figure.suptitle(style.heading_text(view, _common_parameters_text(view, points, units.in_si)))
    return figure, f"period and amplitude over {' and '.join(points.names)}{points.omissions_clause}"


def _common_parameters_text(view: ResultView, points: PointGrid, is_in_si: bool) -> str:
    """Text of the parameters that are equal at all points; for an arm (`is_in_si`), of the quantities that
    are equal at all points."""
    if not is_in_si:
        return style.parameter_text(points.shared_parameters)
    varied = (quantity for quantity, name in PARAMETER_CHANGED_ALONG.items() if name in points.names)
    numbers = [int(points.point_indices[place]) + 1 for place in ((0, 0), (-1, -1))]
    return shared_and_own_texts_of_arms(view, numbers, {*points.names, *varied})[0]


def _draw_statuses(axes: Axes, points: PointGrid, statuses: NDArray[np.str_]) -> None:
    """Fills the cells without a cycle with colours and hatches by status. statuses: status of each cell, (ny,
    nx)."""
    unlisted_looks = cycle(UNLISTED_STATUS_LOOKS)
    for word in dict.fromkeys([*STATUS_LOOKS, *np.unique(statuses).tolist()]):
        if word not in STATUS_NAMES_WITH_CYCLE and word in statuses:
            colour, hatch = STATUS_LOOKS.get(word) or next(unlisted_looks)
            look = {"fc": colour, "hatch": hatch, "ec": CYCLE_MAP_GREY, "label": word.replace("_", " ")}
            fill_cells(axes, points.edges, statuses == word, **look)


def _mark_unstable(axes: Axes, points: PointGrid, unstable: NDArray[np.bool_]) -> None:
    """Draws an open marker in each cell of the mask `unstable`, (ny, nx)."""
    if unstable.any():
        look: dict[str, Any] = {"marker": "o", "mfc": "white", "mec": CYCLE_MAP_GREY, "ls": "", "mew": 0.6}
        row, column = np.nonzero(unstable)
        size = float(np.clip(PANEL_WIDTH_POINTS / max(unstable.shape) / 2, *MARKER_SIZE_LIMITS))
        axes.plot(points.x[column], points.y[row], ms=size, label="unstable cycle", **look)


def _draw_hopf_lines(axes: Axes, points: PointGrid, lines: Sequence[Array]) -> None:
    """Draws lines of Hopf points. lines: (x, y) of each line, (2, n). On these lines the leading growth rate
    is zero. Every zero is a Hopf point: no eigenvalue can pass through 0, because the characteristic
    determinant D has D(0) = 1."""
    label = f"Hopf points ${HOPF_SYMBOL}$" if "F" in points.names else "Hopf points"
    path_effects = [withStroke(linewidth=3.0, foreground="white")]
    for line in lines:
        axes.plot(*line, color="k", lw=1.4, path_effects=path_effects, label=label)


def hopf_lines(points: PointGrid, view: ResultView) -> list[Array]:
    """Lines of Hopf points, (x, y) of shape (2, n) each, as contours of zero leading growth rate.

    Along each row the growth rate is interpolated linearly between the points of the file and the located
    Hopf points; between rows, linearly on the scale of y. A contour therefore passes through the located Hopf
    points of every row. Without a change of sign of the growth rate, the list is empty.
    """
    (x, x_back), (y, y_back) = (axis_coordinates_and_inverse(values) for values in (points.x, points.y))
    to_scale = np.log if style.is_logarithmic(points.x) else np.asarray
    growth = view.variables["linear_growth_rate"].ravel()[points.point_indices]
    zeros = [to_scale(hopf_values) for hopf_values in _hopf_points(points, view)]
    refined_x = np.unique(np.concatenate([x, *zeros]))
    rows = []
    for row, row_zeros in zip(growth, zeros, strict=True):
        nodes, indices = np.unique(np.concatenate([x, row_zeros]), return_index=True)
        rows.append(np.interp(refined_x, nodes, np.concatenate([row, np.zeros_like(row_zeros)])[indices]))
    if not np.nanmin(rows) < 0 < np.nanmax(rows):
        return []
    # This figure is never drawn; matplotlib only computes the contours.
    contours = Figure().subplots().contour(refined_x, y, np.ma.masked_invalid(rows), levels=[0.0])
    lines = (line for line in contours.allsegs[0] if len(line) > 1)
    return [np.array([x_back(line[:, 0]), y_back(line[:, 1])]) for line in lines]


def _hopf_points(points: PointGrid, view: ResultView) -> Iterator[Array]:
    """Yields, for each row of a map, the values of the parameter on the x axis at the located Hopf points,
    (n,)."""
    name, row_parameter = points.names
    stored_thresholds = StoredThresholds(view, name)
    for value, row_indices in zip(points.y, points.point_indices, strict=True):
        parameters = points.shared_parameters | {row_parameter: float(value)}
        changes = stored_thresholds.thresholds_on_line(ParameterLine(name, parameters, points.x, row_indices))
        located = (change for change in changes if isinstance(change, LocatedThreshold))
        yield np.array([change.position for change in located if change.changes_stability])
