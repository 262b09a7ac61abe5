"""Layout of a figure so that all texts fit: broken lines, columns of legends, and heights of panels.

All sizes are measured in the figure after matplotlib's constrained layout.
"""

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import QuadMesh
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.legend import Legend
from matplotlib.text import Text

from .tick_thinning import thin_ticks

MIN_ASPECT = 0.45
"""Smallest ratio of height to width of a panel. If a panel is flatter, the height of the figure is
increased."""
MIN_MAP_ASPECT = 0.7
"""Smallest ratio of height to width of a map, in which slopes along x and along y must be visible."""
MIN_TIME_PANEL_ASPECT = 0.25
"""Smallest ratio of height to width of a panel with a curve against time, in a figure with several panels."""
MAX_FIGURE_HEIGHT = 9.5
"""Largest height of a figure, in inches: the printable height of a page."""
MAX_LAYOUT_PASSES = 6
"""Maximum number of times that a figure is laid out. Each change of the figure moves texts that have been
measured, so that the figure must be laid out again."""
MIN_PANEL_HEIGHT = 0.45
"""Smallest height of a panel, in inches; two tick labels fit above each other."""
EXTRA_HEIGHT_FOR_MEASURING_TEXTS = 4.0
"""Height, in inches, that is added to the figure while texts are measured, so that no panel vanishes."""
EQUAL_SCALE_HEIGHT_FACTOR = 1.03
"""Factor on the required height of panels with equal scales. Without this factor, height and width would both
just suffice, and successive layouts would alternate."""
TEXT_MARGIN = 0.04
"""Smallest distance of a text from the edge of the figure, in inches."""
MAX_DARK_COLOUR_COMPONENT = 0.3
"""A background is dark if red, green and blue are all below this number, from 0 to 1."""
LEGEND_BACKGROUND = "0.9"
"""Background of the legend beside a map on a dark figure."""
WORD_PATTERN = re.compile(r"(?:\\.|\$(?:\\.|[^$\\])*\$|[^\s$]|\xa0)+")
"""Pattern for a word of a text. A formula between dollar signs, including spaces, is part of a word, as is a
no-break space."""


def fit_layout(figure: Figure, min_aspect: float = MIN_ASPECT) -> None:
    """Lays out a figure so that no text is cut off or overlaps, and no panel has a ratio of height to width
    below `min_aspect`.

    The width of the figure does not change. The height is increased only if the content does not fit.
    """
    width, height = figure.get_size_inches()
    figure.set_size_inches(width, height + EXTRA_HEIGHT_FOR_MEASURING_TEXTS)
    for _ in range(MAX_LAYOUT_PASSES):
        _position_panels(figure)
        changes = [_fit_legends(figure), _break_texts(figure), thin_ticks(figure)]
        if not any(changes):
            break
    # The texts fit; now remove the additional height. No text becomes longer by this.
    excess_height = _spare_height(figure, min_aspect)
    figure.set_size_inches(
        width, max(height, min(height + EXTRA_HEIGHT_FOR_MEASURING_TEXTS - excess_height, MAX_FIGURE_HEIGHT))
    )
    for _ in range(MAX_LAYOUT_PASSES):
        _position_panels(figure)
        if not thin_ticks(figure):
            break
    if any(axes.get_aspect() != "auto" for axes in figure.axes):
        _position_panels(figure)  # panels with equal scales have changed their shape


def _position_panels(figure: Figure) -> None:
    """Positions panels and legends of a figure, without drawing the content of the panels."""
    canvas = figure.canvas
    if not isinstance(canvas, FigureCanvasAgg):
        canvas = FigureCanvasAgg(figure)  # otherwise each text creates a canvas to measure itself
    if engine := figure.get_layout_engine():
        engine.execute(figure)
    for legend in figure.legends:
        legend.draw(canvas.get_renderer())  # drawing places the entries


def break_lines(text: Text, max_width: float, is_vertical: bool = False) -> bool:
    """Breaks a text at spaces into lines of at most `max_width` pixels; returns whether the text changed.

    is_vertical: whether the text is rotated by 90 degrees.
    """

    def length() -> float:
        box = text.get_window_extent()
        return float(box.height if is_vertical else box.width)

    original_text = text.get_text()
    if not original_text or length() <= max_width:
        return False
    lines: list[str] = []
    for given_line in original_text.split("\n"):
        line = ""
        for word in WORD_PATTERN.findall(given_line):
            extended_line = f"{line} {word}" if line else word
            text.set_text(extended_line)
            if line and length() > max_width:
                lines.append(line)
                line = word
            else:
                line = extended_line
        lines.append(line)
    text.set_text("\n".join(lines))
    return text.get_text() != original_text


