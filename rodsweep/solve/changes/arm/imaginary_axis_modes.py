"""Eigenvalues near the imaginary axis of selected arms of a path, and the test whether a pair may cross the
axis twice between two of these arms."""

import math
from dataclasses import dataclass

import numpy as np

from ....arrays import Complex, list_of
from ...spectrum.search import Spectrum, SpectrumRequest
from ...spectrum.status import SpectrumStatus
from ...unsolvable import Unsolvable
from ..sample_interpolation import cubic_minimum_and_position, deviation_from_trapezoidal_rule
from ..spectrum_samples import SPECTRUM_SAMPLE_SETTINGS
from .imaginary_axis_pairs import IMAGINARY_AXIS_MODE_SETTINGS, PairNearImaginaryAxis
from .path import ArmPath

NO_EIGENVALUES: Complex = np.empty(0, complex)


@dataclass(frozen=True)
class ArmModes:
    """Modes of the arm at path variable p: eigenvalues w and their slopes dw/dp, (modes,) each, and the
    number of unstable modes. w: either the leading eigenvalues, with both members of each pair, or the
    eigenvalues near the imaginary axis, with one member of each pair."""

    p: float
    w: Complex
    slopes: Complex
    unstable_count: int
    """Number of eigenvalues with Re w > 0."""

    def pairs(self, growing: bool) -> list[PairNearImaginaryAxis]:
        """All growing pairs if `growing`, otherwise all decaying pairs; the pair nearest to the imaginary
        axis comes first."""
        sign = 1.0 if growing else -1.0
        known = zip(list_of(self.w), list_of(self.slopes), strict=True)
        return sorted(
            PairNearImaginaryAxis(sign * w.real, sign * slope.real, w.imag, slope.imag)
            for w, slope in known
            if w.imag > 0 and (w.real > 0) == growing
        )

    @property
    def largest_modulus(self) -> float:
        """Largest modulus of the eigenvalues w; 0 if no eigenvalues are known."""
        return float(np.abs(self.w).max(initial=0.0))


