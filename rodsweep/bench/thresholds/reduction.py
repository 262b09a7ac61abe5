"""The ordinary differential equation du/dt = M(F) u that continuation codes want.

It is the pencil that rodsweep uses without the unknowns that carry no time derivative. On the trivial branch
u = 0 its Jacobian is M(F).
"""

import numpy as np

from ...arrays import Array
from .cases import ThresholdCase
from .spectra_by_force import affine


def reduced(case: ThresholdCase) -> Array:
    """M0, M1, M2 of M(F) = M0 + F M1 + F^2 M2, shape (3, n, n).

    A = A0 + F A1 of the pencil, B is diagonal. Raises ArithmeticError where the block to be eliminated
    depends on F, which is so for gamma3 = 0 with a finite k1 or k2, or is singular, for c2 = 0 < gamma3.
    """
    A0, A1, B = affine(case)
    n = int(np.count_nonzero(B))
    if A1[n:, n:].any() or not A0[n:, n:].any():
        raise ArithmeticError("the pencil does not reduce to a polynomial in F")
    S0, S1 = np.split(np.linalg.solve(A0[n:, n:], np.hstack([A0[n:, :n], A1[n:, :n]])), 2, axis=1)
    up0, up1 = A0[:n, n:], A1[:n, n:]
    pieces = [A0[:n, :n] - up0 @ S0, A1[:n, :n] - up0 @ S1 - up1 @ S0, -up1 @ S1]
    return np.array(pieces) / B[:n, None]
