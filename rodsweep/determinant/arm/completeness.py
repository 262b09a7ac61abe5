"""Proof, from D at a few real points, that a list of an arm's eigenvalues is complete right of a line.

D is entire of order 1/2 with D(0) = 1, so that D'/D(x) = sum 1/(x - w_n) over all eigenvalues. With points
x_1 < ... < x_k right of the hull of the spectrum and c_j = prod_(i != j) 1/(x_i - x_j),

    phi(v) = prod_j 1/(x_j - v) = sum_j c_j/(x_j - v),   sum_n phi(w_n) = sum_j c_j D'/D(x_j).

Subtracting phi at the known eigenvalues leaves R = sum phi over the unknown eigenvalues. The points lie so
far to the right that sum_j arg(x_j - v) is at most pi/2 everywhere in the hull, so every term of R has a real
part >= 0. An unknown eigenvalue right of a line would contribute at least the smallest Re phi right of the
line, and twice as much if it belongs to a conjugate pair. If R is smaller, no eigenvalue right of the line is
unknown.

An eigenvalue far to the left contributes only about |w_n|^-k, so it suffices to know a few eigenvalues left
of the line. The proof relies on the hull, the errors of the known eigenvalues, and estimated errors of D.
"""

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from ...arrays import Array, Complex, list_of
from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants
from ..exponents import EXPONENT_SETTINGS
from .determinant import ArmDeterminant
from .hull.region import EigenvalueHull
from .value import determinant_from_propagators


@dataclass(frozen=True, slots=True, kw_only=True)
class CompletenessSettings(KernelConstants):
    """Settings for proofs of completeness from D'/D at real points x_1 < ... < x_k."""

    eigenvalue_count_beyond_modes: int = 2
    """Number of eigenvalues requested beyond the modes to prove. With 2 additional eigenvalues, 59 of 100
    random arms need a count; with 0, 73 arms. A count costs more than two eigenvalues."""
    real_point_counts: tuple[int, ...] = (3, 6)
    """Numbers k of real points x_j of D'/D in successive trials. Fewer points can lie closer to the hull;
    more points suffice for a wider hull."""
    max_real_point_over_largest_w: tuple[float, ...] = (1.5, 6.0)
    """Upper limits of the largest point x_k of D'/D over the largest known |w|, one for each k. With a larger
    x_k unknown and known eigenvalues contribute almost equally, and most proofs fail."""
    min_real_point_over_line_distance: float = 0.35
    """Lower limit of the smallest point x_1 of D'/D over the distance of the line from the imaginary axis."""
    min_real_point: float = 1e-6
    """Lower limit of the smallest point x_1 of D'/D, in 1/tau2; needed if line and hull are close to 0."""
    relative_real_point_spread: float = 1.0
    """Length (x_k - x_1)/x_1 of the interval of the equidistant points x_j of D'/D."""
    real_point_shift_factor: float = 1.3
    """Factor on the points x_j of D'/D, applied until every term of the sum R has a real part >= 0."""
    hull_strip_count: int = 24
    """Number of vertical strips of the hull right of the line, each with its own bound of Re phi."""
    max_remainder_over_contribution: float = 0.7
    """Completeness is proved if the sum R (`Remainder`) plus its rounding error, and -R, are below this
    fraction of the smallest possible contribution of an unknown eigenvalue right of the line."""
    log_derivative_rounding_ratio: float = 10.0
    """Relative rounding error of D'/D divided by the relative rounding error of D. Measured: at most 0.08
    between two sets of elements, over 45 random arms."""
    field_ranges: ClassVar = {
        "real_point_shift_factor": (1.0, math.inf),
        "max_remainder_over_contribution": (0.0, 1.0),
    }
    """Exclusive bounds (lower, upper) of fields, by name, that the proofs require; see `KernelConstants`."""

    def proof_trials(self) -> list[tuple[int, float]]:
        """Pairs (number k of x_j, largest x_k divided by the largest known |w|) of all trials, in order."""
        return list(zip(self.real_point_counts, self.max_real_point_over_largest_w, strict=True))


COMPLETENESS_SETTINGS = CompletenessSettings()


class Remainder(NamedTuple):
    """The sum R of phi(w) = prod_j 1/(x_j - w) over the unknown eigenvalues w, and its rounding error.
    min_unknown_contribution: lower bound of the contribution of an unknown eigenvalue right of the line."""

    phi_sum: float
    rounding_error: float
    min_unknown_contribution: float


