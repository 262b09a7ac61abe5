"""Maps over two parameters: the cycle's period, the tip's largest y, what else became of the rod, and F**.

The points of the file are the centres of the cells; nothing is interpolated but the line of Hopf points.
"""

from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from ....arrays import Array
from ....config.arm.axes import MOVES
from ....results.file.view import View
from ..style import (
    LABELS,
    colour_cells,
    heading,
    legend_below,
    need,
    parameter_text,
    scale,
)
from .amplitudes.hopf_lines import hopf_lines
from .amplitudes.hopf_marks import HOPF_SYMBOL
from .point_map import PointMap, cell_edges, point_map
from .selection import CYCLE_WORDS, arms_told_apart, outcomes
from .units import units_over

STATUS_LOOKS = {
    "straight": ("#E8EDF2", ""),
    "missing": ("white", "...."),
    "not_settled": ("#C4C4C4", "////"),
    "left_the_model": ("#9A9A9A", "\\\\\\\\"),
    "failed": ("#6E6E6E", "xxxx"),
    "torus": ("#D9CBBF", "++++"),
}
"""Colour and hatching of cells without a cycle: greys, which the maps of colours do not have."""
FURTHER_LOOKS = (("#BFA893", "----"), ("#8F7A68", "oooo"))
"""Of statuses beyond these, in the order in which they are met."""
PANEL = 250
"""Points of print across a panel."""
MARKER = 1.0, 4.0
"""Least and largest size in points of the open marker of an unstable cycle; between them, half a cell."""
HATCHING = "0.25"
ONE_ROW = 6
"""Entries of a legend that one row can hold."""
QUANTITIES = (
    ("period", "viridis", True),
    ("tip_y_max", "plasma", False),
)
"""Variable and colours of each panel, and whether those are logarithmic over more than a decade."""


