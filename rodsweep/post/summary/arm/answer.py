"""What `rodsweep show` says first of an arm: whether the model applies, and when and how fast it beats.

In the units in which the arm was typed, frequencies in Hz.
"""

from collections.abc import Callable, Mapping

import numpy as np

from ....config.arm.axes import NOT_SLENDER
from ....model.arm.neglected import Validity
from ....model.arm.quantities import SCALE_OF
from ....results.file.view import View
from ....results.layouts.arm import EFFECTS, VALIDITY
from ....results.layouts.thresholds import CROSSING_KINDS
from ....wording import counted, some_of
from ..ranges import rounded
from .arm import errors_in_si, load_of, own_unit, region_of_arms
from .drag_range import arms_of_drags, drag_lines

DIGITS = 3
"""Digits of an answer, where its error leaves so many."""
OTHER_PLANE = (
    "the motion is in the plane of the height; where that is above the width, the arm flutters first in the "
    "other plane, at a lower load: exchange width and height to see it"
)


def arm_answer(view: View, done: np.ndarray) -> list[str]:
    """Lines about the points that are `done`, a mask of their shape; none without an arm."""
    return [*plane_lines(view.quantities), *_applied(view, done)] if view.quantities else []


def plane_lines(quantities: Mapping[str, np.ndarray]) -> list[str]:
    """What is said of rectangles of which one gives way first in the plane that is not computed; else none.

    quantities: those of an arm in SI, each a number or (n,).
    """
    height, width = (np.asarray(quantities.get(name, np.nan)) for name in ("height", "width"))
    return [OTHER_PLANE] if np.max(height) > np.min(width) else []


def _applied(view: View, done: np.ndarray) -> list[str]:
    """Lines about points, with whether the model applies to them."""
    rods = done & (view.variables["status"] < NOT_SLENDER)
    if not rods.any():
        return ["no rod covers any of these arms"] if done.any() else []
    validity = {variable.name: view.variables[variable.name][rods] for variable in VALIDITY}
    caveat = validity_sentence(validity)
    inside = rods & (view.variables["model_applies"] != Validity.does_not_apply)
    if not inside.any():
        return [caveat, *(f"if it applied: {line}" for line in ANSWERS[view.task](view, rods))]
    if (inside != rods).any():
        return [caveat, *(f"where it applies: {line}" for line in ANSWERS[view.task](view, inside))]
    answer = ANSWERS[view.task](view, rods)
    return [caveat, *answer] if validity["model_applies"].any() else [*answer[:1], caveat, *answer[1:]]


def validity_sentence(validity: Mapping[str, np.ndarray], when: str = "") -> str:
    """Whether the model applies at points, and what it leaves out there.

    validity: the variables of VALIDITY, (n,); when: they are judged so.
    """
    applies, effect, excess = (validity[variable.name] for variable in VALIDITY)
    worst = Validity(int(applies.max()))
    if worst == Validity.applies:
        return f"the model applies{' at all points' * (len(applies) > 1)}{when}"
    there = applies == worst
    some = f" at {some_of(int(there.sum()), len(applies), 'point')}"
    at = "" if len(applies) == 1 else f" at all {len(applies)} points" if there.all() else some
    verb = "does not apply" if worst == Validity.does_not_apply else "is doubtful"
    place = int(np.flatnonzero(there)[np.argmax(excess[there])])
    name, size = EFFECTS[int(effect[place])].replace("_", " "), f"{excess[place]:.2g}"
    return f"the model {verb}{at}{when}: {name} is {'up to ' * int(there.sum() > 1)}{size} times its limit"


def spanned(view: View, values: np.ndarray, si: str, errors: np.ndarray | float = 0.0) -> str:
    """The range of values in an SI unit, of any shape, in the arm's own unit.

    errors: absolute ones, of the same shape; three digits are told where they are known.
    """
    there = np.isfinite(values)
    finite, known = values[there], np.broadcast_to(errors, values.shape)[there]
    factor, unit = own_unit(view, si, float(np.abs(finite).max()))
    ends = (int(finite.argmin()), int(finite.argmax()))
    low, high = (rounded(factor * float(finite[i]), factor * float(known[i]), DIGITS) for i in ends)
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"


