"""Where an arm flutters, how fast, and whether it returns, over its range of drag. Forces in k3/L^2."""

from dataclasses import dataclass
from math import pi

from ..model.arm.arm import SlenderArm
from ..model.arm.drag import Drag
from ..model.rod import Rod
from ..solve.changes.thresholds import Thresholds, ThresholdsRequest, solve_thresholds
from ..solve.changes.unstable_modes import Crossing, Kind
from ..solve.exclusive import solving
from .relative import FARTHEST

REQUEST = ThresholdsRequest(F_max=FARTHEST, accuracy=1e-6, certify=True, crossings=1000)


@dataclass(frozen=True, slots=True, kw_only=True)
class FlutterForces:
    """The changes of an arm with one drag; None where there is none. Forces in k3/L^2, frequencies in Hz."""

    tau2: float
    """In s."""
    thresholds: Thresholds

    def first(self, kind: Kind) -> Crossing | None:
        """The first change of a kind."""
        return next((c for c in self.thresholds.crossings if c.kind == kind), None)

    def frequency(self, kind: Kind) -> float | None:
        """At the first change of a kind, in Hz."""
        found = self.first(kind)
        return None if found is None else abs(found.frequency) / (2 * pi * self.tau2)

    def force(self, kind: Kind) -> float | None:
        """At the first change of a kind, in k3/L^2."""
        found = self.first(kind)
        return None if found is None else found.at

    def unstable_at(self, F: float) -> bool:
        """Whether the straight arm beats at a force; beyond where changes were sought, as at the end."""
        before = [c.unstable_after for c in self.thresholds.crossings if c.at <= F]
        return bool(before) and before[-1] != 0


@dataclass(frozen=True, slots=True)
class Span:
    """From the least to the greatest of a number over the range of drag; `always` where every drag has it."""

    low: float
    high: float
    always: bool = True


@dataclass(frozen=True, slots=True)
class FlutterRange:
    """The changes of an arm with each drag, the likeliest first."""

    forces: tuple[FlutterForces, ...]

    @property
    def failures(self) -> list[str]:
        """What a search says that did not end well."""
        searches = [f.thresholds for f in self.forces]
        return sorted({t.message or t.status.sentence for t in searches if not t.status.succeeded})

    @property
    def end(self) -> float:
        """How far changes were sought, in k3/L^2."""
        return self.forces[0].thresholds.end

    def force(self, kind: Kind) -> Span | None:
        """Range of the force of the first change of a kind, in k3/L^2."""
        return span_of([f.force(kind) for f in self.forces])

    def frequency(self, kind: Kind) -> Span | None:
        """Range of the frequency there, in Hz."""
        return span_of([f.frequency(kind) for f in self.forces])

    def unstable_at(self, F: float) -> list[bool]:
        """Whether the straight arm beats at a force, with each drag."""
        return [f.unstable_at(F) for f in self.forces]


def span_of(values: list[float | None]) -> Span | None:
    """From the least to the greatest of those that are there; None where none is."""
    there = [value for value in values if value is not None]
    return Span(min(there), max(there), len(there) == len(values)) if there else None


def flutter_forces(arm: SlenderArm, drag: Drag) -> FlutterForces:
    """All changes of an arm with one drag."""
    thresholds = solve_thresholds(Rod(F=0.0, k1=arm.k1, k2=arm.k2, gamma3=arm.gamma3_with(drag)), REQUEST)
    return FlutterForces(tau2=arm.tau2_with(drag), thresholds=thresholds)


@solving
def flutter_range(arm: SlenderArm) -> FlutterRange:
    """All changes of an arm over the range of its drag."""
    return FlutterRange(tuple(flutter_forces(arm, drag) for drag in arm.drags))
