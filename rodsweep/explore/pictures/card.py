"""A picture of the page, or a sentence instead of the picture."""

from collections.abc import Sequence
from html import escape
from textwrap import wrap
from typing import Any

from bokeh.models import Column, ColumnDataSource, Div, InlineStyleSheet, Range1d, Span
from bokeh.plotting import figure

from ...arrays import Array

STABLE, UNSTABLE, NEUTRAL, POINT = "#2f86c6", "#e0672a", "#8a8a8a", "#c23b8f"
"""Colours with enough contrast on white and dark pages."""
FOLD, TORUS = "#8a63d2", "#2a9d5c"
"""Colours of curves of special points of cycles."""
TICKS = 5
"""Approximate number of labels along the lower axis."""
PLAIN_DIGITS = 7
"""Largest power of ten that labels show without an exponent."""
NO_TITLE = "\u00a0"
"""A line of a title without words: a picture that is drawn with an empty title shows no later one."""
TITLE_WIDTH = 46
"""Largest number of characters in a line of a title: the narrowest figure would cut a longer line."""
AXIS_ALPHAS = (
    "axis_line_alpha",
    "axis_label_text_alpha",
    "major_label_text_alpha",
    "major_tick_line_alpha",
    "minor_tick_line_alpha",
)
"""Opacities of all that an axis paints."""
HEIGHT = 300
"""Height of a picture in pixels."""


def new_figure(x_label: str, y_label: str, tooltips: Any = None, **options: Any) -> figure:
    """An empty figure as wide as the column of the page."""
    made = figure(
        height=HEIGHT, sizing_mode="stretch_width", tools="pan,wheel_zoom,box_zoom,reset,save",
        x_axis_label=x_label, y_axis_label=y_label, tooltips=tooltips, **options,
    )  # fmt: skip
    made.toolbar.autohide = True  # beside the frame, so that no button covers a place to click
    made.toolbar.logo = None
    made.toolbar.active_drag = None
    made.min_border_right = 10
    # The outermost half pixel of a canvas is white even on a dark page, so clip it.
    made.stylesheets = [InlineStyleSheet(css=":host { clip-path: inset(1px); }")]
    made.xaxis.ticker.desired_num_ticks = TICKS
    made.xaxis.formatter.power_limit_high = PLAIN_DIGITS
    return made


def vertical_line(at: float, colour: str, dash: str = "solid") -> Span:
    """A vertical line over the full height of a figure; a move paints only the figure's upper canvas."""
    return Span(
        location=at, dimension="height", line_color=colour, line_dash=dash, line_width=1.5, level="overlay"
    )  # fmt: skip


def empty_source(names: Sequence[str], name: str | None = None) -> ColumnDataSource:
    """A data source with empty columns `names`."""
    return ColumnDataSource({each: [] for each in names}, name=name)


def columns(**arrays: Array) -> dict[str, list[Any]]:
    """Columns of a data source, converted to lists: a short array would take two messages of its own."""
    return {name: array.tolist() for name, array in arrays.items()}


def limits(values: Array, margin: float = 0.08) -> tuple[float, float]:
    """Smallest and largest of values, (n,), with a relative margin; (-1, 1) without values."""
    if len(values) == 0:
        return -1.0, 1.0
    low = float(values.min())
    high = float(values.max())
    pad = margin * ((high - low) or abs(high) or 1.0)
    return low - pad, high + pad


def show_range(axis: Range1d, start: float, end: float) -> None:
    """Sets the ends of an axis, and the ends to which the reset button of the figure returns."""
    axis.update(start=start, end=end, reset_start=start, reset_end=end)


def sentence_of(found: dict[str, Any]) -> str:
    """Meaning of an answer's status, and the solver's message."""
    return "; ".join(filter(None, (found["sentence"], found["message"])))


class Card:
    """A figure that can be replaced by a sentence. It has no axes until it shows something."""

    def __init__(self, name: str, figure: figure, title_lines: int = 1):
        """title_lines: room for the title; a longer one is cut until the browser lays the figure out."""
        self.figure = figure
        self.title_lines = title_lines
        figure.name = f"{name}_figure"
        self._paint_axes(0.0)
        self.message = Div(name=f"{name}_message", visible=False, css_classes=["sentence"])
        self.root = Column(self.message, figure, name=name, sizing_mode="stretch_width")

    def entitle(self, text: str) -> None:
        """Writes a title, which may be empty, in lines that fit above the figure."""
        lines = wrap(text, TITLE_WIDTH)
        self.figure.title.text = "\n".join(lines + [NO_TITLE] * (self.title_lines - len(lines)))

    def say(self, sentence: str) -> None:
        """Shows a sentence instead of the figure."""
        self.message.text = escape(sentence)
        self.message.visible = True
        self.figure.visible = False

    def tell(self, sentence: str) -> None:
        """Shows a sentence above the picture."""
        self.message.text = escape(sentence)
        self.message.visible = True
        self.figure.visible = True

    def reveal(self) -> None:
        """Shows the figure with its axes."""
        self.message.visible = False
        self._paint_axes(1.0)
        self.figure.visible = True

    def _paint_axes(self, alpha: float) -> None:
        """Makes the axes transparent or opaque. Axes that come and go would move the frame and leave parts of
        an earlier title.
        """
        for axis in self.figure.axis:
            axis.update(**dict.fromkeys(AXIS_ALPHAS, alpha))
