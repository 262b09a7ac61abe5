"""Limit cycles against a parameter: amplitudes of the tip, as in the paper's Fig. 6, period and power."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .....arrays import Array, list_of
from .....config.arm.axes import PARAMETER_CHANGED_ALONG
from .....config.task.limit_cycle import LONGEST_AXIS_KEYWORD
from .....errors import InputError
from .....results.file.view import ResultView
from .....results.layouts.limit_cycle import STATUS_NAMES_WITH_CYCLE
from ... import style
from ...grid_slices import infinite_values_clause
from ..selection import shared_and_own_texts, shared_and_own_texts_of_arms
from ..units_and_labels import units_of_files
from .amplitude_series import AmplitudeSeries, abscissa_parameter, amplitude_series
from .square_root_law import draw_square_root_laws, mark_hopf_points, square_root_laws

SERIES_LOOKS = tuple(zip(style.LINE_COLOURS, ("o", "s", "^", "D", "v", "P"), strict=True))
"""(colour, marker) of each line."""
MIN_ARROW_POINTS = 4
"""Only a line with at least this number of points has an arrow in the direction of continuation."""
UNSTABLE_CYCLE_MARKER_LOOK: dict[str, Any] = {
    "ls": "", "ms": 5.0, "zorder": 3, "label": "unstable cycle"
}  # fmt: skip
"""Matplotlib style of the open markers of unstable cycles, which are drawn over the markers of the line."""


def draw_amplitude(views: Sequence[ResultView], is_narrow: bool = False) -> tuple[Figure, str]:
    """Returns (figure, description). The figure shows (x_max - x_min)/2 and y_max of the tip, period and
    power against a parameter.

    A straight arm has amplitude 0 and no period. is_narrow: whether all panels are stacked. Raises InputError
    for too many lines.
    """
    first_view = views[0]
    name = abscissa_parameter(first_view)
    units = units_of_files(views, [np.arange(view.variables["status"].size) for view in views])
    pairs = zip(views, units, strict=True)
    all_series = [series for view, own_units in pairs for series in amplitude_series(view, name, own_units)]
    if len(all_series) > len(SERIES_LOOKS):
        raise InputError(
            f"{first_view.path} gives {len(all_series)} lines over {name}, and a figure has room for "
            f"{len(SERIES_LOOKS)}: choose lines with --at, such as --at k1=150, or draw a full grid over two "
            "parameters as maps (--what maps)"
        )
    has_amplitude = any(np.isfinite(series.tip_y_max).any() for series in all_series)
    style.require_content(first_view, has_amplitude, "amplitude")
    figure = Figure(figsize=(4.4, 8.4) if is_narrow else (8.6, 5.6), layout="constrained")
    panels = figure.subplots(*((4, 1) if is_narrow else (2, 2)), sharex=True).T.ravel()
    common_text, series_texts = _shared_and_own_texts(all_series, name)
    _draw_series(panels, all_series, series_texts, _legend_entries_and_directions(views, name))
    coloured = zip(all_series, SERIES_LOOKS, strict=False)
    mark_hopf_points(panels, [(point, look[0]) for series, look in coloured for point in series.hopf_points])
    laws = [
        law
        for series in all_series
        for law in square_root_laws(series.x, series.tip_y_max, series.hopf_points)
    ]
    draw_square_root_laws(panels[1], laws, units[0].names[0] * units[0].in_si)
    _label_axes(panels, name, units[0].panel_labels)
    for panel in panels:
        style.scale_axis(panel, "x", np.unique(all_series[0].x))
    style.draw_shared_legend(figure, column_count=2)
    figure.suptitle(style.heading_text(first_view, common_text))
    omissions = [infinite_values_clause(view.point_columns, [name]) for view in views]
    return figure, f"amplitudes of the tip, period and power against {name}{max(omissions, key=len)}"


def _draw_series(
    panels: Sequence[Axes],
    all_series: Sequence[AmplitudeSeries],
    texts: Sequence[str],
    direction_labels: dict[int, tuple[str, bool | None]],
) -> None:
    """Draws all lines in all panels. texts: text of each line for the legend. direction_labels: result of
    `_legend_entries_and_directions`."""
    for series, text, (colour, marker) in zip(all_series, texts, SERIES_LOOKS, strict=False):
        look: dict[str, Any] = {"color": colour, "marker": marker, "lw": 1.2, "ms": 3.5}
        # Open, larger markers do not hide the markers of the first file.
        if series.view is not all_series[0].view:
            look |= {"mfc": "none", "ms": 6.5, "ls": "--"}
        word, upward = direction_labels[id(series.view)]
        label = ", ".join(filter(None, (word, text)))
        unstable = series.status_names == "unstable"
        for axes, values in zip(panels, series.drawn_quantities, strict=True):
            axes.plot(*series.x_and_values_with_gaps(values), label=label, **look)
            if unstable.any():
                axes.plot(
                    series.x[unstable],
                    values[unstable],
                    mfc=rcParams["axes.facecolor"],
                    **look | UNSTABLE_CYCLE_MARKER_LOOK,
                )
            if upward is not None:
                _draw_direction_arrow(axes, series.x, values, upward, colour)
            _mark_unknown_amplitudes(axes, series, colour)


def _mark_unknown_amplitudes(axes: Axes, series: AmplitudeSeries, colour: str) -> None:
    """Marks, at the top of a panel, the points of a line without a known amplitude, by status."""
    look: dict[str, Any] = {
        "transform": axes.get_xaxis_transform(),
        "color": colour,
        "ms": 5,
        "clip_on": False,
    }
    for word in list_of(np.unique(series.status_names)):
        if word not in (*STATUS_NAMES_WITH_CYCLE, "straight", "missing"):
            x = series.x[series.status_names == word]
            axes.plot(x, np.ones(len(x)), "x", label=f"{word.replace('_', ' ')} (at the top)", **look)


def _legend_entries_and_directions(
    views: Sequence[ResultView], name: str
) -> dict[int, tuple[str, bool | None]]:
    """Returns {id(view): (legend entry, is_upward)}; the path is no key, because all Datasets of Python have
    the same path. is_upward: whether the parameter `name` increased during the continuation; None unless the
    files differ in this direction. Files with different directions of continuation are distinguished by
    direction, other files by name."""
    if len(views) == 1:
        return {id(views[0]): ("", None)}
    options = [view.config.get("limit_cycle", {}) for view in views]
    followed = all(
        chosen.get("start") == "neighbour"
        and chosen.get("along", LONGEST_AXIS_KEYWORD) in (name, LONGEST_AXIS_KEYWORD)
        for chosen in options
    )
    directions = [chosen.get("direction", "up") for chosen in options]
    if not followed or len(set(directions)) < len(views):
        return {id(view): (style.escape_dollar_signs(view.path.stem), None) for view in views}
    entries = {
        "up": (f"${style.TEX_SYMBOLS[name]}$ rising", True),
        "down": (f"${style.TEX_SYMBOLS[name]}$ falling", False),
    }
    return {id(view): entries[direction] for view, direction in zip(views, directions, strict=True)}


def _draw_direction_arrow(axes: Axes, x: Array, values: Array, upward: bool, colour: str) -> None:
    """Draws an arrow of the colour `colour` on a line in the direction of continuation. x, values: points of
    the line, (n,) each. upward: whether the parameter increased."""
    finite_indices = np.flatnonzero(np.isfinite(values))
    if len(finite_indices) < MIN_ARROW_POINTS:
        return
    place = len(finite_indices) * 3 // 4
    ends = finite_indices[place - 1], finite_indices[place]
    tail, head = ((x[i], values[i]) for i in (ends if upward else ends[::-1]))
    arrow = {"arrowstyle": "-|>", "color": colour, "lw": 1.2, "mutation_scale": 14}
    axes.annotate("", head, tail, arrowprops=arrow, zorder=4)


def _shared_and_own_texts(all_series: Sequence[AmplitudeSeries], name: str) -> tuple[str, list[str]]:
    """Returns (text of the parameters that are equal for all lines, text of the other parameters of each
    line); for an arm, of the quantities in the units typed by the user. name: parameter on the horizontal
    axis."""
    view = all_series[0].view
    if all_series[0].units.in_si and all(series.view is view for series in all_series):
        axis_names = [
            quantity for quantity, changed_name in PARAMETER_CHANGED_ALONG.items() if changed_name == name
        ]
        numbers = [series.first_point_number for series in all_series]
        return shared_and_own_texts_of_arms(view, numbers, {name, *axis_names})
    return shared_and_own_texts([series.constant_parameters for series in all_series])


def _label_axes(panels: Sequence[Axes], name: str, labels: Sequence[str]) -> None:
    """Sets limits and labels of the axes. The lower limit is below 0, so that straight arms are visible.
    name: parameter on the horizontal axis."""
    for axes, label in zip(panels, labels, strict=True):
        if not np.isfinite(axes.dataLim.y1):
            axes.text(0.5, 0.5, "no cycle", color="0.5", ha="center", transform=axes.transAxes)
            axes.set_yticks([])
        height = axes.dataLim.y1 if np.isfinite(axes.dataLim.y1) and axes.dataLim.y1 > 0 else 1.0
        axes.set_ylim(-0.04 * height, 1.1 * height)
        axes.axhline(0, color="0.8", lw=0.6, zorder=0)
        axes.set_ylabel(label)
        grid_cell = axes.get_subplotspec()
        if grid_cell is not None and grid_cell.is_last_row():
            axes.set_xlabel(style.AXIS_LABELS[name])
