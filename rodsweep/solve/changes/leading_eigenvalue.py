"""Exchanges of the leading eigenvalue along a path of rods: from real to a complex pair, or back.

An exchange happens in two ways. At a double eigenvalue, D = D_w = 0, two real eigenvalues become a pair or a
pair becomes two real eigenvalues. In an overtaking, a real eigenvalue and a pair exchange the lead without
becoming equal. Anchors are rods whose leading eigenvalues come from the spectrum solver, certified on
request. Between two anchors, cubic interpolation must explain two smooth quantities: the squared difference
of the two leading eigenvalues, and the difference in real part between the leading eigenvalue and the next
eigenvalue of the opposite kind (real or complex). Otherwise an anchor is added between the two anchors.
Newton's method on the determinant D finds each exchange, and the winding number proves that no eigenvalue
lies to the right of the eigenvalues that exchange the lead.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..point import Unsolvable
from ..spectrum.search import SpectrumRequest
from ..spectrum.status import SpectrumStatus
from .anchors import Anchor, next_anchor
from .path_problem import PathProblem
from .search_range import SearchedIntervals, SearchEnd
from .unstable_modes import ChangeKind, Crossing

ANCHOR_MODE_COUNT = 4
"""Number of leading eigenvalues computed at an anchor: the first two, and two that may overtake the first
two. The number is a constant, because with fewer eigenvalues it would be unknown which eigenvalues become
equal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LeadingEigenvalueSettings:
    """Settings of the search for exchanges of the leading eigenvalue: anchors, and Newton's method between
    anchors."""

    accuracy: float = 1e-6
    """Relative accuracy of the eigenvalues at an anchor, before the refinement by Newton's method on D."""
    smallest_interval: float = 2e-4
    """An anchor is added between two anchors only if their distance, as a fraction of the path's length,
    exceeds this."""
    smallest_hiding_interval: float = 1e-9
    """Like `smallest_interval`, for two anchors between which two exchanges may lie."""
    max_overtaking_steps: int = 60
    """Maximum number of Newton steps to an overtaking."""
    carrying_steps: int = 8
    """Number of steps in which an eigenvalue is followed from an anchor to the middle of the interval."""
    max_distance_in_errors: float = 10.0
    """The eigenvalue found by Newton's method is rejected as a different eigenvalue if its distance from the
    start exceeds this multiple of the start's error estimate and `max_relative_distance` times |w|."""
    max_relative_distance: float = 1e-12
    """The eigenvalue w found by Newton's method is accepted if its distance from the start is below this
    multiple of |w|: some thousand rounding errors."""
    smallest_step: float = 1e-12
    """The search fails at an interval whose length, divided by the larger modulus of its ends, is at most
    this (some thousand rounding errors), if its exchange is not found."""
    rounding_error: float = 4e-16
    """Relative rounding error of the path variable: two units in the last place."""
    converged_step_in_errors: float = 4.0
    """Newton's method for an overtaking stops when the step is smaller than this multiple of the error
    estimate."""


LEADING_EIGENVALUE_SETTINGS = LeadingEigenvalueSettings()


class LeaderExchange(NamedTuple):
    """Exchange of the leading eigenvalue at path variable p: a double real eigenvalue (frequency 0), or a
    real eigenvalue and a pair with equal real parts. error_of_p: error of p. growth_rate: the common real
    part. frequency: Im w of the pair. All in 1/tau2, except for p and its error."""

    p: float
    error_of_p: float
    growth_rate: float
    frequency: float


