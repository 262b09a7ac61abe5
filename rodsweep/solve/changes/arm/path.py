"""Transverse eigenvalue problem along a path of nonuniform arms; choice of the problem for any path."""

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from ....arrays import Array, Complex, list_of
from ....determinant.arm.arm_family import ArmFamily, interpolated_family
from ....determinant.arm.count.modes_near_axis import modes_near_axis
from ....determinant.arm.determinant import arm_determinant
from ....determinant.arm.determinant_along_path import ArmAlongPath
from ....determinant.arm.hull.hull import hull_of
from ....determinant.certificate.winding_number import EigenvalueCount
from ....determinant.parameter_path import ParameterPath
from ....determinant.roots.newton import LocatedEigenvalue
from ....model.dispersion import expected_unstable_count
from ...spectrum.path.eigenvalue_prediction import KnownRoots
from ...spectrum.path.followed_arms import FollowedArms
from ...spectrum.problem import ArmProblem
from ...spectrum.search import Spectrum, SpectrumRequest
from ...spectrum.status import SpectrumStatus
from ..path_problem import PathEigenproblem, UniformPath


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmPathSettings:
    """Settings for the intervals of a path of arms and for following eigenvalues."""

    first_interval_count: int = 12
    """Number of intervals into which a path of arms is first divided."""
    edge_shift_fraction: float = 0.0618
    """All edges but the first and the last are shifted by this fraction of an interval. With equal intervals,
    an edge would lie on a Hopf point, where no count succeeds, if the range ends at twice the force of this
    point."""
    steps_per_interval: int = 4
    """Number of steps in which eigenvalues are followed through each of `first_interval_count` intervals."""
    followed_count_beyond_unstable: int = 4
    """At each step, the list of all unstable eigenvalues and this many further leading eigenvalues is proved
    complete."""
    spare_mode_count: int = 2
    """Number of modes computed in addition, if more than `followed_count_beyond_unstable` modes are
    requested."""
    max_expected_growing_modes: float = 16.0
    """No modes are followed where the estimate `expected_unstable_count` exceeds this number: at most 13
    modes can be followed, and the estimate is 0.9 to 1.9 times the true number."""
    family_W_over_max_abs_eigenvalue: float = 4.0
    """Bound W of |w| up to which the interpolated propagators of an arm family are valid, for crossings,
    divided by the largest known |w|. For the eigenvalues themselves, twice the known |w| would suffice."""
    max_known_count_distance_fraction: float = 0.25
    """A known count replaces a count in the middle of an interval if the distance of its path variable from
    the middle is less than this fraction of the interval's length."""


ARM_PATH_SETTINGS = ArmPathSettings()


