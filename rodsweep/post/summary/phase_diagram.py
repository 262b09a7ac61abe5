"""What `rodsweep show` says of a phase diagram: how much of the plane each class takes."""

import numpy as np

from ...model.parameters import LINEAR_PARAMETERS
from ...results.file.view import View
from ...results.layouts.phase_diagram import CLASSES
from .thresholds import search_lines

SHARP = 1e-8
"""Resolution of a boundary, in units of the parameter, for which the uniform grid is counted."""


def phase_diagram_summary(view: View, done: np.ndarray) -> list[str]:
    """The task's lines about the rows that are `done`, a mask of the rows' shape."""
    v = view.variables
    found = v["class"][done]
    counts = [f"{int((found == value).sum())} {word}" for value, word in CLASSES if (found == value).any()]
    lines = [f"of {found.size} points: {', '.join(counts)}", *search_lines(view, done, int(done.sum()))]
    line = next(name for name in LINEAR_PARAMETERS if name not in view.parameters)
    row = next(name for name in view.parameters if len(view.axes[name]) > 1)
    solves, boxes = int(v["solves"][done].sum()), int(v["boxes"][done].sum())
    uniform = float(np.ptp(v[line])) / SHARP * int(done.sum())
    lines.append(
        f"solves: {solves} eigenproblems and {boxes} evaluations of D in all; a uniform grid that resolves "
        f"{line} to {SHARP:g} on these rows has {uniform:.2g} points, {uniform / max(solves + boxes, 1):.1g} "
        "times as many"
    )
    return lines + (curve_lines(view, line, row) if "curve_number" in v else [])


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
    return lines
