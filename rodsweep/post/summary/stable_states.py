"""Stable states of a phase diagram with cycles in `rodsweep show`: straight rod, cycle, or both."""

import numpy as np

from ...results.file.view import ResultView
from ...results.layouts.branch import SPECIAL_KINDS
from ...results.layouts.phase_diagram import STABLE_STATES
from ...results.layouts.thresholds import HOPF_CROSSING_CODES
from ...results.layouts.variables import flag_number
from ...wording import counted
from .cycle_curves import CYCLE_CHANGE_WORDS
from .selection import DiagramRows, percents_by_word

STABLE_STATE_WORDS = dict(STABLE_STATES) | {
    flag_number("neither_known", STABLE_STATES): "no stable state known",
    flag_number("straight", STABLE_STATES): "straight rod only",
    flag_number("cycle", STABLE_STATES): "cycle only",
    flag_number("both", STABLE_STATES): "straight rod and cycle",
}
"""Phrase for the stable states of a rod, by stored number."""
LISTED_STATES = {
    "straight rod and cycle both stable": "both",
    "no stable state known": "neither_known",
    "stable states undecided": "undecided",
}
"""Values of `stable_states` whose regions are listed, by the phrase in the summary."""
KINDS_WITHOUT_CYCLE_CHANGE = tuple(map(SPECIAL_KINDS.index, ("none", "hopf")))
"""Stored numbers of special points that are no change of cycles beside the changes of the straight rod."""


def stable_state_lines(rows: DiagramRows) -> list[str]:
    """Lines about the fraction of the grid with each stable state, the ranges of some states, and the special
    points of cycles."""
    states = rows.variables["stable_states"]
    line = rows.parameters.line
    percents_text = percents_by_word(states[rows.mask], STABLE_STATE_WORDS)
    lines = [f"stable states, in % of the grid points: {percents_text}"]
    for phrase, state in LISTED_STATES.items():
        in_state = rows.items(states == flag_number(state, STABLE_STATES))
        if in_state.any():
            lines.append(f"{phrase}: at grid points of {rows.place_text(in_state, line)}")
        if state == "both":
            hidden = rows.where(~in_state.any(axis=-1) & _is_both_only_between_points(rows.view, line))
            rows_text = f"on {counted(hidden.count, 'row')}, {hidden.row_values_text}"
            lines += [f"{phrase}: only between grid points {rows_text}"] if hidden.count else []
    for kind, phrase in CYCLE_CHANGE_WORDS.items():
        of_kind = rows.items(rows.variables["cycle_special_kind"] == SPECIAL_KINDS.index(kind))
        if of_kind.any():
            lines.append(f"{phrase}: on {rows.place_text(of_kind, f'cycle_special_{line}')}")
    return lines


def _is_both_only_between_points(view: ResultView, line_parameter: str) -> np.ndarray:
    """Mask of the rows, (...,), on which straight rod and cycle are both stable somewhere between two
    neighbouring grid points, but not at these points: only the straight rod is stable at one point, only the
    cycle at the other, and between them one state becomes stable before the other state ends. Only intervals
    with one change of the straight rod and one change of cycles are considered."""
    variables = view.variables
    x = variables[line_parameter]
    straight, cycle = (flag_number(state, STABLE_STATES) for state in ("straight", "cycle"))
    is_between = np.zeros(variables["stable_states"].shape[:-1], dtype=bool)
    for row in np.ndindex(is_between.shape):
        states = variables["stable_states"][row]
        is_hopf = np.isin(variables["crossing_kind"][row], HOPF_CROSSING_CODES)
        is_change = ~np.isin(variables["cycle_special_kind"][row], KINDS_WITHOUT_CYCLE_CHANGE)
        hopfs = variables["crossing_at"][row][is_hopf]
        specials = variables[f"cycle_special_{line_parameter}"][row][is_change]
        for i, pair in enumerate(zip(states[:-1], states[1:], strict=True)):
            of_straight, of_cycle = (
                positions[(positions > x[i]) & (positions < x[i + 1])] for positions in (hopfs, specials)
            )
            if set(pair) == {straight, cycle} and len(of_straight) == len(of_cycle) == 1:
                # The state of the second point begins before the state of the first point ends.
                is_between[row] |= (of_straight[0] < of_cycle[0]) == (pair[0] == cycle)
    return is_between
