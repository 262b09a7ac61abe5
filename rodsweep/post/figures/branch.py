"""The bifurcation diagram of a rod: its cycles over the parameter that is followed, stable and unstable.

Below, how their amplitude grows from the Hopf points beside what the normal form predicts.
"""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter
from numpy.typing import NDArray
from scipy.interpolate import Akima1DInterpolator, CubicHermiteSpline

from ...arrays import Array
from ...model.parameters import CRUSHING
from ...results.file.view import View
from ...results.layouts.variables import MISSING
from ...wording import counted, has_or_have, some_of
from ..branch_curves import (
    CurveOfCycles,
    Range,
    branches_not_told,
    curves_of,
    followed_parameter,
    straight_ranges,
)
from ..summary.branch import ends_of
from . import style
from .cycle.selection import points_told_apart
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
MIRRORED, IMAGE = 3, np.array([1.0, -1.0, 1.0])
"""Cycles that are mirrored at a Hopf point, as many as a slope of Akima's cubic depends on; their image."""
SHARES = np.array([0.5, 1.0, 1.0])
"""Of the parameter, of y and of the logarithm of the period in the length along a branch, in units of their
extents: next to a Hopf point the parameter goes with the square of y, and a length that is y is smoothest."""
OF_SLOPE = 5
"""Cycles through which the polynomial goes whose slope the curve has, so that few cycles suffice."""
CORNER = 0.15
"""Difference of that slope from Akima's, in units of the steeper chord, that only a corner makes."""
BETWEEN = 12
"""Places at which the curve between two cycles is drawn."""
PREDICTED, PREDICTED_WORD = (0, (4, 1, 1, 1)), "by the normal form"
"""Line and word of the amplitude that it predicts next to every Hopf point."""
COLOURS = (style.FIRST, style.SECOND, "#6A3D9A", "#2E7D32", "#8D6E63", "#00838F", "#C2185B", "#9E9D24")
"""Of the branches of one rod, or of several rods, one after another."""


def draw_branch(request: FigureRequest) -> str:
    """The largest tip y and the period over the parameter that is followed, of a rod or of several."""
    view = request.only_view()
    branches = [curves_of(view, rod) for rod in range(view.variables["status"].size)]
    beating = [rod for rod, own in enumerate(branches) if any(curve.cycles.any() for curve in own)]
    style.need(view, beating, "branch with cycles")
    drawn = beating[: len(COLOURS)]
    curves = [curve for rod in drawn for curve in branches[rod]]
    alone = len(branches) == 1
    colours = COLOURS if alone else [COLOURS[k] for k, rod in enumerate(drawn) for _ in branches[rod]]
    along = followed_parameter(view)
    beside = any(curve.beside_hopf_points() for curve in curves)
    figure = Figure(figsize=(5.6, 7.6 if beside else 5.6), layout="constrained")
    upper, lower, *third = figure.subplots(2 + beside, 1)
    lower.sharex(upper)
    upper.tick_params(labelbottom=False)
    marked: dict[str, Line2D] = {}
    for number, curve in enumerate(curves):
        colour = colours[number % len(colours)]
        _draw(upper, lower, curve, colour)
        _mark(upper, lower, curve, marked)
    straight = straight_ranges(view, drawn[0], _shown(view, drawn[0], curves)) if alone else ([], [])
    for stable, ranges in zip((1, 0), straight, strict=True):
        for low, high in ranges:
            upper.plot([low, high], [0, 0], LINES[stable][0], color="k", lw=1.4)
    upper.set_ylabel("largest $y/L$ of the tip")
    lower.set(ylabel=r"period$/\tau_2$", xlabel=style.LABELS[along], yscale="log")
    for axes in third:
        marked["predicted"] = _beside_prediction(axes, curves, colours, along)
    there = {int(s) for curve in curves for s in curve.stable} | {1, 0}
    handles = [Line2D([], [], color="k", ls=LINES[s][0], label=LINES[s][1]) for s in sorted(there)[::-1]]
    shared, own = points_told_apart(view, [rod + 1 for rod in drawn])
    handles += [
        Line2D([], [], color=c, lw=2, label=text) for c, text in zip(COLOURS, own, strict=False) if text
    ]
    style.legend_below(figure, [*handles, *marked.values()], columns=3)
    figure.suptitle(style.heading(view, shared))
    return request.write(
        figure, f"{counted(len(curves), 'branch')} of cycles over {along}{_left_out(view, drawn, beating)}"
    )


def _left_out(view: View, drawn: list[int], beating: list[int]) -> str:
    """What is said of branches and rods that are not drawn."""
    hidden = sum(branches_not_told(view, rod) for rod in range(view.variables["status"].size))
    more = f"; {hidden} more have special points that are not stored" if hidden else ""
    missing = int((view.variables["status"] == MISSING).sum())
    rods = view.variables["status"].size - missing
    if len(drawn) < len(beating):
        more += f"; of the first {len(drawn)} of {len(beating)} rods with branches (--at chooses others)"
    return more + (
        f"; {some_of(rods - len(beating), rods, 'rod')} {has_or_have(rods - len(beating))} none"
        if len(beating) < rods
        else ""
    )


