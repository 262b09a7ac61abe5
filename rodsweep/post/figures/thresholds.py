"""Critical forces against the parameters of the rod, as the paper's Fig. 3 draws them."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ...arrays import Array
from ...results.file.view import View
from . import style
from .class_bars import BAR_ASPECT, draw_class_bars
from .lists import as_grid
from .fitting import LEAST_ASPECT
from .request import FigureRequest

CRITICAL_FORCES = (
    ("F_onset", r"onset $\tilde F_*$", style.FIRST, "o"),
    ("F_hopf", r"Hopf $\tilde F_{**}$", style.SECOND, "s"),
    ("F_restabilization", "restabilization", style.THIRD, "^"),
)
LINE_STYLES = ("-", "--", ":")
"""For the values of the other parameter for which lines are drawn in one panel."""
UNSEEN = 0.01
"""Distance of two lines, in units of the largest force, below which one of them is drawn."""


def draw_thresholds(request: FigureRequest) -> str:
    """One panel for each long axis, the first thresholds along it; else a bar of classes for each rod."""
    view = as_grid(request.only_view())
    if not view.is_grid or view.variables["status"].size == 1:
        least_aspect = BAR_ASPECT if view.variables["status"].size == 1 else LEAST_ASPECT
        return request.write(draw_class_bars(view), "what each rod does over F", least_aspect)
    long = style.long_axes(view)
    style.need(
        view, any(np.isfinite(view.variables[name]).any() for name, *_ in CRITICAL_FORCES), "threshold"
    )
    rows, columns = (len(long), 1) if request.look.narrow else (1, len(long))
    figure = Figure(figsize=(4.6 * columns + 0.4, 4.0 * rows), layout="constrained")
    panels = figure.subplots(rows, columns, sharey=True, squeeze=False).ravel()
    for panel, name in zip(panels, long, strict=True):
        _panel(panel, view, name, [other for other in long if other != name])
        if columns == 1 or panel is panels[0]:
            panel.set_ylabel(style.CRITICAL_FORCE)
    there = [
        Line2D([], [], color=colour, marker=marker, ms=2.5, lw=1.2, label=word)
        for variable, word, colour, marker in CRITICAL_FORCES
        if np.isfinite(view.variables[variable]).any()
    ]
    style.legend_below(figure, there, columns=3)
    figure.suptitle(style.heading(view, style.fixed_text(view, *long), _searched(view)))
    left_out = [name for name in long if not np.isfinite(view.axes[name]).all()]
    without = f"; {' and '.join(left_out)} = inf has no place on an axis and is left out" if left_out else ""
    return request.write(figure, "critical forces against " + " and ".join(long) + without)


def _searched(view: View) -> str:
    """Up to which force thresholds were sought: a curve that is missing may lie beyond."""
    ends = view.variables["F_end"]
    low, high = (style.number(float(end(ends))) for end in (np.nanmin, np.nanmax))
    return rf"searched up to $\tilde F = {low}$" + (f" to ${high}$" if low != high else "")


def _panel(panel: Axes, view: View, name: str, others: list[str]) -> None:
    """The critical forces against one parameter, for some values of the other one."""
    axes = list(view.axes)
    x, label = view.axes[name], style.LABELS[name]
    if name == "gamma3":  # as the paper: against 1/gamma3
        x, label = 1 / x, style.INVERSE_DRAG
    place = others[0] if others else None
    every = {}
    for at in range(len(view.axes[place]) if place else 1):
        index = tuple(slice(None) if n == name else (at if n == place else 0) for n in axes)
        every[at] = np.array([view.variables[variable][index] for variable, *_ in CRITICAL_FORCES])
    lines = {at: every[at] for at in _far_apart(every)}
    for look, alike in zip(LINE_STYLES, _alike(lines), strict=False):
        for values, (_, _, colour, marker) in zip(lines[alike[0]], CRITICAL_FORCES, strict=True):
            keep = np.isfinite(x) & np.isfinite(values)
            panel.plot(x[keep], values[keep], look, color=colour, marker=marker, ms=2, lw=1.2)
        if place:
            said = ", ".join(style.number(float(view.axes[place][at]), 3) for at in alike)
            text = f"${style.SYMBOLS[place]} = {said}$" + (" (one line)" if len(alike) > 1 else "")
            panel.plot([], [], look, color="0.3", label=text)
    style.scale(panel, "x", np.sort(x[np.isfinite(x)]))
    panel.set_xlabel(label)
    panel.set_ylim(bottom=0)
    if place:
        panel.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0))


def _far_apart(lines: dict[int, Array]) -> list[int]:
    """Of the numbers of lines, (3, points) each, the first, the last, and the one that lies most between."""
    last = len(lines) - 1
    if last < 2:
        return sorted(lines)
    heights = np.array(
        [np.nanmean(values) if np.isfinite(values).any() else np.inf for values in lines.values()]
    )
    between = np.abs(heights - (heights[0] + heights[last]) / 2)
    middle = 1 + int(np.argmin(between[1:last])) if np.isfinite(between[1:last]).any() else last // 2
    return [0, middle, last]


def _alike(lines: dict[int, Array]) -> list[list[int]]:
    """The numbers of lines, (3, points) each, in groups of those that cannot be told apart."""
    size = max(float(np.nanmax(values, initial=0.0)) for values in lines.values())
    groups: list[list[int]] = []
    for number, values in lines.items():
        for group in groups:
            other = lines[group[0]]
            same = np.isnan(values) == np.isnan(other)
            if same.all() and np.nanmax(np.abs(values - other), initial=0.0) < UNSEEN * size:
                group.append(number)
                break
        else:
            groups.append([number])
    return groups
