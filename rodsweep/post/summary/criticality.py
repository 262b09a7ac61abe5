"""Hopf points in `rodsweep show`: criticality, coefficients of the normal form, and errors.
variables: variables of a single rod, by name."""

from collections.abc import Iterator, Mapping

import numpy as np

from ...results.file.view import ResultView
from ...results.layouts.thresholds import CROSSING_KINDS
from ...results.layouts.variables import ANGULAR_UNIT
from ...wording import count_of_total, counted
from .arm.arm import crossings_of_arm
from .errors import absolute_errors
from .number_texts import number_and_error, rounded_text, span_text
from .summary_lines import MAX_LISTED_ITEMS, SummaryLines, TextTable, in_brackets, proof_clause, region_text
from .thresholds import ENDED_EARLY, unknown_beyond_clause, unknown_clause, unstored_crossings_clause

CRITICALITY_WORDS = {-1: "supercritical", 1: "subcritical", 0: "undecided"}
"""Word for the criticality of a Hopf point, by sign of Re c (c: cubic coefficient of the normal form)."""
HOPF_SYMBOLS_AND_UNITS = {
    "crossing_F": "F, k3/L^2",
    "crossing_frequency": f"frequency, {ANGULAR_UNIT}",
    "landau_real": "Re c, 1/(tau2 L^2)",
    "landau_imag": "Im c, 1/(tau2 L^2)",
    "growth_slope_real": "Re dw/dF, L^2/(k3 tau2)",
    "growth_slope_imag": "Im dw/dF, L^2/(k3 tau2)",
    "amplitude_coefficient": "a, L",
    "frequency_slope": "b, L^2/(k3 tau2)",
}
"""Symbol and unit of each number of a Hopf point, by variable."""


def criticality_summary(view: ResultView, computed: np.ndarray) -> SummaryLines:
    """Summary of Hopf points. computed: mask of the computed points, of the shape of the points."""
    v = view.variables
    if computed.size == 1:
        none_text = "the Hopf points of this rod are not known"
        if v["crossing_count"].max() >= 0:
            none_text = f"no Hopf point up to F = {span_text(v['F_end'])}"
        of_rod = view.point_values(0)
        lines = list(_hopf_lines(of_rod)) or [none_text]
        lines[0] += unknown_beyond_clause(view, float(of_rod["F_end"]))
        reliability = [_searched_range_line(view, computed)]
        numbers = _hopf_table(of_rod)
        return SummaryLines(lines, reliability, arm_sentences=crossings_of_arm(view), numbers=numbers)
    criticality = v["criticality"][computed]
    is_known = np.isfinite(criticality)
    with_hopf = v["crossing_count"] > 0
    place_text = in_brackets(region_text(view, computed & with_hopf)) if (computed & with_hopf).any() else ""
    unknown = int(((v["crossing_count"] < 0) | (view.has_status(ENDED_EARLY) & ~with_hopf))[computed].sum())
    lines = [
        f"Hopf points at {count_of_total(with_hopf[computed].sum(), computed.sum(), 'rod')}"
        f"{place_text}{unknown_clause(unknown)}"
    ]
    if not is_known.any():
        return SummaryLines(lines, [_searched_range_line(view, computed)])
    names = ("amplitude_coefficient", "frequency_slope")
    values, errors = ((v[name][computed], absolute_errors(v, name)[computed]) for name in names)
    forces_text = span_text(v["crossing_F"][computed][:, 0], v["crossing_error"][computed][:, 0])
    amplitude_text = span_text(*(table[:, 0] for table in values))
    lines.append(
        f"first Hopf point of each rod: {_count_text(criticality[:, 0])}; F = {forces_text}, a = "
        f"{amplitude_text} L"
    )
    lines += _subcritical_lines(view)
    symbols = {"landau": "c", "growth_slope": "dw/dF", "amplitude_coefficient": "a", "frequency_slope": "b"}
    worst = [f"{symbol} {_maximum_text(v[f'{name}_error'][computed])}" for name, symbol in symbols.items()]
    reliability = [_searched_range_line(view, computed), f"worst relative errors: {', '.join(worst)}"]
    scope = "stored" if (v["crossing_count"][computed] > is_known.sum(axis=-1)).any() else "all"
    coefficients_text = f"a = {span_text(*values)} L, b = {span_text(*errors)} L^2/(k3 tau2)"
    return SummaryLines(
        lines, reliability, [f"{scope} Hopf points: {_count_text(criticality)}; {coefficients_text}"]
    )


def _hopf_lines(variables: Mapping[str, np.ndarray]) -> Iterator[str]:
    """Yields one line for each Hopf point of the only rod in a file."""
    for i in np.flatnonzero(variables["crossing_kind"] > 0):
        F_text = rounded_text(variables["crossing_F"][i], variables["crossing_error"][i])
        kind = CROSSING_KINDS[int(variables["crossing_kind"][i])]
        normal_form_text = "its normal form is not known"
        if np.isfinite(variables["landau_error"][i]):
            normal_form_text = (
                f"{CRITICALITY_WORDS[int(variables['criticality'][i])]}, "
                f"{_nearby_cycles_clause(variables, int(i))}"
            )
        unstable_count = int(variables["unstable_after"][i])
        modes_sentence = "the number of unstable modes beyond it is not known"
        if unstable_count >= 0:
            modes_sentence = f"the straight rod has {counted(unstable_count, 'unstable mode')} beyond it"
        yield f"{kind} at F = {F_text}: {normal_form_text}; {modes_sentence}"


