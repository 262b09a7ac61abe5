"""When each kind of request is sent to a solver, and the inputs of its answer: part of the page's state, and
the position of the dragged tip.

A request is sent again only if an input of its answer has changed, or if the user presses a button.
"""

from dataclasses import replace

from ..page_state import PageState
from .diagrams import second_parameter_values
from .dragged_tip import TipPosition
from .requests import SolveRequest

AnswerInputs = tuple[PageState, TipPosition | None]
"""Part of the page's state, and position of the dragged tip, on which an answer depends."""
REQUEST_KINDS_AFTER_EVERY_CHANGE = ("spectrum", "cycle", "thresholds", "growth")
"""Kinds of requests that are sent after every change of the controls."""
LOAD_REQUEST_KIND = "load"
"""Kind of the request for the load of an arm. The request is sent after a change of the controls if the load
is relative to flutter, because only a solver process may search for the flutter threshold."""
IDLE_REQUEST_KINDS = ("branch", "diagram")
"""Kinds of requests that take seconds; they are sent once the controls have not changed for
`PAUSE_MILLISECONDS`."""
MANUAL_REQUEST_KINDS = ("motion", "film", "cycles")
"""Kinds of requests that are sent only when the user presses a button or drags the tip. A change of the rod
cancels these requests."""
STOPPABLE_REQUEST_KINDS = ("cycle", *IDLE_REQUEST_KINDS, *MANUAL_REQUEST_KINDS)
"""Kinds of requests that the button "Stop" cancels."""
TIP_REQUEST_KINDS = ("bent", "motion")
"""Kinds of requests about a dragged tip. An answer for an earlier position of the tip is not shown."""


def inputs_of_request(request: SolveRequest) -> AnswerInputs:
    """Returns (state, tip). state: copy of the request's state in which all values without effect on the
    answer are blank. tip: position of the tip if the answer depends on the tip, else None."""
    kind = request.kind
    state = request.state
    if kind in ("spectrum", "cycle", "film", LOAD_REQUEST_KIND, *TIP_REQUEST_KINDS):
        return replace(state, across="", F_max=""), request.tip
    blank = {state.load_name: ""}
    if kind in ("diagram", "cycles"):
        return state.with_values(**blank, **{state.second_parameter: ""}), None
    return replace(state.with_values(**blank), across=""), None


def state_to_solve(kind: str, state: PageState, diagram_state: PageState | None) -> PageState:
    """State for a request of the kind `kind`: `state`, except for the request "cycles" while the rod of the
    page lies in the drawn diagram. Then the state is `diagram_state`, so that the curves of cycles are added
    to the drawn diagram. diagram_state: state around which the drawn diagram was solved; None if there is no
    diagram."""
    if kind != "cycles" or diagram_state is None or state.tab != "rod":
        return state
    if inputs_of_request(SolveRequest("diagram", state)) != inputs_of_request(
        SolveRequest("diagram", diagram_state)
    ):
        return state
    low, high = second_parameter_values(diagram_state, 2)
    return diagram_state if low <= float(state.visible_texts[state.second_parameter]) <= high else state