def _shown(view: View, rod: int, curves: list[CurveOfCycles]) -> Range:
    """The range in which the straight rod is drawn: not where it is crushed, nor beyond all cycles."""
    low, high = ends_of(view)
    high = min(high, 1.1 * max(float(np.nanmax(curve.at)) for curve in curves))
    force, stiffness = CRUSHING
    columns = {name: float(values[rod]) for name, values in view.point_columns.items()}
    if followed_parameter(view) == force:
        return low, min(high, columns[stiffness])
    return (max(low, columns[force]) if followed_parameter(view) == stiffness else low), high


def through_cycles(curve: CurveOfCycles) -> tuple[Array, Array, Array, NDArray[np.integer]]:
    """(at, y, period, stable) of a branch as it is drawn, (n,), the last (n - 1,): smooth through its cycles.

    At a Hopf point a branch is its own mirror image, y to -y: beyond it the cycles are mirrored, so that the
    curve has the square root there.
    """
    places = np.column_stack([curve.at, curve.y, np.log(curve.period)])
    extent = np.ptp(places, axis=0) + (np.ptp(places, axis=0) == 0)
    moves = (np.diff(places, axis=0) != 0).any(axis=1)  # the end of the range is a cycle too
    own, stable = places[np.append(True, moves)], curve.stable[moves]
    if len(own) <= MIRRORED:
        return curve.at, curve.y, curve.period, curve.stable
    before, behind = (some * IMAGE for some in (own[MIRRORED:0:-1], own[-2 : -MIRRORED - 2 : -1]))
    first, last = (int(vertex[1] == 0) * MIRRORED for vertex in (own[0], own[-1]))
    whole = np.concatenate([before[:first], own, behind[:last]])
    s = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(whole / extent * SHARES, axis=0), axis=1)))
    ends = s[first : first + len(own)]
    finer = np.append(np.linspace(ends[:-1], ends[1:], BETWEEN, endpoint=False, axis=1).ravel(), ends[-1])
    at, y, log_period = CubicHermiteSpline(s, whole, slopes_at_cycles(s, whole))(finer).T
    return at, y, np.exp(log_period), np.repeat(stable, BETWEEN)


def slopes_at_cycles(s: Array, places: Array) -> Array:
    """The derivatives of places by s, both (n, columns): of the polynomial through OF_SLOPE cycles beside.

    Akima's where the two differ much: beside a corner, where another maximum of y(t) becomes the largest, his
    cubic makes no waves.
    """
    akima = Akima1DInterpolator(s, places)(s, 1)
    count = min(OF_SLOPE, len(s))
    smooth = np.empty_like(places)
    for i, start in enumerate(np.clip(np.arange(len(s)) - count // 2, 0, len(s) - count)):
        beside = s[start : start + count] - s[i]
        size = np.abs(beside).max()
        powers = np.vander(beside / size, increasing=True)
        smooth[i] = np.linalg.solve(powers, places[start : start + count])[1] / size
    chords = np.abs(np.diff(places, axis=0) / np.diff(s)[:, None])
    steepest = np.maximum(np.vstack([chords[:1], chords]), np.vstack([chords, chords[-1:]]))
    return np.where(np.abs(smooth - akima) <= CORNER * steepest, smooth, akima)


def _draw(upper: Axes, lower: Axes, curve: CurveOfCycles, colour: str) -> None:
    """A branch in both panels."""
    at, y, period, stable = through_cycles(curve)
    _pieces(upper, at, y, stable, colour)
    _pieces(lower, at, period, stable, colour)


def _pieces(
    axes: Axes, x: np.ndarray, y: np.ndarray, stable: np.ndarray, colour: str, marker: str = ""
) -> None:
    """A curve, x and y of the shape (n,), each run of pieces of one stability, (n - 1,), with its line."""
    changes = np.flatnonzero(np.diff(stable)) + 1
    for run in np.split(np.arange(len(stable)), changes):
        if len(run):
            vertices = slice(run[0], run[-1] + 2)
            line = LINES[int(stable[run[0]])][0]
            axes.plot(x[vertices], y[vertices], ls=line, marker=marker, color=colour, lw=1.4)


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


def _beside_prediction(axes: Axes, curves: list[CurveOfCycles], colours: Sequence[str], along: str) -> Line2D:
    """The cycles next to the Hopf points in units of a, and what the normal form says: one line for all.

    Up to where a branch turns back: beyond, its cycles are no longer those that the law speaks of.
    """
    nearest, farthest = [], []
    for number, curve in enumerate(curves):
        for at, y, stable in curve.beside_hopf_points():
            _pieces(axes, at, y, stable, colours[number % len(colours)], marker=".")
            nearest.append(float(at[0]))
            farthest.append(float(at[-1]))
    ends = np.array([min(nearest), max(farthest)])
    (law,) = axes.plot(ends, ends**0.5, ls=PREDICTED, color="0.4", lw=1.4, zorder=0, label=PREDICTED_WORD)
    symbol = style.SYMBOLS[along]
    axes.set(xscale="log", yscale="log", ylabel="largest $y/|a|$")
    axes.set_xlabel(rf"$|{symbol}/{symbol}^\mathrm{{H}} - 1|$, distance from the Hopf point")
    style.label_few_decades(axes.xaxis, *axes.get_xlim())
    style.label_few_decades(axes.yaxis, *axes.get_ylim())
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_formatter(NullFormatter())
    return law
