"""One page, in one browser tab: state, questions being solved, and pictures."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from bokeh.document import Document
from bokeh.events import Pan, Tap

from ..errors import InputError
from .contents import PageContents
from .scales import SCALES
from .sharing import state_of_text
from .solving.diagrams import uniform
from .solving.questions import Question, Reply
from .solving.solvers import Solvers
from .state import PageState, from_address, rod_of

AT_ONCE = ("spectrum", "cycle", "thresholds", "growth")
"""Kinds of questions that are asked after every change."""
WHEN_IDLE = ("branch", "diagram")
"""Kinds of questions that take seconds, and are asked after a pause of `IDLE`."""
IDLE = 900
"""Milliseconds without a change after which the slow questions are asked."""
NAMES = {"thresholds": "thresholds", "growth": "growth rates", "branch": "branches"}
"""Names of kinds in the sign "solving ..."; a missing kind is its own name."""


class Page:
    """Connects controls, solvers and pictures of one session.

    session: name of the session. stored: answer to the question `diagram` from a result file, or None.
    """

    def __init__(
        self, document: Document, solvers: Solvers, state: PageState, stored: dict[str, Any] | None = None
    ):
        self.document = document
        self.solvers = solvers
        self.state = state
        self.session = f"page-{id(self)}"
        self.is_open = True
        self.solving: set[str] = set()
        self.asked: dict[str, PageState] = {}
        """The part of the state, `needs`, that the latest question of each kind depends on."""
        self.contents = PageContents(self.change, self.load)
        self._idle: Callable[[], None] | None = None
        self.contents.connect(document, self._connections())
        if stored is not None:
            self.asked["diagram"] = needs("diagram", state)
            self.contents.show("diagram", stored, state)

    def open(self, query: str) -> None:
        """Shows the state of an address; query: the address after "?"."""
        try:
            self._change_to(from_address(query, self.state))
        except InputError as error:
            self._change_to(self.state)
            self._refuse(str(error))

    def load(self, text: str) -> None:
        """Shows the rod or arm of a config; text: the config in YAML."""
        try:
            self._change_to(state_of_text(text))
        except InputError as error:
            self._refuse(str(error))

    def close(self) -> None:
        """Cancels all questions of this page."""
        self.is_open = False
        self.solvers.forget(self.session)

    def change(self, values: dict[str, str] | None = None, **changed: Any) -> None:
        """Applies a change of the controls. values: texts by name. changed: other fields of the state."""
        state = replace(self.state, **changed)
        self._change_to(state.with_values(**values) if values else state)

    def solve(self, kind: str) -> None:
        """Asks a question now, even if its answer is already shown."""
        self.asked.pop(kind, None)
        self._ask(kind)

    def _connections(self) -> dict[str, Callable[..., None]]:
        return {
            "branch": lambda: self.solve("branch"),
            "diagram": lambda: self.solve("diagram"),
            "diagram_point": self._move_in_diagram,
            "load": self._move_load,
        }

    def _change_to(self, state: PageState) -> None:
        self.state = state
        self.contents.controls.show(state)
        try:
            subject = state.subject()
            state.largest_force()
            F = rod_of(subject).get("F")
            if F is None:
                raise InputError(f"parameters.{state.load} is missing; give the load")
        except InputError as error:
            self._refuse(str(error))
            return
        self.contents.show_point(state, F)
        for kind in AT_ONCE:
            self._ask(kind)
        self._rest()

    def _refuse(self, sentence: str) -> None:
        """Shows a sentence instead of all pictures except a drawn diagram, and cancels all questions."""
        for kind in (*AT_ONCE, *WHEN_IDLE):
            if kind != "diagram" or kind in self.solving:
                self.asked.pop(kind, None)
            if kind in self.solving:
                self.solvers.drop(self.session, kind)
            if kind != "diagram" or not self.contents.diagram.is_drawn:
                self.contents.say(kind, sentence)
        self.solving.clear()
        self._show_solving()

    def _rest(self) -> None:
        """Schedules the slow questions after the pause `IDLE`; a further change restarts the pause."""
        if self._idle is not None:
            self.document.remove_timeout_callback(self._idle)
        self._idle = self.document.add_timeout_callback(self._rested, IDLE)

    def _rested(self) -> None:
        self._idle = None
        for kind in WHEN_IDLE:
            if needs(kind, self.state) == self.asked.get(kind):
                continue
            if self.state.tab == "rod" and not uniform(self.state):
                self.asked.pop(kind, None)
                self.contents.say(kind, "This takes a minute for such an arm: press the button below.")
                continue
            self._ask(kind)

    def _ask(self, kind: str) -> None:
        wanted = needs(kind, self.state)
        if self.asked.get(kind) == wanted:
            return
        self.asked[kind] = wanted
        self.solving.add(kind)
        self._show_solving()
        question = Question(kind, self.state)
        self.solvers.ask(self.session, question, lambda reply: self._receive(question, reply))

    def _receive(self, question: Question, reply: Reply) -> None:
        """Passes a reply to the document's event loop, because only code there may change the document."""
        if self.is_open:
            self.document.add_next_tick_callback(lambda: self._answered(question, reply))

    def _answered(self, question: Question, reply: Reply) -> None:
        kind = question.kind
        newest = self.asked.get(kind)
        if newest is None:  # the user has entered invalid values meanwhile
            return
        if newest == needs(kind, question.state):
            self.solving.discard(kind)
            self._show_solving()
        if reply.outcome == "answer":
            self.contents.show(kind, reply.content, question.state)
        else:
            self.contents.say(kind, reply.content["sentence"])

    def _show_solving(self) -> None:
        names = [NAMES.get(kind, kind) for kind in (*AT_ONCE, *WHEN_IDLE) if kind in self.solving]
        self.contents.working.text = f"solving {', '.join(names)} ..." if names else ""

    def _move_in_diagram(self, event: Tap | Pan) -> None:
        if event.x is None or event.y is None or event.y <= 0:
            return
        scales = SCALES[self.state.tab]
        load = self.state.load
        second = self.state.second
        self.change({load: scales[load].text(event.x), second: scales[second].text(event.y)})

    def _move_load(self, event: Tap) -> None:
        """Moves the load to the x of a click."""
        if event.x is not None:
            self.change({self.state.load: SCALES[self.state.tab][self.state.load].text(event.x)})


def needs(kind: str, state: PageState) -> PageState:
    """The state with blanks for all fields that the answer to a kind of question does not depend on."""
    if kind in ("spectrum", "cycle"):
        return replace(state, across="", F_max="")
    blank = {state.load: ""}
    if kind == "diagram":
        return state.with_values(**blank, **{state.second: ""})
    return replace(state.with_values(**blank), across="")
