"""Values in a drawn figure with their positions, for the text that a page shows under the pointer.

The values are read from the lines, scatter plots, bars and coloured cells of a matplotlib figure. The modules
that draw figures are therefore independent of pages. names: labels of the two axes of a panel. meanings:
legend entries by colour.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import compress
from math import ceil
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection, QuadMesh
from matplotlib.colors import to_hex
from matplotlib.container import BarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ...arrays import Array
from ..figures.cells import cell_centres
from .plain_label_text import plain_text_of_label

MAX_HOVER_TEXTS = 2500
"""Approximate largest number of texts in a figure; with more values, only every n-th value of long curves has
a text. A text takes some 100 bytes."""
MAX_UNTHINNED_POINTS = 24
"""Every point of a curve with at most this number of points has a text."""
HOVER_VALUE_DIGITS = 8
"""Number of significant digits of a value under the pointer."""
TYPOGRAPHIC_POINTS_PER_INCH = 72
"""Points per inch; a point is the length unit of matplotlib's SVG files."""
MAX_HOVER_DISTANCE_OUTSIDE_FRAME = 1.0
"""Values outside the frame of a panel, up to this distance, in pixels, also have texts."""


@dataclass(frozen=True, slots=True)
class HoverPoint:
    """Text for a value in a figure. x, y: position of the value relative to the upper left corner of the
    figure, in points."""

    x: float
    y: float
    text: str


@dataclass(frozen=True, slots=True)
class HoverSeries:
    """Texts for n values of a curve, shown when the pointer is at them. positions_in_pixels: positions of the
    values relative to the lower left corner of the figure, (n, 2). texts: (n,)."""

    positions_in_pixels: Array
    texts: Sequence[str]


def hover_points(figure: Figure) -> list[HoverPoint]:
    """Texts for the values in a figure, in the order of drawing; series of more than MAX_UNTHINNED_POINTS
    values are thinned, to about MAX_HOVER_TEXTS values together. The layout of the figure must be final."""
    meanings = _legend_words(figure)
    series_list = [series for axes in figure.axes for series in _hover_series_of_panel(axes, meanings)]
    long_text_count = sum(
        len(series.texts) for series in series_list if len(series.texts) > MAX_UNTHINNED_POINTS
    )
    step = max(1, ceil(long_text_count / MAX_HOVER_TEXTS))
    height = figure.get_size_inches()[1] * TYPOGRAPHIC_POINTS_PER_INCH
    scale = TYPOGRAPHIC_POINTS_PER_INCH / figure.dpi
    points = []
    for series in series_list:
        stride = step if len(series.texts) > MAX_UNTHINNED_POINTS else 1
        for (x, y), text in zip(series.positions_in_pixels[::stride], series.texts[::stride], strict=True):
            points.append(HoverPoint(float(scale * x), float(height - scale * y), text))
    return points


def _hover_series_of_panel(axes: Axes, meanings: dict[str, str]) -> Iterator[HoverSeries]:
    """Yields the texts for all values inside the frame of a panel. meanings: legend entries by colour."""
    if axes.get_label() == "<colorbar>" or not axes.get_visible():
        return
    names = (axis_label_text(axes, "x"), axis_label_text(axes, "y"))
    series_list = [*_cell_series(axes, names, meanings), *_bar_series(axes, names, meanings)]
    series_list += [_line_series(axes, line, names) for line in axes.lines if line.get_visible()]
    scatters = (dots for dots in axes.collections if isinstance(dots, PathCollection))
    series_list += [_scatter_series(dots, names) for dots in scatters]
    panel_box = axes.bbox.padded(MAX_HOVER_DISTANCE_OUTSIDE_FRAME)
    for series in series_list:
        is_inside = np.all(np.isfinite(series.positions_in_pixels), axis=1)
        is_inside[is_inside] = [panel_box.contains(x, y) for x, y in series.positions_in_pixels[is_inside]]
        yield HoverSeries(series.positions_in_pixels[is_inside], list(compress(series.texts, is_inside)))


def _line_series(axes: Axes, line: Line2D, names: tuple[str, str]) -> HoverSeries:
    """Texts for the vertices of a line. A line across the whole panel, such as a threshold, has a single
    text, its legend entry, at the middle. names: labels of the two axes."""
    data: Array = np.ma.filled(np.ma.asarray(line.get_xydata(), float), np.nan).reshape(-1, 2)
    with np.errstate(all="ignore"):  # zero has no position on a logarithmic axis
        pixels = line.get_transform().transform(data)
    label = _series_name(line.get_label())
    if line.get_transform() == axes.transData:
        return HoverSeries(pixels, _curve_point_texts(names, data, label))
    # A line across the whole panel: a threshold has a name, and an axis at zero needs no text.
    return HoverSeries(pixels.mean(axis=0, keepdims=True)[: bool(label)], [label][: bool(label)])


