"""Crossings of the imaginary axis along a path of arms. No covering proves that the list is complete.

The unstable modes of selected arms of the path are counted. Between two arms whose counts differ by one pair,
Newton's method on the determinant D finds the crossing. Between two arms with equal counts, the slopes of the
pairs nearest to the axis must exclude two crossings; otherwise the modes of an arm between them are counted.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...unsolvable import Unsolvable
from ..search_range import IntervalQueue, SearchEnd
from ..threshold_kinds import Threshold, crossing_kind
from .imaginary_axis_modes import ArmModes, ModesAlongPath, interval_fraction_of_next_count
from .path import ArmPath


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmCrossingSettings:
    """Settings of the search for crossings along a path of arms."""

    max_growing_pairs_per_max_crossings: float = 2.0
    """Largest number of pairs expected to grow at the right end of an interval, divided by the maximum number
    of crossings; with more pairs the interval is halved before its search."""
    min_halved_interval_over_path: float = 1e-3
    """Intervals shorter than this fraction of the path are searched without being halved."""
    max_pairs_searched_at_once: int = 6
    """Where many modes grow, all crossings between two counted arms are searched at once if their counts
    differ by at most this many pairs."""
    searched_frequency_over_largest_w: float = 4.0
    """Modes near the axis at a crossing are searched up to |Im w| = this number * (largest known |w|)."""
    max_same_crossing_distance_in_errors: float = 10.0
    """Two crossings may be equal if their values differ by at most this multiple of their summed errors."""
    same_crossing_frequency_tolerance: float = 1e-6
    """Two crossings that may be equal by `max_same_crossing_distance_in_errors` are equal if the relative
    difference of their frequencies is at most this number."""
    min_interval_fraction: float = 1e-6
    """An interval with equal unstable counts at both ends is a gap if shorter than this path fraction."""
    min_relative_interval_length: float = 1e-12
    """The search fails at an interval without located crossings whose length, divided by the larger modulus
    of its ends, is at most this number: some thousand rounding errors."""
    count_to_crossing_path_fraction: float = 1e-5
    """Distance from a crossing, as a fraction of the path, at which the modes are counted on both sides."""
    max_newton_steps: int = 20
    """Maximum number of Newton steps for one crossing."""
    converged_step_in_errors: float = 4.0
    """Newton's method for a crossing stops when the step of p is at most this multiple of the error of p."""
    max_relative_frequency_error: float = 1e-2
    """A crossing with a larger relative error of its frequency is not located: from a poor guess, Newton's
    method for w may stop far from all roots of D, where errors are at least 0.16 (83 such stops)."""
    relative_rounding_of_path_variable: float = 4e-16
    """Relative rounding error of the path variable: two units in the last place."""


ARM_CROSSING_SETTINGS = ArmCrossingSettings()


