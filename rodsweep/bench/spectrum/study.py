"""The spectrum benchmark: time and error of a point, on the paper's rods and on hard rods.

The race RACE runs on a `Rod` and gives the leading eigenvalues, at least WANTED_MODES, shape (modes,).
"""

from collections.abc import Sequence
from functools import partial
from math import ceil, isinf, nan
from typing import Any

import numpy as np

from ...arrays import Complex
from ...discretization.elements.resolution import RESOLUTION, Resolution
from ...model.rod import Rod
from ...solve.spectrum.krylov_schur import uniform_solver
from ...solve.spectrum.problem import transverse_problem
from ...solve.spectrum.search import warm_up
from ..peers import Peers
from ..study import (
    Contender,
    Measurement,
    Study,
    contest,
    every_nth_setting,
    failsafe,
    grouped,
    middle,
    plural,
    race,
    table,
)
from .arms import ARM_RACE, arm_spectra, arm_table
from .exact import exact_spectrum, relative_error
from .own import KRYLOV_SCHUR, PENCIL, PLAIN, PROVED, THIS_TOOL, WANTED_MODES, leading, own_spectrum

ORDERS = (8, 10, 12, 14, 16, 18, 20, 24, 28, 32, 40, 56, 80)
"""Sizes of the pencil."""
RACE = "spectrum"
PAPER_RODS = {
    "Fig. 2a": (1e4, 1e4, 1e-4, 60.0),
    "Fig. 2b": (1e4, 1e2, 1e-2, 45.0),
    "Fig. 2c": (2e2, 1e4, 1e-4, 180.0),
    "Fig. 2d": (1e2, 1e4, 1e-4, 85.0),
}
"""k1, k2, gamma3 and the largest force."""
FORCE_COUNT = 5
HARD_RODS = {
    "easy: F = 30, k1 = k2 = 1e4, gamma3 = 1e-4": Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4),
    "stiff: F = 30, k1 = k2 = 1e8, gamma3 = 1e-8": Rod(F=30.0, k1=1e8, k2=1e8, gamma3=1e-8),
    "nearly crushed: F = 0.999 k1, k1 = 200": Rod(F=199.8, k1=200.0, k2=1e4, gamma3=1e-4),
    "12 unstable modes: F = 2000, k1 = 1e4": Rod(F=2000.0, k1=1e4, k2=1e4, gamma3=1e-4),
}
TARGETS = (1e-12, 1e-10, 1e-6)
"""Errors at which the methods are compared, smallest first."""
ROUNDS = 25
QUICK_ROUNDS = 2
QUICK_STRIDE = 3
"""Stride of the sizes on the hard rods in a quick run."""


def spectrum_study(quick: bool, peers: Peers) -> Study:
    """Runs the benchmark: the paper's rods at equal errors, then every method at every size on hard rods."""
    warm_up()
    rounds, stride = (QUICK_ROUNDS, QUICK_STRIDE) if quick else (ROUNDS, 1)
    rods = [
        Rod(F=float(F), k1=k1, k2=k2, gamma3=gamma3)
        for k1, k2, gamma3, top in PAPER_RODS.values()
        for F in np.linspace(0.1 * top, top, FORCE_COUNT)
    ]
    exact = [exact_spectrum(rod, WANTED_MODES) for rod in rods]
    every = contenders() + peers.of(RACE)
    targets = TARGETS[: 1 if quick else None]
    blocks = [equal_errors(every, rods, exact, target, rounds) for target in targets]
    measurements = every_size(every_nth_setting(every, stride), rounds)
    arms = arm_spectra(every_nth_setting(peers.of(ARM_RACE), stride), rounds)
    blocks += [*peers.notes, hard_table(measurements), arm_table(arms, rounds), *peers.skipped]
    return Study("spectrum", "\n\n".join(blocks), measurements, "point", TARGETS[0], undrawn=arms)


def cheapest(every: Sequence[Contender], rod: Rod, exact: list[Any], target: float) -> dict[str, Contender]:
    """The contender with the smallest sufficient size, for every method that reaches the target."""
    found: dict[str, Contender] = {}
    for contender in every:
        if contender.method not in found:
            error = relative_error(failsafe(contender.run, rod), exact)
            found |= {contender.method: contender} if error <= target else {}
    return found


