"""Fits a drawn figure to its page: lines of text, columns of legends, heights of panels.

Sizes are measured on the laid out figure; the layout itself is matplotlib's constrained layout.
"""

import re
from collections.abc import Callable
from math import ceil

import matplotlib
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.text import Text
from matplotlib.ticker import FixedLocator, LogLocator, MaxNLocator

LEAST_ASPECT = 0.45
"""Height of a panel in units of its width below which the figure grows: a curve needs as much to be read."""
MAP_ASPECT = 0.7
"""The same of a map, in which a slope is as worth seeing along either axis."""
TALLEST = 9.5
"""Height in inches beyond which no figure grows: that of a page between its margins."""
MOST_PASSES = 6
"""Layouts until all fits: each change of the figure moves what was measured before."""
SPARE = 4.0
"""Inches by which a figure is higher while its text is measured, so that its panels do not vanish."""
MARGIN = 0.04
"""Inches between text and the edge of the figure."""
BLANK = 0.25
"""Space between the labels of two ticks beside each other, in units of the size of type."""
WORDS = re.compile(r"(?:\\.|\$(?:\\.|[^$\\])*\$|[^\s$])+")
"""Words of a text; mathematics between dollars is part of its word, with the blanks in it."""


def fit(figure: Figure, least_aspect: float = LEAST_ASPECT) -> None:
    """Lays a figure out so that nothing is cut, over anything else, or flatter than `least_aspect`.

    The figure keeps its width, and its height where that suffices.
    """
    width, height = figure.get_size_inches()
    figure.set_size_inches(width, height + SPARE)
    for _ in range(MOST_PASSES):
        figure.draw_without_rendering()
        changes = [_fit_legends(figure), _break_texts(figure), _thin_ticks(figure)]
        if not any(changes):
            break
    spare = _spare_height(figure, least_aspect)
    figure.set_size_inches(width, max(height, min(height + SPARE - spare, TALLEST)))
    for _ in range(MOST_PASSES):
        figure.draw_without_rendering()
        if not _thin_ticks(figure):
            break


def break_lines(text: Text, room: float, length: Callable[[], float]) -> bool:
    """Breaks the lines of a text at blanks so that none is longer than `room` pixels; whether that did.

    length: of the text as it stands, in pixels along its lines.
    """
    before = text.get_text()
    if not before or length() <= room:
        return False
    lines: list[str] = []
    for given in before.split("\n"):
        line = ""
        for word in WORDS.findall(given):
            longer = f"{line} {word}" if line else word
            text.set_text(longer)
            if line and length() > room:
                lines.append(line)
                line = word
            else:
                line = longer
        lines.append(line)
    text.set_text("\n".join(lines))
    return text.get_text() != before


def _break_texts(figure: Figure) -> bool:
    """Breaks headings and the labels of axes where they are longer than the room that they have."""
    margin = MARGIN * figure.dpi
    changed = False
    heading = figure._suptitle  # the artist has no getter
    if heading is not None:
        room = figure.bbox.width - 2 * margin
        changed |= break_lines(heading, room, lambda: heading.get_window_extent().width)
    for axes in figure.axes:
        box = axes.get_window_extent()
        rows, columns = _rows_and_columns(axes)
        centred = 2 * (min(box.x0 + box.x1, 2 * figure.bbox.width - box.x0 - box.x1) / 2 - margin)
        across = min(centred, max(figure.bbox.width / columns, box.width) - 2 * margin)
        down = max(figure.bbox.height / rows - 2 * margin, box.height)
        for text in (axes.title, axes.xaxis.label):
            changed |= break_lines(text, across, lambda text=text: text.get_window_extent().width)
        left = axes._left_title  # the artist has no getter
        room = min(figure.bbox.width - box.x0 - margin, figure.bbox.width / columns - 2 * margin)
        changed |= break_lines(left, room, lambda text=left: text.get_window_extent().width)
        vertical = axes.yaxis.label
        changed |= break_lines(vertical, down, lambda text=vertical: text.get_window_extent().height)
        for second in axes.child_axes:
            label = second.xaxis.label
            changed |= break_lines(label, across, lambda text=label: text.get_window_extent().width)
            label = second.yaxis.label
            changed |= break_lines(label, down, lambda text=label: text.get_window_extent().height)
    return changed


