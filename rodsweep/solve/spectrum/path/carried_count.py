"""A count of eigenvalues carried along a path, as long as a proof with a moving vertical line succeeds.

At the first point it is proved that some number of leading followed eigenvalues are all eigenvalues to the
right of a line. A line in a gap between followed eigenvalues is moved, with the gap, to another point. If no
eigenvalue crosses the moving line (`rodsweep.determinant.moving_line`), the number of eigenvalues to the
right of the line is the same at every point between.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array, Complex
from ....determinant.moving_line import RodAndLineAtEnd, no_crossing_proof_and_count
from ....determinant.roots.settings import ROOT_SETTINGS
from ....model.compiled.compilation import compiled
from ....model.compiled.kernel_constants import KernelConstants
from ....model.rod import Coefficients
from .eigenvalue_prediction import FollowedEigenvalues


@dataclass(frozen=True, slots=True, kw_only=True)
class CarriedCountSettings(KernelConstants):
    """Settings for a number of eigenvalues right of a vertical line that is carried from rod to rod along a
    path: the number of rectangles of one proof, and the gaps between real parts of eigenvalues in which the
    line may lie."""

    rectangle_allowance_per_proof: int = 60
    """One proof covers a strip of (Im w, p) by at most this number of rectangles (`moving_line`), plus
    `rectangles_per_point` times the number of points covered."""
    rectangles_per_point: int = 20
    """Number of rectangles of a proof (`moving_line`) allowed for each point covered: a new count costs as
    much as twenty rectangles."""
    min_wide_relative_half_gap: float = 0.2
    """Gaps between real parts of eigenvalues are treated as equally wide if their relative half-width exceeds
    this; the leftmost of these gaps is taken. Relative half-width: half-width divided by the distance of the
    gap's middle from the imaginary axis."""
    min_relative_half_gap: float = 1e-6
    """No vertical line is placed in a gap between real parts of eigenvalues whose relative half-width (see
    `min_wide_relative_half_gap`) is less than this."""


CARRIED_COUNT_SETTINGS = CarriedCountSettings()


@compiled
def line_and_relative_half_gap(track: FollowedEigenvalues, i: int, gap: int) -> tuple[float, float]:
    """(real part of the vertical line in the middle of a gap between real parts of eigenvalues at point i,
    half-width of the gap divided by the modulus of this real part). The half-width is at most
    `min_wide_relative_half_gap`, and 0 if the line is not to the left of the imaginary axis. gap: number of
    eigenvalues to the right of the gap."""
    right = track.w[i, track.descending_order[i, gap - 1]].real
    left = track.w[i, track.descending_order[i, gap]].real
    line = (right + left) / 2
    if not line < 0:
        return line, 0.0
    return line, min((right - line) / -line, CARRIED_COUNT_SETTINGS.min_wide_relative_half_gap)


@compiled
def count_right_of_widest_gap(track: FollowedEigenvalues, i: int, modes: int) -> int:
    """Number of eigenvalues to the right of the widest gap between real parts of eigenvalues at point i; 0 if
    no gap is wide enough. The gap lies to the left of the `modes` leading eigenvalues and of the imaginary
    axis."""
    best_gap = 0
    max_width = CARRIED_COUNT_SETTINGS.min_relative_half_gap
    for gap in range(modes, track.w.shape[1]):
        width = line_and_relative_half_gap(track, i, gap)[1]
        if width >= max_width:
            best_gap = gap
            max_width = width
    return best_gap


@compiled
def _does_gap_stay_open(
    track: FollowedEigenvalues, ends: tuple[int, int], gap: int, lines: tuple[float, float], p: Array
) -> bool:
    """Whether exactly the leading `gap` eigenvalues lie to the right of a moving line at every point between
    two points. ends: indices of the two points. lines: real parts of the line at the two points. p: path
    variables, (points,). The distance of each eigenvalue from the line must exceed twice the eigenvalue's
    error."""
    i, j = ends
    for s in range(i, j + 1):
        fraction = (p[s] - p[i]) / (p[j] - p[i])
        line = (1 - fraction) * lines[0] + fraction * lines[1]
        for rank in range(track.w.shape[1]):
            k = track.descending_order[s, rank]
            distance = track.w[s, k].real - line
            if not (distance if rank < gap else -distance) > 2 * track.error[s, k]:
                return False
    return True


@compiled
def _count_right_of_widest_open_gap(
    track: FollowedEigenvalues, ends: tuple[int, int], modes: int, proved_count: int, p: Array
) -> int:
    """Number of eigenvalues to the right of the widest gap between real parts that stays open between the
    points `ends`, that is, that no followed eigenvalue enters; 0 if no gap stays open. The number is at least
    `modes` and at most `proved_count`."""
    best_gap = 0
    max_width = CARRIED_COUNT_SETTINGS.min_relative_half_gap
    for gap in range(modes, min(proved_count, track.w.shape[1] - 1) + 1):
        start_line, start_width = line_and_relative_half_gap(track, ends[0], gap)
        end_line, end_width = line_and_relative_half_gap(track, ends[1], gap)
        if min(start_width, end_width) >= max_width and _does_gap_stay_open(
            track, ends, gap, (start_line, end_line), p
        ):
            best_gap = gap
            max_width = min(start_width, end_width)
    return best_gap


