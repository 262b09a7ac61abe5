"""Leading eigenvalues of arms along a path, followed once from point to point, then available at every p."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ....arrays import Array, list_of
from ....determinant.arm.arm_family import ArmFamily
from ....determinant.parameter_path import ParameterPath
from ..spectrum import Spectrum, SpectrumRequest
from ..status import SpectrumStatus
from .arm_following import ARM_FOLLOWING_SETTINGS, follow_eigenvalues_of_arms
from .arm_interval import ArmInterval, follow_interval
from .carried_arm_count import confirmed_mode_count_at
from .carried_count import certified_points_and_unstable_counts, leading_eigenvalues_of_track
from .eigenvalue_prediction import FollowedEigenvalues, KnownRoots, new_track, slice_track


class FollowedArms:
    """Leading eigenvalues of arms along a path; eigenvalues at any path variable p are followed from the
    nearest point.

    Eigenvalues are followed from point to point only as far as the largest requested p. If following fails at
    a point, a new interval starts at a later point. intervals: the intervals followed so far.
    """

    def __init__(self, path: ParameterPath, p: Array, mode_count: int):
        """p: path variable of the points, monotone, (n,). mode_count: number of leading eigenvalues to be
        proved complete at each point."""
        self.path = path
        self.request = SpectrumRequest(mode_count, ARM_FOLLOWING_SETTINGS.eigenvalue_accuracy, certify=True)
        self.intervals: list[ArmInterval] = []
        self._proved_by_p: dict[float, list[ProvedEigenvalues]] = {}
        self._p = p
        self._next_point = 0
        self._points_skipped_on_failure = 1

    def _follow_to(self, p: float) -> None:
        """Follows eigenvalues up to the first point at or beyond p."""
        while self._next_point < len(self._p) and (self._next_point == 0 or self._p[self._next_point] < p):
            previous = self.intervals[-1] if self.intervals else None
            interval = follow_interval(self.path, self._p[self._next_point :], self.request, previous)
            if interval is not None:
                self.intervals.append(interval)
            # Intervals share their end points. After a failure the next points often fail, too,
            # so every further failure skips twice as many points.
            self._next_point += (
                max(len(interval.p) - 1, 1) if interval is not None else self._points_skipped_on_failure
            )
            self._points_skipped_on_failure = (
                1 if interval is not None else 2 * self._points_skipped_on_failure
            )

    def arm_family_at(self, p: float) -> ArmFamily | None:
        """The family of interpolated arms that contains the arm at p; None if eigenvalues could not be
        followed there."""
        self._follow_to(p)
        return next(
            (
                interval.arm_family
                for interval in self.intervals
                if interval.arm_family.p_low <= p <= interval.arm_family.p_high
            ),
            None,
        )

    def slope_and_error_of_eigenvalue(self, w: complex, p: float) -> tuple[complex, float] | None:
        """Returns (dw/dp, error of w) for an eigenvalue w that `spectrum` returned at p; None for any other
        w."""
        for eigenvalues in self._proved_by_p.get(p, []):
            for k in list_of(np.flatnonzero(eigenvalues.track.w[0] == w)):
                return complex(eigenvalues.track.slope[0, k]), float(eigenvalues.track.error[0, k])
        return None

    def spectrum(self, p: float, mode_count: int) -> Spectrum | None:
        """The leading `mode_count` eigenvalues at p; None unless followed, accurate and proved complete."""
        self._follow_to(p)
        proved_at_p = self._proved_by_p.setdefault(p, [])
        if not any(mode_count <= eigenvalues.max_tried_mode_count for eigenvalues in proved_at_p):
            proved_at_p += self._proved_eigenvalues_at(p, mode_count)
        spectra = (eigenvalues.spectrum(mode_count, self.request.accuracy) for eigenvalues in proved_at_p)
        return next((spectrum for spectrum in spectra if spectrum is not None), None)

    def followed_roots(self, p: float) -> KnownRoots | None:
        """Eigenvalues followed to path variable p, not proved complete; None if following fails."""
        self._follow_to(p)
        for interval in self.intervals:
            if interval.p.min() <= p <= interval.p.max():
                track, _ = self._track_and_proved_count_at(interval, p, self.request.mode_count)
                if track is not None:
                    return KnownRoots(track.w[0], track.error[0])
        return None

    def _proved_eigenvalues_at(self, p: float, mode_count: int) -> Iterator["ProvedEigenvalues"]:
        """Yields the eigenvalues at p, followed in each of the `intervals` that contain p; ends after the
        first interval in which `mode_count` leading eigenvalues are proved complete. The proof is tried for
        all growing modes and two more modes at once, which later requests may need."""
        for interval in self.intervals:
            followed_count = interval.track.w.shape[1]
            if not interval.p.min() <= p <= interval.p.max() or followed_count < mode_count:
                continue
            track = None
            proved_count = 0
            requested = 0
            growing_count = int((interval.track.w[np.argmin(np.abs(interval.p - p))].real > 0).sum())
            # More modes may grow at p than at the nearest point.
            while requested < (
                needed_modes := min(
                    max(mode_count, growing_count + ARM_FOLLOWING_SETTINGS.modes_beyond_growing),
                    followed_count,
                )
            ):
                requested = needed_modes
                track, proved_count = self._track_and_proved_count_at(interval, p, requested)
                growing_count = 0 if track is None else int((track.w.real > 0).sum())
            if track is None:
                continue
            for number in sorted({requested, mode_count}, reverse=True):
                if proved_count < number:
                    proved_count = max(
                        proved_count, confirmed_mode_count_at(self.path, interval, p, number, track)
                    )
            yield ProvedEigenvalues(max(mode_count, min(proved_count, requested)), track, proved_count)
            if proved_count >= mode_count:
                return

    def _track_and_proved_count_at(
        self, interval: ArmInterval, p: float, mode_count: int
    ) -> tuple[FollowedEigenvalues | None, int]:
        """Returns (track with the eigenvalues at p only, number of modes proved complete), followed from the
        point nearest to p. interval: an interval that contains p. mode_count: number of leading modes to be
        proved. The track is None if following fails."""
        i = int(np.argmin(np.abs(interval.p - p)))
        start = float(interval.p[i])
        # The proof at the point itself is there already.
        if p == start and mode_count <= self.request.mode_count:
            return slice_track(interval.track, i, i + 1), int(interval.proved_counts[i])
        # One step mostly suffices; shorter steps follow where eigenvalues meet in between.
        for steps in ARM_FOLLOWING_SETTINGS.step_counts_from_nearest_point:
            # At the point itself the eigenvalues are refined once more, with a proof for more modes.
            grid = np.array([start]) if p == start else start + (p - start) * np.arange(steps + 1) / steps
            track = new_track(interval.track.w[i], len(grid))
            proved_counts = np.zeros(len(grid), np.int64)
            track.descending_order[0] = interval.track.descending_order[i]
            if follow_eigenvalues_of_arms(
                track, interval.arm_family, interval.hulls, grid, mode_count, proved_counts
            ) == len(grid):
                return slice_track(track, len(grid) - 1, len(grid)), int(proved_counts[-1])
        return None, 0


class ProvedEigenvalues(NamedTuple):
    """Eigenvalues of the arm at one path variable p; the leading `proved_count` eigenvalues are proved
    complete. max_tried_mode_count: largest number of leading eigenvalues for which a proof was tried."""

    max_tried_mode_count: int
    track: FollowedEigenvalues
    """Track of a single point p with all followed eigenvalues, (1, m)."""
    proved_count: int

    def spectrum(self, mode_count: int, accuracy: float) -> Spectrum | None:
        """The leading `mode_count` eigenvalues if they were followed, have the relative accuracy
        `accuracy` and are proved complete; else None."""
        if self.track.w.shape[1] < mode_count:
            return None
        is_good, unstable_counts = certified_points_and_unstable_counts(
            self.track, np.array([self.proved_count]), mode_count, accuracy
        )
        if not is_good[0]:
            return None
        w, error = leading_eigenvalues_of_track(self.track, mode_count)
        return Spectrum(
            status=SpectrumStatus.ok,
            eigenvalues=w[0],
            error_estimate=error[0],
            unstable_count=int(unstable_counts[0]),
            certified=True,
        )
