"""Portrait of a rod as a figure: thresholds along F, branches of cycles, modes at the thresholds, three
cycles."""

import textwrap
from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...results.file.view import ResultView
from ...results.layouts.limit_cycle import STATUS_NAMES_WITH_CYCLE
from ..figures import style
from ..figures.branch import BRANCH_COLOURS, add_stability_entries, draw_branch_curves, draw_straight_rod
from ..figures.cycle.shapes_and_tip_motion import ARROW_LENGTH, draw_shapes, shades_of_shapes
from ..figures.stability.class_bars import draw_class_bar, mark_thresholds_on_bars
from .paragraph import paragraph
from .portrait_units import rescale_panel
from .results import RodResults

PORTRAIT_SIZE = (10.0, 10.4)
"""Width and height of the figure, in inches."""
ROW_HEIGHTS = (0.4, 2.4, 1.5, 2.2)
"""Relative heights of the rows of panels: thresholds, largest y of the tip, periods, and modes
with cycles."""
ROW_HEIGHTS_WITHOUT_BRANCHES = (0.4, 0.3, 0.1, 2.2)
"""`ROW_HEIGHTS` of a rod without branches: a sentence takes the place of the largest y, and there is no panel
of periods."""
MODE_TO_CYCLE_PANEL_WIDTH_RATIO = 0.65
"""Width of the panel of a mode, divided by the width of the panel of a cycle."""
PARAGRAPH_WIDTH = 162
"""Largest length of a line of the paragraph, in characters."""
PANEL_TEXT_WIDTH = 26
"""Largest length of a line, in characters, of a sentence in a panel for a mode or a cycle."""
CYCLE_COUNT = 3
"""Number of cycles in the figure."""
COEXISTENCE_LOOK = (style.GREEN, "stable cycle beside a stable straight rod")
"""Colour and legend entry of ranges of F in which a stable cycle and the stable straight rod coexist."""
TWO_CYCLES_LOOK = (style.PURPLE, "two stable cycles")
"""Colour and legend entry of ranges of F in which two stable cycles coexist."""
CYCLE_LEGEND_ENTRY = "cycle drawn below"
"""Legend entry of the marks of cycles whose shapes are drawn."""
MIN_DRAWN_IMAGINARY_FRACTION = 1e-3
"""The imaginary part of a mode is drawn if its maximum exceeds this fraction of the maximum of the real part.
At a double eigenvalue half of the digits are rounding errors."""


def draw_rod_portrait(results: RodResults, with_words: bool = True) -> Figure:
    """Figure of the portrait. with_words: whether the paragraph is written above the panels.

    The panel of a missing result contains a sentence with the reason.
    """
    with matplotlib.rc_context(style.FIGURE_STYLE):
        heights = ROW_HEIGHTS if _has_branches(results) else ROW_HEIGHTS_WITHOUT_BRANCHES
        figure_size = (PORTRAIT_SIZE[0], PORTRAIT_SIZE[1] * sum(heights) / sum(ROW_HEIGHTS))
        figure = Figure(figsize=figure_size, layout="constrained")
        modes = list(results.modes_at_first_thresholds) or [""]
        widths = [MODE_TO_CYCLE_PANEL_WIDTH_RATIO] * len(modes) + [1.0] * CYCLE_COUNT
        grid = figure.add_gridspec(4, len(widths), height_ratios=heights, width_ratios=widths)
        bar_panel = figure.add_subplot(grid[0, :])
        upper = figure.add_subplot(grid[1, :], sharex=bar_panel)
        lower = figure.add_subplot(grid[2, :], sharex=bar_panel)
        _draw_thresholds(bar_panel, results)
        _draw_branches(upper, lower, results)
        _convert_to_portrait_units((bar_panel, upper, lower), results)
        if not lower.axison:  # the bar has the only axis of the force
            bar_panel.tick_params(labelbottom=True)
            bar_panel.set_xlabel(results.units.panel_axis_labels[0])
        for column, kind in enumerate(modes):
            _draw_mode(figure.add_subplot(grid[3, column]), results, kind)
        panels = [figure.add_subplot(grid[3, len(modes) + cycle_index]) for cycle_index in range(CYCLE_COUNT)]
        _draw_cycles(panels, results)
        style.draw_shared_legend(figure, column_count=4)
        if with_words:
            paragraph_text = textwrap.fill(paragraph(results), PARAGRAPH_WIDTH)
            figure.suptitle(style.escape_dollar_signs(paragraph_text), x=0.01, ha="left", fontsize=8)
        return figure


