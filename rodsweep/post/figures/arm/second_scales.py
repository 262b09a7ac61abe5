"""A second scale for axes of the follower force F and of the shear stiffness k2, in figures of an arm.

If all points belong to one arm, F corresponds to a pressure or a force at the tip of this arm, and k2 to a
Poisson's ratio if the ratio varies. The second scale of a linear or logarithmic axis is on the opposite side
of the panel.
"""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, MaxNLocator, NullLocator

from ....model.arm.quantities import SCALE_NAMES, UNITS
from ....results.file.view import ResultView
from ..style import CRITICAL_FORCE_LABEL, LABELS
from .quantities import shear_stiffness

SUPPORTED_AXIS_SCALES = ("linear", "log")
"""Scales of an axis for which matplotlib places the ticks of a second scale correctly."""
MAX_TICK_INTERVALS = 5
"""Largest number of intervals between the ticks of the second scale."""
TICK_ROUNDING_TOLERANCE = 1e-9
"""Relative rounding error of k2 at a tick of Poisson's ratio."""
LOAD_WORDS = {"pressure": "pressure on the tip", "force": "force at the tip"}
"""Label of the second scale, by kind of load."""


def add_arm_scales(figure: Figure, views: Sequence[ResultView]) -> None:
    """Adds a scale in SI units to every axis of the follower force, if all files belong to one arm, and a
    scale of Poisson's ratio to every axis of k2, if the ratio varies in a single file."""
    if len(views) == 1:
        _add_poisson_scales(figure, views[0])
    _add_si_scales(figure, views)


def _add_si_scales(figure: Figure, views: Sequence[ResultView]) -> None:
    """Adds a scale in SI units to every axis of the follower force, if all files belong to one arm."""
    load_word = "force" if all(view.load_kind == "force" for view in views) else "pressure"
    factors = [view.quantities.get(SCALE_NAMES[load_word]) for view in views]
    units = {float(unit) for values in factors if values is not None for unit in np.ravel(values)}
    if len(units) != 1 or any(values is None for values in factors):
        return
    (unit,) = units
    for axes in list(figure.axes):
        for letter in ("x", "y"):
            label, scale = (getattr(axes, f"get_{letter}{what}")() for what in ("label", "scale"))
            if label in (LABELS["F"], CRITICAL_FORCE_LABEL) and scale in SUPPORTED_AXIS_SCALES:
                _add_second_scale(_outermost_panel(axes, letter), letter, unit, load_word)


def _add_poisson_scales(figure: Figure, view: ResultView) -> None:
    """Adds a scale of Poisson's ratio to every axis of k2, if k2 varies in the file with the ratio only."""
    ratios = np.ravel(view.quantities.get("poisson", ()))
    stiffnesses = np.ravel(view.parameter_values.get("k2", ()))
    if not view.is_grid or len(ratios) < 2 or len(ratios) != len(stiffnesses):
        return
    for axes in list(figure.axes):
        for letter in ("x", "y"):
            if getattr(axes, f"get_{letter}label")() != LABELS["k2"]:
                continue
            panel = _outermost_panel(axes, letter)
            limits = sorted(getattr(panel, f"get_{letter}lim")())
            ticks = MaxNLocator(MAX_TICK_INTERVALS).tick_values(ratios.min(), ratios.max())
            ticks = ticks[(ticks >= ratios.min()) & (ticks <= ratios.max())]
            positions = np.array([shear_stiffness(view, float(ratio)) for ratio in ticks])
            # The ends of the range are drawn, whatever the rounding error.
            is_visible = (positions >= limits[0] * (1 - TICK_ROUNDING_TOLERANCE)) & (
                positions <= limits[1] * (1 + TICK_ROUNDING_TOLERANCE)
            )
            poisson_axis = _opposite_axis(panel, letter)
            poisson_axis.set(**{f"{letter}label": "Poisson's ratio"})
            texts = [f"{ratio:.4g}" for ratio in ticks[is_visible]]
            getattr(poisson_axis, f"set_{letter}ticks")(positions[is_visible], texts)
            getattr(poisson_axis, f"{letter}axis").set_minor_locator(NullLocator())


def _outermost_panel(axes: Axes, letter: str) -> Axes:
    """The top panel of the column (letter = "x") or the rightmost panel of the row (letter = "y") of `axes`,
    among the panels that share this axis with `axes`; `axes` itself if it is in no grid of panels."""
    shared_axes = axes.get_shared_x_axes() if letter == "x" else axes.get_shared_y_axes()
    grid_cell = axes.get_subplotspec()
    panels = [panel for panel in shared_axes.get_siblings(axes) if panel.get_subplotspec() is not None]
    if grid_cell is None or not panels:
        return axes
    if letter == "x":
        column = [panel for panel in panels if panel.get_subplotspec().colspan == grid_cell.colspan]
        return min(column, key=lambda panel: panel.get_subplotspec().rowspan.start)
    row = [panel for panel in panels if panel.get_subplotspec().rowspan == grid_cell.rowspan]
    return max(row, key=lambda panel: panel.get_subplotspec().colspan.start)


def _add_second_scale(axes: Axes, letter: str, unit: float, load_kind: str) -> None:
    """Adds a second scale to a panel, opposite to the axis `letter` ("x" or "y"). unit: load at F = 1, in SI
    units."""
    symbol = UNITS[load_kind][0]
    word = LOAD_WORDS[load_kind]
    largest_value = unit * max(map(abs, getattr(axes, f"get_{letter}lim")()))
    power = 3 * int(np.floor(np.log10(largest_value) / 3)) if largest_value > 0 else 0
    power = int(np.clip(power, min(EngFormatter.ENG_PREFIXES), max(EngFormatter.ENG_PREFIXES)))
    unit *= 10.0**-power
    symbol = EngFormatter.ENG_PREFIXES[power] + symbol
    functions = partial(np.multiply, unit), partial(np.multiply, 1 / unit)
    si_axis = _opposite_axis(axes, letter, functions=functions)
    si_axis.set(**{f"{letter}label": f"{word} ({symbol})"})
    getattr(si_axis, f"{letter}axis").set_major_locator(MaxNLocator(MAX_TICK_INTERVALS))


def _opposite_axis(panel: Axes, letter: str, **keywords: Any) -> Any:
    """New axis of a panel, opposite to the axis `letter`. keywords: keywords for matplotlib."""
    if letter == "x":
        return panel.secondary_xaxis("top", **keywords)
    return panel.secondary_yaxis("right", **keywords)
