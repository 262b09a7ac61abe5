"""Crossings of the imaginary axis along a path of arms. No covering proves their list complete.

The unstable modes are counted at places along the path. Between places whose counts differ by one pair,
Newton's method on D finds the crossing. Between places with equal counts, the slopes of the pairs nearest to
the axis must exclude two crossings; otherwise a place is added between.
"""

import math
from dataclasses import dataclass

from ...arrays import Complex
from ..point import Unsolvable
from ..spectrum.search import Spectrum, SpectrumRequest
from .anchors import ANCHORS, minimum_of_cubic
from .path_problem import PathProblem
from .search_range import Reach, SearchedIntervals
from .unstable_modes import Crossing, Kind


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmCrossingSettings:
    """Settings for the crossings along a path of arms."""

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


@dataclass(frozen=True)
class AxisPlace:
    """A place p: leading eigenvalues w and their slopes, (modes,) each, and the number of unstable modes."""

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


class CrossingSearch:
    """The search for crossings along a path.

    found: crossings by their p. gaps: intervals of p that may contain two undecided crossings.
    """

    def __init__(self, problem: PathProblem, certify: bool):
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
            modes = (
                ANCHORS.min_known_modes if near is None else max(ANCHORS.min_known_modes, 2 + near.unstable)
            )
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
            slopes = found.eigenvalues.copy()
            for i, w in enumerate(found.eigenvalues.tolist()):
                slopes[i] = self.problem.eigenvalue(w, p)[1] if w.imag >= 0 else slopes[i - 1].conjugate()
            self.places[p] = AxisPlace(p, found.eigenvalues, slopes, found.unstable_count)
        return self.places[p]

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
            try:
                self._search(a, b, intervals)
            except Unsolvable as why:
                intervals.end_within((a, b), str(why))
                self.found = {p: crossing for p, crossing in self.found.items() if p <= a}
        return [self.found[p] for p in sorted(self.found)], intervals.reach

    def _search(self, a: float, b: float, intervals: SearchedIntervals) -> None:
        """Searches one interval: keeps its crossing, or divides the interval."""
        left = self.place(a)
        right = self.place(b)
        # Equal counts leave room for a pair that crosses and returns.
        if left.unstable == right.unstable:
            share = next_count_place(left, right)
            if share == 0.0:
                return
            if b - a <= ARM_CROSSINGS.smallest_interval * intervals.length:
                self.gaps.append((a, b))
                return
        else:
            share = 0.5
            # A change by more than a pair has several crossings, which a bisection must part first.
            crossing = self._between(left, right) if abs(left.unstable - right.unstable) == 2 else None
            beside = self._confirmed(crossing, left, right, intervals.length) if crossing else None
            if crossing is not None and beside is not None:
                self.found[self.problem.path.variable(crossing.at)] = crossing
                intervals.divide((a, beside[0]), (beside[1], b))
                return
            if b - a <= ARM_CROSSINGS.smallest_step * max(abs(a), abs(b)):
                raise Unsolvable(f"the crossing near {self.problem.path.at(a)} is not found")
        middle = a + share * (b - a)
        intervals.divide((a, middle), (middle, b))

    def _confirmed(
        self, crossing: Crossing, left: AxisPlace, right: AxisPlace, length: float
    ) -> tuple[float, float] | None:
        """(p just before, p just behind) a crossing; None if the counts at these two places do not confirm
        the crossing."""
        p = self.problem.path.variable(crossing.at)
        before = max(left.p, p - ARM_CROSSINGS.count_distance * length)
        behind = min(right.p, p + ARM_CROSSINGS.count_distance * length)
        change = self.place(behind).unstable - self.place(before).unstable
        return (before, behind) if change == right.unstable - left.unstable else None

    def _between(self, left: AxisPlace, right: AxisPlace) -> Crossing | None:
        """The crossing between two places with counts that differ by a pair; None if not found."""
        grows = right.unstable > left.unstable
        # The pair that crosses is stable on one side and unstable on the other; the nearest to the axis is
        # tried first.
        for start, growing in ((left, not grows), (right, grows)):
            pairs = [i for i, w in enumerate(start.w.tolist()) if w.imag > 0 and (w.real > 0) == growing]
            for i in sorted(pairs, key=lambda i: abs(start.w[i].real)):
                crossing = self._newton(start, i, (left.p, right.p), grows)
                if crossing is not None:
                    return crossing
        return None

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
                return self._crossing(p, w, slope, blur, grows)
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
