"""The spectrum benchmark: time and error of a point beside the peers, on the paper's and on hard rods."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf, nan
from typing import Any

import numpy as np

from ...model.rod import Rod
from ...solve.spectrum.search import SpectrumRequest, solve_spectrum, warm_up
from ..study import Measurement, Study, race
from .exact import exact_spectrum, relative_error
from .peers import PEERS, Eigenvalues, Peer

MODES = 4
RODS = {
    "Fig. 2a": (1e4, 1e4, 1e-4, 60.0),
    "Fig. 2b": (1e4, 1e2, 1e-2, 45.0),
    "Fig. 2c": (2e2, 1e4, 1e-4, 180.0),
    "Fig. 2d": (1e2, 1e4, 1e-4, 85.0),
}
"""k1, k2, gamma3 and the largest force."""
FORCES = 5
HARD = {
    "easy: F = 30, k1 = k2 = 1e4, gamma3 = 1e-4": Rod(30.0, 1e4, 1e4, 1e-4),
    "stiff: F = 30, k1 = k2 = 1e8, gamma3 = 1e-8": Rod(30.0, 1e8, 1e8, 1e-8),
    "nearly crushed: F = 0.999 k1, k1 = 200": Rod(199.8, 200.0, 1e4, 1e-4),
    "12 unstable modes: F = 2000, k1 = 1e4": Rod(2000.0, 1e4, 1e4, 1e-4),
}
TARGETS = (1e-12, 1e-10, 1e-6)
"""Errors at which the methods are compared, the strictest first."""
ROUNDS, QUICK_ROUNDS = 25, 2
QUICK_STRIDE = 3
"""A quick run measures every third size on the hard rods."""
OWN, PLAIN, PROVED = "this tool", "rodsweep, certificate off", "rodsweep, certificate on"


@dataclass(frozen=True, slots=True)
class Row:
    """One method at one target: median milliseconds a point, over the points at which it gets there."""

    method: str
    milliseconds: float
    error: float
    points: int


def points() -> list[Rod]:
    """The rods of the paper's table, each at forces spread over its figure."""
    return [
        Rod(float(F), k1, k2, gamma3)
        for k1, k2, gamma3, top in RODS.values()
        for F in np.linspace(0.1 * top, top, FORCES)
    ]


def spectrum_study(quick: bool) -> Study:
    """Runs the benchmark: the paper's rods at equal errors, then every method at every size on hard rods."""
    warm_up()
    rounds = QUICK_ROUNDS if quick else ROUNDS
    rods = points()
    exact = [exact_spectrum(rod, MODES) for rod in rods]
    blocks = [equal_errors(rods, exact, target, rounds) for target in TARGETS[: 1 if quick else None]]
    measurements: list[Measurement] = []
    for case, rod in HARD.items():
        measurements += every_size(case, rod, rounds, QUICK_STRIDE if quick else 1)
    blocks.append(hard_table(measurements))
    return Study("spectrum", "\n\n".join(blocks), tuple(measurements), "point", TARGETS[0])


def own(rod: Rod, certify: bool) -> Eigenvalues:
    """This tool's eigenvalues; its error does not depend on the accuracy asked for."""
    return solve_spectrum(rod, SpectrumRequest(MODES, TARGETS[0], certify)).eigenvalues


def failsafe(run: Callable[[], Eigenvalues]) -> Eigenvalues:
    """What a method gives, or nothing where LAPACK, ARPACK or the method itself gives up."""
    try:
        with np.errstate(all="ignore"):
            return run()
    except (ArithmeticError, RuntimeError, ValueError, np.linalg.LinAlgError):
        return np.empty(0, complex)


