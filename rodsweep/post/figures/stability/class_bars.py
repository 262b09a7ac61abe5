"""Colours and legend entries of the stability classes of the straight rod and of the stable states, and the
classes of single rods along F: one bar for each rod, with thresholds."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from ....arrays import Array
from ....results.file.view import ResultView
from ....results.layouts.phase_diagram import STABILITY_CLASSES, STABLE_STATES
from ....results.layouts.thresholds import CROSSING_KINDS
from ....wording import plural
from .. import style
from ..arm.quantities import set_heading
from ..point_lists import label_point_numbers, shared_parameters
from .row_classes import class_above_crossing

CLASS_COLOURS = {
    "missing": "white",
    "monotone": "#DCE9F5",
    "oscillatory": "#9CC3E4",
    "flutter": "#F2B28A",
    "undecided": "#666666",
    "crushed": "#BBBBBB",
    "not stored": "#F3F3F3",
}
"""Colours of the classes: blue for stable rods, orange for unstable rods. The colours also differ in grey
prints. Bars of single rods are "not stored" beyond a full list of crossings."""
STABLE_STATE_COLOURS = {
    "missing": "white",
    "neither_known": "#F6E3A1",
    "straight": CLASS_COLOURS["oscillatory"],
    "cycle": CLASS_COLOURS["flutter"],
    "both": "#8E6BB0",
    "undecided": CLASS_COLOURS["undecided"],
    "crushed": CLASS_COLOURS["crushed"],
}
"""Colours of the values of the variable `stable_states`, by word. The colour of "both" lies between the
colours of "straight" and "cycle"."""
LEGEND_ENTRIES = {
    "missing": "not computed",
    "monotone": "monotone decay",
    "oscillatory": "oscillatory decay",
    "straight": "only straight rod stable",
    "cycle": "only cycle stable",
    "both": "rod and cycle stable",
    "neither_known": "no stable state known",
}
"""Legend entries for the words of `stable_states` and `class`. A word that is not listed is its own legend
entry."""


CLASS_EDGE_LOOK: dict[str, Any] = {"ec": "0.5", "lw": 0.5}
"""Edge of bars and of legend entries, so that light classes are visible on white paper."""


@dataclass(frozen=True, slots=True)
class Palette:
    """Colours for a map of an integer variable. variable: name of the variable. words: (integer, word) of
    each value. colours: colour of each word."""

    variable: str
    words: tuple[tuple[int, str], ...]
    colours: dict[str, str]

    @property
    def colour_keywords(self) -> dict[str, Any]:
        """Keywords with which matplotlib draws an array of the variable's integers in the colours of their
        words."""
        numbers = [number for number, _ in self.words]
        return {
            "cmap": ListedColormap([self.colours[word] for _, word in self.words]),
            "norm": BoundaryNorm(np.append(numbers, numbers[-1] + 1) - 0.5, len(numbers)),
        }

    def legend_entries(self, table: Array) -> list[Patch]:
        """Legend entries for the words whose integers occur in `table`, (rows, columns)."""
        words = [word for number, word in self.words if (table == number).any()]
        return [
            Patch(fc=self.colours[word], label=LEGEND_ENTRIES.get(word, word), **CLASS_EDGE_LOOK)
            for word in words
        ]


CLASS_PALETTE = Palette("class", STABILITY_CLASSES, CLASS_COLOURS)
"""Palette for the stability class of the straight rod."""
STABLE_STATE_PALETTE = Palette("stable_states", STABLE_STATES, STABLE_STATE_COLOURS)
"""Palette for the stable states listed in STABLE_STATES."""


HOPF_OF_FURTHER_PAIR = "later"
"""Key in CROSSING_MARKS of a Hopf point at which a rod that is already unstable becomes unstable to a further
pair of modes."""
CROSSING_MARKS = {
    "onset": (style.BLUE, "o", rf"onset ${style.TEX_SYMBOLS['F']}_*$"),
    "hopf": (style.VERMILION, "s", rf"Hopf ${style.TEX_SYMBOLS['F']}_{{**}}$"),
    HOPF_OF_FURTHER_PAIR: (style.VERMILION, "D", "further Hopf point"),
    "restabilization": (style.GREEN, "^", "restabilization"),
}
"""(colour, marker, legend entry) of each kind of crossing that is marked."""
BAR_WIDTH_OVER_SPACING = 0.8
"""Width of a bar, as a fraction of the distance between bars."""
BAR_ASPECT = 0.12
"""Ratio of height to width of a panel with a single bar."""
THRESHOLD_DIGITS = 6
"""Number of significant digits of the thresholds of a single rod, in the legend."""


def draw_class_bars(view: ResultView) -> Figure:
    """Figure of the stability classes over F: one bar for each rod, coloured by class; horizontal for a
    single rod. Raises InputError if nothing can be drawn."""
    rod_count = view.variables["status"].size
    variables = {name: view.variables[name] for name in ("F_end", "crossing_kind")}
    style.require_content(view, np.isfinite(variables["F_end"]).any(), "computed rod")
    figure = Figure(figsize=(5.8, 2.2 if rod_count == 1 else 4.0), layout="constrained")
    axes = figure.subplots()
    for rod in range(rod_count):
        draw_class_bar(axes, view, rod, is_vertical=rod_count > 1)
    mark_thresholds_on_bars(axes, view, is_vertical=rod_count > 1)
    largest_force = float(np.nanmax(variables["F_end"]))
    if rod_count == 1:
        axes.set(xlim=(0, largest_force), ylim=(-0.75, 0.75), yticks=[], xlabel=style.AXIS_LABELS["F"])
        axes.spines["left"].set_visible(False)
    else:
        axes.set(ylim=(0, largest_force), ylabel=style.AXIS_LABELS["F"])
        label_point_numbers(axes, view, rod_count)
    style.draw_shared_legend(figure, column_count=2)
    set_heading(figure, view, style.parameter_text(shared_parameters(view)))
    return figure


def classes_over_force(view: ResultView, rod: int) -> Iterator[tuple[float, float, str]]:
    """Yields (start, end, class) of each interval of F between crossings of the rod with the index `rod`,
    from F = 0 to the end of the search. The first interval has the class "monotone"; the last is "not stored"
    if the file has no room for all crossings."""
    names = ("crossing_kind", "crossing_F", "unstable_after")
    kinds, F, counts = (view.flattened_by_point(name)[rod] for name in names)
    largest_force = float(view.variables["F_end"].ravel()[rod])
    crossing_count = int(view.variables["crossing_count"].ravel()[rod])
    start = 0.0
    word = "monotone"
    for index in np.flatnonzero(kinds > 0):
        yield start, float(F[index]), word
        start = float(F[index])
        word = class_above_crossing(int(kinds[index]), int(counts[index]))
    if crossing_count > np.count_nonzero(kinds > 0):
        word = "not stored"
    if np.isfinite(largest_force):
        yield start, largest_force, word


def draw_class_bar(axes: Axes, view: ResultView, rod: int, is_vertical: bool) -> None:
    """Draws the bar along F of the rod with the index `rod`, coloured by stability class. is_vertical:
    whether F is on the vertical axis."""
    intervals = list(classes_over_force(view, rod))
    undecided_from, undecided_to = (view.flattened_by_point(name)[rod] for name in ("open_from", "open_to"))
    if np.isfinite(undecided_from):
        intervals.append((float(undecided_from), float(undecided_to), "undecided"))
    for start, end, word in intervals:
        look = CLASS_EDGE_LOOK | {"fc": CLASS_COLOURS[word], "label": LEGEND_ENTRIES.get(word, word)}
        if is_vertical:
            axes.bar(rod + 1, end - start, BAR_WIDTH_OVER_SPACING, bottom=start, **look)
        else:
            axes.barh(0, end - start, BAR_WIDTH_OVER_SPACING, left=start, **look)


def mark_thresholds_on_bars(
    axes: Axes, view: ResultView, is_vertical: bool, unit: str = "", factor: float = 1.0
) -> None:
    """Marks the thresholds of all bars. The legend entries of a horizontal bar, of a single rod, contain the
    forces. is_vertical: as in `draw_class_bar`.

    unit: unit of the loads in legend entries; empty for F. factor: load at F = 1, in this unit.
    """
    kinds, F, counts = map(view.flattened_by_point, ("crossing_kind", "crossing_F", "unstable_after"))
    is_hopf = kinds == CROSSING_KINDS.index("hopf")
    masks = {
        kind: kinds == CROSSING_KINDS.index(kind) for kind in CROSSING_MARKS if kind != HOPF_OF_FURTHER_PAIR
    }
    masks |= {"hopf": is_hopf & (counts <= 2), HOPF_OF_FURTHER_PAIR: is_hopf & (counts > 2)}
    look: dict[str, Any] = {"mec": "white", "mew": 0.6, "ms": 6, "clip_on": False}
    for kind, (colour, marker, word) in CROSSING_MARKS.items():
        rods, crossing_indices = np.nonzero(masks[kind])
        if not rods.size:
            continue
        force = F[rods, crossing_indices]
        x, y = (rods + 1, force) if is_vertical else (force, rods)
        name = plural(word) if kind == HOPF_OF_FURTHER_PAIR and rods.size > 1 else word
        if unit:
            name = name.partition(" $")[0]
        loads_text = ", ".join(f"{factor * force_value:#.{THRESHOLD_DIGITS}g}" for force_value in force)
        label = name if is_vertical else f"{name} = {loads_text} {unit}".rstrip()
        axes.plot(x, y, marker, color=colour, label=label, **look)
