"""Template and style sheets of the page, light or dark according to the browser's preference."""

from collections.abc import Sequence
from pathlib import Path

from bokeh.models import CustomJS, InlineStyleSheet
from bokeh.plotting import figure

TEMPLATES = Path(__file__).parent / "templates"


def read(name: str) -> str:
    """Text of a template."""
    return (TEMPLATES / name).read_text(encoding="utf-8")


def sheet(name: str) -> InlineStyleSheet:
    """A style sheet for widgets, which inherit colours, but not style sheets, from the page."""
    return InlineStyleSheet(css=read(name))


def colours(figures: Sequence[figure]) -> CustomJS:
    """Code of the browser that colours the figures, now and whenever the colour scheme changes."""
    return CustomJS(args={"figures": list(figures)}, code=read("colours.js"))
