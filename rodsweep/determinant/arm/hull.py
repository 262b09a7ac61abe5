"""A convex region that contains every transverse eigenvalue of an arm with profiles and any law.

Testing the eigenproblem with alpha(u) y* and theta*, alpha > 0 continuous, gives with N^2 = int alpha gamma2
|y|^2 + gamma3 |theta|^2 and n^2 N^2 = int alpha c2 |s|^2 + c3 |m|^2

    w N^2 = -n^2 N^2 + int (g - alpha nu) theta* s - F int alpha c3 y* m - int alpha' y* s.

The last three terms are at most a n N^2, where a is the largest norm of the matrix

    [[alpha'/(alpha sqrt(gamma2 c2)), F sqrt(alpha c3/gamma2)], [(g - alpha nu)/sqrt(gamma3 alpha c2), 0]]

along the arm. Where gamma3 is small the term with theta is better bounded by theta(0) = 0: it is at most
c n^2 N^2 with 4 c^2 = int (g - alpha nu)^2/(alpha c2) (int_0^u c3) du. Both give, for some n >= 0,

    Re w <= a n - (1 - c) n^2,   |Im w| <= a n + c n^2,

a convex region bounded by a parabola. Of several alpha the one with the smallest region is taken. With alpha
= g/(nu + |F| sqrt(c2 c3 gamma3/gamma2)) the region of a uniform rod is that of
`rodsweep.determinant.certificate.box`.

Extremes along the arm are looked up at points between the breaks, with `HULL.margin` for those between.
"""

from collections.abc import Iterator, Sequence
from functools import cache
from math import inf, isfinite, log, sqrt
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.material.build import LocalCoefficients
from ...model.rod import Rod
from .averaged_weight import AVERAGED_WEIGHT, averaged_regions, squared_norm
from .region import HULL, UNKNOWN, Hull, Hulls


def hull_of(rod: Rod) -> Hull:
    """The smallest known region that contains the spectrum of the arm; `UNKNOWN` without a bound."""
    return _hull(_arms([rod]))


def hulls_along(rods: Sequence[Rod], places: Array) -> Hulls:
    """The regions for all arms between places of a path, (k,), from the arms at them.

    Extremes along the path are, as those along an arm, looked up at points, with `HULL.margin` between them.
    """
    arms = _arms(rods)
    hulls = [_hull(_part(arms, slice(i, i + 2))) for i in range(len(rods) - 1)]
    return Hulls(places, np.array([hull.a for hull in hulls]), np.array([hull.c for hull in hulls]))


def _hull(arms: "Arms") -> Hull:
    candidates = [*_constant(arms), *_following(arms), *_averaged(arms), *_by_clamp(arms)]
    best = min(candidates, key=lambda hull: _size(*hull), default=UNKNOWN)
    return Hull((1 + HULL.margin) * best.a, best.c) if isfinite(best.a) else UNKNOWN


def _size(a: Any, c: Any) -> Any:
    """A measure of regions, numbers or arrays: its least is the region that is taken."""
    return a**2 * (1 + (c / HULL.wide) ** 4)


class Arms(NamedTuple):
    """n arms: F, (n, 1, 1); lengths of the smooth pieces, (pieces,); coefficients, (n, pieces, points).

    The points of a piece are its Chebyshev points, with increasing u. averaged: `averaged_regions` of each,
    (n, trials, 2), inf for an arm that allows none, without trials for arms without jumps.
    """

    F: Array
    lengths: Array
    local: LocalCoefficients
    continuous: bool
    averaged: Array


def _arms(rods: Sequence[Rod]) -> Arms:
    x = -np.cos(np.pi * np.arange(HULL.points) / (HULL.points - 1)) * (1 - 2 * HULL.inside)
    build = rods[0].build
    lengths = np.diff(build.breaks)
    u = build.breaks[:-1, None] + lengths[:, None] * (x + 1) / 2
    F = np.array([rod.F for rod in rods])[:, None, None]
    lengths = lengths * (1 - 2 * HULL.inside)
    local = Rod.local_of_all(rods, u)
    averaged = np.empty((len(rods), 0, 2)) if build.continuous else _averaged_of_each(F, lengths, local)
    return Arms(F, lengths, local, build.continuous, averaged)


