"""Amplitudes of the tip against the force, as the paper's Fig. 6: the straight arm gives way to beating."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from ....errors import InputError
from ....results.file.view import View
from ..style import FIRST, LABELS, SECOND, THIRD, heading, plain, scale
from .chosen import Array, outcomes, parameter_text, point_columns

COLOURS = (FIRST, SECOND, THIRD, "#CC79A7", "#56B4E9", "#000000")
"""Of Okabe and Ito; a line's marker tells it too."""
MARKERS = ("o", "s", "^", "D", "v", "P")


@dataclass(frozen=True, slots=True)
class Line:
    """Points in the order of the file that differ in one parameter only; amplitudes in L, NaN where unknown.

    parameters: the other ones, by name; words: of the status; all arrays have the shape (points,).
    """

    parameters: dict[str, float]
    x: Array
    amplitude_x: Array
    amplitude_y: Array
    words: NDArray[np.str_]


def draw_amplitude(views: Sequence[View]) -> tuple[Figure, str]:
    """Half the reach of the tip's x, and the largest y, against F; a straight arm has the amplitude 0."""
    name = abscissa(views[0])
    tables = [lines_of(view, name) for view in views]
    total = sum(len(lines) for lines in tables)
    if total > len(COLOURS):
        raise InputError(
            f"{views[0].path} makes {total} lines over {name}, for which a figure has no room; "
            f"run with at most {len(COLOURS)} combinations of the other parameters"
        )
    if not any(np.isfinite(line.amplitude_y).any() for lines in tables for line in lines):
        raise InputError(f"{views[0].path} holds no amplitude that could be drawn")
    figure = Figure(figsize=(5.4, 6.0), layout="constrained")
    top, bottom = figure.subplots(2, 1, sharex=True)
    every = [line.parameters for lines in tables for line in lines]
    shared = {n: v for n, v in every[0].items() if all(p[n] == v for p in every)}
    handles, unknown = [], set()
    looks = iter(zip(COLOURS, MARKERS, strict=True))
    for view, lines in zip(views, tables, strict=True):
        for line in lines:
            colour, marker = next(looks)
            # A later file's open, larger markers leave those of an earlier one to be seen.
            look: dict[str, Any] = {"color": colour, "marker": marker, "lw": 1.2, "ms": 3.5}
            if view is not views[0]:
                look |= {"mfc": "none", "ms": 6.5, "ls": "--"}
            own = parameter_text({n: v for n, v in line.parameters.items() if n not in shared})
            words = [plain(view.path.stem)] if len(views) > 1 else []
            handles.append(Line2D([], [], label=", ".join([*words, own] if own else words), **look))
            for axes, values in ((top, line.amplitude_x), (bottom, line.amplitude_y)):
                axes.plot(*broken_at_onset(line, values), **look)
                unknown |= _mark_unknown(axes, line, colour)
    if unknown:
        label = ", ".join(sorted(unknown)) + " (at the top)"
        handles.append(Line2D([], [], color="0.3", marker="x", ls="", ms=5, label=label))
    for axes in (top, bottom):
        height = axes.dataLim.y1 or 1.0
        axes.set_ylim(-0.04 * height, 1.1 * height)
        axes.axhline(0, color="0.8", lw=0.6, zorder=0)
    top.set_ylabel(r"tip $(x_{\max} - x_{\min})/2$  [$L$]")
    bottom.set_ylabel(r"tip $y_{\max}$  [$L$]")
    bottom.set_xlabel(LABELS[name])
    scale(bottom, "x", np.unique(tables[0][0].x))
    legend = [handle for handle in handles if handle.get_label()]
    if legend:
        figure.legend(
            handles=legend, loc="outside lower center", ncols=min(2, len(legend)), frameon=False, fontsize=8
        )
    figure.suptitle(heading(views[0].attributes.get("title", ""), parameter_text(shared)), fontsize=10)
    return figure, f"amplitudes of the tip against {name}"


def _mark_unknown(axes: Axes, line: Line, colour: str) -> set[str]:
    """Marks at the top where no amplitude is known; returns what became of those points."""
    lost = ~np.isin(line.words, ("cycle", "straight", "missing"))
    for x in line.x[lost]:
        axes.plot(x, 1.0, "x", color=colour, ms=5, clip_on=False, transform=axes.get_xaxis_transform())
    return {str(word).replace("_", " ") for word in line.words[lost]}


def abscissa(view: View) -> str:
    """The parameter against which is drawn: F, or the one with most values where F is fixed."""
    sizes = {name: len(np.unique(column)) for name, column in point_columns(view).items()}
    name = "F" if sizes["F"] > 1 else max(sizes, key=sizes.__getitem__)
    if sizes[name] < 2:
        raise InputError(f"{view.path} holds one point; amplitudes are drawn against F where it has values")
    return name


def lines_of(view: View, name: str) -> list[Line]:
    """The file's points, one line for each combination of the parameters other than `name`."""
    columns = point_columns(view)
    others = [n for n in columns if n != name]
    keys = list(zip(*(columns[n].tolist() for n in others), strict=True))
    words, v = outcomes(view), view.variables
    straight, cycle = words == "straight", words == "cycle"
    reach = (v["tip_x_max"] - v["tip_x_min"]).ravel() / 2
    along_x, along_y = (
        np.where(straight, 0.0, np.where(cycle, values, np.nan)) for values in (reach, v["tip_y_max"].ravel())
    )
    lines = []
    for key in dict.fromkeys(keys):
        at = np.array([k == key for k in keys]) & np.isfinite(columns[name])
        line = columns[name][at], along_x[at], along_y[at], words[at]
        lines.append(Line(dict(zip(others, key, strict=True)), *line))
    return lines


def broken_at_onset(line: Line, values: Array) -> tuple[Array, Array]:
    """(x, values) with a gap between a straight arm and a beating one, where a line would invent a slope."""
    straight = line.words == "straight"
    change = np.flatnonzero(straight[1:] != straight[:-1]) + 1
    return np.insert(line.x, change, np.nan), np.insert(values, change, np.nan)
