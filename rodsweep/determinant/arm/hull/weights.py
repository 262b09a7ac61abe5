"""Bounds for the hull of `rodsweep.determinant.arm.hull.hull`, from constant or smoothly varying weights
alpha.
"""

from math import exp, inf, log, sqrt

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled
from .averaged_weight import squared_block_norm
from .region import HULL_SETTINGS


@compiled
def least_squared_norm(alphas: Array, local: Array, push: float) -> float:
    """The smallest a^2 of the constant weights `alphas`, (n,). a: largest norm, along all arms, of the matrix
    given in `rodsweep.determinant.arm.hull.hull`.

    local: coefficients at all points, (6, points). push: the largest F^2 c3/gamma2.
    """
    least = inf
    for alpha in alphas:
        largest = alpha * push
        for i in range(local.shape[1]):
            nu, c2, _, _, gamma3, g = local[:, i]
            if c2 > 0:
                largest = max(largest, (g - alpha * nu) ** 2 / (gamma3 * alpha * c2))
            elif alpha != 1:  # where c2 = 0 is g = nu
                largest = inf
            if largest >= least:
                break
        least = min(least, largest)
    return least


@compiled
def trial_constant_weights(local: Array) -> Array:
    """Constant weights alpha to try, (HULL_SETTINGS.constant_weight_count + 1,): a geometric
    progression from the smallest to the largest |g/nu| along the arms, none below `min_weight`, and 1.

    local: coefficients, (6, n, pieces, points).
    """
    ratio = np.abs(local[5] / local[0])
    start = log(max(ratio.min(), HULL_SETTINGS.min_weight))
    stop = log(max(ratio.max(), 2 * HULL_SETTINGS.min_weight))
    alphas = np.ones(HULL_SETTINGS.constant_weight_count + 1)
    for k in range(HULL_SETTINGS.constant_weight_count):
        alphas[k] = exp(start + (stop - start) * k / (HULL_SETTINGS.constant_weight_count - 1))
    return alphas


@compiled
def varying_weight_norms(F: Array, lengths: Array, local: Array, derivative: Array) -> Array:
    """a^2 of each weight alpha(u) = g/(nu + f |F| sqrt(c2 c3 gamma3/gamma2)), f from
    `HULL_SETTINGS.weight_factors`: the largest squared norm of the hull's matrix along all arms, (factors,).

    F: (n,). lengths: (pieces,). local: coefficients, (6, n, pieces, points). derivative: (points, points),
    matrix of `ChebyshevMatrices`.
    """
    found = np.zeros(len(HULL_SETTINGS.weight_factors))
    points = local.shape[3]
    level = np.empty(points)
    log_alpha = np.empty(points)
    for m in range(len(HULL_SETTINGS.weight_factors)):
        for arm in range(len(F)):
            for piece in range(len(lengths)):
                for i in range(points):
                    nu, c2, c3, gamma2, gamma3, g = local[:, arm, piece, i]
                    level[i] = HULL_SETTINGS.weight_factors[m] * abs(F[arm]) * sqrt(c2 * c3 * gamma3 / gamma2)
                    log_alpha[i] = log(g / (nu + level[i]))
                for i in range(points):
                    nu, c2, c3, gamma2, gamma3, g = local[:, arm, piece, i]
                    alpha = g / (nu + level[i])
                    slope = (derivative[i] @ log_alpha) * 2 / lengths[piece]
                    A2 = slope * slope / (gamma2 * c2)
                    B2 = F[arm] * F[arm] * alpha * c3 / gamma2
                    e = alpha * level[i]  # g - alpha nu
                    found[m] = max(found[m], squared_block_norm(A2, B2, e, gamma3 * alpha * c2))
    return found


@compiled
def clamp_integrals(alphas: Array, F: Array, lengths: Array, local: Array, integral: Array) -> Array:
    """4 c^2 = int (g - alpha nu)^2/(alpha c2) (int_0^u c3) du, largest of all arms, for each constant alpha,
    (alphas,).

    c bounds the term with theta by the clamp theta(0) = 0, without rotational drag
    (`rodsweep.determinant.arm.hull.hull`). F, lengths, local: as in `HullSamples`. integral: matrix of
    `ChebyshevMatrices`.
    """
    found = np.zeros(len(alphas))
    points = local.shape[3]
    weights = np.empty((len(lengths), points))
    for arm in range(len(F)):
        below = 0.0  # integral of c3
        for piece in range(len(lengths)):
            half = lengths[piece] / 2
            along = integral @ local[2, arm, piece] * half
            weights[piece] = integral[-1] * half * (below + along)
            below += along[-1]
        for k in range(len(alphas)):
            alpha = alphas[k]
            total = 0.0
            for piece in range(len(lengths)):
                for i in range(points):
                    nu = local[0, arm, piece, i]
                    c2 = local[1, arm, piece, i]
                    if c2 > 0:  # g = nu + F c2
                        e = (1 - alpha) * nu + F[arm] * c2
                        total += e * e / (alpha * c2) * weights[piece, i]
            found[k] = max(found[k], total)
    return found
