"""Counts that confirm, at one arm of an interval, that all eigenvalues right of a line are followed."""

import math

import numpy as np

from ....arrays import Array, Complex
from ....determinant.arm.count.count import count_right_of
from ....determinant.arm.determinant import ArmDeterminant
from ....determinant.arm.family_values import propagators_at
from ....determinant.arm.hull.region import hull_at
from ....determinant.parameter_path import ParameterPath
from ..candidates import lines_for_count
from .arm_interval import ArmInterval
from .carried_count import leading_eigenvalues_of_track
from .prediction import FollowedEigenvalues


def confirmed_count_at(
    path: ParameterPath, interval: ArmInterval, p: float, mode_count: int, point_track: FollowedEigenvalues
) -> int:
    """Number of eigenvalues at path variable p that are confirmed by a count to be all eigenvalues to the
    right of a line; 0 if no count confirms this. interval: an interval that contains p. point_track: a track
    with the eigenvalues at p only."""
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
    """Real part, at most `rightmost`, of a line for which a count at path variable p confirms that all
    eigenvalues to its right are followed; None if no count confirms this for any line.

    interval: an interval that contains p. eigenvalues_and_errors: eigenvalues at p by descending real part,
    and their errors, (m,) each. mode_count: number of requested modes, which lie to the right of the line.
    """
    w, error = eigenvalues_and_errors
    if w[-1].real > 0:  # more modes grow, and the count would include them
        return None
    determinant = ArmDeterminant(path.rod_at(p), propagators_at(interval.family, p))
    hull = hull_at(interval.hulls, p)
    lines = [line for line in lines_for_count(w.tolist(), mode_count) if line <= rightmost]
    for line in [*lines, rightmost] if rightmost < math.inf else lines:
        number = count_right_of(line, determinant, hull, w, error).number
        if number is not None:
            are_clear = (np.abs(w.real - line) > 2 * error).all()
            return line if are_clear and number == (w.real > line).sum() else None
    return None
