"""The propagators of all arms on an interval of a path, as polynomials in the path variable p.

Propagators are smooth in p, like the coefficients along the arm. The propagators of a few arms, at Chebyshev
points in p, on elements that resolve all arms, are interpolated. This gives all propagators and their
derivatives by p. The last Chebyshev coefficients show the error.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from ...arrays import Array, list_of
from ...model.compiled.kernel_constants import KernelConstants
from ..exponents import MACHINE_EPSILON
from ..parameter_path import ParameterPath
from .determinant import CoefficientSamples, coefficient_samples, elements_for
from .elements.minor_rates import PROPAGATOR_LENGTH
from .elements.propagators import element_propagators
from .elements.settings import ARM_ELEMENT_SETTINGS

LOG_SCALE_OF_LINEAR_SPACING = math.inf
"""Value of `ArmFamily.log_spacing_scale` for series in p itself, not in a logarithm of p."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmFamilySettings(KernelConstants):
    """Settings for the number and spacing of the arms from which a family is interpolated."""

    arm_counts: tuple[int, ...] = (12, 17, 24, 24, 34)
    """Number of arms between which propagators are interpolated, in each successive trial. 12 suffice on 21
    of 24 random paths from 0 to three times a load."""
    log_spacing_scales_over_interval: tuple[float, ...] = (
        LOG_SCALE_OF_LINEAR_SPACING,
        LOG_SCALE_OF_LINEAR_SPACING,
        LOG_SCALE_OF_LINEAR_SPACING,
        0.05,
        0.05,
    )
    """`ArmFamily.log_spacing_scale` divided by the length of the interval, for each trial. Logarithmic
    spacing needs fewer arms near complex forces of the size of the stiffness, where the stretch of rubber has
    branch points."""
    max_propagator_entries: int = 500_000
    """No `ArmFamily` is made if the propagators of one arm have more entries than this: single arms are then
    faster."""
    max_chebyshev_tail: float = 1e-15
    """The series has converged if the last two Chebyshev coefficients of every propagator are at most this
    number times its largest entry."""
    coefficient_tolerance_factor: float = 10.0
    """The tolerance for series of the coefficients along the arms is `max_chebyshev_tail` times this
    factor."""

    def trial_counts_and_spacings(self) -> list[tuple[int, float]]:
        """Pairs from `arm_counts` and `log_spacing_scales_over_interval`, in the order of the trials."""
        return list(zip(self.arm_counts, self.log_spacing_scales_over_interval, strict=True))


ARM_FAMILY_SETTINGS = ArmFamilySettings()


class ArmFamily(NamedTuple):
    """Propagators of all arms with p from `p_low` to `p_high`, for |w| <= W, as Chebyshev series in p.

    largest_w: W. log_spacing_scale: the series are in log(1 + (p - p_low)/log_spacing_scale), or in p if it
    is `LOG_SCALE_OF_LINEAR_SPACING`. chebyshev_coefficients: Chebyshev coefficients, (nodes, elements, terms,
    PROPAGATOR_LENGTH). reference_entry_sizes: sizes to which the interpolation errors of propagator entries
    are relative, at w = 0, and summed over the positive powers of w/W, (elements, 2, PROPAGATOR_LENGTH). A
    size is the largest modulus on the interval, plus the moduli of the last two Chebyshev coefficients
    divided by `MACHINE_EPSILON`.
    """

    p_low: float
    p_high: float
    log_spacing_scale: float
    largest_w: float
    chebyshev_coefficients: Array
    reference_entry_sizes: Array