def _has_branches(results: RodResults) -> bool:
    """Whether the portrait shows branches of cycles."""
    return results.branches is not None and bool(results.branches.curves)


def _convert_to_portrait_units(panels: Sequence[Axes], results: RodResults) -> None:
    """Converts the panels of the thresholds, the largest y and the period to the units of the portrait."""
    units = results.units
    end = panels[0].get_xlim()[1]
    for axes, y_factor in zip(
        panels,
        (1.0, units.length.factor_from_dimensionless, units.time.factor_from_dimensionless),
        strict=True,
    ):
        if units.load_kind and axes.axison:
            rescale_panel(axes, units.force.factor_from_dimensionless, y_factor)
    panels[0].set_xlim(0, units.force.factor_from_dimensionless * end)


def _draw_thresholds(axes: Axes, results: RodResults) -> None:
    """Draws the stability of the straight rod along F, with the thresholds. If the thresholds are unknown,
    the panel states the reason."""
    view = results.views["thresholds"]
    variables = view.point_values(0)
    axes.set(ylim=(-0.6, 0.6), yticks=[])
    axes.spines["left"].set_visible(False)
    axes.tick_params(labelbottom=False)
    if not np.isfinite(variables["F_end"]):
        _write_sentence(axes, f"thresholds: {_sentence_of_point_status(view)}", PARAGRAPH_WIDTH)
        return
    axes.set_xlim(0, float(variables["F_end"]))
    draw_class_bar(axes, view, 0, is_vertical=False)
    force = results.units.force
    mark_thresholds_on_bars(
        axes, view, is_vertical=False, unit=force.name, factor=force.factor_from_dimensionless
    )


def _draw_branches(upper: Axes, lower: Axes, results: RodResults) -> None:
    """Draws the branches of cycles, the ranges with two stable states, and marks of the cycles whose shapes
    are drawn. Without branches, the upper panel states the reason."""
    rod = results.branches
    if rod is None or not _has_branches(results):
        lower.set_axis_off()
        reason = results.missing_result_reasons.get("branch", "no branch of cycles begins in this range")
        _write_sentence(upper, reason, PARAGRAPH_WIDTH)
        return
    add_stability_entries(upper, rod.curves)
    draw_branch_curves(upper, lower, rod.curves, BRANCH_COLOURS)
    draw_straight_rod(upper, rod)
    bands = ((rod.coexistence_ranges, COEXISTENCE_LOOK), (rod.two_stable_cycle_ranges, TWO_CYCLES_LOOK))
    for ranges, (colour, label) in () if rod.hidden_count else bands:
        for ends in ranges:
            upper.axvspan(*ends, color=colour, alpha=0.25, lw=0, label=label)
    cycles = [(F, view.point_values(0)) for F, view in results.cycles if _has_cycle(view)]
    look: dict[str, Any] = {"color": "k", "ms": 9, "mec": "white", "mew": 0.6, "label": CYCLE_LEGEND_ENTRY}
    for axes, name in ((upper, "tip_y_max"), (lower, "period")) if cycles else ():
        axes.plot([F for F, _ in cycles], [float(stored[name]) for _, stored in cycles], "*", **look)
    upper.tick_params(labelbottom=False)
    force, y, period = results.units.panel_axis_labels
    upper.set_ylabel(y)
    lower.set(ylabel=period, xlabel=force, yscale="log")