def load_spanned(view: View, loads: np.ndarray) -> str:
    """The range of loads in SI, (n,), as the load of the arm is told."""
    return spanned(view, loads, "N" if "force" in view.quantities else "Pa")


def _of_thresholds(view: View, rods: np.ndarray) -> list[str]:
    load, v = load_of(view), view.variables
    hopf, end, rate = (v[name][rods] for name in (f"{load}_hopf", f"{load}_end", "frequency_hopf_hz"))
    lines = [*_flutter(view, hopf, end, rate), *_where(view, rods, hopf)]
    onset, back = v[f"{load}_onset"][rods], v[f"{load}_restabilization"][rods]
    if len(hopf) > 1 and np.isfinite(onset).any():
        lines.append(f"a disturbance swings as it dies away from {load_spanned(view, onset)} on")
    if len(hopf) > 1 and np.isfinite(back).any():
        there = some_of(int(np.isfinite(back).sum()), len(back), "point")
        lines.append(f"is straight again at {there}, from {load_spanned(view, back)} on")
    return lines


def _where(view: View, rods: np.ndarray, loads: np.ndarray) -> list[str]:
    """Which arms flutter at the least and at the largest of loads in SI, (n,), and what drag does."""
    if np.isfinite(loads).sum() < 2:
        return []
    places = np.flatnonzero(rods)
    ends = [places[found(loads)] for found in (np.nanargmin, np.nanargmax)]
    least, most = (region_of_arms(view, np.arange(rods.size) == end) for end in ends)
    lines = [] if least == most else [f"least at {least}; most at {most}"]
    numbers = {"flutter": loads, "its frequency": view.variables["frequency_hopf_hz"][rods]}
    whole = {name: np.full(rods.size, np.nan) for name in numbers}
    for name, values in numbers.items():
        whole[name][places] = values
    return [*lines, *drag_lines(view, whole)]


def _of_crossings(view: View, rods: np.ndarray) -> list[str]:
    v = view.variables
    first = _first_hopf(view, rods)
    load = load_of(view)
    end = v[f"{load}_end"][rods] if f"{load}_end" in v else np.full(len(first), np.nan)
    frequency = _at(v["crossing_frequency_hz"][rods], first)
    return _flutter(view, _at(v[f"crossing_{load}"][rods], first), end, frequency)


def _flutter(view: View, hopf: np.ndarray, end: np.ndarray, frequency: np.ndarray) -> list[str]:
    """Lines about loads at which points flutter, up to where was searched, and frequencies there, (n,)."""
    there = np.isfinite(hopf)
    searched = f"up to {load_spanned(view, end)}" if np.isfinite(end).any() else ""
    if not there.any():
        return [f"does not flutter {searched}".rstrip()]
    of = f" at {int(there.sum())} of {len(hopf)} points" if not there.all() else ""
    lines = [f"flutters{of} from {load_spanned(view, hopf)}; beats at {spanned(view, frequency, 'Hz')}"]
    if not there.all():
        lines.append(f"does not flutter at {int((~there).sum())} of {len(hopf)} points {searched}".rstrip())
    return lines


