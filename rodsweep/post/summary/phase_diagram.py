"""What `rodsweep show` says of a phase diagram: how much of the plane each class takes."""

import numpy as np

from ...model.parameters import LINEAR_PARAMETERS
from ...results.file.view import View
from ...results.layouts.branch import SPECIAL_KINDS
from ...results.layouts.phase_diagram import BAUTIN_ENDS, CLASSES, CYCLE_CURVE_ENDS, STABLE_STATES
from ...results.layouts.thresholds import CROSSING_KINDS
from ...wording import counted, some_of
from .arm import loads_at
from .ranges import error_text, span, to_error
from .thresholds import cost_lines, search_lines
from .told import Told

FLUTTER = next(value for value, word in CLASSES if word == "flutter")
BOTH = next(value for value, word in STABLE_STATES if word == "both")
CHANGES_OF_CYCLES = {
    "fold": "folds of cycles",
    "torus": "torus points of cycles",
    "symmetry_breaking": "cycles lose their symmetry",
    "left_the_model": "cycles leave the model (h1 = 0)",
}
"""What is told of the special points of rows, by their kind."""
CURVE_END_WORDS = {
    "none": "goes on",
    "edge": "edge of the diagram",
    "crushed": "F close to k1",
    "hopf": "Hopf point, where the cycles vanish",
    "left_the_model": "h1 = 0",
    "resonance": "resonance",
    "closed": "closed curve",
    "not_followed": "no further point found",
}
SHARP = 1e-8
"""Resolution of a boundary, in units of the parameter, for which the uniform grid is counted."""


def phase_diagram_summary(view: View, done: np.ndarray) -> Told:
    """The task's sentences about the rows that are `done`, a mask of the rows' shape."""
    v = view.variables
    line = next(name for name in LINEAR_PARAMETERS if name not in view.parameters)
    row = next(name for name in view.parameters if len(view.axes[name]) > 1)
    answer = [*share_lines(v["class"][done]), *row_lines(view, done, line, row)]
    if "stable_states" in v:
        answer += state_lines(view, done, line, row)
    trust = search_lines(view, done, "row")
    details = [*count_lines(v["class"][done]), *cost_lines(view, done), saving_line(view, done, line)]
    if "curve_number" in v:
        answer += fold_lines(view, line, row)
        trust += agreement_lines(view, line)
    if "curve_criticality" in v:
        answer += bautin_lines(view, line, row)
        details += criticality_lines(view)
    if "bautin_along_curve" in v:
        answer += bautin_curve_lines(view)
    if "cycle_curve_number" in v:
        answer += cycle_curve_lines(view, line, row)
    return Told(answer, trust, details, crossings_of_arms(view, done))


def count_lines(found: np.ndarray) -> list[str]:
    """How many places of the grid are of each class; `found` has those of all, of any shape."""
    counts = [f"{int((found == value).sum())} {word}" for value, word in CLASSES if (found == value).any()]
    return [f"of {counted(found.size, 'place')} on the rows: {', '.join(counts)}"]


def saving_line(view: View, done: np.ndarray, line: str) -> str:
    """What the rows cost in all, beside a uniform grid; done: which rows are there, of the shape of rows."""
    v, rows = view.variables, int(done.sum())
    solves, boxes = int(v["solves"][done].sum()), int(v["boxes"][done].sum())
    uniform = float(np.ptp(v[line])) / SHARP * rows
    return (
        f"in all {counted(solves, 'eigenproblem')} and {counted(boxes, 'evaluation')} of D; a uniform grid "
        f"that resolves {line} to {SHARP:g} on these rows has {uniform:.2g} places, "
        f"{uniform / max(solves + boxes, 1):.1g} times as many"
    )


def state_lines(view: View, done: np.ndarray, line: str, row: str) -> list[str]:
    """Over which part of the grid each state is stable, on which rows both are, and where cycles change.

    done: a mask of the rows' shape.
    """
    v, of_row = view.variables, view.point_columns[row].reshape(done.shape)
    states, kinds, at = v["stable_states"], v["cycle_special_kind"], v[f"cycle_special_{line}"]
    found = states[done]
    shares = ((100 * float((found == value).mean()), word) for value, word in STABLE_STATES)
    told = ", ".join(f"{share:.1f} % {word.replace('_', ' ')}" for share, word in shares if share)
    lines = [f"stable states, of the grid: {told}"]
    both = (states == BOTH) & done[..., np.newaxis]
    places = np.broadcast_to(v[line], both.shape)[both]
    found_on = {"straight rod and cycle both stable": (both.any(axis=-1), places)}
    for kind, words in CHANGES_OF_CYCLES.items():
        there = (kinds == SPECIAL_KINDS.index(kind)) & done[..., np.newaxis]
        found_on[words] = there.any(axis=-1), at[there]
    for words, (rows, where) in found_on.items():
        if rows.any():
            lines.append(
                f"{words}: on {some_of(rows.sum(), done.sum(), 'row')}, {line} = {span(where)}, "
                f"{row} = {span(of_row[rows])}"
            )
    return lines


