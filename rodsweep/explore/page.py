"""A page in a browser tab: its state, its pictures, and the requests being solved for it."""

from collections.abc import Callable
from dataclasses import replace
from html import escape
from typing import Any

from bokeh.document import Document
from bokeh.events import Pan, Tap

from ..errors import InputError
from .answers_from_file import AnswersFromFile
from .controls import PauseTimer
from .export_panel import state_from_config_text
from .page_contents import PageContents
from .page_state import PageState, dimensionless_parameters_of, from_address
from .slider_scales import SLIDER_SCALES
from .solving import request_inputs as kinds
from .solving.diagrams import has_uniform_linear_rods
from .solving.dragged_tip import TipPosition
from .solving.request_inputs import AnswerInputs, inputs_of_request, state_to_solve
from .solving.requests import Reply, SolveRequest
from .solving.solver_processes import SolverProcesses
from .templates_and_texts import REQUEST_KIND_WORDS, SLOW_SOLVE_SENTENCE, SOLVE_STOPPED_SENTENCE


class Page:
    """Page in a browser tab. stored: answers from a result file, used instead of solves, or None."""

    def __init__(
        self,
        document: Document,
        solvers: SolverProcesses,
        state: PageState,
        stored: AnswersFromFile | None = None,
    ):
        self.document = document
        self.solvers = solvers
        self.state = state
        self.stored = stored
        self.session = f"page-{id(self)}"
        self.is_open = True
        self.solving: set[str] = set()
        self.progress: dict[str, str] = {}
        """Progress of each running solve, as text, by kind of request."""
        self.latest_inputs: dict[str, AnswerInputs] = {}
        """`inputs_of_request` of the latest request of each kind."""
        self.drawn_around: PageState | None = None
        """State of the page for which the drawn diagram was solved; None before a solver has answered."""
        self.contents = PageContents(self.change, self.load_config)
        self.pause_timer = PauseTimer(document, self._send_slow_requests)
        self.contents.add_to_document(document, self._callbacks())
        self.contents.beating.on_drag(self.request_tip_answer)
        if stored is not None and stored.diagram is not None:
            self.latest_inputs["diagram"] = inputs_of_request(SolveRequest("diagram", state))
            self.contents.show("diagram", stored.diagram, state)

    def show_address(self, query: str) -> None:
        """Shows the state of an address, or an error message; query: part of the address after "?"."""
        try:
            self._change_to(from_address(query, self.state))
        except InputError as error:
            self._change_to(self.state)
            self._show_error(str(error))

    def load_config(self, text: str) -> None:
        """Shows the rod or the arm of a config, or an error message; text: the config in YAML."""
        try:
            loaded_state = state_from_config_text(text, self.state.F_max)
            self._change_to(replace(loaded_state, across=loaded_state.across or self.state.across))
        except InputError as error:
            self._show_error(str(error))

    def close(self) -> None:
        """Cancels all unanswered requests of this page."""
        self.is_open = False
        self.solvers.cancel_session(self.session)

    def change(self, values: dict[str, str] | None = None, **changed: Any) -> None:
        """Changes the state. values: new texts of visible controls. changed: other changed fields."""
        state = replace(self.state, **changed)
        self._change_to(state.with_values(**values) if values else state)

    def solve(self, kind: str, tip: TipPosition | None = None) -> None:
        """Sends a request of the kind `kind` to its solver process, even if its answer is already stored or
        shown. tip: position, in L, at which the tip was released; None if no tip was dragged."""
        self._cancel_request(kind)
        self._send_request(kind, tip, is_solved_again=True)
        self._show_solving()

    def stop_long_solves(self) -> None:
        """Cancels long solves. Pictures of automatic requests show a sentence; a dragged shape is removed."""
        for kind in kinds.STOPPABLE_REQUEST_KINDS:
            if kind in self.solving:
                self._cancel_request(kind)
                if kind in kinds.TIP_REQUEST_KINDS:
                    self.contents.beating.remove_dragged_shape()
                elif kind not in kinds.MANUAL_REQUEST_KINDS:
                    self.contents.show_message(kind, SOLVE_STOPPED_SENTENCE)
        self._show_solving()

    def request_tip_answer(self, kind: str, tip: TipPosition) -> None:
        """Requests the shape with the tip held at `tip`, in L (kind "bent"), or the motion after the tip is
        released there (kind "motion"). A request of the other kind is cancelled."""
        for tip_kind in kinds.TIP_REQUEST_KINDS:
            if tip_kind != kind:
                self._cancel_request(tip_kind)
        self._send_request(kind, tip)
        self._show_solving()

    def _cancel_request(self, kind: str) -> None:
        """Cancels the request of the kind `kind`; an answer that arrives later is ignored."""
        self.latest_inputs.pop(kind, None)
        if kind in self.solving:
            self.solving.discard(kind)
            self.solvers.cancel(self.session, kind)

    def _callbacks(self) -> dict[str, Callable[..., None]]:
        return {
            "branch": lambda: self.solve("branch"),
            "diagram": lambda: self.solve("diagram"),
            "diagram_point": self._select_rod_in_diagram,
            "film": lambda: self.solve("film", self.latest_inputs.get("motion", (None, None))[1]),
            "cycles": lambda: self.solve("cycles"),
            "load": self._select_load,
            "stop": self.stop_long_solves,
        }

    def _change_to(self, state: PageState) -> None:
        self.state = state
        self.contents.controls.show(state)
        try:
            rod_or_arm = state.rod_or_arm()
            state.largest_force()
            F = None if state.has_relative_load else dimensionless_parameters_of(rod_or_arm).get("F")
            if F is None and not state.has_relative_load:
                section = "parameters.arm" if state.tab == "arm" else "parameters"
                raise InputError(f"{section}.{state.load_name} is missing; give the load")
        except InputError as error:
            self._show_error(str(error))
            return
        for kind in (kinds.LOAD_REQUEST_KIND, *kinds.TIP_REQUEST_KINDS, *kinds.MANUAL_REQUEST_KINDS):
            self._cancel_request(kind)
        if F is None:
            self._send_request(kinds.LOAD_REQUEST_KIND)
        for kind in kinds.REQUEST_KINDS_AFTER_EVERY_CHANGE:
            self._send_request(kind)
        self.contents.show_state(state)
        if F is not None:
            self.contents.move_load_lines(state, F)
        self._show_solving()
        self.pause_timer.restart()

    def _show_error(self, sentence: str) -> None:
        """Cancels all solves, and shows `sentence` in place of all pictures except a drawn diagram."""
        self.pause_timer.cancel()
        for kind in (kinds.LOAD_REQUEST_KIND, *kinds.TIP_REQUEST_KINDS, *kinds.MANUAL_REQUEST_KINDS):
            self._cancel_request(kind)
        for kind in (*kinds.REQUEST_KINDS_AFTER_EVERY_CHANGE, *kinds.IDLE_REQUEST_KINDS):
            if kind != "diagram" or kind in self.solving:
                self._cancel_request(kind)
            if kind != "diagram" or not self.contents.diagram.is_drawn:
                self.contents.show_message(kind, sentence)
        self._show_solving()

    def _send_slow_requests(self) -> None:
        self.contents.sharing.show_texts()
        for kind in kinds.IDLE_REQUEST_KINDS:
            if inputs_of_request(SolveRequest(kind, self.state)) == self.latest_inputs.get(kind):
                continue
            if self.state.tab == "rod" and not has_uniform_linear_rods(self.state):
                self.latest_inputs.pop(kind, None)
                self.contents.show_message(kind, SLOW_SOLVE_SENTENCE)
                continue
            self._send_request(kind)
        self._show_solving()

    def _send_request(self, kind: str, tip: TipPosition | None = None, is_solved_again: bool = False) -> None:
        """Sends a request of the kind `kind`, unless the latest request of this kind has the same inputs. A
        stored answer replaces the solve, unless `is_solved_again`. tip: position of the dragged tip, in L."""
        state = state_to_solve(kind, self.state, self.drawn_around)
        cycle_file = self.stored if (kind, tip) == ("film", None) else None
        cycle = None if cycle_file is None else cycle_file.cycle_for_film(state)
        request = SolveRequest(kind, state, tip, cycle)
        inputs = inputs_of_request(request)
        if self.latest_inputs.get(kind) == inputs:
            return
        self.latest_inputs[kind] = inputs
        stored = None if self.stored is None or is_solved_again else self.stored.answer(kind, self.state)
        if stored is not None:
            self._cancel_request(kind)
            self.latest_inputs[kind] = inputs
            self.contents.show(kind, stored, self.state)
            return
        self.solving.add(kind)
        self.progress.pop(kind, None)

        def receive(reply: Reply) -> None:
            if self.is_open:  # only the event loop of the document may change the document
                self.document.add_next_tick_callback(lambda: self._on_answer(request, reply))

        self.solvers.ask(self.session, request, receive, receive)

    def _on_answer(self, request: SolveRequest, reply: Reply) -> None:
        kind = request.kind
        if (newest := self.latest_inputs.get(kind)) is None:  # the user has entered invalid values meanwhile
            return
        is_newest = newest == inputs_of_request(request)
        if reply.outcome == "progress":
            if is_newest and kind in self.solving:
                fraction = reply.content["completed_fraction"]
                percent = "" if fraction is None else f", {fraction:.0%}"
                self.progress[kind] = f" ({escape(reply.content['text'])}{percent})"
                self._show_solving()
            return
        if is_newest:
            self.solving.discard(kind)
        elif kind in kinds.TIP_REQUEST_KINDS:
            return
        if reply.outcome == "answer":
            if kind == "cycles":
                self.latest_inputs["diagram"] = inputs_of_request(replace(request, kind="diagram"))
            if kind in ("cycles", "diagram"):
                self.drawn_around = request.state
            self.contents.show(kind, reply.content, request.state)
        else:
            self.contents.show_message(kind, reply.content["sentence"])
        self._show_solving()

    def _show_solving(self) -> None:
        automatic = (kinds.LOAD_REQUEST_KIND, *kinds.REQUEST_KINDS_AFTER_EVERY_CHANGE)
        others = (*kinds.IDLE_REQUEST_KINDS, *kinds.MANUAL_REQUEST_KINDS)
        solving = [kind for kind in (*automatic, *others) if kind in self.solving]
        is_stoppable = any(kind in kinds.STOPPABLE_REQUEST_KINDS for kind in solving)
        names = [REQUEST_KIND_WORDS.get(kind, kind) + self.progress.get(kind, "") for kind in solving]
        text = f"solving {', '.join(names)} ..." if names else ""
        self.contents.sign.update(text=text, kinds=solving, is_stoppable=is_stoppable)

    def _select_rod_in_diagram(self, event: Tap | Pan) -> None:
        if event.x is None or event.y is None or event.y <= 0:
            return
        values = {self.state.load_name: event.x, self.state.second_parameter: event.y}
        self.change({name: SLIDER_SCALES[self.state.tab][name].text(value) for name, value in values.items()})

    def _select_load(self, event: Tap) -> None:
        """Sets the load to the horizontal position of a click."""
        if event.x is not None:
            load = event.x if self.stored is None else self.stored.load_selected_by_click(self.state, event.x)
            name = self.state.load_name
            self.change({name: SLIDER_SCALES[self.state.tab][name].text(load)})
