"""Everything that changes along a path of rods: crossings of the imaginary axis, and who leads.

The crossings come from `rodsweep.solve.covering`, which proves that there are no others, the changes of
the leading eigenvalue from `rodsweep.solve.leading`. Here they become one list in increasing order of the
parameter, and the winding number confirms how many modes are unstable at both ends and in between.
"""

import math
from dataclasses import dataclass, replace
from enum import IntEnum

from ..model.path import Path, coefficients_at, determinant_along
from .certificate import count_right_of
from .covering import Box, Zero, cover, first_boxes, slabs
from .leading import Change, Tracer, Untraceable

ANCHORS_A_SLAB = 1
"""Rods a slab of the covering whose leading eigenvalues are computed whatever happens there."""
PLACES = (0.5, 0.3, 0.7)
"""Where between two crossings the unstable modes are counted, until a count is decided."""
BESIDE = 1e-4
"""Distance from a crossing, in units of the path, of an anchor where the pair must lead."""
TOGETHER = 1e-5
"""Relative distance of crossings below which nothing is counted between them."""


class Kind(IntEnum):
    """What happens at a point of a path, in the direction in which the parameter grows."""

    onset = 1
    hopf = 2
    hopf_reverse = 3
    restabilization = 4
    real_again = 5
    real_leads = 6
    pair_leads = 7


@dataclass(frozen=True, slots=True)
class Crossing:
    """One change: the value of the parameter with its error, and the eigenvalue there, in 1/tau2.

    unstable_after: unstable modes just beyond it, -1 where that is not known.
    """

    at: float
    kind: Kind
    frequency: float
    growth_rate: float
    error: float
    unstable_after: int = -1


@dataclass(frozen=True, slots=True)
class Transitions:
    """All changes along a path, in increasing order of its parameter.

    open_range: the interval that holds every place where two crossings may lie, or none; nan if there
    is no such place. oscillates_at_start: whether a pair leads there. proved: the covering is complete,
    every count agrees, and nothing lies right of an eigenvalue said to lead. boxes: evaluations of D that
    the covering took; solves: eigenproblems.
    """

    crossings: tuple[Crossing, ...]
    open_range: tuple[float, float]
    unstable_at_start: int
    unstable_at_end: int
    oscillates_at_start: bool
    proved: bool
    boxes: int
    solves: int
    why_not: str = ""


def transitions(path: Path, start: float, stop: float, certify: bool = True) -> Transitions:
    """All changes from the value `start` of the path's parameter up to `stop`.

    Raises Untraceable where no a-priori bound applies or a spectrum cannot be had.
    """
    low, high = sorted((path.variable(start), path.variable(stop)))
    boxes = first_boxes(path, low, high)
    if boxes is None:
        raise Untraceable("no a-priori bound on the eigenvalues applies")
    zeros, left, examined = cover(boxes, path.origin, path.direction)
    tracer = Tracer(path, certify)
    edges = [
        a + (b - a) * i / ANCHORS_A_SLAB for a, b in slabs(path, low, high) for i in range(ANCHORS_A_SLAB)
    ]
    hopfs = [_hopf(path, zero) for zero in zeros if low <= zero[1] <= high]
    gaps = _gaps(path, left)
    counts = _Counts(path, certify)
    unstable = 0 if path.name == "F" and start == 0 else counts.first(start, stop, hopfs, gaps)
    first = tracer.anchor(path.variable(start))
    edges = [*edges, high]
    for _ in range(2):
        counts.doubts = []
        leads = [_lead(path, change) for change in tracer.changes(edges)]
        ordered = sorted(leads + hopfs, key=lambda c: c.at)
        crossings, at_end = counts.along(ordered, gaps, (start, stop), unstable)
        missed = _pairs_that_do_not_lead(path, crossings, first.oscillates, unstable)
        if not missed:
            break
        near = [(p + side * BESIDE * (high - low)) for p in missed for side in (-1, 1)]
        edges = sorted({*edges, *(p for p in near if low < p < high)})
    else:
        counts.doubts.append("the leading eigenvalue is not the pair that crosses the axis")
    proved = certify and not gaps and not counts.doubts and all(c.unstable_after >= 0 for c in crossings)
    proved = proved and tracer.proved and unstable >= 0 and at_end >= 0
    return Transitions(
        crossings,
        (min(a for a, _ in gaps), max(b for _, b in gaps)) if gaps else (math.nan, math.nan),
        unstable,
        at_end,
        first.oscillates,
        proved,
        examined,
        tracer.solves,
        "; ".join(counts.doubts),
    )


