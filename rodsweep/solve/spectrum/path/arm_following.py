"""Eigenvalues of arms followed along a path, and proved complete at every point.

As `rodsweep.solve.spectrum.path.following`, with D from the interpolated propagators of a family. The proof
is that of `rodsweep.determinant.arm.completeness` and needs nothing but the eigenvalues of the point itself.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array, Complex
from ....determinant.arm.completeness import (
    COMPLETENESS,
    proves_completeness,
    remainder_of_sum,
    right_of_hull,
)
from ....determinant.arm.family import ARM_FAMILY, ArmFamily, propagators_at
from ....determinant.arm.hull.region import Hull, PathHulls, hull_at
from ....determinant.arm.value import ARM_VALUE, chain_along, chain_value
from ....determinant.roots.roots import roots_of_parabola, sort_descending
from ....determinant.value import DETERMINANT, second_difference
from ....model.compiled.compilation import compiled
from ..candidates import CANDIDATES
from .following import (
    FOLLOWING,
    CorrectedEigenvalue,
    crowding_of,
    distinct_roots,
    newton_step,
    settled_error,
    store_root,
)
from .prediction import Track, guess_at, guess_two, mates_of

Level = tuple[float, Array, Array]
"""(W, propagators, derivatives of the propagators by p), arrays of shape (elements, terms, PADDED)."""


@compiled
def corrected_of_arm(w: complex, level: Level) -> CorrectedEigenvalue:
    """The eigenvalue of an arm after one Newton step from w; a real eigenvalue stays real."""
    D, D_w, D_p, _, noise = chain_along(w, level[0], level[1], level[2])
    return newton_step(w, D, D_w, D_p, ARM_VALUE.root_noise * noise)


@compiled
def _settled(
    first: CorrectedEigenvalue, crowding: float, exact: bool, level: Level
) -> tuple[CorrectedEigenvalue, float]:
    """(last Newton step, error) of an arm's eigenvalue: steps until `settled_error` is finite; inf without
    convergence.

    first: result of the first step. crowding, exact: as in `settled_error`. level: (W, propagators) of the
    arm.
    """
    here = first
    for _ in range(FOLLOWING.max_corrections):
        error = settled_error(here, crowding, exact)
        if error < math.inf:
            return here, error
        here = corrected_of_arm(here.w, level)
    return here, math.inf


@compiled
def two_roots_of_arm(middle: complex, level: Level) -> tuple[complex, complex]:
    """The two roots near a real `middle`, from the quadratic Taylor polynomial of D."""
    D, D_w, S, _ = chain_value(middle, level[0], level[1])
    h = DETERMINANT.second_step * abs(middle)
    after = chain_value(middle + h, level[0], level[1])
    before = chain_value(middle - h, level[0], level[1])
    second = second_difference(after, before, S, h)
    return roots_of_parabola(middle, complex(D.real, 0.0), complex(D_w.real, 0.0), complex(second.real, 0.0))


@compiled
def _correct_all(track: Track, i: int, p: float, guess: Complex, modes: int, level: Level) -> bool:
    """Corrects the guesses for all eigenvalues of point i, at p, and writes the roots to the track.

    True if all converged and every pair stayed a pair.
    """
    w = track.w[i]
    error = track.error[i]
    order = track.order[i]
    m = len(w)
    mate = np.empty(m, np.int64)
    mates_of(guess, mate)
    w[:] = guess
    sort_descending(w, order)
    for rank in range(m):
        k = order[rank]
        if guess[k].imag != 0 and mate[k] < 0:
            return False
        if guess[k].imag >= 0:
            first = corrected_of_arm(guess[k], level)
            w[k] = first.w
            if mate[k] >= 0:
                w[mate[k]] = w[k].conjugate()
            last, error[k] = _settled(first, crowding_of(w, k), rank <= modes, level)
            # Interpolation changes D as relative changes of w and p by `ARM_FAMILY.converged` would.
            error[k] += ARM_FAMILY.converged * (abs(last.w) + abs(p * last.slope))
            if not store_root(track, i, k, mate[k], last):
                return False
    sort_descending(w, order)
    return distinct_roots(w, error) and np.abs(w).max() <= level[0]


@compiled
def all_right_of_line(track: Track, i: int, modes: int, hull: Hull, level: Level) -> int:
    """Number of leading eigenvalues of point i that are proved to be all eigenvalues right of a line <= 0; 0
    without a proof.

    The line lies left of the wanted `modes`, so that the proof includes all unstable eigenvalues.
    """
    w = track.w[i]
    error = track.error[i]
    k = track.order[i, modes - 1]
    line = min(w[k].real - CANDIDATES.below * error[k] - CANDIDATES.close_below * abs(w[k]), 0.0)
    here = 0
    for j in range(len(w)):
        if abs(w[j].real - line) <= 2 * error[j]:
            return 0
        here += w[j].real > line
    for power in COMPLETENESS.powers:
        points = right_of_hull(line, hull.a, hull.c, power)
        if len(points) == 0 or points[-1] > level[0]:
            continue
        if proves_completeness(remainder_of_sum(line, w, error, hull, points, (level[0], level[1]))):
            return here
    return 0


@compiled
def follow_arms(
    track: Track, family: ArmFamily, hulls: PathHulls, p: Array, modes: int, known: NDArray
) -> int:
    """Follows eigenvalues from the first point on and fills the track; returns the number of points reached.

    track: w and order of the first point are set; p: (points,), path variable of each point, inside the
    family. hulls: regions of all arms of the family. known: (points,), filled with `all_right_of_line`.
    """
    shape = family.coefficients.shape[1:]
    polynomials = np.empty(shape)
    changes = np.empty(shape)
    level = (family.W, polynomials, changes)
    guess = track.w[0].copy()
    decided = np.empty(len(guess), np.int64)
    for i in range(len(p)):
        propagators_at(family, p[i], polynomials, changes)
        if i > 0:
            guess_at(track, i, p, guess, decided)
            for k in range(len(guess)):
                if decided[k] >= 0:
                    two = (k, decided[k])
                    guess_two(track.w[i - 1], two, two_roots_of_arm(guess[k], level), guess)
            track.order[i] = track.order[i - 1]
        if not _correct_all(track, i, p[i], guess, modes, level):
            return i
        known[i] = all_right_of_line(track, i, modes, hull_at(hulls, p[i]), level)
    return len(p)