def _averaged_of_each(F: Array, lengths: Array, local: LocalCoefficients) -> Array:
    """`Arms.averaged` of arms with jumps, from their other fields."""
    starts = np.cumsum(lengths) - lengths
    x = -np.cos(np.pi * np.arange(HULL.points) / (HULL.points - 1)) * (1 - 2 * HULL.inside)
    u = (starts[:, None] + lengths[:, None] * (x + 1) / 2).ravel()
    along = np.stack(local).reshape(6, len(F), -1)
    regions = np.full((len(F), AVERAGED_WEIGHT.trials, 2), inf)
    for i in np.flatnonzero(((along[5] > 0) & (along[1] > 0)).all(axis=1)).tolist():
        regions[i] = averaged_regions(u, along[:, i], float(F[i, 0, 0]))
    return regions


def _part(arms: Arms, chosen: slice) -> Arms:
    """Some of the arms."""
    local = LocalCoefficients(*(x[chosen] for x in arms.local))
    return arms._replace(F=arms.F[chosen], local=local, averaged=arms.averaged[chosen])


def _constant(arms: Arms) -> Iterator[Hull]:
    """The regions for constant alpha; no region if an arm with shear has gamma3 = 0 somewhere."""
    nu, c2, c3, gamma2, gamma3, g = (x.ravel() for x in arms.local)
    push = float((arms.F**2 * arms.local.c3 / arms.local.gamma2).max())
    if not c2.any():  # then g = nu
        yield Hull(sqrt(push), 0.0)
        return
    if not gamma3.all():
        return
    square = _least_square(_constants(g / nu), np.array(arms.local).reshape(6, -1), push)
    yield Hull(sqrt(square), 0.0)


