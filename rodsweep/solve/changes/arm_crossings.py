"""Crossings of the imaginary axis along a path of arms. No covering proves their list complete.

The unstable modes are counted at places along the path. Between places whose counts differ by one pair,
Newton's method on D finds the crossing. Between places with equal counts, the slopes of the pairs nearest to
the axis must exclude two crossings; otherwise a place is added between.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...arrays import Complex
from ..point import Unsolvable
from ..spectrum.search import Spectrum, SpectrumRequest
from .anchors import ANCHORS, minimum_of_cubic
from .path_problem import ArmPath
from .search_range import Reach, SearchedIntervals
from .unstable_modes import Crossing, Kind


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmCrossingSettings:
    """Settings for the crossings along a path of arms."""

    many: float = 16.0
    """Expected number of growing modes beyond which a place knows the modes beside the axis alone."""
    beyond_the_list: float = 2.0
    smallest_first: float = 1e-3
    """Intervals are halved before a search if more modes than the list holds, times the first factor, are
    expected to grow at their right ends, down to this length in units of the path."""
    most_at_once: int = 6
    """Largest number of pairs by which the counts of two places may differ for a search of all crossings
    between."""
    higher: float = 4.0
    """Height up to which modes beside the axis are searched at a crossing, in units of the heights known."""
    same_errors: float = 10.0
    same_frequency: float = 1e-6
    """Two crossings are equal if they differ by less: in p in units of their errors, in frequency
    relative."""
    max_known_modes: int = 200
    """Largest number of leading eigenvalues known at a place."""
    smallest_interval: float = 1e-6
    """Length of an interval, in units of the path, that is not divided further: two crossings inside stay
    undecided."""
    smallest_step: float = 1e-12
    """Relative length of an interval without a place between its ends, up to some thousand roundings."""
    count_distance: float = 1e-5
    """Distance from a crossing, in units of the path, of the counts on both its sides."""
    max_steps: int = 20
    """Maximum number of Newton steps for one crossing."""
    converged: float = 4.0
    """Newton step, in units of the error of p, at which a crossing has converged."""
    rounding: float = 4e-16
    """Relative rounding error of the path variable: two units in the last place."""


ARM_CROSSINGS = ArmCrossingSettings()
NONE_BESIDE: Complex = np.empty(0, complex)


@dataclass(frozen=True)
class AxisPlace:
    """A place p: eigenvalues w and their slopes, (modes,) each, and the number of unstable modes.

    The eigenvalues are the leading ones, or those beside the axis, one of each pair.
    """

    p: float
    w: Complex
    slopes: Complex
    unstable: int

    def nearest(self, growing: bool) -> tuple[float, float] | None:
        """(distance from the axis, its slope by p) of the pair nearest to the axis on one side; None without
        a pair."""
        pairs = [i for i, w in enumerate(self.w.tolist()) if w.imag > 0 and (w.real > 0) == growing]
        if not pairs:
            return None
        i = min(pairs, key=lambda i: abs(self.w[i].real))
        sign = 1.0 if growing else -1.0
        return float(sign * self.w[i].real), float(sign * self.slopes[i].real)

    def moved(self, p: float, unstable: int) -> "AxisPlace":
        """A place close by, with eigenvalues moved along their slopes."""
        return AxisPlace(p, self.w + self.slopes * (p - self.p), self.slopes, unstable)


class CrossingSearch:
    """The search for crossings along a path.

    found: crossings by their p. gaps: intervals of p that may contain two undecided crossings.
    """

    def __init__(self, problem: ArmPath, certify: bool):
        self.problem = problem
        self.certify = certify
        self.places: dict[float, AxisPlace] = {}
        self.found: dict[float, Crossing] = {}
        self.gaps: list[tuple[float, float]] = []

    def place(self, p: float) -> AxisPlace:
        """The place at p; raises Unsolvable if eigenvalues or count cannot be computed."""
        if p not in self.places:
            # The neighbour's count tells how many modes are needed: all unstable ones and a pair beyond.
            near = min(self.places.values(), key=lambda place: abs(place.p - p), default=None)
            growing = 0 if near is None else near.unstable
            many = self.problem.expected_growing(p) > ARM_CROSSINGS.many
            found = self._place_beside(p) if many and self.certify else None
            self.places[p] = found or self._place_of_leaders(p, growing)
        return self.places[p]

    def _place_beside(self, p: float) -> AxisPlace | None:
        """The place at p by a count and the modes beside the axis; None if the count is undecided."""
        try:
            w = self.problem.beside_axis(p, math.inf, NONE_BESIDE)
        except FloatingPointError as unresolved:
            raise Unsolvable(f"{self.problem.path.at(p)}: {unresolved}") from None
        number = self.problem.counted(p, w)
        return None if number is None else self._with_slopes(p, w, number)

    def _with_slopes(self, p: float, w: Complex, unstable: int) -> AxisPlace:
        """The place at p with eigenvalues, (n,), and their slopes."""
        slopes = w.copy()
        for i, guess in enumerate(w.tolist()):
            slopes[i] = self.problem.eigenvalue(guess, p)[1] if guess.imag >= 0 else slopes[i - 1].conjugate()
        return AxisPlace(p, w, slopes, unstable)

    def _place_of_leaders(self, p: float, growing: int) -> AxisPlace:
        """The place at p by its leading modes, two more than grow; growing: how many may grow."""
        modes = max(ANCHORS.min_known_modes, 2 + growing)
        found = self.problem.spectrum(p, SpectrumRequest(modes, ANCHORS.place_accuracy, self.certify))
        while modes < _needed(found) <= ARM_CROSSINGS.max_known_modes:
            if self.certify and found.unstable_count < 0:
                break  # a count that fails does not succeed with more modes
            modes = _needed(found)
            found = self.problem.spectrum(p, SpectrumRequest(modes, ANCHORS.place_accuracy, self.certify))
        if found.unstable_count < 0:
            raise Unsolvable(f"{self.problem.path.at(p)}: {found.status.name} {found.message}".rstrip())
        if _needed(found) > max(modes, ARM_CROSSINGS.max_known_modes):
            raise Unsolvable(f"{self.problem.path.at(p)}: {found.unstable_count} modes grow")
        return self._with_slopes(p, found.eigenvalues, found.unstable_count)

    def crossings(self, edges: list[float], most: float) -> tuple[list[Crossing], Reach]:
        """All crossings from the first of `edges` up to the reach of the search, in increasing order of p.

        The search ends behind the first crossing beyond `most`: where dozens of modes grow, each further one
        costs more than all before. Raises Unsolvable if the search does not reach beyond the first edge.
        """
        intervals = SearchedIntervals(edges)
        self.place(edges[0])
        for a, b in intervals:
            if sum(p < a for p in self.found) > most:
                intervals.stop_at(a, f"more than {most:g} crossings; raise the option crossings")
                continue
            if self._is_too_long(a, b, most, intervals.length):
                intervals.divide((a, (a + b) / 2), ((a + b) / 2, b))
                continue
            try:
                self._search(a, b, intervals)
            except Unsolvable as why:
                intervals.end_within((a, b), str(why))
                self.found = {p: crossing for p, crossing in self.found.items() if p <= a}
        return [self.found[p] for p in sorted(self.found)], intervals.reach

    def _is_too_long(self, a: float, b: float, most: float, length: float) -> bool:
        """Whether the list is likely to be full before b, where a count is expensive."""
        if b in self.places or b - a < ARM_CROSSINGS.smallest_first * length:
            return False
        return self.problem.expected_growing(b) > max(
            ARM_CROSSINGS.beyond_the_list * 2 * most, ARM_CROSSINGS.many
        )

    def _search(self, a: float, b: float, intervals: SearchedIntervals) -> None:
        """Searches one interval: keeps its crossing, or divides the interval."""
        left = self.place(a)
        right = self.place(b)
        if left.unstable == right.unstable:
            share = next_count_place(left, right)
            if share == 0.0:
                return
            if b - a <= ARM_CROSSINGS.smallest_interval * intervals.length:
                self.gaps.append((a, b))
                return
        else:
            share = 0.5
            crossings = self._between(left, right)
            parts = self._parted(crossings, left, right, intervals.length) if crossings else None
            if parts is not None:
                self.found.update(
                    (self.problem.path.variable(crossing.at), crossing) for crossing in crossings
                )
                intervals.divide(*parts)
                return
            if b - a <= ARM_CROSSINGS.smallest_step * max(abs(a), abs(b)):
                raise Unsolvable(f"the crossing near {self.problem.path.at(a)} is not found")
        middle = a + share * (b - a)
        intervals.divide((a, middle), (middle, b))

    def _parted(
        self, crossings: list[Crossing], left: AxisPlace, right: AxisPlace, length: float
    ) -> list[tuple[float, float]] | None:
        """The intervals between crossings, in increasing order of p; None if a count between two of them
        differs.

        The modes beside the axis at a crossing serve the places just before and just behind.
        """
        parts: list[tuple[float, float]] = []
        start = left.p
        unstable = left.unstable
        highest = ARM_CROSSINGS.higher * max(abs(w.imag) for w in (*left.w.tolist(), *right.w.tolist()))
        for k, crossing in enumerate(crossings):
            p = self.problem.path.variable(crossing.at)
            if k > 0:
                middle = (start + p) / 2
                if self.place(middle).unstable != unstable:
                    return None
                parts.append((start, middle))
                start = middle
            w = self.problem.beside_axis(p, highest, np.array([1j * crossing.frequency]))
            here = self._with_slopes(p, w, unstable)
            before = max(left.p, p - ARM_CROSSINGS.count_distance * length)
            behind = min(right.p, p + ARM_CROSSINGS.count_distance * length)
            parts.append((start, before))
            self.places[before] = here.moved(before, unstable)
            unstable += 2 if here.slopes[0].real > 0 else -2
            self.places[behind] = here.moved(behind, unstable)
            start = behind
        return [*parts, (start, right.p)]

    def _between(self, left: AxisPlace, right: AxisPlace) -> list[Crossing]:
        """Crossings between two places, in increasing order of p, that explain the change of the number of
        unstable modes; empty if not found."""
        change = (right.unstable - left.unstable) // 2
        if abs(change) > ARM_CROSSINGS.most_at_once:
            return []
        grows = change > 0
        found: dict[float, Crossing] = {}
        # The pairs that cross are stable on one side and unstable on the other; the nearest to the axis are
        # tried first.
        for start, growing in ((left, not grows), (right, grows)):
            pairs = [i for i, w in enumerate(start.w.tolist()) if w.imag > 0 and (w.real > 0) == growing]
            for i in sorted(pairs, key=lambda i: abs(start.w[i].real)):
                crossing = self._newton(start, i, (left.p, right.p), grows)
                if crossing is not None and not any(_same(crossing, other) for other in found.values()):
                    found[self.problem.path.variable(crossing.at)] = crossing
                if len(found) == abs(change):
                    return [found[p] for p in sorted(found)]
        return []

    def _newton(self, start: AxisPlace, i: int, ends: tuple[float, float], grows: bool) -> Crossing | None:
        """Newton's method for the p at which eigenvalue i of a place lies on the axis; None without
        convergence."""
        p = start.p
        w = complex(start.w[i])
        slope = complex(start.slopes[i])
        for _ in range(ARM_CROSSINGS.max_steps):
            if slope.real == 0 or not math.isfinite(slope.real):
                return None
            step = -w.real / slope.real
            p = p + step
            guess = w + slope * step
            if not ends[0] <= p <= ends[1]:
                return None
            w, slope, error = self.problem.eigenvalue(guess, p)
            blur = error / abs(slope.real) + ARM_CROSSINGS.rounding * abs(p)
            if abs(w.real / slope.real) <= ARM_CROSSINGS.converged * blur:
                # Where nothing is resolved there is no root of D.
                resolved = blur <= ARM_CROSSINGS.count_distance * (ends[1] - ends[0])
                return self._crossing(p, w, slope, blur, grows) if resolved else None
        return None

    def _crossing(self, p: float, w: complex, slope: complex, blur: float, grows: bool) -> Crossing | None:
        """The crossing; None if the pair crosses in the opposite direction."""
        # Newton's method may find another pair of the interval, going the other way.
        if w.imag <= 0 or (slope.real > 0) != grows:
            return None
        kind = Kind.hopf if grows != self.problem.path.inverse else Kind.hopf_reverse
        error_of_p = blur + abs(w.real / slope.real)
        at, error = self.problem.path.value(p, error_of_p)
        error_of_w = (abs(slope.real) + abs(slope.imag)) * error_of_p  # its own, and that by p
        return Crossing(at, kind, w.imag, 0.0, error, frequency_error=error_of_w)


def _same(one: Crossing, other: Crossing) -> bool:
    """Whether two crossings are equal within their errors, of F and of the frequency."""
    apart = abs(one.at - other.at) <= ARM_CROSSINGS.same_errors * (one.error + other.error)
    return apart and abs(one.frequency - other.frequency) <= ARM_CROSSINGS.same_frequency * one.frequency


def _needed(found: Spectrum) -> int:
    """Two more modes than are unstable; without a count the growing modes found are taken."""
    growing = int((found.eigenvalues.real > 0).sum())
    return 2 + max(found.unstable_count, growing)


def next_count_place(left: AxisPlace, right: AxisPlace) -> float:
    """Fraction of the interval at which to count next, because a pair may touch the axis; 0 if no pair
    can."""
    h = right.p - left.p
    for growing in (False, True):
        a = left.nearest(growing)
        b = right.nearest(growing)
        if a is None and b is None:
            continue
        if a is None or b is None:
            value, slope = a or b or (0.0, 0.0)
            # Of a pair that is known at one end only, its own slope must tell whether it came from the axis.
            towards = slope > 0 if a is None else slope < 0
            if towards and value < abs(slope) * h:
                return 0.5
            continue
        lowest, share = minimum_of_cubic(a[0], b[0], h * a[1], h * b[1])
        if lowest < ANCHORS.explained * min(a[0], b[0]):
            return share
    return 0.0
