"""Bifurcation diagram of a rod: stable and unstable cycles against the followed parameter.

A third panel compares the amplitudes near Hopf points with the prediction of the normal form.
"""

from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from ...results.layouts.variables import MISSING_STATUS
from ...wording import count_of_total, counted, has_or_have, is_or_are
from ..branch_curves import RodBranches, followed_parameter, runs_of_equal_stability
from ..crushing import uncrushed_ranges
from ..stored_branches import StoredBranch
from . import style
from .cycle.selection import shared_and_own_texts_of_points
from .request import FigureRequest
from .smooth_branch import smooth_curve_of_branch

STABILITY_LOOKS = {1: ("-", "stable"), 0: ("--", "unstable"), -1: (":", "stability not known")}
"""(line style, legend entry) of a branch, by stability: 1 stable, 0 unstable, -1 unknown."""
SPECIAL_POINT_MARKS = {
    "hopf": ("o", "Hopf point"),
    "fold": ("s", "fold"),
    "torus": ("D", "torus point"),
    "symmetry_breaking": ("^", "symmetry breaking"),
    "period_doubling": ("v", "period doubling"),
    "left_the_model": ("X", "section crushed ($h_1 = 0$)"),
    "no_cycle_found": ("x", "not followed further"),
    "list_full": ("|", "last stored cycle"),
}
"""(marker, legend entry) of a special point, by kind, or by reason for the end of a branch. Other ends are
not marked."""
PREDICTED_AMPLITUDE_LOOK: dict[str, Any] = {"ls": (0, (4, 1, 1, 1)), "label": "predicted by the normal form"}
"""Line style and legend entry of the amplitude predicted by the normal form near a Hopf point."""
BRANCH_COLOURS = (
    style.BLUE,
    style.VERMILION,
    "#6A3D9A",
    "#2E7D32",
    "#8D6E63",
    "#00838F",
    "#C2185B",
    "#9E9D24",
)
"""Colours, in order, of the branches of a single rod, or of the rods if the file has several rods."""


def draw_branch(request: FigureRequest) -> str:
    """Draws the largest y of the tip and the period of cycles against the followed parameter, for one or
    several rods; returns a description of the figure. Raises InputError for options that the task does not
    have, and if nothing can be drawn."""
    view = request.require_single_view()
    rods = [RodBranches(view, number) for number in range(view.variables["status"].size)]
    rods_with_cycles = [rod for rod in rods if any(curve.is_cycle.any() for curve in rod.curves)]
    style.require_content(view, rods_with_cycles, "branch with cycles")
    drawn_rods = rods_with_cycles[: len(BRANCH_COLOURS)]
    curves = [curve for rod in drawn_rods for curve in rod.curves]
    is_single = len(rods) == 1
    colours_of_rods = [
        BRANCH_COLOURS[rod_index] for rod_index, rod in enumerate(drawn_rods) for _ in rod.curves
    ]
    colours: Sequence[str] = BRANCH_COLOURS if is_single else colours_of_rods
    parameter = followed_parameter(view)
    has_hopf_panel = any(curve.scaled_curves_near_hopf_points() for curve in curves)
    figure = Figure(figsize=(5.6, 7.6 if has_hopf_panel else 5.6), layout="constrained")
    upper, lower, *hopf_panel = figure.subplots(2 + has_hopf_panel, 1)
    lower.sharex(upper)
    upper.tick_params(labelbottom=False)
    add_stability_entries(upper, curves)
    common_text, rod_texts = shared_and_own_texts_of_points(view, [rod.index + 1 for rod in drawn_rods])
    for colour, text in zip(BRANCH_COLOURS, rod_texts, strict=False):
        upper.plot([], [], color=colour, lw=2, label=text or None)
    draw_branch_curves(upper, lower, curves, colours)
    if is_single:
        draw_straight_rod(upper, drawn_rods[0])
    upper.set_ylabel("largest $y/L$ of the tip")
    lower.set(ylabel=r"period$/\tau_2$", xlabel=style.AXIS_LABELS[parameter], yscale="log")
    for axes in hopf_panel:
        _draw_predicted_amplitudes(axes, curves, colours, parameter)
    style.draw_shared_legend(figure, column_count=3)
    figure.suptitle(style.heading_text(view, common_text))
    caption = f"{counted(len(curves), 'branch')} of cycles over {parameter}"
    return request.write(figure, caption + _omissions_clause(rods, len(rods_with_cycles), len(drawn_rods)))


