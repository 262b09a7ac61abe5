"""The thresholds benchmark: first onset and first Hopf point, with errors relative to values of 30 digits.

rodsweep finds all thresholds of a rod and can prove the list complete; peers find only the first onset or the
first Hopf point. The compared methods are functions of a `ThresholdCase` that return a `FirstThreshold`; the
comparisons for the two thresholds are called ONSET and HOPF.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf, isinf, isnan, log10, nan
from typing import Any

from ...model.material.rod_material import DEFAULT_MATERIAL, RodMaterial
from ...model.rod import Rod
from ...solve.changes.thresholds import ThresholdsRequest, solve_thresholds, warm_up
from ...wording import counted
from ..peers import PeerContribution
from ..spectrum.arm_spectra import FIVE_SEGMENT_PROFILE
from ..study import (
    BenchmarkReport,
    Measurement,
    TimedMethod,
    grouped_by_fields,
    markdown_table,
    measure_case,
    nan_median,
)

ONSET, HOPF = "onset", "hopf"
"""Kinds of thresholds, which are also names of the two comparisons of methods, of fields of `ThresholdCase`,
and of kinds in rodsweep's results."""
MIN_ERROR_OF_OTHER_THRESHOLD = 0.3
"""A computed threshold with at least this relative error is a different threshold of the rod, and the exact
threshold was missed."""


@dataclass(frozen=True)
class ThresholdCase:
    """A rod, with its name in the tables, and its exact first thresholds. k1, k2, gamma3, taper,
    material: parameters, and constitutive law with profile, of the rod.

    onset, hopf: F of the first onset and of the first Hopf point, rounded from 30 digits; nan if the rod has
    no such threshold. search_end: F at which the searches of peers end.
    """

    name: str
    k1: float
    k2: float
    gamma3: float
    onset: float
    hopf: float
    search_end: float = 60.0
    taper: float = 1.0
    material: RodMaterial = DEFAULT_MATERIAL

    def rod(self, F: float) -> Rod:
        return Rod(F=F, k1=self.k1, k2=self.k2, gamma3=self.gamma3, taper=self.taper, material=self.material)

    def error_of(self, threshold_kind: str, computed: float) -> float:
        """Relative error of the computed threshold `computed` of the kind `threshold_kind`, ONSET or HOPF.

        nan if the rod has no threshold and no threshold was found; inf if the threshold was missed, or if a
        threshold was found that the rod does not have.
        """
        exact = getattr(self, threshold_kind)
        if isnan(exact):
            return nan if isnan(computed) else inf
        error = abs(computed - exact) / exact
        return error if error < MIN_ERROR_OF_OTHER_THRESHOLD else inf


@dataclass(frozen=True, slots=True)
class FirstThreshold:
    """Computed first threshold, and cost of its search; nan for numbers that were not counted.

    force: F of the threshold; nan if no threshold was found. eigenproblem_count: number of eigenproblems.
    determinant_count: number of evaluations of D. matrix_vector_product_count: number of matrix-vector
    products.
    """

    force: float
    eigenproblem_count: float = nan
    determinant_count: float = nan
    matrix_vector_product_count: float = nan


