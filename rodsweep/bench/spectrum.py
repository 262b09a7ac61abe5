"""The spectrum benchmark: time and error of a point, beside the peers, on the paper's four rods."""

import platform
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from ..discretization.resolution import Resolution
from ..model.determinant import scaled_determinant
from ..model.rod import Rod
from ..results.provenance import cpu_name, now, provenance
from ..solve import petsc
from ..solve.spectrum import SpectrumRequest, solve_spectrum
from .peers import SAME_PENCIL, Peer, chebyshev_qz

MODES = 4
RODS = {
    "Fig. 2a": (1e4, 1e4, 1e-4, 60.0),
    "Fig. 2b": (1e4, 1e2, 1e-2, 45.0),
    "Fig. 2c": (2e2, 1e4, 1e-4, 180.0),
    "Fig. 2d": (1e2, 1e4, 1e-4, 85.0),
}
FORCES = 5
ACCURACIES = (1e-6, 1e-10)
CHEBYSHEV_SIZES = (12, 14, 16, 18, 20, 24, 28, 32, 40, 48)
ROUNDS, QUICK_ROUNDS = 25, 5


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table."""

    method: str
    milliseconds: float
    error: float


def points() -> list[Rod]:
    """The rods of the paper's table, each at forces spread over its figure."""
    return [
        Rod(float(F), k1, k2, gamma3)
        for k1, k2, gamma3, top in RODS.values()
        for F in np.linspace(0.1 * top, top, FORCES)
    ]


def exact_spectrum(rod: Rod) -> np.ndarray:
    """The leading eigenvalues, refined by Newton on D from a certified solve."""
    w = solve_spectrum(rod, SpectrumRequest(MODES, 1e-12, certify=True)).eigenvalues.copy()
    for i in range(len(w)):
        for _ in range(3):
            value, slope, _, _ = scaled_determinant(w[i], rod.coefficients)
            w[i] -= value / slope
    return w


def spectrum_table(quick: bool) -> str:
    """Runs the benchmark; returns Markdown with the medians."""
    rods = points()
    exact = [exact_spectrum(rod) for rod in rods]
    rounds = QUICK_ROUNDS if quick else ROUNDS
    lines = []
    for accuracy in ACCURACIES:
        rows = _measure(rods, exact, accuracy, rounds)
        own = rows[0].milliseconds
        lines += [
            "",
            f"Leading {MODES} eigenvalues to {accuracy:.0e}, median over {len(rods)} points of the four rods "
            f"and {rounds} rounds:",
            "",
            "| method | ms a point | worst error | times slower |",
            "|---|---|---|---|",
        ]
        lines += [
            f"| {r.method} | {r.milliseconds:.3f} | {r.error:.0e} | {r.milliseconds / own:.1f} |"
            for r in rows
        ]
    return "\n".join(lines[1:])


def where_and_when() -> str:
    """The machine, the date and the versions that a benchmark ran with."""
    versions = petsc.versions() | {k.removesuffix("_version"): v for k, v in provenance().items()}
    shown = ("rodsweep", "petsc", "slepc", "numpy", "python")
    where = ", ".join(f"{name} {versions[name]}" for name in shown)
    return f"One core of {cpu_name()}, {platform.system()}, {now()[:10]}; {where}. Threads: one."


def _measure(rods: list[Rod], exact: list[np.ndarray], accuracy: float, rounds: int) -> list[Row]:
    """All methods in turn, round after round, so that a slow spell of the machine hits all alike."""
    plain = SpectrumRequest(MODES, accuracy, certify=False)
    proved = SpectrumRequest(MODES, accuracy, certify=True)
    meshes = [_mesh(rod, plain) for rod in rods]
    methods: dict[str, Callable[[int], np.ndarray]] = {
        "rodsweep, certificate off": lambda i: solve_spectrum(rods[i], plain).eigenvalues,
        "rodsweep, certificate on": lambda i: solve_spectrum(rods[i], proved).eigenvalues,
    }
    for name, peer in SAME_PENCIL.items():
        methods[f"{name}, same pencil"] = partial(_on_mesh, peer, rods, meshes)
    sizes = [_cheapest_chebyshev(rod, w, accuracy) for rod, w in zip(rods, exact, strict=True)]
    reached = [i for i, size in enumerate(sizes) if size]
    name = f"Chebyshev collocation and QZ, the cheapest N that reaches it (at {len(reached)} points)"
    methods[name] = lambda i: chebyshev_qz(rods[i], sizes[i], MODES)
    times: dict[str, list[float]] = {name: [] for name in methods}
    errors = dict.fromkeys(methods, 0.0)
    for turn in range(rounds + 1):
        for name, method in methods.items():
            for i in range(len(rods)) if "Chebyshev" not in name else reached:
                began = time.perf_counter()
                w = method(i)
                spent = time.perf_counter() - began
                if turn:
                    times[name].append(spent)
                errors[name] = max(errors[name], relative_error(w, exact[i]))
    return [Row(name, 1e3 * float(np.median(times[name])), errors[name]) for name in methods]


def _on_mesh(peer: Peer, rods: list[Rod], meshes: list[Resolution], i: int) -> np.ndarray:
    return peer(rods[i], meshes[i], MODES)


def relative_error(w: np.ndarray, exact: np.ndarray) -> float:
    """Largest relative distance of an exact eigenvalue to the nearest computed one; inf for none."""
    if not len(w):
        return np.inf
    distance = np.abs(w[None, :] - exact[:, None]).min(axis=1)
    return float((distance / np.abs(exact)).max())


def _mesh(rod: Rod, request: SpectrumRequest) -> Resolution:
    result = solve_spectrum(rod, request)
    return Resolution(result.elements, result.order)


def _cheapest_chebyshev(rod: Rod, exact: np.ndarray, accuracy: float) -> int:
    """The smallest N whose error at this point is within the accuracy; 0 if none is."""
    for n in CHEBYSHEV_SIZES:
        if relative_error(chebyshev_qz(rod, n, MODES), exact) <= accuracy:
            return n
    return 0
