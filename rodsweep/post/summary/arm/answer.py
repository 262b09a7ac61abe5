"""First lines of `rodsweep show` for an arm: validity of the model, flutter load, frequency of beating.
Quantities are in the units typed by the user, frequencies in Hz."""

from collections.abc import Callable

import numpy as np

from ....config.arm.status import NOT_SLENDER
from ....model.arm.neglected import Validity
from ....model.arm.quantities import SCALE_NAMES, UNITS
from ....results.file.view import ResultView
from ....results.layouts.si_variables import VALIDITY_VARIABLES
from ....results.layouts.thresholds import CROSSING_KINDS
from ....wording import count_of_total, counted
from .arm import errors_in_si, range_in_unit
from .drag_range import arm_index_of_points, drag_lines
from .load_lines import ANSWER_DIGITS, compression_lines, extreme_arms_text, flutter_force_line
from .validity_sentences import judged_row_motion_clause, plane_lines, validity_sentence

Lines = list[str]
"""Lines of text."""
FAILED_STATUS = "failed"
"""Status of a point whose solve failed."""
NO_CYCLE_WORDS = {
    "straight": "does not beat",
    "unstable": "has an unstable cycle",
    "torus": "beats quasiperiodically (two frequencies)",
    "not_settled": "is not settled: no stable cycle was found, but a stable cycle may exist",
    "left_the_model": "is crushed somewhere or loses its stiffness, where the model ends",
    FAILED_STATUS: "is not known: the solve failed",
}
"""Predicate for an arm without a stable cycle, by status."""


def arm_answer(view: ResultView, computed: np.ndarray) -> Lines:
    """Lines with the answer about the arms at the points in the mask `computed`, (...,); empty for a rod."""
    if not view.quantities:
        return []
    rods = computed & (view.variables["status"] < NOT_SLENDER)
    lines = _validity_lines(view, computed, rods)
    return [*plane_lines(view.quantities), *lines, *compression_lines(view, rods)]


def _validity_lines(view: ResultView, computed: np.ndarray, rods: np.ndarray) -> Lines:
    """Line on the validity of the model, and lines with the answer for the points in `rods` to which it
    applies; for all these points if it applies to none. computed, rods: masks of computed points and rods."""
    if not rods.any():
        no_rods = ["none of these arms corresponds to a rod of the model; the statuses state the reasons"]
        return no_rods if computed.any() else []
    validity = {variable.name: view.variables[variable.name][rods] for variable in VALIDITY_VARIABLES}
    noun = "row" if "crossing_at" in view.variables else "point"
    caveat = validity_sentence(validity, judged_row_motion_clause(view, rods), noun)
    is_in_model = rods & (view.variables["model_applies"] != Validity.does_not_apply)
    answer_lines = ANSWER_LINES_BY_TASK[view.task]
    if not is_in_model.any():
        return [caveat, *(f"if the model applied: {line}" for line in answer_lines(view, rods))]
    if (is_in_model != rods).any():
        return [caveat, *(f"where the model applies: {line}" for line in answer_lines(view, is_in_model))]
    answer = answer_lines(view, rods)
    return [caveat, *answer] if validity["model_applies"].any() else [*answer[:1], caveat, *answer[1:]]


def range_text(view: ResultView, values: np.ndarray, si: str, errors: np.ndarray | float = 0.0) -> str:
    """Range of `values`, in the SI unit `si`, as text in the unit that the user typed. errors:
    absolute errors, of the shape of `values`, or 0."""
    return range_in_unit(view, values, si, errors, ANSWER_DIGITS)


def si_loads_text(view: ResultView, loads: np.ndarray) -> str:
    """Range of the loads `loads`, (n,) in SI units, as text in the unit that the user typed."""
    return range_text(view, loads, UNITS[view.load_kind][0])


def _with_failure(answer: Callable[[ResultView, np.ndarray], tuple[Lines, Lines]]) -> Callable[..., Lines]:
    """Function from (view, mask of the points in the model) to the answer's lines, with a line on failed
    searches. answer: function from (view, mask of the solved points) to (answer, further lines)."""

    def lines(view: ResultView, rods: np.ndarray) -> Lines:
        failed = rods & view.has_status(FAILED_STATUS)
        failure = f"the result is not known{_count_clause(failed, rods)}: the search failed"
        unsolved = [failure] if failed.any() else []
        if (failed == rods).all():
            return unsolved
        first_line, other_lines = answer(view, rods & ~failed)
        return [*first_line, *unsolved, *other_lines]

    return lines