def draw_branch_curves(
    upper: Axes, lower: Axes, curves: Sequence[StoredBranch], colours: Sequence[str]
) -> None:
    """Draws branches with their special points into two panels. upper: panel of the largest y of the tip.
    lower: panel of the period. colours: colours of the branches, used cyclically."""
    for curve, colour in zip(curves, cycle(colours), strict=False):
        parameter_values, y, period, stable = smooth_curve_of_branch(curve)
        _draw_curve_by_stability(upper, parameter_values, y, stable, colour)
        _draw_curve_by_stability(lower, parameter_values, period, stable, colour)
        for special in curve.special_points:
            kind_or_reason = special.reason if special.kind == "end" else special.kind
            if kind_or_reason in SPECIAL_POINT_MARKS:
                marker, label = SPECIAL_POINT_MARKS[kind_or_reason]
                for axes, value in ((upper, special.tip_y_max), (lower, special.period)):
                    axes.plot(special.at, value, marker, color=style.text_colour(), ms=5, label=label)


def draw_straight_rod(axes: Axes, rod: RodBranches) -> None:
    """Draws the straight rod, where its stability is known, as the line y = 0; the line style shows the
    stability."""
    [(start, end)] = uncrushed_ranges(rod.view, [rod.index])
    if rod.curves:
        end = min(end, 1.1 * max(float(np.nanmax(curve.parameter)) for curve in rod.curves))
    for stable, ranges in zip((1, 0), rod.straight_rod_stable_unstable_ranges((start, end)), strict=True):
        for low, high in ranges:
            axes.plot([low, high], [0, 0], STABILITY_LOOKS[stable][0], color=style.text_colour(), lw=1.4)


def add_stability_entries(axes: Axes, curves: Sequence[StoredBranch]) -> None:
    """Adds legend entries for the line styles of stable and unstable parts of branches, and of parts of
    unknown stability if there are any."""
    stabilities = {int(stability) for curve in curves for stability in curve.stability} | {1, 0}
    for stability in sorted(stabilities, reverse=True):
        line_style, label = STABILITY_LOOKS[stability]
        axes.plot([], [], color=style.text_colour(), ls=line_style, label=label)


def _omissions_clause(rods: Sequence[RodBranches], cycling: int, drawn_count: int) -> str:
    """Clause on branches and rods that the figure leaves out. cycling, drawn_count: numbers of rods with
    cycles, and of drawn rods."""
    hidden = sum(rod.hidden_count for rod in rods)
    clause = ""
    if hidden:
        clause = f"; {hidden} more {is_or_are(hidden)} not drawn: the list of special points is full"
    if drawn_count < cycling:
        clause += f"; of the first {drawn_count} of {cycling} rods with branches (--at chooses others)"
    computed = int((rods[0].view.variables["status"] != MISSING_STATUS).sum())
    straight = computed - cycling
    if straight > 0:
        clause += f"; {count_of_total(straight, computed, 'rod')} {has_or_have(straight)} no branch"
    return clause


def _draw_curve_by_stability(
    axes: Axes, x: np.ndarray, y: np.ndarray, stable: np.ndarray, colour: str, marker: str = ""
) -> None:
    """Draws a curve with line styles by stability. x, y: vertices, (n,) each. stable: stability between
    neighbouring vertices, (n - 1,). colour, marker: colour and marker of the curve, for matplotlib."""
    for vertices, kind in runs_of_equal_stability(stable):
        axes.plot(x[vertices], y[vertices], ls=STABILITY_LOOKS[kind][0], marker=marker, color=colour, lw=1.4)


def _draw_predicted_amplitudes(
    axes: Axes, curves: list[StoredBranch], colours: Sequence[str], parameter_name: str
) -> None:
    """Draws the amplitudes near Hopf points and the amplitudes predicted by the normal form, divided by the
    amplitude coefficient |a|. Each branch is drawn up to its first fold, beyond which the prediction is not
    valid."""
    for curve, colour in zip(curves, cycle(colours), strict=False):
        for relative_distance, y, stable in curve.scaled_curves_near_hopf_points():
            _draw_curve_by_stability(axes, relative_distance, y, stable, colour, marker=".")
    ends = axes.dataLim.intervalx
    axes.plot(ends, ends**0.5, color="0.4", lw=1.4, zorder=0, **PREDICTED_AMPLITUDE_LOOK)
    symbol = style.TEX_SYMBOLS[parameter_name]
    axes.set(xscale="log", yscale="log", ylabel="largest $y/|a|$")
    symbol = f"({symbol})" if "/" in symbol else symbol
    ratio_symbol = rf"{symbol}/{symbol}^\mathrm{{H}}"
    axes.set_xlabel(rf"$|{ratio_symbol} - 1|$, distance from the Hopf point")
    for axis in (axes.xaxis, axes.yaxis):
        style.label_few_decades(axis, *axis.get_view_interval())
        axis.set_minor_formatter(NullFormatter())
