"""Template, style sheets and scripts of the page. The browser's preference selects light or dark colours."""

from collections.abc import Sequence
from pathlib import Path

from bokeh.models import CustomJS, InlineStyleSheet
from bokeh.plotting import figure

TEMPLATE_FOLDER = Path(__file__).parent / "templates"
"""Directory of the templates, style sheets and scripts."""


def template_text(name: str) -> str:
    """Text of the file `name` in TEMPLATE_FOLDER."""
    return (TEMPLATE_FOLDER / name).read_text(encoding="utf-8")


def style_sheet(name: str) -> InlineStyleSheet:
    """Style sheet for Bokeh's widgets, from the file `name` in TEMPLATE_FOLDER. A widget inherits the colours
    of the page, but not its style sheets."""
    return InlineStyleSheet(css=template_text(name))


def colour_script(figures: Sequence[figure]) -> CustomJS:
    """Browser script that gives the figures the colours of the light or dark colour scheme, at once and after
    every change of the scheme."""
    return CustomJS(args={"figures": list(figures)}, code=template_text("colours.js"))
