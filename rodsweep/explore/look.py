"""Template and style sheets of the page, light and dark as the browser asks for."""

from collections.abc import Sequence
from pathlib import Path

from bokeh.models import CustomJS, InlineStyleSheet
from bokeh.plotting import figure

TEMPLATES = Path(__file__).parent / "templates"


def read(name: str) -> str:
    """Text of a template."""
    return (TEMPLATES / name).read_text(encoding="utf-8")


def sheet(name: str) -> InlineStyleSheet:
    """A style sheet for widgets, which do not see those of the page but its colours."""
    return InlineStyleSheet(css=read(name))


def colours(figures: Sequence[figure]) -> CustomJS:
    """What the browser runs once: colours of the figures, and again when its colour scheme changes."""
    return CustomJS(args={"figures": list(figures)}, code=read("colours.js"))
