"""Stable states of a phase diagram with cycles in `rodsweep show`: straight rod, cycle, or both."""

import numpy as np

from ...results.file.view import View
from ...results.layouts.branch import SPECIAL_KINDS
from ...results.layouts.phase_diagram import STABLE_STATES
from ...results.layouts.thresholds import HOPF_CROSSING_CODES
from ...results.layouts.variables import flag_number
from ...wording import count_of_total, counted
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
NO_CYCLE_CHANGE = tuple(map(SPECIAL_KINDS.index, ("none", "hopf")))
"""Stored numbers of special points that are no change of cycles beside the changes of the straight rod."""


def state_lines(view: View, done: np.ndarray, line: str, row: str) -> list[str]:
    """Lines about the fraction of the grid with each stable state, the ranges of some states, and the special
    points of cycles. done: mask of the computed rows, (...,). line: parameter along a row. row: parameter
    constant on a row.
    """
    v = view.variables
    of_row = view.point_columns[row].reshape(done.shape)
    states = v["stable_states"]
    kinds = v["cycle_special_kind"]
    at = v[f"cycle_special_{line}"]
    shares = ((100 * float((states[done] == value).mean()), word) for value, word in STABLE_STATES)
    parts = ", ".join(
        f"{share:.1f} % {STABLE_STATE_WORDS.get(word, word)}" for share, word in shares if share
    )
    lines = [f"stable states, in % of the grid points: {parts}"]
    found_on = {}
    for words, state in LISTED_STATES.items():
        there = (states == flag_number(state, STABLE_STATES)) & done[..., np.newaxis]
        if there.any():
            at_points = there.any(axis=-1)
            lines.append(
                f"{words}: at grid points of {count_of_total(at_points.sum(), done.sum(), 'row')}, "
                f"{line} = {span_text(np.broadcast_to(v[line], there.shape)[there])}, "
                f"{row} = {axis_values_text(of_row[at_points])}"
            )
        hidden = done & ~there.any(axis=-1) & _both_between_grid_points(view, line)
        if state == "both" and hidden.any():
            rows = counted(int(hidden.sum()), "row")
            places = axis_values_text(of_row[hidden])
            lines.append(f"{words}: only between grid points on {rows}, {row} = {places}")
    for kind, words in CYCLE_CHANGE_WORDS.items():
        of_kind = (kinds == SPECIAL_KINDS.index(kind)) & done[..., np.newaxis]
        found_on[words] = of_kind.any(axis=-1), at[of_kind]
    for words, (rows, where) in found_on.items():
        if rows.any():
            lines.append(
                f"{words}: on {count_of_total(rows.sum(), done.sum(), 'row')}, {line} = {span_text(where)}, "
                f"{row} = {axis_values_text(of_row[rows])}"
            )
    return lines


def _both_between_grid_points(view: View, line: str) -> np.ndarray:
    """Mask of rows, (...,), with two neighbouring grid points between which straight rod and cycle are both
    stable though not at these points: one stable state at each, and between them first the beginning of one
    and then the end of the other. line: parameter along a row.

    Only intervals with one change of the straight rod and one change of cycles are decided.
    """
    v = view.variables
    x = v[line]
    straight, cycle = (flag_number(state, STABLE_STATES) for state in ("straight", "cycle"))
    found = np.zeros(v["stable_states"].shape[:-1], dtype=bool)
    for row in np.ndindex(found.shape):
        states = v["stable_states"][row]
        hopfs = v["crossing_at"][row][np.isin(v["crossing_kind"][row], HOPF_CROSSING_CODES)]
        specials = v[f"cycle_special_{line}"][row][~np.isin(v["cycle_special_kind"][row], NO_CYCLE_CHANGE)]
        for i in np.flatnonzero(states[:-1] + states[1:] == straight + cycle):
            within = [places[(places > x[i]) & (places < x[i + 1])] for places in (hopfs, specials)]
            if {states[i], states[i + 1]} != {straight, cycle} or list(map(len, within)) != [1, 1]:
                continue
            (change_of_straight,), (change_of_cycle,) = within
            # The state of the second point begins before the state of the first point ends.
            found[row] |= (change_of_straight < change_of_cycle) == (states[i] == cycle)
    return found