def _threshold_lines(view: ResultView, rods: np.ndarray) -> tuple[Lines, Lines]:
    """Returns (lines about flutter, lines about extreme arms, effect of drag, onset of oscillation and return
    to stability)."""
    load = view.load_kind
    variables = view.variables
    flutter, ends, rates = (
        variables[name][rods] for name in (f"{load}_hopf", f"{load}_end", "frequency_hopf_hz")
    )
    lines = [*_extreme_arm_lines(view, rods, flutter), *flutter_force_line(view, rods)]
    onset = variables[f"{load}_onset"][rods]
    restabilized = variables[f"{load}_restabilization"][rods]
    if len(flutter) > 1 and np.isfinite(onset).any():
        lines.append(f"decaying disturbances oscillate from {si_loads_text(view, onset)} on")
    if len(flutter) > 1 and np.isfinite(restabilized).any():
        points = count_of_total(int(np.isfinite(restabilized).sum()), len(restabilized), "point")
        lines.append(
            f"the straight arm is stable again at {points}, from {si_loads_text(view, restabilized)} on"
        )
    return _flutter_lines(view, flutter, ends, rates), lines


def _extreme_arm_lines(view: ResultView, rods: np.ndarray, loads: np.ndarray) -> Lines:
    """Lines on the arms with the smallest and the largest flutter load, and on the effect of drag; empty with
    fewer than two loads. loads: flutter loads of the points in the mask `rods`, (n,)."""
    if np.isfinite(loads).sum() < 2:
        return []
    extremes_text = extreme_arms_text(view, rods, loads, "smallest flutter load")
    lines = [extremes_text] if extremes_text else []
    indices = np.flatnonzero(rods)
    numbers = {"flutter": loads, "its frequency": view.variables["frequency_hopf_hz"][rods]}
    on_all_points = {name: np.full(rods.size, np.nan) for name in numbers}
    for name, values in numbers.items():
        on_all_points[name][indices] = values
    return [*lines, *drag_lines(view, on_all_points)]


def _crossing_lines(view: ResultView, rods: np.ndarray) -> tuple[Lines, Lines]:
    """Returns (lines about loads and frequencies at the first Hopf points, [])."""
    variables = view.variables
    load = view.load_kind
    loads, frequency = _at_first_hopf(view, rods, f"crossing_{load}")
    return _flutter_lines(view, loads, variables[f"{load}_end"][rods], frequency), []


def _count_clause(mask: np.ndarray, rods: np.ndarray) -> str:
    """Clause on the number of points in the mask `mask`; empty if the mask `rods` has one point only."""
    return f" at {int(mask.sum())} of {int(rods.sum())} points" if rods.sum() > 1 else ""


def _flutter_lines(view: ResultView, loads: np.ndarray, end: np.ndarray, frequency: np.ndarray) -> Lines:
    """Lines about flutter. loads: flutter loads. end: largest searched loads. frequency: in Hz. All (n,)."""
    flutters = np.isfinite(loads)
    search = f"up to {si_loads_text(view, end)}" if np.isfinite(end).any() else ""
    if not flutters.any():
        return [f"does not flutter {search}".rstrip()]
    count_clause = f" at {int(flutters.sum())} of {len(loads)} points" if not flutters.all() else ""
    sentence = f"flutter begins{count_clause} at {si_loads_text(view, loads)}"
    lines = [f"{sentence}; there the arm beats at {range_text(view, frequency, 'Hz')}"]
    if count_clause:
        lines.append(f"does not flutter at {int((~flutters).sum())} of {len(loads)} points {search}".rstrip())
    return lines


def _cycle_lines(view: ResultView, rods: np.ndarray) -> Lines:
    """Lines about frequency, amplitude and effect of drag of limit cycles; if there is no cycle, about the
    outcomes. rods: mask of the points to which the rod model applies."""
    names = {"frequency_hz": "frequency", "tip_y_max_si": "tip_y_max"}
    values = {name: view.variables[name][rods] for name in names}
    errors = {name: errors_in_si(view.variables, source, name)[rods] for name, source in names.items()}
    cycles = rods & view.has_status("cycle")
    if not cycles.any():  # if some arms beat, another line of the summary counts all outcomes
        masks = {phrase: rods & view.has_status(status) for status, phrase in NO_CYCLE_WORDS.items()}
        return [f"{phrase}{_count_clause(mask, rods)}" for phrase, mask in masks.items() if mask.any()]
    is_cycle = cycles[rods]
    height, frequency = (
        range_text(view, values[name][is_cycle], unit, errors[name][is_cycle])
        for name, unit in (("tip_y_max_si", "m"), ("frequency_hz", "Hz"))
    )
    motion = f"beats{_count_clause(cycles, rods)} at {frequency}, its tip by {height} to either side"
    keys = {"frequency": "frequency_hz", "reach of the tip": "tip_y_max_si", "power": "injection_mean_si"}
    numbers = {name: np.where(cycles, view.variables[key], np.nan).ravel() for name, key in keys.items()}
    return [motion, *_drag_outcome_line(view, rods), *drag_lines(view, numbers)]