def interpolated_family(path: ParameterPath, low: float, high: float, W: float) -> ArmFamily | None:
    """The family of the arms of `path` with p from `low` to `high`, for |w| <= W; None if the arms are
    not smooth in p, or the propagators have too many entries. Raises ValueError at a p without a valid arm,
    and FloatingPointError if no elements resolve an arm."""
    for node_count, spacing in ARM_FAMILY_SETTINGS.trial_counts_and_spacings():
        scale = spacing * (high - low)
        arms = [path.rod_at(value) for value in list_of(_interpolation_points(low, high, scale, node_count))]
        samples = coefficient_samples(arms)
        # If the series of the coefficients does not converge, the series of the propagators cannot converge.
        if not _series_converges(samples):
            continue
        elements = elements_for(arms, samples, W)
        entry_count = len(elements.lengths) * ARM_ELEMENT_SETTINGS.max_terms * PROPAGATOR_LENGTH
        if entry_count > ARM_FAMILY_SETTINGS.max_propagator_entries:
            # Later trials have as many entries for each arm, so that none of them would be smaller.
            return None
        propagators = element_propagators(
            [rod.F for rod in arms], elements.local_coefficients, elements.lengths, W
        )
        if _has_small_coefficient_tail(propagators, ARM_FAMILY_SETTINGS.max_chebyshev_tail):
            coefficients = np.tensordot(_chebyshev_coefficient_matrix(node_count), propagators, 1)
            # The last coefficients show truncation errors, which may exceed rounding errors of small entries.
            largest_entry = (
                np.abs(propagators).max(axis=0) + np.abs(coefficients[-2:]).sum(axis=0) / MACHINE_EPSILON
            )
            reference_entry_sizes = np.stack([largest_entry[:, 0], largest_entry[:, 1:].sum(axis=1)], axis=1)
            return ArmFamily(low, high, scale, W, np.ascontiguousarray(coefficients), reference_entry_sizes)
    return None


def has_smooth_coefficients(path: ParameterPath, low: float, high: float) -> bool:
    """Cheap test whether the arms' coefficients are smooth in p from `low` to `high`, as an `ArmFamily`
    requires. Raises ValueError at a p without a valid arm."""
    # The last trial has the most arms: if the coefficients are smooth at all, it mostly says so at once.
    for node_count, spacing in reversed(ARM_FAMILY_SETTINGS.trial_counts_and_spacings()):
        p = _interpolation_points(low, high, spacing * (high - low), node_count)
        if _series_converges(coefficient_samples([path.rod_at(value) for value in list_of(p)])):
            return True
    return False


def _series_converges(samples: CoefficientSamples) -> bool:
    """Whether the Chebyshev series in p of the coefficients along the arms converges at every sample."""
    tolerance = ARM_FAMILY_SETTINGS.coefficient_tolerance_factor * ARM_FAMILY_SETTINGS.max_chebyshev_tail
    # The series are in p, so the axis of the arms comes first.
    return _has_small_coefficient_tail(np.moveaxis(np.array(samples.local_coefficients), 1, 0), tolerance)


def _interpolation_points(low: float, high: float, scale: float, point_count: int) -> Array:
    """Increasing values of p, low to high, of the interpolated arms, (point_count,). scale:
    `ArmFamily.log_spacing_scale`."""
    t: Array = (chebyshev_points(point_count) + 1) / 2
    if scale < LOG_SCALE_OF_LINEAR_SPACING:
        t = np.expm1(t * math.log1p((high - low) / scale)) * scale / (high - low)
    # Beyond the interval, by rounding, the model may have no arm.
    return np.minimum(low + (high - low) * t, high)


def _has_small_coefficient_tail(values: Array, tolerance: float) -> bool:
    """Whether, for every i, the moduli of the last two Chebyshev coefficients of values[:, i] are at most
    tolerance * max|values[:, i]|."""
    other_dimensions = tuple(range(2, values.ndim))
    last_coefficients = np.tensordot(_chebyshev_coefficient_matrix(len(values))[-2:], values, 1)
    largest_values = np.abs(values).max(axis=(0, *other_dimensions))
    return bool(
        (np.abs(last_coefficients).max(axis=(0, *other_dimensions)) <= tolerance * largest_values).all()
    )


@cache
def chebyshev_points(count: int) -> Array:
    """Chebyshev points of [-1, 1] including both ends, (count,), increasing."""
    return np.asarray(-np.cos(np.pi * np.arange(count) / (count - 1)))


@cache
def _chebyshev_coefficient_matrix(count: int) -> Array:
    """Matrix that maps values at `count` Chebyshev points to Chebyshev coefficients, (count, count)."""
    # At Chebyshev points the matrix is well conditioned, and its inverse loses no digits.
    return np.asarray(np.linalg.inv(chebyshev.chebvander(chebyshev_points(count), count - 1)))
