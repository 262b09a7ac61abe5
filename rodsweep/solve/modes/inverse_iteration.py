"""Right and left modes of known eigenvalues on one mesh, by inverse iteration on the dense pencil.

Each eigenvalue is the shift, with the pencil for the right and its transpose for the left vector. The
normalisation is that of `rodsweep.solve.modes.leading_modes`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...determinant.value import ROUND_OFF
from ...discretization.pencil import Pencil, shear_force, slope
from ...model.rod import Rod
from ..spectrum.search import NO_TIP
from .dense_operator import dense_operator

Complex = NDArray[np.complex128]

ITERATIONS = 4
"""Inverse iterations: with the eigenvalue known two suffice but next to a double one."""
CONJUGATE = 1e-12
"""Relative distance below which two neighbouring eigenvalues are one pair."""


@dataclass(frozen=True, slots=True)
class Shapes:
    """The modes on one mesh: arrays as in `rodsweep.solve.modes.leading_modes.Modes`.

    rounding: how far that of (A - w B) x moves an eigenvalue of the mesh, in 1/tau2, shape (modes,).
    """

    pencil: Pencil
    right: Complex
    deformation: Complex
    left: Complex
    pairing: Complex
    condition: NDArray[np.float64]
    rounding: NDArray[np.float64]


def mode_shapes(rod: Rod, pencil: Pencil, eigenvalues: Complex, points: NDArray[np.float64]) -> Shapes:
    """The modes of known eigenvalues on one mesh, at `points` in [0, 1]."""
    X, Z, rounding = _vectors(rod, pencil, eigenvalues)
    evaluation = pencil.evaluation(points)
    y, theta = pencil.fields(X, rod)
    right = np.stack([(evaluation @ y).T, (evaluation @ theta).T])
    adjoint = np.stack([(evaluation @ field).T for field in pencil.fields(Z.conj(), rod)])
    deformation = np.stack([rod.c2 * shear_force(pencil, X, points).T, slope(pencil, theta, points).T])
    B = pencil.inertia(rod)[:, None]
    pairing = (B * Z * X).sum(axis=0)
    norms = [np.sqrt((B * np.abs(V) ** 2).sum(axis=0)) for V in (X, Z)]
    condition = norms[0] * norms[1] / np.abs(pairing)
    return Shapes(pencil, right, deformation, adjoint, pairing, condition, rounding)


def _vectors(rod: Rod, pencil: Pencil, eigenvalues: Complex) -> tuple[Complex, Complex, NDArray[np.float64]]:
    """The right and left vectors, shape (unknowns, modes), scaled at the tip, and `Shapes.rounding`."""
    A, B = dense_operator(rod, pencil)
    m = len(eigenvalues)
    X, Z = np.empty((pencil.unknowns, m), complex), np.empty((pencil.unknowns, m), complex)
    for i, w in enumerate(eigenvalues):
        if i and w.imag < 0 and abs(w - eigenvalues[i - 1].conj()) <= CONJUGATE * abs(w):
            X[:, i], Z[:, i] = X[:, i - 1].conj(), Z[:, i - 1].conj()
        else:
            X[:, i], Z[:, i] = null_vectors(A, B, complex(w))
    squares = (np.abs(Z) ** 2 * (np.abs(A) ** 2 @ np.abs(X) ** 2)).sum(axis=0)
    rounding = ROUND_OFF * np.sqrt(squares) / np.abs((B[:, None] * Z * X).sum(axis=0))
    return X * _tip_scale(rod, pencil, X), Z * _tip_scale(rod, pencil, Z), rounding


def null_vectors(A: NDArray, B: NDArray, w: complex) -> tuple[NDArray, NDArray]:
    """The right and the left vector of the eigenvalue w, of largest entry 1; real where w is."""
    inverse = np.linalg.inv(A - np.diag((w if w.imag else w.real) * B))
    return _iterated(inverse, B), _iterated(inverse.T, B)


def _iterated(inverse: NDArray, B: NDArray) -> NDArray:
    """The null vector of a nearly singular matrix, largest entry 1, by inverse iteration from its inverse.

    What grows most in a step has the smallest residual after it. At a double eigenvalue the inverse all but
    annihilates the vector that it has just given, and the next step gives rounding: hence the better of two.
    """
    x: NDArray = np.ones(len(B))
    before, last, growth = x, 0.0, 0.0
    for _ in range(ITERATIONS):
        before, last = x, growth
        x = inverse @ (B * x)
        growth = float(np.abs(x).max())
        x = x / growth
    return x if growth >= last else before


def _tip_scale(rod: Rod, pencil: Pencil, vectors: Complex) -> Complex:
    """What makes y(1) = 1 of each vector; NaN where the tip does not move."""
    y, theta = pencil.fields(vectors, rod)
    size = np.maximum(np.abs(y).max(axis=0), np.abs(theta).max(axis=0))
    return np.where(np.abs(y[-1]) > NO_TIP * size, 1 / y[-1], np.nan)
