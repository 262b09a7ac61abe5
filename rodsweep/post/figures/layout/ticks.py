"""Labels of ticks on a laid out figure: fewer of them where they run into each other."""

from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import FixedLocator, LogLocator, MaxNLocator, SymmetricalLogLocator

BLANK = 0.25
"""Space between the labels of two ticks beside each other, in units of their height."""
SEEN = 1e-9
"""Length of an axis by which a tick at its end may lie outside by rounding."""


def thin_ticks(figure: Figure) -> bool:
    """Takes labels away from axes on which they run into each other."""
    every = [*figure.axes, *(child for axes in figure.axes for child in axes.child_axes)]
    return any([_thin(axis, way) for axes in every for axis, way in ((axes.xaxis, 0), (axes.yaxis, 1))])


def labels_in_sight(axis: Axis) -> list[Text]:
    """The labels of the ticks within the limits of an axis."""
    low, high = sorted(axis.get_view_interval())
    near = SEEN * (high - low)
    return [
        label
        for place, label in zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=False)
        if label.get_visible() and label.get_text() and low - near <= place <= high + near
    ]


def _thin(axis: Axis, way: int) -> bool:
    """Fewer labels on an axis where two of them meet; way: 0 for a horizontal axis, 1 for a vertical one."""
    shown = labels_in_sight(axis)
    boxes = [label.get_window_extent() for label in shown]
    spans = sorted(tuple(box.intervaly if way else box.intervalx) for box in boxes)
    least = 0.0 if way else BLANK * max((box.height for box in boxes), default=0.0)
    if all(later[0] - earlier[1] >= least for earlier, later in zip(spans[:-1], spans[1:], strict=True)):
        return False
    locator = axis.get_major_locator()
    if isinstance(locator, FixedLocator):
        ticks, texts = axis.get_majorticklocs(), [label.get_text() for label in axis.get_majorticklabels()]
        axis.set_ticks(ticks[::2], texts[::2])
        return True
    if isinstance(locator, LogLocator):
        return _thin_decades(axis, locator)
    if isinstance(locator, SymmetricalLogLocator):
        return _thin_powers(axis, len(shown))
    if isinstance(locator, MaxNLocator) and len(shown) > 2:
        axis.set_major_locator(MaxNLocator(max(len(shown) - 2, 1), steps=[1, 2, 2.5, 5, 10]))
        return True
    return False


def _thin_powers(axis: Axis, shown: int) -> bool:
    """Fewer powers of ten on an axis that is logarithmic but near 0, of which so many are shown."""
    start = getattr(axis.get_transform(), "linthresh", None)
    if start is None:
        return False
    for powers in (2, 3, 4, 6):
        axis.set_major_locator(SymmetricalLogLocator(base=10.0**powers, linthresh=10 * start))
        if len(labels_in_sight(axis)) < shown:
            return True
    return False


def _thin_decades(axis: Axis, locator: LogLocator) -> bool:
    """Fewer of the labels within a decade: 1 and 3, then 1 alone, so long as two are left."""
    low, high = sorted(axis.get_view_interval())
    for subs in ((1.0, 3.0), (1.0,), (2.0,)):
        if len(subs) >= len(getattr(locator, "_subs", None) or ()):
            continue
        there = [tick for tick in LogLocator(subs=subs).tick_values(low, high) if low <= tick <= high]
        if len(there) >= 2:
            axis.set_major_locator(LogLocator(subs=subs))
            return True
    return False
