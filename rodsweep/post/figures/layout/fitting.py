"""Fitting of a figure to its page: breaks lines of text, and adapts columns of legends and heights of panels.

Sizes are measured on the figure after matplotlib's constrained layout.
"""

import re
from math import ceil

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.text import Text

from .remembered_ticks import remembered_ticks
from .ticks import thin_ticks

MIN_ASPECT = 0.45
"""Smallest height of a panel, in units of the width; for a flatter panel the figure grows."""
MAP_ASPECT = 0.7
"""Smallest aspect ratio of a map, for which slopes matter along both axes."""
STRIP_ASPECT = 0.25
"""Smallest aspect ratio of a curve in time, which is long and low and shares a figure with other panels."""
TALLEST = 9.5
"""Largest height of a figure, in inches: the height of a page between its margins."""
MAX_PASSES = 6
"""Largest number of layouts. Each change of the figure moves texts measured before."""
MIN_HEIGHT = 0.45
"""Smallest height of a panel, in inches, at which the labels of two ticks fit above each other."""
SPARE_HEIGHT = 4.0
"""Additional height, in inches, while texts are measured, to keep panels from vanishing."""
SLACK = 1.03
"""Additional factor on the height of a panel with equal scales. If height and width both just suffice, the
layout alternates between them."""
MARGIN = 0.04
"""Margin between text and the edge of the figure, in inches."""
WORDS = re.compile(r"(?:\\.|\$(?:\\.|[^$\\])*\$|[^\s$]|\xa0)+")
"""Words of a text. Mathematics between dollars belongs to a word, blanks included; a no-break space joins a
number and a unit."""


def fit(figure: Figure, min_aspect: float = MIN_ASPECT) -> None:
    """Lays a figure out: nothing is cut or overlaps, and no panel is flatter than `min_aspect`.

    The width of the figure stays, and the height if the content fits.
    """
    width, height = figure.get_size_inches()
    figure.set_size_inches(width, height + SPARE_HEIGHT)
    for _ in range(MAX_PASSES):
        _lay_out(figure)
        changes = [_fit_legends(figure), _break_texts(figure), thin_ticks(figure)]
        if not any(changes):
            break
    # The texts fit; now remove the additional height, which does not lengthen any text.
    spare = _spare_height(figure, min_aspect)
    figure.set_size_inches(width, max(height, min(height + SPARE_HEIGHT - spare, TALLEST)))
    for _ in range(MAX_PASSES):
        _lay_out(figure)
        if not thin_ticks(figure):
            break
    if any(axes.get_aspect() != "auto" for axes in figure.axes):
        _lay_out(figure)  # panels with equal scales have changed their shape


def _lay_out(figure: Figure) -> None:
    """Places panels and legends, without drawing the content of panels, which is not measured."""
    canvas = figure.canvas
    if not isinstance(canvas, FigureCanvasAgg):
        canvas = FigureCanvasAgg(figure)  # otherwise each text creates a canvas to measure itself
    if engine := figure.get_layout_engine():
        with remembered_ticks(figure):
            engine.execute(figure)
    for legend in figure.legends:
        legend.draw(canvas.get_renderer())  # drawing places the entries


def break_lines(text: Text, room: float, upright: bool = False) -> bool:
    """Breaks lines of a text at blanks to fit into `room` pixels; returns whether the text changed.

    upright: whether the text is rotated by 90 degrees.
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
    """Breaks headings and axis labels longer than the room; returns whether any changed."""
    margin = MARGIN * figure.dpi
    width = figure.bbox.width
    changed = [break_lines(heading, width - 2 * margin) for heading in figure.texts]
    for axes in figure.axes:
        box = axes.get_window_extent()
        place = axes.get_subplotspec()
        rows = 1 if place is None else ceil(place.get_gridspec().nrows / len(place.rowspan))
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


def _pitch(axes: Axes, figure: Figure) -> float:
    """Pixels between the middles of a panel and its nearest neighbour; the figure's width without one."""
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
    """Reduces the columns of wide legends and breaks long entries; returns whether any changed."""
    room = figure.bbox.width - 2 * MARGIN * figure.dpi
    changed = False
    for given in list(figure.legends):
        legend = given
        while legend.get_window_extent().width > room and _columns(legend) > 1:
            legend = _with_columns(figure, legend, _columns(legend) - 1)
            changed = True
        texts = legend.get_texts()
        if legend.get_window_extent().width > room:
            beside = legend.get_window_extent().width - max(text.get_window_extent().width for text in texts)
            changed |= any([break_lines(text, room - beside) for text in texts])
    return changed


def _columns(legend: Legend) -> int:
    """Number of columns of a legend."""
    return len({round(text.get_window_extent().x0) for text in legend.get_texts()})


def _with_columns(figure: Figure, legend: Legend, columns: int) -> Legend:
    """Replaces a legend by a legend with the given number of columns."""
    texts = [text.get_text() for text in legend.get_texts()]
    handles = [handle for handle in legend.legend_handles if handle is not None]
    legend.remove()
    new = figure.legend(handles, texts, loc="outside lower center", ncols=columns, frameon=False)
    _lay_out(figure)
    return new


def _spare_height(figure: Figure, min_aspect: float) -> float:
    """Height, in inches, by which the figure can shrink until a panel has the smallest height."""
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
        scale = axes.get_aspect()  # panels with equal scales have the aspect ratio of their data
        own = 0.0 if scale == "auto" else float(axes.get_data_ratio() * scale)
        shape = max(min_aspect, SLACK * own)
        least = max(shape * room.width * width, label + MARGIN, MIN_HEIGHT)
        spare.append((room.height * height - least) / part)
    return min(spare)
