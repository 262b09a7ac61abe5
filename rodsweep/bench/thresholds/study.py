"""The thresholds benchmark: onset and Hopf point, with errors against 30 digits.

rodsweep finds all changes of a rod and proves the list complete. The races ONSET and HOPF run on a
`ThresholdCase` and give a `FirstThreshold`; peers find the first onset or the first Hopf point only.
"""

from collections.abc import Iterable, Sequence
from functools import partial
from math import isinf, isnan, log10, nan
from typing import Any

from ...solve.changes.thresholds import ThresholdsRequest, solve_thresholds, warm_up
from ..peers import Peers
from ..study import Contender, Measurement, Study, contest, grouped, middle, plural, table
from .cases import CASES, HOPF, ONSET, QUICK_CASES, FirstThreshold, ThresholdCase

TITLES = {ONSET: "onset", HOPF: "Hopf point"}
ROUNDS = 5
QUICK_ROUNDS = 1
MOST_DIGITS = 16
F_MAX = 200.0
RODSWEEP = "rodsweep"


def thresholds_study(quick: bool, peers: Peers) -> Study:
    """Runs the benchmark: a table for the onset, a table for the Hopf point, and the skipped peers."""
    warm_up()
    cases, rounds = (QUICK_CASES, QUICK_ROUNDS) if quick else (CASES, ROUNDS)
    found = {kind: timed_on(kind, cases, contenders(kind) + peers.of(kind), rounds) for kind in TITLES}
    tables = [threshold_table(kind, measurements) for kind, measurements in found.items()]
    blocks = [" ".join([introduction(rounds), *peers.notes]), *tables, *peers.skipped]
    return Study("thresholds", "\n\n".join(blocks), found[ONSET] + found[HOPF], "rod")


def contenders(kind: str) -> list[Contender]:
    """rodsweep with and without its proof."""
    return [
        Contender("rodsweep, all changes", "with proof", RODSWEEP, partial(own_threshold, kind, True)),
        Contender("rodsweep, all changes", "without proof", RODSWEEP, partial(own_threshold, kind, False)),
    ]


def own_threshold(kind: str, certify: bool, case: ThresholdCase) -> FirstThreshold:
    """All changes of the rod by rodsweep; returns the first change of a kind."""
    result = solve_thresholds(case.rod(0.0), ThresholdsRequest(F_MAX, 1e-10, certify, 64))
    at = next((change.at for change in result.crossings if change.kind.name == kind), nan)
    return FirstThreshold(at, result.transitions.solves, determinants=result.transitions.boxes)


def timed_on(
    kind: str, cases: Iterable[ThresholdCase], every: Sequence[Contender], rounds: int
) -> list[Measurement]:
    """Measurements of all contenders on each rod."""
    measurements = []
    for case in cases:
        name = f"{case.name}, {TITLES[kind]}"
        measurements += contest(name, case, every, rounds, partial(judged_threshold, case, kind))
    return measurements


def judged_threshold(case: ThresholdCase, kind: str, first: FirstThreshold) -> dict[str, Any]:
    """Error of a threshold. digits: correct digits per eigenproblem, 0 if the threshold was missed."""
    error = case.error_of(kind, first.force)
    missed = "missed" if isnan(first.force) else f"wrong ({first.force:.2f})"
    digits = -log10(min(max(error, 10**-MOST_DIGITS), 1.0))
    extra = {
        "eigenproblems": first.solves,
        "determinants": first.determinants,
        "products": first.products,
        "digits": nan if isnan(getattr(case, kind)) else digits / first.solves,
    }
    return {"error": error, "failure": missed if isinf(error) else "", "extra": extra}


def threshold_table(kind: str, measurements: Sequence[Measurement]) -> str:
    """Table with a line for each method and setting: medians over the rods, and the error on each rod."""
    rods = list(dict.fromkeys(m.case.split(",")[0] for m in measurements))
    rows = []
    for (method, setting), own in grouped(measurements, "method", "setting").items():
        solves, determinants, products, digits = (
            middle(m.extra.get(name, nan) for m in own)
            for name in ("eigenproblems", "determinants", "products", "digits")
        )
        work = "none" if isnan(solves) else f"{solves:.0f}"
        for count, what in ((determinants, "D"), (products, "M u")):
            work += "" if isnan(count) else f", {count:.0f} {what}"
        errors = [m.failure or ("none" if isnan(m.error) else f"{m.error:.0e}") for m in own]
        row = {"method": method, "setting": setting, "work": work, "digits": digits}
        rows.append(row | {"ms": middle(1e3 * m.seconds for m in own), "errors": " | ".join(errors)})
    return table(
        f"{TITLES[kind]} | setting | ms | eigenproblems | digits an eigenproblem | {' | '.join(rods)}",
        "{method} | {setting} | {ms:.1f} | {work} | {digits:.2g} | {errors}",
        rows,
    )


def introduction(rounds: int) -> str:
    """Description of the measurements for the report."""
    return (
        f"Relative error of the first onset and of the first Hopf point; medians over the rods and "
        f"{plural(rounds, 'round')}. rodsweep finds all changes in 0 < F < {F_MAX:g} (or below k1) at once. "
        "It evaluates D in addition to its eigenproblems, and locates each change to rounding, whatever "
        "accuracy is requested. Digits = -log10(error), 0 where the threshold was missed."
    )
