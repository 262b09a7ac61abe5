"""Counts of eigenvalues right of a line: at one arm of an interval, and carried along its arms.

A count at one arm confirms that all eigenvalues right of a line are followed eigenvalues. This remains true
at further arms as long as no eigenvalue but the followed ones lies on the line
(`rodsweep.determinant.arm.count.no_crossing`). A second count, at the last arm, must confirm the result.
"""

import math
from itertools import pairwise

import numpy as np

from ....arrays import Array, Complex, list_of
from ....determinant.arm.arm_family_values import W_and_propagators_at
from ....determinant.arm.count.count import count_right_of
from ....determinant.arm.count.no_crossing import proves_no_crossing_of_arms, sampled_point_indices
from ....determinant.arm.count.settings import NO_CROSSING_SETTINGS
from ....determinant.arm.determinant import ArmDeterminant
from ....determinant.arm.hull.region import hull_at
from ....determinant.parameter_path import ParameterPath
from ..candidates import lines_for_count
from .arm_interval import ArmInterval
from .carried_count import leading_eigenvalues_of_track
from .eigenvalue_prediction import FollowedEigenvalues


def confirmed_mode_count_at(
    path: ParameterPath, interval: ArmInterval, p: float, mode_count: int, point_track: FollowedEigenvalues
) -> int:
    """Number of eigenvalues at path variable p that a winding number confirms to be all eigenvalues to the
    right of a vertical line; 0 if no winding number confirms this. interval: an interval that contains p.
    mode_count: number of requested modes, which lie to the right of the line. point_track: eigenvalues at p,
    as a track with a single point."""
    w, error = leading_eigenvalues_of_track(point_track, point_track.w.shape[1])
    line = confirmed_line(path, interval, p, (w[0], error[0]), mode_count)
    return 0 if line is None else int((w[0].real > line).sum())


def confirmed_line(
    path: ParameterPath,
    interval: ArmInterval,
    p: float,
    eigenvalues_and_errors: tuple[Complex, Array],
    mode_count: int,
    rightmost: float = math.inf,
) -> float | None:
    """Real part, at most `rightmost`, of a vertical line for which a count by winding number at path variable
    p confirms that all eigenvalues to its right are followed; None if no count confirms this for any line.

    interval: an interval that contains p. eigenvalues_and_errors: eigenvalues at p by descending real part,
    and their errors, (m,) each. mode_count: number of requested modes, which lie to the right of the line.
    """
    w, error = eigenvalues_and_errors
    if w[-1].real > 0:  # more modes grow, and the count would include them
        return None
    determinant = ArmDeterminant(path.rod_at(p), W_and_propagators_at(interval.arm_family, p))
    hull = hull_at(interval.hulls, p)
    lines = [line for line in lines_for_count(list_of(w), mode_count) if line <= rightmost]
    for line in [*lines, rightmost] if rightmost < math.inf else lines:
        number = count_right_of(line, determinant, hull, w, error).number
        if number is not None:
            are_clear = (np.abs(w.real - line) > 2 * error).all()
            return line if are_clear and number == (w.real > line).sum() else None
    return None