def cycle_curve_lines(view: View, line: str, row: str) -> list[str]:
    """The curves of folds and torus points of cycles, and where they end."""
    v, lines = view.variables, []
    for number in np.unique(v["cycle_curve_number"]):
        on = np.flatnonzero(v["cycle_curve_number"] == number)
        kind = SPECIAL_KINDS[int(v["cycle_curve_kind"][on[0]])]
        ends = " to ".join(
            f"{row} = {v[f'cycle_curve_{row}'][i]:.9g}, {line} = "
            f"{to_error(v[f'cycle_curve_{line}'][i], v['cycle_curve_error'][i])} "
            f"({CURVE_END_WORDS[tuple(CYCLE_CURVE_ENDS)[int(v['cycle_curve_end'][i])]]})"
            for i in on[[0, -1]]
        )
        what = "folds" if kind == "fold" else "torus points"
        error = error_text(float(v["cycle_curve_error"][on].max()))
        points = counted(len(on), "point")
        lines.append(f"curve of {what}: from {ends}; {points}, largest error of {line} {error}")
    return lines


def share_lines(found: np.ndarray) -> list[str]:
    """How much of the grid each class takes; `found` has the classes of its points, of any shape."""
    shares = ((100 * float((found == value).mean()), word) for value, word in CLASSES)
    return [f"of the grid: {', '.join(f'{share:.1f} % {word}' for share, word in shares if share)}"]


def start_lines(view: View, done: np.ndarray, line: str) -> list[str]:
    """What rows do where they begin, unless all are monotone; done: which rows are there, (rows,)."""
    start = view.variables["class"][done][:, 0]
    words = [f"{word} on {int((start == n).sum())}" for n, word in CLASSES if (start == n).any()]
    if words == [f"monotone on {len(start)}"]:
        return []
    rows = f"of {counted(len(start), 'row')}"
    return [f"at {line} = {view.variables[line][0]:.6g}, where the rows begin, {rows}: {', '.join(words)}"]


def row_lines(view: View, done: np.ndarray, line: str, row: str) -> list[str]:
    """What changes on the rows that are `done`, a mask of their shape: on how many, where, and where not."""
    v, of_row = view.variables, view.point_columns[row].reshape(done.shape)
    lines = start_lines(view, done, line)
    for number, word in enumerate(CROSSING_KINDS):
        there = (v["crossing_kind"] == number) & done[..., np.newaxis]
        on_row = there.any(axis=-1)
        if number and on_row.any():
            first = there & (there.cumsum(axis=-1) == 1)
            again = there & ~first
            at, later = (span(v["crossing_at"][one], v["crossing_error"][one]) for one in (first, again))
            text = f"{word}: on {some_of(on_row.sum(), done.sum(), 'row')}, {line} = {at}"
            text += f", {row} = {span(of_row[on_row])}"
            if again.any():
                text += f"; again on {int(again.any(axis=-1).sum())}, {line} = {later}"
            lines.append(text)
    flutters = (v["class"] == FLUTTER).any(axis=-1)
    if (done & ~flutters).any() and (done & flutters).any():
        with_it, without = (span(of_row[done & mask]) for mask in (flutters, ~flutters))
        lines.append(f"flutter on the rows {row} = {with_it}; on none of {row} = {without}")
    return lines


def crossings_of_arms(view: View, done: np.ndarray) -> list[str]:
    """What changes along F on rows, in the units of an arm; done: a mask of the rows' shape."""
    if not view.quantities or "F" in view.parameters:
        return []
    v, lines = view.variables, []
    for number, word in enumerate(CROSSING_KINDS):
        there = (v["crossing_kind"] == number) & done[..., np.newaxis]
        if number and there.any():
            forces = v["crossing_at"][there]
            rows = some_of(there.any(axis=-1).sum(), done.sum(), "row")
            lines.append(f"{word}: on {rows}, at {loads_at(view, forces, np.zeros(len(forces), int))}")
    return lines


