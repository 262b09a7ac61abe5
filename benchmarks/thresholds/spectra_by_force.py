"""Thresholds with SciPy: from spectra on a grid of forces by interpolation, or by root finding.

Every spectrum is one dense eigenproblem by LAPACK on rodsweep's pencil, on one mesh. All methods search for
the first onset or the first Hopf point above F = 0 and prove nothing.
"""

from collections.abc import Callable
from functools import lru_cache, partial
from math import isnan, nan

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import bisect, brentq

from rodsweep.arrays import Array
from rodsweep.bench.spectrum.rodsweep_and_exact_spectra import leading_eigenvalues
from rodsweep.bench.study import TimedMethod
from rodsweep.bench.thresholds.study import HOPF, ONSET, FirstThreshold, ThresholdCase
from rodsweep.discretization.elements.resolution import Resolution
from rodsweep.discretization.straight.arm_resolution import ArmMesh, arm_mesh
from rodsweep.discretization.straight.uniform_resolution import first_resolution

from ..lapack import Eigenvalues, inverse_spectrum, whole_matrices

MESH_MODES, MESH_ACCURACY = 2, 1e-12
"""Number of leading eigenvalues for which the mesh is chosen, and their relative error on this mesh."""
GRIDS, LARGE_GRID = (50, 200), 800
"""Numbers of forces of the grids. A quick run omits LARGE_GRID."""
TOLERANCES = (1e-3, 1e-6, 1e-12)
"""Relative tolerances of the root finding."""
GRID_GROUP = "grid and interpolation"
"""Group of these methods in the figure."""
BRACKETING_STEP = 2.0
"""Step in F by which a root is bracketed: the step ends at a change of sign."""
SCIPY_ROUNDING = 8.9e-16
"""Smallest relative tolerance that SciPy's root finders accept: four times the rounding unit."""


@lru_cache(maxsize=64)
def threshold_mesh(case: ThresholdCase) -> Resolution | ArmMesh:
    """Mesh with a relative error of MESH_ACCURACY at the Hopf point of a case, or at its onset."""
    rod = case.rod(case.onset if isnan(case.hopf) else case.hopf)
    if not rod.is_uniform_and_linear:
        return arm_mesh(rod, MESH_MODES, MESH_ACCURACY)
    return first_resolution(rod, MESH_MODES, MESH_ACCURACY)


def affine_pencil(case: ThresholdCase) -> tuple[Array, Array, Array]:
    """(A0, A1, diagonal of B) of the pencil A x = w B x with A = A0 + F A1, shapes (n, n), (n, n), (n,)."""
    mesh = threshold_mesh(case)
    A0, B = whole_matrices(case.rod(0.0), mesh)
    return A0, whole_matrices(case.rod(1.0), mesh)[0] - A0, B


class LeadingPair:
    """Function from F to the two leading eigenvalues of a case; `solves` counts the eigenproblems."""

    def __init__(self, case: ThresholdCase):
        self.solves = 0
        self._A0, self._A1, self._B = affine_pencil(case)

    def __call__(self, F: float) -> Eigenvalues:
        self.solves += 1
        return leading_eigenvalues(inverse_spectrum(self._A0 + F * self._A1, self._B), 2)


def threshold_on_grid(
    estimate: Callable[[Array, Eigenvalues], float], points: int, case: ThresholdCase
) -> FirstThreshold:
    """First threshold of a case, estimated from the leading eigenvalues on a grid of F from 0 to
    `case.search_end`.

    estimate: from (forces, leading eigenvalues), (points,) each, to the threshold. points: of the grid.
    """
    forces, pair = np.linspace(0.0, case.search_end, points, dtype=np.float64), LeadingPair(case)
    return FirstThreshold(estimate(forces, np.array([pair(F)[0] for F in map(float, forces)])), points)


def onset_midpoint(forces: Array, w: Eigenvalues) -> float:
    """Onset, halfway between the last force with a real leading eigenvalue w and the first force with a pair.

    forces, w: (points,). NaN without a pair.
    """
    first = int(np.argmax(w.imag != 0))
    return float(forces[first - 1 : first + 1].mean()) if first else nan