class CrossingSearch:
    """Search for crossings along a path. crossings_by_p: crossings by path variable p. gaps: intervals of p
    that may contain two crossings, too short to be divided."""

    def __init__(self, problem: ArmPath, certify: bool):
        self.problem = problem
        self.axis_modes = ModesAlongPath(problem, certify)
        self.crossings_by_p: dict[float, Threshold] = {}
        self.gaps: list[tuple[float, float]] = []

    def crossings_and_search_end(
        self, edges: list[float], max_crossings: float
    ) -> tuple[list[Threshold], SearchEnd]:
        """Returns (crossings, end). crossings: all crossings from the first of `edges` to the end of the
        search, in increasing order of p. end: end of the search.

        The search ends after the first crossing beyond `max_crossings`: where dozens of modes grow, each
        further crossing takes longer than all earlier ones. Raises Unsolvable if the search ends at the first
        edge."""
        intervals = IntervalQueue(edges)
        count_distance = ARM_CROSSING_SETTINGS.count_to_crossing_path_fraction * intervals.length
        first, last = edges[0], edges[-1]
        self.axis_modes.outside_p_by_end = {first: first - count_distance, last: last + count_distance}
        self.axis_modes.modes_at(first)
        for a, b in intervals:
            if sum(p < a for p in self.crossings_by_p) > max_crossings:
                intervals.stop_at(a, f"more than {max_crossings:g} crossings; raise the option crossings")
                continue
            if self._must_be_halved(a, b, max_crossings, intervals.length):
                intervals.add_subintervals((a, (a + b) / 2), ((a + b) / 2, b))
                continue
            try:
                self._search_interval(a, b, intervals)
            except Unsolvable as reason:
                intervals.limit_search_to_left_half((a, b), str(reason))
                self.crossings_by_p = {p: crossing for p, crossing in self.crossings_by_p.items() if p <= a}
        ordered = [self.crossings_by_p[p] for p in sorted(self.crossings_by_p)]
        return [c for c in ordered if self._may_lie_within(c, first, last)], intervals.end

    def _may_lie_within(self, crossing: Threshold, low: float, high: float) -> bool:
        """Whether `crossing`, within its error, may lie between the path variables `low` and `high`."""
        ends = crossing.value - crossing.error, crossing.value + crossing.error
        first, last = sorted(map(self.problem.path.coordinate, ends))
        return first <= high and last >= low

    def _must_be_halved(self, a: float, b: float, max_crossings: float, length: float) -> bool:
        """Whether the interval (a, b) of p must be halved before its search: the interval is not short, the
        modes at b are not known, and the list of `max_crossings` crossings is likely to be full before b.
        length: length of the path."""
        is_short = b - a < ARM_CROSSING_SETTINGS.min_halved_interval_over_path * length
        if is_short or b in self.axis_modes.modes_by_p:
            return False
        max_pairs = ARM_CROSSING_SETTINGS.max_growing_pairs_per_max_crossings * 2 * max_crossings
        has_many_modes = self.axis_modes.computes_only_near_imaginary_axis(b)
        return has_many_modes and self.problem.expected_unstable_count(b) > max_pairs

    def _search_interval(self, a: float, b: float, intervals: IntervalQueue) -> None:
        """Searches the interval (a, b) of p: stores the crossings found, or divides the interval into entries
        of `intervals`, or stores the interval as a gap if it is too short to be divided; raises
        Unsolvable."""
        left_modes = self.axis_modes.modes_at(a)
        right_modes = self.axis_modes.modes_at(b)
        # Equal counts leave room for a pair that crosses and returns.
        if left_modes.unstable_count == right_modes.unstable_count:
            fraction = interval_fraction_of_next_count(left_modes, right_modes)
            if fraction == 0.0:
                return
            if b - a <= ARM_CROSSING_SETTINGS.min_interval_fraction * intervals.length:
                self.gaps.append((a, b))
                return
        else:
            fraction = 0.5
            crossings = self._crossings_between(left_modes, right_modes)
            length = intervals.length
            parts = self._intervals_between_crossings(crossings, left_modes, right_modes, length)
            if crossings and parts is not None:
                self.crossings_by_p.update((self.problem.path.coordinate(c.value), c) for c in crossings)
                intervals.add_subintervals(*parts)
                return
            if b - a <= ARM_CROSSING_SETTINGS.min_relative_interval_length * max(abs(a), abs(b)):
                place = self.problem.path.text_at(a)
                raise Unsolvable(f"the crossing of the imaginary axis near {place} could not be located")
        middle = a + fraction * (b - a)
        intervals.add_subintervals((a, middle), (middle, b))

    def _intervals_between_crossings(
        self, crossings: list[Threshold], left: ArmModes, right: ArmModes, length: float
    ) -> list[tuple[float, float]] | None:
        """The intervals of p from `left` to `right` outside the surroundings of `crossings`, which extend by
        `count_to_crossing_path_fraction` * `length` (length of the path) on both sides. None if a crossing is
        not located, or if the counts at the ends of its surroundings do not confirm it."""
        settings = ARM_CROSSING_SETTINGS
        intervals: list[tuple[float, float]] = []
        start = left.p
        largest_modulus = max(left.largest_modulus, right.largest_modulus)
        max_frequency = settings.searched_frequency_over_largest_w * largest_modulus
        for crossing in crossings:
            p = self.problem.path.coordinate(crossing.value)
            p_before = max(start, p - settings.count_to_crossing_path_fraction * length)
            p_after = min(right.p, p + settings.count_to_crossing_path_fraction * length)
            guesses = None
            if self.axis_modes.computes_only_near_imaginary_axis(p_before):
                w = np.array([1j * crossing.frequency])
                guesses = self.axis_modes.eigenvalues_near_imaginary_axis(p, max_frequency, w)
            count_after = self.axis_modes.modes_at(p_after, guesses).unstable_count
            count_change = count_after - self.axis_modes.modes_at(p_before, guesses).unstable_count
            # With a large error, another crossing may explain the counts.
            max_error = settings.max_relative_frequency_error * crossing.frequency
            is_located = crossing.frequency_error <= max_error
            if not is_located or count_change != (2 if right.unstable_count > left.unstable_count else -2):
                return None
            intervals.append((start, p_before))
            start = p_after
        return [*intervals, (start, right.p)]

    def _crossings_between(self, left: ArmModes, right: ArmModes) -> list[Threshold]:
        """Crossings between the arms with the modes `left` and `right`, in increasing order of p, that
        explain the change of the number of unstable modes; empty if a crossing is not found or the change is
        too large for one search."""
        pair_count_change = (right.unstable_count - left.unstable_count) // 2
        has_many_modes = self.axis_modes.computes_only_near_imaginary_axis(right.p)
        # Where modes are followed, bisection first separates several crossings.
        max_pairs = ARM_CROSSING_SETTINGS.max_pairs_searched_at_once if has_many_modes else 1
        if abs(pair_count_change) > max_pairs:
            return []
        if has_many_modes:
            self.problem.ensure_arm_family(left.p, right.p, max(left.largest_modulus, right.largest_modulus))
        becomes_unstable = pair_count_change > 0
        crossings_by_p: dict[float, Threshold] = {}
        # The pairs that cross are stable on one side and unstable on the other; pairs near the axis are
        # tried first.
        for start, growing in ((left, not becomes_unstable), (right, becomes_unstable)):
            pairs = [i for i, w in enumerate(start.w) if w.imag > 0 and (w.real > 0) == growing]
            for i in sorted(pairs, key=lambda i: abs(start.w[i].real)):
                crossing = self._newton_crossing(start, i, (left.p, right.p), becomes_unstable)
                if crossing is not None and not any(
                    _are_same_crossing(crossing, earlier) for earlier in crossings_by_p.values()
                ):
                    crossings_by_p[self.problem.path.coordinate(crossing.value)] = crossing
                if len(crossings_by_p) == abs(pair_count_change):
                    return [crossings_by_p[p] for p in sorted(crossings_by_p)]
        return []

    def _newton_crossing(
        self, start: ArmModes, i: int, p_ends: tuple[float, float], grows: bool
    ) -> Threshold | None:
        """The crossing of the imaginary axis by the eigenvalue with index i in `start.w`, by Newton's method
        for p; None if Newton's method does not converge within `p_ends`, or converges to another crossing.
        p_ends: allowed interval of p. grows: whether the growth rate of the pair increases with p."""
        p = start.p
        w = complex(start.w[i])
        slope = complex(start.slopes[i])
        settings = ARM_CROSSING_SETTINGS
        for _ in range(settings.max_newton_steps):
            if slope.real == 0 or not math.isfinite(slope.real):
                return None
            step = -w.real / slope.real
            p = p + step
            guess = w + slope * step
            if not p_ends[0] <= p <= p_ends[1]:
                return None
            w, slope, error = self.problem.eigenvalue_with_slope_and_error(guess, p)
            p_error = error / abs(slope.real) + settings.relative_rounding_of_path_variable * abs(p)
            if abs(w.real / slope.real) <= settings.converged_step_in_errors * p_error:
                max_error = settings.count_to_crossing_path_fraction * (p_ends[1] - p_ends[0])
                if self.axis_modes.computes_only_near_imaginary_axis(p) and not p_error <= max_error:
                    return None  # no root of D is resolved
                return self._crossing_at(p, w, slope, p_error, grows)
        return None

    def _crossing_at(
        self, p: float, w: complex, slope: complex, p_error: float, grows: bool
    ) -> Threshold | None:
        """The crossing of the pair w at p; None if w is real, or if its growth rate changes in the direction
        opposite to `grows`: w is then another pair. slope: dw/dp. p_error: error of p."""
        if w.imag <= 0 or (slope.real > 0) != grows:
            return None
        kind = crossing_kind(self.problem.path, grows)
        total_p_error = p_error + abs(w.real / slope.real)
        value, error = self.problem.path.value_and_error(p, total_p_error)
        frequency_error = (abs(slope.real) + abs(slope.imag)) * total_p_error  # by the errors of w and p
        return Threshold(value, kind, w.imag, 0.0, error, frequency_error=frequency_error)


def _are_same_crossing(first: Threshold, second: Threshold) -> bool:
    """Whether the crossings `first` and `second` are equal within the errors of the parameter and of the
    frequency."""
    max_distance = ARM_CROSSING_SETTINGS.max_same_crossing_distance_in_errors * (first.error + second.error)
    max_difference = ARM_CROSSING_SETTINGS.same_crossing_frequency_tolerance * first.frequency
    is_near = abs(first.value - second.value) <= max_distance
    return is_near and abs(first.frequency - second.frequency) <= max_difference
