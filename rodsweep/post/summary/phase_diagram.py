"""What `rodsweep show` says of a phase diagram: how much of the plane each class takes."""

import numpy as np

from ...model.parameters import LINEAR_PARAMETERS
from ...results.file.view import View
from ...results.layouts.phase_diagram import CLASSES
from ...results.layouts.thresholds import CROSSING_KINDS
from .ranges import span
from .thresholds import search_lines

FLUTTER = next(value for value, word in CLASSES if word == "flutter")
SHARP = 1e-8
"""Resolution of a boundary, in units of the parameter, for which the uniform grid is counted."""


def phase_diagram_summary(view: View, done: np.ndarray) -> list[str]:
    """The task's lines about the rows that are `done`, a mask of the rows' shape."""
    v = view.variables
    found = v["class"][done]
    counts = [f"{int((found == value).sum())} {word}" for value, word in CLASSES if (found == value).any()]
    line = next(name for name in LINEAR_PARAMETERS if name not in view.parameters)
    row = next(name for name in view.parameters if len(view.axes[name]) > 1)
    lines = [
        f"of {found.size} points: {', '.join(counts)}",
        *share_lines(found),
        *row_lines(view, done, line, row),
    ]
    lines += search_lines(view, done, int(done.sum()))
    solves, boxes = int(v["solves"][done].sum()), int(v["boxes"][done].sum())
    uniform = float(np.ptp(v[line])) / SHARP * int(done.sum())
    lines.append(
        f"solves: {solves} eigenproblems and {boxes} evaluations of D in all; a uniform grid that resolves "
        f"{line} to {SHARP:g} on these rows has {uniform:.2g} points, {uniform / max(solves + boxes, 1):.1g} "
        "times as many"
    )
    return lines + (curve_lines(view, line, row) if "curve_number" in v else [])


def share_lines(found: np.ndarray) -> list[str]:
    """How much of the grid each class takes; `found` has the classes of its points, of any shape."""
    shares = ((100 * float((found == value).mean()), word) for value, word in CLASSES)
    return [f"of the grid: {', '.join(f'{share:.1f} % {word}' for share, word in shares if share)}"]


def row_lines(view: View, done: np.ndarray, line: str, row: str) -> list[str]:
    """What changes on the rows that are `done`, a mask of their shape: on how many, where, and where not."""
    v, of_row = view.variables, view.point_columns[row].reshape(done.shape)
    lines = []
    for number, word in enumerate(CROSSING_KINDS):
        there = (v["crossing_kind"] == number) & done[..., np.newaxis]
        on_row = there.any(axis=-1)
        if number and on_row.any():
            at, rows = span(v["crossing_at"][there]), span(of_row[on_row])
            lines.append(
                f"{word}: on {int(on_row.sum())} of {int(done.sum())} rows, {line} = {at}, {row} = {rows}"
            )
    flutters = (v["class"] == FLUTTER).any(axis=-1)
    if (done & ~flutters).any() and (done & flutters).any():
        with_it, without = (span(of_row[done & mask]) for mask in (flutters, ~flutters))
        lines.append(f"flutter on the rows {row} = {with_it}; on none of {row} = {without}")
    return lines


def curve_lines(view: View, line: str, row: str) -> list[str]:
    """The curves, how they agree with the rows, and their folds."""
    v = view.variables
    hopf = len(np.unique(v["curve_number"][v["curve_kind"] == 1]))
    double = len(np.unique(v["curve_number"])) - hopf
    lines = [
        f"curves: {hopf} of Hopf points, {double} of double eigenvalues; crossings on rows lie within "
        f"{float(v['curve_agreement']):.1e} of them, over {line}; {int(v['curves_untraced'])} lie on none"
    ]
    for i, (kind, of) in enumerate(zip(v["fold_kind"], v["fold_of"], strict=True)):
        where = ", ".join(
            f"{name} = {v[f'fold_{name}'][i]:.13g} (+- {v[f'fold_{name}_error'][i]:.0e})"
            for name in (row, line)
        )
        what = "Hopf points" if kind else "double eigenvalues"
        lines.append(f"fold of the curve of {what}, where {(line, row)[int(of)]} is extremal: {where}")
    if "partial_beam_k1" in v:
        lines.append(
            f"partial beam limit: the Hopf curve folds at k1 = 4 Fc = {float(v['partial_beam_k1']):.13g}, "
            f"F = 2 Fc = {float(v['partial_beam_F']):.13g}"
        )
    return lines + (criticality_lines(view, line, row) if "curve_criticality" in v else [])


def criticality_lines(view: View, line: str, row: str) -> list[str]:
    """On which side of the Hopf curves cycles are born, and the generalised Hopf points on them."""
    v = view.variables
    side = v["curve_criticality"][v["curve_kind"] == 1]
    kinds = {
        "supercritical": side < 0,
        "subcritical": side > 0,
        "undecided": side == 0,
        "without a normal form": np.isnan(side),
    }
    told = [f"{int(there.sum())} {word}" for word, there in kinds.items() if there.any()]
    lines = [
        f"criticality, gamma1 = {float(v['curve_gamma1']):g}: of {len(side)} points of the Hopf curves "
        f"{', '.join(told) or 'none'}"
    ]
    for i in range(len(v["bautin_curve"])):
        where = ", ".join(
            f"{name} = {v[f'bautin_{name}'][i]:.13g} (+- {v[f'bautin_{name}_error'][i]:.0e})"
            for name in (row, line)
        )
        lines.append(f"generalised Hopf point (Re c = 0) on curve {int(v['bautin_curve'][i])}: {where}")
    if v["bautin_unlocated"]:
        lines.append(
            f"{int(v['bautin_unlocated'])} changes of criticality were seen whose place could not be found"
        )
    return lines
