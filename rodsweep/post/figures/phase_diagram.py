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
from ...config.axes import DEFAULTS
from ...model.parameters import CRUSHING, LINEAR_PARAMETERS
from ...results.file.view import View
from ...results.layouts import lacks_curves
from ...results.layouts.phase_diagram import CLASSES, STABLE_STATES
from .layout.fitting import MAP_ASPECT
from .request import FigureRequest
from .stability.class_bars import BAR_ASPECT, CLASS_COLOURS, classes_behind_crossings
from .stability.diagram_curves import draw_curves, draw_cycle_curves, mark_cycles_on_rows
from .stability.regions import PIXELS, ClassedPlaces, DrawnPlane, coloured
from .stability.row_classes import class_along_row
from .style import LABELS, SYMBOLS, heading, is_logarithmic, legend_below, need, parameter_text, scale
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
    def colours_of_numbers(self) -> dict[str, Any]:
        """How a table of numbers is coloured."""
        numbers = [number for number, _ in self.words]
        return {
            "cmap": ListedColormap([self.colours[word] for _, word in self.words]),
            "norm": BoundaryNorm([*(n - 0.5 for n in numbers), numbers[-1] + 0.5], len(numbers)),
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
BESIDE_CRUSHING = 1 - np.linspace(0, 3e-3, 7)
"""F/k1 that no colour passes: curves of cycles end where F is within 1e-3 of k1, and bound regions there."""


def draw_phase_diagram(request: FigureRequest) -> str:
    """The class of every point, the boundaries where they were traced, and their folds."""
    view = request.only_view()
    line = next(name for name in LINEAR_PARAMETERS if name not in view.parameters)
    row = next((name for name in view.parameters if len(view.axes[name]) > 1), view.parameters[0])
    palette = STATES if STATES.variable in view.variables else MOTIONS
    values = view.variables[palette.variable]
    need(view, (values >= 0).any(), "computed row")
    x, y = view.variables[line], view.axes[row]
    keep = np.isfinite(y)
    if keep.sum() < 2:
        rows = f", for each {row}" if len(y) > 1 else ""
        shown = f"what the rod does over {line}{rows}"
        return request.write(_draw_rows(view, palette, line, row), shown, BAR_ASPECT * len(y))
    table = values.reshape(len(y), len(x))[keep]
    y = y[keep]
    figure = Figure(figsize=(5.8, 4.6), layout="constrained")
    axes = figure.subplots()
    pixels = _class_of_pixels(view, palette, line, row, table)
    unit: dict[str, Any] = {"extent": (0, 1, 0, 1), "transform": axes.transAxes, "aspect": "auto"}
    axes.imshow(pixels, interpolation="nearest", origin="lower", **unit, **palette.colours_of_numbers)
    scale(axes, "x", x)
    scale(axes, "y", y)
    edge = _draw_crushing(axes, x, y) if (line, row) == CRUSHING else []
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]), xlabel=LABELS[line], ylabel=LABELS[row])
    handles: list = palette.patches(table)
    if "curve_number" in view.variables:
        handles += draw_curves(axes, view, line, row, palette is STATES)
    if "cycle_curve_number" in view.variables:
        handles += draw_cycle_curves(axes, view, line, row)
    if "cycle_special_kind" in view.variables:
        handles += mark_cycles_on_rows(axes, view, line, row)
    handles += edge if (table == palette.crushed).any() else []
    legend_below(figure, handles, columns=2 if "bautin_curve" in view.variables else 3)
    figure.suptitle(heading(view, _fixed(view, line, row)))
    missing = "; curves are missing, the file is not finished" if lacks_curves(view.attributes) else ""
    return request.write(figure, f"what the rod does over {line} and {row}{missing}", MAP_ASPECT)


def _fixed(view: View, line: str, row: str) -> str:
    """The parameters that are fixed, with their values; gamma1 where cycles are told of."""
    told = {name: values[0] for name, values in view.axes.items() if name not in (line, row)}
    if "curve_gamma1" in view.variables:
        told["gamma1"] = float(view.variables["curve_gamma1"])
    elif "gamma1" in view.attributes or ("stable_states" in view.variables and not view.quantities):
        told["gamma1"] = float(view.attributes.get("gamma1", DEFAULTS["gamma1"]))
    return parameter_text(told)


