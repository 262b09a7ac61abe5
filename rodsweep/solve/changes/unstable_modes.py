"""Changes along a path as a list, and the number of unstable modes between them.

Crossings and crossing directions give the number after every crossing; the winding number confirms the number
at both ends and between.
"""

import math
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import TYPE_CHECKING

from ...model.rod import Rod

if TYPE_CHECKING:
    from .path_problem import PathProblem  # for annotations only: the module imports solvers


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangeCountSettings:
    """Ends of a search, and places of counts between changes."""

    crushing_margin: float = 1e-6
    """Relative distance below the crushing force at which a search ends; at F = k1 the rod is crushed."""
    meets_crushing: float = 1e-12
    """Relative rounding error of F against the force that crushes the rod: two axes in steps may meet exactly
    there."""
    places: tuple[float, ...] = (0.5, 0.3, 0.7)
    """Places between two crossings, as fractions, at which the unstable modes are counted until a count is
    decided."""
    too_close: float = 1e-3
    """Relative distance of two crossings below which no count is made between: a pair is too near the
    axis."""


CHANGE_COUNTS = ChangeCountSettings()


def end_below_crushing(rod: Rod, F: float) -> float:
    """The force F, or the largest force of a search on a rod that a smaller force crushes."""
    return min(F, rod.crushing_force * (1 - CHANGE_COUNTS.crushing_margin))


class ChangeKind(IntEnum):
    """Kind of a change along a path, in the direction of increasing parameter."""

    onset = 1
    hopf = 2
    hopf_reverse = 3
    restabilization = 4
    real_again = 5
    real_leads = 6
    pair_leads = 7

    @property
    def changes_leader(self) -> bool:
        """Whether the leading eigenvalue changes its kind, as opposed to a pair that crosses the axis."""
        return self in (ChangeKind.onset, ChangeKind.pair_leads, ChangeKind.real_again, ChangeKind.real_leads)

    @property
    def pair_leads_after(self) -> bool:
        """Whether a pair leads beyond the change."""
        return self in (ChangeKind.onset, ChangeKind.pair_leads)


@dataclass(frozen=True, slots=True)
class Crossing:
    """One change: the value of the parameter with its error, and the eigenvalue, in 1/tau2.

    unstable_after: number of unstable modes just beyond the change, -1 if unknown. frequency_error: of the
    frequency of a pair that crosses the axis, else nan.
    """

    at: float
    kind: ChangeKind
    frequency: float
    growth_rate: float
    error: float
    unstable_after: int = -1
    frequency_error: float = math.nan


class ModeCounter:
    """Number of unstable modes along a path, carried from crossing to crossing and confirmed by counts.

    gaps: intervals of the parameter that may contain crossings missing from the list. doubts: statements that
    the counts do not confirm.
    """

    def __init__(self, problem: "PathProblem", gaps: list[tuple[float, float]], certify: bool):
        self.problem = problem
        self.path = problem.path
        self.gaps = gaps
        self.certify = certify
        self.doubts: list[str] = []

    def at(self, value: float) -> int:
        """The winding number at a value of the parameter; -1 if undecided."""
        number = self.problem.count(0.0, self.path.variable(value)).number
        return -1 if number is None else number

    def amid(self, a: float, b: float) -> int:
        """The winding number between two values; -1 if undecided at all of CHANGE_COUNTS.places."""
        known = self.problem.counted_amid(*sorted((self.path.variable(a), self.path.variable(b))))
        if known is not None:
            return known
        for share in CHANGE_COUNTS.places:
            number = self.at(a + share * (b - a))
            if number >= 0:
                return number
        return -1

    def first(self, start: float, stop: float, hopfs: list[Crossing]) -> int:
        """The number at the start, counted there or, if undecided, before the first change."""
        number = self.at(start)
        until = min([stop, *(c.at for c in hopfs), *(a for a, _ in self.gaps)])
        return number if number >= 0 else self.amid(start, until)

    def along(
        self, ordered: list[Crossing], ends: tuple[float, float], unstable: int
    ) -> tuple[tuple[Crossing, ...], int]:
        """(crossings with the number of unstable modes after each, number at the end), from crossings in
        order; resets `doubts`.
        """
        self.doubts = []
        out: list[Crossing] = []
        place = ends[0]
        for crossing in ordered:
            kind = crossing.kind
            if kind in (ChangeKind.hopf, ChangeKind.hopf_reverse):
                unstable = self._between(place, crossing.at, unstable)
                place = crossing.at
                if unstable >= 0:
                    unstable += 2 if kind == ChangeKind.hopf else -2
                if kind == ChangeKind.hopf_reverse and unstable == 0:
                    kind = ChangeKind.restabilization
            out.append(replace(crossing, kind=kind, unstable_after=unstable))
        return tuple(out), self._between(place, ends[1], unstable)

    def _between(self, a: float, b: float, unstable: int) -> int:
        """The number just before b, carried from just after a and confirmed by a count between."""
        inside = [gap for gap in self.gaps if gap[1] > a and gap[0] < b]
        if inside:
            # A gap may hide crossings, so the number is counted anew behind it.
            a = max(gap[1] for gap in inside)
        elif not self.certify:
            return unstable
        if b - a <= CHANGE_COUNTS.too_close * abs(b):
            return -1 if inside else unstable
        counted = self.amid(a, b)
        if inside or unstable < 0:
            return counted
        if counted != unstable:
            undecided = "the count of unstable modes is undecided"
            found = f"{counted} modes are unstable" if counted >= 0 else undecided
            self.doubts.append(
                f"{found} between {self.path.name} = {a:.12g} and {b:.12g}"
                + (f", but the crossings found imply {unstable}" if counted >= 0 else "")
            )
        return unstable
