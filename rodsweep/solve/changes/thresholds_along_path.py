"""Search for all thresholds along a path of rods (`threshold_kinds`): pairs that cross the imaginary axis,
and exchanges of the leading eigenvalue.

The crossings come from a cover of the (eigenvalue, parameter) region with boxes (`covering`), or for
nonuniform arms from `arm.crossings`; exchanges from `leader_exchanges`. Winding numbers confirm the counts.
"""

import math
from dataclasses import dataclass, replace

from ...determinant.certificate.covering import CrossingBox, zeros_and_open_boxes_of_covering
from ...determinant.certificate.first_crossing_boxes import first_crossing_boxes
from ...determinant.parameter_path import ParameterPath, coefficients_at, determinant_value_on_path
from ...determinant.roots.newton import LocatedEigenvalue
from ..unsolvable import Unsolvable
from .arm.crossings import CrossingSearch
from .arm.path import ArmPath, path_problem
from .leader_exchanges import LeaderExchangeSearch
from .path_problem import PathEigenproblem
from .search_range import SearchEnd
from .threshold_kinds import Threshold, crossing_kind
from .unstable_modes import UnstableModeCounter


@dataclass(frozen=True, slots=True, kw_only=True)
class ThresholdSettings:
    """Settings of the search for all thresholds along a path."""

    sample_to_crossing_path_fraction: float = 1e-4
    """Distance, over the length of the path, of samples added beside a crossing whose pair must lead, as the
    only unstable mode, but does not lead according to the exchanges found."""
    max_relative_merged_gap: float = 1e-5
    """Undecided boxes are merged if the gap between them is at most this number times the parameter."""


THRESHOLD_SETTINGS = ThresholdSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class ThresholdSearchResult:
    """All thresholds along a path, by increasing parameter. unstable_at_start, unstable_at_end: number of
    unstable modes at both ends, -1 if unknown."""

    thresholds: tuple[Threshold, ...] = ()
    searched_interval: tuple[float, float] = (math.nan, math.nan)
    """Searched interval of the parameter; all other fields refer to this interval."""
    ended_early: bool = False
    """Whether the searched interval is shorter than the requested interval, at its end or, in a row of a
    diagram, at its start; the reason is in `doubt_text`."""
    range_of_further_crossings: tuple[float, float] = (math.nan, math.nan)
    """Smallest interval that contains all possible further crossings; (nan, nan) if there are none."""
    unstable_at_start: int = -1
    unstable_at_end: int = -1
    oscillates_at_start: bool = False
    """Whether a complex pair leads at the start of the path."""
    is_proved: bool
    """Whether a proof succeeded: crossings complete, counts consistent, leading eigenvalues proved."""
    determinant_evaluation_count: int = 0
    """Number of evaluations of D over boxes of the (eigenvalue, parameter) region; 0 for nonuniform arms."""
    eigenvalue_solve_count: int = 0
    """Number of solved eigenvalue problems."""
    doubt_text: str = ""
    """Reasons why the list is not proved or the search ended early."""

    @property
    def is_proved_to_the_end(self) -> bool:
        """Whether the list is proved complete in the whole requested interval."""
        return self.is_proved and not self.ended_early


@dataclass(frozen=True, slots=True)
class PathCrossings:
    """Crossings of the imaginary axis along `path`. undecided_intervals: intervals of the parameter that may
    contain further crossings. search_end: end of the search. determinant_evaluation_count: number of
    evaluations of D for the cover by boxes."""

    path: ParameterPath
    crossings: list[Threshold]
    undecided_intervals: list[tuple[float, float]]
    search_end: SearchEnd
    determinant_evaluation_count: int = 0

    def restricted_to(self, search_end: SearchEnd) -> "PathCrossings":
        """The crossings and undecided intervals up to `search_end`, at or before the current end."""
        if search_end.p == self.search_end.p:
            return self
        coordinate = self.path.coordinate
        crossings = [c for c in self.crossings if coordinate(c.value) <= search_end.p]
        # A gap that only begins before the end is kept: its part within the searched range is still open.
        gaps = [gap for gap in self.undecided_intervals if min(map(coordinate, gap)) <= search_end.p]
        return replace(self, crossings=crossings, undecided_intervals=gaps, search_end=search_end)

    def searched_interval(self, start: float, stop: float) -> tuple[float, float]:
        """The searched part (low, high) of the requested parameter interval from `start` to `stop`."""
        if not self.search_end.reason:
            return start, stop
        end = self.path.parameter.value(self.search_end.p)
        return (end, stop) if self.path.is_compliance_path else (start, end)