def _draw_crushing(axes: Axes, x: Array, y: Array) -> list[Line2D]:
    """Covers rods that the force x crushes, x > y, and draws the edge x = y; returns it for the legend."""
    if x[-1] <= y[0]:
        return []
    ends = np.linspace(max(x[0], y[0]), min(x[-1], y[-1]), 1000)
    below = np.append(ends, x[-1])
    axes.fill_between(below, np.minimum(below, y[-1]), y[0], color=CLASS_COLOURS["crushed"], lw=0)
    force, stiffness = (SYMBOLS[name] for name in CRUSHING)
    return axes.plot(ends, ends, color="0.4", lw=1.2, label=f"${stiffness} = {force}$")


def _draw_rows(view: View, palette: Palette, line: str, row: str) -> Figure:
    """A bar for each row, where they are too few, or at infinity, to make a plane."""
    x, y = view.variables[line], view.axes[row]
    figure = Figure(figsize=(5.8, 1.6 + 0.5 * len(y)), layout="constrained")
    axes = figure.subplots()
    share = np.linspace(0, 1, PIXELS + 1)
    edges = x[0] * (x[-1] / x[0]) ** share if is_logarithmic(x) else x[0] + (x[-1] - x[0]) * share
    table = np.array([class_along_row(view, palette.variable, line, row, n, edges) for n in range(len(y))])
    looks: dict[str, Any] = {"rasterized": True} | palette.colours_of_numbers
    axes.pcolormesh(edges, np.arange(len(y) + 1) - 0.5, table, **looks)
    for between in np.arange(len(y) - 1) + 0.5:
        axes.axhline(between, color="white", lw=4)
    scale(axes, "x", x)
    axes.set_yticks(np.arange(len(y)), [f"${SYMBOLS[row]} = {number_text(value)}$" for value in y])
    axes.tick_params("y", length=0)
    axes.set(xlim=(x[0], x[-1]), xlabel=LABELS[line])
    legend_below(figure, palette.patches(table), columns=3)
    figure.suptitle(heading(view, _fixed(view, line, row)))
    return figure


def _class_of_pixels(view: View, palette: Palette, line: str, row: str, table: Array) -> Array:
    """What the rod does at every pixel of the plane, bounded by the file's curves, as if none was crushed.

    table: the classes of the computed points, (rows with a finite value, columns).
    """
    y = view.axes[row]
    plane = DrawnPlane(view.variables[line], y[np.isfinite(y)])
    columns, rows = np.meshgrid(plane.x, plane.y)
    there = (table != palette.crushed) | ((line, row) != CRUSHING)
    computed = ClassedPlaces(plane.unit(columns[there], rows[there]), table[there])
    further = ClassedPlaces(np.zeros((0, 2)), np.zeros(0, int))
    if palette is MOTIONS:
        x, at, found = classes_behind_crossings(view, row)
        further = ClassedPlaces(plane.unit(x, at), found)
    curves = [
        plane.unit(view.variables[f"{kind}_{line}"][one], view.variables[f"{kind}_{row}"][one])
        for kind in ("curve", "cycle_curve")
        if f"{kind}_number" in view.variables
        for one in _each_curve(view, kind, double=palette is MOTIONS)
    ]
    if (line, row) == CRUSHING:
        edge = np.linspace(plane.y[0], plane.y[-1], 1000)
        curves += [plane.unit(share * edge, edge) for share in BESIDE_CRUSHING]
    return coloured(computed, further, curves)


def _each_curve(view: View, kind: str, double: bool) -> list[Array]:
    """Which points are of each curve; double: whether curves of double eigenvalues are among them."""
    number = view.variables[f"{kind}_number"]
    counts = number if double or kind != "curve" else np.where(view.variables["curve_kind"] == 1, number, 0)
    return [number == one for one in np.unique(counts[counts > 0])]