@compiled
def _interval_end_with_line_in_gap(
    track: FollowedEigenvalues, i: int, gap: int, p: Array, coefficients: Array
) -> RodAndLineAtEnd:
    """Rod and line at the end, at point i of a path, of an interval over which a vertical line moves. At
    point i the line lies in the middle of a gap between real parts of eigenvalues. gap: number of eigenvalues
    to the right of the gap. p: path variables, (points,). coefficients: (F, nu, c2, gamma3) at each point,
    (points, 4)."""
    F, nu, c2, gamma3 = coefficients[i]
    return RodAndLineAtEnd(
        p[i], Coefficients(F, nu, c2, gamma3), line_and_relative_half_gap(track, i, gap)[0]
    )


@compiled
def last_point_with_carried_count(
    track: FollowedEigenvalues,
    coefficients: Array,
    p: Array,
    direction: Coefficients,
    modes: int,
    proved_counts: NDArray,
) -> int:
    """Index of the last point to which the count at the first point can be carried.

    coefficients: (F, nu, c2, gamma3) at each point, (points, 4). p: path variables, (points,). direction:
    d(F, nu, c2, gamma3)/dp. modes: number of requested modes, to the left of which every vertical line lies.
    proved_counts: number of leading eigenvalues that are all eigenvalues to the right of a line, (points,);
    given at the first point, filled up to the last point reached.
    """
    i = 0
    last = len(p) - 1
    stride = last
    while i < last:
        j = min(i + stride, last)
        gap = _count_right_of_widest_open_gap(track, (i, j), modes, proved_counts[i], p)
        proved = False
        if gap > 0:
            first = _interval_end_with_line_in_gap(track, i, gap, p, coefficients)
            end = _interval_end_with_line_in_gap(track, j, gap, p, coefficients)
            most = (
                CARRIED_COUNT_SETTINGS.rectangle_allowance_per_proof
                + CARRIED_COUNT_SETTINGS.rectangles_per_point * (j - i)
            )
            proved, _ = no_crossing_proof_and_count(first, end, direction, most)
        if proved:
            # The number of eigenvalues to the right of this gap is proved, even if the proved number was
            # larger before.
            proved_counts[i + 1 : j + 1] = gap
            i = j
            # After a successful proof, a proof over twice as many points often succeeds.
            stride = 2 * stride
        elif j == i + 1:
            return i
        else:
            stride = (j - i) // 2
    return last


@compiled
def certified_points_and_unstable_counts(
    track: FollowedEigenvalues, proved_counts: NDArray, modes: int, accuracy: float
) -> tuple[NDArray, NDArray]:
    """Returns (is_good, unstable_counts), (points,) each. is_good: whether the point is certified and its
    leading `modes` eigenvalues have the relative accuracy `accuracy`. unstable_counts: number of unstable
    modes.

    proved_counts: number of leading eigenvalues proved complete at each point, (points,). A point is not good
    if an eigenvalue may lie on the imaginary axis, or if a nearly double eigenvalue has lost digits.
    """
    n = len(proved_counts)
    is_good = np.empty(n, np.bool_)
    unstable_counts = np.zeros(n, np.int64)
    for s in range(n):
        is_good[s] = proved_counts[s] >= modes
        for rank in range(proved_counts[s]):
            k = track.descending_order[s, rank]
            w = track.w[s, k]
            error = track.error[s, k]
            if abs(w.real) <= max(
                ROOT_SETTINGS.imaginary_axis_tolerance_in_errors * error,
                ROOT_SETTINGS.imaginary_axis_tolerance * abs(w),
            ):
                is_good[s] = False
            if rank < modes and not error <= min(
                ROOT_SETTINGS.min_double_root_correction_over_w, accuracy / 2
            ) * abs(w):
                is_good[s] = False
            unstable_counts[s] += w.real > 0
    return is_good, unstable_counts


@compiled
def leading_eigenvalues_of_track(track: FollowedEigenvalues, modes: int) -> tuple[Complex, Array]:
    """The leading `modes` eigenvalues and their errors at every point of a track, (points, modes) each."""
    n = track.w.shape[0]
    w = np.empty((n, modes), np.complex128)
    error = np.empty((n, modes))
    for s in range(n):
        for rank in range(modes):
            k = track.descending_order[s, rank]
            w[s, rank] = track.w[s, k]
            error[s, rank] = track.error[s, k]
    return w, error
