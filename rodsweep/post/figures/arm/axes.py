"""A second scale for axes of the follower force F and of the shear stiffness k2, in figures of an arm.

If all points belong to one arm, F corresponds to a pressure or a force at the tip of this arm, and k2 to a
Poisson's ratio if the ratio varies. The second scale of a linear or logarithmic axis is on the opposite side
of the panel.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, MaxNLocator, NullLocator

from ....model.arm.quantities import SCALE_NAME, UNITS
from ....results.file.view import View
from ..style import CRITICAL_FORCE_LABEL, LABELS
from .quantities import shear_stiffness

SCALES_WITH_SECOND_AXIS = ("linear", "log")
"""Scales of an axis for which matplotlib places the ticks of a second scale correctly."""
MAX_TICK_INTERVALS = 5
"""Largest number of intervals between the ticks of the second scale."""
ROUNDING = 1e-9
"""Relative rounding error of k2 at a tick of Poisson's ratio."""
LOAD_WORDS = {"pressure": "pressure on the tip", "force": "force at the tip"}
"""Label of the second scale, by kind of load."""


def add_arm_scales(figure: Figure, views: Sequence[View]) -> None:
    """Adds a scale in SI units to every axis of the follower force, if all files belong to one arm, and a
    scale of Poisson's ratio to every axis of k2, if the ratio varies in a single file."""
    if len(views) == 1:
        _add_poisson_scales(figure, views[0])
    _add_si_scales(figure, views)


def _add_si_scales(figure: Figure, views: Sequence[View]) -> None:
    """Adds a scale in SI units to every axis of the follower force, if all files belong to one arm."""
    load = "force" if all(view.load_kind == "force" for view in views) else "pressure"
    given = [view.quantities.get(SCALE_NAME[load]) for view in views]
    units = {float(unit) for values in given if values is not None for unit in np.ravel(values)}
    if len(units) != 1 or any(values is None for values in given):
        return
    (unit,) = units
    for axes in list(figure.axes):
        for which in ("x", "y"):
            label, scale = (getattr(axes, f"get_{which}{what}")() for what in ("label", "scale"))
            if label in (LABELS["F"], CRITICAL_FORCE_LABEL) and scale in SCALES_WITH_SECOND_AXIS:
                _add_second_scale(_outermost_panel(axes, which), which, unit, load)


def _add_poisson_scales(figure: Figure, view: View) -> None:
    """Adds a scale of Poisson's ratio to every axis of k2, if k2 varies in the file with the ratio only."""
    ratios = np.ravel(view.quantities.get("poisson", ()))
    stiffnesses = np.ravel(view.parameter_values.get("k2", ()))
    if not view.is_grid or len(ratios) < 2 or len(ratios) != len(stiffnesses):
        return
    for axes in list(figure.axes):
        for which in ("x", "y"):
            if getattr(axes, f"get_{which}label")() != LABELS["k2"]:
                continue
            panel = _outermost_panel(axes, which)
            limits = sorted(getattr(panel, f"get_{which}lim")())
            inside = MaxNLocator(MAX_TICK_INTERVALS).tick_values(ratios.min(), ratios.max())
            inside = inside[(inside >= ratios.min()) & (inside <= ratios.max())]
            at = np.array([shear_stiffness(view, float(ratio)) for ratio in inside])
            # The ends of the range are drawn, whatever the rounding error.
            shown = (at >= limits[0] * (1 - ROUNDING)) & (at <= limits[1] * (1 + ROUNDING))
            second = panel.secondary_xaxis("top") if which == "x" else panel.secondary_yaxis("right")
            getattr(second, f"set_{which}label")("Poisson's ratio")
            texts = [f"{ratio:.4g}" for ratio in inside[shown]]
            getattr(second, f"set_{which}ticks")(at[shown], texts)
            getattr(second, f"{which}axis").set_minor_locator(NullLocator())


def _outermost_panel(axes: Axes, which: str) -> Axes:
    """The top panel of the column (which = "x") or the rightmost panel of the row (which = "y") of `axes`,
    among the panels that share this axis with `axes`; `axes` itself if it is in no grid of panels."""
    shared = axes.get_shared_x_axes() if which == "x" else axes.get_shared_y_axes()
    grid_cell = axes.get_subplotspec()
    panels = [other for other in shared.get_siblings(axes) if other.get_subplotspec() is not None]
    if grid_cell is None or not panels:
        return axes
    if which == "x":
        column = [other for other in panels if other.get_subplotspec().colspan == grid_cell.colspan]
        return min(column, key=lambda other: other.get_subplotspec().rowspan.start)
    row = [other for other in panels if other.get_subplotspec().rowspan == grid_cell.rowspan]
    return max(row, key=lambda other: other.get_subplotspec().colspan.start)


def _add_second_scale(axes: Axes, which: str, unit: float, load: str) -> None:
    """Adds a second scale to a panel, opposite to the axis `which` ("x" or "y"). unit: load at F = 1, in SI
    units. load: kind of load.
    """
    symbol = UNITS[load][0]
    word = LOAD_WORDS[load]
    largest = unit * max(map(abs, getattr(axes, f"get_{which}lim")()))
    power = 3 * int(np.floor(np.log10(largest) / 3)) if largest > 0 else 0
    power = int(np.clip(power, min(EngFormatter.ENG_PREFIXES), max(EngFormatter.ENG_PREFIXES)))
    unit *= 10.0**-power
    symbol = EngFormatter.ENG_PREFIXES[power] + symbol
    functions = partial(np.multiply, unit), partial(np.multiply, 1 / unit)
    if which == "x":
        second = axes.secondary_xaxis("top", functions=functions)
        second.set_xlabel(f"{word} ({symbol})")
    else:
        second = axes.secondary_yaxis("right", functions=functions)
        second.set_ylabel(f"{word} ({symbol})")
    getattr(second, f"{which}axis").set_major_locator(MaxNLocator(MAX_TICK_INTERVALS))