def agreement_lines(view: View, line: str) -> list[str]:
    """How the curves agree with the rows."""
    v = view.variables
    hopf = len(np.unique(v["curve_number"][v["curve_kind"] == 1]))
    double = len(np.unique(v["curve_number"])) - hopf
    within = error_text(float(v["curve_agreement"]))
    lines = [
        f"curves: {hopf} of Hopf points, {double} of double eigenvalues; crossings on rows lie within "
        f"{within} of them, over {line}; {_on_none(int(v['curves_untraced']))}"
    ]
    if "cycle_curve_number" in v and (len(v["cycle_curve_number"]) or v["cycle_curves_untraced"]):
        curves, within = (
            len(np.unique(v["cycle_curve_number"])),
            error_text(float(v["cycle_curve_agreement"])),
        )
        lines.append(
            f"curves of cycles: {curves}; folds and torus points of rows lie within {within} of "
            f"them, over {line}; {_on_none(int(v['cycle_curves_untraced']))}"
        )
    return lines


def _on_none(count: int) -> str:
    """How many points of rows lie on no curve."""
    return f"{count} lies on none" if count == 1 else f"{count} lie on none"


def fold_lines(view: View, line: str, row: str) -> list[str]:
    """Where curves turn back, and where that of the partial beam does."""
    v, lines = view.variables, []
    for i, (kind, of) in enumerate(zip(v["fold_kind"], v["fold_of"], strict=True)):
        what = "Hopf points" if kind else "double eigenvalues"
        where = _place(view, "fold", i, (row, line))
        lines.append(f"fold of the curve of {what}, where {(line, row)[int(of)]} is extremal: {where}")
    if "partial_beam_k1" in v:
        lines.append(
            f"partial beam limit: the Hopf curve folds at k1 = 4 Fc = {float(v['partial_beam_k1']):.13g}, "
            f"F = 2 Fc = {float(v['partial_beam_F']):.13g}"
        )
    return lines


def _place(view: View, what: str, i: int, names: tuple[str, str]) -> str:
    """The i-th fold or generalised Hopf point with its errors."""
    v = view.variables
    return ", ".join(
        f"{name} = {to_error(v[f'{what}_{name}'][i], v[f'{what}_{name}_error'][i])}" for name in names
    )


def criticality_lines(view: View) -> list[str]:
    """On which side of the Hopf curves cycles are born."""
    v = view.variables
    side = v["curve_criticality"][v["curve_kind"] == 1]
    kinds = {
        "supercritical": side < 0,
        "subcritical": side > 0,
        "undecided": side == 0,
        "without a normal form": np.isnan(side),
    }
    told = [f"{int(there.sum())} {word}" for word, there in kinds.items() if there.any()]
    points = counted(len(side), "point")
    return [
        f"criticality, gamma1 = {float(v['curve_gamma1']):g}: of {points} of the Hopf curves "
        f"{', '.join(told) or 'none'}"
    ]


def bautin_lines(view: View, line: str, row: str) -> list[str]:
    """The generalised Hopf points, where the side on which cycles are born changes."""
    v = view.variables
    lines = [
        f"generalised Hopf point (Re c = 0) on curve {int(v['bautin_curve'][i])}: "
        + _place(view, "bautin", i, (row, line))
        for i in range(len(v["bautin_curve"]))
    ]
    if unlocated := int(v["bautin_unlocated"]):
        changes = counted(unlocated, "change")
        lines.append(f"{changes} of criticality seen whose place could not be found")
    return lines


def bautin_curve_lines(view: View) -> list[str]:
    """Where the curves of generalised Hopf points over a third parameter lead, and why they end."""
    v, lines = view.variables, []
    names = [name for name in LINEAR_PARAMETERS if f"bautin_along_{name}" in v]
    for number in np.unique(v["bautin_along_curve"]):
        on = v["bautin_along_curve"] == number
        where = ", ".join(f"{name} = {span(v[f'bautin_along_{name}'][on])}" for name in names)
        ends = [BAUTIN_ENDS[int(end)] for end in v["bautin_along_end"][on][[0, -1]]]
        lines.append(
            f"curve {int(number)} of generalised Hopf points: {counted(int(on.sum()), 'point')}, {where}; "
            f"ends: {ends[0]} and {ends[1]}"
        )
    return lines
