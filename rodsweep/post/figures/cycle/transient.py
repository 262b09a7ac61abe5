"""Motion of the tip from the initial state, as at the right of the paper's Fig. 5."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ....results.file.view import ResultView
from ....results.layouts.limit_cycle import STATUS_NAMES_WITH_CYCLE
from ..style import BLUE, VERMILION
from .selection import TRANSIENT_VARIABLE_NAMES, StoredCycle, chosen_transients
from .units_and_labels import CycleUnits

EXTREMUM_LINE_LOOK: dict[str, Any] = {"color": "0.55", "lw": 0.8, "ls": (0, (4, 2)), "zorder": 1}
"""Line style of horizontal lines at the extrema of the cycle that the motion approaches."""


def draw_transients(view: ResultView, points: Sequence[int], is_narrow: bool = False) -> tuple[Figure, str]:
    """Returns (figure, description). The figure has a column for each point: x and y of the tip against time,
    with horizontal lines at the extrema of the cycle, if any.

    is_narrow: whether the titles leave out the explanation of these lines.
    """
    selection = chosen_transients(view, points)
    motion_count = len(selection.cycles)
    figure = Figure(figsize=(4.2 * motion_count + 1.6, 5.0), layout="constrained")
    panel_rows = figure.subplots(2, motion_count, squeeze=False, sharex="col", sharey="row")
    for (upper, lower), cycle in zip(panel_rows.T, selection.cycles, strict=True):
        draw_start_of_motion(upper, lower, cycle)
        ends = [cycle.status_name.replace("_", " ")]
        if cycle.status_name in STATUS_NAMES_WITH_CYCLE:
            ends[0] += "" if is_narrow else " (extrema dashed)"
            ends.append(cycle.period_text)
        upper.set_title(cycle.heading(*ends))
    label_tip_axes(panel_rows[0, 0], panel_rows[1, 0], selection.cycles[0].units)
    figure.align_ylabels(panel_rows[:, 0])
    figure.suptitle(selection.title)
    return figure, "the tip from the start on" + selection.omissions_clause


def draw_start_of_motion(upper: Axes, lower: Axes, cycle: StoredCycle) -> None:
    """Draws x (upper panel) and y (lower panel) of the tip from the initial state on, with horizontal lines
    at the extrema of the cycle, if any."""
    time, *tip_values = (cycle.values[name] for name in TRANSIENT_VARIABLE_NAMES)
    cycle_values = cycle.values
    levels = (("tip_x_min", 1), ("tip_x_max", 1)), (("tip_y_max", 1), ("tip_y_max", -1))
    for axes, values, colour, extrema in zip(
        (upper, lower), tip_values, (BLUE, VERMILION), levels, strict=True
    ):
        axes.plot(time, values, color=colour, lw=1.1)
        for name, sign in extrema if cycle.status_name in STATUS_NAMES_WITH_CYCLE else ():
            axes.axhline(sign * float(cycle_values[name]), **EXTREMUM_LINE_LOOK)
        axes.margins(x=0)
    label_time_axes(upper, lower, cycle)


def label_tip_axes(upper: Axes, lower: Axes, units: CycleUnits) -> None:
    """Labels the vertical axes of the panels with x (upper) and y (lower) of the tip, in the colours of the
    curves."""
    upper.set_ylabel("tip " + units.axis_label("x"), color=BLUE)
    lower.set_ylabel("tip " + units.axis_label("y"), color=VERMILION)


def label_time_axes(upper: Axes, lower: Axes, cycle: StoredCycle) -> None:
    """Labels the time at the bottom of the panel `lower`, in the unit of the cycle. If the rod has the time
    scale tau1, adds an axis with the time in tau1 at the top of the panel `upper`."""
    tau1 = cycle.tau1
    upper.tick_params(labelbottom=False)
    lower.axhline(0, color="0.8", lw=0.6, zorder=0)
    lower.set_xlabel(cycle.units.time_label)
    if 0 < tau1 < np.inf:
        scales = (lambda t: np.asarray(t) / tau1, lambda t: np.asarray(t) * tau1)
        tau1_axis = upper.secondary_xaxis("top", functions=scales)
        tau1_axis.set_xlabel(r"time $t/\tau_1$")