def _hopf_table(variables: Mapping[str, np.ndarray]) -> TextTable | None:
    """Table with one column for each Hopf point of the only rod in a file; None if the rod has no Hopf
    point."""
    indices = np.flatnonzero(variables["crossing_kind"] > 0)
    kinds = (CROSSING_KINDS[int(variables["crossing_kind"][i])] for i in indices)
    rows = []
    for name, label in HOPF_SYMBOLS_AND_UNITS.items():
        numbers = zip(
            variables[name][indices].tolist(), absolute_errors(variables, name)[indices].tolist(), strict=True
        )
        rows.append((label, *(cell for number in numbers for cell in number_and_error(*number))))
    headings = ("", *(title for kind in kinds for title in (kind, "+-")))
    return TextTable(headings, tuple(rows)) if len(indices) else None


def _nearby_cycles_clause(variables: Mapping[str, np.ndarray], i: int) -> str:
    """Clause on the cycles near the i-th Hopf point of the only rod in a file: whether F is larger or
    smaller, and whether the cycles are stable."""
    sign = int(variables["criticality"][i])
    if sign == 0:
        return "the sign of Re c is within its error"
    side_text = "larger F" if variables["amplitude_coefficient"][i] > 0 else "smaller F"
    count = int(variables["unstable_after"][i])
    is_hopf = CROSSING_KINDS[int(variables["crossing_kind"][i])] == "hopf"
    other_count = count - 2 if is_hopf else count
    if sign > 0:
        return f"unstable cycles at {side_text}"
    if count < 0:
        return f"cycles at {side_text}"
    if other_count:
        return f"cycles at {side_text}, unstable by {other_count} other modes"
    return f"stable cycles at {side_text}"


def _subcritical_lines(view: ResultView) -> Iterator[str]:
    """Yields lines on rods with subcritical Hopf points; rods whose first Hopf point is subcritical come
    first."""
    criticality = view.by_point("criticality")
    rods = np.flatnonzero((criticality == 1).any(axis=-1))
    rods = rods[np.argsort(criticality[rods, 0] != 1, kind="stable")]
    columns = view.point_columns
    for rod in rods[:MAX_LISTED_ITEMS]:
        name = ", ".join(f"{key} = {column[rod]:.6g}" for key, column in columns.items())
        indices = np.flatnonzero(criticality[rod] == 1)
        names = ("crossing_F", "amplitude_coefficient", "amplitude_coefficient_error", "crossing_error")
        forces, amplitude_coefficient, relative, absolute = (
            view.by_point(name)[rod][indices] for name in names
        )
        texts = ", ".join(
            f"F = {rounded_text(F, F_error)} (Hopf point {i + 1}, a = "
            f"{rounded_text(coefficient, abs(coefficient) * relative_coefficient_error)} L)"
            for F, F_error, i, coefficient, relative_coefficient_error in zip(
                forces, absolute, indices, amplitude_coefficient, relative, strict=True
            )
        )
        yield f"subcritical Hopf points, with the amplitude coefficient a, for {name}: {texts}"
    if len(rods) > MAX_LISTED_ITEMS:
        yield f"and subcritical Hopf points for {counted(len(rods) - MAX_LISTED_ITEMS, 'rod')} more"


def _count_text(signs: np.ndarray) -> str:
    """Numbers of supercritical, subcritical and undecided Hopf points, as text. signs: signs of Re c, of any
    shape."""
    counts = {word: int((signs == value).sum()) for value, word in CRITICALITY_WORDS.items()}
    return ", ".join(f"{count} {word}" for word, count in counts.items() if count) or "none known"


def _searched_range_line(view: ResultView, computed: np.ndarray) -> str:
    """Line on the searched range of F, and on the completeness of the list of Hopf points."""
    variables = view.variables
    certified = int(variables["certified"][computed].sum())
    rods = int(computed.sum())
    unlisted = int(
        variables["crossing_count"][computed].clip(min=0).sum()
        - (variables["crossing_kind"][computed] > 0).sum()
    )
    ends = variables["F_end"][computed]
    search_clause = f"searched up to F = {span_text(ends)}; " if np.isfinite(ends).any() else ""
    return (
        f"{search_clause}the list of Hopf points {proof_clause(view)} for "
        f"{count_of_total(certified, rods, 'rod')}{unstored_crossings_clause(unlisted)}"
    )


def _maximum_text(values: np.ndarray) -> str:
    """Largest of the values that are not NaN, as text; "not known" if all values are NaN."""
    known_values = values[~np.isnan(values)]
    return f"{known_values.max():.1e}" if known_values.size else "not known"
