"""A convex region that contains every transverse eigenvalue of an arm with profiles and any law.

Testing the eigenproblem with alpha(u) y* and theta*, alpha > 0 continuous, gives with N^2 = int alpha gamma2
|y|^2 + gamma3 |theta|^2 and n^2 N^2 = int alpha c2 |s|^2 + c3 |m|^2

    w N^2 = -n^2 N^2 + int (g - alpha nu) theta* s - F int alpha c3 y* m - int alpha' y* s.

The last three terms are at most a n N^2, where a is the largest norm of the matrix

    [[alpha'/(alpha sqrt(gamma2 c2)), F sqrt(alpha c3/gamma2)], [(g - alpha nu)/sqrt(gamma3 alpha c2), 0]]

along the arm. For gamma3 = 0 the clamp, theta(0) = 0, bounds the term with theta by c n^2 N^2 with
4 c^2 = int (g - alpha nu)^2/(alpha c2) (int_0^u c3) du. Both bounds give, for some n >= 0,

    Re w <= a n - (1 - c) n^2,   |Im w| <= a n + c n^2,

a convex region bounded by a parabola. The smallest region over several alpha is chosen. For a uniform rod,
alpha = g/(nu + |F| sqrt(c2 c3 gamma3/gamma2)) gives the region of `rodsweep.determinant.certificate.box`.

Extremes along the arm are evaluated at points between the breaks, with the safety factor `HULL_MARGIN`.
"""

from collections.abc import Iterator
from functools import cache
from math import inf, isfinite, sqrt
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.material.build import LocalCoefficients
from ...model.rod import Rod

CHEBYSHEV_POINTS = 25
"""Chebyshev points of each smooth piece, for evaluating coefficients and differentiating alpha."""
HULL_MARGIN = 1.05
"""Safety factor on a and c, for extremes between the points and for rounding."""
INSIDE = 1e-9
"""Distance of the first and last point from the ends of a piece, in units of the piece's length."""
LARGEST_C = 0.9
"""Largest useful c: the region grows without bound as c approaches 1."""
MIDDLES = (0.0, 0.5, 1.0)
"""Trial factors of |F| sqrt(c2 c3 gamma3/gamma2) in alpha."""
WEIGHTS = 41
"""Number of constant weights alpha to try, between the smallest and the largest g/nu."""
DIRECTIONS = 48
"""Number of normals of the region to try for the distance of a point."""


class Hull(NamedTuple):
    """The region Re w <= a n - (1 - c) n^2, |Im w| <= a n + c n^2, n >= 0; a = inf if no bound is known."""

    a: float
    c: float

    def box(self, depth: float = 0.0) -> tuple[float, float]:
        """(max Re w, max |Im w|) of the eigenvalues with Re w >= -depth, depth >= 0."""
        a = self.a
        b = 1 - self.c
        n = (a + sqrt(a * a + 4 * b * depth)) / (2 * b)
        # A pad in proportion to the depth keeps the box open where F = 0 makes the bound vanish.
        pad = 0.01 * depth + 1e-6
        return a * a / (4 * b) + pad, a * n + self.c * n * n + pad


UNKNOWN = Hull(inf, 0.0)
"""The whole plane, when no bound applies."""


@compiled
def clearance(w: complex, a: float, c: float) -> tuple[float, complex]:
    """(distance, normal): lower bound of the distance of w, Im w >= 0, from the hull; unit normal towards w.

    The distance is at most 0 for w inside. <normal, w - v> >= distance for every v in the hull.
    """
    b = 1 - c
    best = -inf
    normal = 1 + 0j
    for k in range(DIRECTIONS):
        # The support function grows without bound as the normal approaches the imaginary axis.
        T = (k / (DIRECTIONS - k)) ** 2
        if not c * T < b:
            break
        size = sqrt(1 + T * T)
        support = a * a * (1 + T) * (1 + T) / (4 * (b - c * T))
        distance = (w.real + T * w.imag - support) / size
        if distance > best:
            best = distance
            normal = complex(1 / size, T / size)
    return best, normal


def hull_of(rod: Rod) -> Hull:
    """The smallest known region that contains the spectrum of the arm; `UNKNOWN` without a bound."""
    pieces = _pieces(rod)
    candidates = [*_constant(rod.F, pieces), *_following(rod, pieces), *_by_clamp(rod.F, pieces)]
    best = min(candidates, key=lambda hull: hull.a**2 / (1 - hull.c), default=UNKNOWN)
    return Hull(HULL_MARGIN * best.a, best.c) if isfinite(best.a) else UNKNOWN


class Piece(NamedTuple):
    """Coefficients at the Chebyshev points of a smooth piece, increasing u, (CHEBYSHEV_POINTS,)."""

    u: Array
    local: LocalCoefficients


