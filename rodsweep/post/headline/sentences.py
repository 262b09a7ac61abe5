"""For each task, the sentence with the answer about one rod, and the numbers and the list printed below the
sentence."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...wording import counted
from ..branch_curves import RodBranches
from ..summary.thresholds import (
    FIRST_CROSSING_WORDS,
    LATER_CROSSING_WORDS,
    later_flutter_change_indices,
    oscillation_end_index,
)
from .one_rod import SingleRodResult


@dataclass(frozen=True, slots=True)
class Headline:
    """First lines printed about the result of a task for one rod.

    sentence: function that returns the sentence with the answer, or an empty text if there is no answer.
    number_variables: variables of the rod to print. list_name: name of the list to print; empty if no list is
    printed. columns: columns of this list. The most important numbers and columns come first.
    """

    sentence: Callable[[SingleRodResult], str]
    number_variables: tuple[str, ...]
    list_name: str = ""
    columns: tuple[str, ...] = ()


def eigenvalue_sentence(rod: SingleRodResult) -> str:
    """Sentence on the number of unstable modes and the leading eigenvalue; empty if no eigenvalue is
    stored."""
    unstable_count = rod.integer_value("unstable_count")
    stability_text = (
        "the straight rod is stable"
        if unstable_count == 0
        else f"{counted(unstable_count or 0, 'unstable mode')}"
    )
    stability_text = "number of unstable modes not known" if unstable_count is None else stability_text
    mode_texts = rod.list_texts["modes"]
    rate, frequency = (rod.si_name_or_name(mode_texts, name) for name in ("growth_rate", "frequency"))
    if not len(mode_texts.columns[rate].values):
        return ""
    return (
        f"{stability_text}: leading growth rate {mode_texts.short_text(rate)}, frequency "
        f"{mode_texts.short_text(frequency)}"
    )


def threshold_sentence(rod: SingleRodResult) -> str:
    """Sentence on the first force of each kind of threshold and on later windows of flutter, or on the
    searched range without a threshold; empty if the count of crossings is unknown."""
    if rod.integer_value("crossing_count") is None:
        return ""
    clauses = []
    for event, phrase in FIRST_CROSSING_WORDS.items():
        column = rod.column(f"F_{event}")
        if column is not None:
            name = column.name.removesuffix(f"_{event}")
            end_text = _oscillation_end_clause(rod) if event == "onset" else ""
            clauses.append(f"{phrase} {name} = {rod.text(f'F_{event}')}{end_text}")
    clauses += _later_flutter_clauses(rod)
    none_text = "" if rod.integer_value("crossing_count") else f"no threshold up to {_search_end_text(rod)}"
    return (", ".join(clauses) or none_text) + _early_search_end_clause(rod)


def _oscillation_end_clause(rod: SingleRodResult) -> str:
    """Clause on the force at which the oscillation that starts at the first onset ends again without flutter;
    empty if there is no such force."""
    end = oscillation_end_index(rod.column_words("crossings", "crossing_kind"))
    if end is None:
        return ""
    crossings = rod.list_texts["crossings"]
    return f" to {crossings.short_text(rod.si_name_or_name(crossings, 'crossing_F'), end)}"


def _later_flutter_clauses(rod: SingleRodResult) -> list[str]:
    """Clauses on the starts and ends of all windows of flutter after the first."""
    crossings = rod.list_texts["crossings"]
    kinds = rod.column_words("crossings", "crossing_kind")
    name = rod.si_name_or_name(crossings, "crossing_F")
    load = name.removeprefix("crossing_")
    return [
        f"{LATER_CROSSING_WORDS[kinds[i]]} {load} = {crossings.short_text(name, i)}"
        for i in later_flutter_change_indices(kinds)
    ]


def hopf_count_sentence(rod: SingleRodResult) -> str:
    """Sentence on the numbers of supercritical, subcritical and undecided Hopf points, or on the searched
    range without a Hopf point; empty if the count is unknown."""
    hopf_count = rod.integer_value("crossing_count")
    if hopf_count is None:
        return ""
    if hopf_count == 0:
        return f"no Hopf point up to {_search_end_text(rod)}{_early_search_end_clause(rod)}"
    criticality_counts = Counter(
        word or "of unknown criticality" for word in rod.column_words("crossings", "criticality")
    )
    kinds_text = ", ".join(f"{number} {word}" for word, number in criticality_counts.items())
    return f"{counted(hopf_count, 'Hopf point')}: {kinds_text}{_early_search_end_clause(rod)}"


def branch_sentence(rod: SingleRodResult) -> str:
    """Sentence on the numbers of branches and cycles, and the largest y of the tip. If no branch exists, the
    sentence states the searched range of the parameter. Empty if the number of branches is unknown."""
    branches = rod.integer_value("branch_count")
    if branches is None:
        return ""
    parameter, start, stop = (rod.view.config["branch"][key] for key in ("along", "start", "stop"))
    if not branches:
        return f"no branch of cycles: no Hopf point for {parameter} from {start:g} to {stop:g}"
    cycles = rod.list_texts["cycles"]
    hopfs = rod.integer_value("hopf_count") or 0
    start_texts = [counted(hopfs, "Hopf point")] if hopfs else []
    if any(curve.starts_outside_range for curve in RodBranches(rod.view).curves):
        start_texts.append("from beyond the range" if hopfs else "beyond the range")
    text = f"{counted(branches, 'branch')} of cycles from {' and '.join(start_texts)}"
    y_name = rod.si_name_or_name(cycles, "tip_y_max")
    if not len(cycles.columns[y_name].values):
        return f"{text}, no cycle is stored"
    largest_y_text = cycles.short_text(y_name, int(np.nanargmax(cycles.columns[y_name].values)))
    return (
        f"{text}: {counted(rod.integer_value('point_count') or 0, 'cycle')}, largest tip y {largest_y_text}"
    )


def cycle_sentence(rod: SingleRodResult) -> str:
    """Sentence on the period and the amplitude of the cycle; empty if the result has no period."""
    if period := rod.text("period"):
        status = str(rod.view.status_names[0])
        cycle_phrase = "the rod beats" if status == "cycle" else f"{status.replace('_', ' ')} cycle"
        return f"{cycle_phrase}: period {period}, largest tip y {rod.text('tip_y_max')}"
    return ""


def _search_end_text(rod: SingleRodResult) -> str:
    """Largest load of the search as text, such as "F = 200"; empty if unknown."""
    column = rod.column("F_end")
    return "" if column is None else f"{column.name.removesuffix('_end')} = {rod.text('F_end')}"


def _early_search_end_clause(rod: SingleRodResult) -> str:
    """Clause that says at which load a search ended early; empty for a complete search."""
    clause_format = "; not known beyond {}, where the search ended early"
    return clause_format.format(_search_end_text(rod)) if rod.view.has_status("ended_early").all() else ""


FIRST_EIGENVALUE_COLUMNS = ("mode", "growth_rate", "frequency")
"""First columns in the list of eigenvalues."""
HEADLINES = {
    "spectrum": Headline(eigenvalue_sentence, (), "modes", (*FIRST_EIGENVALUE_COLUMNS, "longitudinal_rate")),
    "modes": Headline(
        eigenvalue_sentence,
        ("numerical_abscissa", "transient_growth", "transient_time"),
        "modes",
        (*FIRST_EIGENVALUE_COLUMNS, "condition"),
    ),
    "thresholds": Headline(
        threshold_sentence,
        (),
        "crossings",
        ("crossing", "crossing_kind", "crossing_F", "crossing_frequency", "unstable_after"),
    ),
    "criticality": Headline(
        hopf_count_sentence,
        (),
        "crossings",
        ("crossing", "criticality", "crossing_F", "amplitude_coefficient", "crossing_frequency"),
    ),
    "branch": Headline(
        branch_sentence,
        (),
        "special_points",
        ("special", "special_kind", "special_at", "special_tip_y_max", "special_period", "special_reason"),
    ),
    "limit_cycle": Headline(
        cycle_sentence,
        (
            "period",
            "tip_y_max",
            "multiplier",
            "frequency",
            "injection_mean",
            "linear_growth_rate",
            "linear_frequency",
        ),
    ),
}
"""Headline of the result of one rod, by task."""