UNIFORM_CASES = (
    ThresholdCase("Fig. 2a", 1e4, 1e4, 1e-4, 20.0080206921030685, 37.6559805452710669),
    ThresholdCase("Fig. 2b", 1e4, 1e2, 1e-2, 14.7993326711955545, 27.4271941267592812),
    ThresholdCase("Fig. 2c", 2e2, 1e4, 1e-4, 22.4709774737663225, 49.7580049161915004),
    ThresholdCase("Fig. 2d", 1e2, 1e4, 1e-4, 27.4058263581942648, nan),
    ThresholdCase("filament", inf, inf, 0.0, 20.0509536189737612, 37.6954308403185779),
    ThresholdCase("narrow", 147.93, 1e4, 1e-4, 23.7456428120601644, 74.8251556528066767, 140.0),
    ThresholdCase("soft", 1e4, 3.0, 1e-2, 4.15946661669787928, 7.93638669176118928),
)
"""Uniform rods of the benchmark. "narrow" flutters only from F = 74.83 to 75.98, which is between two points
of a coarse grid. In "soft", further pairs soon become unstable, so that a search with a long step misses the
first pair."""
QUICK_CASES = tuple(case for case in UNIFORM_CASES if case.name in ("Fig. 2b", "Fig. 2d", "filament"))
"""Uniform rods in a quick run."""
FIVE_SEGMENTS = RodMaterial(profile=FIVE_SEGMENT_PROFILE)
ARM_CASES = (
    ThresholdCase("cone", 1e4, 1e2, 1e-2, 4.57243445318968512, 11.0801159252882371, taper=0.5),
    ThresholdCase(
        "five segments", 1e4, 1e4, 1e-4, 2.98373047605650440, 5.68247274040263724, material=FIVE_SEGMENTS
    ),
)
"""Arms that vary along their length."""
ARM_INTRODUCTION = (
    "The same tables for arms: a cone with half the radius at its tip, and five segments with radii of 1, "
    "0.6, 1.2, 0.5 and 0.8. rodsweep finds all thresholds in 0 < F < 60 to the requested accuracy of 1e-10."
)
"""Description of the tables of arms for the report."""
THRESHOLD_KIND_NAMES = {ONSET: "onset", HOPF: "Hopf point"}
"""Names of the kinds of thresholds in the tables."""
ROUND_COUNT = 5
"""Number of timed rounds."""
QUICK_ROUND_COUNT = 1
"""Number of timed rounds of a quick run."""
WORK_FIELD_BY_NAME = {
    "eigenproblems": "eigenproblem_count",
    "determinants": "determinant_count",
    "products": "matrix_vector_product_count",
}
"""Field of `FirstThreshold` with a number of operations, by the name of this number in a measurement."""
MAX_CORRECT_DIGITS = 16
"""Upper limit of the counted number of correct digits of a threshold."""
F_MAX = 200.0
"""Largest F of rodsweep's search on uniform rods."""
ARM_F_MAX = 60.0
"""Largest F of rodsweep's search on arms, several times F of their Hopf points."""
CERTIFY_BY_SETTING_NAME = {"with proof": True, "without proof": False}
"""Whether rodsweep proves its list of thresholds complete, by name of the setting."""
RODSWEEP_GROUP = "rodsweep"
"""Group of rodsweep in the figure."""


def run_thresholds_study(quick: bool, peers: PeerContribution) -> BenchmarkReport:
    """Runs the benchmark and returns the results: tables of the onset and of the Hopf point, for uniform rods
    and for arms. quick: whether to use fewer rods and rounds."""
    warm_up()
    cases, round_count = (QUICK_CASES, QUICK_ROUND_COUNT) if quick else (UNIFORM_CASES, ROUND_COUNT)
    blocks = [" ".join([introduction(round_count), *peers.contender_notes])]
    measurements = []
    for group in (cases, ARM_CASES):
        blocks += [ARM_INTRODUCTION] if group is ARM_CASES else []
        for kind in THRESHOLD_KIND_NAMES:
            rod_measurements = measure_rods(
                kind, group, contenders(kind) + peers.contenders_of_race(kind), round_count
            )
            blocks.append(threshold_table(kind, rod_measurements))
            measurements += rod_measurements
    return BenchmarkReport(
        "thresholds", "\n\n".join([*blocks, *peers.skipped_peer_sentences]), measurements, "rod"
    )


def contenders(threshold_kind: str) -> list[TimedMethod]:
    """rodsweep's methods in the comparison for the threshold `threshold_kind`, ONSET or HOPF: with and
    without its proof of completeness."""
    runs = {
        setting: partial(rodsweep_threshold, threshold_kind, proves)
        for setting, proves in CERTIFY_BY_SETTING_NAME.items()
    }
    return [TimedMethod("rodsweep, all changes", name, RODSWEEP_GROUP, run) for name, run in runs.items()]