def _pieces(rod: Rod) -> list[Piece]:
    x = -np.cos(np.pi * np.arange(CHEBYSHEV_POINTS) / (CHEBYSHEV_POINTS - 1)) * (1 - 2 * INSIDE)
    breaks = rod.build.breaks
    grids = [a + (b - a) * (x + 1) / 2 for a, b in zip(breaks[:-1], breaks[1:], strict=True)]
    return [Piece(u, rod.local(u)) for u in grids]


def _joined(pieces: list[Piece]) -> LocalCoefficients:
    """The coefficients of all pieces, concatenated."""
    return LocalCoefficients(*(np.concatenate(rows) for rows in zip(*(p.local for p in pieces), strict=True)))


def _constant(F: float, pieces: list[Piece]) -> Iterator[Hull]:
    """The regions for constant alpha; no region if an arm with shear has gamma3 = 0 somewhere."""
    nu, c2, c3, gamma2, gamma3, g = _joined(pieces)
    push = F**2 * float((c3 / gamma2).max())
    if not c2.any():  # then g = nu
        yield Hull(sqrt(push), 0.0)
        return
    if not gamma3.all():
        return
    ratio = np.abs(g / nu)
    between = np.geomspace(max(float(ratio.min()), 1e-3), max(float(ratio.max()), 2e-3), WEIGHTS)
    alphas = np.append(between, 1.0)
    turns = ((g - alphas[:, None] * nu) ** 2 / (gamma3 * alphas[:, None] * c2)).max(axis=1)
    yield Hull(sqrt(float(np.maximum(alphas * push, turns).min())), 0.0)


def _following(rod: Rod, pieces: list[Piece]) -> Iterator[Hull]:
    """The regions for alpha = g/(nu + ...); no region unless g > 0 and alpha has no jumps."""
    nu, c2, _, _, _, g = _joined(pieces)
    if not (g > 0).all() or not (c2 > 0).all() or not rod.build.continuous:
        return
    for factor in MIDDLES:
        yield Hull(max(_norm(rod.F, piece, factor) for piece in pieces), 0.0)


def _norm(F: float, piece: Piece, factor: float) -> float:
    """The largest norm of the matrix along a piece, with `factor` of `MIDDLES` in alpha."""
    nu, c2, c3, gamma2, gamma3, g = piece.local
    level = factor * abs(F) * np.sqrt(c2 * c3 * gamma3 / gamma2)
    alpha = g / (nu + level)
    slope = _chebyshev()[0] @ np.log(alpha) * 2 / (piece.u[-1] - piece.u[0])
    A = slope / np.sqrt(gamma2 * c2)
    B = F * np.sqrt(alpha * c3 / gamma2)
    e = g * level / (nu + level)  # g - alpha nu, which is 0 where gamma3 is
    C = np.where(e == 0, 0.0, e / np.sqrt(np.where(e == 0, 1.0, gamma3 * alpha * c2)))
    total = A**2 + B**2 + C**2
    product = B * C
    largest = (total + np.sqrt(np.maximum(total**2 - 4 * product**2, 0.0))) / 2
    return sqrt(float(largest.max()))


@cache
def _chebyshev() -> tuple[Array, Array]:
    """Matrices (derivative, integral from -1) of the interpolant through the points in [-1, 1]."""
    x = -np.cos(np.pi * np.arange(CHEBYSHEV_POINTS) / (CHEBYSHEV_POINTS - 1))
    to_series = np.linalg.inv(np.polynomial.chebyshev.chebvander(x, CHEBYSHEV_POINTS - 1))
    slopes = np.polynomial.chebyshev.chebder(to_series)
    integrals = np.polynomial.chebyshev.chebint(to_series, lbnd=-1)
    derivative = np.polynomial.chebyshev.chebvander(x, CHEBYSHEV_POINTS - 2) @ slopes
    return derivative, np.polynomial.chebyshev.chebvander(x, CHEBYSHEV_POINTS) @ integrals


def _by_clamp(F: float, pieces: list[Piece]) -> Iterator[Hull]:
    """The region for alpha = 1 and theta(0) = 0, without rotational drag; no region if c is too large."""
    below = 0.0  # int_0^u c3 du at the start of the piece
    integral = 0.0  # 4 c^2/F^2: for alpha = 1, g - alpha nu = F c2
    for u, (_, c2, c3, _, _, _) in pieces:
        along = _chebyshev()[1] * (u[-1] - u[0]) / 2
        turned = below + along @ c3
        integral += float(along[-1] @ (c2 * turned))
        below = float(turned[-1])
    c = HULL_MARGIN * abs(F) * sqrt(max(integral, 0.0)) / 2
    local = _joined(pieces)
    if c < LARGEST_C:
        yield Hull(abs(F) * sqrt(float((local.c3 / local.gamma2).max())), c)