def find_thresholds(
    path: ParameterPath, start: float, stop: float, certify: bool = True, max_crossings: float = math.inf
) -> ThresholdSearchResult:
    """All thresholds along `path` for parameter values from `start` to `stop`; `certify` requests a proof.

    The search ends early at a rod whose eigenvalues cannot be computed, and for a nonuniform arm after more
    than `max_crossings` crossings. Raises Unsolvable if not even the first interval can be searched, or if no
    a-priori bound applies."""
    low, high = sorted((path.coordinate(start), path.coordinate(stop)))
    problem = path_problem(path)
    crossings = _crossings(problem, (low, high), certify, max_crossings)
    search = LeaderExchangeSearch(problem, certify)
    edges = problem.interval_edges(low, high)
    # A second round, with samples close to it, only if a pair on the axis was not found to lead.
    for _ in range(2):
        end_p = crossings.search_end.p
        exchanges, end = search.exchanges_and_search_end([*(p for p in edges if p < end_p), end_p])
        crossings = crossings.restricted_to(end) if end.reason else crossings
        ends = crossings.searched_interval(start, stop)
        counter = UnstableModeCounter(problem, crossings.undecided_intervals, certify)
        # Without load the operator is self-adjoint and negative: no mode is unstable, no count is needed.
        is_unloaded = path.parameter_name == "F" and start == 0
        start_count = 0 if is_unloaded else counter.count_at_start(*ends, crossings.crossings)
        oscillates = search.sample_at(path.coordinate(ends[0])).oscillates
        ordered = sorted(exchanges + crossings.crossings, key=lambda c: c.value)
        thresholds, end_count = counter.thresholds_with_counts_and_end_count(ordered, ends, start_count)
        missed_p = _crossings_contradicting_exchanges(path, thresholds, oscillates, start_count)
        if not missed_p:
            break
        distance = THRESHOLD_SETTINGS.sample_to_crossing_path_fraction * (high - low)
        sample_p = [p + sign * distance for p in missed_p for sign in (-1, 1)]
        edges = sorted({*edges, *(p for p in sample_p if low < p < high)})
    else:
        counter.doubts.append("a pair crosses the imaginary axis, but another eigenvalue grows faster")
    if certify and not search.leading_eigenvalues_proved:
        counter.doubts.append("it is not proved everywhere in the range which eigenvalue leads")
    result = _search_result(crossings, (start, stop), counter, thresholds, (start_count, end_count))
    return replace(result, oscillates_at_start=oscillates, eigenvalue_solve_count=problem.solve_count)


def find_imaginary_axis_crossings(
    path: ParameterPath, start: float, stop: float, certify: bool = True, max_crossings: float = math.inf
) -> ThresholdSearchResult:
    """Crossings of the imaginary axis by pairs between the parameter values `start` and `stop`, without
    exchanges of the leading eigenvalue, in half the time of `find_thresholds`. certify: whether a proof is
    requested. With `certify`, the result is `is_proved` if no further crossing is possible and every count
    agrees. Other arguments, early ends and errors: as for `find_thresholds`."""
    low, high = sorted((path.coordinate(start), path.coordinate(stop)))
    problem = path_problem(path)
    path_crossings = _crossings(problem, (low, high), certify, max_crossings)
    counter = UnstableModeCounter(problem, path_crossings.undecided_intervals, certify)
    ends = path_crossings.searched_interval(start, stop)
    ordered = sorted(path_crossings.crossings, key=lambda c: c.value)
    count = 0 if path.parameter_name == "F" and start == 0 else counter.count_at_start(*ends, ordered)
    crossings, end_count = counter.thresholds_with_counts_and_end_count(ordered, ends, count)
    return _search_result(path_crossings, (start, stop), counter, crossings, (count, end_count))


def _search_result(
    crossings: PathCrossings,
    interval: tuple[float, float],
    counter: UnstableModeCounter,
    thresholds: tuple[Threshold, ...],
    end_counts: tuple[int, int],
) -> ThresholdSearchResult:
    """The result of a search that found `thresholds` in the searched part of the requested `interval`, with
    the reason if the search ended early. crossings: crossings of the imaginary axis, with the end of the
    search. counter: undecided gaps, and doubts. end_counts: numbers of unstable modes at both ends."""
    starts, ends = zip(*counter.gaps, strict=True) if counter.gaps else ((math.nan,), (math.nan,))
    is_known = all(number >= 0 for number in (*end_counts, *(c.unstable_after for c in thresholds)))
    reason = crossings.search_end.reason
    end = crossings.path.parameter.value(crossings.search_end.p)
    message = f"the search ends at {crossings.path.parameter_name} = {end:.12g}: {reason}" if reason else ""
    return ThresholdSearchResult(
        thresholds=thresholds,
        searched_interval=crossings.searched_interval(*interval),
        ended_early=bool(reason),
        range_of_further_crossings=(min(starts), max(ends)),
        unstable_at_start=end_counts[0],
        unstable_at_end=end_counts[1],
        is_proved=counter.certify and not counter.gaps and not counter.doubts and is_known,
        determinant_evaluation_count=crossings.determinant_evaluation_count,
        doubt_text="; ".join(filter(None, (message, *counter.doubts))),
    )