class ModesAlongPath:
    """The modes of the arms of a path, computed when needed. modes_by_p: the modes computed so far, by path
    variable p. outside_p_by_end: for each end of the path, by its p: a path variable just outside the path,
    at which the modes are counted instead if the count at the end fails, for example because a pair lies on
    the axis."""

    def __init__(self, problem: ArmPath, certify: bool):
        self.problem = problem
        self.certify = certify
        self.modes_by_p: dict[float, ArmModes] = {}
        self.outside_p_by_end: dict[float, float] = {}

    def computes_only_near_imaginary_axis(self, p: float) -> bool:
        """Whether, at path variable p, only the modes near the imaginary axis are computed: many modes are
        expected to grow, and `certify` is set."""
        return (
            self.certify
            and self.problem.expected_unstable_count(p)
            > IMAGINARY_AXIS_MODE_SETTINGS.max_growing_count_for_leading_modes
        )

    def modes_at(self, p: float, guesses: Complex | None = None) -> ArmModes:
        """The modes at path variable p, or just outside an end p of the path where the count fails; raises
        Unsolvable if the eigenvalues or the count cannot be computed. guesses: approximate eigenvalues near
        the imaginary axis, (n,), one of each pair, if available."""
        if p not in self.modes_by_p:
            try:
                self.modes_by_p[p] = self._compute_modes(p, guesses)
            except Unsolvable as reason:
                if p not in self.outside_p_by_end:
                    raise
                try:
                    self.modes_by_p[p] = self._compute_modes(self.outside_p_by_end[p], None)
                except (Unsolvable, ValueError):  # ValueError: no such rod, for example a crushed one
                    raise reason from None
        return self.modes_by_p[p]

    def _compute_modes(self, p: float, guesses: Complex | None) -> ArmModes:
        """The modes near the imaginary axis if `computes_only_near_imaginary_axis(p)` and their count is
        decided, otherwise the leading modes; raises Unsolvable. guesses: approximate eigenvalues near the
        imaginary axis, (n,), one of each pair, if available."""
        # The neighbour's count gives the number of modes: the unstable modes and one more pair.
        nearest_modes = min(self.modes_by_p.values(), key=lambda place: abs(place.p - p), default=None)
        expected_count = 0 if nearest_modes is None else nearest_modes.unstable_count
        modes = (
            self._modes_near_imaginary_axis(p, guesses) if self.computes_only_near_imaginary_axis(p) else None
        )
        return modes or self._leading_modes(p, expected_count)

    def eigenvalues_near_imaginary_axis(self, p: float, max_frequency: float, known_w: Complex) -> Complex:
        """Eigenvalues near the imaginary axis at path variable p, with |Im w| up to `max_frequency`, (n,),
        one of each pair. known_w: some of these eigenvalues, (k,), which come first. Raises Unsolvable if no
        elements resolve the arm."""
        try:
            return self.problem.eigenvalues_near_imaginary_axis(p, max_frequency, known_w)
        except FloatingPointError as unresolved:
            raise Unsolvable(f"{self.problem.path.text_at(p)}: {unresolved}") from None

    def _modes_near_imaginary_axis(self, p: float, guesses: Complex | None) -> ArmModes | None:
        """The modes near the imaginary axis at path variable p, and a count of the unstable modes; None if
        the count is undecided. guesses: approximate eigenvalues of these modes, (n,), if available."""
        if guesses is None:
            guesses = self.eigenvalues_near_imaginary_axis(p, math.inf, NO_EIGENVALUES)
        refined_roots = [self.problem.eigenvalue_with_slope_and_error(guess, p) for guess in list_of(guesses)]
        w = np.array([root[0] for root in refined_roots], complex)
        count = self.problem.unstable_mode_count(p, w, np.array([root[2] for root in refined_roots]))
        slopes = np.array([root[1] for root in refined_roots], complex)
        return None if count is None else ArmModes(p, w, slopes, count)

    def _leading_modes(self, p: float, expected_count: int) -> ArmModes:
        """The leading modes at path variable p, at least two more than the unstable modes; raises Unsolvable
        if the count fails or too many modes grow. expected_count: expected number of unstable modes."""
        settings = SPECTRUM_SAMPLE_SETTINGS
        mode_count = max(settings.min_computed_modes, 2 + expected_count)
        spectrum = self.problem.spectrum(
            p, SpectrumRequest(mode_count, settings.arm_eigenvalue_accuracy, self.certify)
        )
        while mode_count < _needed_mode_count(spectrum) <= IMAGINARY_AXIS_MODE_SETTINGS.max_computed_modes:
            if self.certify and spectrum.unstable_count < 0:
                break  # more modes do not help a failed count
            mode_count = _needed_mode_count(spectrum)
            spectrum = self.problem.spectrum(
                p, SpectrumRequest(mode_count, settings.arm_eigenvalue_accuracy, self.certify)
            )
        if spectrum.unstable_count < 0:
            is_undecided = (
                spectrum.status != SpectrumStatus.ok
            )  # else only the number of unstable modes is unknown
            status_name = spectrum.status.name if is_undecided else SpectrumStatus.undecided.name
            place = self.problem.path.text_at(p)
            raise Unsolvable(
                f"the spectrum at {place} has the status {status_name}: {spectrum.message}".rstrip(": ")
            )
        if _needed_mode_count(spectrum) > max(mode_count, IMAGINARY_AXIS_MODE_SETTINGS.max_computed_modes):
            raise Unsolvable(
                f"{self.problem.path.text_at(p)}: {spectrum.unstable_count} modes grow, but at most "
                f"{IMAGINARY_AXIS_MODE_SETTINGS.max_computed_modes} modes are computed; shorten the range"
            )
        slopes = spectrum.eigenvalues.copy()
        for i, w in enumerate(list_of(spectrum.eigenvalues)):
            # The lower member of a pair follows the upper one in the list.
            slopes[i] = (
                self.problem.eigenvalue_with_slope_and_error(w, p)[1]
                if w.imag >= 0
                else slopes[i - 1].conjugate()
            )
        return ArmModes(p, spectrum.eigenvalues, slopes, spectrum.unstable_count)


