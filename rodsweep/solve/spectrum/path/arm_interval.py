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

from ....arrays import Array, Complex
from ....determinant.arm.arm_family import ArmFamily, has_smooth_coefficients, interpolated_family
from ....determinant.arm.completeness import (
    COMPLETENESS_SETTINGS,
    has_conjugate,
    points_right_of_hull,
    prove_complete,
)
from ....determinant.arm.determinant import arm_determinant
from ....determinant.arm.hull.hull import hulls_along
from ....determinant.arm.hull.region import PathHulls, hull_at
from ....determinant.parameter_path import Path
from ....determinant.roots.roots import Roots
from ...backend.solver_pools import destroy_pooled_solvers
from ...point_outcome import FAILURES
from ..candidates import line_for_proof
from ..search import SpectrumSearch
from ..spectrum import SpectrumRequest
from .arm_following import follow_eigenvalues_of_arms
from .arm_following_settings import ARM_FOLLOWING_SETTINGS
from .prediction import Track, slice_track, start_track


class ArmInterval(NamedTuple):
    """Points p of a path, (n,), whose eigenvalues were followed with one family of arms.

    track: as in `follow_eigenvalues_of_arms`. proved_modes: number of leading modes proved complete at each
    point, (n,). arm_count: number of given points inside the family, of which the first n were reached.
    further_modes: number of modes followed in addition to the wanted modes.
    """

    p: Array
    track: Track
    proved_modes: NDArray[np.int64]
    family: ArmFamily
    hulls: PathHulls
    arm_count: int
    further_modes: int

    def proved_points(self, modes: int) -> int:
        """Number of points at which at least `modes` leading modes are proved complete."""
        return int((self.proved_modes >= modes).sum())


def follow_interval(
    path: Path,
    p: Array,
    request: SpectrumRequest,
    before: ArmInterval | None = None,
    counts_follow: bool = False,
) -> ArmInterval | None:
    """The first points of p, (n,), that are reached with one family of arms; None if the first point fails,
    if no family is found, or if n is below `ARM_FOLLOWING_SETTINGS.min_points`.

    If not all growing modes can be proved complete, more eigenvalues are followed; also if too few points are
    proved complete, unless counts follow at these points. before: the previous interval of the path, whose
    family is used again if it contains enough of the points p.
    """
    best: ArmInterval | None = None
    for further in (
        number
        for number in ARM_FOLLOWING_SETTINGS.further_modes
        if before is None or number >= before.further_modes
    ):
        if best is not None and not (
            _follows_too_few_modes(best)
            or (not counts_follow and _more_modes_prove_middle(path, best, request, further))
        ):
            break
        found = (
            _follow_with_further_modes(path, p, request, further, before)
            if len(p) >= ARM_FOLLOWING_SETTINGS.min_points
            else None
        )
        if found is not None and (best is None or _is_better_interval(found, best, request.modes)):
            best = found
        enough = best is not None and best.proved_points(
            request.modes
        ) >= ARM_FOLLOWING_SETTINGS.min_proved_fraction * len(best.p)
        if best is not None and enough and not _follows_too_few_modes(best):
            break
    return best


def _follows_too_few_modes(found: ArmInterval) -> bool:
    """Whether too few modes are followed to prove all growing modes complete at every point."""
    growing = (found.track.w.real > 0).sum(axis=1).max()
    return bool(growing + ARM_FOLLOWING_SETTINGS.modes_beyond_growing > found.track.w.shape[1])


def _is_better_interval(found: ArmInterval, other: ArmInterval, modes: int) -> bool:
    """Whether `found` has more proved points than `other`, or equally many while `other` follows too few
    modes.
    """
    here = found.proved_points(modes)
    there = other.proved_points(modes)
    return here > there or (here == there and _follows_too_few_modes(other))


