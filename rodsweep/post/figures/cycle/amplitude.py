"""Amplitudes of the tip against the force, as the paper's Fig. 6: the straight arm gives way to beating."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from ....arrays import Array
from ....errors import InputError
from ....results.file.view import View
from ..style import FIRST, LABELS, SECOND, THIRD, heading, legend_below, need, plain, scale
from .selection import outcomes, told_apart

BRANCH_LOOKS = tuple(
    zip((FIRST, SECOND, THIRD, "#CC79A7", "#56B4E9", "#000000"), ("o", "s", "^", "D", "v", "P"), strict=True)
)
"""Colour, of Okabe and Ito, and marker of each branch."""


@dataclass(frozen=True, slots=True)
class AmplitudeBranch:
    """Points in the order of the file that differ in one parameter only; amplitudes in L, NaN where unknown.

    parameters: the other ones, by name; words: of the status; all arrays have the shape (points,).
    """

    view: View
    parameters: dict[str, float]
    x: Array
    amplitude_x: Array
    amplitude_y: Array
    words: NDArray[np.str_]

    def broken_at_onset(self, values: Array) -> tuple[Array, Array]:
        """(x, values) with a gap between a straight arm and a beating one: a line would invent a slope."""
        straight = self.words == "straight"
        change = np.flatnonzero(straight[1:] != straight[:-1]) + 1
        return np.insert(self.x, change, np.nan), np.insert(values, change, np.nan)


def draw_amplitude(views: Sequence[View]) -> tuple[Figure, str]:
    """Half the reach of the tip's x, and the largest y, against F; a straight arm has the amplitude 0."""
    first = views[0]
    name = abscissa(first)
    branches = [branch for view in views for branch in branches_of(view, name)]
    if len(branches) > len(BRANCH_LOOKS):
        raise InputError(
            f"{first.path} makes {len(branches)} lines over {name}, for which a figure has no room; "
            f"run with at most {len(BRANCH_LOOKS)} combinations of the other parameters"
        )
    need(first, any(np.isfinite(branch.amplitude_y).any() for branch in branches), "amplitude")
    figure = Figure(figsize=(5.4, 6.0), layout="constrained")
    top, bottom = figure.subplots(2, 1, sharex=True)
    shared, own = told_apart([branch.parameters for branch in branches])
    handles, unknown = [], set[str]()
    for branch, text, (colour, marker) in zip(branches, own, BRANCH_LOOKS, strict=False):
        look: dict[str, Any] = {"color": colour, "marker": marker, "lw": 1.2, "ms": 3.5}
        if branch.view is not first:  # open, larger markers leave those of an earlier file to be seen
            look |= {"mfc": "none", "ms": 6.5, "ls": "--"}
        file = plain(branch.view.path.stem) if len(views) > 1 else ""
        handles.append(Line2D([], [], label=", ".join(filter(None, (file, text))), **look))
        for axes, values in ((top, branch.amplitude_x), (bottom, branch.amplitude_y)):
            axes.plot(*branch.broken_at_onset(values), **look)
            unknown |= _mark_unknown(axes, branch, look["color"])
    if unknown:
        label = ", ".join(sorted(unknown)) + " (at the top)"
        handles.append(Line2D([], [], color="0.3", marker="x", ls="", ms=5, label=label))
    for axes in (top, bottom):
        height = axes.dataLim.y1 or 1.0
        axes.set_ylim(-0.04 * height, 1.1 * height)
        axes.axhline(0, color="0.8", lw=0.6, zorder=0)
    top.set_ylabel(r"tip $(x_{\max} - x_{\min})/2$  [$L$]")
    bottom.set(ylabel=r"tip $y_{\max}$  [$L$]", xlabel=LABELS[name])
    scale(bottom, "x", np.unique(branches[0].x))
    if legend := [handle for handle in handles if handle.get_label()]:
        legend_below(figure, legend, columns=min(2, len(legend)))
    figure.suptitle(heading(first, shared), fontsize=10)
    return figure, f"amplitudes of the tip against {name}"


def _mark_unknown(axes: Axes, branch: AmplitudeBranch, colour: str) -> set[str]:
    """Marks at the top where no amplitude is known; returns what became of those points."""
    lost = ~np.isin(branch.words, ("cycle", "straight", "missing"))
    for x in branch.x[lost]:
        axes.plot(x, 1.0, "x", color=colour, ms=5, clip_on=False, transform=axes.get_xaxis_transform())
    return {str(word).replace("_", " ") for word in branch.words[lost]}


def abscissa(view: View) -> str:
    """The parameter against which is drawn: F, or the one with most values where F is fixed."""
    sizes = {name: len(np.unique(column)) for name, column in view.point_columns.items()}
    name = "F" if sizes["F"] > 1 else max(sizes, key=sizes.__getitem__)
    if sizes[name] < 2:
        raise InputError(f"{view.path} holds one point; amplitudes are drawn against F where it has values")
    return name


def branches_of(view: View, name: str) -> list[AmplitudeBranch]:
    """The file's points, one branch for each combination of the parameters other than `name`."""
    columns = view.point_columns
    x = columns.pop(name)
    keys = list(zip(*(column.tolist() for column in columns.values()), strict=True))
    words, v = outcomes(view), view.variables
    straight, cycle = words == "straight", words == "cycle"
    reach = (v["tip_x_max"] - v["tip_x_min"]).ravel() / 2
    along_x, along_y = (
        np.where(straight, 0.0, np.where(cycle, values, np.nan)) for values in (reach, v["tip_y_max"].ravel())
    )
    branches = []
    for key in dict.fromkeys(keys):
        at = np.array([k == key for k in keys]) & np.isfinite(x)
        parameters = dict(zip(columns, key, strict=True))
        branches.append(AmplitudeBranch(view, parameters, x[at], along_x[at], along_y[at], words[at]))
    return branches
