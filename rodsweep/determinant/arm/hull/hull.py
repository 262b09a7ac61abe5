"""The hull of an arm: a convex region that contains all transverse eigenvalues, for any profiles and material
law.

Testing the eigenproblem with alpha(u) y* and theta*, alpha > 0 continuous, gives with N^2 = int alpha gamma2
|y|^2 + gamma3 |theta|^2 and n^2 N^2 = int alpha c2 |s|^2 + c3 |m|^2

    w N^2 = -n^2 N^2 + int (g - alpha nu) theta* s - F int alpha c3 y* m - int alpha' y* s.

The last three terms are at most a n N^2, where a is the largest norm of the matrix

    [[alpha'/(alpha sqrt(gamma2 c2)), F sqrt(alpha c3/gamma2)], [(g - alpha nu)/sqrt(gamma3 alpha c2), 0]]

along the arm. Where gamma3 is small the term with theta is better bounded by theta(0) = 0: it is at most c
n^2 N^2 with 4 c^2 = int (g - alpha nu)^2/(alpha c2) (int_0^u c3) du. Both give, for some n >= 0,

    Re w <= a n - (1 - c) n^2,   |Im w| <= a n + c n^2,

a convex region bounded by a parabola. Several weights alpha are tried, and the smallest region is used. With
alpha = g/(nu + |F| sqrt(c2 c3 gamma3/gamma2)) the region of a uniform rod equals the region of
`rodsweep.determinant.certificate.box_of_all_eigenvalues`.

Extremes along the arm are evaluated at points between the breaks, and `HULL_SETTINGS.enlargement_fraction`
allows for the arm between these points."""

from collections.abc import Sequence
from functools import cache, lru_cache
from math import inf, isfinite, sqrt
from typing import NamedTuple

import numpy as np

from ....arrays import Array, list_of
from ....model.compiled.compilation import compiled
from ....model.local_coefficients import local_coefficient_array
from ....model.material.rod_material import RodMaterial
from ....model.rod import Rod
from ...parameter_path import ParameterPath
from .averaged_weight import regions_from_averaged_weights_of_arms
from .region import HULL_SETTINGS, UNBOUNDED_HULL, EigenvalueHull, PathHulls
from .weights import (
    four_c_squared_from_clamp,
    smallest_squared_norm,
    squared_norms_of_varying_weights,
    trial_constant_weights,
)


def hull_of(rod: Rod) -> EigenvalueHull:
    """The smallest hull found for the spectrum of an arm; `UNBOUNDED_HULL` if no bound is found."""
    return _hull_of_sampled_arms(_hull_samples([rod]))


def hulls_along(path: ParameterPath, low: float, high: float, point_count: int) -> PathHulls:
    """The hulls of all arms of a path between neighbouring values of `point_count` equally spaced p, from
    `low` to `high`. Extremes along the path are evaluated at these values only;
    `HULL_SETTINGS.enlargement_fraction` allows for the arms between."""
    p = np.linspace(low, high, point_count)
    arms = _hull_samples([path.rod_at(x) for x in list_of(p)])
    hulls = [_hull_of_sampled_arms(_slice_of_samples(arms, slice(i, i + 2))) for i in range(point_count - 1)]
    return PathHulls(p, np.array([hull.a for hull in hulls]), np.array([hull.c for hull in hulls]))


def _hull_of_sampled_arms(arms: "HullSamples") -> EigenvalueHull:
    """The smallest hull found for the spectra of all sampled arms; `UNBOUNDED_HULL` if no bound is found."""
    max_c = 1 - HULL_SETTINGS.min_one_minus_c
    a, c = _smallest_common_region(
        arms.F,
        arms.interval_lengths,
        arms.local_coefficients,
        arms.regions_from_averaged_weights,
        _chebyshev_matrices(),
        max_c,
    )
    return EigenvalueHull((1 + HULL_SETTINGS.enlargement_fraction) * a, c) if isfinite(a) else UNBOUNDED_HULL


class HullSamples(NamedTuple):
    """Coefficients of n arms of one material at Chebyshev points, from which hulls are computed.

    F: forces, (n,). interval_lengths: lengths of the intervals between breaks, (pieces,). local_coefficients:
    coefficients, (6, n, pieces, points), with increasing u. regions_from_averaged_weights: constants (a, c)
    of the trial regions of each arm from averaged weights, (n, trials, 2); inf if a trial gives no bound; (n,
    0, 2) for arms without jumps.
    """

    F: Array
    interval_lengths: Array
    local_coefficients: Array
    regions_from_averaged_weights: Array


def _hull_samples(rods: Sequence[Rod]) -> HullSamples:
    """The `HullSamples` of arms of one material, one for each of `rods`."""
    material = rods[0].material
    lengths, u, end_to_end_u = _lengths_and_chebyshev_points(material)
    F = np.array([rod.F for rod in rods], float)
    coefficients = local_coefficient_array(rods, u)
    averaged_regions: Array = np.empty((len(rods), 0, 2))
    if material.jump_positions:
        averaged_regions = regions_from_averaged_weights_of_arms(
            F, end_to_end_u, coefficients.reshape(6, len(F), -1)
        )
    return HullSamples(F, lengths, coefficients, averaged_regions)


