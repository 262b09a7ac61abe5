"""The bifurcation diagram of a rod: its cycles over the parameter that is followed, stable and unstable."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ...errors import InputError
from ...results.file.view import View
from ..branch_curves import CurveOfCycles, Range, curves_of, followed_parameter, straight_ranges
from ..summary.branch import ends_of
from . import style
from .request import FigureRequest

LINES = {1: ("-", "stable"), 0: ("--", "unstable"), -1: (":", "not known")}
"""Line and word of a piece of a curve, by its stability."""
MARKS = {
    "hopf": ("o", "Hopf point"),
    "fold": ("s", "fold"),
    "torus": ("D", "torus point"),
    "symmetry_breaking": ("^", "symmetry breaking"),
    "period_doubling": ("v", "period doubling"),
    "left_the_model": ("X", "the model ends ($h_1 = 0$)"),
    "no_cycle_found": ("x", "no further cycle found"),
    "list_full": ("|", "last cycle stored"),
}
"""Marker and words of a special point, by its kind or, of an end, the reason; other ends are not marked."""
COLOURS = (style.FIRST, style.SECOND, "#6A3D9A", "#2E7D32", "#8D6E63", "#00838F")
"""Of the branches, one after another."""


def draw_branch(request: FigureRequest) -> str:
    """The largest tip y and the period over the parameter that is followed, of a file with one rod."""
    view = request.only_view()
    if view.variables["status"].size != 1:
        rods = view.variables["status"].size
        raise InputError(
            f"{view.path} holds {rods} rods; a bifurcation diagram is of one: give one value a parameter"
        )
    curves = curves_of(view, 0)
    style.need(view, any(curve.cycles.any() for curve in curves), "branch with cycles")
    along = followed_parameter(view)
    figure = Figure(figsize=(5.6, 5.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    marked: dict[str, Line2D] = {}
    for number, curve in enumerate(curves):
        colour = COLOURS[number % len(COLOURS)]
        _pieces(upper, curve.at, curve.y, curve, colour)
        _pieces(lower, curve.at, curve.period, curve, colour)
        _mark(upper, lower, curve, marked)
    for stable, ranges in zip((1, 0), straight_ranges(view, 0, _shown(view, curves)), strict=True):
        for low, high in ranges:
            upper.plot([low, high], [0, 0], LINES[stable][0], color="k", lw=1.4)
    upper.set_ylabel("largest $y/L$ of the tip")
    lower.set(ylabel=r"period$/\tau_2$", xlabel=style.LABELS[along], yscale="log")
    there = {int(s) for curve in curves for s in curve.stable} | {1, 0}
    handles = [Line2D([], [], color="k", ls=LINES[s][0], label=LINES[s][1]) for s in sorted(there)[::-1]]
    style.legend_below(figure, [*handles, *marked.values()], columns=3)
    figure.suptitle(style.heading(view, style.fixed_text(view)), fontsize=9)
    return request.write(figure, f"{len(curves)} branches of cycles over {along}")


def _shown(view: View, curves: list[CurveOfCycles]) -> Range:
    """The range in which the straight rod is drawn: no further than cycles and Hopf points reach."""
    low, high = ends_of(view)
    reach = max(float(np.nanmax(curve.at)) for curve in curves)
    return low, min(high, 1.1 * reach)


def _pieces(axes: Axes, x: np.ndarray, y: np.ndarray, curve: CurveOfCycles, colour: str) -> None:
    """A curve, x and y of the shape (n,), each run of pieces of one stability with its line."""
    changes = np.flatnonzero(np.diff(curve.stable)) + 1
    for run in np.split(np.arange(len(curve.stable)), changes):
        if len(run):
            vertices = slice(run[0], run[-1] + 2)
            line = LINES[int(curve.stable[run[0]])][0]
            axes.plot(x[vertices], y[vertices], line, color=colour, lw=1.4)


def _mark(upper: Axes, lower: Axes, curve: CurveOfCycles, marked: dict[str, Line2D]) -> None:
    """Marks the special points of a curve; what the legend says of them, by kind, goes into `marked`."""
    for special in curve.special:
        kind = special.reason if special.kind == "end" else special.kind
        if kind not in MARKS:
            continue
        marker, word = MARKS[kind]
        (drawn,) = upper.plot(special.at, special.tip_y_max, marker, color="k", ms=5, ls="", label=word)
        lower.plot(special.at, special.period, marker, color="k", ms=5, ls="")
        marked.setdefault(kind, drawn)
