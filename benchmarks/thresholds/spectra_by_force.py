"""Thresholds as one finds them with SciPy: spectra on a grid of forces, interpolated, or root finding.

Every spectrum is one dense eigenproblem by LAPACK on the pencil that rodsweep uses, on one mesh. All look
for the first onset or the first Hopf point above F = 0 and prove nothing.
"""

from collections.abc import Callable
from functools import lru_cache, partial
from math import isnan, nan

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import bisect, brentq

from rodsweep.arrays import Array
from rodsweep.bench.spectrum.own import leading
from rodsweep.bench.study import Contender
from rodsweep.bench.thresholds.study import HOPF, ONSET, FirstThreshold, ThresholdCase
from rodsweep.discretization.elements.resolution import Resolution, expected_wave_number, resolution_for
from rodsweep.discretization.straight.arm_resolution import ArmMesh, arm_mesh
from rodsweep.model.dispersion import most_amplified_wave

from ..lapack import Eigenvalues, inverse_spectrum, whole_matrices

MESH_MODES, MESH_ACCURACY = 2, 1e-12
"""Leading eigenvalues for which the mesh is chosen, and their relative error on it."""
GRIDS, LARGE_GRID = (50, 200), 800
TOLERANCES = (1e-3, 1e-6, 1e-12)
SWEEP = "grid and interpolation"
"""Group of a figure."""
MARCH = 2.0
"""Step in F at which a sign is looked for before a root is."""
SCIPY_ROUNDING = 8.9e-16
"""The least relative tolerance that SciPy's searches take: four units of rounding."""


@lru_cache(maxsize=64)
def mesh_of(case: ThresholdCase) -> Resolution | ArmMesh:
    """Fine enough at the thresholds of a rod."""
    rod = case.rod(case.onset if isnan(case.hopf) else case.hopf)
    if not rod.standard:
        return arm_mesh(rod, MESH_MODES, MESH_ACCURACY)
    wave = most_amplified_wave(rod)[1]
    return resolution_for(expected_wave_number(MESH_MODES, wave), MESH_ACCURACY)


def affine(case: ThresholdCase) -> tuple[Array, Array, Array]:
    """A0, A1 and the diagonal of B, shapes (n, n), (n, n), (n,): A = A0 + F A1 at F."""
    mesh = mesh_of(case)
    A0, B = whole_matrices(case.rod(0.0), mesh)
    return A0, whole_matrices(case.rod(1.0), mesh)[0] - A0, B


class LeadingPair:
    """The two leading eigenvalues at a force, counting the eigenproblems."""

    def __init__(self, case: ThresholdCase):
        self.solves = 0
        self._A0, self._A1, self._B = affine(case)

    def __call__(self, F: float) -> Eigenvalues:
        self.solves += 1
        return leading(inverse_spectrum(self._A0 + F * self._A1, self._B), 2)


def on_grid(
    estimate: Callable[[Array, Eigenvalues], float], points: int, case: ThresholdCase
) -> FirstThreshold:
    """An estimate from the leading eigenvalue at equal steps of F from 0 to the top, shapes (points,)."""
    forces, pair = np.linspace(0.0, case.top, points, dtype=np.float64), LeadingPair(case)
    return FirstThreshold(estimate(forces, np.array([pair(F)[0] for F in map(float, forces)])), points)


def between(forces: Array, w: Eigenvalues) -> float:
    """An onset: halfway between the last real leading w, shape (points,), and the first pair."""
    first = int(np.argmax(w.imag != 0))
    return float(forces[first - 1 : first + 1].mean()) if first else nan


def square_root_law(forces: Array, w: Eigenvalues) -> float:
    """An onset: where (Im w)^2, linear in F next to it, vanishes, by the first two pairs in w, (points,)."""
    pairs = np.flatnonzero(w.imag)[:2]
    return _zero(forces[pairs], w[pairs].imag ** 2) if len(pairs) == 2 and pairs[0] else nan


def interpolated_growth(forces: Array, w: Eigenvalues) -> float:
    """A Hopf point: where Re w, shape (points,), vanishes between two forces, as one reads it off a plot."""
    up = np.flatnonzero((w.real[:-1] < 0) & (w.real[1:] > 0))[:1]
    return _zero(forces[up[0] :], w.real[up[0] :]) if up.size else nan


def _zero(forces: Array, values: NDArray[np.floating]) -> float:
    """Where the line through the first two points vanishes."""
    (a, b), (p, q) = map(float, forces[:2]), map(float, values[:2])
    return a - p * (b - a) / (q - p)


def by_steps(
    search: Callable[..., float], test: Callable[[Eigenvalues], float], tolerance: float, case: ThresholdCase
) -> FirstThreshold:
    """Steps from F = 0 until a test changes its sign, then a search of SciPy's between the two forces."""
    pair = LeadingPair(case)
    forces = [*map(float, np.arange(0.0, case.top, MARCH)), case.top]
    behind, value = forces[0], test(pair(forces[0]))
    for ahead in forces[1:]:
        value_ahead = test(pair(ahead))
        if value * value_ahead < 0:
            accuracy = {"xtol": tolerance * ahead, "rtol": SCIPY_ROUNDING}
            root = search(lambda F: test(pair(F)), behind, ahead, **accuracy)
            return FirstThreshold(float(root), pair.solves)
        behind, value = ahead, value_ahead
    return FirstThreshold(nan, pair.solves)


def growth(w: Eigenvalues) -> float:
    """The growth rate, which vanishes at a Hopf point."""
    return float(w[0].real)


def discriminant(w: Eigenvalues) -> float:
    """(w1 - w2)^2, smooth where two real eigenvalues become a pair, and negative beyond."""
    return float(((w[0] - w[1]) ** 2).real)


def leads_real(w: Eigenvalues) -> float:
    """1 where a real eigenvalue leads, -1 where a pair does."""
    return -1.0 if w[0].imag else 1.0


BY_GRID = {
    ONSET: {"grid, between two forces": between, "grid, square-root law": square_root_law},
    HOPF: {"grid, linear interpolation": interpolated_growth},
}
BY_STEPS = {
    ONSET: {
        "steps, bisection on Im w > 0": partial(by_steps, bisect, leads_real),
        "steps, Brent on (w1 - w2)^2": partial(by_steps, brentq, discriminant),
    },
    HOPF: {"steps, Brent on Re w": partial(by_steps, brentq, growth)},
}
"""The estimates on a grid and the searches by steps, by what they are for."""


def contenders(kind: str, quick: bool) -> list[Contender]:
    """All grids and searches for one kind of threshold; who is quick does without the largest grid."""
    grids = GRIDS if quick else (*GRIDS, LARGE_GRID)
    by_grid = [
        Contender(name, f"{n} forces", SWEEP, partial(on_grid, estimate, n), slow=n == LARGE_GRID)
        for name, estimate in BY_GRID[kind].items()
        for n in grids
    ]
    by_search = [
        Contender(name, f"tolerance {tolerance:.0e}", SWEEP, partial(search, tolerance))
        for name, search in BY_STEPS[kind].items()
        for tolerance in TOLERANCES
    ]
    return by_grid + by_search
