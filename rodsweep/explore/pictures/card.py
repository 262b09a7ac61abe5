"""Card of a picture (a figure, or a sentence in its place), and the common style of all figures."""

from collections.abc import Iterable, Sequence
from html import escape
from math import nan
from textwrap import wrap
from typing import Any

from bokeh.models import Column, ColumnDataSource, Div, InlineStyleSheet, Legend, LegendItem, Range1d, Span
from bokeh.plotting import figure

from ...arrays import Array, list_of

STABLE_COLOUR, UNSTABLE_COLOUR, NEUTRAL_COLOUR, POINT_COLOUR = "#2f86c6", "#e0672a", "#8a8a8a", "#c23b8f"
"""Colours of lines and marks, with enough contrast on light and on dark pages."""
FOLD_COLOUR, TORUS_COLOUR = "#8a63d2", "#2a9d5c"
"""Colours of curves of folds and of torus points of cycles."""
TICK_COUNT = 5
"""Desired number of tick labels along the lower axis."""
MIN_TICK_POWER_WITH_EXPONENT = 7
"""Tick labels below 10 to this power are written without an exponent."""
BLANK_TITLE_LINE = "\u00a0"
"""Blank line of a title (a no-break space). Bokeh never shows the title of a figure first drawn with an empty
title."""
MAX_TITLE_CHARACTERS = 46
"""Largest number of characters per line of a title; a longer line would be cut in the narrowest figure."""
AXIS_OPACITY_PROPERTIES = (
    "axis_line_alpha",
    "axis_label_text_alpha",
    "major_label_text_alpha",
    "major_tick_line_alpha",
    "minor_tick_line_alpha",
)
"""Names of the opacities of an axis: line, label, tick labels and tick marks."""
FIGURE_HEIGHT = 300
"""Height of a picture in pixels."""


AxisLimits = tuple[float, float]
"""Lower and upper limit of an axis."""


def new_figure(x: tuple[str, AxisLimits], y: tuple[str, AxisLimits], **options: Any) -> figure:
    """Empty Bokeh figure with the page's style, as wide as a column of the page. x, y: (label, limits) of the
    axes. options: keywords of Bokeh's `figure`."""
    plot = figure(
        height=FIGURE_HEIGHT, sizing_mode="stretch_width", tools="pan,wheel_zoom,box_zoom,reset,save",
        x_axis_label=x[0], y_axis_label=y[0], x_range=Range1d(*x[1]), y_range=Range1d(*y[1]), **options,
    )  # fmt: skip
    plot.toolbar.autohide = True  # moves the toolbar outside the frame, so that no button covers the plot
    plot.toolbar.logo = None
    plot.toolbar.active_drag = None
    plot.min_border_right = 10
    # The outermost half pixel of a canvas is white even on a dark page, so clip it. The canvas begins up to
    # half a pixel beside its layout.
    plot.stylesheets = [InlineStyleSheet(css=":host { clip-path: inset(2px); }")]
    plot.xaxis.ticker.desired_num_ticks = TICK_COUNT
    plot.xaxis.formatter.power_limit_high = MIN_TICK_POWER_WITH_EXPONENT
    return plot


def vertical_line(colour: str, dash: str = "solid") -> Span:
    """Vertical line at x = 0 over the whole height of a figure. When the line moves, Bokeh redraws
    only the top canvas."""
    look: dict[str, Any] = {"line_color": colour, "line_dash": dash, "line_width": 1.5}
    return Span(location=0, dimension="height", level="overlay", **look)


def add_line_legend(
    plot: figure, looks: Iterable[tuple[str, str, str]], line_width: float, visible: bool = True
) -> Legend:
    """Adds a legend of lines to a figure, and returns it. looks: (entry, colour, line style) of each line."""
    lines = {text: {"color": colour, "line_dash": dash} for text, colour, dash in looks}
    items = [
        LegendItem(label=text, renderers=[plot.line([nan], [nan], line_width=line_width, **look)])
        for text, look in lines.items()
    ]
    legend = Legend(items=items, location="top_left", visible=visible)
    plot.add_layout(legend)
    return legend


def empty_source(names: Sequence[str], name: str | None = None) -> ColumnDataSource:
    """Bokeh data source with the empty columns `names`."""
    return ColumnDataSource({column: [] for column in names}, name=name)


def source_columns(**arrays: Array) -> dict[str, list[Any]]:
    """Columns of a Bokeh data source, as lists by name. Bokeh would send each array in two separate
    messages."""
    return {name: list_of(array) for name, array in arrays.items()}


def axis_limits(values: Array, margin: float = 0.08) -> AxisLimits:
    """(lower, upper) limit of an axis for `values`, (n,): their range, widened at both ends by the fraction
    `margin`; (-1, 1) for an empty array."""
    if len(values) == 0:
        return -1.0, 1.0
    low = float(values.min())
    high = float(values.max())
    pad = margin * ((high - low) or abs(high) or 1.0)
    return low - pad, high + pad


def status_sentence(answer: dict[str, Any]) -> str:
    """Meaning of the status of the answer `answer`, followed by the solver's message if there is one."""
    return "; ".join(filter(None, (answer["sentence"], answer["message"])))


class Card:
    """A figure, or a sentence in its place. The axes of the figure are invisible until the first
    `show_figure`."""

    def __init__(self, name: str, figure: figure, title_lines: int = 1):
        """name: prefix of the names of the Bokeh models. title_lines: number of lines reserved for the title;
        further lines are cut until the browser lays out the figure again."""
        self.figure = figure
        self.title_lines = title_lines
        figure.name = f"{name}_figure"
        self.set_title("")
        self._set_axes_opacity(0.0)
        self.message = Div(name=f"{name}_message", visible=False, css_classes=["sentence"])
        self.root = Column(self.message, figure, name=name, sizing_mode="stretch_width")

    def set_title(self, text: str) -> None:
        """Sets the title of the figure, wrapped to lines of at most MAX_TITLE_CHARACTERS characters."""
        lines = wrap(text, MAX_TITLE_CHARACTERS)
        self.figure.title.text = "\n".join(lines + [BLANK_TITLE_LINE] * (self.title_lines - len(lines)))

    def set_axes(self, x: AxisLimits, y: AxisLimits, labels: tuple[str, str] | None = None) -> None:
        """Sets the limits of the axes, which are also the limits that the reset button of the figure
        restores. labels: labels of the two axes; None leaves them unchanged."""
        for axis_range, (start, end) in ((self.figure.x_range, x), (self.figure.y_range, y)):
            axis_range.update(start=start, end=end, reset_start=start, reset_end=end)
        if labels:
            self.figure.xaxis.axis_label, self.figure.yaxis.axis_label = labels

    def show_sentence_instead(self, sentence: str) -> None:
        """Hides the figure and shows a sentence in its place."""
        self.message.text = escape(sentence)
        self.message.visible = True
        self.figure.visible = False

    def show_sentence_above(self, sentence: str) -> None:
        """Shows a sentence above the figure, and the figure."""
        self.message.text = escape(sentence)
        self.message.visible = True
        self.figure.visible = True

    def show_figure(self) -> None:
        """Shows the figure with its axes."""
        self.message.visible = False
        self._set_axes_opacity(1.0)
        self.figure.visible = True

    def _set_axes_opacity(self, alpha: float) -> None:
        """Makes the axes transparent or opaque. Removing and adding axes instead would move the frame and
        leave parts of an earlier title. alpha: opacity, 0 or 1."""
        for axis in self.figure.axis:
            axis.update(**dict.fromkeys(AXIS_OPACITY_PROPERTIES, alpha))
