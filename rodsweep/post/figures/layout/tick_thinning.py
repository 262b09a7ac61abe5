"""Tick labels of a figure: some are removed where neighbours overlap."""

import numpy as np
from matplotlib.axis import Axis, XAxis
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import FixedFormatter, FixedLocator

from ....arrays import Array, list_of

MIN_LABEL_GAP_OVER_HEIGHT = 0.25
"""Smallest gap between neighbouring tick labels of a horizontal axis, divided by the height of the labels."""
EDGE_TOLERANCE = 1e-9
"""Rounding tolerance for a tick at the end of an axis, divided by the length of the axis; and for the decimal
logarithm of a power of ten."""


def thin_ticks(figure: Figure) -> bool:
    """Removes some tick labels, such as every second, from each axis whose labels overlap; returns whether
    any label was removed."""
    panels = [*figure.axes, *(inset for axes in figure.axes for inset in axes.child_axes)]
    return any([_thin_ticks_of_axis(axis) for panel in panels for axis in (panel.xaxis, panel.yaxis)])


def visible_labels(axis: Axis) -> list[Text]:
    """Visible tick labels within the limits of an axis."""
    return [label for _, label in _visible_ticks(axis)]


def _visible_ticks(axis: Axis) -> list[tuple[float, Text]]:
    """(position, label) of each visible tick with a label within the limits of an axis."""
    low, high = sorted(axis.get_view_interval())
    margin = EDGE_TOLERANCE * (high - low)
    return [
        (float(position), label)
        for position, label in zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=False)
        if label.get_visible() and label.get_text() and low - margin <= position <= high + margin
    ]


def _thin_ticks_of_axis(axis: Axis) -> bool:
    """Removes some labelled ticks of an axis if their labels overlap; returns whether any was removed."""
    ticks = _visible_ticks(axis)
    if len(ticks) < 2:
        return False
    boxes = [label.get_window_extent() for _, label in ticks]
    is_horizontal = isinstance(axis, XAxis)
    extents = np.array([box.intervalx if is_horizontal else box.intervaly for box in boxes])
    starts, ends = extents[extents[:, 0].argsort()].T
    min_gap = MIN_LABEL_GAP_OVER_HEIGHT * max(box.height for box in boxes) if is_horizontal else 0.0
    if (starts[1:] - ends[:-1] >= min_gap).all():
        return False
    kept = _positions_of_kept_ticks(np.array([position for position, _ in ticks]), axis.get_scale() == "log")
    if isinstance(axis.get_major_formatter(), FixedFormatter):
        axis.set_ticks(kept, [label.get_text() for position, label in ticks if position in kept])
    else:
        axis.set_major_locator(FixedLocator(list_of(kept)))
    return True


def _positions_of_kept_ticks(positions: Array, is_logarithmic: bool) -> Array:
    """Positions, (m,), of the ticks that stay. On a logarithmic axis: the powers of ten, if there are at
    least two powers of ten and also other ticks. Otherwise: every second tick, with 0 if 0 is a tick.
    positions: positions of all ticks, (n,)."""
    if is_logarithmic:
        exponents = np.log10(positions)
        is_power = np.abs(exponents - exponents.round()) < EDGE_TOLERANCE
        if 2 <= is_power.sum() < len(positions):
            return np.asarray(positions[is_power])
    zeros = np.flatnonzero(positions == 0)
    return np.asarray(positions[zeros[0] % 2 if zeros.size else 0 :: 2])
