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

from ...arrays import Array
from ...model.compiled.compilation import compiled, compiled_for_vectors
from ...model.compiled.settings import CompiledSettings
from ..exponents import EXPONENT_SETTINGS
from ..parameter_path import Path
from ..roots.newton import ROOT_NEWTON_SETTINGS
from ..value import DeterminantValue
from .determinant import CoefficientSamples, coefficient_samples, elements_for
from .elements.minor_rates import PADDED
from .elements.propagators import element_propagators
from .elements.settings import ARM_ELEMENT_SETTINGS
from .newton import ARM_ROOT_SETTINGS
from .rounding import rounding_error_by_chain
from .value import determinant_along_chain, path_value_by_chain

LINEAR_SCALE = math.inf
"""Value of `ArmFamily.scale` for series in p itself, not in a logarithm of p."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmFamilySettings(CompiledSettings):
    """Settings for the number and spacing of the arms from which a family is interpolated."""

    arm_counts: tuple[int, ...] = (12, 17, 24, 24, 34)
    """Number of arms in each trial. 12 suffice on 21 of 24 random paths from 0 to three times a load."""
    spacing_scales: tuple[float, ...] = (LINEAR_SCALE, LINEAR_SCALE, LINEAR_SCALE, 0.05, 0.05)
    """`ArmFamily.scale` over the length of the interval, for each trial. Logarithmic spacing needs fewer arms
    near complex forces of the size of the stiffness, where the stretch of rubber has branch points."""
    max_propagator_entries: int = 500_000
    """No family is made if the propagators of one arm have more entries: single arms are then faster."""
    converged_tail: float = 1e-15
    """The series has converged if the last two Chebyshev coefficients of every propagator are at most this
    number times its largest entry."""
    coefficient_tail_factor: float = 10.0
    """The tolerance for series of the coefficients along the arms is `converged_tail` times this factor."""

    @property
    def interpolation_error(self) -> float:
        """Error of eigenvalues and crossings from interpolation, as a relative change of w and of p."""
        return 2 * self.converged_tail

    def trials(self) -> list[tuple[int, float]]:
        """Pairs from `arm_counts` and `spacing_scales`, in the order of the trials."""
        return list(zip(self.arm_counts, self.spacing_scales, strict=True))


ARM_FAMILY_SETTINGS = ArmFamilySettings()


class ArmFamily(NamedTuple):
    """Propagators of all arms with p from `p_low` to `p_high`, for |w| <= W, as Chebyshev series in p.

    largest_w: W. scale: the series are in log(1 + (p - low)/scale), or in p if scale is `LINEAR_SCALE`.
    coefficients: Chebyshev coefficients, (nodes, elements, terms, PADDED).
    """

    p_low: float
    p_high: float
    scale: float
    largest_w: float
    coefficients: Array


def interpolated_family(path: Path, low: float, high: float, W: float) -> ArmFamily | None:
    """The family of the arms of `path` with p from `low` to `high`, for |w| <= W; None if the arms are
    not smooth in p, or the propagators have too many entries. Raises ValueError at a p without a valid arm,
    and FloatingPointError if no elements resolve an arm."""
    for number, share in ARM_FAMILY_SETTINGS.trials():
        scale = share * (high - low)
        arms = [path.rod_at(value) for value in _interpolation_points(low, high, scale, number).tolist()]
        samples = coefficient_samples(arms)
        # What the coefficients along the arm do not resolve, the propagators made of them cannot.
        if not _series_converges(samples):
            continue
        found = elements_for(arms, samples, W)
        entries = len(found.lengths) * ARM_ELEMENT_SETTINGS.max_terms * PADDED
        if entries > ARM_FAMILY_SETTINGS.max_propagator_entries:
            return None
        values = element_propagators([rod.F for rod in arms], found.local, found.lengths, W)
        if _has_small_coefficient_tail(values, ARM_FAMILY_SETTINGS.converged_tail):
            coefficients = np.tensordot(_chebyshev_coefficient_matrix(number), values, 1)
            return ArmFamily(low, high, scale, W, np.ascontiguousarray(coefficients))
    return None


def has_smooth_coefficients(path: Path, low: float, high: float) -> bool:
    """Whether the arms' coefficients are smooth in p from `low` to `high`, as a family needs: a cheap test.
    Raises ValueError at a p without a valid arm."""
    for number, share in reversed(ARM_FAMILY_SETTINGS.trials()):
        p = _interpolation_points(low, high, share * (high - low), number)
        if _series_converges(coefficient_samples([path.rod_at(value) for value in p.tolist()])):
            return True
    return False


def _series_converges(samples: CoefficientSamples) -> bool:
    """Whether the Chebyshev series in p of the coefficients along the arms converges at every sample."""
    tail = ARM_FAMILY_SETTINGS.coefficient_tail_factor * ARM_FAMILY_SETTINGS.converged_tail
    return _has_small_coefficient_tail(np.moveaxis(np.array(samples.local), 1, 0), tail)


def _interpolation_points(low: float, high: float, scale: float, number: int) -> Array:
    """Increasing values of p, low to high, of the interpolated arms, (number,); scale: see `ArmFamily`."""
    t = (chebyshev_points(number) + 1) / 2
    if scale < LINEAR_SCALE:
        t = np.expm1(t * math.log1p((high - low) / scale)) * scale / (high - low)
    # Beyond the interval, by rounding, the model may have no arm.
    return np.minimum(low + (high - low) * t, high)


def _has_small_coefficient_tail(values: Array, tolerance: float) -> bool:
    """Whether the last two Chebyshev coefficients of each values[:, i] are <= tolerance * max|values[:,
    i]|.
    """
    others = tuple(range(2, values.ndim))
    last = np.tensordot(_chebyshev_coefficient_matrix(len(values))[-2:], values, 1)
    size = np.abs(values).max(axis=(0, *others))
    return bool((np.abs(last).max(axis=(0, *others)) <= tolerance * size).all())


@cache
def chebyshev_points(number: int) -> Array:
    """Chebyshev points of [-1, 1] including both ends, (number,), increasing."""
    return np.asarray(-np.cos(np.pi * np.arange(number) / (number - 1)))


@cache
def _chebyshev_coefficient_matrix(number: int) -> Array:
    """Matrix that maps values at `number` Chebyshev points to Chebyshev coefficients, (number, number)."""
    return np.asarray(np.linalg.inv(chebyshev.chebvander(chebyshev_points(number), number - 1)))


@compiled
def write_propagators(family: ArmFamily, p: float, polynomials: Array, changes: Array) -> None:
    """Writes the propagators of the arm at p into polynomials, and their derivatives by p into changes, both
    (elements, terms, PADDED).
    """
    half = (family.p_high - family.p_low) / 2
    t = (p - (family.p_low + family.p_high) / 2) / half
    if family.scale < LINEAR_SCALE:
        whole = math.log1p(2 * half / family.scale)
        t = 2 * math.log1p((p - family.p_low) / family.scale) / whole - 1
        half = (p - family.p_low + family.scale) * whole / 2
    nodes = len(family.coefficients)
    T = np.empty(nodes)
    rates = np.empty(nodes)
    # T_0 and T_(-1), as T_(-1) = T_1
    here = 1.0
    before = t
    rate = 0.0
    rate_before = -1.0
    for k in range(nodes):
        T[k] = here
        rates[k] = rate / half
        if k == 0:
            here = t
            before = 1.0
            rate = 1.0
            rate_before = 0.0
        else:
            rate, rate_before = 2 * here + 2 * t * rate - rate_before, rate
            here, before = 2 * t * here - before, here
    series = family.coefficients.reshape(nodes, -1)
    _sum_series(series, T, rates, polynomials.reshape(-1), changes.reshape(-1))


@compiled_for_vectors
def _sum_series(series: Array, T: Array, rates: Array, values: Array, slopes: Array) -> None:
    """values = sum_k T[k] series[k], slopes = sum_k rates[k] series[k], (n,) each; series: (nodes, n)."""
    nodes, n = series.shape
    values[:] = 0.0
    slopes[:] = 0.0
    for k in range(nodes % 4):
        t = T[k]
        p = rates[k]
        for i in range(n):
            values[i] += t * series[k, i]
            slopes[i] += p * series[k, i]
    for k in range(nodes % 4, nodes, 4):  # four at a time save passes over the sums
        t, u, v, w = T[k], T[k + 1], T[k + 2], T[k + 3]
        p, q, r, s = rates[k], rates[k + 1], rates[k + 2], rates[k + 3]
        for i in range(n):
            a = series[k, i]
            b = series[k + 1, i]
            c = series[k + 2, i]
            d = series[k + 3, i]
            values[i] += t * a + u * b + v * c + w * d
            slopes[i] += p * a + q * b + r * c + s * d


@compiled
def propagators_at(family: ArmFamily, p: float) -> tuple[float, Array]:
    """(W, propagators for |w| <= W, (elements, terms, PADDED)) of the arm at p of a family."""
    polynomials = np.empty(family.coefficients.shape[1:])
    write_propagators(family, p, polynomials, np.empty_like(polynomials))
    return family.largest_w, polynomials


@compiled
def determinant_of_family_arm(family: ArmFamily, w: complex, p: float) -> DeterminantValue:
    """D and dD/dw times exp(-S) of the arm at p of a family; |w| <= W."""
    shape = family.coefficients.shape[1:]
    polynomials = np.empty(shape)
    changes = np.empty(shape)
    write_propagators(family, p, polynomials, changes)
    return determinant_along_chain(w, family.largest_w, polynomials)


@compiled
def eigenvalue_of_family_arm(family: ArmFamily, guess: complex, p: float) -> tuple[complex, complex, float]:
    """Returns (w, dw/dp, error of w) of the eigenvalue near `guess`, for the arm at p of a family. Newton's
    method ends when rounding stops the decrease of the steps. A real guess gives a real w. Not for nearly
    double eigenvalues.
    """
    polynomials = np.empty(family.coefficients.shape[1:])
    changes = np.empty_like(polynomials)
    write_propagators(family, p, polynomials, changes)
    w = guess
    last = math.inf
    for _ in range(ROOT_NEWTON_SETTINGS.max_refinements):
        value = determinant_along_chain(w, family.largest_w, polynomials)
        step = value.D / value.D_w if value.D_w != 0 else 0j
        if w.imag == 0:
            step = complex(step.real, 0.0)
        if not abs(step) < last / 2 or abs(w) > family.largest_w:
            break
        last = abs(step)
        w -= step
    D, D_w, D_p, S, _ = path_value_by_chain(w, family.largest_w, polynomials, changes)
    size = max(abs(D_w), EXPONENT_SETTINGS.least_divisor)
    slope = -D_p / D_w if D_w != 0 else 0j
    if w.imag == 0:
        slope = complex(slope.real, 0.0)
    e = rounding_error_by_chain(w, family.largest_w, polynomials, S) + ARM_ROOT_SETTINGS.residual * abs(D)
    return w, slope, e / size + ARM_FAMILY_SETTINGS.interpolation_error * (abs(w) + abs(p * slope))
