"""Phase diagrams, as the paper's Fig. 4: what the rod does over two parameters, with the boundaries."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...arrays import Array
from ...model.parameters import CRUSHING, LINEAR_PARAMETERS
from ...results.file.view import View
from ...results.layouts import lacks_curves
from ...results.layouts.branch import SPECIAL_KINDS
from ...results.layouts.phase_diagram import CLASSES, STABLE_STATES
from .class_bars import CLASS_COLOURS
from .request import FigureRequest
from .style import LABELS, SYMBOLS, THIRD, fixed_text, heading, legend_below, need, scale
from .style import number as number_text

STATE_COLOURS = {
    "missing": "white",
    "neither_known": "#F6E3A1",
    "straight": CLASS_COLOURS["oscillatory"],
    "cycle": CLASS_COLOURS["flutter"],
    "both": "#8E6BB0",
    "undecided": CLASS_COLOURS["undecided"],
    "crushed": CLASS_COLOURS["crushed"],
}
"""Of the stable states: where both are, the colour lies between those of the two."""


@dataclass(frozen=True, slots=True)
class Palette:
    """What a map shows: a variable of words, its words with their numbers, and their colours."""

    variable: str
    words: tuple[tuple[int, str], ...]
    colours: dict[str, str]

    @property
    def looks(self) -> dict[str, Any]:
        """How it is drawn."""
        numbers = [number for number, _ in self.words]
        return {
            "cmap": ListedColormap([self.colours[word] for _, word in self.words]),
            "norm": BoundaryNorm([*(n - 0.5 for n in numbers), numbers[-1] + 0.5], len(numbers)),
            "shading": "nearest",
            "rasterized": True,
        }

    @property
    def crushed(self) -> int:
        return next(number for number, word in self.words if word == "crushed")

    def patches(self, table: Array) -> list[Patch]:
        """What the legend says of the words that are in a table, (rows, columns)."""
        there = (word for number, word in self.words if (table == number).any())
        return [
            Patch(facecolor=self.colours[word], edgecolor="0.5", lw=0.5, label=LEGEND.get(word, word))
            for word in there
        ]


LEGEND = {
    "straight": "straight rod stable",
    "cycle": "cycle stable",
    "both": "both stable",
    "neither_known": "no stable state known",
}
"""Words of the stable states; the others speak for themselves."""
MOTIONS = Palette("class", CLASSES, CLASS_COLOURS)
STATES = Palette("stable_states", STABLE_STATES, STATE_COLOURS)
CURVE_LOOKS = {1: ("Hopf points", 1.4, "-"), 0: ("double eigenvalue", 1.0, "--")}
"""Legend, width and style of a curve, by its kind in the file."""
CURVE_NAMES = {1: (r"$\tilde F_{**}$", 0.85), 0: (r"$\tilde F_*$", 0.12)}
"""What stands beside the longest curve of a kind, and where on the part of it that is in sight."""
SIDE_LOOKS = {
    -1: ("supercritical Hopf points", 1.4, "-"),
    1: ("subcritical Hopf points", 1.4, "--"),
    0: ("Hopf points, side undecided", 0.6, "-"),
}
"""Of the parts of Hopf curves, where the file tells on which side cycles are born; by Re c's sign."""
CYCLE_CURVES = {"fold": ("folds of cycles", "#9B1B30"), "torus": ("torus points of cycles", THIRD)}
"""Legend and colour of the curves of special points of cycles, by kind."""
BESIDE_SIDES = "double eigenvalue", 1.0, ":"
"""Of double eigenvalues beside them, because dashed then means subcritical."""


