"""Spectra of neighbouring rods along one parameter: eigenvalues and their count are followed from rod to rod.

Krylov-Schur solves the first rod for a few modes more than requested, and solves again at a rod where
following stops, or where a count of eigenvalues differs from the number found. Rods without a proof or with
lost digits are left to be solved one by one. The outcome depends only on the given rods.
"""

import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....arrays import COMPLEX_NAN, Array, Complex, list_of
from ....determinant.arm.hull.hull import hulls_along
from ....determinant.certificate.winding_number import count_right_of
from ....determinant.parameter_path import ParameterPath
from ....model.rod import Rod, coefficients_of
from ...backend.solver_pools import destroy_pooled_solvers
from ...point_outcome import FAILURE_EXCEPTIONS
from ..search import SpectrumRequest, SpectrumSearch
from ..search import warm_up as warm_up_search
from ..spectrum import FollowedPoints, Spectrum, errors_with_rounding
from ..status import SpectrumStatus
from .arm_following import ARM_FOLLOWING_SETTINGS
from .arm_interval import follow_interval
from .carried_arm_count import ArmCountCarrier, confirmed_mode_count_at
from .carried_count import (
    certified_points_and_unstable_counts,
    count_right_of_widest_gap,
    last_point_with_carried_count,
    leading_eigenvalues_of_track,
    line_and_relative_half_gap,
)
from .eigenvalue_following import follow_eigenvalues
from .eigenvalue_prediction import FollowedEigenvalues, new_track, slice_track


@dataclass(frozen=True, slots=True, kw_only=True)
class NeighbouringRodsSettings:
    """Settings for eigenvalues followed along neighbouring rods of a sweep."""

    further_mode_count: int = 2
    """Number of modes followed in addition to the requested modes. The vertical line right of which
    eigenvalues are counted lies in a gap between the real parts of these additional modes."""


NEIGHBOURING_RODS_SETTINGS = NeighbouringRodsSettings()


@dataclass(frozen=True, slots=True)
class NeighbouringRods:
    """Neighbouring rods of a sweep with the values `parameter_values`, (n,), of the parameter of `path`."""

    path: ParameterPath
    parameter_values: Array

    def __len__(self) -> int:
        return len(self.parameter_values)

    def rod_at(self, i: int) -> Rod:
        """Rod of index i."""
        return self.path.rod.with_values(**{self.path.parameter_name: float(self.parameter_values[i])})

    @property
    def path_variable_values(self) -> Array:
        """Path variable p of every rod, (n,)."""
        return 1 / self.parameter_values if self.path.is_compliance_path else self.parameter_values

    @property
    def coefficients(self) -> Array:
        """(F, nu, c2, gamma3) of every rod, (n, 4), identical to `Rod.coefficients`."""
        columns = coefficients_of({**self.path.rod.values, self.path.parameter_name: self.parameter_values})
        coefficients = np.empty((len(self), len(columns)))
        for number, column in enumerate(columns):
            coefficients[:, number] = column
        return coefficients


@dataclass(frozen=True, slots=True)
class FollowedSpectra:
    """Spectra of `NeighbouringRods`. spectra: one `Spectrum` with a first axis of length n for all rods;
    eigenvalues are NaN where `is_solved` is False. is_solved: whether the spectrum of each rod is known,
    (n,); the remaining rods must be solved one by one."""

    spectra: Spectrum
    is_solved: NDArray[np.bool_]


def follow_spectra(rods: NeighbouringRods, request: SpectrumRequest) -> FollowedSpectra:
    """The leading `request.mode_count` eigenvalues of all rods, as far as eigenvalues can be followed from
    rod to rod and proved complete; `is_solved` is False for every other rod."""
    start_time = time.perf_counter()
    n = len(rods)
    fields = _fields_of_unsolved_spectra(n, request.mode_count)
    is_solved = np.zeros(n, np.bool_)
    start = 0
    stride = 1
    while start < n:
        followed_w = _followed_eigenvalues(rods, start, request)
        if followed_w is None:
            # If no proof succeeds, for example without a bound, following is tried less and less often.
            start += stride
            stride *= 2
            continue
        indices = slice(start, start + len(followed_w.is_accepted))
        fields["eigenvalues"][indices] = followed_w.w
        errors = errors_with_rounding(followed_w.w, followed_w.error, rods.path.rod)
        fields["error_estimate"][indices] = errors
        fields["unstable_count"][indices] = followed_w.unstable_count
        fields["certified"][indices] = True
        is_solved[indices] = followed_w.is_accepted
        start = indices.stop
        stride = 1
    seconds = np.full(n, (time.perf_counter() - start_time) / max(1, int(is_solved.sum())))
    return FollowedSpectra(Spectrum(seconds=seconds, **fields), is_solved)


def _fields_of_unsolved_spectra(rod_count: int, mode_count: int) -> dict[str, Any]:
    """Arrays for the fields of a `Spectrum` of several rods, filled with the values of an unsolved rod."""
    zeros = np.zeros(rod_count, np.int64)
    return {
        "eigenvalues": np.full((rod_count, mode_count), COMPLEX_NAN),
        "error_estimate": np.full((rod_count, mode_count), np.nan),
        "unstable_count": zeros - 1,
        "certified": np.zeros(rod_count, np.bool_),
        "elements": zeros.copy(),
        "order": zeros.copy(),
        "status": zeros + SpectrumStatus.ok,
        "message": np.full(rod_count, "", object),
    }


