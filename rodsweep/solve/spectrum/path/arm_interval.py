"""Spectra of arms at neighbouring values of one parameter: eigenvalues are followed, and proved complete at
each arm.

Krylov-Schur solves the first arm for more modes than wanted: a proof that all eigenvalues to the right of a
line are known is easier with known eigenvalues to the left of the line. The propagators of all arms are
interpolated from the propagators of a few arms (`rodsweep.determinant.arm.arm_family`), on an interval short
enough for smooth polynomials.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array, Complex, list_of
from ....determinant.arm.arm_family import ArmFamily, has_smooth_coefficients, interpolated_family
from ....determinant.arm.completeness import (
    COMPLETENESS_SETTINGS,
    is_real_or_conjugate_known,
    points_right_of_hull,
    prove_complete,
)
from ....determinant.arm.determinant import arm_determinant
from ....determinant.arm.hull.hull import hulls_along
from ....determinant.arm.hull.region import PathHulls, hull_at
from ....determinant.parameter_path import ParameterPath
from ....determinant.roots.roots import RootsOfD
from ...backend.solver_pools import destroy_pooled_solvers
from ...point_outcome import FAILURE_EXCEPTIONS
from ..candidates import line_for_proof
from ..search import SpectrumSearch
from ..spectrum import SpectrumRequest
from .arm_following import ARM_FOLLOWING_SETTINGS, follow_eigenvalues_of_arms
from .eigenvalue_prediction import FollowedEigenvalues, new_track, slice_track


class ArmInterval(NamedTuple):
    """Interval of a path: points p, (n,), at which eigenvalues were followed with one `ArmFamily`.

    track: the eigenvalues followed to these points. proved_counts: number of leading modes proved complete at
    each point, (n,). family_point_count: number of given points inside this family, of which the first n were
    reached. further_mode_count: number of modes followed in addition to the wanted modes.
    """

    p: Array
    track: FollowedEigenvalues
    proved_counts: NDArray[np.int64]
    arm_family: ArmFamily
    hulls: PathHulls
    """Hulls that contain the spectra of the arms of the interval."""
    family_point_count: int
    further_mode_count: int

    def proved_point_count(self, mode_count: int) -> int:
        """Number of points at which at least `mode_count` leading modes are proved complete."""
        return int((self.proved_counts >= mode_count).sum())


def follow_interval(
    path: ParameterPath,
    p: Array,
    request: SpectrumRequest,
    previous: ArmInterval | None = None,
    counts_follow: bool = False,
) -> ArmInterval | None:
    """The leading eigenvalues at the first points of p, (n,), that are reached with one `ArmFamily`; None if
    the first point fails, if no family is found, or if n is below `min_family_points`.

    More eigenvalues are followed if these do not suffice to prove all growing modes complete, or, without
    `counts_follow`, too few points are proved complete. counts_follow: whether the caller counts eigenvalues
    at points without a proof. previous: its family is used again if it contains enough of p.
    """
    best: ArmInterval | None = None
    if len(p) < ARM_FOLLOWING_SETTINGS.min_family_points:
        return None
    for added_modes in ARM_FOLLOWING_SETTINGS.further_mode_counts:
        # This interval will need as many modes as the previous interval, so fewer modes are not tried.
        if previous is not None and added_modes < previous.further_mode_count:
            continue
        if best is not None and not (
            _follows_too_few_to_prove_growing(best)
            or (not counts_follow and _proves_middle_unproved_point(path, best, request, added_modes))
        ):
            break
        interval = _follow_with_further_modes(path, p, request, added_modes, previous)
        if interval is not None and (best is None or _is_better_interval(interval, best, request.mode_count)):
            best = interval
        min_proved = (
            0.0
            if best is None
            else ARM_FOLLOWING_SETTINGS.min_proved_fraction_without_more_modes * len(best.p)
        )
        is_proved = best is not None and best.proved_point_count(request.mode_count) >= min_proved
        if best is not None and is_proved and not _follows_too_few_to_prove_growing(best):
            break
    return best


def _follows_too_few_to_prove_growing(interval: ArmInterval) -> bool:
    """Whether too few modes are followed to prove all growing modes complete at every point."""
    growing_count = (interval.track.w.real > 0).sum(axis=1).max()
    return bool(growing_count + ARM_FOLLOWING_SETTINGS.modes_beyond_growing > interval.track.w.shape[1])


def _is_better_interval(interval: ArmInterval, other: ArmInterval, mode_count: int) -> bool:
    """Whether `interval` has more points with `mode_count` proved modes than `other`, or as many if `other`
    follows too few modes."""
    proved = interval.proved_point_count(mode_count)
    other_proved = other.proved_point_count(mode_count)
    return proved > other_proved or (proved == other_proved and _follows_too_few_to_prove_growing(other))


def _proves_middle_unproved_point(
    path: ParameterPath, interval: ArmInterval, request: SpectrumRequest, added_mode_count: int
) -> bool:
    """Whether following `added_mode_count` additional modes would prove completeness at the middle point
    among the points without a proof."""
    unproved = np.flatnonzero(interval.proved_counts < request.mode_count)
    p = float(interval.p[unproved[len(unproved) // 2]])
    # One point is solved to see whether more modes help, before all points are followed with more.
    roots = _leading_roots(path, p, request, added_mode_count)
    if roots is None or len(roots.w) < request.mode_count:
        return False
    arm = arm_determinant(path.rod_at(p))
    line = line_for_proof(
        complex(roots.w[request.mode_count - 1]), float(roots.error[request.mode_count - 1])
    )
    try:
        return prove_complete(line, roots.w, roots.error, arm, hull_at(interval.hulls, p)).is_complete
    except FloatingPointError:
        return False


def _follow_with_further_modes(
    path: ParameterPath,
    p: Array,
    request: SpectrumRequest,
    added_mode_count: int,
    previous: ArmInterval | None,
) -> ArmInterval | None:
    """The first points of p, (n,), that are reached as in `follow_interval`, with exactly `added_mode_count`
    modes followed besides the wanted modes; None if the first point fails or no `ArmFamily` is found."""
    settings = ARM_FOLLOWING_SETTINGS
    first_w = _eigenvalues_of_previous_interval(previous, float(p[0]), request, added_mode_count)
    if first_w is None:
        roots = _leading_roots(path, float(p[0]), request, added_mode_count)
        # Following takes no unpaired complex eigenvalues.
        first_w = None if roots is None else roots.w[is_real_or_conjugate_known(roots.w)]
    n = len(p)
    family_data = None
    if first_w is not None and previous is not None:
        inside_count = int(((p >= previous.arm_family.p_low) & (p <= previous.arm_family.p_high)).sum())
        if (
            inside_count >= settings.min_family_points
            and settings.min_reused_W_over_max_w * np.abs(first_w).max() <= previous.arm_family.largest_w
        ):
            family_data = (previous.arm_family, previous.hulls)
            n = inside_count
        else:
            # The last interval shows how far one family reaches.
            max_points = settings.max_points_over_previous_family * len(previous.p)
            n = min(n, max(max_points, settings.min_family_points))
    while first_w is not None and family_data is None and n >= settings.min_family_points:
        family_data = arm_family_and_hulls(path, p[:n], first_w, request.mode_count)
        # On half the interval the propagators need a lower degree.
        n = n if family_data is not None else n // 2
    if first_w is None or family_data is None:
        return None
    family, hulls = family_data
    track = new_track(first_w, n)
    proved_counts = np.zeros(n, np.int64)
    reached = follow_eigenvalues_of_arms(track, family, hulls, p[:n], request.mode_count, proved_counts)
    if reached == 0:
        return None
    arm_count = previous.family_point_count if previous is not None and family is previous.arm_family else n
    reached_track = slice_track(track, 0, reached)
    counts = proved_counts[:reached]
    return ArmInterval(p[:reached], reached_track, counts, family, hulls, arm_count, added_mode_count)


def arm_family_and_hulls(
    path: ParameterPath, p: Array, first_eigenvalues: Complex, mode_count: int
) -> tuple[ArmFamily, PathHulls] | None:
    """(`ArmFamily` of the arms at all p, (n,); hulls that contain the spectra of these arms); None if all p
    are equal, if the arms are not smooth in p, or if no elements resolve an arm. first_eigenvalues:
    eigenvalues at the first point, (m,), in descending order. mode_count: number of requested modes."""
    low = float(p.min())
    high = float(p.max())
    if not low < high:
        return None
    try:
        if not has_smooth_coefficients(path, low, high):
            return None
        hulls = hulls_along(path, low, high, ARM_FOLLOWING_SETTINGS.hulls_per_interval)
        W = ARM_FOLLOWING_SETTINGS.family_W_over_max_abs_eigenvalue * float(np.abs(first_eigenvalues).max())
        line = min(
            ARM_FOLLOWING_SETTINGS.family_W_over_max_abs_eigenvalue
            * float(first_eigenvalues[mode_count - 1].real),
            0.0,
        )
        family = arm_family_for_proofs(path, hulls, W, line)
    except (ValueError, FloatingPointError):
        return None
    return None if family is None else (family, hulls)


def arm_family_for_proofs(path: ParameterPath, hulls: PathHulls, W: float, line: float) -> ArmFamily | None:
    """The family of all arms of the path that `hulls` covers, valid for |w| <= W, or up to a larger |w|, at
    most `family_W_over_max_abs_eigenvalue` * W, that the proofs of `completeness` need. None if the arms are
    not smooth in p. line: real part right of which the proofs find no unknown eigenvalue. Raises ValueError
    without a valid arm at a p, FloatingPointError if no elements resolve an arm."""
    largest_hull = max(zip(list_of(hulls.a), list_of(hulls.c), strict=True))
    proof_w = [
        points[-1]
        for point_count in COMPLETENESS_SETTINGS.real_point_counts
        if len(points := points_right_of_hull(line, *largest_hull, point_count))
    ]
    near_ends = [w for w in proof_w if w <= ARM_FOLLOWING_SETTINGS.family_W_over_max_abs_eigenvalue * W]
    return interpolated_family(path, float(hulls.p[0]), float(hulls.p[-1]), max([W, *near_ends]))


def _eigenvalues_of_previous_interval(
    previous: ArmInterval | None, p: float, request: SpectrumRequest, added_mode_count: int
) -> Complex | None:
    """Eigenvalues, (m,), at p, from the interval `previous`; None unless p is the last point of this
    interval, `added_mode_count` further modes were followed there, and all its points are proved complete."""
    if previous is None or previous.further_mode_count != added_mode_count or previous.p[-1] != p:
        return None
    if previous.proved_point_count(request.mode_count) < len(previous.p):
        return None
    return previous.track.w[-1][previous.track.descending_order[-1]]


def _leading_roots(
    path: ParameterPath, p: float, request: SpectrumRequest, added_mode_count: int
) -> RootsOfD | None:
    """The leading eigenvalues at path variable p, without a proof: the wanted modes and `added_mode_count`
    more modes; None if the solve fails."""
    try:
        mode_count = request.mode_count + added_mode_count
        search = SpectrumSearch(
            path.rod_at(p), replace(request, mode_count=mode_count, certify=False), requested_count=mode_count
        )
        with np.errstate(all="ignore"):
            search.find_spectrum()
    except FAILURE_EXCEPTIONS:
        destroy_pooled_solvers()
        return None
    return None if search.best is None else search.best.candidates.roots
