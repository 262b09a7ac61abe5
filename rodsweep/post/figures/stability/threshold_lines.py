"""Figures of first thresholds of rods against a parameter, with curves for all or some values of a second
parameter."""

from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ....arrays import Array
from ....results.file.view import ResultView
from .. import style
from ..arm.quantities import set_heading

CRITICAL_FORCE_LOOKS = (
    ("F_onset", r"onset $\tilde F_*$", style.BLUE, "o", ":"),
    ("F_hopf", r"Hopf $\tilde F_{**}$", style.VERMILION, "s", "-"),
    ("F_restabilization", "restabilization", style.GREEN, "^", "--"),
)
"""(variable, legend entry, colour, marker, line style) of each kind of threshold. The colours are used if a
panel has no other colours for its lines."""
FILE_COLOURS = (*style.LINE_COLOURS[:5], "0.3")
"""Colours of the files in a figure of several files."""
THRESHOLD_LINE_LOOK: dict[str, Any] = {"ms": 3, "lw": 1.2}
"""Matplotlib style of all lines of thresholds."""
SECOND_PARAMETER_LINE_STYLES = ("-", "--", ":")
"""Line styles for the values of the second parameter in one panel."""
MAX_COLOURED_LINES = 6
"""Largest number of values of the second parameter that have distinguishable colours."""
DARKEST_SHADE = 0.0
"""Position in the colour map, from 0 to 1, of the first line's colour, the darkest."""
LIGHTEST_SHADE = 0.85
"""Position in the colour map, from 0 to 1, of the last line's colour; lighter colours are invisible on white
paper."""
MIN_RELATIVE_LINE_DISTANCE = 0.01
"""Two lines are drawn as one line if their distance, divided by the largest force, is below this number."""
FORCE_AXIS_MARGIN_FACTOR = 1.05
"""Upper limit of the axis of forces divided by the largest force; on a logarithmic axis also the smallest
force divided by the lower limit."""


def draw_lines_of_grid(view: ResultView, names: list[str], search: str) -> tuple[Figure, str]:
    """Returns (figure, description). The figure shows thresholds against the parameter with more values, with
    a line for each value of the other parameter. names: the one or two parameters with several
    values. search: clause on the searched range. Raises InputError if nothing can be drawn."""
    x_name = max(names, key=lambda name: np.count_nonzero(np.isfinite(view.parameter_values[name])))
    second_name = next((name for name in names if name != x_name), None)
    figure = Figure(figsize=(5.6, 4.2), layout="constrained")
    axes = figure.subplots()
    table = _first_force_table(view, x_name)
    x = _abscissa_values(view, x_name)
    style.require_content(view, np.isfinite(x).sum() > 1, f"two finite values of {x_name}")
    if second_name:
        shades = matplotlib.colormaps["viridis"](np.linspace(DARKEST_SHADE, LIGHTEST_SHADE, len(table)))
        _add_threshold_kind_entries(axes, np.concatenate(table, axis=1))
        for value, values, shade in zip(view.parameter_values[second_name], table, shades, strict=True):
            label = f"${style.TEX_SYMBOLS[second_name]} = {style.number_in_tex(float(value))}$"
            _draw_lines_in_one_colour(axes, x, values, shade, label)
    else:
        _draw_lines_by_kind(axes, x, table[0], ls="-")
    _label_axes(axes, view, x_name, table)
    axes.set_ylabel(style.CRITICAL_FORCE_LABEL)
    style.draw_shared_legend(figure, column_count=3)
    set_heading(figure, view, style.constant_parameters_text(view, *names), search)
    caption = f"critical forces against {x_name}" + (f" for every {second_name}" if second_name else "")
    return figure, caption + _infinite_values_clause(view, [x_name])


