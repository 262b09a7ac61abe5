"""Spectra of arms at neighbouring points of a path.

Followed eigenvalues are proved complete by D'/D, by a count carried along the arms, or by a count at each
arm.
"""

import numpy as np

from ....arrays import Array
from ....determinant.arm.hull.hull import hulls_along
from ....determinant.parameter_path import Path
from ..spectrum import FollowedPoints, SpectrumRequest
from .arm_count import confirmed_count_at
from .arm_following_settings import ARM_FOLLOWING_SETTINGS
from .arm_interval import ArmInterval, follow_interval
from .carried_arm_count import carry_counts
from .carried_count import assess_points, leading_eigenvalues
from .prediction import slice_track


def follow_spectra_of_arms(path: Path, p: Array, request: SpectrumRequest) -> FollowedPoints | None:
    """Spectra of the arms at the path variables p, (n,), from the first point to the last point reached; None
    if no point is reached."""
    found = follow_interval(path, p, request, counts_follow=True)
    if found is None:
        return None
    if (found.proved_modes < request.modes).sum() >= ARM_FOLLOWING_SETTINGS.min_unproved_points:
        found = _with_finer_hulls(path, found)
    carry_counts(path, found, request.modes)
    for i in np.flatnonzero(found.proved_modes < request.modes).tolist():
        here = slice_track(found.track, i, i + 1)
        found.proved_modes[i] = confirmed_count_at(path, found, float(found.p[i]), request.modes, here)
    good, unstable = assess_points(found.track, found.proved_modes, request.modes, request.accuracy)
    return FollowedPoints(*leading_eigenvalues(found.track, request.modes), unstable, good)


def _with_finer_hulls(path: Path, found: ArmInterval) -> ArmInterval:
    """The interval `found` with hulls at more arms, hence closer to the hull of each arm."""
    places = np.linspace(
        found.family.p_low, found.family.p_high, ARM_FOLLOWING_SETTINGS.hulls_per_unproved_interval
    )
    return found._replace(hulls=hulls_along([path.rod_at(x) for x in places.tolist()], places))