def _needed_mode_count(spectrum: Spectrum) -> int:
    """Number of modes to be computed: two more than the counted number of unstable modes, or than the number
    of eigenvalues with Re w > 0 in `spectrum` if this number is larger."""
    growing_count = int((spectrum.eigenvalues.real > 0).sum())
    return 2 + max(spectrum.unstable_count, growing_count)


def interval_fraction_of_next_count(left: ArmModes, right: ArmModes) -> float:
    """Position between `left` and `right` at which the modes are to be computed and counted next, as a
    fraction of the interval of p; 0 if this is not needed, because no pair can touch the imaginary axis in
    the interval."""
    length = right.p - left.p
    for grows in (False, True):
        left_pairs, right_pairs = left.pairs(grows), right.pairs(grows)
        lowest_left = min(left_pairs, key=lambda pair: pair.min_distance_on_tangent(length), default=None)
        lowest_right = min(right_pairs, key=lambda pair: pair.min_distance_on_tangent(-length), default=None)
        # A growing pair without a partner at the other end may have crossed the axis.
        if grows and (
            any(pair.is_missing_in(right_pairs, length) for pair in left_pairs)
            or any(pair.is_missing_in(left_pairs, -length) for pair in right_pairs)
        ):
            return 0.5
        if lowest_left is None or lowest_right is None:
            # The slope of a pair known at one end only shows whether the pair came from the axis.
            if (lowest_left and lowest_left.min_distance_on_tangent(length) < 0) or (
                lowest_right and lowest_right.min_distance_on_tangent(-length) < 0
            ):
                return 0.5
            continue
        left_pair, right_pair = left_pairs[0], right_pairs[0]
        minimum, fraction = cubic_minimum_and_position(
            left_pair.distance,
            right_pair.distance,
            length * left_pair.distance_slope,
            length * right_pair.distance_slope,
        )
        if minimum < SPECTRUM_SAMPLE_SETTINGS.interpolation_tolerance * min(
            left_pair.distance, right_pair.distance
        ):
            return fraction
        # A pair farther from the axis may reach it, while the nearest pair moves away.
        if _may_touch_imaginary_axis_between(
            left_pair, right_pair, length
        ) or _may_touch_imaginary_axis_between(lowest_left, lowest_right, length):
            return 0.5
    return 0.0


def _may_touch_imaginary_axis_between(
    left: PairNearImaginaryAxis, right: PairNearImaginaryAxis, length: float
) -> bool:
    """Whether the distance of a pair from the imaginary axis may vanish within an interval although its cubic
    interpolant stays above zero: the tangents of the distance meet below zero, or one tangent falls below
    zero within the interval and the slopes do not explain the change of the pair. left, right: the pair at
    the ends. length: length of the interval."""
    if min(left.min_distance_on_tangent(length), right.min_distance_on_tangent(-length)) >= 0:
        return False
    change = abs(right.distance - left.distance)
    unexplained_change = deviation_from_trapezoidal_rule(left[:2], right[:2], length)
    unexplained_frequency = deviation_from_trapezoidal_rule(left[2:], right[2:], length)
    max_unexplained = IMAGINARY_AXIS_MODE_SETTINGS.max_change_unexplained_by_slopes
    is_explained = unexplained_change <= max_unexplained * max(
        min(left.distance, right.distance), change
    ) and unexplained_frequency <= max_unexplained * max(abs(right.frequency - left.frequency), change)
    return not is_explained or _tangents_meet_below_zero(left, right, length)


def _tangents_meet_below_zero(
    left: PairNearImaginaryAxis, right: PairNearImaginaryAxis, length: float
) -> bool:
    """Whether the distance of a pair from the imaginary axis decreases at the left end of an interval and
    increases at its right end, with tangents that meet below zero: the distance may then vanish between the
    ends. left, right: the pair at the ends. length: length of the interval."""
    if not left.distance_slope < 0 < right.distance_slope:
        return False
    meeting_place = (left.distance - right.distance + right.distance_slope * length) / (
        right.distance_slope - left.distance_slope
    )
    return left.distance + left.distance_slope * meeting_place < 0
