"""Interpolation between two samples of the spectrum along a path: whether the slopes of the eigenvalues at
both samples exclude that, between the samples, the leading eigenvalue changes between real and complex (an
exchange)."""

import math
from typing import NamedTuple

from .spectrum_samples import SPECTRUM_SAMPLE_SETTINGS, SpectrumSample


def cubic_minimum_and_position(a: float, b: float, slope_a: float, slope_b: float) -> tuple[float, float]:
    """Returns (minimum on [0, 1], argument of the minimum) for the cubic with values `a`, `b` and slopes
    `slope_a`, `slope_b` at 0 and 1; the argument is 0.5 if the minimum is at an end."""
    # The cubic a + slope_a t + square t^2 + cube t^3 of Hermite interpolation.
    square_term = 3 * (b - a) - 2 * slope_a - slope_b
    cubic_term = slope_a + slope_b - 2 * (b - a)
    minimum = min(a, b)
    argument = 0.5
    discriminant = square_term * square_term - 3 * cubic_term * slope_a
    # A straight line has both terms 0, and its minimum at an end.
    if discriminant >= 0 and (square_term or cubic_term):
        # The root of slope_a + 2 square t + 3 cube t^2 at the minimum, computed without cancellation.
        root = math.sqrt(discriminant)
        t = 0.5
        # Of the two forms of the root only the one without a difference of nearly equal numbers is used.
        if square_term + root > 0:
            t = -slope_a / (square_term + root)
        elif cubic_term:
            t = (root - square_term) / (3 * cubic_term)
        value = a + t * (slope_a + t * (square_term + t * cubic_term))
        # The cubic also has its minimum outside the interval, where no sample is needed.
        if 0 < t < 1 and value < minimum:
            minimum = value
            argument = t
    return minimum, argument


class NextSamplePosition(NamedTuple):
    """Position of an additional sample between two samples. No sample is needed if the slopes of the
    eigenvalues agree with the change of the eigenvalues between the samples, and exclude that the leading
    eigenvalue changes between real and complex (an exchange). may_hold_two_exchanges: whether two exchanges
    may lie between the samples."""

    interval_fraction: float
    """Position between the two samples as a fraction of their interval, from 0 to 1; 0 for no further
    sample."""
    may_hold_two_exchanges: bool


def next_sample_between(left: SpectrumSample, right: SpectrumSample) -> NextSamplePosition:
    """The sample to be added between the samples `left` and `right`. The leading eigenvalue must be real at
    both samples, or a pair at both samples."""
    distance = right.p - left.p
    for a, b in (
        (left.scaled_squared_difference_and_slope(), right.scaled_squared_difference_and_slope()),
        (left.scaled_other_type_gap_and_slope(), right.scaled_other_type_gap_and_slope()),
    ):
        # Neither sample has such an eigenvalue among the computed ones, so none is near the leading one.
        if a is None and b is None:
            continue
        if a is None or b is None:
            value, slope = a or b or (0.0, 0.0)
            # Known at one sample only, the gap may close within the interval; 2 is a safety factor.
            if abs(value) < 2 * abs(slope) * distance:
                return NextSamplePosition(0.5, False)
            continue
        smallest_value = min(abs(a[0]), abs(b[0]))
        # By the trapezoidal rule smooth slopes explain the change between the samples.
        unexplained_change = deviation_from_trapezoidal_rule(a, b, distance)
        # The gap is mirrored to be positive, so that one test, of a minimum, serves both signs.
        sign = math.copysign(distance, a[0])
        minimum, fraction = cubic_minimum_and_position(abs(a[0]), abs(b[0]), sign * a[1], sign * b[1])
        # Two samples of one kind have gaps of one sign, so the product is 0 only where a sample itself lies
        # at an exchange.
        if a[0] * b[0] <= 0 or minimum < SPECTRUM_SAMPLE_SETTINGS.interpolation_tolerance * smallest_value:
            return NextSamplePosition(fraction, True)
        if unexplained_change > SPECTRUM_SAMPLE_SETTINGS.interpolation_tolerance * max(
            smallest_value, abs(b[0] - a[0])
        ):
            return NextSamplePosition(0.5, False)
    return NextSamplePosition(0.0, False)


def excludes_exchange(left: SpectrumSample, right: SpectrumSample, may_hold_two_exchanges: bool) -> bool:
    """Whether the slopes at two close samples, `left` and `right`, exclude that the leading eigenvalue
    changes between real and complex, although `next_sample_between` requests a sample between them.
    may_hold_two_exchanges: this field of that function's result. The leading eigenvalue must be real at both
    samples, or a pair at both samples."""
    return two_pairs_exchange_lead(left, right) or (
        not may_hold_two_exchanges and next_two_stay_below_leader(left, right)
    )


def next_two_stay_below_leader(left: SpectrumSample, right: SpectrumSample) -> bool:
    """Whether the slopes exclude that the two eigenvalues after the leading eigenvalue or pair take the lead
    between the samples `left` and `right`. These two eigenvalues may be real or a complex pair. The leading
    eigenvalue must be real at both samples, or a pair at both samples."""
    left_gaps = left.scaled_mean_and_product_of_next_gaps()
    right_gaps = right.scaled_mean_and_product_of_next_gaps()
    if left_gaps is None or right_gaps is None:
        return False
    distance = right.p - left.p
    return all(_stays_positive(a, b, distance) for a, b in zip(left_gaps, right_gaps, strict=True))


