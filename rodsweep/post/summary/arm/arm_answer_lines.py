"""First lines of `rodsweep show` for an arm: validity of the model, flutter load, frequency of beating.
Quantities are in the units typed by the user, frequencies in Hz."""

from collections.abc import Callable

import numpy as np

from ....config.arm.status import NOT_SLENDER
from ....model.arm.neglected import Validity
from ....model.arm.quantities import LOAD_SCALE_NAME_BY_LOAD, UNITS_AND_EXAMPLES
from ....results.layouts.si_variables import VALIDITY_VARIABLES
from ....results.layouts.thresholds import CROSSING_KINDS
from ....wording import counted
from ...crushing import crushing_forces
from ..selection import PointSelection
from .arm_texts import errors_in_si, range_text_in_printing_unit
from .load_lines import (
    MAX_ANSWER_DIGITS,
    arm_index_apart_from_drag,
    compression_lines,
    drag_variation_lines,
    extreme_arms_text,
    flutter_force_line,
)
from .validity_sentences import bending_plane_warning, judged_row_motion_clause, validity_sentence

TextLines = list[str]
"""Lines of text."""
FAILED_STATUS = "failed"
"""Status of a point whose solve failed."""
NO_CYCLE_PREDICATE_BY_STATUS = {
    "straight": "does not beat",
    "unstable": "has an unstable cycle",
    "torus": "beats quasiperiodically (two frequencies)",
    "not_settled": "is not settled: no stable cycle was found, but a stable cycle may exist",
    "left_the_model": "is crushed somewhere or loses its stiffness, where the model ends",
    FAILED_STATUS: "is not known: the solve failed",
}
"""Predicate for an arm without a stable cycle, by status."""
THRESHOLD_SEARCH_TASKS = ("thresholds", "criticality", "branch", "phase_diagram")
"""Tasks that search for thresholds, which may fail."""


def arm_answer(points: PointSelection) -> TextLines:
    """Lines with the answer about the arms at the computed points; empty for a rod."""
    view = points.view
    if not view.quantities:
        return []
    arms = points.where(view.variables["status"] < NOT_SLENDER)
    return [
        *bending_plane_warning(view.quantities),
        *_validity_and_answer_lines(points, arms),
        *compression_lines(arms),
    ]


def _validity_and_answer_lines(points: PointSelection, arms: PointSelection) -> TextLines:
    """Line on the validity of the model, and lines with the answer for the arms to which it applies; for all
    arms if it applies to none. points: all computed points. arms: the points with a slender arm."""
    if not arms.count:
        no_rods = ["none of these arms corresponds to a rod of the model; the statuses state the reasons"]
        return no_rods if points.count else []
    validity = {variable.name: arms.values(variable.name) for variable in VALIDITY_VARIABLES}
    noun = "row" if "crossing_at" in arms.variables else "point"
    caveat = validity_sentence(validity, judged_row_motion_clause(arms), noun)
    in_model = arms.where(arms.variables["model_applies"] != Validity.does_not_apply)
    answer = _task_lines(in_model if in_model.count else arms)
    if not in_model.count:
        return [caveat, *(f"if the model applied: {line}" for line in answer)]
    if in_model.count < arms.count:
        return [caveat, *(f"where the model applies: {line}" for line in answer)]
    return [caveat, *answer] if validity["model_applies"].any() else [*answer[:1], caveat, *answer[1:]]


def _task_lines(arms: PointSelection) -> TextLines:
    """Lines with the answer of the task; for searches, also a line on the searches that failed."""
    task = arms.view.task
    failed = arms.with_status(FAILED_STATUS)
    if task not in THRESHOLD_SEARCH_TASKS or not failed.count:
        return ANSWER_LINES_BY_TASK[task](arms)
    solved = arms.where(~failed.mask)
    lines = ANSWER_LINES_BY_TASK[task](solved) if solved.count else []
    return [*lines, f"the result is not known{_point_count_clause(failed, arms)}: the search failed"]


def range_text_in_typed_unit(
    arms: PointSelection, values: np.ndarray, si: str, errors: np.ndarray | float = 0.0
) -> str:
    """Range of `values`, in the SI unit `si`, as text in the unit that the user typed. errors:
    absolute errors, of the shape of `values`, or 0."""
    return range_text_in_printing_unit(arms.view, values, si, errors, MAX_ANSWER_DIGITS)


