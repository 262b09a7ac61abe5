"""The spectrum benchmark: time and error of the leading eigenvalues of the paper's rods and of hard rods.

The contenders of the race SPECTRUM_RACE_NAME are functions of a `Rod` that return at least the MODE_COUNT
leading eigenvalues, (modes,).
"""

from collections.abc import Sequence
from functools import partial
from math import ceil, isinf, nan
from typing import Any

import numpy as np

from ...arrays import Complex
from ...discretization.elements.resolution import RESOLUTION_SETTINGS, Resolution
from ...model.rod import Rod
from ...solve.spectrum.krylov_schur import uniform_solver
from ...solve.spectrum.problem import transverse_problem
from ...solve.spectrum.search import warm_up
from ...wording import counted
from ..peers import PeerContribution
from ..study import (
    BenchmarkReport,
    Measurement,
    TimedMethod,
    every_nth_setting,
    markdown_table,
    measure_case,
    nan_median,
    result_or_error,
    time_runs,
)
from .arm_spectra import ARM_SPECTRUM_RACE_NAME, arm_table, measure_arm_spectra
from .rodsweep_and_exact_spectra import (
    CERTIFIED_NAME,
    KRYLOV_SCHUR_NAME,
    MODE_COUNT,
    PENCIL_GROUP,
    RODSWEEP_GROUP,
    UNCERTIFIED_NAME,
    error_as_measurement_field,
    exact_spectrum,
    leading_eigenvalues,
    relative_error,
    rodsweep_spectrum,
    table_by_case,
)

ELEMENT_ORDERS = (8, 10, 12, 14, 16, 18, 20, 24, 28, 32, 40, 56, 80)
"""Orders of the elements of rodsweep's pencil on which eigensolvers are run."""
SPECTRUM_RACE_NAME = "spectrum"
"""Name of the race of spectra of rods."""
PAPER_RODS = {
    "Fig. 2a": (1e4, 1e4, 1e-4, 60.0),
    "Fig. 2b": (1e4, 1e2, 1e-2, 45.0),
    "Fig. 2c": (2e2, 1e4, 1e-4, 180.0),
    "Fig. 2d": (1e2, 1e4, 1e-4, 85.0),
}
"""(k1, k2, gamma3, largest force) of the rods of the paper's figures."""
FORCE_COUNT = 5
"""Number of forces for each of the paper's rods."""
HARD_RODS = {
    "easy: F = 30, k1 = k2 = 1e4, gamma3 = 1e-4": Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4),
    "stiff: F = 30, k1 = k2 = 1e8, gamma3 = 1e-8": Rod(F=30.0, k1=1e8, k2=1e8, gamma3=1e-8),
    "nearly crushed: F = 0.999 k1, k1 = 200": Rod(F=199.8, k1=200.0, k2=1e4, gamma3=1e-4),
    "12 unstable modes: F = 2000, k1 = 1e4": Rod(F=2000.0, k1=1e4, k2=1e4, gamma3=1e-4),
}
"""Rods on which methods lose accuracy or speed, and an easy rod for comparison, by name in the table."""
TARGET_ERRORS = (1e-12, 1e-10, 1e-6)
"""Relative errors at which the methods are compared, smallest first."""
ROUND_COUNT = 25
"""Number of timed rounds."""
QUICK_ROUND_COUNT = 2
"""Number of timed rounds of a quick run."""
QUICK_STRIDE = 3
"""Number n: a quick run uses only every n-th size on hard rods and arms."""


def run_spectrum_study(quick: bool, peers: PeerContribution) -> BenchmarkReport:
    """Runs the benchmark and returns the results: the paper's rods at equal errors, hard rods at all sizes,
    and arms. quick: whether to use fewer rounds, target errors and sizes."""
    warm_up()
    round_count, stride = (QUICK_ROUND_COUNT, QUICK_STRIDE) if quick else (ROUND_COUNT, 1)
    rods = [
        Rod(F=float(F), k1=k1, k2=k2, gamma3=gamma3)
        for k1, k2, gamma3, max_F in PAPER_RODS.values()
        for F in np.linspace(0.1 * max_F, max_F, FORCE_COUNT)
    ]
    exact = [exact_spectrum(rod, MODE_COUNT) for rod in rods]
    methods = contenders() + peers.contenders_of_race(SPECTRUM_RACE_NAME)
    targets = TARGET_ERRORS[: 1 if quick else None]
    blocks = [time_at_equal_error(methods, rods, exact, target, round_count) for target in targets]
    measurements = measure_hard_rods(every_nth_setting(methods, stride), round_count)
    arms = measure_arm_spectra(
        every_nth_setting(peers.contenders_of_race(ARM_SPECTRUM_RACE_NAME), stride), round_count
    )
    blocks += [
        *peers.contender_notes,
        hard_rod_table(measurements),
        arm_table(arms, round_count),
        *peers.skipped_peer_sentences,
    ]
    return BenchmarkReport("spectrum", "\n\n".join(blocks), measurements, "point", TARGET_ERRORS[0], arms)