def draw_maps(view: View, narrow: bool = False) -> tuple[Figure, str]:
    """Period and largest y of the tip, with the line of Hopf points over both.

    narrow: whether the panels have no room beside each other.
    """
    points = point_map(view)
    words = outcomes(view)[points.at]
    cycles = np.isin(words, CYCLE_WORDS)
    need(view, cycles.any(), "cycle")
    figure, panels = map_panels(2, narrow)
    lines = hopf_lines(points, view)
    (units,) = units_over([view], [points.at.ravel()])
    _, largest_y, period, _ = units.labels_over
    for axes, label, (name, colours, ratios) in zip(panels, (period, largest_y), QUANTITIES, strict=True):
        drawn = units.drawn({name: view.variables[name].ravel()[points.at.ravel()]})[name]
        values = np.where(cycles, drawn.reshape(points.at.shape), np.nan)
        edges = cell_edges(points.x), cell_edges(points.y)
        colour_cells(axes, edges, values, label, colours, ratios)
        handles = _draw_hopf_lines(axes, points, lines)
        handles += _draw_statuses(axes, points, words)
        handles += _mark_unstable(axes, points, words == "unstable")
    label_maps(panels, points)
    if handles:
        rows = -(-len(handles) // ONE_ROW)
        legend_below(figure, handles, columns=-(-len(handles) // rows))
    figure.suptitle(heading(view, _shared(view, points, units.in_si)))
    return figure, f"period and amplitude over {' and '.join(points.names)}{points.left_out}"


def _shared(view: View, points: PointMap, in_si: bool) -> str:
    """What all points share: the parameters, or an arm's quantities; in_si: whether there is an arm."""
    if not in_si:
        return parameter_text(points.shared)
    along = {quantity for quantity, moved in MOVES.items() if moved in points.names}
    numbers = [int(points.at[0, 0]) + 1, int(points.at[-1, -1]) + 1]
    return arms_told_apart(view, numbers, {*points.names, *along})[0]


def map_panels(count: int, narrow: bool) -> tuple[Figure, list[Axes]]:
    """A figure with panels that share their axes: side by side, or if narrow one above the other."""
    apart = ConstrainedLayoutEngine(wspace=0.0 if narrow else 0.06)  # the first bar's label is its own
    figure = Figure(figsize=(4.2, 3.2 * count) if narrow else (4.8 * count, 4.5), layout=apart)
    shape = (count, 1) if narrow else (1, count)
    return figure, list(figure.subplots(*shape, sharex=True, sharey=True, squeeze=False).ravel())


def label_maps(panels: Sequence[Axes], points: PointMap) -> None:
    """Scales and labels of panels that share their axes: each once where they are in a row or a column."""
    for axes in panels:
        scale(axes, "x", points.x)
        scale(axes, "y", points.y)
        place = axes.get_subplotspec()
        if place is None or place.is_last_row():
            axes.set_xlabel(LABELS[points.names[0]])
        if place is None or place.is_first_col():
            axes.set_ylabel(LABELS[points.names[1]])


def _draw_statuses(axes: Axes, points: PointMap, words: NDArray[np.str_]) -> list[Artist]:
    """Fills the cells that have no cycle, each status in its own way; returns what the legend says."""
    further = cycle(FURTHER_LOOKS)
    handles: list[Artist] = []
    for word in dict.fromkeys([*STATUS_LOOKS, *np.unique(words).tolist()]):
        there = words == word
        if word in CYCLE_WORDS or not there.any():
            continue
        colour, hatch = STATUS_LOOKS.get(word) or next(further)
        look: dict[str, Any] = {"facecolor": colour, "hatch": hatch, "edgecolor": HATCHING}
        for row, (bottom, top) in zip(there, _pairs(cell_edges(points.y)), strict=True):
            axes.broken_barh(_runs(row, cell_edges(points.x)), (bottom, top - bottom), lw=0, **look)
        handles.append(Patch(label=word.replace("_", " "), lw=0.5, **look))
    return handles


def _mark_unstable(axes: Axes, points: PointMap, there: NDArray[np.bool_]) -> list[Artist]:
    """An open marker in the cells of unstable cycles, as for amplitudes; returns what the legend says."""
    if not there.any():
        return []
    look: dict[str, Any] = {"marker": "o", "mfc": "white", "mec": HATCHING, "ls": "", "mew": 0.6}
    row, column = np.nonzero(there)
    size = float(np.clip(PANEL / max(there.shape) / 2, *MARKER))
    axes.plot(points.x[column], points.y[row], ms=size, **look)
    return [Line2D([], [], label="unstable cycle", ms=MARKER[1], **look)]


def _pairs(values: Array) -> list[tuple[float, float]]:
    """Each of the values, shape (n,), with the next."""
    return list(zip(values[:-1].tolist(), values[1:].tolist(), strict=True))


def _runs(there: NDArray[np.bool_], edges: Array) -> list[tuple[float, float]]:
    """(left, width) of each run of neighbouring cells of a row."""
    steps = np.diff(np.concatenate(([0], there.astype(int), [0])))
    starts, ends = edges[np.flatnonzero(steps > 0)], edges[np.flatnonzero(steps < 0)]
    return list(zip(starts.tolist(), (ends - starts).tolist(), strict=True))


def _draw_hopf_lines(axes: Axes, points: PointMap, lines: Sequence[Array]) -> list[Artist]:
    """Where the leading growth rate is 0, lines of shape (2, n): x, y; returns what the legend says.

    That is where the rod starts to beat, or stops: no eigenvalue passes through 0, for D(0) = 1.
    """
    look: dict[str, Any] = {"color": "k", "lw": 1.4}
    halo = [withStroke(linewidth=3.0, foreground="white")]
    for line in lines:
        axes.plot(*line, path_effects=halo, **look)
    symbol = f" ${HOPF_SYMBOL}$" if "F" in points.names else ""
    return [Line2D([], [], label=f"Hopf points{symbol}", **look)] if lines else []