def equal_errors(
    every: Sequence[Contender], rods: Sequence[Rod], exact: Sequence[list[Any]], target: float, rounds: int
) -> str:
    """Table of all methods at the cheapest size that reaches the target, point by point."""
    fit = [cheapest(every, rod, roots, target) for rod, roots in zip(rods, exact, strict=True)]
    names = list(dict.fromkeys(contender.method for contender in every))
    runs = {
        (name, i): partial(failsafe, fit[i][name].run, rod)
        for name in names
        for i, rod in enumerate(rods)
        if name in fit[i]
    }
    timed = dict(zip(runs, race(list(runs.values()), [rounds] * len(runs)), strict=True))
    rows = []
    for name in names:
        reached = [i for i in range(len(rods)) if name in fit[i]]
        row = {
            "method": name,
            "points": len(reached),
            "ms": 1e3 * middle(timed[name, i].median for i in reached),
            "worst": max((relative_error(timed[name, i].outcome, exact[i]) for i in reached), default=nan),
            "ratio": middle(timed[name, i].median / timed[PLAIN, i].median for i in reached),
        }
        rows.append(row)
    return (
        f"Leading {WANTED_MODES} eigenvalues to {target:.0e}: each method at the cheapest size that reaches "
        f"this error; median over {len(rods)} points of the paper's four rods, "
        f"{plural(rounds, 'round')}:\n\n"
    ) + table(
        "method | points reached | ms a point | worst error | times this tool's time",
        "{method} | {points:.0f} | {ms:.3f} | {worst:.0e} | {ratio:.1f}",
        rows,
    )


def every_size(every: Sequence[Contender], rounds: int) -> list[Measurement]:
    """Measurements of all methods at all sizes on the hard rods."""
    measurements = []
    for case, rod in HARD_RODS.items():
        judge = partial(judged_spectrum, exact_spectrum(rod, WANTED_MODES))
        measurements += contest(case, rod, every, rounds, judge)
    return measurements


def judged_spectrum(exact: list[Any], w: Complex) -> dict[str, float]:
    """Error of eigenvalues, shape (modes,)."""
    return {"error": relative_error(w, exact)}


def hard_table(measurements: Sequence[Measurement]) -> str:
    """Table: for every method on every hard rod the smallest error, and the time for ten times this error."""
    rows = [
        {"method": method, "cells": " | ".join(best(own) for own in grouped(every, "case").values())}
        for (method,), every in grouped(measurements, "method").items()
    ]
    return (
        f"Leading {WANTED_MODES} eigenvalues of hard rods: the smallest relative error that a method reaches "
        "at any size, and the ms of the cheapest size with at most ten times this error (the figure shows "
        "all sizes):\n\n"
    ) + table(" | ".join(["method", *HARD_RODS]), "{method} | {cells}", rows)


def best(measurements: Sequence[Measurement]) -> str:
    """Table cell of one method on one rod: smallest error and time."""
    least = min(m.error for m in measurements)
    near = min((m for m in measurements if m.error <= 10 * least), key=lambda m: m.seconds)
    return "failed" if isinf(least) else f"{least:.0e}, {1e3 * near.seconds:.2f} ms"


def mesh_of(order: int) -> Resolution:
    """One element of the given order, or several equal elements of at most RESOLUTION.max_order."""
    elements = ceil(order / RESOLUTION.max_order)
    return Resolution(elements, ceil(order / elements))


def krylov_schur(rod: Rod, size: int) -> Complex:
    """SLEPc's Krylov-Schur, converged to rounding, without refinement on D, shape (modes,)."""
    w = uniform_solver(mesh_of(size)).solve(rod, transverse_problem(rod).shift, WANTED_MODES, tight=True)
    return leading(w, WANTED_MODES + 1)


def contenders() -> list[Contender]:
    """rodsweep with and without certificate, and Krylov-Schur at all sizes."""
    return [
        Contender(PLAIN, "", THIS_TOOL, partial(own_spectrum, certify=False)),
        Contender(PROVED, "", THIS_TOOL, partial(own_spectrum, certify=True)),
        *(Contender(KRYLOV_SCHUR, str(size), PENCIL, partial(krylov_schur, size=size)) for size in ORDERS),
    ]
