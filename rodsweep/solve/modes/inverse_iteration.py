"""Right and left modes of known eigenvalues on one mesh, by inverse iteration on the dense pencil.

Each eigenvalue is the shift, with the pencil for the right and its transpose for the left vector. The
normalisation is that of `rodsweep.solve.modes.leading_modes`.
"""

from dataclasses import dataclass, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...determinant.value import ROUND_OFF
from ...discretization.elements.resolution import Resolution
from ...discretization.straight.dense_form import AnyPencil, DenseForm, dense_form
from ...discretization.straight.pencil import tip_scale
from ...model.rod import Rod

ITERATIONS = 4
"""Inverse iterations: with the eigenvalue known two suffice but next to a double one."""
CONJUGATE = 1e-12
"""Relative distance below which two neighbouring eigenvalues are one pair."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Vectors:
    """The modes on one mesh, at given points.

    right: (Y, Theta) with Y(1) = 1, left: (Y+, Theta+) with Y+(1) = 1, in L and 1 for a tip deflection of L;
    deformation: (h2, Pi) = (Y' - nu Theta, Theta') of the right modes (Sec. V), h2 = c2 s being exactly
    0 in an unshearable rod; complex, shape (2, modes, points), NaN where a tip does not move.
    Where a stiffness jumps, h2 and Pi are those behind the jump.
    pairing: (psi_n, xi_n) in the Gamma inner product, complex, shape (modes,).
    condition: |psi| |xi|/|(psi, xi)| >= 1, shape (modes,): how much farther than its size a perturbation of
    L, in the Gamma norm, moves the eigenvalue; inf at the onset F*. With gamma3 = 0 theta follows
    y at once, is no part of the state, and the norm is that of y.
    rounding: how far that of (A - w B) x moves an eigenvalue of the mesh, in 1/tau2, shape (modes,).
    mode_error: largest error of Y, Theta, h2, Pi, Y+ and Theta+, each in units of its largest value;
    condition_error: relative; both of shape (modes,) and NaN until another mesh is compared.
    """

    resolution: Resolution
    right: Complex
    deformation: Complex
    left: Complex
    pairing: Complex
    condition: Array
    rounding: Array
    mode_error: Array
    condition_error: Array

    def errors(self) -> dict[str, float]:
        """The largest relative errors, by quantity; inf where there is no number."""
        errors = {"modes": self.mode_error.max(), "condition numbers": self.condition_error.max()}
        return {name: inf if np.isnan(error) else float(error) for name, error in errors.items()}


def mode_vectors(rod: Rod, pencil: AnyPencil, eigenvalues: Complex, points: Array) -> Vectors:
    """The modes of known eigenvalues on one mesh, at `points` in [0, 1], shape (n,)."""
    form = dense_form(rod, pencil)
    X, Z, rounding = _vectors(form, eigenvalues)
    evaluation = form.mesh.evaluation(points)
    B = form.B[:, None]
    pairing = (B * Z * X).sum(axis=0)
    norms = [np.sqrt((B * np.abs(V) ** 2).sum(axis=0)) for V in (X, Z)]
    return replace(
        no_vectors(Resolution(form.mesh.elements, form.mesh.order), len(eigenvalues), len(points)),
        right=np.stack([(evaluation @ field).T for field in form.fields(X)]),
        deformation=form.strains(X, points),
        left=np.stack([(evaluation @ field).T for field in form.fields(Z.conj())]),
        pairing=pairing,
        condition=norms[0] * norms[1] / np.abs(pairing),
        rounding=rounding,
    )


def no_vectors(resolution: Resolution, modes: int, points: int) -> Vectors:
    """What stands for the vectors where there are none: NaN."""
    shape, numbers = np.full((2, modes, points), np.nan + 0j), np.full(modes, np.nan)
    return Vectors(
        resolution=resolution,
        right=shape,
        deformation=shape,
        left=shape,
        pairing=numbers + 0j,
        condition=numbers,
        rounding=numbers,
        mode_error=numbers,
        condition_error=numbers,
    )


def _vectors(form: DenseForm, eigenvalues: Complex) -> tuple[Complex, Complex, Array]:
    """The right and left vectors, shape (unknowns, modes), scaled at the tip, and `Vectors.rounding`."""
    A, B = form.A, form.B
    m = len(eigenvalues)
    X, Z = np.empty((len(B), m), complex), np.empty((len(B), m), complex)
    for i, w in enumerate(eigenvalues):
        if i and w.imag < 0 and abs(w - eigenvalues[i - 1].conj()) <= CONJUGATE * abs(w):
            X[:, i], Z[:, i] = X[:, i - 1].conj(), Z[:, i - 1].conj()
        else:
            X[:, i], Z[:, i] = null_vectors(A, B, complex(w))
    squares = (np.abs(Z) ** 2 * (np.abs(A) ** 2 @ np.abs(X) ** 2)).sum(axis=0)
    rounding = ROUND_OFF * np.sqrt(squares) / np.abs((B[:, None] * Z * X).sum(axis=0))
    right, left = (V * tip_scale(*form.fields(V)) for V in (X, Z))
    return right, left, rounding


def null_vectors(A: NDArray, B: NDArray, w: complex) -> tuple[NDArray, NDArray]:
    """The right and the left vector of the eigenvalue w, (unknowns,), of largest entry 1; real where w is."""
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
