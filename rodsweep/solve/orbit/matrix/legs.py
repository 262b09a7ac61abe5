"""Legs of a strongly unstable orbit: runs of intervals over which perturbations grow moderately.

The map P over all intervals multiplies rounding errors by the growth of perturbations. Cycles with many
unstable modes reach 1e15, where Newton's steps have no correct digit. With the start of every leg as an
unknown (multiple shooting; Ascher, Mattheij & Russell 1995, ch. 4), errors grow over one leg only.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import schur

from ....arrays import Array, Complex
from ..orbit import Orbit
from ..semidiscrete import Semidiscrete
from .substitution import substitute, to_end
from .workspace import Factors


@dataclass(frozen=True, slots=True, kw_only=True)
class LegSettings:
    """Settings for the legs of an orbit."""

    max_growth: float = 1e7
    """Largest norm of the map of a leg: a Newton step keeps nine digits. Stable cycles have norms below 1e3,
    and a single leg."""
    sweeps: int = 2
    """Sweeps of the orthogonal iteration that orders directions by their growth over all legs; the second
    one starts with directions that are in order."""
    negligible_multiplier: float = 1e-17
    """Largest modulus of a multiplier that counts as 0."""


LEGS = LegSettings()


@dataclass(frozen=True, eq=False)
class Legs:
    """Legs of an orbit. edges: first interval of each leg, and the number of intervals, m + 1 numbers. maps:
    from the start of each leg to its end, (m, n, n)."""

    edges: tuple[int, ...]
    maps: Array

    def ends(self, factors: Factors, columns: Array, whole: Array, p: Semidiscrete) -> Array:
        """Changes of the ends of all legs by right sides for fixed starts, (m, columns, n).

        columns: reduced right sides, (K, s, columns, n). whole: change of the end of the last interval for a
        fixed start of the first interval, (columns, n).
        """
        ends = np.zeros((len(self.maps), *whole.shape))
        if len(ends) == 1:
            return whole[None]
        columns = np.ascontiguousarray(columns)
        for end, (first, last) in zip(ends, pairwise(self.edges), strict=True):
            for k in range(first, last):
                to_end(factors.blocks[k], columns[k], p, end)
        return ends

    def substituted(self, factors: Factors, starts: Array, columns: Array, p: Semidiscrete) -> Array:
        """Changes of all stages, (K, s, 1, n), from changes of the starts, (m, n), and reduced right sides,
        (K, s, 1, n)."""
        out = np.empty_like(columns)
        for start, (first, last) in zip(starts, pairwise(self.edges), strict=True):
            part = factors._replace(blocks=factors.blocks[first:last])
            substitute(start[None], columns[first:last], p, part, out[first:last])
        return out

    def multipliers(self, orbit: Orbit) -> Complex:
        """Nonzero multipliers of the map S^-1 P over the solved part of the period, (rank,).

        P is never formed: it would lose the digits of the multipliers far below its norm. Orthogonal
        iteration makes the map triangular, with rows graded by the growth. Raises LinAlgError if an entry is
        not finite.
        """
        *others, last = self.maps
        ahead = triangle = np.eye(len(last))
        for _ in range(LEGS.sweeps):
            # Directions that vanish over a period would only cost time.
            lasting = np.flatnonzero(np.abs(np.diag(triangle)) > LEGS.negligible_multiplier)
            start = ahead = ahead[:, : lasting[-1] + 1] if len(lasting) else ahead
            triangle = np.eye(start.shape[1])
            for A in (*others, orbit.symmetry.returned(last, orbit.form.layout)):
                ahead, R = np.linalg.qr(A @ ahead)
                triangle = R @ triangle
        # The map is `ahead triangle start^T`, which is similar to this matrix.
        graded = triangle @ (start.T @ ahead)
        if not np.isfinite(graded).all():
            raise np.linalg.LinAlgError("the derivative of the flow is not finite")
        # `eigvals` would balance the matrix and so undo the grading: multipliers near 1 lost nine digits.
        values = np.diag(schur(graded, output="complex")[0])
        return values[np.abs(values) > LEGS.negligible_multiplier]


def legs_of(factors: Factors, mass: Array) -> Legs:
    """The longest legs of an eliminated matrix whose maps have moderate norms. mass: M, (n,)."""
    blocks = factors.blocks
    if not np.linalg.norm(factors.propagator) > LEGS.max_growth:  # nor for nan, which no legs help
        return Legs((0, len(blocks)), factors.propagator[None])
    firsts = [0]
    maps = [blocks[0, 0, 1] * mass]
    for k in range(1, len(blocks)):
        longer = blocks[k, 0, 1] @ (mass[:, None] * maps[-1])
        if np.linalg.norm(longer) <= LEGS.max_growth:
            maps[-1] = longer
        else:
            firsts.append(k)
            maps.append(blocks[k, 0, 1] * mass)
    return Legs((*firsts, len(blocks)), np.array(maps))