def draw_phase_diagram(request: FigureRequest) -> str:
    """The class of every point, the boundaries where they were traced, and their folds."""
    view = request.only_view()
    line = next(name for name in LINEAR_PARAMETERS if name not in view.parameters)
    row = next(name for name in view.parameters if len(view.axes[name]) > 1)
    palette = STATES if STATES.variable in view.variables else MOTIONS
    values = view.variables[palette.variable]
    need(view, (values >= 0).any(), "computed row")
    x, y = view.variables[line], view.axes[row]
    keep = np.isfinite(y)
    if keep.sum() < 2:
        return request.write(
            _draw_rows(view, palette, line, row), f"what the rod does over {line}, for each {row}"
        )
    table = values.reshape(len(y), len(x))[keep]
    y = y[keep]
    figure = Figure(figsize=(5.8, 4.6), layout="constrained")
    axes = figure.subplots()
    crushing = (line, row) == CRUSHING
    drawn = _without_stairs(table, palette.crushed) if crushing else table
    axes.pcolormesh(x, y, drawn, **palette.looks)
    scale(axes, "x", x)
    scale(axes, "y", y)
    edge: list[Line2D] = []
    if crushing:
        ends = np.linspace(y[0], y[-1], 1000)
        axes.fill_between(ends, ends, y[0], color=CLASS_COLOURS["crushed"], lw=0)
        word = f"${SYMBOLS[row]} = {SYMBOLS[line]}$"
        edge = axes.plot(ends, ends, color="0.4", lw=1.2, label=word)
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]), xlabel=LABELS[line], ylabel=LABELS[row])
    handles: list = palette.patches(table)
    if "curve_number" in view.variables:
        handles += _curves(axes, view, line, row)
    if "cycle_curve_number" in view.variables:
        handles += _cycle_curves(axes, view, line, row)
    handles += edge if (table == palette.crushed).any() else []
    legend_below(figure, handles, columns=2 if "bautin_curve" in view.variables else 3)
    axes.set_title(heading(view, fixed_text(view, line, row)), fontsize=9)
    missing = "; curves are missing, the file is not finished" if lacks_curves(view.attributes) else ""
    return request.write(figure, f"what the rod does over {line} and {row}{missing}")


def _draw_rows(view: View, palette: Palette, line: str, row: str) -> Figure:
    """A bar for each row, where they are too few, or at infinity, to make a plane."""
    x, y = view.variables[line], view.axes[row]
    table = view.variables[palette.variable].reshape(len(y), len(x))
    figure = Figure(figsize=(5.8, 1.6 + 0.5 * len(y)), layout="constrained")
    axes = figure.subplots()
    axes.pcolormesh(x, np.arange(len(y)), table, **palette.looks)
    for between in np.arange(len(y) - 1) + 0.5:
        axes.axhline(between, color="white", lw=4)
    scale(axes, "x", x)
    axes.set_yticks(np.arange(len(y)), [f"${SYMBOLS[row]} = {number_text(value)}$" for value in y])
    axes.tick_params("y", length=0)
    axes.set(xlim=(x[0], x[-1]), xlabel=LABELS[line])
    legend_below(figure, palette.patches(table), columns=3)
    axes.set_title(heading(view, fixed_text(view, line, row)), fontsize=9)
    return figure


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


def _without_stairs(table: Array, crushed_rod: int) -> Array:
    """Classes, (rows, columns), with those of crushed rods replaced by the next above: the edge is drawn."""
    filled = table.copy()
    for row in range(len(table) - 2, -1, -1):
        crushed = filled[row] == crushed_rod
        filled[row, crushed] = filled[row + 1, crushed]
    return filled


def _curves(axes: Axes, view: View, line: str, row: str) -> list[Line2D]:
    """Draws the boundaries and folds; returns what the legend says of them.

    Where the file tells stable states only Hopf points bound them.
    """
    v = view.variables
    sides, states = "curve_criticality" in v, STATES.variable in v
    handles = _sides(axes, view, line, row) if sides else []
    looks = {0: BESIDE_SIDES} if sides else CURVE_LOOKS
    for number, (word, width, style) in looks.items():
        there = v["curve_kind"] == number
        if states and number == 0:
            continue
        curves = [v["curve_number"] == curve for curve in np.unique(v["curve_number"][there])]
        for one in curves:
            axes.plot(v[f"curve_{line}"][one], v[f"curve_{row}"][one], style, color="k", lw=width)
        if there.any():
            handles.append(Line2D([], [], color="k", lw=width, ls=style, label=word))
        if there.any() and not sides:
            paths = [np.column_stack([v[f"curve_{line}"][one], v[f"curve_{row}"][one]]) for one in curves]
            _name_longest(axes, paths, *CURVE_NAMES[number])
    return handles if states else handles + _points(axes, view, line, row)


