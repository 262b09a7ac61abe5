"""Places of a path of arms with the eigenvalues beside the imaginary axis, and whether two crossings may hide
between two places."""

import math
from dataclasses import dataclass

import numpy as np

from ....arrays import Complex
from ...point import Unsolvable
from ...spectrum.search import Spectrum, SpectrumRequest
from ..anchors import ANCHORS, minimum_of_cubic
from .path import ArmPath


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisPlaceSettings:
    """Settings for the places of a search for crossings."""

    many: float = 16.0
    """Expected number of growing modes beyond which a place knows the modes beside the axis alone."""
    max_known_modes: int = 200
    """Largest number of leading eigenvalues known at a place."""


AXIS_PLACES = AxisPlaceSettings()
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

    @property
    def highest(self) -> float:
        """Largest |w|; 0 without eigenvalues."""
        return float(np.abs(self.w).max(initial=0.0))


class AxisPlaces:
    """The known places of a path, by p."""

    def __init__(self, problem: ArmPath, certify: bool):
        self.problem = problem
        self.certify = certify
        self.known: dict[float, AxisPlace] = {}

    def are_many(self, p: float) -> bool:
        """Whether a place at p knows the modes beside the axis alone."""
        return self.certify and self.problem.expected_growing(p) > AXIS_PLACES.many

    def at(self, p: float, beside: Complex | None = None) -> AxisPlace:
        """The place at p; raises Unsolvable if eigenvalues or count cannot be computed.

        beside: approximate eigenvalues beside the axis, (n,), one of each pair, if known.
        """
        if p not in self.known:
            # The neighbour's count tells how many modes are needed: all unstable ones and a pair beyond.
            near = min(self.known.values(), key=lambda place: abs(place.p - p), default=None)
            growing = 0 if near is None else near.unstable
            found = self._place_beside(p, beside) if self.are_many(p) else None
            self.known[p] = found or self._place_of_leaders(p, growing)
        return self.known[p]

    def modes_beside(self, p: float, highest: float, known: Complex) -> Complex:
        """Eigenvalues beside the axis at p, (n,), as `ArmPath.beside_axis`; known: some of them, (k,).

        Raises Unsolvable if no elements resolve the arm.
        """
        try:
            return self.problem.beside_axis(p, highest, known)
        except FloatingPointError as unresolved:
            raise Unsolvable(f"{self.problem.path.at(p)}: {unresolved}") from None

    def _place_beside(self, p: float, beside: Complex | None) -> AxisPlace | None:
        """The place at p by a count and the modes beside the axis; None if the count is undecided."""
        guesses = self.modes_beside(p, math.inf, NONE_BESIDE) if beside is None else beside
        refined = [self.problem.eigenvalue(guess, p) for guess in guesses.tolist()]
        w = np.array([one[0] for one in refined], complex)
        number = self.problem.counted(p, w, np.array([one[2] for one in refined]))
        slopes = np.array([one[1] for one in refined], complex)
        return None if number is None else AxisPlace(p, w, slopes, number)

    def _place_of_leaders(self, p: float, growing: int) -> AxisPlace:
        """The place at p by its leading modes, two more than grow; growing: how many may grow."""
        modes = max(ANCHORS.min_known_modes, 2 + growing)
        found = self.problem.spectrum(p, SpectrumRequest(modes, ANCHORS.place_accuracy, self.certify))
        while modes < _needed(found) <= AXIS_PLACES.max_known_modes:
            if self.certify and found.unstable_count < 0:
                break  # a count that fails does not succeed with more modes
            modes = _needed(found)
            found = self.problem.spectrum(p, SpectrumRequest(modes, ANCHORS.place_accuracy, self.certify))
        if found.unstable_count < 0:
            raise Unsolvable(f"{self.problem.path.at(p)}: {found.status.name} {found.message}".rstrip())
        if _needed(found) > max(modes, AXIS_PLACES.max_known_modes):
            raise Unsolvable(
                f"{self.problem.path.at(p)}: {found.unstable_count} modes grow, more than the search follows"
            )
        slopes = found.eigenvalues.copy()
        for i, w in enumerate(found.eigenvalues.tolist()):
            slopes[i] = self.problem.eigenvalue(w, p)[1] if w.imag >= 0 else slopes[i - 1].conjugate()
        return AxisPlace(p, found.eigenvalues, slopes, found.unstable_count)


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