class CompletenessProof(NamedTuple):
    """Outcome of `prove_complete`: whether completeness is proved, and number of evaluations of D."""

    is_complete: bool
    evaluation_count: int


def prove_complete(
    line: float, known_w: Complex, errors: Array, determinant: ArmDeterminant, hull: EigenvalueHull
) -> CompletenessProof:
    """Proof, if possible, that all eigenvalues with Re w >= line are known. line: if > 0, or without a hull,
    nothing is proved. known_w, errors: known eigenvalues and their absolute errors, (n,) each. Raises
    FloatingPointError if no elements resolve the arm."""
    # Negated, so that a line of nan proves nothing.
    if not math.isfinite(hull.a) or not line <= 0:
        return CompletenessProof(False, 0)
    # R must be real, so an eigenvalue without its conjugate is treated as unknown.
    paired = is_real_or_conjugate_known(known_w)
    evaluation_count = 0
    for k, max_ratio in COMPLETENESS_SETTINGS.proof_trials():
        points = points_right_of_hull(line, hull.a, hull.c, k)
        if _last_proof_point(points) <= max_ratio * np.abs(known_w).max():
            propagators = determinant.propagators_for(points[-1])
            known = known_w[paired], errors[paired]
            remainder = sum_over_unknown_eigenvalues(line, *known, hull, points, propagators)
            evaluation_count += k
            if proves_completeness(remainder):
                return CompletenessProof(True, evaluation_count)
    return CompletenessProof(False, evaluation_count)


def is_real_or_conjugate_known(known_w: Complex) -> np.ndarray:
    """Mask, (n,), of known eigenvalues that are real or whose conjugate is known too."""
    conjugates = set(list_of(known_w.conj()))
    return np.array([w in conjugates for w in list_of(known_w)], dtype=bool)


def largest_w_of_proof(line: float, hull: EigenvalueHull, known_w: Complex) -> float:
    """Largest |w| at which the first possible trial of `prove_complete` evaluates D; inf if no trial is
    possible. line: Re w of the vertical line. known_w: known eigenvalues, (n,)."""
    largest_w = float(np.abs(known_w).max())
    for k, ratio in COMPLETENESS_SETTINGS.proof_trials():
        if (last_w := _last_proof_point(points_right_of_hull(line, hull.a, hull.c, k))) <= ratio * largest_w:
            return last_w
    return math.inf


def requirements_of_cheapest_proof(
    line: float, hull: EigenvalueHull, known_w: Complex, mode_count: int
) -> tuple[int, float]:
    """Returns (number of leading eigenvalues that the cheapest proof needs, largest |w| of this proof). line:
    Re w of the vertical line. known_w: approximate eigenvalues, (n,), leading first. The cheapest proof has
    the smallest |w|, and therefore the fewest elements. The number is at least `mode_count`. If no proof is
    possible, the result is (0, inf)."""
    cheapest = 0, math.inf
    # The leading eigenvalues are not the smallest, so |w| need not increase along the list.
    moduli = list_of(np.maximum.accumulate(np.abs(known_w)))
    complete = [*list_of(known_w[1:] != known_w[:-1].conj()), True]
    for k, ratio in COMPLETENESS_SETTINGS.proof_trials():
        last_w = _last_proof_point(points_right_of_hull(line, hull.a, hull.c, k))
        for count in range(mode_count, len(moduli) + 1):
            largest_w = moduli[count - 1]
            if last_w <= ratio * largest_w and max(last_w, largest_w) < cheapest[1] and complete[count - 1]:
                cheapest = count, max(last_w, largest_w)
    return cheapest


def _last_proof_point(points: Array) -> float:
    """The largest of the real points x_j, (k,), at which a proof evaluates D'/D; inf if there are none."""
    return float(points[-1]) if len(points) else math.inf


@compiled
def proves_completeness(remainder: Remainder) -> bool:
    """Whether the sum R of a `Remainder` is too small for an unknown eigenvalue right of the line. False also
    if R is far below 0: some known eigenvalue is then not a root of D."""
    max_remainder = COMPLETENESS_SETTINGS.max_remainder_over_contribution * remainder.min_unknown_contribution
    return remainder.phi_sum + remainder.rounding_error < max_remainder and -max_remainder < remainder.phi_sum


