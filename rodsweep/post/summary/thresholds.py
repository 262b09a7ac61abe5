"""What `rodsweep show` says of thresholds: where they lie, and what was not decided."""

from itertools import product

import numpy as np

from ...results.file.view import View
from .ranges import span

FORCES_AND_RATES = {
    "onset": ("F_onset", "growth rate", "onset_growth_rate"),
    "Hopf": ("F_hopf", "frequency", "hopf_frequency"),
    "restabilization": ("F_restabilization", "frequency", "restabilization_frequency"),
}


def thresholds_summary(view: View, done: np.ndarray) -> list[str]:
    """The task's lines about the points that are `done`, a mask of the points' shape."""
    v = view.variables
    points = int(done.sum())
    lines = []
    for event, (force, word, number) in FORCES_AND_RATES.items():
        F = v[force][done]
        there = int(np.isfinite(F).sum())
        where = f": F = {span(F)}, {word} {span(v[number][done])}" if there else ""
        lines.append(f"{event}: at {there} of {points} points{where}")
    lines.append(f"searched up to F = {span(v['F_end'][done])}")
    return [*lines, *monotony_lines(view), *search_lines(view, done, points)]


def monotony_lines(view: View) -> list[str]:
    """Whether the first onset and Hopf point rise with a parameter, as the paper says of k2 and 1/gamma3."""
    lines = []
    long = [name for name, values in view.axes.items() if len(values) > 2] if view.is_grid else []
    for name, force in product(long, ("F_onset", "F_hopf")):
        along = np.moveaxis(view.variables[force], list(view.axes).index(name), -1)
        label = name
        if name == "gamma3":
            along, label = along[..., ::-1], "1/gamma3"
        there = np.isfinite(along).sum(axis=-1) > 1
        if not there.any():
            continue
        rising = np.apply_along_axis(lambda F: (np.diff(F[np.isfinite(F)]) > 0).all(), -1, along) & there
        text = f"{force} rises with {label} on {int(rising.sum())} of {int(there.sum())} lines"
        others = [n for n in view.axes if n != name]
        for other, places in zip(others, np.argwhere(there & ~rising).T, strict=True):
            if len(view.axes[other]) > 1 and places.size:
                low, high = view.axes[other][places].min(), view.axes[other][places].max()
                text += f", and falls somewhere for {other} = {low:.6g}"
                text += f" to {high:.6g}" if high > low else ""
        lines.append(text)
    return lines


def search_lines(view: View, done: np.ndarray, lines: int) -> list[str]:
    """How far the searches can be trusted, and what they cost; `done` has the points' shape."""
    v = view.variables
    there = v["crossing_kind"][done] > 0
    stored = there.sum(axis=-1)
    errors = v["crossing_error"][done][there]
    worst = f"; absolute error at most {np.nanmax(errors):.1e}" if np.isfinite(errors).any() else ""
    undecided = int(np.isfinite(v["open_from"][done]).sum())
    return [
        f"crossings stored: {int(stored.sum())}, at most {int(stored.max())} on a line{worst}",
        f"certified: {int(v['certified'][done].sum())} of {lines}; a range stays undecided on {undecided}",
        f"cost of a line: {span(v['boxes'][done].astype(float))} evaluations of D, "
        f"{span(v['solves'][done].astype(float))} eigenproblems",
    ]