class ArmPath(PathEigenproblem):
    """Path of arms that vary along the length or have a nonlinear law; the determinant D is computed from
    propagators. The leading eigenvalues are followed along the path once, and then from the nearest step to
    every requested p."""

    def __init__(self, path: ParameterPath):
        super().__init__(path)
        self._followed_arms: FollowedArms | None = None
        self._solved_spectra: dict[float, Spectrum] = {}
        """Spectra that were solved, not followed: for each path variable p, the last spectrum solved."""
        self._unstable_counts: dict[float, int] = {}
        """Proved numbers of unstable modes, by p."""
        self._families: list[ArmFamily] = []
        self._determinant_along_path = ArmAlongPath(path, self._arm_family_at)

    def _arm_family_at(self, p: float) -> ArmFamily | None:
        """The family of arms (interpolated propagators, `ArmFamily`) whose interval of the path contains p;
        None if there is no such family."""
        family = next(
            (candidate for candidate in self._families if candidate.p_low <= p <= candidate.p_high), None
        )
        if (
            family is None
            and self._followed_arms is not None
            and self.expected_unstable_count(p) <= ARM_PATH_SETTINGS.max_expected_growing_modes
        ):
            return self._followed_arms.arm_family_at(p)
        return family

    def ensure_arm_family(self, low: float, high: float, largest_modulus: float) -> None:
        """Creates a family of arms, that is, interpolated propagators for all arms from `low` to `high`, for
        eigenvalues up to |w| = `largest_modulus`, if possible and if no stored family suffices."""
        W = ARM_PATH_SETTINGS.family_W_over_max_abs_eigenvalue * largest_modulus
        if any(
            # A family serves eigenvalues up to half of its W, so that Newton's iterates stay within W.
            stored.p_low <= low and high <= stored.p_high and largest_modulus * 2 <= stored.largest_w
            for stored in self._families
        ):
            return
        with suppress(ValueError, FloatingPointError):
            family = interpolated_family(self.path, low, high, W)
            self._families += [family] if family is not None else []

    def interval_edges(self, low: float, high: float) -> list[float]:
        edges = np.linspace(low, high, ARM_PATH_SETTINGS.first_interval_count + 1)
        edges[1:-1] -= (
            ARM_PATH_SETTINGS.edge_shift_fraction * (high - low) / ARM_PATH_SETTINGS.first_interval_count
        )
        if self._followed_arms is None and low < high:
            step_positions = (
                np.arange(ARM_PATH_SETTINGS.first_interval_count * ARM_PATH_SETTINGS.steps_per_interval + 1)
                / ARM_PATH_SETTINGS.steps_per_interval
            )
            points = np.interp(step_positions, np.arange(len(edges)), edges)
            self._followed_arms = FollowedArms(
                self.path, points, ARM_PATH_SETTINGS.followed_count_beyond_unstable
            )
        return list_of(edges)

    def expected_unstable_count(self, p: float) -> float:
        """Estimate of the number of unstable modes at p."""
        return expected_unstable_count(self.path.rod_at(p))

    def followed_spectrum(self, p: float, mode_count: int) -> Spectrum | None:
        """The `mode_count` leading eigenvalues at p, proved complete, if they can be followed to p; else
        None."""
        settings = ARM_PATH_SETTINGS
        if (
            self._followed_arms is None
            or self.expected_unstable_count(p) > settings.max_expected_growing_modes
        ):
            return None
        spectrum = self._followed_arms.spectrum(p, mode_count)
        if spectrum is not None:
            self._unstable_counts[p] = spectrum.unstable_count
        return spectrum

    def spectrum(self, p: float, request: SpectrumRequest) -> Spectrum:
        """The leading eigenvalues at p: followed, taken from an earlier request, or solved."""
        key = p, request
        if key not in self._spectra:
            spectrum = self.followed_spectrum(p, request.mode_count)
            if spectrum is None:
                spectrum = self._solved_spectrum(p, request)
            self._spectra[key] = spectrum
            if spectrum.certified:
                self._unstable_counts[p] = spectrum.unstable_count
        return self._spectra[key]

    def _solved_spectrum(self, p: float, request: SpectrumRequest) -> Spectrum:
        """The leading eigenvalues at p, from an earlier solve at p with enough modes, or from a new solve.
        Near a crossing a request for many modes is followed by a request for one more pair; this pair is
        therefore included in the first solve."""
        stored_spectrum = self._solved_spectra.get(p)
        # A few modes more at first save a second solve where the next request needs one pair more.
        if (
            stored_spectrum is None
            or len(stored_spectrum.eigenvalues) < request.mode_count
            or stored_spectrum.status != SpectrumStatus.ok
        ):
            spare = (
                ARM_PATH_SETTINGS.spare_mode_count
                if request.mode_count > ARM_PATH_SETTINGS.followed_count_beyond_unstable
                else 0
            )
            stored_spectrum = super().spectrum(p, replace(request, mode_count=request.mode_count + spare))
            # The additional modes may be harder to solve; they must not spoil the requested modes.
            if spare and stored_spectrum.status != SpectrumStatus.ok:
                stored_spectrum = super().spectrum(p, request)
            self._solved_spectra[p] = stored_spectrum
        return replace(
            stored_spectrum,
            eigenvalues=stored_spectrum.eigenvalues[: request.mode_count],
            error_estimate=stored_spectrum.error_estimate[: request.mode_count],
        )

    def known_unstable_count_near_middle(self, low: float, high: float) -> int | None:
        known_p = [
            p
            for p in self._unstable_counts
            if abs(p - (low + high) / 2) < ARM_PATH_SETTINGS.max_known_count_distance_fraction * (high - low)
        ]
        nearest_p = min(known_p, key=lambda p: abs(p - (low + high) / 2), default=None)
        return None if nearest_p is None else self._unstable_counts[nearest_p]

    def eigenvalue_with_slope_and_error(self, guess: complex, p: float) -> tuple[complex, complex, float]:
        slope_and_error = (
            self._followed_arms.slope_and_error_of_eigenvalue(guess, p)
            if self._followed_arms is not None
            else None
        )
        if slope_and_error is None:
            return self._determinant_along_path.eigenvalue_with_slope_and_error(guess, p)
        return (guess, *slope_and_error)

    def double_eigenvalue(self, x: float, p: float, expected_distance: float) -> LocatedEigenvalue:
        return self._determinant_along_path.double_eigenvalue(x, p, expected_distance)

    def count_right_of(self, line: float, p: float) -> EigenvalueCount:
        spectrum = self.followed_spectrum(p, ARM_PATH_SETTINGS.followed_count_beyond_unstable)
        if spectrum is not None:
            w = spectrum.eigenvalues
            error = spectrum.error_estimate
            are_clear = (np.abs(w.real - line) > 2 * error).all()
            # The followed modes are complete down to the last of them, so counting them is a proof.
            if are_clear and w[-1].real < line <= 0:
                return EigenvalueCount(int((w.real > line).sum()), 0)
            if (
                are_clear
                and line == 0
                and spectrum.unstable_count < ARM_PATH_SETTINGS.followed_count_beyond_unstable
            ):
                return EigenvalueCount(spectrum.unstable_count, 0)
        followed_roots = self._followed_arms.followed_roots(p) if self._followed_arms is not None else None
        return ArmProblem(self.path.rod_at(p)).count_right_of(line, followed_roots)

    def unstable_mode_count(self, p: float, known_w: Complex, known_error: Array) -> int | None:
        """Number of unstable modes at p, known already or by a count; None if the count is undecided.
        known_w: eigenvalues near the imaginary axis, (n,), one of each pair, which make the count faster.
        known_error: errors of these eigenvalues, (n,)."""
        if p not in self._unstable_counts:
            roots = KnownRoots(np.append(known_w, known_w.conj()), np.append(known_error, known_error))
            count = ArmProblem(self.path.rod_at(p)).count_right_of(0.0, roots).number
            if count is None:
                return None
            self._unstable_counts[p] = count
        return self._unstable_counts[p]

    def eigenvalues_near_imaginary_axis(self, p: float, max_frequency: float, known_w: Complex) -> Complex:
        """Eigenvalues at p near the imaginary axis with |Im w| up to `max_frequency`, (n,), one of each pair.
        known_w: some of these eigenvalues, (k,), which come first. Raises FloatingPointError if no elements
        resolve the arm."""
        rod = self.path.rod_at(p)
        return modes_near_axis(arm_determinant(rod), min(max_frequency, hull_of(rod).box()[1]), known_w)


def path_problem(path: ParameterPath) -> PathEigenproblem:
    """The eigenvalue problem along `path`: `UniformPath` for uniform linear rods, else `ArmPath`."""
    return UniformPath(path) if path.rod.is_uniform_and_linear else ArmPath(path)