def si_load_range_text(arms: PointSelection, loads: np.ndarray) -> str:
    """Range of the loads `loads`, (n,) in SI units, as text in the unit that the user typed."""
    return range_text_in_typed_unit(arms, loads, UNITS_AND_EXAMPLES[arms.view.load_kind][0])


def _point_count_clause(part: PointSelection, arms: PointSelection) -> str:
    """Clause on the number of points of `part` among those of `arms`; empty if `arms` has one point."""
    return f" at {part.count} of {arms.count} points" if arms.count > 1 else ""


def _threshold_lines(arms: PointSelection) -> TextLines:
    """Lines about flutter, extreme loads, effect of drag, onset of oscillation, later stability."""
    load = arms.view.load_kind
    names = (f"{load}_hopf", f"{load}_end", "frequency_hopf_hz")
    flutter, ends, rates = map(arms.values, names)
    lines = _flutter_lines(arms, flutter, ends, rates)
    if np.isfinite(flutter).sum() > 1:
        extremes_text = extreme_arms_text(arms, flutter, "smallest flutter load")
        lines += [extremes_text] if extremes_text else []
        lines += drag_variation_lines(arms, {"flutter": names[0], "its frequency": names[2]})
    lines += flutter_force_line(arms)
    onset, restabilized = (arms.values(f"{load}_{event}") for event in ("onset", "restabilization"))
    if arms.count > 1 and np.isfinite(onset).any():
        lines.append(f"decaying disturbances start to oscillate at {si_load_range_text(arms, onset)}")
    if arms.count > 1 and np.isfinite(restabilized).any():
        points_text = f"{np.isfinite(restabilized).sum()} of {counted(arms.count, 'point')}"
        again_text = f"from {si_load_range_text(arms, restabilized)} on"
        lines.append(f"the straight arm is stable again at {points_text}, {again_text}")
    return lines


def _flutter_lines(
    arms: PointSelection, loads: np.ndarray, ends: np.ndarray, frequency: np.ndarray
) -> TextLines:
    """Lines about flutter. Flutter loads and the ends of searches: SI units; frequency: Hz; (n,) each."""
    flutter_count = int(np.isfinite(loads).sum())
    search = f" up to {si_load_range_text(arms, ends)}" if np.isfinite(ends).any() else ""
    if not flutter_count:
        return [f"does not flutter{search}"]
    count_clause = f" at {flutter_count} of {len(loads)} points" if flutter_count < len(loads) else ""
    sentence = f"flutter begins{count_clause} at {si_load_range_text(arms, loads)}"
    lines = [f"{sentence}; there the arm beats at {range_text_in_typed_unit(arms, frequency, 'Hz')}"]
    if count_clause:
        lines.append(f"does not flutter at {len(loads) - flutter_count} of {len(loads)} points{search}")
    return lines


def _first_hopf_lines(arms: PointSelection) -> TextLines:
    """Lines about loads and frequencies at the first Hopf points."""
    load = arms.view.load_kind
    return _flutter_lines(
        arms,
        _values_at_first_hopf_point(arms, f"crossing_{load}"),
        arms.values(f"{load}_end"),
        _values_at_first_hopf_point(arms, "crossing_frequency_hz"),
    )


def _first_hopf_lines_of_rows(arms: PointSelection) -> TextLines:
    """Lines about loads and frequencies at the first Hopf points of rows along F; empty for rows along
    another parameter."""
    view = arms.view
    if "F" in view.parameters:
        return []
    name = LOAD_SCALE_NAME_BY_LOAD[view.load_kind]
    scale = np.broadcast_to(view.variables[name], arms.mask.shape)[arms.mask]
    last_force = np.minimum(view.variables["F"][-1], crushing_forces(view)[arms.mask.ravel()])
    forces = _values_at_first_hopf_point(arms, "crossing_at")
    return _flutter_lines(
        arms, forces * scale, last_force * scale, _values_at_first_hopf_point(arms, "crossing_frequency_hz")
    )


def _values_at_first_hopf_point(arms: PointSelection, name: str) -> np.ndarray:
    """Values of the variable `name` at the first Hopf point of each arm, (n,); NaN for an arm without a Hopf
    point."""
    is_hopf = arms.values("crossing_kind") == CROSSING_KINDS.index("hopf")
    first_hopf = np.arange(arms.count), np.argmax(is_hopf, axis=-1)
    return np.where(is_hopf.any(axis=-1), arms.values(name)[first_hopf], np.nan)