def _pairs_that_do_not_lead(
    path: Path, crossings: tuple[Crossing, ...], oscillates: bool, unstable: int
) -> list[float]:
    """Path variables of crossings whose pair is alone on the axis and so must lead, but is said not to."""
    missed = []
    for crossing in crossings:
        if crossing.kind in (Kind.onset, Kind.pair_leads, Kind.real_again, Kind.real_leads):
            oscillates = crossing.kind in (Kind.onset, Kind.pair_leads)
        else:
            if min(unstable, crossing.unstable_after) == 0 and not oscillates:
                missed.append(path.variable(crossing.at))
            unstable = crossing.unstable_after
    return missed


def _value(path: Path, p: float, error: float) -> tuple[float, float]:
    """(value of the parameter, its error) from the path variable's."""
    return (1 / p, error / p**2) if path.inverse else (p, error)


def _hopf(path: Path, zero: Zero) -> Crossing:
    """A crossing, hopf or hopf_reverse by the direction in which the pair moves."""
    eta, p, _, error = zero
    _, D_w, D_p, _, _ = determinant_along(
        complex(0.0, eta), coefficients_at(p, path.origin, path.direction), path.direction
    )
    growing = (-D_p / D_w).real > 0
    kind = Kind.hopf if growing != path.inverse else Kind.hopf_reverse
    value, error = _value(path, p, error)
    return Crossing(value, kind, eta, 0.0, error)


def _lead(path: Path, change: Change) -> Crossing:
    to_pair = change.to_pair != path.inverse
    double, single = (Kind.onset, Kind.pair_leads) if to_pair else (Kind.real_again, Kind.real_leads)
    value, error = _value(path, change.p, change.error)
    return Crossing(value, double if change.double else single, change.frequency, change.growth_rate, error)


def _gaps(path: Path, left: list[Box]) -> list[tuple[float, float]]:
    """Disjoint intervals of the parameter that the open boxes cover."""
    gaps: list[tuple[float, float]] = []
    for a, b in sorted(sorted((_value(path, p0, 0.0)[0], _value(path, p1, 0.0)[0])) for _, _, p0, p1 in left):
        if gaps and a <= gaps[-1][1] * (1 + TOGETHER):
            gaps[-1] = gaps[-1][0], max(b, gaps[-1][1])
        else:
            gaps.append((a, b))
    return gaps


class _Counts:
    """The number of unstable modes along a path, carried from crossing to crossing and counted beside."""

    def __init__(self, path: Path, certify: bool):
        self.path, self.certify = path, certify
        self.doubts: list[str] = []

    def at(self, value: float) -> int:
        """The winding number at a value of the parameter; -1 where it is undecided."""
        number = count_right_of(0.0, self.path.at(self.path.variable(value))).number
        return -1 if number is None else number

    def first(self, start: float, stop: float, hopfs: list[Crossing], gaps: list[tuple[float, float]]) -> int:
        """The number at the start, counted there or, where that is undecided, before anything changes."""
        until = min([stop, *(c.at for c in hopfs), *(a for a, _ in gaps)])
        number = self.at(start)
        for share in PLACES:
            if number < 0 and until < math.inf:
                number = self.at(start + share * (until - start))
        return number

    def along(
        self,
        ordered: list[Crossing],
        gaps: list[tuple[float, float]],
        ends: tuple[float, float],
        unstable: int,
    ) -> tuple[tuple[Crossing, ...], int]:
        """(crossings with the unstable modes after each, the number at the end)."""
        out: list[Crossing] = []
        place = ends[0]
        for crossing in ordered:
            kind = crossing.kind
            if kind in (Kind.hopf, Kind.hopf_reverse):
                unstable = self._between(place, crossing.at, gaps, unstable)
                place = crossing.at
                if unstable >= 0:
                    unstable += 2 if kind == Kind.hopf else -2
                if kind == Kind.hopf_reverse and unstable == 0:
                    kind = Kind.restabilization
            out.append(replace(crossing, kind=kind, unstable_after=unstable))
        return tuple(out), self._between(place, ends[1], gaps, unstable)

    def _between(self, a: float, b: float, gaps: list[tuple[float, float]], unstable: int) -> int:
        """The number just before b, carried from just after a and checked by a count between."""
        inside = [gap for gap in gaps if gap[1] > a and gap[0] < b]
        if inside:
            a = max(gap[1] for gap in inside)
        elif not self.certify:
            return unstable
        if b - a <= TOGETHER * abs(b):
            return -1 if inside else unstable
        counted = -1
        for share in PLACES:
            counted = self.at(a + share * (b - a))
            if counted >= 0:
                break
        if inside or unstable < 0:
            return counted
        if counted >= 0 and counted != unstable:
            self.doubts.append(
                f"{counted} modes are unstable between {self.path.name} = {a:.12g} and {b:.12g}, "
                f"not {unstable}"
            )
        return unstable
