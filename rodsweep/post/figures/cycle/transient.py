"""The tip from the start on, as on the right of the paper's Fig. 5: how the beating emerges, or does not."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ....results.file.view import View
from ..style import FIRST, SECOND
from .selection import CYCLE_WORDS, TRACE, StoredCycle, chosen_traces
from .units import CycleUnits

LEVEL: dict[str, Any] = {"color": "0.55", "lw": 0.8, "ls": (0, (4, 2)), "zorder": 1}
"""The look of the extrema of the cycle that the motion comes to."""


def draw_transients(view: View, points: Sequence[int], narrow: bool = False) -> tuple[Figure, str]:
    """A column for each point, cycle or not: x and y of the tip against time, and the cycle's extrema.

    narrow: whether the columns have no room for the words about extrema.
    """
    selection = chosen_traces(view, points)
    count = len(selection.cycles)
    figure = Figure(figsize=(4.2 * count + 1.6, 5.0), layout="constrained")
    rows = figure.subplots(2, count, squeeze=False, sharex="col", sharey="row")
    for (upper, lower), cycle in zip(rows.T, selection.cycles, strict=True):
        draw_emergence(upper, lower, cycle)
        ends = [cycle.word.replace("_", " ")]
        if cycle.word in CYCLE_WORDS:
            ends[0] += "" if narrow else " (extrema dashed)"
            ends.append(cycle.period_text)
        upper.set_title(cycle.heading(*ends))
    label_tip(rows[0, 0], rows[1, 0], selection.cycles[0].units)
    figure.align_ylabels(rows[:, 0])
    figure.suptitle(selection.title)
    return figure, "the tip from the start on" + selection.left_out


def draw_emergence(upper: Axes, lower: Axes, cycle: StoredCycle) -> None:
    """x and y of the tip from the start on, with the extrema of the cycle where there is one."""
    time, *tip = (cycle.values[name] for name in TRACE)
    v = cycle.values
    levels = (("tip_x_min", 1), ("tip_x_max", 1)), (("tip_y_max", 1), ("tip_y_max", -1))
    for axes, values, colour, pair in zip((upper, lower), tip, (FIRST, SECOND), levels, strict=True):
        axes.plot(time, values, color=colour, lw=1.1)
        for name, sign in pair if cycle.word in CYCLE_WORDS else ():
            axes.axhline(sign * float(v[name]), **LEVEL)
        axes.margins(x=0)
    label_time(upper, lower, cycle)


def label_tip(upper: Axes, lower: Axes, units: CycleUnits) -> None:
    """What the two panels show, in the colours of their lines."""
    upper.set_ylabel("tip " + units.along("x"), color=FIRST)
    lower.set_ylabel("tip " + units.along("y"), color=SECOND)


def label_time(upper: Axes, lower: Axes, cycle: StoredCycle) -> None:
    """The time in the cycle's unit below, and in the paper's tau1 above where there is one."""
    tau1 = cycle.tau1
    upper.tick_params(labelbottom=False)
    lower.axhline(0, color="0.8", lw=0.6, zorder=0)
    lower.set_xlabel(cycle.units.time_label)
    if 0 < tau1 < np.inf:
        top = upper.secondary_xaxis(
            "top", functions=(lambda t: np.asarray(t) / tau1, lambda t: np.asarray(t) * tau1)
        )
        top.set_xlabel(r"time $t/\tau_1$")
