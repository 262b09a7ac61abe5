"""Template, style sheets and scripts of the page, and texts that change with every answer. These texts are
outside Bokeh's layout, because each change of a Bokeh `Div` causes a new layout of the whole page."""

from collections.abc import Sequence
from pathlib import Path

from bokeh.core.properties import Bool, List, String
from bokeh.document import Document
from bokeh.events import DocumentReady
from bokeh.model import DataModel
from bokeh.models import CustomJS, InlineStyleSheet

TEMPLATE_FOLDER = Path(__file__).parent / "templates"
"""Directory of the templates, style sheets and scripts."""


def template_text(name: str) -> str:
    """Text of the file `name` in TEMPLATE_FOLDER."""
    return (TEMPLATE_FOLDER / name).read_text(encoding="utf-8")


def style_sheet(name: str) -> InlineStyleSheet:
    """Style sheet for Bokeh's widgets, from the file `name` in TEMPLATE_FOLDER. A widget inherits the colours
    of the page, but not its style sheets."""
    return InlineStyleSheet(css=template_text(name))


REQUEST_KIND_WORDS = {"cycles": "folds and torus points", "growth": "growth rates", "branch": "branches"}
"""Name of a kind of request in the text "solving ..."; a kind that is not listed is its own name."""
SOLVE_STOPPED_SENTENCE = "Stopped. A change of the rod starts the solve again."
"""Sentence shown in place of a picture after the user has stopped its solve."""
SLOW_SOLVE_SENTENCE = "The solve takes a minute for such a rod; press the button below to start."
"""Sentence shown in place of a picture of rods that are not uniform or not of linear material."""


class PageText(DataModel):
    """HTML text that the browser inserts where the template embeds this model."""

    text = String(default="")


class SolvingIndicator(PageText):
    """The text "solving ...". kinds: kinds of requests being solved; the numbers and pictures of these kinds
    fade, because they belong to an earlier state. is_stoppable: whether the button "Stop" is visible next to
    the text."""

    kinds = List(String)
    is_stoppable = Bool(default=False)


def add_texts(document: Document, texts: Sequence[PageText]) -> None:
    """Adds texts to a Bokeh document, with a browser script that displays every change."""
    for text in texts:
        document.add_root(text)
        callback = CustomJS(args={"text": text}, code=template_text("text.js"))
        for name in text.properties() & {"text", "kinds", "is_stoppable"}:
            text.js_on_change(name, callback)
        document.js_on_event(DocumentReady, callback)
