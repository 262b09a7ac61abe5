"""Thresholds as one finds them with SciPy: spectra on a grid of forces, interpolated, or root finding.

Every spectrum is one dense eigenproblem by LAPACK on the pencil that rodsweep uses, on one mesh. All look
for the first onset or the first Hopf point above F = 0 and prove nothing.
"""

from collections.abc import Callable
from math import isnan, nan

import numpy as np
import scipy.linalg
import scipy.optimize
from numpy.typing import NDArray

from ...discretization.pencil import assemble
from .cases import Found, Problem

Array = NDArray[np.float64]

MARCH = 2.0
"""Step in F at which a sign is looked for before a root is."""
LEAST_TOLERANCE = 8.9e-16
"""Of Brent's method in SciPy: four units of rounding."""


def affine(problem: Problem) -> tuple[Array, Array, Array]:
    """A0, A1 and the diagonal of B, which are the pencil at the force F by A = A0 + F A1."""
    pencil = assemble(problem.mesh.elements, problem.mesh.order)
    size, pieces = (pencil.unknowns, pencil.unknowns), pencil.dense_pieces()
    A0, at_1 = ((pencil.coefficients(problem.rod(F)) @ pieces).reshape(size, order="F") for F in (0.0, 1.0))
    return A0, at_1 - A0, pencil.inertia(problem.rod(0.0))


class Spectra:
    """The two leading eigenvalues at a force, counting the eigenproblems.

    LAPACK's LU of A, then its standard eigenproblem (geev) of the block of A^-1 B that carries the time
    derivatives, the fastest of the dense ways.
    """

    def __init__(self, problem: Problem):
        self.top = problem.top
        self.solves = 0
        self._A0, self._A1, B = affine(problem)
        self._dynamic = int(np.count_nonzero(B))
        self._B = np.diag(B)[:, : self._dynamic]

    def __call__(self, F: float) -> NDArray[np.complex128]:
        self.solves += 1
        inverse = np.linalg.solve(self._A0 + F * self._A1, self._B)[: self._dynamic]
        w = 1 / scipy.linalg.eigvals(inverse, check_finite=False)
        return w[np.argsort(-w.real, kind="stable")[:2]]

    def growth(self, F: float) -> float:
        return float(self(F)[0].real)

    def discriminant(self, F: float) -> float:
        """(w1 - w2)^2, smooth where two real eigenvalues become a pair, and negative beyond."""
        w = self(F)
        return float(((w[0] - w[1]) ** 2).real)

    def real(self, F: float) -> float:
        """1 where a real eigenvalue leads, -1 where a pair does."""
        return -1.0 if self(F)[0].imag else 1.0


def _grid(problem: Problem, points: int) -> tuple[Array, NDArray[np.complex128]]:
    """Equal steps of F from 0 to the top, and the leading eigenvalue at each."""
    forces, spectra = np.linspace(0.0, problem.top, points, dtype=np.float64), Spectra(problem)
    return forces, np.array([spectra(float(F))[0] for F in forces])


def onset_between(points: int, problem: Problem) -> Found:
    """Halfway between the last real leading eigenvalue of the grid and the first pair."""
    forces, w = _grid(problem, points)
    pair = np.flatnonzero(w.imag)
    return Found(float(forces[pair[0] - 1 : pair[0] + 1].mean()) if pair.size and pair[0] else nan, points)


def onset_by_square_root(points: int, problem: Problem) -> Found:
    """Where (Im w)^2, linear in F next to the onset, vanishes: through the first two pairs of the grid."""
    forces, w = _grid(problem, points)
    pair = np.flatnonzero(w.imag)[:2]
    if len(pair) < 2 or not pair[0]:
        return Found(nan, points)
    (a, b), (p, q) = forces[pair], w[pair].imag ** 2
    return Found(float(a - p * (b - a) / (q - p)), points)


def hopf_interpolated(points: int, problem: Problem) -> Found:
    """Where the linear interpolant of the growth rate first vanishes, as one reads it off a plot."""
    forces, w = _grid(problem, points)
    up = np.flatnonzero((w.real[:-1] < 0) & (w.real[1:] > 0))
    if not up.size:
        return Found(nan, points)
    i = int(up[0])
    share = w[i].real / (w[i].real - w[i + 1].real)
    return Found(float(forces[i] + share * (forces[i + 1] - forces[i])), points)


def _bracket(test: Callable[[float], float], top: float) -> tuple[float, float]:
    """The first step of a march from F = 0 over which the sign changes; nan where none does."""
    behind, value = 0.0, test(0.0)
    while behind < top:
        ahead = min(behind + MARCH, top)
        value_ahead = test(ahead)
        if value * value_ahead < 0:
            return behind, ahead
        behind, value = ahead, value_ahead
    return nan, nan


def _brent(spectra: Spectra, test: Callable[[float], float], tolerance: float) -> Found:
    a, b = _bracket(test, spectra.top)
    if isnan(a):
        return Found(nan, spectra.solves)
    root = scipy.optimize.brentq(test, a, b, xtol=tolerance * b, rtol=max(tolerance, LEAST_TOLERANCE))
    return Found(float(root), spectra.solves)


def hopf_by_brent(tolerance: float, problem: Problem) -> Found:
    """A march until the growth rate changes its sign, then Brent's method on it."""
    spectra = Spectra(problem)
    return _brent(spectra, spectra.growth, tolerance)


def onset_by_brent(tolerance: float, problem: Problem) -> Found:
    """The same on (w1 - w2)^2, as one does who knows that the onset is a double eigenvalue."""
    spectra = Spectra(problem)
    return _brent(spectra, spectra.discriminant, tolerance)


def onset_by_bisection(tolerance: float, problem: Problem) -> Found:
    """A march until a pair leads, then bisection on whether one does."""
    spectra = Spectra(problem)
    a, b = _bracket(spectra.real, problem.top)
    while b - a > 2 * tolerance * b:
        middle = (a + b) / 2
        if middle in (a, b):
            break
        a, b = (middle, b) if spectra.real(middle) > 0 else (a, middle)
    return Found((a + b) / 2, spectra.solves)
