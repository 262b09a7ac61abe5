"""What `rodsweep show` says of thresholds: where they lie, and what was not decided."""

from itertools import product

import numpy as np

from ...results.file.view import View
from ...results.layouts.thresholds import CROSSING_KINDS, CROSSING_MEANINGS
from ...results.layouts.variables import ANGULAR
from ...wording import counted, plural, some_of
from .arm.arm import crossings_of_arm
from .ranges import error_text, rounded, span, to_error
from .told import Told, at_point, in_brackets

EVENTS = {
    "hopf": ("F** (straight rod starts to beat)", "hopf_frequency", "frequency", ANGULAR),
    "restabilization": ("stable again", "restabilization_frequency", "frequency", ANGULAR),
    "onset": ("F* (straight rod starts to oscillate)", "onset_growth_rate", "growth rate", "1/tau2"),
}
"""What the first crossing of each kind is called, and what is told of it beside the force."""


def thresholds_summary(view: View, done: np.ndarray) -> Told:
    """The task's sentences about the points that are `done`, a mask of the points' shape."""
    if done.size == 1:
        return Told(crossing_lines(view), trust_of_one(view), cost_lines(view, done), crossings_of_arm(view))
    answer = [event_line(view, done, event) for event in EVENTS]
    trust = [*search_lines(view, done, "rod"), f"searched up to F = {span(view.variables['F_end'][done])}"]
    return Told(answer, trust, [*monotony_lines(view), *cost_lines(view, done)])


def event_line(view: View, done: np.ndarray, event: str) -> str:
    """Forces at which rods first have a crossing of a kind, and which rods; done: of the grid's shape."""
    words, rate, noun, unit = EVENTS[event]
    v = view.variables
    F = np.where(done, v[f"F_{event}"], np.nan).ravel()
    there, rods = np.isfinite(F), int(done.sum())
    if not there.any():
        return f"{words}: at none of {counted(rods, 'rod')}"
    low, high = int(np.nanargmin(F)), int(np.nanargmax(F))
    errors = crossing_errors(view, F, "crossing_F")
    places = [f"{rounded(F[i], errors[i])}{in_brackets(at_point(view, i))}" for i in (low, high)]
    forces = " to ".join(places if places[0] != places[1] else places[:1])
    where = f"all {counted(rods, 'rod')}" if there.sum() == rods else some_of(int(there.sum()), rods, "rod")
    return f"{words}: F = {forces}, at {where}; {noun} {span(v[rate][done])} {unit}"


def crossing_errors(view: View, F: np.ndarray, at: str) -> np.ndarray:
    """The absolute errors of crossings, one of each point, (points,), from the list of crossings."""
    table, errors = map(view.by_point, (at, "crossing_error"))
    return np.where(table == F[:, None], errors, 0.0).max(axis=1)


def crossing_lines(view: View) -> list[str]:
    """Every crossing of the one rod of a file, and what is sure between them."""
    v = {name: view.variables[name].ravel() for name in view.variables}
    lines = []
    for i in np.flatnonzero(v["crossing_kind"] > 0):
        kind = CROSSING_KINDS[int(v["crossing_kind"][i])]
        F = to_error(v["crossing_F"][i], v["crossing_error"][i])
        growth, frequency = v["crossing_growth_rate"][i], v["crossing_frequency"][i]
        rates = f"growth rate {growth:.6g} 1/tau2, frequency {frequency:.6g} {ANGULAR}"
        after = int(v["unstable_after"][i])
        above = f"; unstable modes above: {after if after >= 0 else 'not known'}"
        lines.append(f"{kind} at F = {F}: {CROSSING_MEANINGS[kind]}; {rates}{above}")
    if not lines and v["crossing_count"][0] < 0:
        return ["nothing is known of its thresholds"]
    return lines or [f"no threshold up to F = {v['F_end'][0]:.15g}"]


def trust_of_one(view: View) -> list[str]:
    """How far the one rod of a file was searched, and whether all is found."""
    v = {name: view.variables[name].ravel() for name in ("crossing_count", "crossing_kind", "certified")}
    end, open_from, open_to = (float(view.variables[n].ravel()[0]) for n in ("F_end", "open_from", "open_to"))
    hidden = int(v["crossing_count"][0]) - int((v["crossing_kind"] > 0).sum())
    proof = "proved" if v["certified"].all() else "not proved"
    lines = [f"searched up to F = {end:.15g}; that no crossing is missing is {proof}{not_stored(hidden)}"]
    if np.isfinite(open_from):
        lines.append(f"undecided: F = {open_from:.9g} to {open_to:.9g}")
    return lines


def not_stored(hidden: int) -> str:
    """What is said of crossings that a list has no room for."""
    verb = "is" if hidden == 1 else "are"
    return f"; {hidden} more {verb} not stored, raise the option crossings" if hidden > 0 else ""


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
        text = f"{force} rises with {label} on {some_of(rising.sum(), there.sum(), 'line')}"
        falling = np.apply_along_axis(lambda F: (np.diff(F[np.isfinite(F)]) < 0).all(), -1, along) & there
        if falling.any():
            text += f", falls on {int(falling.sum())}"
        others, where = [n for n in view.axes if n != name], []
        for other, places in zip(others, np.argwhere(there & ~rising & ~falling).T, strict=True):
            if len(view.axes[other]) > 1 and places.size:
                low, high = view.axes[other][places].min(), view.axes[other][places].max()
                where.append(f"{other} = {low:.6g}" + (f" to {high:.6g}" if high > low else ""))
        if mixed := int((there & ~rising & ~falling).sum()):
            text += f", does both on {mixed}{in_brackets(', '.join(where))}"
        lines.append(text)
    return lines


def search_lines(view: View, done: np.ndarray, noun: str) -> list[str]:
    """How far the searches can be trusted; `done` has the points' shape, noun: what a point is."""
    v, searches = view.variables, int(done.sum())
    there = v["crossing_kind"][done] > 0
    stored = there.sum(axis=-1)
    errors = v["crossing_error"][done][there]
    known = errors[np.isfinite(errors)]
    worst = f"; absolute error at most {error_text(float(known.max()))}" if known.size else ""
    undecided = int(np.isfinite(v["open_from"][done]).sum())
    proved = some_of(int(v["certified"][done].sum()), searches, noun)
    window = f"; a range stays undecided on {counted(undecided, noun)}" if undecided else ""
    hidden = int((v["crossing_count"][done] - stored).clip(min=0).sum())
    return [
        f"that no crossing is missing is proved on {proved}{window}",
        f"crossings stored: {int(stored.sum())}, at most {int(stored.max())} on a {noun}{worst}"
        f"{not_stored(hidden)}",
    ]


def cost_lines(view: View, done: np.ndarray) -> list[str]:
    """What the searches cost; `done` has the points' shape."""
    v = view.variables
    boxes, solves = (v[name][done] for name in ("boxes", "solves"))
    return [f"cost of a search: {spans(boxes, 'evaluation')} of D, {spans(solves, 'eigenproblem')}"]


def spans(values: np.ndarray, noun: str) -> str:
    """A range of whole numbers of things, (n,)."""
    text = span(values)
    return f"{text} {noun if text == '1' else plural(noun)}"
