"""Eigenvalues of arms by another discretisation: displacements on elements, shear by its stiffness, dense QR.

Shares nothing with the package but `Rod.local_coefficients`, the coefficients along the arm.
"""

import numpy as np
from numpy.polynomial import legendre


def _lobatto(p):
    series = np.zeros(p + 1)
    series[p] = 1
    x = np.concatenate([[-1], np.sort(legendre.legroots(legendre.legder(series)).real), [1]])
    return x, 2 / (p * (p + 1) * legendre.legval(x, series) ** 2)


def _basis(x, at):
    """Values and slopes of the Lagrange polynomials through x at points, by Vandermonde matrices."""
    series = np.linalg.inv(legendre.legvander(x, len(x) - 1))
    return legendre.legvander(at, len(x) - 1) @ series, legendre.legvander(at, len(x) - 2) @ legendre.legder(
        series
    )


def edges_of(rod, per_length):
    """Ends of elements: those of smooth pieces, and between them equal ratios of radii."""
    edges = [0.0]
    breaks = rod.material.breaks
    for a, b in zip(breaks[:-1], breaks[1:], strict=True):
        count = max(1, int(np.ceil(per_length * (b - a))))
        radii = [1 - (1 - rod.taper) * u for u in (a, b)]
        inner = np.linspace(a, b, count + 1)
        if rod.taper != 1:
            inner = (1 - np.geomspace(*radii, count + 1)) / (1 - rod.taper)
        edges += [*inner[1:-1], b]
    return np.array(edges)


def nodes(rod, per_length=4, p=20):
    """u of all nodes, the clamp included."""
    edges = edges_of(rod, per_length)
    inner = (_lobatto(p)[0][1:] + 1) / 2
    return np.append(0.0, (edges[:-1, None] + np.diff(edges)[:, None] * inner).ravel())


def matrices(rod, per_length=4, p=20):
    """(A, diagonal of M) of A x = w M x in the values of y and theta at all nodes but the clamp."""
    x, w = _lobatto(p)
    g, wg = legendre.leggauss(p)
    value, slope = _basis(x, g)
    edges = edges_of(rod, per_length)
    n = (len(edges) - 1) * p + 1
    A, M = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    for e, (a, b) in enumerate(zip(edges[:-1], edges[1:], strict=True)):
        here = rod.local_coefficients(a + (b - a) * (g + 1) / 2)
        at_nodes = rod.local_coefficients(np.clip(a + (b - a) * (x + 1) / 2, a + 1e-12, b - 1e-12))
        y, weight, d = np.arange(e * p, e * p + p + 1), wg * (b - a) / 2, slope * 2 / (b - a)
        t = y + n
        by_y, by_t = d / here.c2[:, None], -(here.nu / here.c2)[:, None] * value  # s of y and theta
        A[np.ix_(y, y)] -= d.T @ (weight[:, None] * by_y)
        A[np.ix_(y, t)] -= d.T @ (weight[:, None] * (by_t - rod.F * value))
        A[np.ix_(t, y)] += value.T @ ((weight * here.g)[:, None] * by_y)
        A[np.ix_(t, t)] += value.T @ ((weight * here.g)[:, None] * by_t) - d.T @ (
            (weight / here.c3)[:, None] * d
        )
        M[y] += w * (b - a) / 2 * at_nodes.gamma2
        M[t] += w * (b - a) / 2 * at_nodes.gamma3
    A[n - 1, 2 * n - 1] -= rod.F
    kept = np.r_[1:n, n + 1 : 2 * n]
    return A[np.ix_(kept, kept)], M[kept]


def eigenvalues(rod, per_length=4, p=20):
    """All eigenvalues of an arm with shear, by descending real part."""
    A, M = matrices(rod, per_length, p)
    found = np.linalg.eigvals(A / M[:, None])
    return found[np.argsort(-found.real)]


def in_energy_norm(rod, per_length=4, p=20):
    """L in coordinates in which the norm of the dissipation is Euclidean, (n, n), of an arm with shear."""
    A, M = matrices(rod, per_length, p)
    root = np.sqrt(M)
    return A / root[:, None] / root
