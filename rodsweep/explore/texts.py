"""Texts of the page that change with every answer. These texts are outside Bokeh's layout, because each
change of a Bokeh `Div` causes a new layout of the whole page.
"""

from collections.abc import Sequence

from bokeh.core.properties import Bool, List, String
from bokeh.document import Document
from bokeh.events import DocumentReady
from bokeh.model import DataModel
from bokeh.models import CustomJS

from .page_style import template_text


class PageText(DataModel):
    """HTML text that the browser inserts where the template embeds this model."""

    text = String(default="")


class SolvingSign(PageText):
    """The text "solving ...". kinds: kinds of questions being solved; the numbers and pictures of these kinds
    fade, because they belong to an earlier state. is_stoppable: whether the button "Stop" is visible next to
    the text.
    """

    kinds = List(String)
    is_stoppable = Bool(default=False)


def add_texts(document: Document, texts: Sequence[PageText]) -> None:
    """Adds texts to a Bokeh document, with a browser script that displays every change."""
    for text in texts:
        document.add_root(text)
        shown = CustomJS(args={"text": text}, code=template_text("text.js"))
        for name in text.properties() & {"text", "kinds", "is_stoppable"}:
            text.js_on_change(name, shown)
        document.js_on_event(DocumentReady, shown)