@compiled
def points_right_of_hull(line: float, a: float, c: float, k: int) -> Array:
    """Real points x_1 < ... < x_k, (k,), so far right that Re prod_j 1/(x_j - w) >= 0 for all w in the hull;
    empty if the points overflow. line: Re w of the vertical line. a, c: constants of `hull.hull`."""
    # As close to the hull as allowed: from farther away all eigenvalues contribute alike.
    x = max(a * a, COMPLETENESS_SETTINGS.min_real_point_over_line_distance * abs(line))
    x = max(x, COMPLETENESS_SETTINGS.min_real_point)
    points = x * (1 + COMPLETENESS_SETTINGS.relative_real_point_spread * np.arange(k) / max(k - 1, 1))
    while not _max_argument_sum(points, a, c) < math.pi / 2:
        if not points[0] < 1 / EXPONENT_SETTINGS.min_divisor:
            return points[:0]
        points *= COMPLETENESS_SETTINGS.real_point_shift_factor
    return points


@compiled
def _max_argument_sum(points: Array, a: float, c: float) -> float:
    """Upper bound of sum_j arg(x_j - v), v in the hull (a, c) of `hull.hull`; inf if an x_j may lie in it."""
    b = 1 - c
    total = 0.0
    for x in points:
        if not x > a * a / (4 * b):
            return math.inf
        slope = c / b
        if a > 0:  # |Im v|/(x - Re v) on the boundary is largest at this n
            n = (c * x + math.sqrt(c * c * x * x + a * a * x)) / a
            slope = (a * n + c * n * n) / (x - a * n + b * n * n)
        total += math.atan(slope)
    return total


@compiled
def sum_over_unknown_eigenvalues(
    line: float, known: Complex, error: Array, hull: EigenvalueHull, points: Array, level: tuple[float, Array]
) -> Remainder:
    """R, the sum of prod_j 1/(x_j - w) over the unknown eigenvalues w, and the least that one right of Re w =
    `line` in `hull` adds. known, error: known eigenvalues, closed under conjugation, and errors, (n,) each.
    points: real x_j, increasing, (k,). level: (W, propagators for |w| <= W), W at least the largest x_j."""
    k = len(points)
    R = 0.0
    rounding = 0.0
    for j in range(k):
        weight = 1.0
        for i in range(k):
            if i != j:
                weight /= points[i] - points[j]
        value = determinant_from_propagators(complex(points[j], 0.0), level[0], level[1])
        slope = (value.D_w / value.D).real
        R += weight * slope
        # The c_j alternate in sign: R may be far smaller than the terms that are rounded.
        slope_rounding = abs(weight * slope) * COMPLETENESS_SETTINGS.log_derivative_rounding_ratio
        rounding += slope_rounding * value.rounding_error / abs(value.D)
    for n in range(len(known)):
        w = known[n]
        phi = 1 + 0j
        rate = 0.0
        for x in points:
            phi /= x - w
            rate += 1 / abs(x - w)
        R -= phi.real
        rounding += abs(phi) * rate * error[n]
    return Remainder(R, rounding, _min_contribution_right_of(line, points, hull[0], hull[1]))


@compiled
def _min_contribution_right_of(line: float, points: Array, a: float, c: float) -> float:
    """Lower bound of what an eigenvalue right of the line in the hull (a, c) adds to R (`Remainder`)."""
    b = 1 - c
    rightmost = max(a * a / (4 * b), line)
    lower_bound = 1.0
    for x in points:
        lower_bound /= x - line
    for i in range(COMPLETENESS_SETTINGS.hull_strip_count):
        start = line + (rightmost - line) * i / COMPLETENESS_SETTINGS.hull_strip_count
        stop = line + (rightmost - line) * (i + 1) / COMPLETENESS_SETTINGS.hull_strip_count
        depth = max(-start, 0.0)
        n = (a + math.sqrt(a * a + 4 * b * depth)) / (2 * b)
        height = a * n + c * n * n
        modulus = 1.0
        angle_sum = 0.0
        for x in points:
            modulus /= math.hypot(x - start, height)
            angle_sum += math.atan2(height, x - stop)
        # Off the real axis both eigenvalues of a conjugate pair contribute.
        lower_bound = min(lower_bound, 2 * modulus * math.cos(angle_sum) if angle_sum < math.pi / 2 else 0.0)
    return lower_bound
