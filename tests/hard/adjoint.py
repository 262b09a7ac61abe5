"""Exact condition numbers, from the power series in u of a mode and its adjoint mode (Appendix B)."""

import mpmath as mp
from reference import determinant as reference

DIGITS = 60
SMALLEST = mp.mpf(10) ** -40
"""Terms of the power series that are left out."""


def condition(rod, w):
    """|psi| |xi|/|(psi, xi)| in the Gamma norm, for an eigenvalue w that is known to 30 digits."""
    with mp.workdps(DIGITS):
        weights = (mp.mpf(1), mp.mpf(rod[3]))
        # The adjoint mode belongs to w*: its conjugate solves the same equations with w.
        xi, psi = (_series(rod, mp.mpmathify(w), ends) for ends in (0, 1))
        norms = [mp.sqrt(mp.re(_product(_conjugate(x), x, weights))) for x in (xi, psi)]
        return norms[0] * norms[1] / abs(_product(psi, xi, weights))


def _conjugate(fields):
    return [[mp.conj(c) for c in field] for field in fields]


def _product(a, b, weights):
    """sum over the fields of weight int a b du."""
    total = mp.mpf(0)
    for weight, p, q in zip(weights, a, b, strict=True):
        if weight:
            inverse = [mp.mpf(1) / (n + 1) for n in range(len(p) + len(q))]
            total += weight * mp.fsum(x * mp.fdot(q, inverse[i:]) for i, x in enumerate(p))
    return total


def _series(rod, w, ends):
    """Coefficients of y and theta in powers of u; the tip is free (0) or that of the adjoint (1)."""
    F, c2, gamma3, nu, g = reference.coefficients(*rod)
    A = mp.matrix([[0, nu, c2, 0], [0, 0, 0, 1], [w, 0, 0, F], [0, gamma3 * w, -g, 0]])
    terms = [mp.eye(4)[:, 2:]]
    while mp.norm(terms[-1]) > SMALLEST or len(terms) < 8:
        terms.append(A * terms[-1] / len(terms))
    tip = mp.matrix(4, 2)
    for term in terms:
        tip += term
    rows = [[tip[2, j] - ends * F * tip[1, j] for j in (0, 1)]]
    rows += [[tip[3, j] + ends * F * tip[0, j] for j in (0, 1)]]
    row = max(rows, key=lambda r: max(map(abs, r)))
    start = mp.matrix([row[1], -row[0]])
    states = [term * start for term in terms]
    return [[state[i] for state in states] for i in (0, 1)]
