"""Fits a drawn figure to its page: lines of text, columns of legends, heights of panels.

Sizes are measured on the laid out figure; the layout itself is matplotlib's constrained layout.
"""

import re
from math import ceil

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.text import Text

from .ticks import thin_ticks

LEAST_ASPECT = 0.45
"""Height of a panel in units of its width below which the figure grows: a curve needs as much to be read."""
MAP_ASPECT = 0.7
"""The same of a map, in which a slope is as worth seeing along either axis."""
STRIP_ASPECT = 0.25
"""The same of a curve in time, which is long and low, and goes with others."""
TALLEST = 9.5
"""Height in inches beyond which no figure grows: that of a page between its margins."""
MOST_PASSES = 6
"""Layouts until all fits: each change of the figure moves what was measured before."""
LEAST_HEIGHT = 0.45
"""Inches of a panel below which the labels of two ticks have no room above each other."""
SPARE = 4.0
"""Inches by which a figure is higher while its text is measured, so that its panels do not vanish."""
SLACK = 1.03
"""By how much more than its height a panel of one scale gets: where height and width both just suffice, the
layout goes back and forth between them."""
MARGIN = 0.04
"""Inches between text and the edge of the figure."""
WORDS = re.compile(r"(?:\\.|\$(?:\\.|[^$\\])*\$|[^\s$]|\xa0)+")
"""Words of a text; mathematics between dollars is part of its word, with the blanks in it, and a no-break
space holds a number and its unit together."""


def fit(figure: Figure, least_aspect: float = LEAST_ASPECT) -> None:
    """Lays a figure out so that nothing is cut, over anything else, or flatter than `least_aspect`.

    The figure keeps its width, and its height where that suffices.
    """
    width, height = figure.get_size_inches()
    figure.set_size_inches(width, height + SPARE)
    for _ in range(MOST_PASSES):
        _lay_out(figure)
        changes = [_fit_legends(figure), _break_texts(figure), thin_ticks(figure)]
        if not any(changes):
            break
    spare = _spare_height(figure, least_aspect)
    figure.set_size_inches(width, max(height, min(height + SPARE - spare, TALLEST)))
    for _ in range(MOST_PASSES):
        _lay_out(figure)
        if not thin_ticks(figure):
            break


def _lay_out(figure: Figure) -> None:
    """Places panels and legends, and draws nothing else: what is drawn in them is not measured."""
    canvas = figure.canvas
    if not isinstance(canvas, FigureCanvasAgg):
        canvas = FigureCanvasAgg(figure)  # without it each text makes one that measures it
    if engine := figure.get_layout_engine():
        engine.execute(figure)
    for legend in figure.legends:
        legend.draw(canvas.get_renderer())  # which places its entries


def break_lines(text: Text, room: float, upright: bool = False) -> bool:
    """Breaks the lines of a text at blanks so that none is longer than `room` pixels; whether that did.

    upright: whether its lines go up the page.
    """

    def length() -> float:
        box = text.get_window_extent()
        return float(box.height if upright else box.width)

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
    margin, width = MARGIN * figure.dpi, figure.bbox.width
    changed = [break_lines(heading, width - 2 * margin) for heading in figure.texts]
    for axes in figure.axes:
        box = axes.get_window_extent()
        rows = _rows(axes)
        centred = min(box.x0 + box.x1, 2 * width - box.x0 - box.x1) - 2 * margin
        across = min(centred, _pitch(axes, figure) - 2 * margin)
        down = max(figure.bbox.height / rows - 2 * margin, box.height)
        own = [text for text in axes.get_children() if isinstance(text, Text) and text not in axes.texts]
        for title in own:
            from_left = min(width - box.x0 - margin, _pitch(axes, figure) - 2 * margin)
            room = across if title.get_horizontalalignment() == "center" else from_left
            changed.append(break_lines(title, room))
        for one in (axes, *axes.child_axes):
            changed.append(break_lines(one.xaxis.label, across))
            changed.append(break_lines(one.yaxis.label, down, upright=True))
    return any(changed)


def _rows(axes: Axes) -> int:
    """Rows of the grid of panels of which the axes are one, one that spans several counted as one."""
    place = axes.get_subplotspec()
    return 1 if place is None else ceil(place.get_gridspec().nrows / len(place.rowspan))


def _pitch(axes: Axes, figure: Figure) -> float:
    """Pixels from the middle of a panel to that of the next beside it; the figure's width without one."""
    place = axes.get_subplotspec()
    if place is None:
        return float(figure.bbox.width)
    middles = {
        round(other.get_position(original=True).intervalx.mean() * figure.bbox.width)
        for other in figure.axes
        if (its := other.get_subplotspec()) is not None and its.get_gridspec() is place.get_gridspec()
    }
    own = round(axes.get_position(original=True).intervalx.mean() * figure.bbox.width)
    return float(min((abs(middle - own) for middle in middles - {own}), default=figure.bbox.width))


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
            changed |= any([break_lines(text, room - beside) for text in texts])
    return changed


def _columns(legend: Legend) -> int:
    return len({round(text.get_window_extent().x0) for text in legend.get_texts()})


def _with_columns(figure: Figure, legend: Legend, columns: int) -> Legend:
    """The legend of a figure anew, with another number of columns."""
    texts = [text.get_text() for text in legend.get_texts()]
    handles = [handle for handle in legend.legend_handles if handle is not None]
    legend.remove()
    new = figure.legend(handles, texts, loc="outside lower center", ncols=columns, frameon=False)
    _lay_out(figure)
    return new


def _shape(axes: Axes) -> float:
    """Height over width of a panel whose x and y have one scale, which its data fix; 0 of any other."""
    scale = axes.get_aspect()
    return 0.0 if scale == "auto" else float(axes.get_data_ratio() * scale)


def _spare_height(figure: Figure, least_aspect: float) -> float:
    """By how much the figure can get lower, in inches, until a panel has the least height for its width."""
    width, height = figure.get_size_inches()
    spare = [height]
    for axes in figure.axes:
        place = axes.get_subplotspec()
        if place is None or hasattr(axes, "_colorbar"):
            continue
        room = axes.get_position(original=True)
        ratios = np.asarray(place.get_gridspec().get_height_ratios())
        part = ratios[place.rowspan.start : place.rowspan.stop].sum() / ratios.sum()
        label = axes.yaxis.label.get_window_extent().height / figure.dpi
        shape = max(least_aspect, SLACK * _shape(axes))
        least = max(shape * room.width * width, label + MARGIN, LEAST_HEIGHT)
        spare.append((room.height * height - least) / part)
    return min(spare)
