"""Picture of the stability diagram over the load and a second parameter. A click selects new values of the
two parameters. The regions are areas of equal numbers of unstable modes, bounded by the stored curves of Hopf
points and by the crushing load as in the figures of `rodsweep plot`."""

from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np
from bokeh.models import FixedTicker, HoverTool, LogTicker, Ticker

from ...arrays import Array
from ...post.figures.phase_diagram import CURVE_END_CRUSHING_RATIO
from ...post.figures.stability.regions import PIXEL_COUNT, ClassifiedPoints, DrawnPlane, pixel_classes
from ...wording import counted
from ..slider_scales import SliderScale
from ..solving.diagram_curves_and_unstable_counts import DiagramCurve
from ..solving.diagrams import CRUSHED_UNSTABLE_COUNT, UNKNOWN_UNSTABLE_COUNT
from . import card

PIXEL_ROWS_PER_DRAWN_ROW = 2
"""Number of rows of pixels that are computed for each drawn row of the grid; a drawn row is then about one
pixel high on the page."""
MIN_LOG_TICKER_RATIO = 100
"""On a logarithmic axis whose ends have a smaller ratio, Bokeh's ticker places ticks at equal distances, and
none in the lower part."""
TICK_MANTISSAS = np.array([1.0, 2.0, 5.0])
"""Mantissas of the ticks of an axis whose ends have a ratio below MIN_LOG_TICKER_RATIO."""


class UnstableCountGrid(NamedTuple):
    """Numbers of unstable modes in narrow rows of cells. column_edges: edges of the columns, (columns + 1,).
    row_edges: edges of the rows, (rows + 1,). unstable_counts: numbers of unstable modes, (rows, columns)."""

    column_edges: Array
    row_edges: Array
    unstable_counts: Array


