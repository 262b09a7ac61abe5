"""The thresholds benchmark: onset and Hopf point, beside sweeps with SciPy and continuation codes.

rodsweep finds all changes of a rod, and proves that there are no others; its peers find the first onset or
the first Hopf point only. The errors are against 30 digits.
"""

import tempfile
from collections.abc import Iterable, Sequence
from functools import partial
from math import isinf, isnan, log10, nan
from pathlib import Path
from typing import Any

from ...solve.changes.thresholds import ThresholdsRequest, solve_thresholds, warm_up
from ..auto import AUTO
from ..study import Contender, Measurement, Study, contest, grouped, middle, plural, table
from .cases import CASES, HOPF, MESH_ACCURACY, ONSET, QUICK_CASES, FirstThreshold, ThresholdCase
from .continuation import BEYOND_HOPF, PYCONT, continuation_codes
from .spectra_by_force import BY_GRID, BY_STEPS, MARCH, on_grid

TITLES = {ONSET: "onset", HOPF: "Hopf point"}
ROUNDS, QUICK_ROUNDS = 5, 1
MOST_DIGITS = 16
F_MAX = 200.0
GRIDS, LARGE_GRID = (50, 200), 800
TOLERANCES = (1e-3, 1e-6, 1e-12)
RODSWEEP, SWEEP = "rodsweep", "grid and interpolation"


def thresholds_study(quick: bool) -> Study:
    """Runs the benchmark: a table for the onset, one for the Hopf point, and what was skipped."""
    warm_up()
    cases, rounds = (QUICK_CASES, QUICK_ROUNDS) if quick else (CASES, ROUNDS)
    with tempfile.TemporaryDirectory() as directory:
        codes, skipped = continuation_codes(Path(directory), quick)
        onsets = timed_on(ONSET, cases, contenders(ONSET, quick), rounds)
        hopf_points = timed_on(HOPF, cases, contenders(HOPF, quick) + codes, rounds)
    blocks = [introduction(rounds, [code.method for code in codes])]
    blocks += [threshold_table(ONSET, onsets), threshold_table(HOPF, hopf_points), *skipped]
    return Study("thresholds", "\n\n".join(blocks), onsets + hopf_points, "rod")


def contenders(kind: str, quick: bool) -> list[Contender]:
    """rodsweep and those that need SciPy only."""
    grids = GRIDS if quick else (*GRIDS, LARGE_GRID)
    return [
        Contender("rodsweep, all changes", "with proof", RODSWEEP, partial(own_threshold, kind, True)),
        Contender("rodsweep, all changes", "without proof", RODSWEEP, partial(own_threshold, kind, False)),
        *(
            Contender(name, f"{n} forces", SWEEP, partial(on_grid, estimate, n), n == LARGE_GRID)
            for name, estimate in BY_GRID[kind].items()
            for n in grids
        ),
        *(
            Contender(name, f"tolerance {tolerance:.0e}", SWEEP, partial(search, tolerance))
            for name, search in BY_STEPS[kind].items()
            for tolerance in TOLERANCES
        ),
    ]


def own_threshold(kind: str, certify: bool, case: ThresholdCase) -> FirstThreshold:
    """All changes of the rod, and of them the first of a kind."""
    result = solve_thresholds(case.k1, case.k2, case.gamma3, ThresholdsRequest(F_MAX, 1e-10, certify, 64))
    at = next((change.at for change in result.crossings if change.kind.name == kind), nan)
    return FirstThreshold(at, result.transitions.solves, determinants=result.transitions.boxes)


def timed_on(
    kind: str, cases: Iterable[ThresholdCase], every: Sequence[Contender], rounds: int
) -> list[Measurement]:
    """All contenders on each rod."""
    measurements = []
    for case in cases:
        name = f"{case.name}, {TITLES[kind]}"
        measurements += contest(name, case, every, rounds, partial(judged_threshold, case, kind))
    return measurements


def judged_threshold(case: ThresholdCase, kind: str, first: FirstThreshold) -> dict[str, Any]:
    """What is wrong with a threshold. digits: of it, an eigenproblem, 0 where it was missed."""
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
    """A line for each method and setting: medians over the rods, and the error on each."""
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


def introduction(rounds: int, codes: Iterable[str]) -> str:
    """What is measured."""
    text = (
        f"Relative error of the first onset and of the first Hopf point; medians over the rods and "
        f"{plural(rounds, 'round')}. rodsweep finds all changes in 0 < F < {F_MAX:g} (or below k1) at once, "
        "for which it evaluates D besides its eigenproblems, and each to rounding, whatever accuracy is "
        "asked for. The others search for the first one in 0 < F < 60 (140 for the narrow window of flutter, "
        "74.83 to 75.98), prove nothing, and are given a mesh that leaves an error of "
        f"{MESH_ACCURACY:.0e} there. Grids and steps: dense LAPACK (LU and geev) on rodsweep's pencil at "
        f"every force; steps are of {MARCH:g} in F until a sign changes. Digits = -log10(error), 0 where the "
        "threshold was missed. Continuation codes follow u = 0 of du/dt = M(F) u, the same pencil without "
        "the unknowns that carry no time derivative."
    )
    return " ".join([text, *(CODES[name] for name in dict.fromkeys(codes))])


CODES = {
    AUTO: f"{AUTO} starts at F = 0; its times include the start of its program, not its compilation.",
    PYCONT: (
        f"{PYCONT} multiplies by M only. It is started where a pair leads already, and ended {BEYOND_HOPF:g} "
        "beyond the Hopf point: from F = 0, through the onset, it is by chance right, off by percents or "
        "without a result. Its first vectors are random, so that its numbers vary."
    ),
}
