"""Paragraph of the portrait of a rod: thresholds, criticality, branches, coexisting states, cycles, missing
results."""

from collections.abc import Iterator, Sequence
from math import isfinite

import numpy as np

from ...results.layouts.limit_cycle import STATUS_NAMES_WITH_CYCLE
from ...results.layouts.thresholds import CROSSING_KINDS
from ...wording import counted, is_or_are
from ..stored_branches import StoredBranch
from ..summary.branch import SPECIAL_POINT_WORDS
from ..summary.criticality import CRITICALITY_WORDS
from ..summary.number_texts import rounded_text
from ..summary.thresholds import ENDED_EARLY_STATUS
from .arm_sentences import arm_sentences, cycle_validity_caveat
from .portrait_units import PortraitUnits
from .results import RodResults

SAME_HOPF_POINT_TOLERANCE = 1e-6
"""Hopf points of two tasks are the same Hopf point if their forces differ by at most this relative amount."""
THRESHOLD_CLAUSES = {
    "onset": "decaying disturbances start to oscillate at {F}",
    "hopf": "a pair of modes becomes unstable at {F}",
    "hopf_reverse": "a pair becomes stable at {F}, where other modes stay unstable",
    "restabilization": "it is stable again from {F}",
    "real_again": "decaying disturbances stop oscillating at {F}",
    "real_leads": "a real eigenvalue becomes the leading eigenvalue at {F}",
    "pair_leads": "a complex pair overtakes the leading real eigenvalue at {F}",
}
"""Clause on the straight rod at a threshold, by kind of threshold."""
TASKS_WITH_STATED_STATUS = ("thresholds", "criticality", "branch")
"""Tasks whose status the paragraph states unless the status is `SUCCESS_STATUS`."""
SUCCESS_STATUS = "ok"
"""Status of a search for thresholds, criticality or branches that is complete."""


def paragraph(results: RodResults) -> str:
    """All results about the rod as one paragraph of text."""
    states = (*_threshold_sentences(results), *_branch_sentences(results), *_cycle_sentences(results))
    return " ".join([*_rod_sentence(results), *states, *_missing_result_sentences(results)])


def _rod_sentence(results: RodResults) -> Iterator[str]:
    """Yields a sentence on the parameters of the rod and the searched range of the load, and for an arm
    further sentences."""
    end_force = float(results.views["thresholds"].point_values(0)["F_end"])
    units = results.units
    end_text = units.load_text(end_force)
    requested_force_text = units.load_text(results.F_max)
    kind = results.rod.kind
    search_text = f"was searched up to {end_text}"
    if not isfinite(end_force):
        search_text = "could not be searched"
    elif end_text != requested_force_text:
        reason = f"just above {end_text} the {kind} is crushed"
        if results.views["thresholds"].has_status(ENDED_EARLY_STATUS).all():
            reason = "the search ended early: the list was full, or modes could not be counted"
        search_text += f", not to {requested_force_text}: {reason}"
    yield f"The {kind} with {results.rod.description} {search_text}."
    if results.rod.arm:
        yield from arm_sentences(results)


def _threshold_sentences(results: RodResults) -> Iterator[str]:
    """Yields sentences on the thresholds of the straight rod, with the criticality of the Hopf points."""
    view = results.views["thresholds"]
    variables = view.point_values(0)
    crossing_indices = np.flatnonzero(variables["crossing_kind"] > 0)
    units = results.units
    end_text = units.load_text(float(variables["F_end"]))
    clauses = []
    for i in crossing_indices:
        kind = CROSSING_KINDS[int(variables["crossing_kind"][i])]
        clause = THRESHOLD_CLAUSES[kind].format(
            F=units.load_text(variables["crossing_F"][i], variables["crossing_error"][i])
        )
        if frequency := float(variables["crossing_frequency"][i]):
            clause += f" (frequency {units.frequency_text(frequency)}"
            clause += f"{_criticality_clause(results, float(variables['crossing_F'][i]))})"
        clauses.append(clause)
    if clauses:
        yield f"In the straight state, {'; '.join(clauses)}."
    elif variables["crossing_count"] == 0:
        yield f"The straight {results.rod.kind} has no threshold up to {end_text}."
    if variables["crossing_count"] >= 0:
        range_clause = f" up to {end_text}" if view.has_status(ENDED_EARLY_STATUS).all() else ""
        proof_text = "proved complete" if variables["certified"] else "not proved complete"
        yield f"This list of thresholds{range_clause} is {proof_text}."


