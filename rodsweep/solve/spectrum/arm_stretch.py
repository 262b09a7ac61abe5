"""Spectra of arms at neighbouring points along one parameter: followed, and proved complete one by one.

Krylov-Schur solves the first point for more modes than wanted: the known ones beyond the line make the proof
easy. The propagators of all arms come from a few (`rodsweep.determinant.arm.family`), on as much of the
interval as they are smooth polynomials on.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...determinant.arm.completeness import POWERS, right_of_hull
from ...determinant.arm.family import Family, family_of
from ...determinant.arm.hull import Hull, hull_of
from ...determinant.parameter_path import Path
from ..point import FAILURES
from .arm_following import follow_arms
from .carried_count import judge_points, leading
from .prediction import Track, part
from .problem import forget_solvers
from .search import Search
from .spectrum import Reached, Spectrum, SpectrumRequest
from .status import SpectrumStatus

FURTHER_MODES = 3
"""Modes that are followed beyond those wanted, at least."""
HEADROOM = 2.0
"""Largest |w| for which propagators are made, in units of the largest at the first point."""
FEWEST = 4
"""Fewest points for which a family of arms is made."""
ACCURACY = 1e-8
"""Relative accuracy of eigenvalues along a path."""
STEPS_FROM_NEAREST = (1, 4)
"""Numbers of steps in which a point is reached from the nearest one of a path."""
HULL_ARMS = 7
"""Arms of an interval from which the hull of all is made."""


class Interval(NamedTuple):
    """Points of a path, (n,), that were followed with one family of arms: track and `known` of `follow_arms`."""

    p: Array
    track: Track
    known: NDArray[np.int64]
    family: Family
    hull: Hull


def followed_arms(path: Path, p: Array, request: SpectrumRequest) -> Reached | None:
    """The points p, (n,), as far as eigenvalues can be followed from the first; None where none can be."""
    found = _interval(path, p, request)
    if found is None:
        return None
    good, unstable = judge_points(found.track, found.known, request.modes, request.accuracy)
    return Reached(*leading(found.track, request.modes), unstable, good)


def _interval(path: Path, p: Array, request: SpectrumRequest) -> Interval | None:
    """The points p, (n,), as far as one family of arms and following reach; None if not beyond the first."""
    n = len(p)
    first = first_eigenvalues(path, float(p[0]), request) if n >= FEWEST else None
    while first is not None and n >= FEWEST:
        made = arms_between(path, p[:n], first, request.modes)
        if made is not None:
            return _followed(first, *made, p[:n], request)
        n //= 2
    return None


def _followed(
    first: Complex, family: Family, hull: Hull, p: Array, request: SpectrumRequest
) -> Interval | None:
    """The points of an interval that has a family."""
    track, known = _empty_track(first, len(p)), np.zeros(len(p), np.int64)
    n = follow_arms(track, family, hull, p, request.modes, known)
    return Interval(p[:n], part(track, 0, n), known[:n], family, hull) if n else None


def _empty_track(first: Complex, points: int) -> Track:
    """A track with the eigenvalues of its first point, (m,), the leading ones first."""
    shape = (points, len(first))
    order = np.zeros(shape, np.int64)
    order[0] = np.arange(len(first))
    track = Track(np.empty(shape, complex), np.empty(shape, complex), np.empty(shape), order)
    track.w[0] = first
    return track


def arms_between(path: Path, p: Array, first: Complex, modes: int) -> tuple[Family, Hull] | None:
    """The family of the arms at points p, (n,), in order, and their hull; None where there is no family.

    first: eigenvalues at the first point, (m,), leading ones first.
    """
    low, high = float(p.min()), float(p.max())
    if not low < high:
        return None
    try:
        hull = hull_of(*(path.at(x) for x in np.linspace(low, high, HULL_ARMS).tolist()))
        W = HEADROOM * float(np.abs(first).max())
        line = min(HEADROOM * float(first[modes - 1].real), 0.0)
        ends = [points[-1] for k in POWERS if len(points := right_of_hull(line, hull.a, hull.c, k))]
        near = [end for end in ends if end <= HEADROOM * W]
        family = family_of(path, low, high, max([W, *near]))
    except (ValueError, FloatingPointError):
        return None
    return None if family is None else (family, hull)


def first_eigenvalues(path: Path, p: float, request: SpectrumRequest) -> Complex | None:
    """Eigenvalues to follow from p on, (m,), pairs whole; None where they cannot be had."""
    try:
        modes = request.modes + FURTHER_MODES
        search = Search(path.at(p), replace(request, modes=modes, certify=False), wanted=modes)
        with np.errstate(all="ignore"):
            search.outcome()
    except FAILURES:
        forget_solvers()
        return None
    if search.best is None:
        return None
    w = search.best.found.roots.w
    return w[np.array([value.imag == 0 or value.conjugate() in w for value in w], dtype=bool)]


class FollowedArms:
    """Leading eigenvalues along a path, followed once from point to point, and from these to any other.

    Where following ends at a point it starts anew from there.
    """

    def __init__(self, path: Path, p: Array, modes: int):
        """p: points in order, (n,); modes: leading eigenvalues that are to be proved complete at each."""
        self.request = SpectrumRequest(modes, ACCURACY, certify=True)
        self.intervals: list[Interval] = []
        place, patience = 0, 1
        while place < len(p):
            found = _interval(path, p[place:], self.request)
            if found is not None:
                self.intervals.append(found)
            place += max(len(found.p) - 1, 1) if found is not None else patience
            patience = 1 if found is not None else 2 * patience

    def family(self, p: float) -> Family | None:
        """The family of arms that contains p."""
        return next((one.family for one in self.intervals if one.family.low <= p <= one.family.high), None)

    def spectrum(self, p: float, modes: int) -> Spectrum | None:
        """The leading eigenvalues at p; None where they are not followed, accurate and proved complete."""
        for one in self.intervals:
            if one.p.min() <= p <= one.p.max():
                found = _from_nearest(one, p, min(modes, one.track.w.shape[1]), self.request.accuracy)
                if found is not None:
                    return found
        return None


def _from_nearest(one: Interval, p: float, modes: int, accuracy: float) -> Spectrum | None:
    """The leading eigenvalues at p, followed from the nearest point of an interval."""
    i = int(np.argmin(np.abs(one.p - p)))
    start = float(one.p[i])
    for steps in STEPS_FROM_NEAREST:
        grid = np.array([start]) if p == start else start + (p - start) * np.arange(steps + 1) / steps
        track, known = _empty_track(one.track.w[i], len(grid)), np.zeros(len(grid), np.int64)
        track.order[0] = one.track.order[i]
        if follow_arms(track, one.family, one.hull, grid, modes, known) == len(grid):
            good, unstable = judge_points(part(track, len(grid) - 1, len(grid)), known[-1:], modes, accuracy)
            if good[0]:
                w, error = leading(part(track, len(grid) - 1, len(grid)), modes)
                return Spectrum(
                    status=SpectrumStatus.ok,
                    eigenvalues=w[0],
                    error_estimate=error[0],
                    unstable_count=int(unstable[0]),
                    certified=True,
                )
    return None