def _points(axes: Axes, view: View, line: str, row: str) -> list[Line2D]:
    """Marks the folds of Hopf curves and the partial beam's; returns what the legend says of them."""
    v = view.variables
    handles = []
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


def _cycle_curves(axes: Axes, view: View, line: str, row: str) -> list[Line2D]:
    """Draws the curves of folds and torus points of cycles; returns what the legend says of them."""
    v, handles = view.variables, []
    for kind, (word, colour) in CYCLE_CURVES.items():
        there = v["cycle_curve_kind"] == SPECIAL_KINDS.index(kind)
        for curve in np.unique(v["cycle_curve_number"][there]):
            one = v["cycle_curve_number"] == curve
            points = v[f"cycle_curve_{line}"][one], v[f"cycle_curve_{row}"][one]
            axes.plot(*points, color=colour, lw=1.8, zorder=1.9)  # below marks and Hopf curves
        if there.any():
            handles.append(Line2D([], [], color=colour, lw=1.8, label=word))
    return handles


def _sides(axes: Axes, view: View, line: str, row: str) -> list[Line2D]:
    """Draws Hopf curves by the side on which cycles are born, and where it changes; returns the legend."""
    v = view.variables
    used = set()
    for curve in np.unique(v["curve_number"][v["curve_kind"] == 1]):
        for side, points in parts_of_one_side(view, int(curve), line, row):
            _, width, style = SIDE_LOOKS[side]
            axes.plot(*points.T, style, color="k", lw=width)
            used.add(side)
    handles = [
        Line2D([], [], color="k", lw=width, ls=style, label=word)
        for side, (word, width, style) in SIDE_LOOKS.items()
        if side in used
    ]
    for i in range(len(v["bautin_curve"])):
        x, y = v[f"bautin_{line}"][i], v[f"bautin_{row}"][i]
        label = rf"Re $c$ = 0: ${SYMBOLS[line]}$ = {x:.6g}, ${SYMBOLS[row]}$ = {y:.6g}"
        handles += axes.plot(x, y, "kD", mfc="white", ls="", ms=5, label=label)
    return handles + (_bautin_curves(axes, view, line, row) if "bautin_along_curve" in v else [])


def _bautin_curves(axes: Axes, view: View, line: str, row: str) -> list[Line2D]:
    """Draws the ways of the generalised Hopf points over a third parameter; returns the legend."""
    v, drawn = view.variables, []
    third = next(n for n in LINEAR_PARAMETERS if f"bautin_along_{n}" in v and n not in (line, row))
    for number in np.unique(v["bautin_along_curve"]):
        on = v["bautin_along_curve"] == number
        reach = v[f"bautin_along_{third}"][on]
        low, high = (number_text(float(end), 3) for end in (reach.min(), reach.max()))
        label = rf"Re $c$ = 0, ${SYMBOLS[third]}$ = ${low}$ to ${high}$"
        x, y = (v[f"bautin_along_{name}"][on] for name in (line, row))
        drawn += axes.plot(x, y, "-.", color="tab:red", lw=1.2, label=label)
    return drawn


def parts_of_one_side(view: View, curve: int, line: str, row: str) -> list[tuple[int, np.ndarray]]:
    """The parts of a Hopf curve between generalised Hopf points: (-1, 1 or 0 undecided, points (n, 2))."""
    v = view.variables
    rows = np.flatnonzero(v["curve_number"] == curve)
    on = np.flatnonzero(v["bautin_curve"] == curve)
    places = np.searchsorted(rows, v["bautin_curve_point"][on] - 1, side="right")
    columns = [np.insert(v[f"curve_{name}"][rows], places, v[f"bautin_{name}"][on]) for name in (line, row)]
    points = np.column_stack(columns)
    side = np.insert(np.nan_to_num(v["curve_criticality"][rows]), places, 0)
    # The sides of a piece are those of its ends; a point within the error of a change takes its neighbour's.
    ends = side[:-1], side[1:]
    pieces = np.where(ends[0] * ends[1] < 0, 0, np.sign(ends[0] + ends[1])).astype(int)
    cuts = [0, *(np.flatnonzero(np.diff(pieces)) + 1), len(pieces)]
    return [(int(pieces[a]), points[a : b + 1]) for a, b in zip(cuts[:-1], cuts[1:], strict=True) if b > a]