def _criticality_clause(results: RodResults, F: float) -> str:
    """Clause on the criticality of the Hopf point at the force F; empty if there is no Hopf point at F."""
    view = results.views.get("criticality")
    if view is None:
        return ""
    variables = view.point_values(0)
    is_same_crossing = np.abs(variables["crossing_F"] - F) <= SAME_HOPF_POINT_TOLERANCE * abs(F)
    criticalities = variables["criticality"][is_same_crossing & np.isfinite(variables["criticality"])]
    if not criticalities.size:
        return ""
    side_word = "above" if variables["amplitude_coefficient"][is_same_crossing][0] > 0 else "below"
    return f"; {CRITICALITY_WORDS[int(criticalities[0])]}, with cycles {side_word} this load"


def _branch_sentences(results: RodResults) -> Iterator[str]:
    """Yields sentences on the branches of cycles, their special points, and the ranges in which cycles are
    stable."""
    rod = results.branches
    if rod is None:
        return
    if rod.hidden_count:
        yield (
            f"{rod.hidden_count} of its branches of cycles {is_or_are(rod.hidden_count)} not drawn: the list "
            "of special points is full."
        )
    curves = rod.curves
    if not curves:
        yield "No branch of cycles begins at a Hopf point in this range."
        return
    units = results.units
    cycles = sum(int(curve.is_cycle.sum()) for curve in curves)
    texts = [
        f"{counted(len(loads), word)} at {units.load_phrase(', '.join(loads))}"
        for kind, word in SPECIAL_POINT_WORDS.items()
        if (loads := _special_point_loads(curves, kind, units.force.factor_from_dimensionless))
    ]
    accuracy = results.views["branch"].config["accuracy"]
    branches_phrase = f"{counted(len(curves), 'branch')} of cycles ({cycles} solved to {accuracy:g})"
    special_points_phrase = (
        f"with {' and '.join(texts)}" if texts else "without a fold or another change of stability"
    )
    yield f"{branches_phrase} {_beginnings_phrase(curves)}, {special_points_phrase}."
    yield from _incomplete_branches_sentence(curves, units)
    stable = [stable_range for curve in curves for stable_range in curve.stable_ranges]
    is_decided = all(curve.is_fully_known for curve in curves)
    no_cycle_text = "none" if is_decided and not rod.hidden_count else "none is known"
    errors = rod.special_point_parameter_errors
    yield f"Stable cycles: {units.load_ranges_text(stable, errors) if stable else no_cycle_text}."
    if not rod.hidden_count:
        ranges = rod.coexistence_ranges
        ranges_text = units.load_ranges_text(ranges, errors) if ranges else ""
        yield _coexistence_sentence(ranges_text, rod.is_coexistence_known, results.rod.kind)
        if pairs := rod.two_stable_cycle_ranges:
            yield f"Two different cycles are stable at {units.load_ranges_text(pairs, errors)}."


def _beginnings_phrase(curves: Sequence[StoredBranch]) -> str:
    """Phrase for the places where branches begin, such as "begin at its Hopf points"."""
    kinds = [curve.special_points[0].kind for curve in curves]
    is_single_curve = len(curves) == 1
    place_texts = []
    if "hopf" in kinds:
        place_texts.append("at a Hopf point" if is_single_curve else "at its Hopf points")
    if breakings := kinds.count("symmetry_breaking"):
        place_texts.append(f"at {counted(breakings, 'symmetry breaking')}")
    if any(curve.starts_outside_range for curve in curves):
        place_texts.append("beyond the range")
    verb = "begins" if is_single_curve else "begin"
    return f"{verb} {' and '.join(place_texts)}".replace(" and at ", " and ")


