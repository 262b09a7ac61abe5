"""Profiles along the arm: factors of stiffnesses and drags as functions of the material coordinate u.

A profile is a table. Between two rows each factor is a monotone cubic (Fritsch and Carlson, 1980), which
stays between its end values; two rows at one u are a jump. A taper t multiplies the factors by those of a
circular cone of radius r(u) = 1 - (1 - t) u: k1, k2 ~ r^2, k3 ~ r^4, gamma3 ~ r^2. The drags gamma1 and
gamma2 of a cone vary only by a logarithm, which is neglected.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array

FACTORS = ("k1", "k2", "k3", "gamma1", "gamma2", "gamma3")
"""Columns of a profile beside u, in this order."""
RADIUS_POWERS = {"k1": 2, "k2": 2, "k3": 4, "gamma3": 2}
"""Power of the radius in each factor of a cone; 0 where none is given."""


@dataclass(frozen=True)
class Profile:
    """A table of factors. Compares and hashes by its values.

    u: increasing from 0 to 1, a value twice at a jump. rows: the factors of `FACTORS` at each u, above 0.
    Raises ValueError, in a sentence, for a table that is no profile.
    """

    u: tuple[float, ...]
    rows: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        if len(self.u) < 2 or self.u[0] != 0 or self.u[-1] != 1:
            raise ValueError("the first row must be at u = 0 and the last at u = 1")
        for a, b in zip(self.u[:-1], self.u[1:], strict=True):
            if not a <= b:
                raise ValueError(f"u = {b:g} follows u = {a:g}; u must not decrease")
        for number, value in enumerate(self.u):
            if self.u.count(value) > (1 if value in (0, 1) else 2):
                most = "one row" if value in (0, 1) else "two rows, which are a jump"
                raise ValueError(
                    f"there are {self.u.count(value)} rows at u = {value:g}; there may be {most}"
                )
            for name, factor in zip(FACTORS, self.rows[number], strict=True):
                if not 0 < factor < np.inf:
                    raise ValueError(
                        f"the factor of {name} at u = {value:g} is {factor:g}; it must be finite and above 0"
                    )

    @cached_property
    def breaks(self) -> Array:
        """The u between which all factors are smooth, increasing, both ends included, (breaks,)."""
        return np.unique(self.u)

    @cached_property
    def _pieces(self) -> Array:
        """Values and slopes at both ends of each piece, (pieces, factors, 4)."""
        u, rows = np.array(self.u), np.array(self.rows)
        jumps = np.flatnonzero(np.diff(u) == 0) + 1
        pieces = []
        for part in np.split(np.arange(len(u)), jumps):
            slopes = _monotone_slopes(u[part], rows[part])
            values = rows[part]
            pieces.append(np.stack([values[:-1], values[1:], slopes[:-1], slopes[1:]], axis=-1))
        return np.concatenate(pieces)

    def factors(self, u: Array) -> Array:
        """The factors at points that are no break, shape (factors, *u.shape)."""
        place = np.clip(np.searchsorted(self.breaks, u, side="right") - 1, 0, len(self.breaks) - 2)
        h = np.diff(self.breaks)[place]
        t = (u - self.breaks[place]) / h
        y0, y1, d0, d1 = np.moveaxis(self._pieces[place], (-2, -1), (0, 1)).swapaxes(0, 1)
        return (
            y0 * (1 + 2 * t) * (1 - t) ** 2
            + y1 * t**2 * (3 - 2 * t)
            + h * t * (1 - t) * (d0 * (1 - t) - d1 * t)
        )


def _monotone_slopes(u: Array, values: Array) -> Array:
    """Slopes at rows, (rows, factors), that keep the cubics between them monotone."""
    h = np.diff(u)[:, None]
    chords = np.diff(values, axis=0) / h
    slopes = np.zeros_like(values)
    if len(u) == 2:
        return np.repeat(chords, 2, axis=0)
    w1, w2 = 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
    same = chords[:-1] * chords[1:] > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        inner = (w1 + w2) / (w1 / chords[:-1] + w2 / chords[1:])
    slopes[1:-1] = np.where(same, inner, 0.0)
    for end, near, next_one in ((0, 0, 1), (-1, -1, -2)):
        slope = ((2 * h[near] + h[next_one]) * chords[near] - h[near] * chords[next_one]) / (
            h[near] + h[next_one]
        )
        slope = np.where(slope * chords[near] <= 0, 0.0, slope)
        turns = chords[near] * chords[next_one] <= 0
        slopes[end] = np.where(turns & (np.abs(slope) > 3 * np.abs(chords[near])), 3 * chords[near], slope)
    return slopes
