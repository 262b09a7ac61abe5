"""Template, style sheets and scripts of the page. Its colours are light or dark as the browser prefers."""

from collections.abc import Sequence
from pathlib import Path

from bokeh.models import CustomJS, InlineStyleSheet
from bokeh.plotting import figure

TEMPLATES = Path(__file__).parent / "templates"
"""Directory of the templates, style sheets and scripts."""


def read(name: str) -> str:
    """Text of the file `name` in TEMPLATES."""
    return (TEMPLATES / name).read_text(encoding="utf-8")


def sheet(name: str) -> InlineStyleSheet:
    """Style sheet for Bokeh's widgets from the file `name`. Widgets inherit colours, but no style sheet, from
    the page.
    """
    return InlineStyleSheet(css=read(name))


def colours(figures: Sequence[figure]) -> CustomJS:
    """Browser script that colours the figures for the light or dark colour scheme, now and after every change
    of the scheme.
    """
    return CustomJS(args={"figures": list(figures)}, code=read("colours.js"))
