"""Thresholds of an arm for each drag of its range: flutter, frequency, restabilization. Forces: k3/L^2."""

from dataclasses import dataclass, replace
from math import inf, pi

from ..model.arm.arm import SlenderArm
from ..model.arm.drag import Drag
from ..solve.changes.status import ThresholdStatus
from ..solve.changes.threshold_kinds import Threshold, ThresholdKind
from ..solve.changes.thresholds import Thresholds, ThresholdsRequest, solve_thresholds
from ..solve.solve_lock import exclusive_solve
from .relative_load import SEARCH_END, SEARCH_ENDS_OF_VARYING_ARM, rod_with_drag

SEARCH_REQUEST = ThresholdsRequest(F_max=SEARCH_END, accuracy=1e-6, certify=True, max_thresholds=1000)
"""Request for all thresholds of an arm, with relative accuracy 1e-6 and a proof that none is missing."""
MIN_SEARCH_END_OVER_FLUTTER_AND_LOAD = 2.0
"""For an arm that varies along its length, the end of the search moves through `SEARCH_ENDS_OF_VARYING_ARM`
until it is at least this number times the first flutter force and this number times the load."""
KINDS_USED_BY_VERDICT = (
    ThresholdKind.onset,
    ThresholdKind.hopf,
    ThresholdKind.hopf_reverse,
    ThresholdKind.restabilization,
)
"""Kinds of the thresholds that a verdict uses; other exchanges of the leading eigenvalue do not matter."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ThresholdsWithDrag:
    """Thresholds of an arm for one drag. Forces are in k3/L^2, frequencies in Hz."""

    tau2: float
    """Viscous time scale of the arm, in s."""
    thresholds: Thresholds
    """Result of the search for thresholds along the force."""

    @property
    def is_usable(self) -> bool:
        """Whether the search gave thresholds. The search may have ended early, the list may be incomplete,
        and the thresholds may miss the accuracy; see `uncertainty_reason`."""
        return self.thresholds.status in (
            ThresholdStatus.ok,
            ThresholdStatus.ended_early,
            ThresholdStatus.not_certified,
            ThresholdStatus.accuracy_not_reached,
        )

    @property
    def uncertainty_reason(self) -> str:
        """Why usable thresholds are uncertain: a threshold of a kind in KINDS_USED_BY_VERDICT misses the
        accuracy, or the list is not proved complete; empty if the thresholds are certain."""
        search = self.thresholds
        accuracy = SEARCH_REQUEST.accuracy
        if any(
            c.error > accuracy * abs(c.value) for c in search.thresholds if c.kind in KINDS_USED_BY_VERDICT
        ):
            return f"a threshold misses the relative accuracy of {accuracy:g}"
        if search.search_result.is_proved:
            return ""
        return search.message or "the list of thresholds is not proved complete"

    def first_threshold(self, kind: ThresholdKind) -> Threshold | None:
        """The threshold of the given kind at the smallest force; None if no threshold has this kind."""
        return next((c for c in self.thresholds.thresholds if c.kind == kind), None)

    def first_frequency_hz(self, kind: ThresholdKind) -> float | None:
        """Frequency, in Hz, at the first threshold of the given kind; None if no threshold has this kind."""
        threshold = self.first_threshold(kind)
        return None if threshold is None else abs(threshold.frequency) / (2 * pi * self.tau2)

    def first_force(self, kind: ThresholdKind) -> float | None:
        """Force, in k3/L^2, at the first threshold of the given kind; None if no threshold has this kind."""
        threshold = self.first_threshold(kind)
        return None if threshold is None else threshold.value

    @property
    def second_flutter_force(self) -> float | None:
        """Force, in k3/L^2, at which the arm flutters again after its first restabilization; None if the arm
        does not flutter again."""
        stable_from = self.first_force(ThresholdKind.restabilization)
        hopf_forces = (c.value for c in self.thresholds.thresholds if c.kind == ThresholdKind.hopf)
        return None if stable_from is None else next((F for F in hopf_forces if stable_from < F), None)

    def is_unstable_at(self, F: float) -> bool:
        """Whether the straight arm is unstable at the force F. For an F beyond the end of the search, the
        stability at this end is returned."""
        unstable_counts = [c.unstable_after for c in self.thresholds.thresholds if c.value <= F]
        return bool(unstable_counts) and unstable_counts[-1] != 0

    def without_forces_above(self, end_force: float) -> "ThresholdsWithDrag":
        """A copy without the thresholds at forces larger than `end_force`."""
        result = self.thresholds
        kept_thresholds = tuple(c for c in result.thresholds if c.value <= end_force)
        shortened = replace(
            result, search_result=replace(result.search_result, thresholds=kept_thresholds), end=end_force
        )
        return replace(self, thresholds=shortened)


@dataclass(frozen=True, slots=True)
class RangeOverDrags:
    """Range of a quantity over the drags of an arm; drags for which the quantity does not exist are left out.
    low, high: smallest and largest value. exists_for_every_drag: whether the quantity exists for every
    drag."""

    low: float
    high: float
    exists_for_every_drag: bool = True


@dataclass(frozen=True, slots=True)
class ThresholdsOverDrags:
    """Thresholds of an arm for every drag of its range."""

    by_drag: tuple[ThresholdsWithDrag, ...]
    """Thresholds for each drag, the most likely drag first."""

    @property
    def failure_texts(self) -> list[str]:
        """Distinct error messages of failed searches; a search that stops before the requested force has not
        failed."""
        failed_searches = [f.thresholds for f in self.by_drag if not f.is_usable]
        return sorted({thresholds.message or thresholds.status.sentence for thresholds in failed_searches})

    @property
    def uncertainty_reasons(self) -> list[str]:
        """Distinct reasons for which thresholds, for some drags, are uncertain."""
        return sorted({f.uncertainty_reason for f in self.by_drag if f.is_usable} - {""})

    @property
    def end(self) -> float:
        """Largest force of the search, in k3/L^2; the same for all drags."""
        return self.by_drag[0].thresholds.end

    def first_force_range(self, kind: ThresholdKind) -> RangeOverDrags | None:
        """Range, over the drags, of the force at the first threshold of the given kind, in k3/L^2; None if no
        drag has such a threshold."""
        return range_over_drags([f.first_force(kind) for f in self.by_drag])

    @property
    def second_flutter_force_range(self) -> RangeOverDrags | None:
        """Range, over the drags, of the force at which the arm flutters again, in k3/L^2; None if it flutters
        again for no drag."""
        return range_over_drags([f.second_flutter_force for f in self.by_drag])

    def first_frequency_range(self, kind: ThresholdKind) -> RangeOverDrags | None:
        """Range, over the drags, of the frequency at the first threshold of the given kind, in Hz; None if no
        drag has such a threshold."""
        return range_over_drags([f.first_frequency_hz(kind) for f in self.by_drag])


def range_over_drags(values: list[float | None]) -> RangeOverDrags | None:
    """Range of the numbers in `values`, which may contain None; None if `values` contains no number."""
    known_values = [value for value in values if value is not None]
    if known_values:
        return RangeOverDrags(min(known_values), max(known_values), len(known_values) == len(values))
    return None


def thresholds_with_drag(arm: SlenderArm, drag: Drag, end_force: float = SEARCH_END) -> ThresholdsWithDrag:
    """All thresholds of the straight arm with the given drag, at forces from 0 to `end_force`."""
    thresholds = solve_thresholds(rod_with_drag(arm, drag), replace(SEARCH_REQUEST, F_max=end_force))
    return ThresholdsWithDrag(tau2=arm.tau2_with(drag), thresholds=thresholds)


@exclusive_solve
def thresholds_over_drags(arm: SlenderArm) -> ThresholdsOverDrags:
    """All thresholds of the straight arm for each drag, up to a force common to all drags. The search with
    the most likely drag sets this force. If a search stops at a smaller force, the smallest such force is the
    end for all drags."""
    likeliest_drag, *others = arm.base_drag_estimates
    end, first_result = _first_search_end_and_thresholds(arm, likeliest_drag)
    results = (first_result, *(thresholds_with_drag(arm, drag, end) for drag in others))
    common_end = min(thresholds.thresholds.end for thresholds in results)
    return ThresholdsOverDrags(tuple(thresholds.without_forces_above(common_end) for thresholds in results))


def _first_search_end_and_thresholds(arm: SlenderArm, drag: Drag) -> tuple[float, ThresholdsWithDrag]:
    """Returns (end, thresholds): the largest force requested, and the thresholds up to this force. `end` is
    SEARCH_END for an arm that does not vary. For other arms, `end` is the first number of
    SEARCH_ENDS_OF_VARYING_ARM that is at least MIN_SEARCH_END_OVER_FLUTTER_AND_LOAD times the first flutter
    force and a known load, or that the search did not reach; without such a number, the last number."""
    has_known_load = arm.load_name is not None and arm.load_over_flutter is None
    for end in SEARCH_ENDS_OF_VARYING_ARM if arm.geometry.varies_along_arm else (SEARCH_END,):
        thresholds = thresholds_with_drag(arm, drag, end)
        flutter = thresholds.first_force(ThresholdKind.hopf)
        min_end = max(inf if flutter is None else flutter, arm.F if has_known_load else 0.0)
        if MIN_SEARCH_END_OVER_FLUTTER_AND_LOAD * min_end <= end or thresholds.thresholds.end < end:
            break
    return end, thresholds
