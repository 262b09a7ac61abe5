"""Eigenvalues near the imaginary axis of selected arms of a path, and the test whether a pair may cross the
axis twice between two of these arms."""

import math
from dataclasses import dataclass

import numpy as np

from ....arrays import Complex
from ...spectrum.search import Spectrum, SpectrumRequest
from ...spectrum.status import SpectrumStatus
from ...unsolvable import Unsolvable
from ..anchor_interpolation import minimum_of_cubic
from ..anchors import ANCHOR_SETTINGS
from .path import ArmPath


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisModeSettings:
    """Settings of the eigenvalues that are computed for selected arms during a search for crossings."""

    many_modes: float = 16.0
    """If a certificate is requested and more modes of an arm than this are expected to grow, only the modes
    near the imaginary axis are computed."""
    max_known_modes: int = 200
    """Maximum number of leading eigenvalues computed for one arm."""


AXIS_MODE_SETTINGS = AxisModeSettings()
NO_EIGENVALUES: Complex = np.empty(0, complex)


@dataclass(frozen=True)
class AxisModes:
    """Modes of the arm at path variable p: eigenvalues w and their slopes dw/dp, (modes,) each, and the
    number of unstable modes.

    w: either the leading eigenvalues, with both members of each pair, or the eigenvalues near the imaginary
    axis, with one member of each pair.
    """

    p: float
    w: Complex
    slopes: Complex
    unstable_count: int

    def nearest_pair(self, growing: bool) -> tuple[float, float] | None:
        """Returns (distance from the imaginary axis, derivative of this distance with respect to p) of the
        pair nearest to the axis, among the growing pairs if `growing`, otherwise among the decaying pairs;
        None if no such pair is known."""
        pairs = [i for i, w in enumerate(self.w.tolist()) if w.imag > 0 and (w.real > 0) == growing]
        if not pairs:
            return None
        i = min(pairs, key=lambda i: abs(self.w[i].real))
        sign = 1.0 if growing else -1.0
        return float(sign * self.w[i].real), float(sign * self.slopes[i].real)

    @property
    def largest_modulus(self) -> float:
        """Largest modulus of the eigenvalues w; 0 if no eigenvalues are known."""
        return float(np.abs(self.w).max(initial=0.0))