def _draw_mode(axes: Axes, results: RodResults, kind: str) -> None:
    """Draws the deflection of the leading mode at the first threshold of the given kind."""
    if kind not in results.modes_at_first_thresholds:
        _write_sentence(axes, f"no mode: {results.missing_result_reasons['modes']}", PANEL_TEXT_WIDTH)
        return
    F, view = results.modes_at_first_thresholds[kind]
    variables = view.point_values(0)
    axes.set_title(results.units.mode_title(kind, F))
    if not np.isfinite(variables["Y_real"][0]).all():
        _write_sentence(axes, f"no mode: {_sentence_of_point_status(view)}", PANEL_TEXT_WIDTH)
        return
    smallest = MIN_DRAWN_IMAGINARY_FRACTION * np.abs(variables["Y_real"][0]).max()
    for name, line, label in (("Y_real", "-", "Re"), ("Y_imag", ":", "Im")):
        if np.abs(variables[name][0]).max() > smallest:
            axes.plot(view.variables["u"], variables[name][0], line, color=style.BLUE, lw=1.5, label=label)
    axes.axhline(0, color="0.8", lw=0.6, zorder=0)
    axes.set(xlabel="$u/L$", ylabel="$Y_1$", xlim=(0, 1))
    axes.legend(frameon=False, loc="upper left", fontsize=7, handlelength=1.2, borderpad=0)


def _draw_cycles(panels: Sequence[Axes], results: RodResults) -> None:
    """Draws the shapes of up to three cycles on a common scale; later shapes of a period are darker."""
    if not results.cycles:
        for axes in panels[1:]:
            axes.set_axis_off()
        _write_sentence(
            panels[0], f"no cycle: {results.missing_result_reasons['limit_cycle']}", PANEL_TEXT_WIDTH
        )
        return
    cycles = [view.point_values(0) for _, view in results.cycles if _has_cycle(view)]
    units = results.units
    length = units.length.factor_from_dimensionless
    max_y = max((float(np.abs(stored["shape_y"]).max()) for stored in cycles), default=0.0) + ARROW_LENGTH
    for axes, (F, view) in zip(panels, results.cycles, strict=True):
        stored = view.point_values(0)
        force = units.load_title(F)
        if not _has_cycle(view):
            axes.set_title(force)
            _write_sentence(axes, f"no cycle: {_sentence_of_point_status(view)}", PANEL_TEXT_WIDTH)
            continue
        shapes = length * stored["shape_x"], length * stored["shape_y"], stored["shape_theta"]
        draw_shapes(axes, shapes, shades_of_shapes(len(shapes[0])), length, lw=1.3)
        period = units.time.text(float(stored["period"]), float(stored["period"] * stored["period_error"]))
        axes.set_title(f"{force}\n$T$ = {period}".replace("tau2", r"$\tau_2$"))
        ends = length * np.array([-0.1, 1 + ARROW_LENGTH])
        axes.set(xlim=ends, ylim=(-length * max_y, length * max_y), aspect="equal")
        axes.set(
            xlabel=units.coordinate_label("x"),
            ylabel=units.coordinate_label("y") if axes is panels[0] else "",
        )
        axes.tick_params(labelleft=axes is panels[0])


def _has_cycle(view: ResultView) -> bool:
    """Whether the only point in `view` has a cycle."""
    return bool(view.has_status(*STATUS_NAMES_WITH_CYCLE).all())


def _sentence_of_point_status(view: ResultView) -> str:
    """Meaning of the status of the only point in `view`."""
    word = str(view.status_names[0])
    return view.status_sentences.get(word, word)


def _write_sentence(axes: Axes, sentence: str, width: int) -> None:
    """Writes a sentence into an empty panel, in lines of `width` characters."""
    axes.set_axis_off()
    text = style.escape_dollar_signs(textwrap.fill(f"{sentence[:1].upper()}{sentence[1:]}.", width))
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", fontsize=8)
