"""Work-precision figure: error of numerical methods against computing time, as measured by the benchmarks."""

from math import ceil, sqrt
from pathlib import Path
from textwrap import fill

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from ..results.file.benchmark_file import Table
from .figures.style import BLUE, FIGURE_STYLE, GREEN, VERMILION
from .output_files import save_figure

GROUP_COLOURS = (BLUE, VERMILION, GREEN, "black", "0.55")
"""Colours of the groups of methods, in order of appearance."""
METHOD_MARKERS = ("o", "s", "^", "D", "v", "P", "X")
"""Markers that distinguish the methods within one group."""
MIN_TIME_RATIO_FOR_DECADE_LABELS = 1e3
"""If the longest time exceeds this multiple of the shortest time, only powers of ten have tick labels."""
MIN_DRAWN_ERROR = 1e-17
"""Smaller relative errors are drawn at this value, because zero has no logarithm."""
PANEL_SIZE = 3.6
"""Width and height of a panel, in inches."""
PANEL_TITLE_WIDTH = 36
"""Largest length of a line in the title of a panel, in characters."""


def draw_work_precision(measurements: Table, xlabel: str, target: float | None, output: Path) -> None:
    """Writes a figure with a panel for each case, a curve for each method, and a horizontal line at the error
    `target` to the file `output`.

    measurements: table with columns case, method, group, seconds and error. Rows without a finite error are
    left out. Raises EnvironmentIncomplete if the file cannot be written.
    """
    columns = {name: np.array(measurements[name]) for name in ("case", "method", "group", "seconds", "error")}
    has_error = np.isfinite(columns["error"])
    cases, methods, groups, seconds, errors = (values[has_error] for values in columns.values())
    curve_looks = _plot_keywords_by_method(dict(zip(methods.tolist(), groups.tolist(), strict=True)))
    titles = list(dict.fromkeys(cases.tolist()))
    is_wide = np.nanmax(seconds) > MIN_TIME_RATIO_FOR_DECADE_LABELS * np.nanmin(seconds)
    column_count = ceil(sqrt(len(titles)))
    row_count = ceil(len(titles) / column_count)
    with matplotlib.rc_context(FIGURE_STYLE):
        figure_size = PANEL_SIZE * column_count + 3.0, PANEL_SIZE * row_count + 0.5
        figure = Figure(figsize=figure_size, layout="constrained")
        grid = figure.subplots(row_count, column_count, sharex=True, sharey=True, squeeze=False)
        for axes, title in zip(grid.flat, titles, strict=False):
            axes.set(xscale="log", yscale="log")
            axes.set_title(fill(title, PANEL_TITLE_WIDTH), fontsize=10)
            if target is not None:
                axes.axhline(target, color="0.75", lw=0.8, zorder=0)
            for method, curve_look in curve_looks.items():
                is_of_method = (cases == title) & (methods == method)
                axes.plot(
                    1e3 * seconds[is_of_method],
                    np.maximum(errors[is_of_method], MIN_DRAWN_ERROR),
                    **curve_look,
                )
            axes.xaxis.set_major_locator(LogLocator(subs=(1,) if is_wide else (1, 2, 5)))
            axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axes.xaxis.set_minor_formatter(NullFormatter())
        for axes in grid.flat[len(titles) :]:
            axes.set_axis_off()
        figure.supxlabel(xlabel)
        figure.supylabel("relative error")
        handles = [Line2D([], [], label=method, **curve_look) for method, curve_look in curve_looks.items()]
        figure.legend(handles=handles, loc="outside right center", frameon=False, fontsize=9)
        save_figure(figure, output)


def _plot_keywords_by_method(groups: dict[str, str]) -> dict[str, dict]:
    """Keywords of matplotlib for the curve of each method: a colour for each group, a marker for each method
    of a group."""
    order = list(dict.fromkeys(groups.values()))
    curve_looks = {}
    for method, group in groups.items():
        index = [method_ for method_, group_ in groups.items() if group_ == group].index(method)
        is_first_group = group == order[0]
        colour = GROUP_COLOURS[order.index(group) % len(GROUP_COLOURS)]
        curve_looks[method] = {
            "color": colour,
            "marker": METHOD_MARKERS[index % len(METHOD_MARKERS)],
            "ms": 5,
            "lw": 2.2 if is_first_group else 1.1,
            "mfc": colour if is_first_group else "white",
            "zorder": 3 if is_first_group else 2,
        }
    return curve_looks