class AxisModesOfPath:
    """The modes of the arms of a path, computed when needed.

    modes_by_p: the modes computed so far, by path variable p. outside_p_by_end: for p of each end of the
    path, a path variable just outside, at which the modes are counted instead if the count at the end fails,
    for example because a pair lies on the axis.
    """

    def __init__(self, problem: ArmPath, certify: bool):
        self.problem = problem
        self.certify = certify
        self.modes_by_p: dict[float, AxisModes] = {}
        self.outside_p_by_end: dict[float, float] = {}

    def has_many_modes(self, p: float) -> bool:
        """Whether, at path variable p, only the modes near the imaginary axis are computed: many modes are
        expected to grow, and `certify` is set."""
        return self.certify and self.problem.expected_unstable_count(p) > AXIS_MODE_SETTINGS.many_modes

    def modes_at(self, p: float, beside: Complex | None = None) -> AxisModes:
        """The modes at path variable p, or just outside an end p of the path where the count fails; raises
        Unsolvable if the eigenvalues or the count cannot be computed.

        beside: approximate eigenvalues near the imaginary axis, (n,), one of each pair, if available.
        """
        if p not in self.modes_by_p:
            try:
                self.modes_by_p[p] = self._compute_modes(p, beside)
            except Unsolvable:
                replacement = self._modes_just_outside(p)
                if replacement is None:
                    raise
                self.modes_by_p[p] = replacement
        return self.modes_by_p[p]

    def _modes_just_outside(self, p: float) -> AxisModes | None:
        """The modes slightly outside the end p of the searched range, used if the modes at p cannot be
        counted; None if p is no end, or if these modes cannot be computed."""
        if p not in self.outside_p_by_end:
            return None
        try:
            return self._compute_modes(self.outside_p_by_end[p], None)
        except (Unsolvable, ValueError):  # ValueError: no such rod, for example a crushed one
            return None

    def _compute_modes(self, p: float, beside: Complex | None) -> AxisModes:
        """The modes near the imaginary axis if `has_many_modes(p)` and their count is decided, otherwise the
        leading modes; raises Unsolvable. beside: as in `modes_at`."""
        # The neighbour's count gives the number of modes: the unstable modes and one more pair.
        near = min(self.modes_by_p.values(), key=lambda place: abs(place.p - p), default=None)
        growing = 0 if near is None else near.unstable_count
        found = self._modes_near_axis(p, beside) if self.has_many_modes(p) else None
        return found or self._leading_modes(p, growing)

    def eigenvalues_near_axis(self, p: float, max_frequency: float, known: Complex) -> Complex:
        """Eigenvalues near the imaginary axis at path variable p, with |Im w| up to `max_frequency`, (n,),
        one of each pair. known: some of these eigenvalues, (k,), which come first.

        Raises Unsolvable if no elements resolve the arm.
        """
        try:
            return self.problem.eigenvalues_near_axis(p, max_frequency, known)
        except FloatingPointError as unresolved:
            raise Unsolvable(f"{self.problem.path.text_at(p)}: {unresolved}") from None

    def _modes_near_axis(self, p: float, beside: Complex | None) -> AxisModes | None:
        """The modes near the imaginary axis at path variable p, and a count of the unstable modes; None if
        the count is undecided. beside: approximate eigenvalues of these modes, (n,), if available."""
        guesses = self.eigenvalues_near_axis(p, math.inf, NO_EIGENVALUES) if beside is None else beside
        refined = [self.problem.eigenvalue(guess, p) for guess in guesses.tolist()]
        w = np.array([one[0] for one in refined], complex)
        number = self.problem.counted_unstable_modes(p, w, np.array([one[2] for one in refined]))
        slopes = np.array([one[1] for one in refined], complex)
        return None if number is None else AxisModes(p, w, slopes, number)

    def _leading_modes(self, p: float, growing: int) -> AxisModes:
        """The leading modes at path variable p, at least two more than the unstable modes; raises Unsolvable
        if the count fails or too many modes grow. growing: expected number of unstable modes."""
        modes = max(ANCHOR_SETTINGS.min_known_modes, 2 + growing)
        found = self.problem.spectrum(p, SpectrumRequest(modes, ANCHOR_SETTINGS.arm_accuracy, self.certify))
        while modes < _needed_modes(found) <= AXIS_MODE_SETTINGS.max_known_modes:
            if self.certify and found.unstable_count < 0:
                break  # more modes do not help a failed count
            modes = _needed_modes(found)
            found = self.problem.spectrum(
                p, SpectrumRequest(modes, ANCHOR_SETTINGS.arm_accuracy, self.certify)
            )
        if found.unstable_count < 0:
            decided = found.status != SpectrumStatus.ok  # else only the number of unstable modes is unknown
            name = found.status.name if decided else SpectrumStatus.undecided.name
            raise Unsolvable(f"{self.problem.path.text_at(p)}: {name} {found.message}".rstrip())
        if _needed_modes(found) > max(modes, AXIS_MODE_SETTINGS.max_known_modes):
            raise Unsolvable(
                f"{self.problem.path.text_at(p)}: {found.unstable_count} modes grow, more than "
                "the search follows"
            )
        slopes = found.eigenvalues.copy()
        for i, w in enumerate(found.eigenvalues.tolist()):
            slopes[i] = self.problem.eigenvalue(w, p)[1] if w.imag >= 0 else slopes[i - 1].conjugate()
        return AxisModes(p, found.eigenvalues, slopes, found.unstable_count)


def _needed_modes(found: Spectrum) -> int:
    """Number of modes to be computed: two more than the larger of two numbers, the counted unstable modes and
    the growing modes found."""
    growing = int((found.eigenvalues.real > 0).sum())
    return 2 + max(found.unstable_count, growing)


def next_count_position(left: AxisModes, right: AxisModes) -> float:
    """Position of the next count as a fraction of the interval of p from `left` to `right`; 0 if no count is
    needed, because no pair can touch the imaginary axis in the interval."""
    h = right.p - left.p
    for growing in (False, True):
        a = left.nearest_pair(growing)
        b = right.nearest_pair(growing)
        if a is None and b is None:
            continue
        if a is None or b is None:
            value, slope = a or b or (0.0, 0.0)
            # The slope of a pair known at one end only shows whether the pair came from the axis.
            towards = slope > 0 if a is None else slope < 0
            if towards and value < abs(slope) * h:
                return 0.5
            continue
        lowest, share = minimum_of_cubic(a[0], b[0], h * a[1], h * b[1])
        if lowest < ANCHOR_SETTINGS.interpolation_tolerance * min(a[0], b[0]):
            return share
    return 0.0
