"""The thresholds benchmark: all changes of a rod with their proof, beside spectra on a grid of forces.

The practice that it replaces is a sweep over F with the threshold read off by interpolation: the onset
where the imaginary part of the leading eigenvalue becomes visible, the Hopf point where the linear
interpolant of its real part vanishes.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from math import inf, nan

import numpy as np

from ..model.rod import Rod
from ..solve.spectrum import SpectrumRequest, solve_spectrum
from ..solve.thresholds import ThresholdsRequest, solve_thresholds, warm_up

F_MAX = 200.0
RODS = {
    "Fig. 2a": (1e4, 1e4, 1e-4, 20.0080206921030685, 37.6559805452710669),
    "Fig. 2b": (1e4, 1e2, 1e-2, 14.7993326711955545, 27.4271941267592812),
    "Fig. 2c": (2e2, 1e4, 1e-4, 22.4709774737663225, 49.7580049161915004),
    "Fig. 2d": (1e2, 1e4, 1e-4, 27.4058263581942648, nan),
    "filament": (inf, inf, 0.0, 20.0509536189737612, 37.6954308403185779),
}
"""k1, k2, gamma3, then onset and Hopf point, from 30 digits (tests/reference/thresholds.json)."""
GRIDS = (50, 200, 800)
"""Points of the sweeps from 0 to 60 whose thresholds are interpolated."""
GRID_TOP = 60.0
ROUNDS, QUICK_ROUNDS = 15, 3

Found = tuple[float, float, int]
"""(onset, Hopf point, eigenproblems)."""


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table: one method on one rod."""

    method: str
    rod: str
    milliseconds: float
    solves: float
    error: float


def thresholds_table(quick: bool) -> str:
    """Runs the benchmark; returns Markdown with the medians."""
    warm_up()
    rounds = QUICK_ROUNDS if quick else ROUNDS
    rows = [row for rod in RODS for row in _measure(rod, rounds)]
    lines = [
        f"All stability changes of a rod in 0 < F < {F_MAX:g} (or below k1), median of {rounds} rounds; the "
        f"interpolated sweeps cover 0 to {GRID_TOP:g} only and prove nothing:",
        "",
        "| rod | method | ms | eigenproblems | worst relative error of onset and Hopf point |",
        "|---|---|---|---|---|",
    ]
    lines += [
        f"| {r.rod} | {r.method} | {r.milliseconds:.1f} | {r.solves:.0f} | {r.error:.0e} |" for r in rows
    ]
    return "\n".join(lines)


def _measure(name: str, rounds: int) -> list[Row]:
    """All methods on one rod in turn, round after round."""
    k1, k2, gamma3, *exact = RODS[name]
    methods: dict[str, Callable[[], Found]] = {
        "rodsweep, with proof": partial(_own, k1, k2, gamma3, certify=True),
        "rodsweep, without proof": partial(_own, k1, k2, gamma3, certify=False),
    }
    for points in GRIDS:
        methods[f"spectra at {points} forces, interpolated"] = partial(interpolated, k1, k2, gamma3, points)
    times: dict[str, list[float]] = {method: [] for method in methods}
    found: dict[str, Found] = {}
    for _ in range(rounds):
        for method, run in methods.items():
            began = time.perf_counter()
            found[method] = run()
            times[method].append(time.perf_counter() - began)
    return [
        Row(method, name, 1e3 * float(np.median(times[method])), at[2], _error(at, exact))
        for method, at in found.items()
    ]


def _error(found: Found, exact: list[float]) -> float:
    """The larger relative error of the onset and the Hopf point; inf where one is missed or invented."""
    errors = []
    for got, right in zip(found, exact, strict=False):
        if np.isnan(got) != np.isnan(right):
            return inf
        if not np.isnan(right):
            errors.append(abs(got - right) / right)
    return max(errors)


def _own(k1: float, k2: float, gamma3: float, certify: bool) -> Found:
    result = solve_thresholds(k1, k2, gamma3, ThresholdsRequest(F_MAX, 1e-10, certify, 64))
    first = {c.kind.name: c.at for c in reversed(result.crossings)}
    return first.get("onset", nan), first.get("hopf", nan), result.solves


def interpolated(k1: float, k2: float, gamma3: float, points: int) -> Found:
    """Onset and Hopf point from spectra at equal steps of F, as one reads them off a plot."""
    forces = np.linspace(0.0, GRID_TOP, points)
    request = SpectrumRequest(2, 1e-10, certify=False)
    w = np.array([solve_spectrum(Rod(float(F), k1, k2, gamma3), request).eigenvalues[0] for F in forces])
    pair = np.flatnonzero(w.imag != 0)
    onset = (forces[pair[0] - 1] + forces[pair[0]]) / 2 if pair.size and pair[0] else nan
    up = np.flatnonzero((w.real[:-1] < 0) & (w.real[1:] > 0))
    if not up.size:
        return onset, nan, points
    i = int(up[0])
    share = w[i].real / (w[i].real - w[i + 1].real)
    return onset, float(forces[i] + share * (forces[i + 1] - forces[i])), points
