"""Leading eigenvalues of arms along a path, followed once and read at any place between."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....determinant.arm.family import ArmFamily
from ....determinant.parameter_path import Path
from ..spectrum import Spectrum, SpectrumRequest
from ..status import SpectrumStatus
from .arm_following import follow_arms
from .arm_stretch import ARM_STRETCH, ArmInterval, counted, interval_of
from .carried_count import judge_points, leading
from .prediction import KnownRoots, Track, part_of_track, track_from


class FollowedArms:
    """Leading eigenvalues along a path, followed once from point to point; any p between is reached from the
    nearest point.

    Points are followed as far as a p is asked for. After a point at which following ends, a new interval
    starts.
    """

    def __init__(self, path: Path, p: Array, modes: int):
        """p: points in order, (n,); modes: number of leading eigenvalues to prove complete at each point."""
        self.path = path
        self.request = SpectrumRequest(modes, ARM_STRETCH.accuracy, certify=True)
        self.intervals: list[ArmInterval] = []
        self._judged: dict[float, list[JudgedPlace]] = {}
        self._p = p
        self._place = 0
        self._patience = 1

    def _follow_to(self, p: float) -> None:
        """Follows the points up to p, or up to the first one beyond."""
        while self._place < len(self._p) and (self._place == 0 or self._p[self._place] < p):
            before = self.intervals[-1] if self.intervals else None
            found = interval_of(self.path, self._p[self._place :], self.request, before)
            if found is not None:
                self.intervals.append(found)
            # Intervals share their end points. Where following fails it often fails at the next points too,
            # so every further failure skips twice as many.
            self._place += max(len(found.p) - 1, 1) if found is not None else self._patience
            self._patience = 1 if found is not None else 2 * self._patience

    def family(self, p: float) -> ArmFamily | None:
        """The family of arms that contains p."""
        self._follow_to(p)
        return next((one.family for one in self.intervals if one.family.low <= p <= one.family.high), None)

    def slope(self, w: complex, p: float) -> tuple[complex, float] | None:
        """(dw/dp, error of w) of an eigenvalue w returned by `spectrum` at p; None for any other w."""
        for one in self._judged.get(p, []):
            for k in np.flatnonzero(one.here.w[0] == w).tolist():
                return complex(one.here.slope[0, k]), float(one.here.error[0, k])
        return None

    def spectrum(self, p: float, modes: int) -> Spectrum | None:
        """The leading eigenvalues at p; None unless followed, accurate and proved complete."""
        self._follow_to(p)
        judged = self._judged.setdefault(p, [])
        if not any(modes <= one.asked for one in judged):
            judged += self._judge(p, modes)
        found = (one.spectrum(modes, self.request.accuracy) for one in judged)
        return next((spectrum for spectrum in found if spectrum is not None), None)

    def roots(self, p: float) -> KnownRoots | None:
        """Eigenvalues followed to p, which need not be all; None if following fails."""
        self._follow_to(p)
        for one in self.intervals:
            if one.p.min() <= p <= one.p.max():
                here, _ = self._from_nearest(one, p, self.request.modes)
                if here is not None:
                    return KnownRoots(here.w[0], here.error[0])
        return None

    def _judge(self, p: float, modes: int) -> Iterator["JudgedPlace"]:
        """Yields the eigenvalues at p of every interval that contains p, up to the first that are complete.

        All growing modes and two more are judged at once, because the next requests need them.
        """
        for one in self.intervals:
            followed = one.track.w.shape[1]
            if not one.p.min() <= p <= one.p.max() or followed < modes:
                continue
            here = None
            known = 0
            wanted = 0
            growing = int((one.track.w[np.argmin(np.abs(one.p - p))].real > 0).sum())
            # More modes may grow at p than at the nearest point.
            while wanted < (needed := min(max(modes, growing + ARM_STRETCH.modes_beyond_growing), followed)):
                wanted = needed
                here, known = self._from_nearest(one, p, wanted)
                growing = 0 if here is None else int((here.w.real > 0).sum())
            if here is None:
                continue
            for number in sorted({wanted, modes}, reverse=True):
                if known < number:
                    known = max(known, counted(self.path, one, p, number, here))
            yield JudgedPlace(max(modes, min(known, wanted)), here, known)
            if known >= modes:
                return

    def _from_nearest(self, one: ArmInterval, p: float, modes: int) -> tuple[Track | None, int]:
        """(eigenvalues at p followed from the nearest point, how many are proved complete there).

        The track is of p alone, None where following fails.
        """
        i = int(np.argmin(np.abs(one.p - p)))
        start = float(one.p[i])
        if p == start and modes <= self.request.modes:
            return part_of_track(one.track, i, i + 1), int(one.known[i])
        for steps in ARM_STRETCH.steps_from_nearest:
            grid = np.array([start]) if p == start else start + (p - start) * np.arange(steps + 1) / steps
            track = track_from(one.track.w[i], len(grid))
            known = np.zeros(len(grid), np.int64)
            track.order[0] = one.track.order[i]
            if follow_arms(track, one.family, one.hulls, grid, modes, known) == len(grid):
                return part_of_track(track, len(grid) - 1, len(grid)), int(known[-1])
        return None, 0


class JudgedPlace(NamedTuple):
    """Eigenvalues at one place of a path, of which the leading `known` are proved complete.

    asked: largest number of modes for which the eigenvalues were judged.
    """

    asked: int
    here: Track
    known: int

    def spectrum(self, modes: int, accuracy: float) -> Spectrum | None:
        """The leading eigenvalues if followed, accurate and complete; else None."""
        if self.here.w.shape[1] < modes:
            return None
        good, unstable = judge_points(self.here, np.array([self.known]), modes, accuracy)
        if not good[0]:
            return None
        w, error = leading(self.here, modes)
        return Spectrum(
            status=SpectrumStatus.ok,
            eigenvalues=w[0],
            error_estimate=error[0],
            unstable_count=int(unstable[0]),
            certified=True,
        )