class ArmCountCarrier:
    """Carries counts of the eigenvalues right of a line along the arms of an interval, to fill
    `proved_counts` at points without a proof. modes: number of requested modes. w, error: followed
    eigenvalues by descending real part, and their errors, (points, m). lines: real part, at each point, of
    the rightmost line to the left of all requested eigenvalues and of the imaginary axis, (points,)."""

    def __init__(self, path: ParameterPath, interval: ArmInterval, mode_count: int):
        self.path = path
        self.interval = interval
        self.modes = mode_count
        self.w, self.error = leading_eigenvalues_of_track(interval.track, interval.track.w.shape[1])
        last = self.w[:, mode_count - 1]
        # Left of the axis, so that the count also gives the number of unstable modes.
        self.lines = np.minimum(last.real, 0.0) - NO_CROSSING_SETTINGS.line_distance_over_last_w * np.abs(
            last
        )

    def carry_counts(self) -> None:
        """Fills `interval.proved_counts` wherever a count can be carried."""
        # Where even the last followed eigenvalue grows, not all growing eigenvalues are followed.
        unproved = np.flatnonzero((self.interval.proved_counts < self.modes) & (self.w[:, -1].real <= 0))
        for run in np.split(unproved, np.flatnonzero(np.diff(unproved) > 1) + 1):
            first = int(run[0]) if len(run) else 0
            end = first + len(run)
            skipped_count = 1
            while end - first >= NO_CROSSING_SETTINGS.arm_count:
                points, lines = self._carried_points_and_lines(first, end - 1)
                if not lines:
                    # Further points often fail, too, so every further failure skips twice as many points.
                    first += skipped_count
                    skipped_count *= 2
                    continue
                # A second count at the far end is needed, since the carrying rests on sampled arms.
                if self._confirmed_line_at_or_left_of(points[-1], lines[-1]) is not None:
                    self._store_proved_counts_between(points, lines)
                first = points[-1] + 1
                skipped_count = 1

    def _carried_points_and_lines(self, index: int, last_index: int) -> tuple[list[int], list[float]]:
        """Returns (points, lines). points: indices of the points, from `index` to at most `last_index`, from
        each of which the count is carried to the next. lines: real parts; on the way from points[k] to
        points[k + 1], only followed eigenvalues cross the vertical line at Re w = lines[k]. `lines` is empty
        if the count cannot be carried from `index`."""
        min_stride = NO_CROSSING_SETTINGS.arm_count - 1
        points = [index]
        lines: list[float] = []
        confirmed_line = None
        stride = last_index - index
        while last_index - index >= min_stride:
            next_index = min(index + stride, last_index)
            # A rest too short for a stride of its own is added to this one.
            if last_index - next_index < min_stride:
                next_index = last_index
            # One fixed line for the stride, left of the requested modes at all of its points.
            line = float(self.lines[index : next_index + 1].min())
            # A count right of one line says nothing about a line farther left.
            if confirmed_line is None or confirmed_line > line:
                confirmed_line = self._confirmed_line_at_or_left_of(index, line)
                if confirmed_line is None:
                    break
            if self._is_line_free_of_unknown_eigenvalues(line, index, next_index):
                points.append(next_index)
                lines.append(line)
                confirmed_line = line
                index = next_index
                stride *= 2
            elif next_index - index < 2 * min_stride:
                break
            else:
                stride = (next_index - index) // 2
        return points, lines

    def _confirmed_line_at_or_left_of(self, i: int, line: float) -> float | None:
        """Result of `confirmed_line` at the point with index i, with `rightmost` = `line`."""
        p = float(self.interval.p[i])
        return confirmed_line(self.path, self.interval, p, (self.w[i], self.error[i]), self.modes, line)

    def _is_line_free_of_unknown_eigenvalues(self, line: float, first: int, last: int) -> bool:
        """Whether it is proved that only followed eigenvalues lie on the vertical line at Re w = `line`, for
        all arms between the points with the indices `first` and `last`."""
        interval = self.interval
        points = sampled_point_indices(first, last)
        known_w = interval.track.w[points], interval.track.error[points]
        p = interval.p[points]
        rods = [self.path.rod_at(value) for value in list_of(p)]
        return proves_no_crossing_of_arms(line, rods, p, known_w, interval.arm_family, interval.hulls)

    def _store_proved_counts_between(self, points: list[int], lines: list[float]) -> None:
        """Fills `interval.proved_counts` from points[k] to points[k + 1] by counts to the right of Re w =
        lines[k]; a point with a followed eigenvalue within twice its error of this line keeps its count."""
        for (first, last), line in zip(pairwise(points), lines, strict=True):
            part = slice(first, last + 1)
            w = self.w[part]
            is_clear = (np.abs(w.real - line) > 2 * self.error[part]).all(axis=1)
            counts = np.where(is_clear, (w.real > line).sum(axis=1), self.interval.proved_counts[part])
            self.interval.proved_counts[part] = counts