def _more_modes_prove_middle(path: Path, found: ArmInterval, request: SpectrumRequest, further: int) -> bool:
    """Whether following `further` additional modes would prove completeness at the middle point among the
    points without a proof."""
    left = np.flatnonzero(found.proved_modes < request.modes)
    return _more_modes_prove_point(path, found, float(found.p[left[len(left) // 2]]), request, further)


def _more_modes_prove_point(
    path: Path, found: ArmInterval, p: float, request: SpectrumRequest, further: int
) -> bool:
    """Whether the wanted modes at path variable p, inside the interval `found`, would be proved complete if
    `further` modes were followed in addition."""
    roots = _leading_roots(path, p, request, further)
    if roots is None or len(roots.w) < request.modes:
        return False
    arm = arm_determinant(path.rod_at(p))
    line = line_for_proof(complex(roots.w[request.modes - 1]), float(roots.error[request.modes - 1]))
    try:
        return prove_complete(line, roots.w, roots.error, arm, hull_at(found.hulls, p))[0]
    except FloatingPointError:
        return False


def _follow_with_further_modes(
    path: Path, p: Array, request: SpectrumRequest, further: int, before: ArmInterval | None
) -> ArmInterval | None:
    """The first points of p, (n,), that are reached as in `follow_interval`, with exactly `further` modes
    followed in addition to the wanted modes; None if the first point fails or no family is found."""
    first = _eigenvalues_of_previous_interval(before, float(p[0]), request, further)
    if first is None:
        first = first_eigenvalues(path, float(p[0]), request, further)
    n = len(p)
    made = None
    if first is not None and before is not None:
        inside = int(((p >= before.family.p_low) & (p <= before.family.p_high)).sum())
        if (
            inside >= ARM_FOLLOWING_SETTINGS.min_points
            and ARM_FOLLOWING_SETTINGS.min_reused_W_factor * np.abs(first).max() <= before.family.largest_w
        ):
            made = (before.family, before.hulls)
            n = inside
        else:
            n = min(
                n,
                max(
                    ARM_FOLLOWING_SETTINGS.max_points_growth * len(before.p),
                    ARM_FOLLOWING_SETTINGS.min_points,
                ),
            )
    while first is not None and made is None and n >= ARM_FOLLOWING_SETTINGS.min_points:
        made = family_and_hulls(path, p[:n], first, request.modes)
        # On half the interval the propagators need a lower degree.
        n = n if made is not None else n // 2
    if first is None or made is None:
        return None
    family, hulls = made
    track = start_track(first, n)
    known = np.zeros(n, np.int64)
    reached = follow_eigenvalues_of_arms(track, family, hulls, p[:n], request.modes, known)
    if reached == 0:
        return None
    arms = before.arm_count if before is not None and family is before.family else n
    return ArmInterval(
        p[:reached], slice_track(track, 0, reached), known[:reached], family, hulls, arms, further
    )


def family_and_hulls(path: Path, p: Array, first: Complex, modes: int) -> tuple[ArmFamily, PathHulls] | None:
    """(family of the arms at all p, (n,); hulls that contain the spectra of these arms); None if all p are
    equal, if the arms are not smooth in p, or if no elements resolve an arm.

    first: eigenvalues at the first point, (m,), in descending order. modes: number of requested modes.
    """
    low = float(p.min())
    high = float(p.max())
    if not low < high:
        return None
    try:
        if not has_smooth_coefficients(path, low, high):
            return None
        places = np.linspace(low, high, ARM_FOLLOWING_SETTINGS.hulls_per_interval)
        hulls = hulls_along([path.rod_at(x) for x in places.tolist()], places)
        W = ARM_FOLLOWING_SETTINGS.W_reserve_factor * float(np.abs(first).max())
        line = min(ARM_FOLLOWING_SETTINGS.W_reserve_factor * float(first[modes - 1].real), 0.0)
        hull = max(zip(hulls.a.tolist(), hulls.c.tolist(), strict=True))
        ends = [
            points[-1]
            for k in COMPLETENESS_SETTINGS.point_counts
            if len(points := points_right_of_hull(line, *hull, k))
        ]
        near = [end for end in ends if end <= ARM_FOLLOWING_SETTINGS.W_reserve_factor * W]
        family = interpolated_family(path, low, high, max([W, *near]))
    except (ValueError, FloatingPointError):
        return None
    return None if family is None else (family, hulls)


def _eigenvalues_of_previous_interval(
    before: ArmInterval | None, p: float, request: SpectrumRequest, further: int
) -> Complex | None:
    """Eigenvalues, (m,), at p, from the previous interval `before`; None unless p is the last point of this
    interval, `further` modes were followed there, and all its points are proved complete.
    """
    if before is None or before.further_modes != further or before.p[-1] != p:
        return None
    if before.proved_points(request.modes) < len(before.p):
        return None
    return before.track.w[-1][before.track.descending_order[-1]]


def first_eigenvalues(path: Path, p: float, request: SpectrumRequest, further: int) -> Complex | None:
    """Eigenvalues at p from which following starts, (m,), without unpaired complex eigenvalues; None if the
    solve fails.
    """
    found = _leading_roots(path, p, request, further)
    return None if found is None else found.w[has_conjugate(found.w)]


def _leading_roots(path: Path, p: float, request: SpectrumRequest, further: int) -> Roots | None:
    """The leading eigenvalues at path variable p, without a proof: the wanted modes and `further` more modes;
    None if the solve fails.
    """
    try:
        modes = request.modes + further
        search = SpectrumSearch(path.rod_at(p), replace(request, modes=modes, certify=False), requested=modes)
        with np.errstate(all="ignore"):
            search.outcome()
    except FAILURES:
        destroy_pooled_solvers()
        return None
    return None if search.best is None else search.best.candidates.roots
