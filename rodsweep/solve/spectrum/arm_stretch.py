"""Spectra of arms at neighbouring points along one parameter: followed, and proved complete one by one.

Krylov-Schur solves the first point for more modes than wanted: the known ones beyond the line make the proof
easy. The propagators of all arms come from a few (`rodsweep.determinant.arm.family`), on as much of the
interval as they are smooth polynomials on.
"""

from dataclasses import replace

import numpy as np

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
from .spectrum import Reached, SpectrumRequest

FURTHER_MODES = 3
"""Modes that are followed beyond those wanted, at least."""
HEADROOM = 2.0
"""Largest |w| for which propagators are made, in units of the largest at the first point."""
FEWEST = 4
"""Fewest points for which a family of arms is made."""
HULL_ARMS = 7
"""Arms of an interval from which the hull of all is made."""


def followed_arms(path: Path, p: Array, request: SpectrumRequest) -> Reached | None:
    """The points p, (n,), as far as eigenvalues can be followed from the first; None where none can be."""
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
) -> Reached | None:
    """The points of an interval that has a family."""
    shape = (len(p), len(first))
    order = np.zeros(shape, np.int64)
    order[0] = np.arange(len(first))
    track = Track(np.empty(shape, complex), np.empty(shape, complex), np.empty(shape), order)
    track.w[0] = first
    known = np.zeros(len(p), np.int64)
    n = follow_arms(track, family, hull, p, request.modes, known)
    if n == 0:
        return None
    reached = part(track, 0, n)
    good, unstable = judge_points(reached, known[:n], request.modes, request.accuracy)
    return Reached(*leading(reached, request.modes), unstable, good)


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
