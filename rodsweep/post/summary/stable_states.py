"""Stable states of a phase diagram with cycles in `rodsweep show`: straight rod, cycle, or both."""

import numpy as np

from ...results.file.view import ResultView
from ...results.layouts.branch import SPECIAL_KINDS
from ...results.layouts.phase_diagram import STABLE_STATES
from ...results.layouts.thresholds import HOPF_CROSSING_CODES
from ...results.layouts.variables import flag_number
from ...wording import count_of_total, counted
from ..plane_curves import PlaneParameters
from .diagram_curves import CYCLE_CHANGE_WORDS
from .number_texts import axis_values_text, span_text

STABLE_STATE_WORDS = {
    "neither_known": "no stable state known",
    "straight": "straight rod only",
    "cycle": "cycle only",
    "both": "straight rod and cycle",
}
"""Phrase for the stable states of a rod, by name; other names are printed as they are."""
LISTED_STATES = {
    "straight rod and cycle both stable": "both",
    "no stable state known": "neither_known",
    "stable states undecided": "undecided",
}
"""Values of `stable_states` whose regions are listed, by the phrase in the summary."""
KINDS_WITHOUT_CYCLE_CHANGE = tuple(map(SPECIAL_KINDS.index, ("none", "hopf")))
"""Stored numbers of special points that are no change of cycles beside the changes of the straight rod."""


def stable_state_lines(view: ResultView, computed: np.ndarray, parameters: PlaneParameters) -> list[str]:
    """Lines about the fraction of the grid with each stable state, the ranges of some states, and the special
    points of cycles. computed: mask of the computed rows, (...,)."""
    variables = view.variables
    line, row = parameters
    row_values = view.point_columns[row].reshape(computed.shape)
    states = variables["stable_states"]
    kinds = variables["cycle_special_kind"]
    positions = variables[f"cycle_special_{line}"]
    shares = (
        (float((states[computed] == number).mean()), STABLE_STATE_WORDS.get(state_word, state_word))
        for number, state_word in STABLE_STATES
    )
    texts = ", ".join(f"{100 * share:.1f} % {phrase}" for share, phrase in shares if share)
    lines = [f"stable states, in % of the grid points: {texts}"]
    for phrase, state in LISTED_STATES.items():
        in_state = (states == flag_number(state, STABLE_STATES)) & computed[..., np.newaxis]
        if in_state.any():
            at_points = in_state.any(axis=-1)
            rows_text = f"at grid points of {count_of_total(at_points.sum(), computed.sum(), 'row')}"
            values_text = span_text(np.broadcast_to(variables[line], in_state.shape)[in_state])
            rows = axis_values_text(row_values[at_points])
            lines.append(f"{phrase}: {rows_text}, {line} = {values_text}, {row} = {rows}")
        is_hidden = computed & ~in_state.any(axis=-1) & _is_both_only_between_points(view, line)
        if state == "both" and is_hidden.any():
            rows = counted(int(is_hidden.sum()), "row")
            hidden_values = axis_values_text(row_values[is_hidden])
            lines.append(f"{phrase}: only between grid points on {rows}, {row} = {hidden_values}")
    for kind, phrase in CYCLE_CHANGE_WORDS.items():
        is_of_kind = (kinds == SPECIAL_KINDS.index(kind)) & computed[..., np.newaxis]
        has_kind = is_of_kind.any(axis=-1)
        if has_kind.any():
            rows_text = f"on {count_of_total(has_kind.sum(), computed.sum(), 'row')}"
            rows = axis_values_text(row_values[has_kind])
            values_text = span_text(positions[is_of_kind])
            lines.append(f"{phrase}: {rows_text}, {line} = {values_text}, {row} = {rows}")
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
        hopfs = variables["crossing_at"][row][np.isin(variables["crossing_kind"][row], HOPF_CROSSING_CODES)]
        specials = variables[f"cycle_special_{line_parameter}"][row][
            ~np.isin(variables["cycle_special_kind"][row], KINDS_WITHOUT_CYCLE_CHANGE)
        ]
        for i in np.flatnonzero(states[:-1] + states[1:] == straight + cycle):
            positions_between = [
                positions[(positions > x[i]) & (positions < x[i + 1])] for positions in (hopfs, specials)
            ]
            if {states[i], states[i + 1]} != {straight, cycle} or list(map(len, positions_between)) != [1, 1]:
                continue
            (change_of_straight,), (change_of_cycle,) = positions_between
            # The state of the second point begins before the state of the first point ends.
            is_between[row] |= (change_of_straight < change_of_cycle) == (states[i] == cycle)
    return is_between