def _crossings(
    problem: PathEigenproblem, p_ends: tuple[float, float], certify: bool, max_crossings: float
) -> PathCrossings:
    """Crossings for path variables in `p_ends`: by boxes, or for nonuniform arms by counts of unstable modes
    (argument principle), proved if `certify`. max_crossings: number of crossings beyond which the search for
    nonuniform arms ends."""
    if not isinstance(problem, ArmPath):
        return _crossings_by_covering(problem.path, *p_ends)
    search = CrossingSearch(problem, certify)
    crossings, search_end = search.crossings_and_search_end(problem.interval_edges(*p_ends), max_crossings)
    value = problem.path.parameter.value
    gaps = [(min(gap), max(gap)) for gap in ((value(a), value(b)) for a, b in search.gaps)]
    return PathCrossings(problem.path, crossings, gaps, search_end)


def _crossings_by_covering(path: ParameterPath, low: float, high: float) -> PathCrossings:
    """Crossings for path variables from `low` to `high`, by boxes; raises Unsolvable if no a-priori bound
    applies."""
    boxes = first_crossing_boxes(path, low, high)
    if boxes is None:
        ends = f"from {path.text_at(low)} to {path.text_at(high)}"
        raise Unsolvable(f"no a-priori bound on the eigenvalues applies to all rods {ends}")
    zeros, undecided, box_count = zeros_and_open_boxes_of_covering(boxes, path.origin, path.direction)
    inner_zeros = [
        zero for zero in zeros if low <= zero.p + zero.error_of_p and zero.p - zero.error_of_p <= high
    ]
    crossings = [_hopf_crossing(path, zero) for zero in inner_zeros]
    return PathCrossings(path, crossings, _undecided_intervals(path, undecided), SearchEnd(high), box_count)


def _crossings_contradicting_exchanges(
    path: ParameterPath, crossings: tuple[Threshold, ...], oscillates: bool, unstable_count: int
) -> list[float]:
    """Path variables of the crossings whose pair must lead, as the only unstable mode, but does not lead by
    the exchanges. oscillates: whether a pair leads at the start. unstable_count: its value at the start."""
    missed_p = []
    for crossing in crossings:
        if crossing.kind.switches_real_and_complex:
            oscillates = crossing.kind.pair_leads_after
        else:
            if min(unstable_count, crossing.unstable_after) == 0 and not oscillates:
                missed_p.append(path.coordinate(crossing.value))
            unstable_count = crossing.unstable_after
    return missed_p


def _hopf_crossing(path: ParameterPath, zero: LocatedEigenvalue) -> Threshold:
    """Crossing of the imaginary axis at `zero`, a zero of D on this axis."""
    coefficients = coefficients_at(zero.p, path.origin, path.direction)
    value = determinant_value_on_path(complex(0.0, zero.eta_or_x), coefficients, path.direction)
    kind = crossing_kind(path, (-value.D_p / value.D_w).real > 0)  # dw/dp = -D_p/D_w
    parameter_value, error = path.value_and_error(zero.p, zero.error_of_p)
    return Threshold(parameter_value, kind, zero.eta_or_x, 0.0, error, frequency_error=zero.error_of_eta_or_x)


def _undecided_intervals(path: ParameterPath, undecided: list[CrossingBox]) -> list[tuple[float, float]]:
    """Disjoint intervals of the parameter covered by the boxes `undecided`."""
    gaps: list[tuple[float, float]] = []
    for a, b in sorted(sorted((path.coordinate(box.p_from), path.coordinate(box.p_to))) for box in undecided):
        if gaps and a <= gaps[-1][1] * (1 + THRESHOLD_SETTINGS.max_relative_merged_gap):
            gaps[-1] = gaps[-1][0], max(b, gaps[-1][1])
        else:
            gaps.append((a, b))
    return gaps
