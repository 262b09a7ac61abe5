"""Stable states of a phase diagram with cycles in `rodsweep show`: straight rod, cycle, or both."""

import numpy as np

from ...results.file.view import ResultView
from ...results.layouts.branch import SPECIAL_KINDS
from ...results.layouts.phase_diagram import STABLE_STATES
from ...results.layouts.thresholds import HOPF_CROSSING_CODES
from ...results.layouts.variables import stored_number_of_word
from ...wording import counted
from .cycle_curves import SPECIAL_POINT_WORDS_BY_KIND
from .selection import DiagramRows, percents_by_word_text

STABLE_STATE_WORDS = dict(STABLE_STATES) | {
    stored_number_of_word("neither_known", STABLE_STATES): "no stable state known",
    stored_number_of_word("straight", STABLE_STATES): "straight rod only",
    stored_number_of_word("cycle", STABLE_STATES): "cycle only",
    stored_number_of_word("both", STABLE_STATES): "straight rod and cycle",
}
"""Phrase for the stable states of a rod, by stored number."""
STATES_WITH_LISTED_REGIONS = {
    "straight rod and cycle both stable": "both",
    "no stable state known": "neither_known",
    "stable states undecided": "undecided",
}
"""Values of `stable_states` whose regions are listed, by the phrase in the summary."""
SPECIAL_KINDS_WITHOUT_CYCLE_CHANGE = tuple(map(SPECIAL_KINDS.index, ("none", "hopf")))
"""Stored numbers of the kinds of special points that do not count as changes of cycles: no special point, and
Hopf points, which count as changes of the straight rod."""


def stable_state_lines(rows: DiagramRows) -> list[str]:
    """Lines about the fraction of the grid with each stable state, the ranges of some states, and the special
    points of cycles."""
    states = rows.variables["stable_states"]
    line = rows.parameters.line_parameter
    percents_text = percents_by_word_text(states[rows.mask], STABLE_STATE_WORDS)
    lines = [f"stable states, in % of the grid points: {percents_text}"]
    for phrase, state in STATES_WITH_LISTED_REGIONS.items():
        in_state = rows.item_mask(states == stored_number_of_word(state, STABLE_STATES))
        if in_state.any():
            lines.append(f"{phrase}: at grid points of {rows.row_count_and_ranges_text(in_state, line)}")
        if state == "both":
            hidden = rows.where(
                ~in_state.any(axis=-1) & _has_coexistence_only_between_points(rows.view, line)
            )
            rows_text = f"on {counted(hidden.count, 'row')}, {hidden.row_parameter_values_text}"
            lines += [f"{phrase}: only between grid points {rows_text}"] if hidden.count else []
    for kind, phrase in SPECIAL_POINT_WORDS_BY_KIND.items():
        of_kind = rows.item_mask(rows.variables["cycle_special_kind"] == SPECIAL_KINDS.index(kind))
        if of_kind.any():
            lines.append(f"{phrase}: on {rows.row_count_and_ranges_text(of_kind, f'cycle_special_{line}')}")
    return lines


def _has_coexistence_only_between_points(view: ResultView, line_parameter: str) -> np.ndarray:
    """Mask of the rows of the diagram (one value of the second parameter each), (...,), on which straight rod
    and cycle are both stable somewhere between two neighbouring grid points, but not at these points: only
    the straight rod is stable at one point, only the cycle at the other, and between them one state becomes
    stable before the other state ends. Only intervals with one change of the straight rod and one change of
    cycles are considered."""
    variables = view.variables
    x = variables[line_parameter]
    straight, cycle = (stored_number_of_word(state, STABLE_STATES) for state in ("straight", "cycle"))
    is_between = np.zeros(variables["stable_states"].shape[:-1], dtype=bool)
    for row in np.ndindex(is_between.shape):
        states = variables["stable_states"][row]
        is_hopf = np.isin(variables["crossing_kind"][row], HOPF_CROSSING_CODES)
        is_change = ~np.isin(variables["cycle_special_kind"][row], SPECIAL_KINDS_WITHOUT_CYCLE_CHANGE)
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