@lru_cache(maxsize=HULL_SETTINGS.max_cached_materials)
def _lengths_and_chebyshev_points(material: RodMaterial) -> tuple[Array, Array, Array]:
    """Returns (lengths, u, end_to_end_u). u: Chebyshev points in each interval between breaks of the profile,
    (pieces, points). lengths: distance from the first to the last of them, a little shorter than the
    interval, (pieces,). end_to_end_u: the same points after the intervals are moved together, so that the
    last point of an interval coincides with the first point of the next, (pieces * points,)."""
    x = (1 - 2 * HULL_SETTINGS.end_point_distance_over_interval) * _chebyshev_matrices().points
    lengths = np.diff(material.breaks)
    u = material.breaks[:-1, None] + lengths[:, None] * (x + 1) / 2
    lengths = lengths * (1 - 2 * HULL_SETTINGS.end_point_distance_over_interval)
    interval_starts = np.cumsum(lengths) - lengths
    return lengths, u, (interval_starts[:, None] + lengths[:, None] * (x + 1) / 2).ravel()


def _slice_of_samples(arms: HullSamples, arm_indices: slice) -> HullSamples:
    """The samples of the arms with the indices `arm_indices`."""
    coefficients = np.ascontiguousarray(arms.local_coefficients[:, arm_indices])
    return arms._replace(
        F=arms.F[arm_indices],
        local_coefficients=coefficients,
        regions_from_averaged_weights=arms.regions_from_averaged_weights[arm_indices],
    )


class ChebyshevMatrices(NamedTuple):
    """Chebyshev points in [-1, 1], (points,), and the matrices that differentiate and integrate an
    interpolant. differentiation_matrix, integration_matrix: matrices from values at the points to
    derivatives, and to integrals from -1, at the points, (points, points)."""

    points: Array
    differentiation_matrix: Array
    integration_matrix: Array


@cache
def _chebyshev_matrices() -> ChebyshevMatrices:
    """The `ChebyshevMatrices` of `HULL_SETTINGS.points_per_interval` points, cached."""
    x = -np.cos(
        np.pi * np.arange(HULL_SETTINGS.points_per_interval) / (HULL_SETTINGS.points_per_interval - 1)
    )
    to_series = np.linalg.inv(np.polynomial.chebyshev.chebvander(x, HULL_SETTINGS.points_per_interval - 1))
    slopes = np.polynomial.chebyshev.chebder(to_series)
    integrals = np.polynomial.chebyshev.chebint(to_series, lbnd=-1)
    derivative = np.polynomial.chebyshev.chebvander(x, HULL_SETTINGS.points_per_interval - 2) @ slopes
    integral = np.polynomial.chebyshev.chebvander(x, HULL_SETTINGS.points_per_interval) @ integrals
    return ChebyshevMatrices(x, np.ascontiguousarray(derivative), np.ascontiguousarray(integral))


@compiled
def _smallest_common_region(
    F: Array, lengths: Array, coefficients: Array, averaged: Array, chebyshev: ChebyshevMatrices, max_c: float
) -> tuple[float, float]:
    """Returns (a, c) of the smallest region that contains the spectra of all arms, before a is enlarged;
    (inf, 0) if no bound is found.

    F: forces, (n,). lengths: lengths of the intervals between breaks, (pieces,). coefficients: (6, n, pieces,
    points). averaged: constants (a, c) of trial regions from averaged weights, (n, trials, 2). max_c: regions
    with c >= max_c are not used.
    """
    nu, c2, c3, gamma2, gamma3, g = coefficients
    max_weighted_force = 0.0
    for arm in range(len(F)):
        max_weighted_force = max(max_weighted_force, (F[arm] * F[arm] * c3[arm] / gamma2[arm]).max())
    alphas = trial_constant_weights(coefficients)
    smallest = (inf, 0.0)
    if not (c2 > 0).any():  # then g = nu
        smallest = (sqrt(max_weighted_force), 0.0)
    # The norm divides by the rotational drag.
    elif (gamma3 > 0).all():
        smallest = (sqrt(smallest_squared_norm(alphas, coefficients.reshape(6, -1), max_weighted_force)), 0.0)
    continuous = averaged.shape[1] == 0
    if continuous and (g > 0).all() and (c2 > 0).all():
        for square in squared_norms_of_varying_weights(
            F, lengths, coefficients, chebyshev.differentiation_matrix
        ):
            smallest = _smaller_region(smallest, (sqrt(square), 0.0), max_c)
    for trial in range(averaged.shape[1]):
        # With the largest a and the largest c of all arms, the region contains the region of every arm.
        c = (1 + HULL_SETTINGS.enlargement_fraction) * float(averaged[:, trial, 1].max())
        smallest = _smaller_region(smallest, (float(averaged[:, trial, 0].max()), c), max_c)
    # Where c2 = 0, g equals nu: only alpha = 1 keeps (g - alpha nu)^2/c2 finite.
    if not (c2 > 0).all():
        alphas = np.ones(1)
    integrals = four_c_squared_from_clamp(alphas, F, lengths, coefficients, chebyshev.integration_matrix)
    for k in range(len(alphas)):
        c = (1 + HULL_SETTINGS.enlargement_fraction) * sqrt(integrals[k]) / 2
        smallest = _smaller_region(smallest, (sqrt(alphas[k] * max_weighted_force), c), max_c)
    return smallest


@compiled
def _smaller_region(
    current: tuple[float, float], candidate: tuple[float, float], max_c: float
) -> tuple[float, float]:
    """The smaller of the regions (a, c) `current` and `candidate`, by the measure a^2 (1 +
    (c/c_at_doubled_measure)^4). `current` is returned if `candidate` has c >= `max_c`."""
    if not candidate[1] < max_c:
        return current
    current_size = current[0] ** 2 * (1 + (current[1] / HULL_SETTINGS.c_at_doubled_measure) ** 4)
    candidate_size = candidate[0] ** 2 * (1 + (candidate[1] / HULL_SETTINGS.c_at_doubled_measure) ** 4)
    return candidate if candidate_size < current_size else current