def coarsest_contenders_at_error(
    methods: Sequence[TimedMethod], rod: Rod, exact: list[Any], target: float
) -> dict[str, TimedMethod]:
    """Contender with the smallest size that reaches the error `target` on a rod, by name of the method;
    methods that do not reach this error are left out.

    methods: contenders of all methods, by ascending size.
    """
    cheapest: dict[str, TimedMethod] = {}
    for contender in methods:
        if contender.method not in cheapest:
            error = relative_error(result_or_error(contender.run, rod), exact)
            cheapest |= {contender.method: contender} if error <= target else {}
    return cheapest


def time_at_equal_error(
    methods: Sequence[TimedMethod],
    rods: Sequence[Rod],
    exact: Sequence[list[Any]],
    target: float,
    round_count: int,
) -> str:
    """Times all methods on all rods, in `round_count` rounds, each at the smallest size that reaches the
    error `target`, and returns the table of the methods."""
    pairs = zip(rods, exact, strict=True)
    cheapest = [coarsest_contenders_at_error(methods, rod, roots, target) for rod, roots in pairs]
    names = list(dict.fromkeys(contender.method for contender in methods))
    runs = {
        (name, i): partial(result_or_error, cheapest[i][name].run, rod)
        for name in names
        for i, rod in enumerate(rods)
        if name in cheapest[i]
    }
    timed = dict(zip(runs, time_runs(list(runs.values()), [round_count] * len(runs)), strict=True))
    rows = []
    for name in names:
        indices = [i for i in range(len(rods)) if name in cheapest[i]]
        seconds = [timed[name, i].median_seconds for i in indices]
        own_seconds = [timed[UNCERTIFIED_NAME, i].median_seconds for i in indices]
        row = {
            "method": name,
            "points": len(indices),
            "ms": 1e3 * nan_median(seconds),
            "worst": max((relative_error(timed[name, i].outcome, exact[i]) for i in indices), default=nan),
            "ratio": nan_median(time / own for time, own in zip(seconds, own_seconds, strict=True)),
        }
        rows.append(row)
    return (
        f"Leading {MODE_COUNT} eigenvalues to {target:.0e}: each method at the cheapest size that reaches "
        f"this error; median over {len(rods)} points of the paper's four rods, "
        f"{counted(round_count, 'round')}:\n\n"
    ) + markdown_table(
        "method | points reached | ms a point | worst error | times this tool's time",
        "{method} | {points:.0f} | {ms:.3f} | {worst:.0e} | {ratio:.1f}",
        rows,
    )


def measure_hard_rods(methods: Sequence[TimedMethod], round_count: int) -> list[Measurement]:
    """Measurements of the contenders `methods` on all HARD_RODS."""
    measurements = []
    for case, rod in HARD_RODS.items():
        measure_error = partial(error_as_measurement_field, exact_spectrum(rod, MODE_COUNT))
        measurements += measure_case(case, rod, methods, round_count, measure_error)
    return measurements


def hard_rod_table(measurements: Sequence[Measurement]) -> str:
    """Table of hard rods, after a sentence that explains it: the smallest error of every method, and the time
    of the method for at most ten times this error."""
    return (
        f"Leading {MODE_COUNT} eigenvalues of hard rods: the smallest relative error that a method reaches "
        "at any size, and the ms of the cheapest size with at most ten times this error (the figure shows "
        "all sizes):\n\n"
    ) + table_by_case(HARD_RODS, measurements, hard_rod_cell)


def hard_rod_cell(measurements: Sequence[Measurement]) -> str:
    """Cell of `hard_rod_table` for one method on one rod: the smallest error at any size, and the shortest
    time of a size with at most ten times this error; "failed" if all sizes failed."""
    min_error = min(m.error for m in measurements)
    fastest = min((m for m in measurements if m.error <= 10 * min_error), key=lambda m: m.seconds)
    return "failed" if isinf(min_error) else f"{min_error:.0e}, {1e3 * fastest.seconds:.2f} ms"


def mesh_of_total_order(order: int) -> Resolution:
    """Mesh of one element of the order `order` or, if this exceeds the maximum order of an element, of
    several equal elements with at least this total order."""
    elements = ceil(order / RESOLUTION_SETTINGS.max_order)
    return Resolution(elements, ceil(order / elements))


def krylov_schur(rod: Rod, order: int) -> Complex:
    """Leading eigenvalues, (n,) with n at most MODE_COUNT + 1, of a rod by SLEPc's Krylov-Schur, without
    Newton's method for D. order: total order of the elements."""
    solver = uniform_solver(mesh_of_total_order(order))
    eigenvalues = solver.solve(rod, transverse_problem(rod).shift, MODE_COUNT, to_rounding=True)
    return leading_eigenvalues(eigenvalues, MODE_COUNT + 1)


def contenders() -> list[TimedMethod]:
    """Contenders of SPECTRUM_RACE_NAME: rodsweep without and with certificate, and Krylov-Schur at all
    orders."""
    krylov = {str(size): partial(krylov_schur, order=size) for size in ELEMENT_ORDERS}
    return [
        TimedMethod(UNCERTIFIED_NAME, "", RODSWEEP_GROUP, partial(rodsweep_spectrum, certify=False)),
        TimedMethod(CERTIFIED_NAME, "", RODSWEEP_GROUP, partial(rodsweep_spectrum, certify=True)),
        *(TimedMethod(KRYLOV_SCHUR_NAME, size, PENCIL_GROUP, run) for size, run in krylov.items()),
    ]
