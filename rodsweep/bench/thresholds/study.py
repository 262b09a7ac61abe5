"""The thresholds benchmark: onset and Hopf point, beside sweeps with SciPy and continuation codes.

rodsweep finds all changes of a rod, and proves that there are no others; its peers find the first onset or
the first Hopf point only. The errors are against 30 digits.
"""

import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from math import inf, isfinite, isinf, isnan, log10
from pathlib import Path
from statistics import median

from ...solve.changes.thresholds import warm_up
from ..study import Measurement, Study, race
from .cases import CASES, ENOUGH, MESH_ACCURACY, QUICK_CASES, Case, Found, Problem, error_of
from .continuation_codes import auto_version
from .methods import AUTO, CONTINUATION, F_MAX, HOPF, ONSET, PYCONT, Method, methods
from .peers import MARCH

TITLES = {ONSET: "onset", HOPF: "Hopf point"}
ROUNDS, QUICK_ROUNDS = 5, 1
ROUNDING = 1.1e-16
"""Least error when digits are counted."""


@dataclass(frozen=True, slots=True)
class Result:
    """What a method found on a rod, in processor seconds; the relative error as in Measurement."""

    case: Case
    method: Method
    seconds: float
    found: Found
    error: float

    @property
    def digits(self) -> float:
        """Digits of the threshold an eigenproblem, 0 where it was missed; nan for who solves none."""
        return log10(max(1 / max(self.error, ROUNDING), 1.0)) / self.found.solves


def thresholds_study(quick: bool) -> Study:
    """Runs the benchmark: a table for the onset, one for the Hopf point, and what was skipped."""
    warm_up()
    cases, rounds = (QUICK_CASES, QUICK_ROUNDS) if quick else (CASES, ROUNDS)
    with tempfile.TemporaryDirectory() as directory:
        every, skipped = methods(Path(directory), quick)
        results = {kind: measure(kind, cases, every[kind], rounds) for kind in every}
    blocks = [introduction(rounds, every[HOPF])]
    blocks += [table(kind, cases, found) for kind, found in results.items()]
    measurements = [_measurement(kind, result) for kind, found in results.items() for result in found]
    return Study("thresholds", "\n\n".join(blocks + skipped), tuple(measurements), "rod")


def measure(kind: str, cases: Sequence[Case], every: Sequence[Method], rounds: int) -> list[Result]:
    """All methods on each rod in turn, round after round, but slow ones once."""
    results = []
    for case in cases:
        problem, exact = case.problem(), getattr(case, kind)
        quick = [method for method in every if not method.slow]
        raced = _raced([partial(method.run, problem) for method in quick], rounds)
        timed = dict(zip(quick, raced, strict=True))
        for method in every:
            seconds, found = timed[method] if method in timed else _once(method, problem)
            error = inf if found.failure else error_of(found.force, exact)
            results.append(Result(case, method, seconds, found, error))
    return results


def _raced(runs: Sequence[Callable[[], Found]], rounds: int) -> list[tuple[float, Found]]:
    """(median seconds, outcome) of each, with what other programs take, which a race does not count."""
    outside: list[list[float]] = [[] for _ in runs]

    def noted(run: Callable[[], Found], spent: list[float]) -> Found:
        found = run()
        spent.append(found.outside)
        return found

    seconds, found = race([partial(noted, *pair) for pair in zip(runs, outside, strict=True)], rounds)
    return [(s + median(o[1:]), f) for s, o, f in zip(seconds, outside, found, strict=True)]


def _once(method: Method, problem: Problem) -> tuple[float, Found]:
    """Time and outcome of the same run, which may be another the next time."""
    began = time.process_time()
    found = method.run(problem)
    return time.process_time() - began, found


def _measurement(kind: str, result: Result) -> Measurement:
    method, found = result.method, result.found
    extra = {"eigenproblems": found.solves, "determinants": found.determinants, "products": found.products}
    case = f"{result.case.name}, {TITLES[kind]}"
    return Measurement(case, method.name, method.setting, result.seconds, result.error, method.group, extra)


def introduction(rounds: int, every: Sequence[Method]) -> str:
    """What is measured, and with which versions."""
    names = {method.name for method in every}
    versions = [f"SciPy {version('scipy')}"]
    text = (
        "Relative error of the first onset and of the first Hopf point; processor time, medians over the "
        f"rods and {rounds} round{'s' * (rounds > 1)}. rodsweep finds all changes in 0 < F < {F_MAX:g} (or "
        "below k1) at once, for which it evaluates D besides its eigenproblems, and each to rounding, "
        "whatever accuracy is asked for. The others search for the first one in 0 < F < 60 (140 for the "
        "narrow window of flutter, 74.83 to 75.98), prove nothing, and are given a mesh that leaves an error "
        f"of {MESH_ACCURACY:.0e} there. Grids and steps: dense LAPACK (LU and geev) on rodsweep's pencil at "
        f"every force; steps are of {MARCH:g} in F until a sign changes. Accuracy for the solves spent: "
        "digits = -log10(error), the median over the rods, 0 where the threshold was missed."
    )
    if any(method.group == CONTINUATION for method in every):
        text += (
            " Continuation codes follow u = 0 of du/dt = M(F) u, the same pencil without the unknowns that "
            "carry no time derivative."
        )
    if AUTO in names:
        versions.append(f"{AUTO} {auto_version()}".strip())
        text += f" {AUTO} starts at F = 0; its times include the start of its program, not its compilation."
    if PYCONT in names:
        versions.append(f"{PYCONT} {version('pycont-lite')}")
        text += (
            f" {PYCONT} multiplies by M only. It is started where a pair leads already, and ended "
            f"{ENOUGH:g} beyond the Hopf point: from F = 0, through the onset, it is by chance right, off by "
            "percents or without a result. Its first vectors are random, so that its numbers vary."
        )
    return f"{text} {', '.join(versions)}."


def table(kind: str, cases: Sequence[Case], results: Sequence[Result]) -> str:
    """A line for each method and setting: medians over the rods, and the error on each."""
    lines = [
        f"| {TITLES[kind]} | setting | ms | eigenproblems | digits an eigenproblem | "
        + " | ".join(case.name for case in cases)
        + " |",
        "|---|---|---|---|---|" + "---|" * len(cases),
    ]
    for method in dict.fromkeys(result.method for result in results):
        own = [result for result in results if result.method == method]
        sought = [result.digits for result in own if not isnan(getattr(result.case, kind))]
        digits = f"{median(sought):.2g}" if sought and isfinite(sum(sought)) else ""
        ms = 1e3 * median(result.seconds for result in own)
        cells = " | ".join(_cell(result) for result in own)
        lines.append(f"| {method.name} | {method.setting} | {ms:.1f} | {_work(own)} | {digits} | {cells} |")
    return "\n".join(lines)


def _work(results: Sequence[Result]) -> str:
    """Medians of the eigenproblems, of the evaluations of D, or of the products with M."""
    columns = {
        name: [getattr(r.found, name) for r in results] for name in ("solves", "determinants", "products")
    }
    solves, determinants, products = (median(column) for column in columns.values())
    if isnan(solves):
        return f"none, {products:.0f} M u"
    return f"{solves:.0f}" + (f", {determinants:.0f} D" if isfinite(determinants) else "")


def _cell(result: Result) -> str:
    """The error, or in which way there is none."""
    if result.found.failure:
        return f"failed ({result.found.failure})"
    if isinf(result.error):
        return "missed" if isnan(result.found.force) else f"wrong ({result.found.force:.2f})"
    return "none" if isnan(result.error) else f"{result.error:.0e}"
