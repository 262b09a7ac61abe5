"""The three limits of the model, approached: rods in which compliances or the rotational drag are small.

A path is a rod with None in the place of what tends to its limit; `rod_on` puts k = 1/epsilon or
gamma3 = epsilon there, and inf or 0 for epsilon = 0. D is entire in 1/k1, 1/k2 and gamma3, so simple
eigenvalues and thresholds leave the limit at first order, by the slopes given here.
"""

from math import inf

import mpmath as mp

from .exact import derivatives

EPSILONS = (1e-6, 1e-8, 1e-10, 1e-12, 1e-14)
COMPLIANCES = ("c1", "c2", "gamma3")
PATHS = [
    (30.0, None, 1e4, 1e-4),
    (15.0, None, inf, 0.0),
    (8.0, None, 5.0, 2.0),
    (-10.0, None, 1e2, 1e-2),
    (30.0, 1e4, None, 1e-4),
    (30.0, 60.0, None, 0.0),
    (-10.0, 1e4, None, 1e-2),
    (5.0, inf, None, 3.0),
    (30.0, 1e4, 1e4, None),
    (12.0, 200.0, 20.0, None),
    (-10.0, 1e4, 1e2, None),
    (30.0, 1e4, inf, None),
    (30.0, None, None, None),
    (15.0, None, None, None),
    (0.0, None, None, None),
]


def rod_on(path, epsilon):
    F, *rest = path
    stiff = 1 / epsilon if epsilon else inf
    return F, *(small if x is None else x for x, small in zip(rest, (stiff, stiff, epsilon), strict=True))


def rate_of(epsilon):
    """1/(1/epsilon) as the rod has it: the float k is not quite 1/epsilon."""
    return float(mp.mpf(1) / mp.mpf(1 / epsilon))


def tending(path):
    return [name for name, x in zip(COMPLIANCES, path[1:], strict=True) if x is None]


def eigenvalue_slope(path, w):
    """dw/depsilon at the limit, to all digits."""
    D_w, *changes = derivatives(w, rod_on(path, 0.0), ["w", *tending(path)])
    return -sum(changes) / D_w


def hopf_slope(path, w):
    """dF/depsilon along which the eigenvalue w = i eta stays on the imaginary axis."""
    D_w, D_F, *changes = derivatives(w, rod_on(path, 0.0), ["w", "F", *tending(path)])
    return -mp.re(sum(changes) / D_w) / mp.re(D_F / D_w)


def onset_slope(path, w):
    """dF/depsilon along which w stays double: D_w = 0 leaves dD = D_F dF + D_epsilon depsilon."""
    D_F, *changes = derivatives(w, rod_on(path, 0.0), ["F", *tending(path)])
    return -sum(changes) / D_F
