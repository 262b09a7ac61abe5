"""Phase diagrams, as the paper's Fig. 4: what the rod does over two parameters, with the boundaries."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...errors import InputError
from ...model.parameters import CRUSHING, LINEAR_PARAMETERS
from ...results.file.view import View
from ...results.layouts.phase_diagram import CLASSES
from .request import FigureRequest
from .style import LABELS, SYMBOLS, fixed_text, heading, legend_below, need, scale

CLASS_COLOURS = {
    "missing": "white",
    "monotone": "#DCE9F5",
    "oscillatory": "#9CC3E4",
    "flutter": "#F2B28A",
    "undecided": "#666666",
    "crushed": "#BBBBBB",
}
"""Light to dark blue for stable rods and orange for unstable ones: told apart by all, and in grey."""

CURVE_LOOKS = {1: ("Hopf points", 1.4, "-"), 0: ("double eigenvalue", 1.0, "--")}
"""Legend, width and style of a curve, by its kind in the file."""


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
    axes.pcolormesh(x, y, table, cmap=colours, norm=norm, shading="nearest", rasterized=True)
    scale(axes, "x", x)
    scale(axes, "y", y)
    if (line, row) == CRUSHING:  # the map's points leave a staircase
        crushed = np.linspace(y[0], y[-1], 1000)
        axes.fill_between(crushed, crushed, y[0], color=CLASS_COLOURS["crushed"], lw=0)
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]), xlabel=LABELS[line], ylabel=LABELS[row])
    handles: list = [
        Patch(facecolor=CLASS_COLOURS[word], edgecolor="0.5", lw=0.5, label=word)
        for number, word in CLASSES
        if (table == number).any()
    ]
    if "curve_number" in view.variables:
        handles += _curves(axes, view, line, row)
    legend_below(figure, handles, columns=3)
    axes.set_title(heading(view, fixed_text(view, line, row)), fontsize=9)
    return request.write(figure, f"what the rod does over {line} and {row}")


def _curves(axes: Axes, view: View, line: str, row: str) -> list[Line2D]:
    """Draws the boundaries and folds; returns what the legend says of them."""
    v = view.variables
    handles = []
    for number, (word, width, style) in CURVE_LOOKS.items():
        there = v["curve_kind"] == number
        for curve in np.unique(v["curve_number"][there]):
            one = v["curve_number"] == curve
            axes.plot(v[f"curve_{line}"][one], v[f"curve_{row}"][one], style, color="k", lw=width)
        if there.any():
            handles.append(Line2D([], [], color="k", lw=width, ls=style, label=word))
    for i in range(len(v["fold"])):
        if v["fold_kind"][i] == 1 and v["fold_of"][i] == 1:  # where a window of flutter closes
            F, k = v[f"fold_{line}"][i], v[f"fold_{row}"][i]
            axes.plot(F, k, "ko", ms=4)
            label = rf"fold ${SYMBOLS[line]}$ = {F:.6g}, ${SYMBOLS[row]}$ = {k:.6g}"
            handles.append(Line2D([], [], color="k", marker="o", ls="", ms=4, label=label))
    if "partial_beam_k1" in v:
        F, k = float(v["partial_beam_F"]), float(v["partial_beam_k1"])
        x, y = (F, k) if line == "F" else (k, F)
        label = rf"partial beam: $2F_c$ = {F:.6g}, $4F_c$ = {k:.6g}"
        (ring,) = axes.plot(x, y, "ko", mfc="none", ls="", ms=7, label=label)
        handles.append(ring)
    return handles
