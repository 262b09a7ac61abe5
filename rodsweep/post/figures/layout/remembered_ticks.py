"""Ticks and boxes of their labels, found once for each position of a panel.

To lay out a panel, matplotlib finds the ticks of each axis a dozen times: for the axis, its label, the title
and the spines. Finding the ticks takes a quarter of the time of a layout.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from matplotlib.axis import Axis
from matplotlib.figure import Figure

FOUND_BY = ("_update_ticks", "_get_ticklabel_bboxes")
"""Methods of matplotlib's axes that find ticks and boxes. Without them nothing is remembered."""


@contextmanager
def remembered_ticks(figure: Figure) -> Iterator[None]:
    """Within the context each axis of the figure finds its ticks anew only once the panel has moved.

    Nothing but the positions and limits of panels may change within the context.
    """
    panels = [panel for axes in figure.axes for panel in (axes, *axes.child_axes)]
    known = all(hasattr(Axis, name) for name in FOUND_BY)
    held = [axis for panel in panels for axis in (panel.xaxis, panel.yaxis)] if known else []
    for axis in held:
        for name, method in zip(FOUND_BY, _remembering(axis), strict=True):
            setattr(axis, name, method)
    try:
        yield
    finally:
        for axis in held:
            for name in FOUND_BY:
                delattr(axis, name)


def _remembering(axis: Any) -> tuple[Callable[[], list[Any]], Callable[[Sequence[Any], Any], Any]]:
    """Both methods of an axis, which remember the last position of its panel."""
    find, measure = (getattr(axis, name) for name in FOUND_BY)
    last: dict[str, Any] = {}

    def ticks() -> list[Any]:
        position = (*axis.axes.bbox.bounds, *axis.axes.viewLim.bounds)
        if last.get("position") != position:
            last.clear()
            last.update(position=position, ticks=find())
        found: list[Any] = last["ticks"]
        return found

    def boxes(of: Sequence[Any], renderer: Any) -> Any:
        if of is not ticks():
            return measure(of, renderer)
        if "boxes" not in last:
            last["boxes"] = measure(of, renderer)
        return last["boxes"]

    return ticks, boxes
