"""Spectra of arms at the points of a stretch. If few followed modes leave many points without a proof, more
modes are followed to these points.

A count at a point costs as much as following ten further modes to the point. More modes prove more points, up
to a value of the path variable beyond which the hull is too wide; bisection with single arms finds this
value.
"""

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....determinant.arm.hull.hull import hulls_along
from ....determinant.parameter_path import Path
from ..spectrum import FollowedPoints, SpectrumRequest
from .arm_stretch import ArmInterval, count_at, follow_interval, follow_with, proves_point
from .arm_stretch_settings import ARM_STRETCH
from .carried_count import assess_points, leading_eigenvalues
from .prediction import slice_track


def follow_stretch_of_arms(path: Path, p: Array, request: SpectrumRequest) -> FollowedPoints | None:
    """Spectra of the arms at the path variables p, (n,), from the first point to the last point reached; None
    if no point is reached."""
    found = follow_interval(path, p, request)
    if found is None:
        return None
    if (found.proved_modes < request.modes).sum() >= ARM_STRETCH.min_unproved_points:
        found = _with_finer_hulls(path, found)
    again = _followed_again(path, found, request)
    counted = found.proved_modes < request.modes
    for first, interval in again:
        counted[first : first + len(interval.p)] &= interval.proved_modes < request.modes
    for i in np.flatnonzero(counted).tolist():
        here = slice_track(found.track, i, i + 1)
        found.proved_modes[i] = count_at(path, found, float(found.p[i]), request.modes, here)
    spectra = _spectra(found, request)
    for first, interval in again:
        proved = np.flatnonzero(interval.proved_modes >= request.modes)
        for column, better in zip(spectra, _spectra(interval, request), strict=True):
            column[first + proved] = better[proved]
    return FollowedPoints(*spectra)


def _with_finer_hulls(path: Path, found: ArmInterval) -> ArmInterval:
    """The interval `found` with hulls at more arms, hence closer to the hull of each arm."""
    places = np.linspace(found.family.low, found.family.high, ARM_STRETCH.hull_arms_for_unproved)
    return found._replace(hulls=hulls_along([path.rod_at(x) for x in places.tolist()], places))


def _spectra(
    found: ArmInterval, request: SpectrumRequest
) -> tuple[NDArray, NDArray, NDArray[np.int64], NDArray[np.bool_]]:
    """The columns of `FollowedPoints` at all points of an interval, (points, ...) each."""
    good, unstable = assess_points(found.track, found.proved_modes, request.modes, request.accuracy)
    return *leading_eigenvalues(found.track, request.modes), unstable, good


def _followed_again(
    path: Path, found: ArmInterval, request: SpectrumRequest
) -> list[tuple[int, ArmInterval]]:
    """Returns (index of the first point in `found`, interval) for each group of unproved points that is
    followed again with more modes."""
    again: list[tuple[int, ArmInterval]] = []
    left = np.flatnonzero(found.proved_modes < request.modes)
    for further in ARM_STRETCH.further_modes_for_unproved:
        if further <= found.further_modes or len(left) < ARM_STRETCH.min_unproved_points:
            continue
        start, stop = _provable(path, found, left, request, further)
        if stop - start < ARM_STRETCH.min_unproved_points:
            continue
        interval = follow_with(path, found.p[start:stop], request, further, None)
        if interval is not None:
            again.append((start, interval))
            left = left[(left < start) | (left >= stop)]
    return again


def _provable(
    path: Path, found: ArmInterval, left: NDArray[np.int64], request: SpectrumRequest, further: int
) -> tuple[int, int]:
    """Returns (start, stop): the range of points for which following `further` modes is expected to give a
    proof, at one end of `left`; (0, 0) if there is no such range.

    left: increasing indices of the points without a proof, (n,).
    """
    for order in (left, left[::-1]):
        if not proves_point(path, found, float(found.p[order[0]]), request, further):
            continue
        good, bad = 0, len(order)
        if proves_point(path, found, float(found.p[order[-1]]), request, further):
            good = bad - 1
        while bad - good > max(1, len(order) // ARM_STRETCH.unproved_parts):
            middle = (good + bad) // 2
            if proves_point(path, found, float(found.p[order[middle]]), request, further):
                good = middle
            else:
                bad = middle
        ends = sorted((int(order[0]), int(order[good])))
        return ends[0], ends[1] + 1
    return 0, 0