def draw_lines_of_files(views: Sequence[ResultView], x_name: str, search: str) -> tuple[Figure, str]:
    """Returns (figure, description). The figure shows thresholds against the parameter `x_name`, with a
    colour for each file. search: clause on the searched range."""
    figure = Figure(figsize=(5.6, 4.6), layout="constrained")
    axes = figure.subplots()
    tables = [_first_force_table(view, x_name)[0] for view in views]
    forces = np.concatenate(tables, axis=1)
    _add_threshold_kind_entries(axes, forces)
    for view, values, colour in zip(views, tables, FILE_COLOURS, strict=False):
        label = style.file_label(view, views)
        _draw_lines_in_one_colour(axes, _abscissa_values(view, x_name), values, colour, label)
    longest = max(views, key=lambda view: len(view.parameter_values[x_name]))
    _label_axes(axes, longest, x_name, forces)
    forces = np.sort(forces[np.isfinite(forces)])
    if style.is_logarithmic(forces):
        style.scale_axis(axes, "y", forces)
        axes.set_ylim(forces[0] / FORCE_AXIS_MARGIN_FACTOR, forces[-1] * FORCE_AXIS_MARGIN_FACTOR)
    axes.set_ylabel(style.CRITICAL_FORCE_LABEL)
    style.draw_shared_legend(figure, column_count=2)
    figure.suptitle("\n".join(filter(None, (style.constant_parameters_text(longest, x_name), search))))
    clause = _infinite_values_clause(longest, [x_name])
    return figure, f"critical forces against {x_name} of {len(views)} files{clause}"


def draw_lines_of_three_values(
    view: ResultView, names: list[str], is_narrow: bool, search: str
) -> tuple[Figure, str]:
    """Returns (figure, description). As in the paper's Fig. 3, the figure has a panel for each of the two
    parameters `names` as abscissa, with curves for some values of the second parameter. is_narrow: whether
    the panels are stacked. search: clause on the searched range."""
    row_count, column_count = (2, 1) if is_narrow else (1, 2)
    figure = Figure(figsize=(4.6 * column_count + 0.4, 4.0 * row_count), layout="constrained")
    panels = figure.subplots(row_count, column_count, sharey=True, squeeze=False).ravel()
    texts = []
    for panel, x_name, second_name in zip(panels, names, reversed(names), strict=True):
        line_count = _draw_lines_of_up_to_three_values(panel, view, x_name, second_name)
        texts.append(f"{line_count} of {len(view.parameter_values[second_name])} values of {second_name}")
        if is_narrow or panel is panels[0]:
            panel.set_ylabel(style.CRITICAL_FORCE_LABEL)
    style.draw_shared_legend(figure, column_count=3)
    set_heading(figure, view, style.constant_parameters_text(view, *names), search)
    lines = f"lines for {' and '.join(texts)} (--what map: all)"
    omissions_clause = _infinite_values_clause(view, names)
    return figure, f"critical forces against {' and '.join(names)}, {lines}{omissions_clause}"


def _draw_lines_of_up_to_three_values(panel: Axes, view: ResultView, x_name: str, second_name: str) -> int:
    """Draws thresholds against the parameter `x_name` for up to three different values of the parameter
    `second_name`, see `_first_middle_and_last_line`, with a legend of these values above the panel; returns
    the number of values."""
    table = _first_force_table(view, x_name)
    indices = _first_middle_and_last_line(table)
    groups = _groups_of_equal_lines({index: table[index] for index in indices})
    entries = []
    for line_style, group in zip(SECOND_PARAMETER_LINE_STYLES, groups, strict=False):
        _draw_lines_by_kind(panel, _abscissa_values(view, x_name), table[group[0]], ls=line_style, ms=2)
        values = view.parameter_values[second_name][group]
        text = f"${style.TEX_SYMBOLS[second_name]} = " + ", ".join(
            style.number_in_tex(float(value), 3) for value in values
        )
        label = f"{text}$ (one line)" if len(group) > 1 else f"{text}$"
        entries.append(Line2D([], [], ls=line_style, color="0.3", label=label))
    _label_axes(panel, view, x_name, table[indices])
    panel.legend(handles=entries, frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0))
    return len(indices)


def _first_force_table(view: ResultView, x_name: str) -> Array:
    """Smallest force of each kind of threshold (onset, Hopf, restabilization) on a grid in which at most one
    parameter varies beside `x_name`, (m, 3, n); NaN for a missing threshold. m, n: numbers of values of the
    other parameter and of `x_name`."""
    forces = np.stack([view.variables[variable] for variable, *_ in CRITICAL_FORCE_LOOKS])
    forces = np.moveaxis(forces, 1 + list(view.parameter_values).index(x_name), -1)
    return forces.reshape(len(forces), -1, forces.shape[-1]).swapaxes(0, 1)


