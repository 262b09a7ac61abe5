"""Contents of a page: controls, pictures, tables and texts, and the pictures that each kind of answer
fills."""

from collections.abc import Callable, Mapping
from typing import Any

from bokeh.document import Document
from bokeh.events import DocumentReady, Pan, Tap
from bokeh.models import Button, CustomJS

from .controls import ChangeCallback, Controls
from .export_panel import ExportPanel
from .page_state import PageState
from .pictures.card import Card
from .pictures.diagram import DiagramPicture
from .pictures.growth_and_branches import BranchPicture, GrowthRatePicture
from .pictures.moving_arm import MovingArmPicture
from .pictures.numbers_table import NumbersTable
from .pictures.spectrum import ModePicture, SpectrumPicture
from .slider_scales import SLIDER_SCALES, length_axis, load_axis
from .solving.diagrams import can_follow_cycle_curves
from .templates_and_texts import SolvingIndicator, add_texts, style_sheet, template_text

NO_CYCLE_CURVES_FOUND_SENTENCE = "No folds and no torus points of cycles were found in this diagram."
"""Sentence above the diagram after a search that found no curves of cycles."""


class PageContents:
    """All Bokeh models of a page: controls, pictures, table, texts and buttons.

    changed: callback for a change of a control. on_load: callback for the text of a config file that the user
    loads.
    """

    def __init__(self, changed: ChangeCallback, on_load: Callable[[str], None]):
        widgets = style_sheet("widgets.css")
        texts = style_sheet("text.css")
        self.controls = Controls(changed, widgets)
        self.spectrum = SpectrumPicture()
        self.mode = ModePicture()
        self.growth = GrowthRatePicture()
        self.beating = MovingArmPicture()
        self.branches = BranchPicture()
        self.diagram = DiagramPicture()
        self.numbers = NumbersTable()
        self.sign = SolvingIndicator(name="working")
        self.sharing = ExportPanel(self.cards, self.beating.arm_line, on_load)
        self.buttons = {
            kind: Button(label=label, name=f"{name}_button", stylesheets=[widgets])
            for kind, name, label in (
                ("diagram", "diagram", "Solve the diagram around this point"),
                ("branch", "branches", "Solve the branches"),
                ("cycles", "cycles", "Add folds and torus points of cycles (minutes)"),
                ("film", "film", "Save a film (GIF)"),
                ("stop", "stop", "Stop"),
            )
        }
        for div in (card.message for card in self.cards):
            div.update(sizing_mode="stretch_width", stylesheets=[texts])

    @property
    def cards(self) -> list[Card]:
        """Cards of all pictures, see `Card`."""
        pictures = (self.spectrum, self.mode, self.growth, self.beating, self.branches, self.diagram)
        return [picture.card for picture in pictures]

    def add_to_document(self, document: Document, callbacks: Mapping[str, Callable[..., None]]) -> None:
        """Adds all models to a Bokeh document. callbacks: callbacks, by name of the button; "diagram_point"
        and "load" for clicks in pictures."""
        for kind, button in self.buttons.items():
            button.on_click(callbacks[kind])
        for event in (Tap, Pan):
            self.diagram.card.figure.on_event(event, callbacks["diagram_point"])
        for picture in (self.growth, self.branches):
            picture.card.figure.on_event(Tap, callbacks["load"])
        # Add models last: a document subscribes only to events that its models already handle.
        # Freeze: otherwise the document goes through all models after each root, which takes a second in all.
        with document.models.freeze():
            for root in (
                self.controls.root, self.sharing.root, *self.buttons.values(),
                *(card.root for card in self.cards),
            ):  # fmt: skip
                document.add_root(root)
            add_texts(document, (self.sign, self.numbers.root))
        colours = CustomJS(args={"figures": [c.figure for c in self.cards]}, code=template_text("colours.js"))
        document.js_on_event(DocumentReady, colours)
        document.js_on_event(DocumentReady, self.beating.animation_script())
        document.title = "rodsweep explore"
        document.template = template_text("page.html")
        document.template_variables["page_css"] = template_text("page.css")

    def show_state(self, state: PageState) -> None:
        """Marks the load and the second parameter of `state` in the diagram. Updates the pressure above the
        field of the largest force, the button for curves of cycles, the config and the Python lines."""
        self.controls.show_largest_pressure(state, load_axis(state))
        x, y = (
            SLIDER_SCALES[state.tab][name].value(state.visible_texts[name])
            for name in (state.load_name, state.second_parameter)
        )
        if x is not None and y is not None:
            self.diagram.mark_rod(x, y)
        self.buttons["cycles"].visible = can_follow_cycle_curves(state)
        self.sharing.update_exported_texts(state)

    def move_load_lines(self, state: PageState, F: float) -> None:
        """Moves the line that marks the load, in the pictures over the load, to the dimensionless force F, in
        k3/L^2."""
        for picture in (self.growth, self.branches):
            picture.load_line.location = F * load_axis(state).factor_from_dimensionless

    def show_solved_load(self, answer: dict[str, Any], state: PageState) -> None:
        """Marks the load of `state` in all pictures. answer: answer to the request "load", with the
        dimensionless force F."""
        self.move_load_lines(state, answer["F"])
        y = SLIDER_SCALES[state.tab][state.second_parameter].value(
            state.visible_texts[state.second_parameter]
        )
        if y is not None:
            self.diagram.mark_rod(answer["F"] * load_axis(state).factor_from_dimensionless, y)

    def show(self, kind: str, answer: dict[str, Any], state: PageState) -> None:
        """Draws the answer `answer` to a request of the kind `kind` in all pictures that show this answer,
        and updates the table of numbers; the answer "film" is saved as a file."""
        if kind == "load":
            self.show_solved_load(answer, state)
            return
        if kind == "spectrum":
            self.spectrum.show(answer)
            self.mode.show(answer)
        elif kind == "cycle":
            self.beating.show(answer, length_axis(state))
        elif kind == "bent":
            self.beating.show_arm_with_held_tip(answer)
        elif kind == "motion":
            self.beating.show_motion(answer)
        elif kind == "film":
            self.sharing.save_film(answer["gif"])
        elif kind == "thresholds":
            self.growth.show_thresholds(answer, load_axis(state))
        elif kind == "growth":
            self.growth.show_rates(answer, load_axis(state))
        elif kind == "branch":
            self.branches.show(answer, load_axis(state), length_axis(state))
        else:
            scales = SLIDER_SCALES[state.tab]
            self.diagram.show(answer, scales[state.load_name], scales[state.second_parameter])
            if kind == "cycles" and not answer["cycle_curves"]:
                self.diagram.card.show_sentence_above(NO_CYCLE_CURVES_FOUND_SENTENCE)
        self.numbers.show(kind, answer)

    def show_message(self, kind: str, sentence: str) -> None:
        """Shows a sentence in place of the pictures for requests of the kind `kind`; for requests on cycle
        curves, drags and films, above the picture. A request "load" has no picture of its own, and no
        sentence is shown."""
        if kind == "load":  # the pictures of the other kinds state why there is no load
            return
        self.numbers.show(kind, None)
        if kind == "cycle":
            self.beating.remove_all_shapes()
        if kind == "cycles":
            self.diagram.card.show_sentence_above(sentence)
            return
        if kind in ("bent", "motion", "film"):
            self.beating.remove_dragged_shape()
            self.beating.card.show_sentence_above(sentence)
            return
        by_kind = {
            "spectrum": (self.spectrum, self.mode), "cycle": (self.beating,), "thresholds": (self.growth,),
            "growth": (self.growth,), "branch": (self.branches,), "diagram": (self.diagram,),
        }  # fmt: skip
        for picture in by_kind[kind]:
            picture.card.show_sentence_instead(sentence)
