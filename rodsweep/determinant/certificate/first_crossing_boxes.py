"""The first boxes of a covering of the (eta, p) plane, w = i eta on the imaginary axis, p: path variable. The
a-priori bounds exclude every crossing outside these boxes.

The a-priori bounds (`box_of_all_eigenvalues`) hold on an interval of the path. Intervals of p are so short
that no coefficient changes much over an interval.
"""

import math
import sys
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ..parameter_path import ParameterPath, coefficients_at
from .box_of_all_eigenvalues import BOX_SETTINGS, frequency_bound_on_path, zero_free_radius


@dataclass(frozen=True, slots=True, kw_only=True)
class CoveringSettings:
    """Settings for the first boxes of a covering of the (eta, p) plane: frequency eta, path variable p."""

    min_intervals: int = 8
    """Minimum number of intervals of p into which the path is divided."""
    max_upper_over_lower_eta: float = 4.0
    """Largest ratio of the upper to the lower end of a first box in the frequency eta."""
    max_nu_decrease_fraction: float = 0.5
    """Largest decrease of the stretch nu over an interval of p, as a fraction of nu at the start of the
    interval."""
    min_interval_over_longest: float = 1e-6
    """Lower limit of the length of an interval of p, as a fraction of the longest. Near p = 0 intervals
    become short, because a drag or compliance p at most doubles over an interval."""
    min_last_over_previous_interval: float = 1e-3
    """If the last interval of p is below this fraction of the previous interval, the two are merged."""
    eta_padding: float = 1e-6
    """Amount added to the upper bound of the frequency eta, in 1/tau2, because the bound itself is 0 at F =
    0."""


COVERING_SETTINGS = CoveringSettings()


def path_intervals_of_bounded_change(
    path: ParameterPath, p_start: float, p_stop: float
) -> list[tuple[float, float]]:
    """Intervals (start, end) of p from `p_start` to `p_stop`; over each interval nu at most halves, and a
    drag or compliance at most doubles, except on the shortest intervals."""
    edges = [p_start]
    width = (p_stop - p_start) / COVERING_SETTINGS.min_intervals
    while edges[-1] < p_stop:
        p = edges[-1]
        step = width
        nu = coefficients_at(p, path.origin, path.direction).nu
        slope = path.direction.nu
        if slope < 0:  # the rod is crushed at nu = 0
            step = min(step, COVERING_SETTINGS.max_nu_decrease_fraction * nu / -slope)
        if path.parameter_name != "F":  # drag and compliances vary over decades
            step = min(step, max(p, COVERING_SETTINGS.min_interval_over_longest * width))
        end = p + step
        # On a path of a few roundings, p + step is p.
        is_last = end <= p or p_stop - end < COVERING_SETTINGS.min_last_over_previous_interval * step
        edges.append(p_stop if is_last else end)
    return list(zip(edges[:-1], edges[1:], strict=True))


def first_crossing_boxes(path: ParameterPath, p_start: float, p_stop: float) -> Array | None:
    """Boxes (eta_from, eta_to, p_from, p_to), (n, 4), that contain every crossing w = i eta, eta > 0, with p
    from p_start to p_stop. None if no a-priori bound exists, or if the lower bound of eta is 0 or almost
    underflows."""
    boxes = []
    for interval_start, interval_end in path_intervals_of_bounded_change(path, p_start, p_stop):
        max_eta = (1 + BOX_SETTINGS.relative_bound_excess) * frequency_bound_on_path(
            path, interval_start, interval_end
        ) + COVERING_SETTINGS.eta_padding
        if not math.isfinite(max_eta):
            return None
        min_eta = zero_free_radius(path, interval_start, interval_end, max_eta)
        if min_eta * sys.float_info.max <= max_eta:  # `min_eta` is 0 or so small that top/min_eta overflows
            return None
        count = max(
            1, math.ceil(math.log(max_eta / min_eta) / math.log(COVERING_SETTINGS.max_upper_over_lower_eta))
        )
        # Boxes of one ratio: discs about a centre must not reach the branch point of P at eta = 0.
        edges = np.geomspace(min_eta, max_eta, count + 1)
        boxes += [(edges[i], edges[i + 1], interval_start, interval_end) for i in range(count)]
    return np.array(boxes).reshape(-1, 4)
