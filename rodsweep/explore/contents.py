"""Everything on a page: its controls, pictures, numbers and texts, and which answer fills which."""

from collections.abc import Callable, Mapping
from html import escape
from typing import Any

from bokeh.document import Document
from bokeh.events import DocumentReady, Pan, Tap
from bokeh.models import Button, Column, CustomJS, Div

from .controls import Changed, Controls
from .look import colours, read, sheet
from .pictures.beating import BeatingPicture
from .pictures.branches import BranchPicture
from .pictures.card import Card
from .pictures.diagram import DiagramPicture
from .pictures.growth import GrowthPicture
from .pictures.numbers import NumbersTable
from .pictures.spectrum import ModePicture, SpectrumPicture
from .scales import SCALES
from .state import PageState

SHOW_ADDRESS = 'history.replaceState(null, "", location.pathname + "?" + source.tags[0])'
"""The browser's address is the state."""


class Contents:
    """All models of a page. changed: called by the controls."""

    def __init__(self, changed: Changed):
        widgets, texts = sheet("widgets.css"), sheet("text.css")
        self.controls = Controls(changed, widgets)
        self.spectrum, self.mode, self.growth = SpectrumPicture(), ModePicture(), GrowthPicture()
        self.beating, self.branches, self.diagram = BeatingPicture(), BranchPicture(), DiagramPicture()
        self.numbers = NumbersTable()
        self.working = Div(name="working", css_classes=["working"], stylesheets=[texts])
        self.yaml, self.python = Div(name="yaml"), Div(name="python")
        self.address = Div(name="address", tags=[""])
        self.sharing = Column(
            self.yaml, self.python, self.address, name="sharing", sizing_mode="stretch_width"
        )
        self.buttons = {
            kind: Button(label=label, name=f"{name}_button", stylesheets=[widgets])
            for kind, name, label in (
                ("diagram", "diagram", "Solve the diagram around this point"),
                ("branch", "branches", "Solve the branches"),
            )
        }
        self.numbers.root.stylesheets = [texts]
        for div in (self.yaml, self.python, self.address, *(card.message for card in self.cards)):
            div.update(sizing_mode="stretch_width", stylesheets=[texts])

    @property
    def cards(self) -> list[Card]:
        """All pictures."""
        pictures = (self.spectrum, self.mode, self.growth, self.beating, self.branches, self.diagram)
        return [picture.card for picture in pictures]

    def connect(self, document: Document, react: Mapping[str, Callable[..., None]]) -> None:
        """Puts everything into a document. react: what to do on a click, by button or picture."""
        for root in (
            self.working, self.controls.root, self.numbers.root, self.sharing, *self.buttons.values(),
            *(card.root for card in self.cards),
        ):  # fmt: skip
            document.add_root(root)
        for kind, button in self.buttons.items():
            button.on_click(react[kind])
        for event in (Tap, Pan):
            self.diagram.card.figure.on_event(event, react["diagram_point"])
        for picture in (self.growth, self.branches):
            picture.card.figure.on_event(Tap, react["load"])
        self.address.js_on_change("tags", CustomJS(args={"source": self.address}, code=SHOW_ADDRESS))
        document.js_on_event(DocumentReady, colours([card.figure for card in self.cards]))
        document.js_on_event(DocumentReady, self.beating.animation())
        document.title = "rodsweep explore"
        document.template = read("page.html")
        document.template_variables["page_css"] = read("page.css")

    def show_point(self, state: PageState, F: float) -> None:
        """Shows where the point is, and how it is written elsewhere."""
        self.growth.move_point(F)
        self.branches.move_point(F)
        load, second = SCALES[state.tab][state.load], SCALES[state.tab][state.second]
        x, y = load.value(state.values[state.load]), second.value(state.values[state.second])
        if x is not None and y is not None:
            self.diagram.move_point(x, y)
        query = state.address()
        self.address.tags = [query]
        self.address.text = f'<a href="?{escape(query)}">This page as an address</a>'
        self.yaml.text = f"<pre>{escape(state.yaml('limit_cycle'))}</pre>"
        self.python.text = f"<pre>{escape(state.python())}</pre>"

    def show(self, kind: str, found: dict[str, Any], state: PageState) -> None:
        """Fills the pictures that an answer belongs to."""
        self.numbers.show(kind, found)
        if kind == "spectrum":
            self.spectrum.show(found)
            self.mode.show(found)
        elif kind == "cycle":
            self.beating.show(found)
        elif kind == "thresholds":
            self.growth.show_thresholds(found)
        elif kind == "growth":
            self.growth.show_rates(found)
        elif kind == "branch":
            self.branches.show(found)
        else:
            scales = SCALES[state.tab]
            self.diagram.show(found, scales[state.load], scales[state.second])

    def say(self, kind: str, sentence: str) -> None:
        """Shows a sentence in place of the pictures of a question."""
        self.numbers.show(kind, None)
        if kind == "cycle":
            self.beating.stop()
        by_kind = {
            "spectrum": (self.spectrum, self.mode), "cycle": (self.beating,), "thresholds": (self.growth,),
            "growth": (self.growth,), "branch": (self.branches,), "diagram": (self.diagram,),
        }  # fmt: skip
        for picture in by_kind[kind]:
            picture.card.say(sentence)