def _break_texts(figure: Figure) -> bool:
    """Breaks headings and axis labels that are too long; returns whether any text changed."""
    margin = TEXT_MARGIN * figure.dpi
    width = figure.bbox.width
    changed = [break_lines(heading, width - 2 * margin) for heading in figure.texts]
    for axes in figure.axes:
        box = axes.get_window_extent()
        grid_cell = axes.get_subplotspec()
        row_count = column_count = 1.0
        if grid_cell is not None:
            grid = grid_cell.get_gridspec()
            row_count = grid.nrows / len(grid_cell.rowspan)
            column_count = grid.ncols / len(grid_cell.colspan)
        # A left title ends at the edge of the page; a centred text extends equally to both sides.
        left_width = min(width - box.x0, width / column_count) - 2 * margin
        centred_width = min(box.x0 + box.x1, 2 * width - box.x0 - box.x1, width / column_count) - 2 * margin
        max_height = max(figure.bbox.height / row_count - 2 * margin, box.height)
        texts = [text for text in axes.get_children() if isinstance(text, Text) and text not in axes.texts]
        for title in texts:
            is_centred = title.get_horizontalalignment() == "center"
            changed.append(break_lines(title, centred_width if is_centred else left_width))
        for panel in (axes, *axes.child_axes):
            changed.append(break_lines(panel.xaxis.label, centred_width))
            changed.append(break_lines(panel.yaxis.label, max_height, is_vertical=True))
    return any(changed)


def place_legend(
    figure: Figure, handles: Sequence[Artist], labels: Sequence[str], column_count: int
) -> Legend:
    """Legend with `column_count` columns below the panels of a figure. Beside a map on a dark figure, the
    legend has a light background, because lines on maps are black."""
    panels = [artist for axes in figure.axes for artist in (*axes.images, *axes.collections)]
    has_map = any(isinstance(artist, AxesImage | QuadMesh) for artist in panels)
    look: dict[str, Any] = {"frameon": False}
    if has_map and max(to_rgb(figure.get_facecolor())) < MAX_DARK_COLOUR_COMPONENT:
        look = {"frameon": True, "facecolor": LEGEND_BACKGROUND, "labelcolor": "black"}
    return figure.legend(list(handles), labels, loc="outside lower center", ncols=column_count, **look)


def _fit_legends(figure: Figure) -> bool:
    """Reduces the number of columns of legends that are too wide, and breaks long entries; returns whether
    any legend changed."""
    max_width = figure.bbox.width - 2 * TEXT_MARGIN * figure.dpi
    changed = False
    for old_legend in list(figure.legends):
        legend = old_legend
        texts = legend.get_texts()
        column_count = len({round(text.get_window_extent().x0) for text in texts})
        while legend.get_window_extent().width > max_width and column_count > 1:
            column_count -= 1
            handles = [handle for handle in legend.legend_handles if handle is not None]
            legend.remove()
            legend = place_legend(figure, handles, [text.get_text() for text in texts], column_count)
            texts = legend.get_texts()
            _position_panels(figure)
            changed = True
        if (width := legend.get_window_extent().width) > max_width:
            extra_width = width - max(text.get_window_extent().width for text in texts)
            changed |= any([break_lines(text, max_width - extra_width) for text in texts])
    return changed


def _spare_height(figure: Figure, min_aspect: float) -> float:
    """Height, in inches, by which the figure can shrink until the first panel reaches its smallest height.
    min_aspect: smallest ratio of height to width of a panel."""
    width, height = figure.get_size_inches()
    spares = [height]
    for axes in figure.axes:
        grid_cell = axes.get_subplotspec()
        if grid_cell is None or hasattr(axes, "_colorbar"):
            continue
        panel_box = axes.get_position(original=True)
        ratios = np.asarray(grid_cell.get_gridspec().get_height_ratios())
        row_fraction = ratios[grid_cell.rowspan.start : grid_cell.rowspan.stop].sum() / ratios.sum()
        label_height = axes.yaxis.label.get_window_extent().height / figure.dpi
        scale = axes.get_aspect()  # panels with equal scales have the aspect ratio of their data
        data_ratio = 0.0 if scale == "auto" else float(axes.get_data_ratio() * scale)
        aspect = max(min_aspect, EQUAL_SCALE_HEIGHT_FACTOR * data_ratio)
        min_height = max(aspect * panel_box.width * width, label_height + TEXT_MARGIN, MIN_PANEL_HEIGHT)
        spares.append((panel_box.height * height - min_height) / row_fraction)
    return min(spares)