@compiled
def _least_square(alphas: Array, local: Array, push: float) -> float:
    """The least squared norm of the matrix for a constant alpha, of those to try, (n,).

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
        least = min(least, largest)
    return least


def _constants(ratio: Array) -> Array:
    """Constant alpha that are tried, (HULL.weights + 1,), for ratios g/nu along arms, (...,)."""
    sizes = np.abs(ratio)
    ends = np.log(np.maximum([sizes.min(), sizes.max()], (HULL.least_ratio, 2 * HULL.least_ratio)))
    return np.append(
        np.exp(ends[0] + (ends[1] - ends[0]) * np.arange(HULL.weights) / (HULL.weights - 1)), 1.0
    )


def _following(arms: Arms) -> Iterator[Hull]:
    """The regions for alpha = g/(nu + ...); no region unless g > 0 and alpha has no jumps."""
    if not (arms.local.g > 0).all() or not (arms.local.c2 > 0).all() or not arms.continuous:
        return
    for square in _squares_following(arms.F.ravel(), arms.lengths, np.array(arms.local), _chebyshev()[0]):
        yield Hull(sqrt(square), 0.0)


def _averaged(arms: Arms) -> Iterator[Hull]:
    """The best region for alpha averaged over windows; no region unless alpha has jumps and g > 0."""
    if arms.continuous:
        return
    a, c = arms.averaged.max(axis=0).T
    c = (1 + HULL.margin) * c
    with np.errstate(invalid="ignore"):
        best = int(np.argmin(np.where(c < 1 - HULL.least_remainder, _size(a, c), inf)))
    if c[best] < 1 - HULL.least_remainder:
        yield Hull(float(a[best]), float(c[best]))


@compiled
def _squares_following(F: Array, lengths: Array, local: Array, derivative: Array) -> Array:
    """The largest squared norm of the matrix along arms for each of `HULL.middles`.

    F: (n,). lengths: (pieces,). local: coefficients, (6, n, pieces, points). derivative: (points, points).
    """
    found = np.zeros(len(HULL.middles))
    points = local.shape[3]
    level = np.empty(points)
    log_alpha = np.empty(points)
    for m in range(len(HULL.middles)):
        for arm in range(len(F)):
            for piece in range(len(lengths)):
                for i in range(points):
                    nu, c2, c3, gamma2, gamma3, g = local[:, arm, piece, i]
                    level[i] = HULL.middles[m] * abs(F[arm]) * sqrt(c2 * c3 * gamma3 / gamma2)
                    log_alpha[i] = log(g / (nu + level[i]))
                for i in range(points):
                    nu, c2, c3, gamma2, gamma3, g = local[:, arm, piece, i]
                    alpha = g / (nu + level[i])
                    slope = (derivative[i] * log_alpha).sum() * 2 / lengths[piece]
                    A2 = slope * slope / (gamma2 * c2)
                    B2 = F[arm] * F[arm] * alpha * c3 / gamma2
                    e = alpha * level[i]  # g - alpha nu
                    found[m] = max(found[m], squared_norm(A2, B2, e, gamma3 * alpha * c2))
    return found


@cache
def _chebyshev() -> tuple[Array, Array]:
    """Matrices (derivative, integral from -1) of the interpolant through the points in [-1, 1]."""
    x = -np.cos(np.pi * np.arange(HULL.points) / (HULL.points - 1))
    to_series = np.linalg.inv(np.polynomial.chebyshev.chebvander(x, HULL.points - 1))
    slopes = np.polynomial.chebyshev.chebder(to_series)
    integrals = np.polynomial.chebyshev.chebint(to_series, lbnd=-1)
    derivative = np.polynomial.chebyshev.chebvander(x, HULL.points - 2) @ slopes
    return derivative, np.polynomial.chebyshev.chebvander(x, HULL.points) @ integrals


def _by_clamp(arms: Arms) -> Iterator[Hull]:
    """The regions by constant alpha and theta(0) = 0, which need no rotational drag."""
    nu, c2, c3, gamma2, _, g = arms.local
    lengths = arms.lengths[:, None]
    along = c3 @ _chebyshev()[1].T * lengths / 2  # integrals of c3 from the start of each piece
    below = np.cumsum(along[..., -1:], axis=1) - along[..., -1:]
    weights = _chebyshev()[1][-1] * lengths / 2 * (below + along)
    alphas = _constants(g / nu) if c2.all() else np.ones(1)
    along_arms = np.array([nu, c2, arms.F * c2, weights]).reshape(4, len(arms.F), -1)
    integrals = _largest_integrals(alphas, along_arms)
    push = float((arms.F**2 * c3 / gamma2).max())
    c = (1 + HULL.margin) * np.sqrt(integrals) / 2
    a = np.sqrt(alphas * push)
    best = int(np.argmin(np.where(c < 1 - HULL.least_remainder, _size(a, c), inf)))
    if c[best] < 1 - HULL.least_remainder:
        yield Hull(float(a[best]), float(c[best]))


@compiled
def _largest_integrals(alphas: Array, along_arms: Array) -> Array:
    """The largest 4 c^2 of n arms for each constant alpha to try, (trials,).

    along_arms: nu, c2, F c2 and weights of the integral along the arm, (4, n, points).
    """
    found = np.zeros(len(alphas))
    for k in range(len(alphas)):
        alpha = alphas[k]
        for arm in range(along_arms.shape[1]):
            total = 0.0
            for i in range(along_arms.shape[2]):
                nu, c2, pull, weight = along_arms[:, arm, i]
                if c2 > 0:
                    total += ((1 - alpha) * nu + pull) ** 2 / (alpha * c2) * weight  # g = nu + pull
            found[k] = max(found[k], total)
    return found
