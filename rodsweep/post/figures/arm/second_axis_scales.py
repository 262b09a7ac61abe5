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
from matplotlib.ticker import MaxNLocator, NullLocator

from ....model.arm.quantities import LOAD_SCALE_NAME_BY_LOAD, UNITS_AND_EXAMPLES
from ....model.units import with_si_prefix
from ....results.file.view import ResultView
from ..style import AXIS_LABELS, CRITICAL_FORCE_LABEL
from .quantities import k2_at_poisson_ratio

SUPPORTED_AXIS_SCALES = ("linear", "log")
"""Scales of an axis for which matplotlib places the ticks of a second scale correctly."""
MAX_TICK_INTERVALS = 5
"""Largest number of intervals between the ticks of the second scale."""
RELATIVE_K2_TICK_ROUNDING = 1e-9
"""A tick of Poisson's ratio is drawn if its k2 lies beyond the axis by at most this relative amount."""
LOAD_SCALE_LABEL_BY_LOAD_KIND = {"pressure": "pressure on the tip", "force": "force at the tip"}
"""Label of the second scale, by kind of load."""


def add_arm_scales(figure: Figure, views: Sequence[ResultView]) -> None:
    """Adds a scale in SI units to every axis of the follower force, if all files belong to one arm, and a
    scale of Poisson's ratio to every axis of k2, if the ratio varies in a single file."""
    load_kind = "force" if all(view.load_kind == "force" for view in views) else "pressure"
    scales = [np.ravel(view.quantities.get(LOAD_SCALE_NAME_BY_LOAD[load_kind], np.nan)) for view in views]
    load_scales = np.unique(np.concatenate(scales))
    for axes in list(figure.axes):
        for letter in ("x", "y"):
            label, scale = (getattr(axes, f"get_{letter}{what}")() for what in ("label", "scale"))
            is_force = label in (AXIS_LABELS["F"], CRITICAL_FORCE_LABEL) and scale in SUPPORTED_AXIS_SCALES
            panel = _outermost_panel(axes, letter)
            if is_force and load_scales.size == 1 and np.isfinite(load_scales[0]):
                _add_load_scale(panel, letter, float(load_scales[0]), load_kind)
            if label == AXIS_LABELS["k2"] and len(views) == 1 and _is_k2_varied_by_poisson_only(views[0]):
                _add_poisson_scale(panel, letter, views[0])


def _is_k2_varied_by_poisson_only(view: ResultView) -> bool:
    """Whether the points form a grid in which k2 varies only because Poisson's ratio varies."""
    ratio_count = np.size(view.quantities.get("poisson", ()))
    return view.is_grid and ratio_count > 1 and ratio_count == np.size(view.parameter_values.get("k2", ()))


def _add_poisson_scale(panel: Axes, letter: str, view: ResultView) -> None:
    """Adds a scale of Poisson's ratio to a panel, opposite to the axis `letter` of k2."""
    ratios = np.ravel(view.quantities["poisson"])
    ticks = MaxNLocator(MAX_TICK_INTERVALS).tick_values(ratios.min(), ratios.max())
    ticks = ticks[(ticks >= ratios.min()) & (ticks <= ratios.max())]
    positions = np.array([k2_at_poisson_ratio(view, float(ratio)) for ratio in ticks])
    # Ticks beyond the drawn range would widen the axis; rounding moves ticks at the ends of the range.
    low, high = sorted(getattr(panel, f"get_{letter}lim")())
    margin = RELATIVE_K2_TICK_ROUNDING * abs(positions)
    is_visible = (positions >= low - margin) & (positions <= high + margin)
    axis = _opposite_axis(panel, letter, "Poisson's ratio")
    axis.set_ticks(positions[is_visible], [f"{ratio:.4g}" for ratio in ticks[is_visible]])
    axis.set_minor_locator(NullLocator())


def _outermost_panel(axes: Axes, letter: str) -> Axes:
    """The top panel of the column (letter = "x") or the rightmost panel of the row (letter = "y") of `axes`,
    among the panels that share this axis with `axes`."""
    sharing = axes.get_shared_x_axes() if letter == "x" else axes.get_shared_y_axes()
    own_place = axes.get_position(original=True)
    places = {panel: panel.get_position(original=True) for panel in sharing.get_siblings(axes)}
    if letter == "x":
        return max(
            (panel for panel in places if places[panel].x0 == own_place.x0), key=lambda p: places[p].y0
        )
    return max((panel for panel in places if places[panel].y0 == own_place.y0), key=lambda p: places[p].x0)


def _add_load_scale(panel: Axes, letter: str, unit: float, load_kind: str) -> None:
    """Adds a scale of the load to a panel, opposite to the axis `letter` of the follower force. unit: load at
    F = 1, in SI units."""
    largest_load = unit * max(map(abs, getattr(panel, f"get_{letter}lim")()))
    factor, symbol = with_si_prefix(largest_load, UNITS_AND_EXAMPLES[load_kind][0])
    functions = partial(np.multiply, unit * factor), partial(np.multiply, 1 / (unit * factor))
    axis = _opposite_axis(panel, letter, f"{LOAD_SCALE_LABEL_BY_LOAD_KIND[load_kind]} ({symbol})", functions)
    axis.set_major_locator(MaxNLocator(MAX_TICK_INTERVALS))


def _opposite_axis(panel: Axes, letter: str, label: str, functions: Any = None) -> Any:
    """New axis of a panel, opposite to the axis `letter`. functions: (function, inverse) that convert values
    on the axis `letter` to values on the new axis, and back; None if both values are equal."""
    is_x = letter == "x"
    new_axes: Any = (
        panel.secondary_xaxis("top", functions=functions)
        if is_x
        else panel.secondary_yaxis("right", functions=functions)
    )
    axis = new_axes.xaxis if is_x else new_axes.yaxis
    axis.set_label_text(label)
    return axis
