"""Spectra of arms at neighbouring points of a path.

Followed eigenvalues are proved complete by D'/D, by a count carried along the arms, or by a count at each
arm.
"""

import numpy as np

from ....arrays import Array
from ....determinant.arm.hull.hull import hulls_along
from ....determinant.parameter_path import ParameterPath
from ..spectrum import FollowedPoints, SpectrumRequest
from .arm_count import confirmed_count_at
from .arm_following_settings import ARM_FOLLOWING_SETTINGS
from .arm_interval import follow_interval
from .carried_arm_count import ArmCountCarrier
from .carried_count import assess_points, leading_eigenvalues
from .prediction import slice_track


def follow_spectra_of_arms(path: ParameterPath, p: Array, request: SpectrumRequest) -> FollowedPoints | None:
    """Spectra of the arms at the path variables p, (n,), from the first point to the last point reached; None
    if no point is reached."""
    interval = follow_interval(path, p, request, counts_follow=True)
    if interval is None:
        return None
    if (interval.proved_modes < request.modes).sum() >= ARM_FOLLOWING_SETTINGS.min_unproved_points:
        number = ARM_FOLLOWING_SETTINGS.hulls_per_unproved_interval
        hulls = hulls_along(path, interval.family.p_low, interval.family.p_high, number)
        interval = interval._replace(hulls=hulls)
    ArmCountCarrier(path, interval, request.modes).carry_counts()
    for i in np.flatnonzero(interval.proved_modes < request.modes).tolist():
        point_track = slice_track(interval.track, i, i + 1)
        interval.proved_modes[i] = confirmed_count_at(
            path, interval, float(interval.p[i]), request.modes, point_track
        )
    is_accepted, unstable_counts = assess_points(
        interval.track, interval.proved_modes, request.modes, request.accuracy
    )
    return FollowedPoints(*leading_eigenvalues(interval.track, request.modes), unstable_counts, is_accepted)