def onset_by_square_root(forces: Array, w: Eigenvalues) -> float:
    """Onset, extrapolated from the first two leading pairs: (Im w)^2 is linear in F, and 0 at the onset.

    forces, w: (points,). NaN without two pairs.
    """
    pairs = np.flatnonzero(w.imag)[:2]
    return _zero(forces[pairs], w[pairs].imag ** 2) if len(pairs) == 2 and pairs[0] else nan


def hopf_by_interpolation(forces: Array, w: Eigenvalues) -> float:
    """Hopf point by linear interpolation of Re w between the first two forces with a change of sign.

    forces, w: (points,). NaN without a change of sign.
    """
    up = np.flatnonzero((w.real[:-1] < 0) & (w.real[1:] > 0))[:1]
    return _zero(forces[up[0] :], w.real[up[0] :]) if up.size else nan


def _zero(forces: Array, values: NDArray[np.floating]) -> float:
    """Force at which the line through the first two points (force, value) vanishes; forces, values: (n,)."""
    (a, b), (p, q) = map(float, forces[:2]), map(float, values[:2])
    return a - p * (b - a) / (q - p)


def threshold_by_steps(
    search: Callable[..., float], test: Callable[[Eigenvalues], float], tolerance: float, case: ThresholdCase
) -> FirstThreshold:
    """First threshold of a case: steps of MARCH from F = 0 until `test` changes its sign, then a root search.

    search: root finder of SciPy. test: from the two leading eigenvalues to a number. tolerance: relative.
    """
    pair = LeadingPair(case)
    forces = [*map(float, np.arange(0.0, case.search_end, BRACKETING_STEP)), case.search_end]
    behind, value = forces[0], test(pair(forces[0]))
    for ahead in forces[1:]:
        value_ahead = test(pair(ahead))
        if value * value_ahead < 0:
            accuracy = {"xtol": tolerance * ahead, "rtol": SCIPY_ROUNDING}
            root = search(lambda F: test(pair(F)), behind, ahead, **accuracy)
            return FirstThreshold(float(root), pair.solves)
        behind, value = ahead, value_ahead
    return FirstThreshold(nan, pair.solves)


def growth_rate(w: Eigenvalues) -> float:
    """Growth rate Re w of the leading eigenvalue, which vanishes at a Hopf point; w: (2,)."""
    return float(w[0].real)


def discriminant(w: Eigenvalues) -> float:
    """(w1 - w2)^2 of the leading w, (2,): smooth in F, positive for real w, negative for a pair."""
    return float(((w[0] - w[1]) ** 2).real)


def real_or_pair(w: Eigenvalues) -> float:
    """1 if the leading eigenvalue is real, -1 if it belongs to a complex pair; w: (2,)."""
    return -1.0 if w[0].imag else 1.0


GRID_ESTIMATES = {
    ONSET: {"grid, between two forces": onset_midpoint, "grid, square-root law": onset_by_square_root},
    HOPF: {"grid, linear interpolation": hopf_by_interpolation},
}
"""Estimates from a grid of forces, by kind of threshold and name of the method."""
STEP_SEARCHES = {
    ONSET: {
        "steps, bisection on Im w > 0": partial(threshold_by_steps, bisect, real_or_pair),
        "steps, Brent on (w1 - w2)^2": partial(threshold_by_steps, brentq, discriminant),
    },
    HOPF: {"steps, Brent on Re w": partial(threshold_by_steps, brentq, growth_rate)},
}
"""Root searches by steps, by kind of threshold and name of the method."""


def contenders(kind: str, quick: bool) -> list[TimedMethod]:
    """All grids and root searches for one kind of threshold; quick: without LARGE_GRID."""
    grids = GRIDS if quick else (*GRIDS, LARGE_GRID)
    by_grid = [
        TimedMethod(
            name, f"{n} forces", GRID_GROUP, partial(threshold_on_grid, estimate, n), is_slow=n == LARGE_GRID
        )
        for name, estimate in GRID_ESTIMATES[kind].items()
        for n in grids
    ]
    by_search = [
        TimedMethod(name, f"tolerance {tolerance:.0e}", GRID_GROUP, partial(search, tolerance))
        for name, search in STEP_SEARCHES[kind].items()
        for tolerance in TOLERANCES
    ]
    return by_grid + by_search
