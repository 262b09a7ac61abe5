"""When each kind of question is asked, and which part of a page's state an answer depends on.

A question whose answer would be the same as the last one is not asked again.
"""

from dataclasses import replace

from ..state import PageState
from .letting_go import Tip
from .questions import Question

Needs = tuple[PageState, Tip | None]
"""What an answer depends on."""
AT_ONCE = ("spectrum", "cycle", "thresholds", "growth")
"""Kinds of questions that are asked after every change."""
WHEN_IDLE = ("branch", "diagram")
"""Kinds of questions that take seconds, and are asked when the page has rested."""
ON_REQUEST = ("motion", "film", "cycles")
"""Questions that only the user asks; a change of the rod drops them."""
STOPPABLE = ("cycle", *WHEN_IDLE, *ON_REQUEST)
"""Questions that the button "Stop" cancels."""
OF_TIP = ("bent", "motion")
"""Questions of a drag of the tip; an answer to another place of the tip is not shown."""


def needs(question: Question) -> Needs:
    """The parts of the state that affect the answer, all others blank; and the place of the tip, or None."""
    kind = question.kind
    state = question.state
    if kind in ("spectrum", "cycle", "film", *OF_TIP):
        return replace(state, across="", F_max=""), question.tip
    blank = {state.load: ""}
    if kind in ("diagram", "cycles"):
        return state.with_values(**blank, **{state.second: ""}), None
    return replace(state.with_values(**blank), across=""), None