def _abscissa_values(view: ResultView, x_name: str) -> Array:
    """Values on the horizontal axis, (n,): values of the parameter `x_name`, or 1/gamma3 instead of gamma3,
    as in the paper."""
    values = view.parameter_values[x_name]
    return 1 / values if x_name == "gamma3" else values


def _draw_lines_by_kind(axes: Axes, x: Array, values: Array, **look: Any) -> None:
    """Draws lines of the three kinds of thresholds, with legend entries of the kinds with a finite force. x:
    (n,); points at an infinite x are left out. values: first forces, (3, n), with NaN at gaps. look: keywords
    for matplotlib that replace the look in CRITICAL_FORCE_LOOKS."""
    is_finite = np.isfinite(x)
    for forces, (_, label, colour, marker, line_style) in zip(values, CRITICAL_FORCE_LOOKS, strict=True):
        if np.isfinite(forces).any():
            keywords = (
                THRESHOLD_LINE_LOOK
                | {"color": colour, "marker": marker, "ls": line_style, "label": label}
                | look
            )
            axes.plot(x[is_finite], forces[is_finite], **keywords)


def _draw_lines_in_one_colour(axes: Axes, x: Array, values: Array, colour: Any, label: str) -> None:
    """Draws lines of the three kinds of thresholds in one colour, with one legend entry. x, values: see
    `_draw_lines_by_kind`."""
    _draw_lines_by_kind(axes, x, values, color=colour, label=None)
    axes.plot([], [], color=colour, lw=2, label=label)


def _add_threshold_kind_entries(axes: Axes, values: Array) -> None:
    """Adds legend entries, in grey, of the kinds of thresholds with a finite force in `values`, (3, n)."""
    _draw_lines_by_kind(axes, np.full(values.shape[1], np.inf), values, color="0.3")


def _label_axes(axes: Axes, view: ResultView, x_name: str, table: Array) -> None:
    """Labels the horizontal axis, of the parameter `x_name`, and sets the scales. The axis of forces starts
    at 0. table: drawn forces, of any shape, NaN for a missing force."""
    x = _abscissa_values(view, x_name)
    style.scale_axis(axes, "x", np.sort(x[np.isfinite(x)]))
    axes.set_xlabel(style.INVERSE_DRAG_LABEL if x_name == "gamma3" else style.AXIS_LABELS[x_name])
    drawn_top = axes.get_ylim()[1] if axes.lines else 0.0
    axes.set_ylim(0, max(float(np.nanmax(table, initial=0.0)) * FORCE_AXIS_MARGIN_FACTOR, drawn_top) or 1.0)


def _infinite_values_clause(view: ResultView, names: list[str]) -> str:
    """Clause on infinite values of the parameters `names`, which an axis cannot show; empty if all values are
    finite."""
    omissions = []
    for name in names:
        is_left_out = ~np.isfinite(_abscissa_values(view, name))
        omissions += [f"{name} = {value:g}" for value in view.parameter_values[name][is_left_out]]
    return f"; {' and '.join(omissions)} has no place on an axis and is left out" if omissions else ""


def _first_middle_and_last_line(table: Array) -> list[int]:
    """Indices of three lines: the first, the last, and between them the line whose mean force is nearest to
    the average of the mean forces of these two; all lines if there are fewer than three. table: forces,
    (lines, 3, n), as from `_first_force_table`."""
    last = len(table) - 1
    if last < 2:
        return list(range(len(table)))
    heights = np.array([np.nanmean(values) if np.isfinite(values).any() else np.inf for values in table])
    distances = np.abs(heights - (heights[0] + heights[last]) / 2)
    middle = 1 + int(np.argmin(distances[1:last])) if np.isfinite(distances[1:last]).any() else last // 2
    return [0, middle, last]


def _groups_of_equal_lines(lines: dict[int, Array]) -> list[list[int]]:
    """Groups of lines that cannot be distinguished in the figure, as lists of keys. lines: forces, (3,
    points) each, by key."""
    size = max(float(np.nanmax(values, initial=0.0)) for values in lines.values())
    groups: list[list[int]] = []
    for number, values in lines.items():
        for group in groups:
            first = lines[group[0]]
            same_gaps = np.isnan(values) == np.isnan(first)
            if (
                same_gaps.all()
                and np.nanmax(np.abs(values - first), initial=0.0) < MIN_RELATIVE_LINE_DISTANCE * size
            ):
                group.append(number)
                break
        else:
            groups.append([number])
    return groups
