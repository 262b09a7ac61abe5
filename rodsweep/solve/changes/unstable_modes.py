"""Number of unstable modes between the thresholds along a path of rods.

The directions of the crossings (`threshold_kinds`) give the number of unstable modes after every crossing.
Winding numbers confirm this number at both ends and between the crossings.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from .threshold_kinds import Threshold, ThresholdKind

if TYPE_CHECKING:
    from .path_problem import PathEigenproblem  # for annotations only: the module imports solvers


@dataclass(frozen=True, slots=True, kw_only=True)
class UnstableModeCountSettings:
    """Settings for counts of unstable modes between thresholds."""

    count_interval_fractions: tuple[float, ...] = (0.5, 0.3, 0.7)
    """Positions between two crossings, as fractions of the interval, at which the unstable modes are counted,
    in this order, until a count is decided."""
    min_relative_gap_between_crossings: float = 1e-3
    """Modes are not counted between two crossings at path variables a < b if (b - a)/|b| is at most this
    number, because a pair is then too close to the imaginary axis."""
    relative_strip_half_width: float = 1e-5
    """Distance from the imaginary axis, divided by a pair's frequency, at which modes are counted on both
    sides of the pair. The count on the axis is undecided for pairs within some 1e-6."""


UNSTABLE_MODE_COUNT_SETTINGS = UnstableModeCountSettings()


class UnstableModeCounter:
    """Number of unstable modes along a path, from the directions of the crossings, confirmed by winding
    numbers. gaps: intervals of the parameter that may contain crossings missing from the list. doubts:
    sentences on counts that are undecided or contradict the crossings."""

    def __init__(self, problem: "PathEigenproblem", gaps: list[tuple[float, float]], certify: bool):
        self.problem = problem
        self.path = problem.path
        self.gaps = gaps
        self.certify = certify
        self.doubts: list[str] = []

    def count_at(self, value: float) -> int:
        """Number of unstable modes at the parameter value `value`, by the winding number; -1 if undecided."""
        # Unstable modes are those to the right of the imaginary axis.
        number = self.problem.count_right_of(0.0, self.path.coordinate(value)).number
        return -1 if number is None else number

    def count_at_point_between(self, a: float, b: float) -> int:
        """Number of unstable modes at a position between the parameter values a and b, known already or by
        the winding number; -1 if the count is undecided at all positions tried."""
        # For nonuniform arms the search for crossings has counted the modes of some rods already.
        known_count = self.problem.known_unstable_count_near_middle(
            *sorted((self.path.coordinate(a), self.path.coordinate(b)))
        )
        if known_count is not None:
            return known_count
        # Near a pair almost on the axis a count is undecided, and another position may be farther from it.
        for fraction in UNSTABLE_MODE_COUNT_SETTINGS.count_interval_fractions:
            number = self.count_at(a + fraction * (b - a))
            if number >= 0:
                return number
        return -1

    def expected_count_if_confirmed(self, a: float, b: float, frequency: float, expected: int) -> int:
        """`expected`, if counts on both sides of the imaginary axis show that in the middle between the
        parameter values a and b exactly one pair is near the axis, and that with or without this pair
        `expected` modes are unstable; otherwise -1. frequency: frequency of the pair, in 1/tau2."""
        distance = UNSTABLE_MODE_COUNT_SETTINGS.relative_strip_half_width * frequency
        middle = self.path.coordinate((a + b) / 2)
        right = self.problem.count_right_of(distance, middle).number
        left = self.problem.count_right_of(-distance, middle).number
        is_one_pair = right is not None and left == right + 2
        return expected if is_one_pair and expected in (right, left) else -1

    def count_at_start(self, start: float, stop: float, crossings: list[Threshold]) -> int:
        """Number of unstable modes at `start`, before all crossings `crossings` of the imaginary axis up to
        the parameter value `stop`. If the count at `start` is undecided, as for a pair close to the axis, the
        number follows from a count before the first crossing, or from a count between later crossings and the
        directions of the crossings before. -1 if undecided."""
        # Beyond a gap the number of modes does not give the number before.
        end = min([stop, *(gap_start for gap_start, _ in self.gaps)])
        ordered = sorted((c for c in crossings if c.value - c.error < end), key=lambda c: c.value)
        # A crossing at `start` within its error may lie on either side: only a count after it is valid.
        if not ordered or start < ordered[0].value - ordered[0].error:
            number = self.count_at(start)
            if number >= 0:
                return number
        lower_edges = [start, *(c.value + c.error for c in ordered)]
        upper_edges = [*(c.value - c.error for c in ordered), end]
        change = 0
        for index, (a, b) in enumerate(zip(lower_edges, upper_edges, strict=True)):
            number = self.count_at_point_between(a, b) if a < b else -1
            if number >= 0:
                # A contradiction of crossings and count leaves the number unknown.
                return number - change if number >= change else -1
            if index < len(ordered):
                change += _change_of_count(ordered[index].kind)
        return -1

    def thresholds_with_counts_and_end_count(
        self, ordered_thresholds: list[Threshold], parameter_ends: tuple[float, float], unstable_count: int
    ) -> tuple[tuple[Threshold, ...], int]:
        """Returns (thresholds, at_end). thresholds: as `ordered_thresholds`, with `unstable_after` set, and
        with the kind restabilization where the last unstable pair becomes stable. at_end: number of unstable
        modes at the end. ordered_thresholds: thresholds by increasing parameter. parameter_ends: smallest and
        largest parameter value. unstable_count: number of unstable modes at the start. Unknown numbers are
        -1. `doubts` afterwards contains the doubts of this call only."""
        self.doubts = []
        counted_thresholds: list[Threshold] = []
        start = parameter_ends[0]
        frequency = 0.0
        for crossing in ordered_thresholds:
            kind = crossing.kind
            # Exchanges of the leading eigenvalue do not move an eigenvalue across the axis.
            if kind in (ThresholdKind.hopf, ThresholdKind.hopf_reverse):
                frequency = crossing.frequency
                unstable_count = self._count_before(start, crossing.value, unstable_count, frequency)
                start = crossing.value
                if unstable_count >= 0:
                    unstable_count += _change_of_count(kind)
                if kind == ThresholdKind.hopf_reverse and unstable_count == 0:
                    kind = ThresholdKind.restabilization
            counted_thresholds.append(replace(crossing, kind=kind, unstable_after=unstable_count))
        end = parameter_ends[1]
        return tuple(counted_thresholds), self._count_before(start, end, unstable_count, frequency)

    def _count_before(self, a: float, b: float, unstable_count: int, frequency: float) -> int:
        """Number of unstable modes just before b: `unstable_count`, the number just after a, compared with a
        count between a and b if `certify`; a contradiction is added to `doubts`. If a gap lies between a and
        b, the result is the number counted between the gap and b, or -1 if undecided. frequency: frequency,
        in 1/tau2, of the pair that crosses the axis at b or was the last to cross before; 0 if there is no
        crossing."""
        gaps_between = [gap for gap in self.gaps if gap[1] > a and gap[0] < b]
        if gaps_between:
            # A gap may hide crossings, so the modes are counted again after the gap.
            a = max(gap[1] for gap in gaps_between)
        # Without gaps the directions of the crossings give the number; a count only confirms it.
        elif not self.certify:
            return unstable_count
        # So close to two crossings their pairs are almost on the axis, and the count would be undecided.
        if b - a <= UNSTABLE_MODE_COUNT_SETTINGS.min_relative_gap_between_crossings * abs(b):
            return -1 if gaps_between else unstable_count
        count = self.count_at_point_between(a, b)
        if gaps_between or unstable_count < 0:
            return count
        # Between two close Hopf points their pair may be too near the axis at all positions.
        if count < 0 and frequency:
            count = self.expected_count_if_confirmed(a, b, frequency, unstable_count)
        if count != unstable_count:
            undecided_text = "the count of unstable modes is undecided"
            count_text = f"{count} modes are unstable" if count >= 0 else undecided_text
            self.doubts.append(
                f"{count_text} between {self.path.parameter_name} = {a:.12g} and {b:.12g}"
                + (f", but the crossings found imply {unstable_count}" if count >= 0 else "")
            )
        return unstable_count


def _change_of_count(kind: ThresholdKind) -> int:
    """Change of the number of unstable modes, 2 or -2, when the parameter increases through a crossing of the
    imaginary axis of this kind."""
    # Eigenvalues cross in conjugate pairs, as the determinant is real for real w; none crosses at w = 0.
    return 2 if kind == ThresholdKind.hopf else -2
