"""What `rodsweep show` says of thresholds: where they lie, and what was not decided."""

from itertools import product

import numpy as np

from ...results.file.view import View
from ...results.layouts.thresholds import CROSSING_KINDS, CROSSING_MEANINGS
from .arm import crossing_line_in_si
from .ranges import span, to_error

FORCES_AND_RATES = {
    "onset": ("F_onset", "growth rate", "onset_growth_rate"),
    "Hopf": ("F_hopf", "frequency", "hopf_frequency"),
    "restabilization": ("F_restabilization", "frequency", "restabilization_frequency"),
}


def thresholds_summary(view: View, done: np.ndarray) -> list[str]:
    """The task's lines about the points that are `done`, a mask of the points' shape."""
    v = view.variables
    points = int(done.sum())
    if done.size == 1:
        return [*crossing_lines(view), search_lines(view, done, 1)[-1]]
    lines = []
    for event, (force, word, number) in FORCES_AND_RATES.items():
        F = v[force][done]
        there = int(np.isfinite(F).sum())
        where = f": F = {span(F)}, {word} {span(v[number][done])}" if there else ""
        lines.append(f"{event}: at {there} of {points} points{where}")
    lines.append(f"searched up to F = {span(v['F_end'][done])}")
    return [*lines, *monotony_lines(view), *search_lines(view, done, points)]


def crossing_lines(view: View) -> list[str]:
    """Every crossing of the one rod of a file, and what is sure between them."""
    v = {name: view.variables[name].ravel() for name in view.variables}
    lines = []
    for i in np.flatnonzero(v["crossing_kind"] > 0):
        kind = CROSSING_KINDS[int(v["crossing_kind"][i])]
        F = to_error(v["crossing_F"][i], v["crossing_error"][i])
        growth, frequency = v["crossing_growth_rate"][i], v["crossing_frequency"][i]
        rates = f"growth rate {growth:.6g}, frequency {frequency:.6g} 1/tau2"
        after = int(v["unstable_after"][i])
        above = f"; unstable modes above: {after if after >= 0 else 'not known'}"
        lines.append(f"{kind} at F = {F}: {CROSSING_MEANINGS[kind]}; {rates}{above}")
        lines += crossing_line_in_si(view, int(i))
    found, stored = int(v["crossing_count"][0]), int((v["crossing_kind"] > 0).sum())
    more = f"; {found - stored} more are not stored, raise the option crossings" * (found > stored)
    proof = "proved" if v["certified"].all() else "not proved"
    lines.append(f"searched up to F = {v['F_end'][0]:.15g}; that no crossing is missing is {proof}{more}")
    if np.isfinite(v["open_from"][0]):
        lines.append(f"undecided: F = {v['open_from'][0]:.9g} to {v['open_to'][0]:.9g}")
    return lines


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