def unstable_count_grid(answer: dict[str, Any]) -> UnstableCountGrid | None:
    """Numbers of unstable modes on a fine grid, from the answer `answer` to the request "diagram", in the
    units of the answer. None if the answer has no curve of Hopf points, fewer than two values of the second
    parameter, or a value that is not finite and positive."""
    x = answer["x"]
    y = answer["y"]
    hopf_curves = [curve for curve in answer["curves"] if curve.kind == "hopf"]
    if not hopf_curves or len(y) < 2 or not (np.isfinite(y) & (y > 0)).all():
        return None
    # The axis of the loads is linear, and the axis of the second parameter logarithmic, for any values.
    plane = DrawnPlane(np.linspace(x[0], x[-1], 3), np.linspace(np.log(y[0]), np.log(y[-1]), 3))
    columns, rows = np.meshgrid(x, np.log(y))
    counts = np.asarray(answer["unstable_count"])
    is_counted = counts != CRUSHED_UNSTABLE_COUNT
    computed = ClassifiedPoints(
        plane.fractions_of_axes(columns[is_counted], rows[is_counted]), counts[is_counted]
    )
    row_positions = plane.fractions_of_axes(answer["between_x"], np.log(answer["between_y"]))
    row_points = ClassifiedPoints(row_positions, np.asarray(answer["between_count"]))
    curves = [plane.fractions_of_axes(curve.x, np.log(curve.y)) for curve in hopf_curves]
    ratio = _crushing_ratio(plane, np.log(y), answer["crushing_load"])
    pixels = pixel_classes(
        computed, row_points, curves, ratio > CURVE_END_CRUSHING_RATIO, UNKNOWN_UNSTABLE_COUNT
    )
    pixels = np.where(ratio < 1, pixels, CRUSHED_UNSTABLE_COUNT)
    column_edges = np.linspace(x[0], x[-1], PIXEL_COUNT + 1)
    row_edges = np.geomspace(y[0], y[-1], PIXEL_COUNT // PIXEL_ROWS_PER_DRAWN_ROW + 1)
    return UnstableCountGrid(
        column_edges, row_edges, pixels[PIXEL_ROWS_PER_DRAWN_ROW // 2 :: PIXEL_ROWS_PER_DRAWN_ROW]
    )


def _crushing_ratio(plane: DrawnPlane, logs: Array, load: Array) -> Array:
    """Load divided by the crushing load, at which the stretch is 0, at every pixel, (PIXEL_COUNT,
    PIXEL_COUNT). logs: logarithms of the second parameter, (rows,). load: crushing load of each row, infinite
    on no row or on all rows, (rows,)."""
    if np.isinf(load).all():
        return np.zeros((PIXEL_COUNT, PIXEL_COUNT))
    # With two logarithmic axes the crushing load is a straight line over k1, and over the taper.
    crushing = np.exp(np.interp(plane.pixel_centres(plane.y), logs, np.log(load)))
    return np.asarray(plane.pixel_centres(plane.x) / crushing[:, None])


BOUNDARY_COLOURS = {"double": card.NEUTRAL_COLOUR, "onset": card.NEUTRAL_COLOUR, "hopf": card.UNSTABLE_COLOUR}
"""Colour of a stability boundary, by kind; other kinds have the colour STABLE_COLOUR."""
CYCLE_CURVE_LOOKS = {
    "fold": ("folds of cycles", card.FOLD_COLOUR, "solid"),
    "torus": ("torus points", card.TORUS_COLOUR, "dashed"),
}
"""(legend entry, colour, line style) of curves of folds and of torus points of cycles, by kind of point."""
DARKEST_UNSTABLE_COUNT = 6
"""Cells with this number of unstable modes, or more, have the darkest colour."""


class DiagramCell(NamedTuple):
    """Rectangle around neighbouring grid points of a row that have equal numbers of unstable modes. left,
    right, bottom, top: edges, in the units of the axes."""

    left: float
    right: float
    bottom: float
    top: float
    unstable_count: int


def geometric_cell_edges(values: Array) -> Array:
    """Edges, (n + 1,), of the cells around n increasing positive values, (n,): the geometric means of
    neighbouring values, and beyond each end an edge at the same ratio as the edge on the other side of the
    end value (exp(+-0.1) if n = 1)."""
    logs = np.log(values)
    if len(logs) == 1:
        return np.exp(logs[0] + np.array([-0.1, 0.1]))
    midpoints = (logs[1:] + logs[:-1]) / 2
    return np.exp(np.concatenate(([2 * logs[0] - midpoints[0]], midpoints, [2 * logs[-1] - midpoints[-1]])))


def diagram_cells(x: Array, y: Array, counts: Array) -> list[DiagramCell]:
    """Rectangles of equal numbers of unstable modes on a grid. x: loads, (columns,). y: second parameter,
    (rows,). counts: numbers of unstable modes, (rows, columns)."""
    return merged_cells_of_rows(
        np.concatenate(([x[0]], (x[1:] + x[:-1]) / 2, [x[-1]])), geometric_cell_edges(y), counts
    )


def merged_cells_of_rows(edges: Array, row_edges: Array, counts: Array) -> list[DiagramCell]:
    """Rectangles of equal numbers of unstable modes in rows of cells. edges: edges of the columns, (columns +
    1,). row_edges: edges of the rows, (rows + 1,). counts: numbers of unstable modes, (rows, columns)."""
    cells = []
    for row, line in enumerate(counts):
        start = 0
        for count, group in groupby(map(int, line)):
            end = start + len(list(group))
            cells.append(DiagramCell(edges[start], edges[end], row_edges[row], row_edges[row + 1], count))
            start = end
    return cells


def stability_colour_and_opacity(unstable_count: int) -> tuple[str, float]:
    """Returns (colour, opacity) of a cell. unstable_count: number of unstable modes, or
    CRUSHED_UNSTABLE_COUNT, or UNKNOWN_UNSTABLE_COUNT."""
    if unstable_count in (CRUSHED_UNSTABLE_COUNT, UNKNOWN_UNSTABLE_COUNT):
        return card.NEUTRAL_COLOUR, 0.55 if unstable_count == CRUSHED_UNSTABLE_COUNT else 0.25
    if unstable_count == 0:
        return card.STABLE_COLOUR, 0.18
    return card.UNSTABLE_COLOUR, 0.2 + 0.5 * min(
        unstable_count, DARKEST_UNSTABLE_COUNT
    ) / DARKEST_UNSTABLE_COUNT


def unstable_count_words(unstable_count: int) -> str:
    """Phrase for a number of unstable modes, or for CRUSHED_UNSTABLE_COUNT or UNKNOWN_UNSTABLE_COUNT."""
    texts = {
        0: "stable",
        CRUSHED_UNSTABLE_COUNT: "crushed by the load",
        UNKNOWN_UNSTABLE_COUNT: "not searched, or not known",
    }
    return texts.get(unstable_count, counted(unstable_count, "unstable mode"))


class DiagramPicture:
    """Stability of the straight rod over two parameters. Blue: stable. Orange: flutter, darker for more
    unstable modes. Grey: crushed, or not known."""

    def __init__(self) -> None:
        axes = ("force F (k3/L^2)", (0, 1)), ("k2", (0.1, 1))
        figure = card.new_figure(*axes, y_axis_type="log")
        self.cell_source = card.empty_source(
            (*DiagramCell._fields, "words", "colour", "alpha"), "cell_source"
        )
        self.curve_source = card.empty_source(("x", "y", "colour"), "curve_source")
        self.cycle_curve_source = card.empty_source(("x", "y", "colour", "dash"), "cycle_curve_source")
        self.crossing_source = card.empty_source(("x", "y", "colour"), "crossing_source")
        self.point_source = card.empty_source(("x", "y"), "point_source")
        look = {"color": "colour", "alpha": "alpha", "line_width": 0}
        edges = {name: name for name in ("left", "right", "bottom", "top")}
        areas = figure.quad(**edges, **look, source=self.cell_source)
        figure.add_tools(HoverTool(renderers=[areas], tooltips=[("", "@words")]))
        figure.multi_line("x", "y", color="colour", line_width=2, source=self.curve_source)
        look = {"color": "colour", "line_dash": "dash", "line_width": 3}
        figure.multi_line("x", "y", **look, source=self.cycle_curve_source)
        self.legend = card.add_line_legend(figure, CYCLE_CURVE_LOOKS.values(), 3, visible=False)
        figure.scatter("x", "y", size=6, color="colour", source=self.crossing_source)
        look = {"marker": "cross", "size": 22, "line_width": 3, "color": card.POINT_COLOUR}
        figure.scatter("x", "y", **look, source=self.point_source, level="overlay")
        self.card = card.Card("diagram", figure)

    @property
    def is_drawn(self) -> bool:
        """Whether the figure contains a diagram."""
        return len(self.cell_source.data["left"]) > 0

    def show(self, answer: dict[str, Any], load: SliderScale, row_scale: SliderScale) -> None:
        """Draws the answer `answer` to the request "diagram". load, row_scale: scales of the controls of the
        load and of the second parameter, for units and labels of the axes."""
        x = answer["x"] * load.factor_from_si
        y = answer["y"] * row_scale.factor_from_si
        regions = unstable_count_grid(answer)
        if regions is None:
            grid = diagram_cells(x, y, answer["unstable_count"])
        else:
            edges = (regions.column_edges * load.factor_from_si, regions.row_edges * row_scale.factor_from_si)
            grid = merged_cells_of_rows(*edges, regions.unstable_counts)
        data = {name: [getattr(cell, name) for cell in grid] for name in DiagramCell._fields}
        shades = [stability_colour_and_opacity(cell.unstable_count) for cell in grid]
        data["words"] = [unstable_count_words(cell.unstable_count) for cell in grid]
        data |= {"colour": [colour for colour, _ in shades], "alpha": [alpha for _, alpha in shades]}
        self.cell_source.data = data
        self._show_curves(answer)
        positions = (
            answer["crossing_x"] * load.factor_from_si,
            answer["crossing_y"] * row_scale.factor_from_si,
        )
        self.crossing_source.data = _boundary_columns(*positions, answer["crossing_kind"])
        y_limits = float(grid[0].bottom), float(grid[-1].top)
        self.card.set_axes((float(x[0]), float(x[-1])), y_limits, (load.label, row_scale.label))
        self.card.figure.yaxis.ticker = log_axis_ticker(*y_limits)
        self.card.show_figure()

    def _show_curves(self, answer: dict[str, Any]) -> None:
        self.curve_source.data = _boundary_columns(*_curve_columns(answer["curves"]))
        x, y, kinds = _curve_columns(answer["cycle_curves"])
        colours, dashes = ([CYCLE_CURVE_LOOKS[kind][side] for kind in kinds] for side in (1, 2))
        self.cycle_curve_source.data = {"x": x, "y": y, "colour": colours, "dash": dashes}
        self.legend.visible = len(kinds) > 0

    def mark_rod(self, x: float, y: float) -> None:
        """Moves the mark of the page's rod. x: load, y: second parameter, in the units of the axes."""
        self.point_source.data = {"x": [x], "y": [y]}


def log_axis_ticker(low: float, high: float) -> Ticker:
    """A ticker that places ticks in all parts of a logarithmic axis from `low` to `high`."""
    if not 0 < low < high < MIN_LOG_TICKER_RATIO * low:
        return LogTicker()
    exponents = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)))
    return FixedTicker(ticks=np.outer(10.0**exponents, TICK_MANTISSAS).ravel().tolist())


def _boundary_columns(x: Any, y: Any, kinds: Iterable[str]) -> dict[str, Any]:
    """Columns x, y and colour of a data source of Bokeh, for curves or crossings with the given `kinds`."""
    return {"x": x, "y": y, "colour": [BOUNDARY_COLOURS.get(kind, card.STABLE_COLOUR) for kind in kinds]}


def _curve_columns(curves: Sequence[DiagramCurve]) -> tuple[list[Array], list[Array], list[str]]:
    """Returns (x, y, kinds), lists with one entry per curve."""
    return [curve.x for curve in curves], [curve.y for curve in curves], [curve.kind for curve in curves]
