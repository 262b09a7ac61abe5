"""Texts that change with every answer, in elements outside of Bokeh's layout: each change of a `Div` is a new
layout of the whole page.
"""

from collections.abc import Sequence

from bokeh.core.properties import Bool, String
from bokeh.document import Document
from bokeh.events import DocumentReady
from bokeh.model import DataModel
from bokeh.models import CustomJS

from .look import read


class PageText(DataModel):
    """HTML of the element in which the template embeds this model."""

    text = String(default="")


class SolvingSign(PageText):
    """The sign "solving ..."; `is_stoppable`: whether the button "Stop" is shown beside it."""

    is_stoppable = Bool(default=False)


def show_texts(document: Document, texts: Sequence[PageText]) -> None:
    """Adds texts to a document, with the code of the browser that shows them."""
    for text in texts:
        document.add_root(text)
        shown = CustomJS(args={"text": text}, code=read("text.js"))
        for name in text.properties() & {"text", "is_stoppable"}:
            text.js_on_change(name, shown)
        document.js_on_event(DocumentReady, shown)
