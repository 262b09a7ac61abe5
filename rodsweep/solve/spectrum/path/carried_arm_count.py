"""Counts of eigenvalues right of a line, carried along the arms of an interval.

A count at one arm confirms that all eigenvalues right of a line are followed eigenvalues. They remain all, at
all further arms, as long as no unknown eigenvalue lies on the line
(`rodsweep.determinant.arm.count.no_crossing`). A second count, at the last arm, must confirm the result.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ....arrays import Array, Complex
from ....determinant.arm.count.no_crossing import proves_no_crossing, sampled_point_indices
from ....determinant.arm.count.settings import NO_CROSSING_SETTINGS
from ....determinant.parameter_path import ParameterPath
from .arm_count import confirmed_line
from .arm_interval import ArmInterval
from .carried_count import leading_eigenvalues


@dataclass(frozen=True, slots=True, kw_only=True)
class CarriedArmCountSettings:
    """Settings for counts that are carried along the arms of an interval."""

    line_distance: float = 0.05
    """Distance of the line to the left of the last requested eigenvalue w, or of the imaginary axis if w
    grows, divided by |w|."""


CARRIED_ARM_COUNT_SETTINGS = CarriedArmCountSettings()


class SortedEigenvalues(NamedTuple):
    """Followed eigenvalues of an interval by descending real part, and their errors, (points, m) each. lines:
    real part of the rightmost line that lies left of all requested eigenvalues, (points,)."""

    w: Complex
    error: Array
    lines: Array


class CarriedCountChain(NamedTuple):
    """Successive points of an interval, by index, between which no unknown eigenvalue crosses a line:
    `lines[k]` between `points[k]` and `points[k + 1]`."""

    points: list[int]
    lines: list[float]


def carry_counts(path: ParameterPath, interval: ArmInterval, modes: int) -> None:
    """Fills `interval.proved_modes` at points without a proof, wherever a count can be carried to them.
    modes: number of requested modes."""
    w, error = leading_eigenvalues(interval.track, interval.track.w.shape[1])
    last_requested_w = w[:, modes - 1]
    lines = np.minimum(last_requested_w.real, 0.0) - CARRIED_ARM_COUNT_SETTINGS.line_distance * np.abs(
        last_requested_w
    )
    followed = SortedEigenvalues(w, error, lines)
    # Where even the last followed eigenvalue grows, not all growing eigenvalues are followed.
    unproved = np.flatnonzero((interval.proved_modes < modes) & (w[:, -1].real <= 0))
    for run in np.split(unproved, np.flatnonzero(np.diff(unproved) > 1) + 1):
        first = int(run[0]) if len(run) else 0
        end = first + len(run)
        skipped_count = 1
        while end - first >= NO_CROSSING_SETTINGS.arm_count:
            chain = _longest_chain(path, interval, followed, (first, end - 1), modes)
            if not chain.lines:
                # Further points often fail, too, so every further failure skips twice as many points.
                first += skipped_count
                skipped_count *= 2
                continue
            end_of_chain = chain.points[-1], chain.lines[-1]
            if _confirmed_line_at(path, interval, followed, end_of_chain, modes) is not None:
                _store_proved_modes(interval, followed, chain)
            first = chain.points[-1] + 1
            skipped_count = 1


def _longest_chain(
    path: ParameterPath,
    interval: ArmInterval,
    followed: SortedEigenvalues,
    end_indices: tuple[int, int],
    modes: int,
) -> CarriedCountChain:
    """The longest chain of points found from the first to the last index in `end_indices`; without lines if
    no count can be carried from the first point."""
    index, last_index = end_indices
    shortest = NO_CROSSING_SETTINGS.arm_count - 1
    chain = CarriedCountChain([index], [])
    confirmed = None
    stride = last_index - index
    while last_index - index >= shortest:
        next_index = min(index + stride, last_index)
        if last_index - next_index < shortest:
            next_index = last_index
        line = float(followed.lines[index : next_index + 1].min())
        if confirmed is None or confirmed > line:
            confirmed = _confirmed_line_at(path, interval, followed, (index, line), modes)
            if confirmed is None:
                break
        if _is_line_free(path, interval, line, (index, next_index)):
            chain.points.append(next_index)
            chain.lines.append(line)
            confirmed = line
            index = next_index
            stride *= 2
        elif next_index - index < 2 * shortest:
            break
        else:
            stride = (next_index - index) // 2
    return chain


def _confirmed_line_at(
    path: ParameterPath,
    interval: ArmInterval,
    followed: SortedEigenvalues,
    index_and_line: tuple[int, float],
    modes: int,
) -> float | None:
    """Result of `confirmed_line` at a point, with `rightmost` = real part of the given line. index_and_line:
    (index of the point, real part of the line)."""
    i, line = index_and_line
    eigenvalues_and_errors = followed.w[i], followed.error[i]
    return confirmed_line(path, interval, float(interval.p[i]), eigenvalues_and_errors, modes, line)


def _is_line_free(
    path: ParameterPath, interval: ArmInterval, line: float, end_indices: tuple[int, int]
) -> bool:
    """Whether no unknown eigenvalue lies on a line, for any arm between two points of the interval."""
    points = sampled_point_indices(*end_indices)
    known_w = interval.track.w[points], interval.track.error[points]
    p = interval.p[points]
    rods = [path.rod_at(value) for value in p.tolist()]
    return proves_no_crossing(line, rods, p, known_w, interval.family, interval.hulls)


def _store_proved_modes(interval: ArmInterval, followed: SortedEigenvalues, chain: CarriedCountChain) -> None:
    """Fills `interval.proved_modes` at the points of a chain at which no followed eigenvalue is close to the
    line."""
    for (first, last), line in zip(pairwise(chain.points), chain.lines, strict=True):
        w = followed.w[first : last + 1]
        is_clear = (np.abs(w.real - line) > 2 * followed.error[first : last + 1]).all(axis=1)
        right_count = (w.real > line).sum(axis=1)
        interval.proved_modes[first : last + 1] = np.where(
            is_clear, right_count, interval.proved_modes[first : last + 1]
        )