def _drag_outcome_line(view: ResultView, rods: np.ndarray) -> Lines:
    """Line with the numbers of arms (with load) that beat for all, some or no drags of their range. Empty
    list if drag is not varied or an outcome is undecided."""
    arms = arm_index_of_points(view)
    if arms is None or (rods & ~view.has_status("cycle", "straight")).any():
        return []
    is_cycle = view.has_status("cycle").ravel()
    by_arm = [is_cycle[(arms == arm) & rods.ravel()] for arm in np.unique(arms[rods.ravel()])]
    always = sum(mask.all() for mask in by_arm)
    never = sum(not mask.any() for mask in by_arm)
    some = len(by_arm) - always - never
    numbers = {"for every drag": always, "for part of the range of drag": some, "for no drag": never}
    counts_text = ", ".join(f"{phrase} at {count}" for phrase, count in numbers.items() if count)
    return [f"of {counted(len(by_arm), 'combination')} of arm and load: beats {counts_text}"]


def _mode_lines(view: ResultView, rods: np.ndarray) -> Lines:
    """Lines about stability and leading frequency of the straight arms."""
    count = view.variables["unstable_count"]
    unstable = rods & (count > 0)
    is_unknown = rods & (count < 0)
    lines = []
    if unstable.any():
        frequency = range_text(view, np.abs(view.variables["frequency_hz"][unstable][:, 0]), "Hz")
        count_clause = _count_clause(unstable, rods)
        lines = [f"the straight arm is unstable{count_clause}; its leading mode oscillates at {frequency}"]
    elif not is_unknown.any():
        lines = ["the straight arm is stable"]
    if is_unknown.any():
        lines.append(f"whether the straight arm is stable is not known{_count_clause(is_unknown, rods)}")
    return lines


def _branch_lines(view: ResultView, rods: np.ndarray) -> tuple[Lines, Lines]:
    """Returns (lines about loads and frequencies of cycles on branches, [])."""
    loads = view.variables[f"branch_{view.load_kind}"][rods]
    if not np.isfinite(loads).any():
        return ["has no branch of cycles from a Hopf point in the range searched"], []
    frequency = 1 / view.variables["period_si"][rods]
    rate_text = range_text(view, frequency, "Hz", errors=frequency * view.variables["period_error"][rods])
    return [f"cycles, stable or not, exist at {si_loads_text(view, loads)}; they beat at {rate_text}"], []


def _row_lines(view: ResultView, rods: np.ndarray) -> tuple[Lines, Lines]:
    """Returns (lines about loads and frequencies at the first Hopf points, [])."""
    variables = view.variables
    scale = np.broadcast_to(variables[SCALE_NAMES[view.load_kind]], rods.shape)[rods]
    forces, frequency = _at_first_hopf(view, rods, "crossing_at")
    last_force = np.minimum(variables["F"][-1], view.point_columns["k1"].reshape(rods.shape)[rods])
    return _flutter_lines(view, forces * scale, last_force * scale, frequency), []


def _at_first_hopf(view: ResultView, rods: np.ndarray, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Returns (values of the variable `name`, frequencies in Hz) at the first Hopf point of each arm in the
    mask `rods`, (n,) each; NaN for an arm without a Hopf point."""
    is_hopf = view.variables["crossing_kind"][rods] == CROSSING_KINDS.index("hopf")
    first_hopf = np.arange(len(is_hopf)), np.argmax(is_hopf, axis=-1)
    has_hopf = is_hopf.any(axis=-1)
    names = (name, "crossing_frequency_hz")
    values, frequency = (
        np.where(has_hopf, view.variables[variable_name][rods][first_hopf], np.nan) for variable_name in names
    )
    return values, frequency


ANSWER_LINES_BY_TASK: dict[str, Callable[[ResultView, np.ndarray], Lines]] = {
    "spectrum": _mode_lines,
    "modes": _mode_lines,
    "thresholds": _with_failure(_threshold_lines),
    "criticality": _with_failure(_crossing_lines),
    "limit_cycle": _cycle_lines,
    "branch": _with_failure(_branch_lines),
    "phase_diagram": lambda view, rods: (
        [] if "F" in view.parameters else _with_failure(_row_lines)(view, rods)
    ),
}
"""For each task, the function of the view and a mask of computed points that returns the answer's lines."""
