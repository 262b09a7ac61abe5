"""Hopf points in `rodsweep show`: criticality, coefficients of the normal form, and errors."""

from collections.abc import Iterator, Mapping

import numpy as np

from ...results.file.view import View
from ...results.layouts.thresholds import CROSSING_KINDS
from ...results.layouts.variables import ANGULAR_UNIT
from ...wording import count_of_total, counted
from .arm.arm import crossings_of_arm
from .errors import absolute_errors
from .number_texts import number_and_error, rounded_text, span_text
from .summary_lines import SummaryLines, TextTable, in_brackets, proof_clause, region_text
from .thresholds import ENDED_EARLY, unknown_beyond_clause, unknown_clause, unstored_clause

CRITICALITY_WORDS = {-1: "supercritical", 1: "subcritical", 0: "undecided"}
"""Word for the criticality of a Hopf point, by sign of Re c (c: cubic coefficient of the normal form)."""
MAX_LISTED_RODS = 8
"""At most this number of rods with subcritical Hopf points are listed one by one."""
HOPF_NUMBERS = {
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


def criticality_summary(view: View, done: np.ndarray) -> SummaryLines:
    """Summary of Hopf points. done: mask of the computed points, of the shape of the points."""
    v = view.variables
    if done.size == 1:
        none = "the Hopf points of this rod are not known"
        if v["crossing_count"].max() >= 0:
            none = f"no Hopf point up to F = {span_text(v['F_end'])}"
        of_rod = view.point_values(0)
        lines = list(_hopf_lines(of_rod)) or [none]
        lines[0] += unknown_beyond_clause(view, float(of_rod["F_end"]))
        reliability = [_searched_range_line(view, done)]
        numbers = _hopf_table(of_rod)
        return SummaryLines(lines, reliability, arm_sentences=crossings_of_arm(view), numbers=numbers)
    side = v["criticality"][done]
    known = np.isfinite(side)
    with_hopf = v["crossing_count"] > 0
    where = in_brackets(region_text(view, done & with_hopf)) if (done & with_hopf).any() else ""
    unknown = int(((v["crossing_count"] < 0) | (view.has_status(ENDED_EARLY) & ~with_hopf))[done].sum())
    lines = [
        f"Hopf points at {count_of_total(with_hopf[done].sum(), done.sum(), 'rod')}"
        f"{where}{unknown_clause(unknown)}"
    ]
    if not known.any():
        return SummaryLines(lines, [_searched_range_line(view, done)])
    names = ("amplitude_coefficient", "frequency_slope")
    a, b = ((v[name][done], absolute_errors(v, name)[done]) for name in names)
    F = span_text(v["crossing_F"][done][:, 0], v["crossing_error"][done][:, 0])
    size = span_text(*(table[:, 0] for table in a))
    lines.append(f"first Hopf point of each rod: {_count_text(side[:, 0])}; F = {F}, a = {size} L")
    lines += _subcritical_lines(view)
    reliability = [
        _searched_range_line(view, done),
        f"worst relative errors: c {_maximum(v['landau_error'][done])}, dw/dF "
        f"{_maximum(v['growth_slope_error'][done])}, a {_maximum(v['amplitude_coefficient_error'][done])}, b "
        f"{_maximum(v['frequency_slope_error'][done])}",
    ]
    which = "stored" if (v["crossing_count"][done] > known.sum(axis=-1)).any() else "all"
    sizes = f"a = {span_text(*a)} L, b = {span_text(*b)} L^2/(k3 tau2)"
    return SummaryLines(lines, reliability, [f"{which} Hopf points: {_count_text(side)}; {sizes}"])


def _hopf_lines(v: Mapping[str, np.ndarray]) -> Iterator[str]:
    """Yields one line for each Hopf point of the only rod in a file. v: variables of this rod."""
    for i in np.flatnonzero(v["crossing_kind"] > 0):
        F = rounded_text(v["crossing_F"][i], v["crossing_error"][i])
        kind = CROSSING_KINDS[int(v["crossing_kind"][i])]
        form = "its normal form is not known"
        if np.isfinite(v["landau_error"][i]):
            form = f"{CRITICALITY_WORDS[int(v['criticality'][i])]}, {_nearby_cycles_clause(v, int(i))}"
        after = int(v["unstable_after"][i])
        modes = "the number of unstable modes beyond it is not known"
        if after >= 0:
            modes = f"the straight rod has {counted(after, 'unstable mode')} beyond it"
        yield f"{kind} at F = {F}: {form}; {modes}"


def _hopf_table(v: Mapping[str, np.ndarray]) -> TextTable | None:
    """Table with one column for each Hopf point of the only rod in a file; None if the rod has no Hopf point.
    v: variables of this rod.
    """
    at = np.flatnonzero(v["crossing_kind"] > 0)
    kinds = (CROSSING_KINDS[int(v["crossing_kind"][i])] for i in at)
    rows = []
    for name, words in HOPF_NUMBERS.items():
        numbers = zip(v[name][at].tolist(), absolute_errors(v, name)[at].tolist(), strict=True)
        rows.append((words, *(cell for number in numbers for cell in number_and_error(*number))))
    headings = ("", *(head for kind in kinds for head in (kind, "+-")))
    return TextTable(headings, tuple(rows)) if len(at) else None


def _nearby_cycles_clause(v: Mapping[str, np.ndarray], i: int) -> str:
    """Clause on the cycles near the i-th Hopf point of the only rod in a file: whether F is larger or
    smaller, and whether the cycles are stable. v: variables of this rod.
    """
    side = int(v["criticality"][i])
    if side == 0:
        return "the sign of Re c is within its error"
    above = "larger F" if v["amplitude_coefficient"][i] > 0 else "smaller F"
    after = int(v["unstable_after"][i])
    hopf = CROSSING_KINDS[int(v["crossing_kind"][i])] == "hopf"
    others = after - 2 if hopf else after
    if side > 0:
        return f"unstable cycles at {above}"
    if after < 0:
        return f"cycles at {above}"
    return f"cycles at {above}, unstable by {others} other modes" if others else f"stable cycles at {above}"


def _subcritical_lines(view: View) -> Iterator[str]:
    """Yields lines on rods with subcritical Hopf points; rods whose first Hopf point is subcritical come
    first.
    """
    side = view.by_point("criticality")
    rods = np.flatnonzero((side == 1).any(axis=-1))
    rods = rods[np.argsort(side[rods, 0] != 1, kind="stable")]
    columns = view.point_columns
    for rod in rods[:MAX_LISTED_RODS]:
        name = ", ".join(f"{key} = {column[rod]:.6g}" for key, column in columns.items())
        places = np.flatnonzero(side[rod] == 1)
        names = ("crossing_F", "amplitude_coefficient", "amplitude_coefficient_error", "crossing_error")
        forces, a, relative, absolute = (view.by_point(name)[rod][places] for name in names)
        each = ", ".join(
            f"F = {rounded_text(F, dF)} (Hopf point {i + 1}, a = {rounded_text(x, abs(x) * dx)} L)"
            for F, dF, i, x, dx in zip(forces, absolute, places, a, relative, strict=True)
        )
        yield f"subcritical Hopf points for {name}: {each}"
    if len(rods) > MAX_LISTED_RODS:
        yield f"and subcritical Hopf points for {counted(len(rods) - MAX_LISTED_RODS, 'rod')} more"


def _count_text(side: np.ndarray) -> str:
    """Numbers of supercritical, subcritical and undecided Hopf points, as text. side: signs of Re c, of any
    shape.
    """
    counts = {word: int((side == value).sum()) for value, word in CRITICALITY_WORDS.items()}
    return ", ".join(f"{count} {word}" for word, count in counts.items() if count) or "none known"


def _searched_range_line(view: View, done: np.ndarray) -> str:
    """Line on the searched range of F, and on the completeness of the list of Hopf points. done: mask of the
    computed points.
    """
    v = view.variables
    certified = int(v["certified"][done].sum())
    rods = int(done.sum())
    hidden = int(v["crossing_count"][done].clip(min=0).sum() - (v["crossing_kind"][done] > 0).sum())
    ends = v["F_end"][done]
    searched = f"searched up to F = {span_text(ends)}; " if np.isfinite(ends).any() else ""
    return (
        f"{searched}the list of Hopf points {proof_clause(view)} for "
        f"{count_of_total(certified, rods, 'rod')}{unstored_clause(hidden)}"
    )


def _maximum(values: np.ndarray) -> str:
    """Largest of the values that are not NaN, as text; "not known" if all values are NaN."""
    known = values[~np.isnan(values)]
    return f"{known.max():.1e}" if known.size else "not known"