def _scatter_series(dots: PathCollection, names: tuple[str, str]) -> HoverSeries:
    """Texts for the points of a scatter plot, with the value that is shown by the colour of a point, if any.
    An invisible scatter plot contains the points between which filled contours are interpolated."""
    data: Array = np.ma.filled(np.ma.asarray(dots.get_offsets(), float), np.nan)
    pixels = dots.get_offset_transform().transform(data)
    texts = _curve_point_texts(names, data, _series_name(dots.get_label()))
    values = dots.get_array()
    if values is None:
        return HoverSeries(pixels, texts)
    name = "" if dots.colorbar is None else plain_text_of_label(dots.colorbar.ax.get_ylabel())
    if name := name or _series_name(dots.get_label()):
        rows = zip(np.ma.filled(values, np.nan), data, strict=True)
        texts = [
            f"{name}: {_coordinate_text(value)}\n{_coordinates_text(names, position)}"
            for value, position in rows
        ]
    return HoverSeries(pixels, texts)


def _cell_series(axes: Axes, names: tuple[str, str], meanings: dict[str, str]) -> Iterator[HoverSeries]:
    """Yields the texts for the cells of coloured meshes: value on the colour bar, or legend entry of the
    colour, and coordinates."""
    for mesh in axes.collections:
        if not isinstance(mesh, QuadMesh):
            continue
        corners = np.asarray(mesh.get_coordinates(), float)
        edges = axes.transData.transform(corners.reshape(-1, 2)).reshape(corners.shape)
        x = cell_centres(edges[0, :, 0])
        y = cell_centres(edges[:, 0, 1])
        pixels = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        values: np.ndarray = np.ma.masked_invalid(np.ma.asarray(mesh.get_array())).ravel()
        name = "" if mesh.colorbar is None else plain_text_of_label(mesh.colorbar.ax.get_ylabel())
        drawn_indices = np.flatnonzero(~np.ma.getmaskarray(values))
        centres = axes.transData.inverted().transform(pixels[drawn_indices]).reshape(-1, 2)
        texts = []
        for centre, value in zip(centres, values[drawn_indices], strict=True):
            meaning = "" if name else meanings.get(to_hex(mesh.to_rgba(value)), "")
            word = f"{name}: {_coordinate_text(value)}" if name else meaning
            texts.append("\n".join(filter(None, (word, _coordinates_text(names, centre)))))
        yield HoverSeries(pixels[drawn_indices], texts)


def _bar_series(axes: Axes, names: tuple[str, str], meanings: dict[str, str]) -> Iterator[HoverSeries]:
    """Yields the texts for bars, at the middle of each bar: legend entry, and values at both ends."""
    for bars in axes.containers:
        if not isinstance(bars, BarContainer):
            continue
        long_axis = 0 if bars.orientation == "horizontal" else 1
        for bar in bars.patches:
            low_corner, high_corner = bar.get_bbox().get_points()[:, long_axis]
            word = meanings.get(to_hex(bar.get_facecolor()), "")
            extent_text = (
                f"{names[long_axis]} from {_coordinate_text(low_corner)} to {_coordinate_text(high_corner)}"
            )
            middle = axes.transData.transform(bar.get_bbox().get_points().mean(axis=0))
            yield HoverSeries(middle[None], ["\n".join(filter(None, (word, extent_text)))])


def axis_label_text(axes: Axes, letter: Literal["x", "y"]) -> str:
    """Label of an axis as plain text, from the panel itself or from a panel with the same axis; `letter` if
    there is no label."""
    shared_axes = axes.get_shared_x_axes() if letter == "x" else axes.get_shared_y_axes()
    for panel in (axes, *shared_axes.get_siblings(axes), *_panels_with_same_axis(axes, letter)):
        label = panel.get_xlabel() if letter == "x" else panel.get_ylabel()
        if label:
            return plain_text_of_label(label)
    return letter


def _panels_with_same_axis(axes: Axes, letter: Literal["x", "y"]) -> list[Axes]:
    """Other panels in the same column (for "x") or row (for "y") with the same limits on this axis."""

    def place(panel: Axes) -> object:
        grid = panel.get_subplotspec()
        if grid is None:
            return None
        if letter == "x":
            return grid.colspan.start, panel.get_xlim()
        return grid.rowspan.start, panel.get_ylim()

    figure = axes.get_figure()
    panels = [] if figure is None else figure.axes
    return [
        other_panel for other_panel in panels if other_panel is not axes and place(other_panel) == place(axes)
    ]


def _legend_words(figure: Figure) -> dict[str, str]:
    """Legend entries of coloured patches in a figure, by colour."""
    legends = [*figure.legends, *(legend for axes in figure.axes if (legend := axes.get_legend()))]
    meanings = {}
    for legend in legends:
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
            if isinstance(handle, Patch):
                meanings[to_hex(handle.get_facecolor())] = plain_text_of_label(text.get_text())
    return meanings


def _series_name(label: object) -> str:
    """Legend entry of a curve; empty for a curve that is not in the legend."""
    text = str(label)
    return "" if text.startswith("_") else plain_text_of_label(text)


def _curve_point_texts(names: tuple[str, str], data: Array, series: str) -> list[str]:
    """Text for each point of a curve: legend entry `series` and both coordinates. data: points in data
    coordinates, (n, 2)."""
    return ["\n".join(filter(None, (series, _coordinates_text(names, point)))) for point in data]


def _coordinates_text(names: tuple[str, str], point: Array) -> str:
    """Coordinates of a point as text, one line each. point: point in data coordinates, (2,)."""
    return "\n".join(f"{name} = {_coordinate_text(value)}" for name, value in zip(names, point, strict=True))


def _coordinate_text(value: float) -> str:
    return f"{value:.{HOVER_VALUE_DIGITS}g}"
