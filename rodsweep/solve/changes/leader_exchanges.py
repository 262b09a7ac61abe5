"""Exchanges of the leading eigenvalue along a path of rods: from real to a complex pair, or back.

An exchange happens in two ways. At a double eigenvalue, D = D_w = 0, two real eigenvalues become a pair or a
pair becomes two real eigenvalues. In an overtaking, a real eigenvalue and a pair exchange the lead without
becoming equal. A sample is a rod whose leading eigenvalues come from the spectrum solver, certified on
request. Between two samples, cubic interpolation must explain two smooth quantities: the squared difference
of the two leading eigenvalues, and the difference in real part between the leading eigenvalue and the next
eigenvalue of the opposite kind (real or complex). Otherwise a sample is added between the two samples.
Newton's method on the determinant D finds each exchange, and the winding number proves that no eigenvalue
lies to the right of the eigenvalues that exchange the lead. The slopes must also exclude further exchanges
between the two samples; otherwise samples are added on both sides of the exchange.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ..spectrum.search import SpectrumRequest
from ..spectrum.status import SpectrumStatus
from ..unsolvable import Unsolvable
from .exchange_newton import double_eigenvalue_between, overtaking_between
from .path_problem import PathEigenproblem
from .sample_interpolation import (
    excludes_exchange,
    has_only_double_eigenvalue,
    has_only_leader_exchange,
    next_sample_between,
)
from .search_range import IntervalQueue, SearchEnd
from .spectrum_samples import SpectrumSample
from .threshold_kinds import Threshold, ThresholdKind

SAMPLED_MODE_COUNT = 4
"""Number of leading eigenvalues of a sample: the first two, and two that may overtake the first two. The
number is a constant, because with fewer eigenvalues it would be unknown which eigenvalues become equal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaderExchangeSettings:
    """Settings of the search for exchanges of the leading eigenvalue between samples: rods of the path whose
    leading eigenvalues are computed."""

    eigenvalue_accuracy: float = 1e-6
    """Relative accuracy of the eigenvalues at a sample, before the refinement by Newton's method on D."""
    close_sample_path_fraction: float = 2e-4
    """Two samples are close if their distance is at most this fraction of the path's length. Only between
    close samples may the slopes of the eigenvalues exclude an exchange (`excludes_exchange`)."""
    min_interval_fraction: float = 1e-8
    """A sample is added between two samples only if their distance, as a fraction of the path's length,
    exceeds this number. Three real eigenvalues of cones meet within 4e-7 of the path."""
    max_samples_without_spacing_limit: int = 1000
    """If the search has more samples than this number, a sample is added between two samples only if they are
    not close, see `close_sample_path_fraction`."""
    sample_offset_interval_fraction: float = 1e-3
    """If further exchanges may lie between two samples, a sample is added on either side of the exchange
    found, at a distance of this fraction of the distance between the two samples."""
    min_interval_fraction_with_two_exchanges: float = 1e-9
    """Value that replaces `min_interval_fraction` if the interpolation does not exclude two exchanges between
    two samples."""
    min_subinterval_fraction: float = 0.05
    """Smallest distance of an added sample from the two samples between which it lies, divided by their
    distance. A minimum of the interpolant, at which a sample is added, may coincide with one of the two
    samples."""
    max_newton_displacement_in_errors: float = 10.0
    """The eigenvalue w found by Newton's method is rejected as a different eigenvalue if its distance from
    the start exceeds both this multiple of the start's error estimate and `max_relative_newton_displacement`
    times |w|, or if another eigenvalue of the sample is nearer to w than the start is."""
    max_relative_newton_displacement: float = 1e-12
    """The eigenvalue w found by Newton's method is never rejected if its distance from the starting value of
    the method is at most this multiple of |w|: some thousand rounding errors."""
    min_relative_interval_length: float = 1e-12
    """If no exchange is found between two samples with a real and a complex leading eigenvalue, the search
    fails once the interval is at most this fraction of the larger |p| of the two: some thousand rounding
    errors."""


LEADER_EXCHANGE_SETTINGS = LeaderExchangeSettings()