def _incomplete_branches_sentence(curves: Sequence[StoredBranch], units: PortraitUnits) -> Iterator[str]:
    """Yields a sentence on the branches that are not drawn to their ends, because the portrait has reached
    its limit on work or on the number of cycles."""
    limited_curves = [curve for curve in curves if curve.special_points[-1].reason == "list_full"]
    if not limited_curves:
        return
    end_texts = [
        units.load_text(curve.special_points[-1].at) for curve in limited_curves if curve.is_cycle.any()
    ]
    clauses = (
        [f"{len(end_texts)} of them {is_or_are(len(end_texts))} drawn only to {', '.join(end_texts)}"]
        if end_texts
        else []
    )
    if missing_count := len(limited_curves) - len(end_texts):
        clauses.append(f"{missing_count} {is_or_are(missing_count)} not drawn")
    yield (
        f"{' and '.join(clauses)}, because the portrait has reached its limit of work or of cycles; "
        "`rodsweep run` with task: branch follows branches to their ends."
    )


def _coexistence_sentence(ranges: str, is_decided: bool, kind: str) -> str:
    """Sentence on the coexistence of a stable cycle and the stable straight rod. ranges: loads of coexistence
    as text; empty if no such load was found. is_decided: whether the stability of all states is known. kind:
    "rod" or "arm"."""
    if ranges:
        return f"A stable cycle exists beside the stable straight {kind} at {ranges}."
    if is_decided:
        return f"On these branches no stable cycle exists beside the stable straight {kind}."
    return f"It is not known whether a stable cycle exists beside the stable straight {kind}."


def _special_point_loads(curves: Sequence[StoredBranch], kind: str, factor: float) -> list[str]:
    """Distinct loads, as text, at the special points of the given kind. factor: load at F = 1."""
    points = [special for curve in curves for special in curve.special_points if special.kind == kind]
    return list(dict.fromkeys(rounded_text(factor * point.at, factor * point.error) for point in points))


def _cycle_sentences(results: RodResults) -> Iterator[str]:
    """Yields a sentence on the drawn cycles, and on the loads at which no cycle was found."""
    units = results.units
    clauses = []
    for F, view in results.cycles:
        variables = view.point_values(0)
        word = str(view.status_names[0])
        if word not in STATUS_NAMES_WITH_CYCLE:
            no_cycle_text = f"no cycle that is drawn ({word.replace('_', ' ')})"
            clauses.append(
                f"at {units.load_text(F)} a motion from a small deflection leads to {no_cycle_text}"
            )
            continue
        period = units.time.text(
            float(variables["period"]), float(variables["period"] * variables["period_error"])
        )
        y_text = units.length.text(
            float(variables["tip_y_max"]), float(variables["tip_y_max"] * variables["amplitude_error"])
        )
        place_text = f"at {units.load_text(F)}{', unstable,' if word == 'unstable' else ''}"
        clauses.append(
            f"{place_text} the period is {period} and the largest y of the tip {y_text}"
            f"{cycle_validity_caveat(view)}"
        )
    if clauses:
        yield f"Cycles: {'; '.join(clauses)}."


def _missing_result_sentences(results: RodResults) -> Iterator[str]:
    """Yields sentences on missing results, and on results whose status is not `SUCCESS_STATUS`."""
    for task, reason in results.missing_result_reasons.items():
        yield f"Not solved, {task.replace('_', ' ')}: {reason}."
    for task in TASKS_WITH_STATED_STATUS:
        if (view := results.views.get(task)) and (word := str(view.status_names[0])) != SUCCESS_STATUS:
            yield f"About {task}, {word.replace('_', ' ')}: {view.status_sentences.get(word, word)}."