def _cycle_lines(arms: PointSelection) -> TextLines:
    """Lines about frequency, amplitude and effect of drag of limit cycles; if there is no cycle, about
    the outcomes."""
    cycles = arms.with_status("cycle")
    if not cycles.count:  # if some arms beat, another line of the summary counts all outcomes
        phrases = NO_CYCLE_PREDICATE_BY_STATUS.items()
        parts = [(phrase, arms.with_status(status)) for status, phrase in phrases]
        return [f"{phrase}{_point_count_clause(part, arms)}" for phrase, part in parts if part.count]
    height_text, frequency_text = (
        range_text_in_typed_unit(
            arms, cycles.values(si_name), unit, errors_in_si(arms.variables, name, si_name)[cycles.mask]
        )
        for name, si_name, unit in (("tip_y_max", "tip_y_max_si", "m"), ("frequency", "frequency_hz", "Hz"))
    )
    count_clause = _point_count_clause(cycles, arms)
    motion = f"beats{count_clause} at {frequency_text}, its tip by {height_text} to either side"
    names = {"frequency": "frequency_hz", "reach of the tip": "tip_y_max_si", "power": "injection_mean_si"}
    return [motion, *_drag_outcome_line(arms), *drag_variation_lines(cycles, names)]


def _drag_outcome_line(arms: PointSelection) -> TextLines:
    """Line that counts the combinations of arm and load that beat with every drag, with some, or with none.
    Empty list if drag is not varied or an outcome is undecided."""
    arm_indices = arm_index_apart_from_drag(arms.view)
    if arm_indices is None or arms.with_status("cycle", "straight").count < arms.count:
        return []
    is_cycle = arms.with_status("cycle").mask.ravel()[arms.mask.ravel()]
    own_indices = arm_indices[arms.mask.ravel()]
    by_arm = [is_cycle[own_indices == index] for index in np.unique(own_indices)]
    always = sum(mask.all() for mask in by_arm)
    never = sum(not mask.any() for mask in by_arm)
    some = len(by_arm) - always - never
    numbers = {"for every drag": always, "for part of the range of drag": some, "for no drag": never}
    counts_text = ", ".join(f"{phrase} at {count}" for phrase, count in numbers.items() if count)
    return [f"of {counted(len(by_arm), 'combination')} of arm and load: beats {counts_text}"]


def _leading_mode_lines(arms: PointSelection) -> TextLines:
    """Lines about stability and leading frequency of the straight arms."""
    unstable_count = arms.variables["unstable_count"]
    unstable = arms.where(unstable_count > 0)
    unknown = arms.where(unstable_count < 0)
    lines = []
    if unstable.count:
        frequency = range_text_in_typed_unit(arms, np.abs(unstable.values("frequency_hz")[:, 0]), "Hz")
        place_text = _point_count_clause(unstable, arms)
        lines = [f"the straight arm is unstable{place_text}; its leading mode oscillates at {frequency}"]
    elif not unknown.count:
        lines = ["the straight arm is stable"]
    if unknown.count:
        lines.append(f"whether the straight arm is stable is not known{_point_count_clause(unknown, arms)}")
    return lines


def _branch_lines(arms: PointSelection) -> TextLines:
    """Lines about loads and frequencies of cycles on branches."""
    loads = arms.values(f"branch_{arms.view.load_kind}")
    if not np.isfinite(loads).any():
        return ["has no branch of cycles from a Hopf point in the range searched"]
    frequency = 1 / arms.values("period_si")
    rate_text = range_text_in_typed_unit(
        arms, frequency, "Hz", errors=frequency * arms.values("period_error")
    )
    return [f"cycles, stable or not, exist at {si_load_range_text(arms, loads)}; they beat at {rate_text}"]


ANSWER_LINES_BY_TASK: dict[str, Callable[[PointSelection], TextLines]] = {
    "spectrum": _leading_mode_lines,
    "modes": _leading_mode_lines,
    "thresholds": _threshold_lines,
    "criticality": _first_hopf_lines,
    "limit_cycle": _cycle_lines,
    "branch": _branch_lines,
    "phase_diagram": _first_hopf_lines_of_rows,
}
"""For each task, the function that returns the lines of the answer about the arms."""
