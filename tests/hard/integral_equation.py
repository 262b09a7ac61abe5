"""The spectrum of one rod from integral equations on Gauss nodes and LAPACK: no code shared with rodsweep.

Integrating the first-order system (s and m = theta' from the tip, y and theta from the clamp) builds all
four boundary conditions in:

    y = J0 (nu theta + c2 s),  theta = J0 m,  s = J1 (w y + F m),  m = J1 (gamma3 w theta - g s),

J0 = int_0^u, J1 = -int_u^1. Solved for (y, theta) with w = sigma + (w - sigma) this is an ordinary
eigenproblem for 1/(w - sigma) with a compact operator in every limit; w = infinity is its zero.
"""

from functools import cache

import numpy as np
from numpy.polynomial import legendre


@cache
def integration(n):
    """(J0, J1, quadrature weights) on n Gauss nodes of [0, 1]."""
    x, w = legendre.leggauss(n)
    P = legendre.legvander(x, n)
    k = np.arange(n)
    coefficients = (2 * k[:, None] + 1) / 2 * P[:, :n].T * w
    integrals = np.empty((n, n))
    integrals[:, 0] = (1 + x) / 2
    integrals[:, 1:] = (P[:, 2:] - P[:, : n - 1]) / (2 * k[1:] + 1) / 2
    J0 = integrals @ coefficients
    return J0, J0 - w / 2, w / 2


def coefficients_of(F, k1, k2, gamma3):
    """(F, nu, c2, gamma3, g)"""
    nu, c2 = (k1 - F) / k1 if np.isfinite(k1) else 1.0, 1 / k2
    return F, nu, c2, gamma3, nu + F * c2


def wave_numbers(w, rod):
    """The larger |q| of q^4 + (F g - (c2 + gamma3) w) q^2 + w (c2 gamma3 w + g nu) = 0 at each w."""
    F, nu, c2, gamma3, g = coefficients_of(*rod)
    half = ((c2 + gamma3) * w - F * g) / 2
    root = np.sqrt(half**2 - w * (c2 * gamma3 * w + g * nu) + 0j)
    return np.sqrt(np.maximum(abs(half + root), abs(half - root)))


def fastest_wave(rod):
    """(growth rate, |q| there) of the most amplified wave exp(i kappa u) of an endless rod."""
    F, nu, c2, gamma3, g = coefficients_of(*rod)
    K = F * g * np.geomspace(1e-5, 1, 200) if F * g > 0 else np.zeros(1)
    if g < 0:  # the wave that neither shear nor rotation slows down, but for its inertia
        K = np.append(K, -g * nu / (c2 + gamma3))
    with np.errstate(all="ignore"):
        b, c = (c2 + gamma3) * K + g * nu, K * (K - F * g)
        rate = -2 * c / (b + np.sqrt(b * b - 4 * c2 * gamma3 * c))
    rate = rate[np.isfinite(rate)].max(initial=0.0)
    return rate, max(float(wave_numbers(np.array([rate]), rod)[0]), np.sqrt(abs(F * g)))


def nodes_for(rod, modes=4):
    """Nodes that resolve the most amplified wave, and those of the leading modes that decay."""
    return 16 + 4 * int(0.2 * fastest_wave(rod)[1]) + max(8, 4 * modes)


def dense_eigenvalues(rod, n, shift):
    """All eigenvalues that n nodes can stand for, in descending order of the real part."""
    F, nu, c2, gamma3, g = coefficients_of(*rod)
    J0, J1, weights = integration(n)
    one = np.eye(n)
    system = np.block(
        [
            [one - shift * c2 * J1 @ J0, -F * J1 - shift * nu * J1 @ J0 @ J0],
            [g * J1, one - shift * gamma3 * J1 @ J0],
        ]
    )
    fields = np.block([[c2 * J0, nu * J0 @ J0], [0 * one, J0]])
    loads = np.block([[J1, 0 * one], [0 * one, J1]])
    scale = np.concatenate([np.sqrt(weights), np.sqrt(gamma3 * weights)])
    moving = scale > 0
    G = fields[moving] @ np.linalg.solve(system, loads[:, moving])
    G = scale[moving, None] * G * np.where(np.arange(2 * n) < n, 1.0, gamma3)[moving] / scale[moving]
    mu = np.linalg.eigvals(G)
    w = shift + 1 / mu[mu != 0]
    w = w[wave_numbers(w, rod) < n]
    return w[np.lexsort((-w.imag, -w.real))]