def rodsweep_threshold(threshold_kind: str, certify: bool, case: ThresholdCase) -> FirstThreshold:
    """The first threshold of the kind `threshold_kind` by rodsweep, from the list of all thresholds of the
    rod. certify: whether rodsweep proves this list complete."""
    rod = case.rod(0.0)
    F_max = F_MAX if rod.is_uniform_and_linear else ARM_F_MAX
    result = solve_thresholds(rod, ThresholdsRequest(F_max, 1e-10, certify, 64))
    threshold = next(
        (change.value for change in result.thresholds if change.kind.name == threshold_kind), nan
    )
    if not rod.is_uniform_and_linear:
        return FirstThreshold(threshold)
    search = result.search_result
    return FirstThreshold(threshold, search.eigenvalue_solve_count, search.determinant_evaluation_count)


def measure_rods(
    threshold_kind: str, cases: Iterable[ThresholdCase], contenders: Sequence[TimedMethod], round_count: int
) -> list[Measurement]:
    """Measurements of the methods `contenders`, which find the threshold `threshold_kind`, ONSET or HOPF, on
    each of the rods `cases`. round_count: number of timed runs of each method on a rod; a slow method runs
    only once."""
    measurements = []
    for case in cases:
        name = f"{case.name}, {THRESHOLD_KIND_NAMES[threshold_kind]}"
        measurements += measure_case(
            name, case, contenders, round_count, partial(threshold_measurement_fields, case, threshold_kind)
        )
    return measurements


def threshold_measurement_fields(
    case: ThresholdCase, threshold_kind: str, computed_threshold: FirstThreshold
) -> dict[str, Any]:
    """Fields of `Measurement` for the computed threshold `computed_threshold` of the kind `threshold_kind`:
    error, failure, cost, and correct decimal digits per eigenproblem (0 if the threshold was missed)."""
    error = case.error_of(threshold_kind, computed_threshold.force)
    outcome = "missed" if isnan(computed_threshold.force) else f"wrong ({computed_threshold.force:.2f})"
    digits = -log10(min(max(error, 10**-MAX_CORRECT_DIGITS), 1.0))
    values = {name: getattr(computed_threshold, field) for name, field in WORK_FIELD_BY_NAME.items()}
    values["digits"] = (
        nan if isnan(getattr(case, threshold_kind)) else digits / computed_threshold.eigenproblem_count
    )
    return {"error": error, "failure": outcome if isinf(error) else "", "extra_columns": values}


def threshold_table(kind: str, measurements: Sequence[Measurement]) -> str:
    """Table of one kind of threshold, with one line for each method and setting: medians over the rods, and
    errors on each rod."""
    rods = list(dict.fromkeys(m.case.split(",")[0] for m in measurements))
    rows = []
    for (method, setting), measured in grouped_by_fields(measurements, "method", "setting").items():
        names = (*WORK_FIELD_BY_NAME, "digits")
        medians = (nan_median(m.extra_columns.get(name, nan) for m in measured) for name in names)
        solve_counts, determinants, products, digits = medians
        work = "" if isnan(solve_counts) else f"{solve_counts:.0f}"
        for count, unit_text in ((determinants, "D"), (products, "M u")):
            work += "" if isnan(count) else f"{', ' * bool(work)}{count:.0f} {unit_text}"
        errors = [m.failure or ("none" if isnan(m.error) else f"{m.error:.0e}") for m in measured]
        row = {"method": method, "setting": setting, "work": work, "digits": digits}
        rows.append(row | {"ms": nan_median(1e3 * m.seconds for m in measured), "errors": " | ".join(errors)})
    return markdown_table(
        f"{THRESHOLD_KIND_NAMES[kind]} | setting | ms | eigenproblems | digits an eigenproblem | "
        + " | ".join(rods),
        "{method} | {setting} | {ms:.1f} | {work} | {digits:.2g} | {errors}",
        rows,
    )


def introduction(round_count: int) -> str:
    """Description of the tables of uniform rods for the report."""
    return (
        f"Relative error of the first onset and of the first Hopf point; medians over the rods and "
        f"{counted(round_count, 'round')}. rodsweep finds all thresholds in 0 < F < {F_MAX:g} (or below k1) "
        "in one search. In addition to eigenproblems it evaluates the determinant D; each change is located "
        "to rounding error, whatever accuracy is requested. Digits = -log10(error), 0 where the threshold "
        "was missed."
    )