def equal_errors(rods: Sequence[Rod], exact: Sequence[list[Any]], target: float, rounds: int) -> str:
    """All methods at the cheapest size that reaches the target, point by point; a table."""
    runs: list[Callable[[], Eigenvalues]] = []
    names: list[tuple[str, int]] = []
    for name, certify in ((PLAIN, False), (PROVED, True)):
        for i, rod in enumerate(rods):
            names.append((name, i))
            runs.append(partial(own, rod, certify))
    for peer in PEERS:
        for i, rod in enumerate(rods):
            size = cheapest(peer, rod, exact[i], target)
            if size:
                names.append((peer.name, i))
                runs.append(partial(failsafe, partial(peer.solve, rod, size, MODES)))
    seconds, found = race(runs, rounds)
    at: dict[str, dict[int, tuple[float, float]]] = {name: {} for name in (PLAIN, PROVED)}
    at |= {peer.name: {} for peer in PEERS}
    for (name, i), spent, w in zip(names, seconds, found, strict=True):
        at[name][i] = 1e3 * spent, relative_error(w, exact[i])
    lines = [
        f"Leading {MODES} eigenvalues to {target:.0e}, each method at the cheapest size that gets there, "
        f"median over {len(rods)} points of the paper's four rods, {rounds} rounds:",
        "",
        "| method | points reached | ms a point | worst error | times this tool's time |",
        "|---|---|---|---|---|",
    ]
    for name, reached in at.items():
        if not reached:
            lines.append(f"| {name} | 0 | | | |")
            continue
        times = [milliseconds for milliseconds, _ in reached.values()]
        ratio = np.median([milliseconds / at[PLAIN][i][0] for i, (milliseconds, _) in reached.items()])
        worst = max(error for _, error in reached.values())
        lines.append(f"| {name} | {len(reached)} | {np.median(times):.3f} | {worst:.0e} | {ratio:.1f} |")
    return "\n".join(lines)


def cheapest(peer: Peer, rod: Rod, exact: list[Any], target: float) -> int:
    """The smallest size whose error is within the target; 0 if none is."""
    for size in peer.sizes:
        if relative_error(failsafe(partial(peer.solve, rod, size, MODES)), exact) <= target:
            return size
    return 0


def every_size(case: str, rod: Rod, rounds: int, stride: int = 1) -> list[Measurement]:
    """All methods at each stride-th of their sizes on one rod."""
    exact = exact_spectrum(rod, MODES)
    settings = [(PLAIN, OWN, ""), (PROVED, OWN, "")]
    runs: list[Callable[[], Eigenvalues]] = [partial(own, rod, False), partial(own, rod, True)]
    for peer in PEERS:
        for size in peer.sizes[::stride]:
            settings.append((peer.name, peer.group, str(size)))
            runs.append(partial(failsafe, partial(peer.solve, rod, size, MODES)))
    seconds, found = race(runs, rounds)
    return [
        Measurement(case, method, size, spent if len(w) else nan, relative_error(w, exact), group)
        for (method, group, size), spent, w in zip(settings, seconds, found, strict=True)
    ]


def hard_table(measurements: Sequence[Measurement]) -> str:
    """For every method on every hard rod the least error, and the time it takes to get within ten of it."""
    cases = list(dict.fromkeys(m.case for m in measurements))
    lines = [
        f"Leading {MODES} eigenvalues of hard rods: the least relative error that a method reaches at any "
        "size, and the ms of the cheapest size within a factor 10 of it (the figure and the file have all):",
        "",
        "| method | " + " | ".join(cases) + " |",
        "|---|" + "---|" * len(cases),
    ]
    for method in dict.fromkeys(m.method for m in measurements):
        cells = []
        for case in cases:
            here = [m for m in measurements if (m.case, m.method) == (case, method)]
            least = min(m.error for m in here)
            if least == inf:
                cells.append("failed")
                continue
            near = min((m for m in here if m.error <= 10 * least), key=lambda m: m.seconds)
            cells.append(f"{least:.0e}, {1e3 * near.seconds:.2f} ms")
        lines.append(f"| {method} | " + " | ".join(cells) + " |")
    return "\n".join(lines)
