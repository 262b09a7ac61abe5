"""Ticks of a figure: labels removed where neighbours overlap, and a cache of ticks and boxes of tick labels
for each position of a panel."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import FixedLocator, LogLocator, MaxNLocator, SymmetricalLogLocator

CACHED_METHODS = ("_update_ticks", "_get_ticklabel_bboxes")
"""Methods of matplotlib's Axis that compute ticks and boxes. If a method is missing, the cache is not
used."""


@contextmanager
def cached_ticks(figure: Figure) -> Iterator[None]:
    """Context in which an axis of the figure computes its ticks again only after the panel or its limits have
    changed. Nothing except positions and limits of panels may change in this context. Without effect if
    matplotlib lacks a method in CACHED_METHODS."""
    panels = [panel for axes in figure.axes for panel in (axes, *axes.child_axes)]
    has_methods = all(hasattr(Axis, name) for name in CACHED_METHODS)
    cached_axes = [axis for panel in panels for axis in (panel.xaxis, panel.yaxis)] if has_methods else []
    for axis in cached_axes:
        for name, method in zip(CACHED_METHODS, _cached_methods(axis), strict=True):
            setattr(axis, name, method)
    try:
        yield
    finally:
        for axis in cached_axes:
            for name in CACHED_METHODS:
                delattr(axis, name)


def _cached_methods(axis: Any) -> tuple[Callable[[], list[Any]], Callable[[Sequence[Any], Any], Any]]:
    """Returns the two methods CACHED_METHODS of an axis with a cache for the last position of the panel."""
    find_ticks, measure_boxes = (getattr(axis, name) for name in CACHED_METHODS)
    latest: dict[str, Any] = {}

    def ticks() -> list[Any]:
        position = (*axis.axes.bbox.bounds, *axis.axes.viewLim.bounds)
        if latest.get("position") != position:
            latest.clear()
            latest.update(position=position, ticks=find_ticks())
        result: list[Any] = latest["ticks"]
        return result

    def boxes(of: Sequence[Any], renderer: Any) -> Any:
        if of is not ticks():
            return measure_boxes(of, renderer)
        if "boxes" not in latest:
            latest["boxes"] = measure_boxes(of, renderer)
        return latest["boxes"]

    return ticks, boxes


LABEL_GAP = 0.25
"""Smallest gap between neighbouring tick labels of a horizontal axis, divided by the height of the labels."""
EDGE_TOLERANCE = 1e-9
"""Rounding tolerance for a tick at the end of an axis, divided by the length of the axis."""


def thin_ticks(figure: Figure) -> bool:
    """Removes some tick labels, such as every second, from each axis whose labels overlap; returns whether
    any label was removed."""
    all_axes = [*figure.axes, *(inset for axes in figure.axes for inset in axes.child_axes)]
    return any(
        [
            _remove_overlapping_labels(axis, direction)
            for axes in all_axes
            for axis, direction in ((axes.xaxis, 0), (axes.yaxis, 1))
        ]
    )


def visible_labels(axis: Axis) -> list[Text]:
    """Visible tick labels within the limits of an axis."""
    low, high = sorted(axis.get_view_interval())
    margin = EDGE_TOLERANCE * (high - low)
    return [
        label
        for position, label in zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=False)
        if label.get_visible() and label.get_text() and low - margin <= position <= high + margin
    ]


def _remove_overlapping_labels(axis: Axis, direction: int) -> bool:
    """Removes some tick labels of an axis, such as every second, if its labels overlap; returns whether any
    label was removed. direction: 0 for a horizontal axis, 1 for a vertical axis."""
    labels = visible_labels(axis)
    boxes = [label.get_window_extent() for label in labels]
    extents = sorted(tuple(box.intervaly if direction else box.intervalx) for box in boxes)
    min_gap = 0.0 if direction else LABEL_GAP * max((box.height for box in boxes), default=0.0)
    if all(
        following[0] - previous[1] >= min_gap
        for previous, following in zip(extents[:-1], extents[1:], strict=True)
    ):
        return False
    locator = axis.get_major_locator()
    if isinstance(locator, FixedLocator):
        ticks = axis.get_majorticklocs()
        texts = [label.get_text() for label in axis.get_majorticklabels()]
        axis.set_ticks(ticks[::2], texts[::2])
        return True
    if isinstance(locator, LogLocator):
        return _thin_labels_within_decades(axis, locator)
    if isinstance(locator, SymmetricalLogLocator):
        return _thin_powers(axis, len(labels))
    if isinstance(locator, MaxNLocator) and len(labels) > 2:
        axis.set_major_locator(MaxNLocator(max(len(labels) - 2, 1), steps=[1, 2, 2.5, 5, 10]))
        return True
    return False


def _thin_powers(axis: Axis, label_count: int) -> bool:
    """Removes labelled powers of ten from a symmetric logarithmic axis; returns whether any label was
    removed."""
    start = getattr(axis.get_transform(), "linthresh", None)
    if start is None:
        return False
    for decade_step in (2, 3, 4, 6):
        axis.set_major_locator(SymmetricalLogLocator(base=10.0**decade_step, linthresh=10 * start))
        if len(visible_labels(axis)) < label_count:
            return True
    return False


def _thin_labels_within_decades(axis: Axis, locator: LogLocator) -> bool:
    """Reduces the labelled numbers of each decade to 1 and 3, only 1, or only 2; returns whether labels were
    removed."""
    low, high = sorted(axis.get_view_interval())
    labelled = getattr(locator, "_subs", None)
    max_labels = 0 if labelled is None or isinstance(labelled, str) else len(labelled)
    for multiples in ((1.0, 3.0), (1.0,), (2.0,)):
        if len(multiples) >= max_labels:
            continue
        ticks = [tick for tick in LogLocator(subs=multiples).tick_values(low, high) if low <= tick <= high]
        if len(ticks) >= 2:
            axis.set_major_locator(LogLocator(subs=multiples))
            return True
    return False