def _of_cycles(view: View, rods: np.ndarray) -> list[str]:
    names = {"frequency_hz": "frequency", "tip_y_max_si": "tip_y_max"}
    v = {name: view.variables[name][rods] for name in names}
    errors = {name: errors_in_si(view.variables, own, name)[rods] for name, own in names.items()}
    there = np.isfinite(v["frequency_hz"])
    if not there.any():
        return ["does not beat"]
    of = f" at {int(there.sum())} of {len(there)} points" if len(there) > 1 else ""
    wide = spanned(view, v["tip_y_max_si"], "m", errors["tip_y_max_si"])
    rate = spanned(view, v["frequency_hz"], "Hz", errors["frequency_hz"])
    beats = f"beats{of} at {rate}, its tip by {wide} to either side"
    known = {"frequency": "frequency_hz", "reach of the tip": "tip_y_max_si", "power": "injection_mean_si"}
    numbers = {name: np.where(rods, view.variables[key], np.nan).ravel() for name, key in known.items()}
    return [beats, *_decided(view, rods), *drag_lines(view, numbers)]


def _decided(view: View, rods: np.ndarray) -> list[str]:
    """At how many arms and loads drag decides whether there is a cycle; none where none was varied."""
    arms = arms_of_drags(view)
    if arms is None:
        return []
    beats = np.isfinite(view.variables["frequency_hz"]).ravel()
    of_arms = [beats[(arms == arm) & rods.ravel()] for arm in np.unique(arms[rods.ravel()])]
    always, never = sum(each.all() for each in of_arms), sum(not each.any() for each in of_arms)
    some = len(of_arms) - always - never
    told = {"with every drag": always, "with part of the range of drag": some, "with none": never}
    counts = ", ".join(f"{words} at {count}" for words, count in told.items() if count)
    return [f"of {counted(len(of_arms), 'combination')} of arm and load: beats {counts}"]


def _of_modes(view: View, rods: np.ndarray) -> list[str]:
    unstable = view.variables["unstable_count"][rods] > 0
    if not unstable.any():
        return ["stays straight"]
    of = f" at {int(unstable.sum())} of {len(unstable)} points" if len(unstable) > 1 else ""
    leading = view.variables["frequency_hz"][rods][unstable][:, 0]
    return [f"gives way{of}; its leading mode oscillates at {spanned(view, np.abs(leading), 'Hz')}"]


def _of_branches(view: View, rods: np.ndarray) -> list[str]:
    loads = view.variables[f"branch_{load_of(view)}"][rods]
    if not np.isfinite(loads).any():
        return ["does not beat"]
    frequency = 1 / view.variables["period_si"][rods]
    errors = frequency * view.variables["period_error"][rods]
    return [f"beats at {load_spanned(view, loads)}, at {spanned(view, frequency, 'Hz', errors=errors)}"]


def _of_diagram(view: View, rods: np.ndarray) -> list[str]:
    if "F" in view.parameters:  # the rows cross another parameter
        return []
    first, v = _first_hopf(view, rods), view.variables
    scale = SCALE_OF[load_of(view)]
    loads = _at(v["crossing_at"][rods], first) * np.broadcast_to(v[scale], rods.shape)[rods]
    last = np.minimum(v["F"][-1], view.point_columns["k1"].reshape(rods.shape)[rods])
    ends = last * np.broadcast_to(v[scale], rods.shape)[rods]
    return _flutter(view, loads, ends, _at(v["crossing_frequency_hz"][rods], first))


def _first_hopf(view: View, rods: np.ndarray) -> np.ndarray:
    """The place of the first Hopf point among the crossings of each point, (n,); -1 without one."""
    hopf = view.variables["crossing_kind"][rods] == CROSSING_KINDS.index("hopf")
    return np.where(hopf.any(axis=-1), np.argmax(hopf, axis=-1), -1)


def _at(values: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Of tables, (n, crossings), the value at a place of each, (n,); nan at place -1."""
    return np.where(places < 0, np.nan, values[np.arange(len(places)), np.maximum(places, 0)])


ANSWERS: dict[str, Callable[[View, np.ndarray], list[str]]] = {
    "spectrum": _of_modes,
    "modes": _of_modes,
    "thresholds": _of_thresholds,
    "criticality": _of_crossings,
    "limit_cycle": _of_cycles,
    "branch": _of_branches,
    "phase_diagram": _of_diagram,
}
"""What each task has to say, from (view, which points have a rod and are computed)."""
