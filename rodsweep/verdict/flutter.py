"""Thresholds of an arm over the range of drag: flutter, frequency, restabilization. Forces in k3/L^2."""

from dataclasses import dataclass, replace
from math import inf, pi

from ..model.arm.arm import SlenderArm
from ..model.arm.drag import Drag
from ..solve.changes.thresholds import Thresholds, ThresholdsRequest, ThresholdStatus, solve_thresholds
from ..solve.changes.unstable_modes import ChangeKind, Crossing
from ..solve.exclusive import solving
from .relative import ENDS_OF_VARIED, SEARCH_END, rod_with

SEARCH_REQUEST = ThresholdsRequest(F_max=SEARCH_END, accuracy=1e-6, certify=True, crossings=1000)
"""Search request for the thresholds of an arm: complete lists, thresholds to six digits."""
BEYOND_FLUTTER = 2.0
"""Smallest ratio of the last search's end to the first flutter and to the load, for an arm that varies."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FlutterForces:
    """Thresholds of an arm with one drag. Forces in k3/L^2, frequencies in Hz; None without a change."""

    tau2: float
    """Time scale, in s."""
    thresholds: Thresholds

    def first(self, kind: ChangeKind) -> Crossing | None:
        """The first change of a kind along the force."""
        return next((c for c in self.thresholds.crossings if c.kind == kind), None)

    def frequency(self, kind: ChangeKind) -> float | None:
        """Frequency at the first change of a kind, in Hz."""
        found = self.first(kind)
        return None if found is None else abs(found.frequency) / (2 * pi * self.tau2)

    def force(self, kind: ChangeKind) -> float | None:
        """Force at the first change of a kind, in k3/L^2."""
        found = self.first(kind)
        return None if found is None else found.at

    def unstable_at(self, F: float) -> bool:
        """Whether the straight arm is unstable at F, or at the end of the search for larger F."""
        before = [c.unstable_after for c in self.thresholds.crossings if c.at <= F]
        return bool(before) and before[-1] != 0

    def up_to(self, end: float) -> "FlutterForces":
        """The thresholds without the changes beyond the force `end`."""
        found = self.thresholds
        crossings = tuple(c for c in found.crossings if c.at <= end)
        cut = replace(found, transitions=replace(found.transitions, crossings=crossings), end=end)
        return replace(self, thresholds=cut)


@dataclass(frozen=True, slots=True)
class Span:
    """Smallest and largest value of a quantity over the range of drag.

    always: whether the quantity exists for every drag.
    """

    low: float
    high: float
    always: bool = True


@dataclass(frozen=True, slots=True)
class FlutterRange:
    """Thresholds of an arm for each drag, the likeliest drag first."""

    forces: tuple[FlutterForces, ...]

    @property
    def failures(self) -> list[str]:
        """Messages of failed searches, without repetition. A search that ended early has not failed."""
        searches = [f.thresholds for f in self.forces]
        usable = (ThresholdStatus.ok, ThresholdStatus.ended_early)
        return sorted({t.message or t.status.sentence for t in searches if t.status not in usable})

    @property
    def end(self) -> float:
        """Largest force of the search, in k3/L^2."""
        return self.forces[0].thresholds.end

    def force(self, kind: ChangeKind) -> Span | None:
        """Range of the force of the first change of a kind, in k3/L^2."""
        return span_of([f.force(kind) for f in self.forces])

    def frequency(self, kind: ChangeKind) -> Span | None:
        """Range of the frequency at the first change of a kind, in Hz."""
        return span_of([f.frequency(kind) for f in self.forces])

    def unstable_at(self, F: float) -> list[bool]:
        """Whether the straight arm is unstable at a force, for each drag."""
        return [f.unstable_at(F) for f in self.forces]


def span_of(values: list[float | None]) -> Span | None:
    """Smallest and largest number in a list of numbers and None; None without a number."""
    known = [value for value in values if value is not None]
    return Span(min(known), max(known), len(known) == len(values)) if known else None


def flutter_forces(arm: SlenderArm, drag: Drag, end: float = SEARCH_END) -> FlutterForces:
    """All changes of stability of an arm with one drag, up to the force `end`."""
    thresholds = solve_thresholds(rod_with(arm, drag), replace(SEARCH_REQUEST, F_max=end))
    return FlutterForces(tau2=arm.tau2_with(drag), thresholds=thresholds)


@solving
def flutter_range(arm: SlenderArm) -> FlutterRange:
    """All changes of stability of an arm for each drag, up to one force for all.

    The search with the likeliest drag sets the force; a search that ends early lowers it.
    """
    likeliest, *others = arm.drags
    end, first = _first_search(arm, likeliest)
    found = (first, *(flutter_forces(arm, drag, end) for drag in others))
    common = min(forces.thresholds.end for forces in found)
    return FlutterRange(tuple(forces.up_to(common) for forces in found))


def _first_search(arm: SlenderArm, drag: Drag) -> tuple[float, FlutterForces]:
    """(end of the search, changes of stability up to the end); the end is beyond first flutter and load."""
    known_load = arm.load is not None and arm.share_of_flutter is None
    for end in ENDS_OF_VARIED if arm.shape.varies else (SEARCH_END,):
        found = flutter_forces(arm, drag, end)
        flutter = found.force(ChangeKind.hopf)
        reached = max(inf if flutter is None else flutter, arm.F if known_load else 0.0)
        if BEYOND_FLUTTER * reached <= end or found.thresholds.end < end:
            break
    return end, found