def two_pairs_exchange_lead(left: SpectrumSample, right: SpectrumSample) -> bool:
    """Whether the slopes show that the first two pairs at `left` are the first two pairs at `right` in the
    opposite order, and exclude that one of the two pairs becomes real between the samples."""
    # Four complex eigenvalues are two pairs; a real one among them would be an exchange of another kind.
    if any(w.imag == 0 for sample in (left, right) for w in sample.w):
        return False
    distance = right.p - left.p
    # The index changes from 0 to 2 because the same pair is first at one sample and second at the other.
    return _changes_sign_once(
        left.scaled_growth_gap_and_slope(0, 2), right.scaled_growth_gap_and_slope(2, 0), distance
    ) and all(
        _stays_positive(left.scaled_squared_frequency(i), right.scaled_squared_frequency(2 - i), distance)
        for i in (0, 2)
    )


def has_only_double_eigenvalue(left: SpectrumSample, right: SpectrumSample) -> bool:
    """Whether the slopes at the samples `left` and `right` show that the leading eigenvalue changes only once
    between them: at a double eigenvalue, from real at one sample to a complex pair at the other."""
    squares = left.scaled_squared_difference_and_slope(), right.scaled_squared_difference_and_slope()
    if squares[0] is None or squares[1] is None:
        return False
    distance = right.p - left.p
    # The mean of the two leading eigenvalues is smooth where they become a pair.
    return _changes_sign_once(squares[0], squares[1], distance) and _stays_positive(
        left.scaled_pair_growth_gap_and_slope(), right.scaled_pair_growth_gap_and_slope(), distance
    )


def has_only_leader_exchange(left: SpectrumSample, right: SpectrumSample) -> bool:
    """Whether the slopes show that, between the samples `left` and `right`, a real eigenvalue and a pair
    exchange the lead once and no other eigenvalue takes the lead. False unless the first three eigenvalues of
    both samples are one real eigenvalue and one pair."""
    # Indices of the real eigenvalue and of one eigenvalue of the pair; index 3 is the next eigenvalue.
    indices = [(2, 0) if sample.oscillates else (0, 1) for sample in (left, right)]
    ((real_left, pair_left), (real_right, pair_right)) = indices
    samples = ((left, real_left, pair_left), (right, real_right, pair_right))
    if any(sample.w[real].imag != 0 or sample.w[pair].imag == 0 for sample, real, pair in samples):
        return False
    distance = right.p - left.p
    return (
        _changes_sign_once(
            left.scaled_growth_gap_and_slope(*indices[0]),
            right.scaled_growth_gap_and_slope(*indices[1]),
            distance,
        )
        and _stays_positive(
            left.scaled_growth_gap_and_slope(real_left, 3),
            right.scaled_growth_gap_and_slope(real_right, 3),
            distance,
        )
        and _stays_positive(
            left.scaled_growth_gap_and_slope(pair_left, 3),
            right.scaled_growth_gap_and_slope(pair_right, 3),
            distance,
        )
        and _stays_positive(
            left.scaled_squared_frequency(pair_left), right.scaled_squared_frequency(pair_right), distance
        )
    )


def _stays_positive(left: tuple[float, float], right: tuple[float, float], distance: float) -> bool:
    """Whether a quantity is positive between two samples: its slopes agree with its change, and its cubic
    interpolant stays above zero. left, right: (value, slope) at the samples. distance: distance of the
    samples."""
    (a, slope_a), (b, slope_b) = left, right
    smallest_value = min(a, b)
    minimum, _ = cubic_minimum_and_position(a, b, distance * slope_a, distance * slope_b)
    unexplained_change = deviation_from_trapezoidal_rule(left, right, distance)
    return (
        # The limit 0 refuses a negative value at a sample, for which the first part alone would hold.
        minimum >= SPECTRUM_SAMPLE_SETTINGS.interpolation_tolerance * smallest_value > 0
        and unexplained_change
        <= SPECTRUM_SAMPLE_SETTINGS.interpolation_tolerance * max(smallest_value, abs(b - a))
    )


def _changes_sign_once(left: tuple[float, float], right: tuple[float, float], distance: float) -> bool:
    """Whether a quantity has opposite signs at two samples, and its change agrees with the change by the
    trapezoidal rule from its slopes. left, right: (value, slope) at the samples. distance: distance of the
    samples."""
    change = abs(right[0] - left[0])
    return (
        left[0] * right[0] < 0
        and deviation_from_trapezoidal_rule(left, right, distance)
        <= SPECTRUM_SAMPLE_SETTINGS.interpolation_tolerance * change
    )


def deviation_from_trapezoidal_rule(
    left: tuple[float, float], right: tuple[float, float], distance: float
) -> float:
    """Modulus of the difference between the change of a quantity from `left` to `right` and its change by the
    trapezoidal rule. left, right: (value, slope) at the samples. distance: distance of the samples."""
    return abs(right[0] - left[0] - distance * (left[1] + right[1]) / 2)