class LeaderExchangeSearch:
    """Finds the exchanges of the leading eigenvalue along a path of rods. samples: rods of the path whose
    leading eigenvalues are computed, by path variable p."""

    def __init__(self, problem: PathEigenproblem, certify: bool):
        self.problem = problem
        self.path = problem.path
        self.certify = certify
        self.samples: dict[float, SpectrumSample] = {}
        self.leading_eigenvalues_proved = certify
        """Whether all samples are certified, no undecided interval is left, and counts prove at each exchange
        that no further eigenvalue lies to the right."""

    def sample_at(self, p: float) -> SpectrumSample:
        """The sample at path variable p, solved at the first call; raises Unsolvable."""
        if p not in self.samples:
            self.samples[p] = self._solve_sample(p)
        return self.samples[p]

    def _solve_sample(self, p: float) -> SpectrumSample:
        request = SpectrumRequest(
            SAMPLED_MODE_COUNT, LEADER_EXCHANGE_SETTINGS.eigenvalue_accuracy, self.certify
        )
        spectrum = self.problem.spectrum(p, request)
        # With a mode on the imaginary axis the status is undecided, but no mode is missing.
        self.leading_eigenvalues_proved &= spectrum.certified or spectrum.status == SpectrumStatus.undecided
        if not np.isfinite(spectrum.eigenvalues).all():
            place = self.path.text_at(p)
            text = f"the spectrum at {place} has the status {spectrum.status.name}: {spectrum.message}"
            raise Unsolvable(text.rstrip(": "))
        # A copy, because the stored spectrum is shared.
        w = spectrum.eigenvalues.copy()
        slope = np.empty(SAMPLED_MODE_COUNT, dtype=complex)
        for i, guess in enumerate(spectrum.eigenvalues):
            # Newton's method may jump to another eigenvalue, as in a cluster; the first value then stays.
            refined_w, slope[i], _ = self.problem.eigenvalue_with_slope_and_error(complex(guess), p)
            error = LEADER_EXCHANGE_SETTINGS.max_newton_displacement_in_errors * spectrum.error_estimate[i]
            max_distance = max(error, LEADER_EXCHANGE_SETTINGS.max_relative_newton_displacement * abs(guess))
            distances = np.abs(spectrum.eigenvalues - refined_w)
            if distances[i] <= min(max_distance, distances.min()):
                w[i] = refined_w
        return SpectrumSample(p, w, slope, *self.problem.relaxation_time_and_slope(p))

    def exchanges_and_search_end(self, edges: list[float]) -> tuple[list[Threshold], SearchEnd]:
        """Returns (exchanges, end of the search). exchanges: all exchanges by increasing p, from the first of
        `edges` to the end of the search. edges: increasing values of p that divide the path into the first
        intervals. Raises Unsolvable if the search ends at the first edge."""
        exchanges: list[Threshold] = []
        intervals = IntervalQueue(edges)
        self.sample_at(edges[0])
        for a, b in intervals:
            try:
                exchanges += self._search_interval(a, b, intervals)
            except Unsolvable as reason:
                intervals.limit_search_to_left_half((a, b), str(reason))
        return exchanges, intervals.end

    def _search_interval(self, a: float, b: float, intervals: IntervalQueue) -> list[Threshold]:
        """The exchange between the samples at a and b, in a list; an empty list if there is none, or if the
        test is undecided. An undecided interval is divided into two entries of `intervals`; if it is too
        short for that, `leading_eigenvalues_proved` becomes False. Raises Unsolvable."""
        left_sample = self.sample_at(a)
        right_sample = self.sample_at(b)
        fraction = 0.5
        if left_sample.oscillates == right_sample.oscillates:
            fraction, may_hold_two = next_sample_between(left_sample, right_sample)
            settings = LEADER_EXCHANGE_SETTINGS
            min_interval = (
                settings.min_interval_fraction_with_two_exchanges
                if may_hold_two
                else settings.min_interval_fraction
            )
            if len(self.samples) > settings.max_samples_without_spacing_limit:
                min_interval = settings.close_sample_path_fraction
            is_close = b - a <= settings.close_sample_path_fraction * intervals.length
            if fraction == 0.0 or (is_close and excludes_exchange(left_sample, right_sample, may_hold_two)):
                return []
            # Two exchanges may lie in an interval too short to divide: the list then is not proved.
            if b - a <= min_interval * intervals.length:
                self.leading_eigenvalues_proved = False
                return []
        else:
            exchange = self._exchange_between(left_sample, right_sample)
            if exchange is not None:
                return self._exchange_if_alone(exchange, left_sample, right_sample, intervals)
            if b - a <= LEADER_EXCHANGE_SETTINGS.min_relative_interval_length * max(abs(a), abs(b)):
                raise Unsolvable(
                    f"no point was found near {self.path.text_at(a)} at which the leading eigenvalue turns "
                    "from real to complex or back"
                )
        min_part_ratio = LEADER_EXCHANGE_SETTINGS.min_subinterval_fraction
        middle = a + min(max(fraction, min_part_ratio), 1 - min_part_ratio) * (b - a)
        intervals.add_subintervals((a, middle), (middle, b))
        return []

    def _exchange_if_alone(
        self, exchange: Threshold, left: SpectrumSample, right: SpectrumSample, intervals: IntervalQueue
    ) -> list[Threshold]:
        """A list with the exchange `exchange` between the samples `left` and `right`, if no further exchange
        lies between them. Otherwise an empty list, and the interval is divided on both sides of the exchange
        into entries of `intervals`; if it is too short for that, the list contains the exchange, and
        `leading_eigenvalues_proved` becomes False."""
        excludes_others = has_only_double_eigenvalue if exchange.frequency == 0 else has_only_leader_exchange
        if excludes_others(left, right):
            return [exchange]
        length = right.p - left.p
        if length <= LEADER_EXCHANGE_SETTINGS.min_interval_fraction_with_two_exchanges * intervals.length:
            self.leading_eigenvalues_proved = False
            return [exchange]
        p = self.path.coordinate(exchange.value)
        distance = LEADER_EXCHANGE_SETTINGS.sample_offset_interval_fraction * length
        sample_p = sorted({left.p, max(left.p, p - distance), min(right.p, p + distance), right.p})
        intervals.add_subintervals(*pairwise(sample_p))
        return []

    def _exchange_between(self, left: SpectrumSample, right: SpectrumSample) -> Threshold | None:
        """The exchange between the samples `left` and `right`, one with a leading pair and one with a real
        leading eigenvalue. None if Newton's method finds no exchange, or if a count shows that eigenvalues
        with larger real parts exist at the point found."""
        pair_sample, real_sample = (left, right) if left.oscillates else (right, left)
        # Kinds are named in the direction of the parameter, along a stiffness the direction of falling p.
        if right.oscillates != self.path.is_compliance_path:
            double_kind = ThresholdKind.onset
            overtaking_kind = ThresholdKind.pair_leads
        else:
            double_kind = ThresholdKind.real_again
            overtaking_kind = ThresholdKind.real_leads
        for find_exchange, kind, next_index in (
            (double_eigenvalue_between, double_kind, 2),
            (overtaking_between, overtaking_kind, 3),
        ):
            exchange = find_exchange(self.problem, pair_sample, real_sample)
            if exchange is None or not left.p <= exchange.p <= right.p:
                continue
            # Counted halfway to the next eigenvalue: only the exchanged eigenvalues may lie to the right.
            next_growth = max(left.w[next_index].real, right.w[next_index].real)
            if next_growth >= exchange.growth_rate:
                continue
            count = self.problem.count_right_of((exchange.growth_rate + next_growth) / 2, exchange.p)
            # A different count means that other eigenvalues lead; an undecided count leaves the exchange
            # unproved.
            if count.number in (next_index, None):
                self.leading_eigenvalues_proved = (
                    self.leading_eigenvalues_proved and count.number == next_index
                )
                value, error = self.path.value_and_error(exchange.p, exchange.error_of_p)
                return Threshold(value, kind, exchange.frequency, exchange.growth_rate, error)
        return None