def _rows_and_columns(axes: Axes) -> tuple[int, int]:
    """Of the grid of panels of which the axes are one, one that spans several counted as one."""
    place = axes.get_subplotspec()
    if place is None:
        return 1, 1
    grid = place.get_gridspec()
    return ceil(grid.nrows / len(place.rowspan)), ceil(grid.ncols / len(place.colspan))


def _fit_legends(figure: Figure) -> bool:
    """Gives legends that are wider than the figure fewer columns, and breaks entries too long for one."""
    room = figure.bbox.width - 2 * MARGIN * figure.dpi
    changed = False
    for given in list(figure.legends):
        legend = given
        while legend.get_window_extent().width > room and _columns(legend) > 1:
            legend, changed = _with_columns(figure, legend, _columns(legend) - 1), True
        texts = legend.get_texts()
        if legend.get_window_extent().width > room:
            beside = legend.get_window_extent().width - max(text.get_window_extent().width for text in texts)
            for text in texts:
                changed |= break_lines(text, room - beside, lambda text=text: text.get_window_extent().width)
    return changed


def _columns(legend: Legend) -> int:
    return min(legend._ncols, len(legend.get_texts()))


def _with_columns(figure: Figure, legend: Legend, columns: int) -> Legend:
    """The legend of a figure anew, with another number of columns."""
    texts = [text.get_text() for text in legend.get_texts()]
    handles = [handle for handle in legend.legend_handles if handle is not None]
    legend.remove()
    new = figure.legend(handles, texts, loc="outside lower center", ncols=columns, frameon=False)
    figure.draw_without_rendering()
    return new


def _thin_ticks(figure: Figure) -> bool:
    """Takes labels away from axes on which they run into each other."""
    every = [*figure.axes, *(child for axes in figure.axes for child in axes.child_axes)]
    return any([_thin(axis, way) for axes in every for axis, way in ((axes.xaxis, 0), (axes.yaxis, 1))])


def _thin(axis: Axis, way: int) -> bool:
    """Fewer labels on an axis where two of them meet; way: 0 for a horizontal axis, 1 for a vertical one."""
    shown = [label for label in axis.get_majorticklabels() if label.get_visible() and label.get_text()]
    boxes = [label.get_window_extent() for label in shown]
    spans = sorted(tuple(box.intervaly if way else box.intervalx) for box in boxes)
    least = 0.0 if way else BLANK * matplotlib.rcParams["font.size"] * axis.get_figure().dpi / 72
    if all(later[0] - earlier[1] >= least for earlier, later in zip(spans[:-1], spans[1:], strict=True)):
        return False
    locator = axis.get_major_locator()
    if isinstance(locator, FixedLocator):
        ticks, texts = axis.get_majorticklocs(), [label.get_text() for label in axis.get_majorticklabels()]
        axis.set_ticks(ticks[::2], texts[::2])
        return True
    if isinstance(locator, LogLocator):
        return _thin_decades(axis, locator)
    if isinstance(locator, MaxNLocator) and len(shown) > 2:
        axis.set_major_locator(MaxNLocator(max(len(shown) - 2, 1), steps=[1, 2, 2.5, 5, 10]))
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


def _spare_height(figure: Figure, least_aspect: float) -> float:
    """By how much the figure can get lower, in inches, until a panel has the least height for its width."""
    width, height = figure.get_size_inches()
    spare = [height]
    for axes in figure.axes:
        place = axes.get_subplotspec()
        if place is None or hasattr(axes, "_colorbar"):
            continue
        room = axes.get_position(original=True)
        ratios = place.get_gridspec().get_height_ratios()
        part = sum(ratios[row] for row in place.rowspan) / sum(ratios)
        spare.append((room.height * height - least_aspect * room.width * width) / part)
    return min(spare)
