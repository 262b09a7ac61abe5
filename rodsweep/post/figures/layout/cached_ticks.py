"""Cache of the ticks of axes, and of the boxes of tick labels, for each position of a panel.

To lay out a panel, matplotlib computes the ticks of each axis a dozen times: for the axis, the axis label,
the title and the spines. These computations take a quarter of the time of a layout.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from matplotlib.axis import Axis
from matplotlib.figure import Figure

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
