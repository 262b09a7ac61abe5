"""Factors of stiffnesses and drags along an arm with a profile and a taper, cached for points of meshes."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...arrays import Array
from .profile import FACTOR_NAMES, RADIUS_POWERS, Profile, relative_radius


@dataclass(frozen=True, slots=True, kw_only=True)
class FactorCacheSettings:
    """Limits of the cache of factors along an arm, which takes at most 13 MB."""

    max_points: int = 1024
    """Largest number of points at which the factors of stiffnesses and drags are cached. Larger arrays belong
    to meshes used once."""
    max_entries: int = 256
    """Maximum number of cached results, by profile, taper and points; a sweep along F needs about ten."""


FACTOR_CACHE_SETTINGS = FactorCacheSettings()


def factors_along(
    profile: Profile | None, taper: float, u: Array, remainder: Array | None = None
) -> dict[str, Array]:
    """Stiffnesses and drags at points u, divided by their values at the base, by name: arrays of the shape of
    u. Callers must not write into these arrays, because they may be shared through the cache. remainder:
    exact coordinates of the points minus u, (*u.shape); None: u is exact."""
    if u.size > FACTOR_CACHE_SETTINGS.max_points:
        return _factors_along(profile, taper, u, np.zeros(u.shape) if remainder is None else remainder)
    # Arrays cannot be keys of a cache, but their bytes can.
    remainder_bytes = b"" if remainder is None else remainder.tobytes()
    return _cached_factors(profile, float(taper), (u.tobytes(), remainder_bytes), u.shape)


@lru_cache(maxsize=FACTOR_CACHE_SETTINGS.max_entries)
def _cached_factors(
    profile: Profile | None, taper: float, point_bytes: tuple[bytes, bytes], shape: tuple[int, ...]
) -> dict[str, Array]:
    """The result of `factors_along`, cached by the bytes of the points, because the arms of a sweep over F
    are evaluated at the same points. point_bytes: bytes of the arrays u and `remainder` (exact coordinates of
    the points minus u), the latter empty if u is exact. shape: shape of both arrays."""
    u = np.frombuffer(point_bytes[0]).reshape(shape)
    remainder = np.frombuffer(point_bytes[1]).reshape(shape) if point_bytes[1] else np.zeros(shape)
    return _factors_along(profile, taper, u, remainder)


def _factors_along(profile: Profile | None, taper: float, u: Array, remainder: Array) -> dict[str, Array]:
    """The result of `factors_along`, without the cache. remainder: zeros if u is exact."""
    if profile is None:
        factors: dict[str, Array] = dict.fromkeys(FACTOR_NAMES, np.ones(u.shape))
    else:
        factors = dict(zip(FACTOR_NAMES, profile.factors_at(u, remainder), strict=True))
    # A uniform rod skips the products with 1, the most frequent case.
    if taper != 1:
        radius = relative_radius(taper, u, remainder)
        square = radius * radius  # a power of NumPy takes as long as ten products
        radius_to_power = {2: square, 4: square * square}
        for name, exponent in RADIUS_POWERS.items():
            factor = radius_to_power[exponent]
            # Not in place: without a profile all names share one array of ones.
            factors[name] = factors[name] * factor if profile else factor
    return factors


@lru_cache(maxsize=1024)
def smallest_factor_along(profile: Profile | None, taper: float, name: str) -> float:
    """Smallest k1, gamma1 or gamma3 (`name`) along an arm with a profile and a taper, divided by the value at
    the base."""
    exponent = RADIUS_POWERS.get(name, 0)
    # The power of the radius of a cone is monotone, so its minimum is at an end.
    smallest_end_factor = min(1.0, taper**exponent)
    if profile is None:
        return smallest_end_factor
    column = FACTOR_NAMES.index(name)
    with np.errstate(over="ignore"):  # an overflow is not the smallest factor
        row_factors = [
            relative_radius(taper, u) ** exponent * row[column]
            for u, row in zip(profile.u, profile.rows, strict=True)
        ]
        points = profile.candidate_minima_between_rows(name, taper, min(row_factors))
        factors_between_rows = relative_radius(taper, points) ** exponent * profile.factors_at(points)[column]
    return float(min(*row_factors, *factors_between_rows))