def _followed_eigenvalues(
    rods: NeighbouringRods, start: int, request: SpectrumRequest
) -> FollowedPoints | None:
    """Eigenvalues followed from the rod with index `start` as far as possible, with counts; None if the first
    rod fails, or for a uniform rod of nonlinear material, which is solved as an equivalent linear rod."""
    rod = rods.path.rod
    has_varying_taper = rods.path.parameter_name == "taper"
    if rod.is_uniform and not (rod.is_uniform_and_linear or has_varying_taper):
        return None  # the linear rod to which uniform rubber is equivalent has the closed form and its proof
    if has_varying_taper or not rod.is_uniform_and_linear:
        return follow_spectra_of_arms(rods.path, rods.path_variable_values[start:], request)
    first = _first_eigenvalues_and_proved_count(rods.rod_at(start), request)
    if first is None:
        return None
    first_w, proved_count = first
    modes = request.mode_count
    later_rods = NeighbouringRods(rods.path, rods.parameter_values[start:])
    track = new_track(first_w, len(later_rods))
    p = later_rods.path_variable_values
    n = follow_eigenvalues(track, later_rods.coefficients, p, rods.path.direction, modes)
    if n == 0:
        return None
    track = slice_track(track, 0, n)
    proved_counts = _proved_counts_along(later_rods, track, modes, proved_count)
    reached_track = slice_track(track, 0, len(proved_counts))
    is_good, unstable_counts = certified_points_and_unstable_counts(
        reached_track, proved_counts, modes, request.accuracy
    )
    return FollowedPoints(*leading_eigenvalues_of_track(reached_track, modes), unstable_counts, is_good)


def follow_spectra_of_arms(path: ParameterPath, p: Array, request: SpectrumRequest) -> FollowedPoints | None:
    """Spectra of the arms at the path variables p, (n,), from the first point to the last point reached; None
    if no point is reached. Followed eigenvalues are proved complete by D'/D, by a count carried along the
    arms, or by a count at each arm."""
    interval = follow_interval(path, p, request, counts_follow=True)
    if interval is None:
        return None
    modes = request.mode_count
    unproved_count = (interval.proved_counts < modes).sum()
    if unproved_count >= ARM_FOLLOWING_SETTINGS.min_unproved_points_for_more_hulls:
        hull_count = ARM_FOLLOWING_SETTINGS.hulls_per_unproved_interval
        hulls = hulls_along(path, interval.arm_family.p_low, interval.arm_family.p_high, hull_count)
        interval = interval._replace(hulls=hulls)
    ArmCountCarrier(path, interval, modes).carry_counts()
    for i in list_of(np.flatnonzero(interval.proved_counts < modes)):
        point_track = slice_track(interval.track, i, i + 1)
        interval.proved_counts[i] = confirmed_mode_count_at(
            path, interval, float(interval.p[i]), modes, point_track
        )
    is_accepted, unstable_counts = certified_points_and_unstable_counts(
        interval.track, interval.proved_counts, modes, request.accuracy
    )
    return FollowedPoints(*leading_eigenvalues_of_track(interval.track, modes), unstable_counts, is_accepted)


def _proved_counts_along(
    rods: NeighbouringRods, track: FollowedEigenvalues, mode_count: int, first_count: int
) -> NDArray[np.int64]:
    """Number of leading eigenvalues proved complete at each point of a track, up to the last point with a
    proof, (points,). mode_count: number of requested eigenvalues. first_count: number of eigenvalues proved
    complete at the first point. If a proof does not carry the number to the next point, a new count there is
    tried."""
    n = len(track.w)
    coefficients = rods.coefficients[:n]
    p = rods.path_variable_values[:n]
    proved_counts = np.zeros(n, np.int64)
    proved_counts[0] = first_count
    direction = rods.path.direction
    index = 0
    while True:
        rest = slice_track(track, index, n), coefficients[index:], p[index:]
        rest_counts = proved_counts[index:]
        index += last_point_with_carried_count(*rest, direction, mode_count, rest_counts)
        if index == n - 1:
            break
        gap = count_right_of_widest_gap(track, index + 1, mode_count)
        line = float(line_and_relative_half_gap(track, index + 1, gap)[0]) if gap else 0.0
        if not gap or count_right_of(line, rods.rod_at(index + 1)).number != gap:
            break
        index += 1
        proved_counts[index] = gap
    return proved_counts[: index + 1]


def _first_eigenvalues_and_proved_count(rod: Rod, request: SpectrumRequest) -> tuple[Complex, int] | None:
    """Returns (eigenvalues to follow, (m,), with complex ones in pairs; number of leading eigenvalues proved
    complete), or None after a failure or without a proof."""
    try:
        count = request.mode_count + NEIGHBOURING_RODS_SETTINGS.further_mode_count
        extended_request = replace(request, mode_count=count - 1, certify=True)
        search = SpectrumSearch(rod, extended_request, requested_count=count)
        with np.errstate(all="ignore"):
            outcome = search.find_spectrum()
    except FAILURE_EXCEPTIONS:
        destroy_pooled_solvers()
        return None
    if search.best is None or search.best.comparison is None or not outcome.certified:
        return None
    w = search.best.candidates.roots.w.copy()
    proved_count = search.best.comparison.found_count
    w = w[: proved_count + 1 + (proved_count < len(w) and w[proved_count].imag > 0)]
    for k in np.flatnonzero(w.imag > 0):
        if k + 1 == len(w):
            return w[:k], min(proved_count, int(k))
        w[k + 1] = w[k].conjugate()
    return w, proved_count


def warm_up() -> None:
    """Loads compiled code and creates the solver objects, so that the first sweep takes no extra time."""
    warm_up_search()
    path = ParameterPath(Rod(F=15.0, k1=1e4, k2=1e4, gamma3=1e-4), "F")
    follow_spectra(
        NeighbouringRods(path, np.linspace(15.0, 45.0, 12)), SpectrumRequest(2, 1e-4, certify=True)
    )
