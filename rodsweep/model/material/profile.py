"""Profiles along the arm: factors of stiffnesses and drags as functions of the material coordinate u.

A profile is a table. Between two rows each factor is a monotone cubic (Fritsch and Carlson, 1980), with
values between its end values; two rows at the same u describe a jump. A taper t multiplies the factors by
powers of the radius r(u) = 1 - (1 - t) u of a circular cone: k1, k2 ~ r^2, k3 ~ r^4, gamma3 ~ r^2. The
logarithms in the drags gamma1 and gamma2 of a cone are not part of the taper.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...arrays import Array

FACTOR_NAMES = ("k1", "k2", "k3", "gamma1", "gamma2", "gamma3")
"""Names of the stiffnesses and drags, in the order of the columns of a profile after the column u."""
MIN_ROW_DISTANCE = 1e-6
"""Smallest distance in u between two rows that are no jump. All spectra of sixty random arms with two rows at
this distance were solved; at 1e-7 no elements resolved eight of the arms."""
ROW_DISTANCE_TOLERANCE = 1e-9
"""Relative tolerance of the test for `MIN_ROW_DISTANCE`: two rows of a profile may be closer by this
fraction, because the difference of two values of u has a rounding error."""
RADIUS_POWERS = {"k1": 2, "k2": 2, "k3": 4, "gamma3": 2}
"""Exponents of the radius in the stiffnesses and drags of a cone; for missing names the exponent is 0."""


@dataclass(frozen=True)
class Profile:
    """Table of factors of stiffnesses and drags along the arm, compared and hashed by value. u: material
    coordinates, increasing from 0 to 1, with a repeated value at a jump. rows: positive factors at each u, in
    the order of `FACTOR_NAMES`. Raises ValueError for an invalid table."""

    u: tuple[float, ...]
    rows: tuple[tuple[float, ...], ...]

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        """Hash of the table, kept because rods of a sweep are keys of caches; equal in all processes."""
        return hash((self.u, self.rows))

    def __post_init__(self) -> None:
        if len(self.u) < 2:
            raise ValueError(f"there must be rows at u = 0 and u = 1; the number of rows is {len(self.u)}")
        if self.u[0] != 0 or self.u[-1] != 1:
            first, last = _all_digits_text(self.u[0]), _all_digits_text(self.u[-1])
            raise ValueError(f"the rows go from u = {first} to {last}; they must go from 0 to 1")
        for a, b in zip(self.u[:-1], self.u[1:], strict=True):
            # Negated, so that nan is refused too.
            if not a <= b:
                raise ValueError(
                    f"u = {_all_digits_text(b)} follows u = {_all_digits_text(a)}; u must not decrease"
                )
            # Distance 0 is a jump, which the elements follow exactly; only nearly equal rows are a problem.
            if 0 < b - a < MIN_ROW_DISTANCE * (1 - ROW_DISTANCE_TOLERANCE):
                raise ValueError(
                    f"two rows near u = {a:g} differ by {b - a:.2g} in u; allowed: 0 (a jump) or at least "
                    f"{MIN_ROW_DISTANCE:g}"
                )
        for row_number, value in enumerate(self.u):
            if self.u.count(value) > (1 if value in (0, 1) else 2):
                allowed = "one row" if value in (0, 1) else "two rows (a jump)"
                raise ValueError(f"there are {self.u.count(value)} rows at u = {value:g}; allowed: {allowed}")
            for name, factor in zip(FACTOR_NAMES, self.rows[row_number], strict=True):
                if not 0 < factor < np.inf:
                    raise ValueError(
                        f"the factor of {name} at u = {value:g} is {factor:g}; it must be finite and above 0"
                    )
        with np.errstate(over="ignore", invalid="ignore"):
            # Slopes between finite factors may overflow, and no message could explain that later.
            is_finite = np.isfinite(self._cubic_coefficients).all()
        if not is_finite:
            raise ValueError(
                f"the largest factor is {max(map(max, self.rows)):g}, and interpolation between the rows "
                "overflows; give smaller factors"
            )

    @cached_property
    def breaks(self) -> Array:
        """Ends of the intervals of u on which all factors are smooth, increasing from 0 to 1, (breaks,)."""
        return np.unique(self.u)

    @cached_property
    def is_piecewise_constant(self) -> bool:
        """Whether every factor is constant between neighbouring u."""
        return all(
            self.u[i] == self.u[i + 1] or self.rows[i] == self.rows[i + 1] for i in range(len(self.u) - 1)
        )

    @cached_property
    def _cubic_coefficients(self) -> Array:
        """Coefficients of the cubic polynomials between neighbouring u, (4, factors, 2, intervals). The first
        axis is the power of the distance from one end of the interval, cubes first; the distance is 1 at the
        opposite end. The third axis is the end from which the distance is counted: the lower u, the upper
        u."""
        u = np.array(self.u)
        rows = np.array(self.rows)
        jumps = np.flatnonzero(np.diff(u) == 0) + 1
        coefficients = []
        # A jump splits the profile, so that slopes use one side only.
        for part in np.split(np.arange(len(u)), jumps):
            y = rows[part]
            h = np.diff(u[part])[:, None]
            slopes = _monotone_slopes(u[part], y)
            lower, upper = h * slopes[:-1], h * slopes[1:]
            from_lower = _hermite_cubics(y[:-1], y[1:], lower, upper)
            # Seen from its upper end an interval runs backwards, so slopes change sign and place.
            from_upper = _hermite_cubics(y[1:], y[:-1], -upper, -lower)
            coefficients.append(np.stack([from_lower, from_upper], axis=1))
        return np.ascontiguousarray(np.concatenate(coefficients, axis=2).transpose(0, 3, 1, 2))

    def with_factors_above(self, name: str, min_factor: float, taper: float = 1.0) -> "Profile":
        """The profile that makes the stiffness or drag `name` of an arm at least `min_factor` times its value
        at the base in every row; between two rows factors lie between the factors of the rows. taper: tip
        radius over base radius of the arm."""
        column = FACTOR_NAMES.index(name)
        exponent = RADIUS_POWERS.get(name, 0)
        rows = []
        for u, row in zip(self.u, self.rows, strict=True):
            # The radius to its power multiplies the factor later, so it is divided out here.
            factor = max(row[column], min_factor / relative_radius(taper, u) ** exponent)
            rows.append(row[:column] + (factor,) + row[column + 1 :])
        return Profile(self.u, tuple(rows))

    def candidate_minima_between_rows(self, name: str, taper: float, limit: float) -> Array:
        """Points u between rows, (points,), among them all minima of the stiffness or drag `name` of an arm
        that are below `limit` times the value at the base. taper: tip radius over base radius of the arm."""
        column, exponent = FACTOR_NAMES.index(name), RADIUS_POWERS.get(name, 0)
        radii = relative_radius(taper, self.breaks)
        points = [np.empty(0)]
        for i, (cubic, from_upper) in enumerate(self._cubic_coefficients[:, column].transpose(2, 1, 0)):
            first_radius, last_radius = radii[i : i + 2]
            # The cubic is monotone, so no product is below that of the smaller ends.
            if min(cubic[-1], from_upper[-1]) * min(first_radius, last_radius) ** exponent >= limit:
                continue
            c, slope = cubic / np.abs(cubic).max(), last_radius - first_radius
            # (c r^n)' = r^(n - 1) (c' r + n c r'), where c' r + n c r' is a cubic polynomial.
            derivative = np.polyadd(np.polymul(np.polyder(c), (slope, first_radius)), exponent * slope * c)
            # Coefficients below rounding move no root between the rows, but make the others overflow.
            derivative[np.abs(derivative) <= np.finfo(float).eps * np.abs(derivative).max()] = 0.0
            t = np.roots(derivative).real
            a, b = self.breaks[i : i + 2]
            points.append(a + (b - a) * t[(t > 0) & (t < 1)])
        u = np.concatenate(points)
        return u[~np.isin(u, self.breaks)]

    def factors_at(self, u: Array, remainder: Array | float = 0.0) -> Array:
        """Factors at points u, in the order of `FACTOR_NAMES`, (factors, *u.shape). No u may be a break.
        remainder: exact coordinates of the points minus u, (*u.shape)."""
        breaks = self.breaks
        # At u = 1 the search returns one interval too many.
        interval = np.minimum(np.searchsorted(breaks[1:], u, side="right"), len(breaks) - 2)
        from_left = u - breaks[interval] + remainder
        from_right = breaks[interval + 1] - u - remainder
        # Powers of the distance from the nearer end keep the digits of a factor that falls to a small part of
        # its value at the other end.
        nearer_end = (from_right < from_left).astype(int)
        t = np.minimum(from_left, from_right) / (breaks[interval + 1] - breaks[interval])
        cubic, square, linear, constant = self._cubic_coefficients[:, :, nearer_end, interval]
        factors: Array = ((cubic * t + square) * t + linear) * t + constant
        return factors


def relative_radius(taper: float, u: Any, remainder: Any = 0.0) -> Any:
    """Radius of a cone at points u, divided by the radius at the base, to nearly all digits.

    taper: tip radius over base radius. remainder: exact coordinates of the points minus u; near a thin tip
    the rounding of u itself changes the radius. u and remainder are numbers or arrays of one shape.
    """
    # Both formulas add positive numbers only: the radius is summed from the thinner end.
    return taper + (1 - taper) * (1 - u - remainder) if taper < 1 else 1 + (taper - 1) * u


def _hermite_cubics(first: Array, last: Array, first_slope: Array, last_slope: Array) -> Array:
    """Coefficients of cubic polynomials on [0, 1], cubes first, (4, intervals, factors). first, last: values
    at 0 and at 1. first_slope, last_slope: slopes at 0 and at 1. Each is (intervals, factors)."""
    # The increment is formed first, as first and last may be large and nearly equal.
    increment = last - first
    return np.array(
        [
            first_slope + last_slope - 2 * increment,
            3 * increment - 2 * first_slope - last_slope,
            first_slope,
            first,
        ]
    )


def _all_digits_text(u: float) -> str:
    """Text of u with all digits that distinguish u from other numbers; 1 for 1.0."""
    return repr(float(u)).removesuffix(".0")


def _monotone_slopes(u: Array, values: Array) -> Array:
    """Slopes of the factors at the rows, (rows, factors), for monotone cubic polynomials (Fritsch and
    Carlson, 1980). u: (rows,). values: factors, (rows, factors)."""
    h = np.diff(u)[:, None]
    chords = np.diff(values, axis=0) / h
    slopes = np.zeros_like(values)
    # A single interval has no neighbour for a slope, and becomes linear.
    if len(u) == 2:
        return np.repeat(chords, 2, axis=0)
    w1 = 2 * h[1:] + h[:-1]
    w2 = h[1:] + 2 * h[:-1]
    is_monotone = chords[:-1] * chords[1:] > 0
    with np.errstate(divide="ignore", invalid="ignore"):
        # With the weighted harmonic mean the cubics are monotone; at an extremum the slope is 0.
        inner = (w1 + w2) / (w1 / chords[:-1] + w2 / chords[1:])
    slopes[1:-1] = np.where(is_monotone, inner, 0.0)
    for end, end_interval, next_interval in ((0, 0, 1), (-1, -1, -2)):
        slope = (
            (2 * h[end_interval] + h[next_interval]) * chords[end_interval]
            - h[end_interval] * chords[next_interval]
        ) / (h[end_interval] + h[next_interval])
        # The one-sided formula may point against the data; a flat start does not overshoot.
        slope = np.where(slope * chords[end_interval] <= 0, 0.0, slope)
        # Beyond three times the chord a cubic is no longer monotone (Fritsch and Carlson).
        changes_sign = chords[end_interval] * chords[next_interval] <= 0
        slopes[end] = np.where(
            changes_sign & (np.abs(slope) > 3 * np.abs(chords[end_interval])), 3 * chords[end_interval], slope
        )
    return slopes
