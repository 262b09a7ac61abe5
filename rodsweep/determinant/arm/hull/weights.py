"""Bounds of the norms that determine the hull, the region that contains the spectrum of an arm, from constant
or smooth weights alpha (`rodsweep.determinant.arm.hull.hull`). coefficients: nu, c2, c3, gamma2, gamma3 and g
= nu + F c2, along the first axis."""

from math import exp, inf, log, sqrt

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled
from .averaged_weight import squared_block_norm
from .region import HULL_SETTINGS


@compiled
def smallest_squared_norm(alphas: Array, coefficients: Array, max_weighted_force: float) -> float:
    """The smallest a^2 of the constant weights `alphas`, (n,). a: largest norm, along all arms, of the matrix
    given in `rodsweep.determinant.arm.hull.hull`. coefficients: nu, c2, c3, gamma2, gamma3 and g at all
    points, (6, points). max_weighted_force: the largest F^2 c3/gamma2 at these points."""
    smallest = inf
    for alpha in alphas:
        largest_norm = alpha * max_weighted_force
        for i in range(coefficients.shape[1]):
            nu, c2, _, _, gamma3, g = coefficients[:, i]
            if c2 > 0:
                largest_norm = max(largest_norm, (g - alpha * nu) ** 2 / (gamma3 * alpha * c2))
            elif alpha != 1:  # where c2 = 0 is g = nu
                largest_norm = inf
            if largest_norm >= smallest:
                break
        smallest = min(smallest, largest_norm)
    return smallest


@compiled
def trial_constant_weights(coefficients: Array) -> Array:
    """Constant weights alpha to try, (HULL_SETTINGS.constant_weight_count + 1,): a geometric progression from
    the smallest to the largest |g/nu| along the arms, none below `min_constant_weight`, and the weight 1.
    coefficients: nu, c2, c3, gamma2, gamma3 and g of n arms, (6, n, pieces, points)."""
    ratio = np.abs(coefficients[5] / coefficients[0])
    start = log(max(ratio.min(), HULL_SETTINGS.min_constant_weight))
    # At least twice the smallest weight, so that the progression has a length even if all ratios are tiny.
    log_max = log(max(ratio.max(), 2 * HULL_SETTINGS.min_constant_weight))
    alphas = np.ones(HULL_SETTINGS.constant_weight_count + 1)
    for k in range(HULL_SETTINGS.constant_weight_count):
        alphas[k] = exp(start + (log_max - start) * k / (HULL_SETTINGS.constant_weight_count - 1))
    return alphas


@compiled
def squared_norms_of_varying_weights(
    F: Array, lengths: Array, coefficients: Array, derivative: Array
) -> Array:
    """For each weight alpha(u) = g/(nu + f |F| sqrt(c2 c3 gamma3/gamma2)), f from
    `HULL_SETTINGS.load_term_factors`, a^2: the largest squared norm, along all arms, of the matrix given in
    `rodsweep.determinant.arm.hull.hull`, (factors,).

    F: forces of n arms, (n,). lengths: lengths of the intervals between breaks of the profile, (pieces,).
    coefficients: nu, c2, c3, gamma2, gamma3 and g, (6, n, pieces, points). derivative: differentiation matrix
    of `ChebyshevMatrices`, (points, points).
    """
    squared_norms = np.zeros(len(HULL_SETTINGS.load_term_factors))
    points = coefficients.shape[3]
    level = np.empty(points)
    log_alpha = np.empty(points)
    for m in range(len(HULL_SETTINGS.load_term_factors)):
        for arm in range(len(F)):
            for interval in range(len(lengths)):
                for i in range(points):
                    nu, c2, c3, gamma2, gamma3, g = coefficients[:, arm, interval, i]
                    level[i] = (
                        HULL_SETTINGS.load_term_factors[m] * abs(F[arm]) * sqrt(c2 * c3 * gamma3 / gamma2)
                    )
                    log_alpha[i] = log(g / (nu + level[i]))
                for i in range(points):
                    nu, c2, c3, gamma2, gamma3, g = coefficients[:, arm, interval, i]
                    alpha = g / (nu + level[i])
                    slope = (derivative[i] @ log_alpha) * 2 / lengths[interval]
                    A2 = slope * slope / (gamma2 * c2)
                    B2 = F[arm] * F[arm] * alpha * c3 / gamma2
                    # The difference g - alpha nu itself would cancel where the load is small.
                    e = alpha * level[i]  # g - alpha nu
                    squared_norms[m] = max(
                        squared_norms[m], squared_block_norm(A2, B2, e, gamma3 * alpha * c2)
                    )
    return squared_norms


@compiled
def four_c_squared_from_clamp(
    alphas: Array, F: Array, lengths: Array, coefficients: Array, integral: Array
) -> Array:
    """4 c^2 = int (g - alpha nu)^2/(alpha c2) (int_0^u c3) du, largest of all arms, for each constant alpha,
    (alphas,).

    c bounds the term with theta by the clamp theta(0) = 0, without rotational drag
    (`rodsweep.determinant.arm.hull.hull`). F: forces, (n,). lengths: lengths of the intervals between breaks,
    (pieces,). coefficients: nu, c2, c3, gamma2, gamma3 and g, (6, n, pieces, points). integral: matrix of
    `ChebyshevMatrices`.
    """
    squared_integrals = np.zeros(len(alphas))
    points = coefficients.shape[3]
    weights = np.empty((len(lengths), points))
    for arm in range(len(F)):
        compliance_before_interval = 0.0  # integral of c3
        for interval in range(len(lengths)):
            half = lengths[interval] / 2
            compliance_integral = integral @ coefficients[2, arm, interval] * half
            weights[interval] = integral[-1] * half * (compliance_before_interval + compliance_integral)
            compliance_before_interval += compliance_integral[-1]
        for k in range(len(alphas)):
            alpha = alphas[k]
            total = 0.0
            for interval in range(len(lengths)):
                for i in range(points):
                    nu = coefficients[0, arm, interval, i]
                    c2 = coefficients[1, arm, interval, i]
                    if c2 > 0:  # g = nu + F c2
                        e = (1 - alpha) * nu + F[arm] * c2
                        total += e * e / (alpha * c2) * weights[interval, i]
            squared_integrals[k] = max(squared_integrals[k], total)
    return squared_integrals
