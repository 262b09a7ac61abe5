"""Phase diagrams, as the paper's Fig. 4: what the rod does over two parameters, with the boundaries."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...arrays import Array
from ...errors import InputError
from ...model.parameters import CRUSHING, LINEAR_PARAMETERS
from ...results.file.view import View
from ...results.layouts.phase_diagram import CLASSES
from .class_bars import CLASS_COLOURS
from .request import FigureRequest
from .style import LABELS, SYMBOLS, fixed_text, heading, legend_below, need, scale

CRUSHED = next(number for number, word in CLASSES if word == "crushed")
CURVE_LOOKS = {1: ("Hopf points", 1.4, "-"), 0: ("double eigenvalue", 1.0, "--")}
"""Legend, width and style of a curve, by its kind in the file."""
CURVE_NAMES = {1: (r"$\tilde F_{**}$", 0.85), 0: (r"$\tilde F_*$", 0.12)}
"""What stands beside the longest curve of a kind, and where on the part of it that is in sight."""


def draw_phase_diagram(request: FigureRequest) -> str:
    """The class of every point, the boundaries where they were traced, and their folds."""
    view = request.only_view()
    line = next(name for name in LINEAR_PARAMETERS if name not in view.parameters)
    row = next(name for name in view.parameters if len(view.axes[name]) > 1)
    values = view.variables["class"]
    need(view, (values >= 0).any(), "computed row")
    x, y = view.variables[line], view.axes[row]
    keep = np.isfinite(y)
    table = values.reshape(len(y), len(x))[keep]
    y = y[keep]
    if len(y) < 2:
        raise InputError(f"{view.path} has fewer than two rows with a finite {row}, which make no diagram")
    figure = Figure(figsize=(5.8, 4.6), layout="constrained")
    axes = figure.subplots()
    numbers = [number for number, _ in CLASSES]
    colours = ListedColormap([CLASS_COLOURS[word] for _, word in CLASSES])
    norm = BoundaryNorm([*(n - 0.5 for n in numbers), numbers[-1] + 0.5], len(numbers))
    crushing = (line, row) == CRUSHING
    drawn = _without_stairs(table) if crushing else table
    axes.pcolormesh(x, y, drawn, cmap=colours, norm=norm, shading="nearest", rasterized=True)
    scale(axes, "x", x)
    scale(axes, "y", y)
    edge: list[Line2D] = []
    if crushing:
        ends = np.linspace(y[0], y[-1], 1000)
        axes.fill_between(ends, ends, y[0], color=CLASS_COLOURS["crushed"], lw=0)
        word = f"${SYMBOLS[row]} = {SYMBOLS[line]}$"
        edge = axes.plot(ends, ends, color="0.4", lw=1.2, label=word)
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]), xlabel=LABELS[line], ylabel=LABELS[row])
    handles: list = [
        Patch(facecolor=CLASS_COLOURS[word], edgecolor="0.5", lw=0.5, label=word)
        for number, word in CLASSES
        if (table == number).any()
    ]
    if "curve_number" in view.variables:
        handles += _curves(axes, view, line, row)
    handles += edge if (table == CRUSHED).any() else []
    legend_below(figure, handles, columns=3)
    axes.set_title(heading(view, fixed_text(view, line, row)), fontsize=9)
    return request.write(figure, f"what the rod does over {line} and {row}")


def _name_longest(axes: Axes, paths: list[Array], name: str, share: float) -> None:
    """Writes a name beside the curve, (points, 2), that is longest in sight, at a share of its length."""
    lengths, seen = [], []
    for path in paths:
        places = axes.transAxes.inverted().transform(axes.transData.transform(path))
        inside = ((places >= 0) & (places <= 1)).all(axis=1)
        steps = np.linalg.norm(np.diff(places[inside], axis=0), axis=1)
        seen.append(path[inside])
        lengths.append(np.append(0.0, np.cumsum(steps)) if inside.any() else np.zeros(1))
    longest = max(range(len(paths)), key=lambda i: lengths[i][-1])
    if lengths[longest][-1] > 0:
        at = int(np.searchsorted(lengths[longest], share * lengths[longest][-1]))
        axes.annotate(
            name, seen[longest][at], xytext=(4, -2), textcoords="offset points", fontsize=8, va="top"
        )


def _without_stairs(table: Array) -> Array:
    """Classes, (rows, columns), with those of crushed rods replaced by the next above: the edge is drawn."""
    filled = table.copy()
    for row in range(len(table) - 2, -1, -1):
        crushed = filled[row] == CRUSHED
        filled[row, crushed] = filled[row + 1, crushed]
    return filled


def _curves(axes: Axes, view: View, line: str, row: str) -> list[Line2D]:
    """Draws the boundaries and folds; returns what the legend says of them."""
    v = view.variables
    handles = []
    for number, (word, width, style) in CURVE_LOOKS.items():
        there = v["curve_kind"] == number
        curves = [v["curve_number"] == curve for curve in np.unique(v["curve_number"][there])]
        for one in curves:
            axes.plot(v[f"curve_{line}"][one], v[f"curve_{row}"][one], style, color="k", lw=width)
        if there.any():
            handles.append(Line2D([], [], color="k", lw=width, ls=style, label=word))
            paths = [np.column_stack([v[f"curve_{line}"][one], v[f"curve_{row}"][one]]) for one in curves]
            _name_longest(axes, paths, *CURVE_NAMES[number])
    for i in range(len(v["fold"])):
        if v["fold_kind"][i] == 1 and v["fold_of"][i] == 1:  # where a window of flutter closes
            F, k = v[f"fold_{line}"][i], v[f"fold_{row}"][i]
            axes.plot(F, k, "ko", ms=4)
            label = rf"fold ${SYMBOLS[line]} = {F:.6g}$, ${SYMBOLS[row]} = {k:.6g}$"
            handles.append(Line2D([], [], color="k", marker="o", ls="", ms=4, label=label))
    if "partial_beam_k1" in v:
        F, k = float(v["partial_beam_F"]), float(v["partial_beam_k1"])
        x, y = (F, k) if line == "F" else (k, F)
        label = rf"partial beam $2F_c = {F:.6g}$, $4F_c = {k:.6g}$"
        (cross,) = axes.plot(x, y, "+", color="k", ls="", ms=10, mew=1.2, label=label)
        handles.append(cross)
    return handles