class LeaderExchangeSearch:
    """Finds the exchanges of the leading eigenvalue along a path. anchors: the solved anchors, by path
    variable."""

    def __init__(self, problem: PathProblem, certify: bool):
        self.problem = problem
        self.path = problem.path
        self.certify = certify
        self.anchors: dict[float, Anchor] = {}
        self.leaders_proved = certify
        """Whether all anchors are certified, no undecided interval is left, and counts prove at each exchange
        that no further eigenvalue lies to the right."""

    def anchor(self, p: float) -> Anchor:
        """The anchor at path variable p, solved at the first call; raises Unsolvable if the eigenvalues
        cannot be computed."""
        if p not in self.anchors:
            self.anchors[p] = self._solve(p)
        return self.anchors[p]

    def _solve(self, p: float) -> Anchor:
        request = SpectrumRequest(ANCHOR_MODE_COUNT, LEADING_EIGENVALUE_SETTINGS.accuracy, self.certify)
        found = self.problem.spectrum(p, request)
        # With a mode on the imaginary axis the status is undecided, but no mode is missing.
        self.leaders_proved &= found.certified or found.status == SpectrumStatus.undecided
        if not np.isfinite(found.eigenvalues).all():
            raise Unsolvable(f"{self.path.text_at(p)}: {found.status.name} {found.message}".rstrip())
        w = found.eigenvalues.copy()
        slope = np.empty(ANCHOR_MODE_COUNT, dtype=complex)
        for i, guess in enumerate(found.eigenvalues):
            # Newton's method may jump to another eigenvalue, for example in a cluster; then the first value
            # stays.
            polished, slope[i], _ = self.problem.eigenvalue(complex(guess), p)
            error = LEADING_EIGENVALUE_SETTINGS.max_distance_in_errors * found.error_estimate[i]
            rounding = LEADING_EIGENVALUE_SETTINGS.max_relative_distance * abs(guess)
            if abs(polished - guess) <= max(error, rounding):
                w[i] = polished
        return Anchor(p, w, slope, *self.problem.relaxation(p))

    def changes(self, edges: list[float]) -> tuple[list[Crossing], SearchEnd]:
        """Returns (exchanges, end of the search). exchanges: all exchanges by increasing p, for p from the
        first of `edges` to the end of the search.

        Raises Unsolvable if the search ends at the first edge.
        """
        found: list[Crossing] = []
        intervals = SearchedIntervals(edges)
        self.anchor(edges[0])
        for a, b in intervals:
            try:
                found += self._search(a, b, intervals)
            except Unsolvable as why:
                intervals.end_within((a, b), str(why))
        return found, intervals.end

    def _search(self, a: float, b: float, intervals: SearchedIntervals) -> list[Crossing]:
        """The exchange between the anchors at a and b, in a list; an empty list if there is no exchange, or
        if the test is undecided. An undecided interval is divided into two entries of `intervals`, or ends
        the proof if it is too short; raises Unsolvable."""
        left = self.anchor(a)
        right = self.anchor(b)
        share = 0.5
        if left.oscillates == right.oscillates:
            share, hides = next_anchor(left, right)
            smallest = (
                LEADING_EIGENVALUE_SETTINGS.smallest_hiding_interval
                if hides
                else LEADING_EIGENVALUE_SETTINGS.smallest_interval
            )
            if share == 0.0:
                return []
            # Two exchanges may hide in an interval too short to divide: the list then is not proved.
            if b - a <= smallest * intervals.length:
                self.leaders_proved = False
                return []
        else:
            change = self._exchange_between(left, right)
            if change is not None:
                return [change]
            if b - a <= LEADING_EIGENVALUE_SETTINGS.smallest_step * max(abs(a), abs(b)):
                raise Unsolvable(
                    f"no point was found near {self.path.text_at(a)} at which the leading eigenvalue turns "
                    "from real to complex or back"
                )
        middle = a + share * (b - a)
        intervals.add_parts((a, middle), (middle, b))
        return []

    def _exchange_between(self, left: Anchor, right: Anchor) -> Crossing | None:
        """The exchange between an anchor with a leading pair and an anchor with a real leading eigenvalue.
        None if Newton's method finds no exchange, or if a count shows that other eigenvalues lead there."""
        pair, real = (left, right) if left.oscillates else (right, left)
        # Kinds are named in the direction of the parameter, along a stiffness the direction of falling p.
        if right.oscillates != self.path.is_compliance:
            double = ChangeKind.onset
            single = ChangeKind.pair_leads
        else:
            double = ChangeKind.real_again
            single = ChangeKind.real_leads
        for find, kind, meeting in ((self._double_eigenvalue, double, 2), (self._overtaking, single, 3)):
            found = find(pair, real)
            if found is None or not left.p <= found.p <= right.p:
                continue
            # Counted halfway to the next eigenvalue: only the exchanged eigenvalues may lie to the right.
            behind = max(left.w[meeting].real, right.w[meeting].real)
            count = self.problem.count((found.growth_rate + behind) / 2, found.p)
            # A different count means that other eigenvalues lead; an undecided count leaves the exchange
            # unproved.
            if count.number in (meeting, None):
                self.leaders_proved = self.leaders_proved and count.number == meeting
                at, error = self.path.value(found.p, found.error_of_p)
                return Crossing(at, kind, found.frequency, found.growth_rate, error)
        return None

    def _double_eigenvalue(self, pair: Anchor, real: Anchor) -> LeaderExchange | None:
        """The double eigenvalue between an anchor `pair` with a leading pair and an anchor `real` with two
        real leading eigenvalues; None if Newton's method does not find it.
        """
        below = pair.squared_pair_difference()
        above = real.squared_pair_difference()
        width = abs(pair.p - real.p)
        if below is None or above is None:
            return None
        # (w1 - w2)^2 is smooth through the double root, where w itself has a square root: it is interpolated.
        share = above[0] / (above[0] - below[0])
        p = real.p + share * (pair.p - real.p)
        x = (1 - share) * float((real.w[0] + real.w[1]).real) / 2 + share * float(pair.w[0].real)
        x, p, _, error = self.problem.double_eigenvalue(x, p, width)
        return None if math.isnan(p) else LeaderExchange(p, error, x, 0.0)

    def _overtaking(self, pair: Anchor, real: Anchor) -> LeaderExchange | None:
        """The point between two anchors where a real eigenvalue and a pair have equal real parts, by Newton's
        method; None if Newton's method does not find it.
        """
        if all(w.imag != 0 for w in pair.w) or all(w.imag == 0 for w in real.w):
            return None  # no eigenvalue of the other kind is known
        p = (pair.p + real.p) / 2
        ends = sorted((pair.p, real.p))
        # Start each eigenvalue from the anchor where it leads and carry it to the middle.
        w_real = self._follow_eigenvalue(complex(real.w[0]), real.p, p)
        w_pair = self._follow_eigenvalue(complex(pair.w[0]), pair.p, p)
        for _ in range(LEADING_EIGENVALUE_SETTINGS.max_overtaking_steps):
            w_real, s_real, e_real = self.problem.eigenvalue(w_real, p)
            w_pair, s_pair, e_pair = self.problem.eigenvalue(w_pair, p)
            slope = s_real.real - s_pair.real
            # An eigenvalue that changed between real and complex is not the one that was followed.
            if w_real.imag != 0 or w_pair.imag == 0 or slope == 0 or not math.isfinite(slope):
                return None
            step = -(w_real.real - w_pair.real) / slope
            error = (e_real + e_pair) / abs(slope) + LEADING_EIGENVALUE_SETTINGS.rounding_error * abs(p)
            p += step
            if not ends[0] <= p <= ends[1]:
                return None
            if abs(step) <= LEADING_EIGENVALUE_SETTINGS.converged_step_in_errors * error:
                return LeaderExchange(p, max(error, abs(step)), w_pair.real, abs(w_pair.imag))
            w_real = w_real + step * s_real
            w_pair = w_pair + step * s_pair
            if w_real.imag != 0:
                w_real = complex(w_real.real, 0.0)
        return None

    def _follow_eigenvalue(self, w: complex, start: float, stop: float) -> complex:
        """The eigenvalue at p = `stop` that continues the eigenvalue w at p = `start`, followed in small
        steps by Newton's method on D."""
        p = start
        for i in range(1, LEADING_EIGENVALUE_SETTINGS.carrying_steps + 1):
            w, slope, _ = self.problem.eigenvalue(w, p)
            following = start + (stop - start) * i / LEADING_EIGENVALUE_SETTINGS.carrying_steps
            ahead = w + slope * (following - p)
            w = complex(ahead.real, 0.0) if w.imag == 0 else ahead
            p = following
        return w
