"""What the answer to a question depends on, so that no question is asked twice."""

from dataclasses import replace

from ..state import PageState
from .letting_go import Tip
from .questions import Question

Needs = tuple[PageState, Tip | None]
"""What an answer depends on."""
OF_TIP = ("bent", "motion")
"""Questions of a drag of the tip; an answer to another place of the tip is not shown."""


def needs(question: Question) -> Needs:
    """The state, blank in all fields that do not affect the answer, and the place of the tip."""
    kind = question.kind
    state = question.state
    if kind in ("spectrum", "cycle", "film", *OF_TIP):
        return replace(state, across="", F_max=""), question.tip
    blank = {state.load: ""}
    if kind in ("diagram", "cycles"):
        return state.with_values(**blank, **{state.second: ""}), None
    return replace(state.with_values(**blank), across=""), None
