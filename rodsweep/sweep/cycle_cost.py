"""Estimated cost of limit cycles before the start of a sweep."""

import numpy as np

from .cost_estimate import CostEstimate, sampled_points_with_rod
from .points.points import Points

CYCLE_FROM_MODE_SECONDS = 0.1
"""Time of a limit cycle computed from the leading mode, in s, close to the time in the benchmark."""
MIN_PULL_OF_SLOW_MOTION = 500.0
"""Smallest pull, in k3/L^2, under which the motion of a rod returns to the straight state so slowly that it
is followed to its end: under a pull of 100 its integration takes 0.1 s, under 1000 it takes 7 s."""
PULLED_MOTION_SECONDS = 8.0
"""Time of the motion of a rod under a pull of at least MIN_PULL_OF_SLOW_MOTION, in s: 6.5 to 9 s for pulls of
1e3 to 1e4."""
MAX_FORCE_OF_MEASURED_CYCLES = 350.0
"""Largest force, in k3/L^2, at which CYCLE_FROM_MODE_SECONDS holds: eight random rods under 60 to 300 took
0.04 to 0.17 s. A rod under 400 took 2 s, one under 1500 25 s, because their motion does not repeat."""
UNDERESTIMATED_RODS_TEXT = "rods far above flutter, whose motion may not repeat,"
"""Kind of rods whose cycles may take many times as long as estimated."""
CHAINED_CYCLE_SECONDS = 0.01
"""Time of a limit cycle computed from the cycle of a neighbouring point, in s, as in the benchmark."""
MARCHED_CYCLE_SECONDS = 0.25
"""Time of a limit cycle by time integration to a relative accuracy of 1e-5, in s: mean over 40 rods."""
ACCURACY_OF_MARCHED_CYCLE_SECONDS = 1e-5
"""Relative accuracy at which MARCHED_CYCLE_SECONDS was measured."""
MARCHED_ACCURACY_EXPONENT = 0.35
"""Exponent of ACCURACY_OF_MARCHED_CYCLE_SECONDS/accuracy in the time of a limit cycle by time integration,
for smaller accuracies: three rods took nine times as long at 1e-8."""


def cycles_cost(points: Points, first_count: int) -> CostEstimate:
    """Estimated cost of the limit cycles of `points`. first_count: number of cycles computed from the leading
    mode; all other cycles are computed from a neighbour's cycle."""
    indices = sampled_points_with_rod(points)
    # Without any rod in the model nothing is pulled, as for F = 0.
    F = np.asarray(points.parameter_values_of_points(indices)["F"]) if indices.size else np.zeros(1)
    pulled_count = points.count * float(np.mean(-MIN_PULL_OF_SLOW_MOTION >= F))
    seconds = first_count * CYCLE_FROM_MODE_SECONDS + (points.count - first_count) * CHAINED_CYCLE_SECONDS
    doubt = UNDERESTIMATED_RODS_TEXT if bool((F > MAX_FORCE_OF_MEASURED_CYCLES).any()) else ""
    return CostEstimate(seconds + pulled_count * PULLED_MOTION_SECONDS, underestimated_rods=doubt)


def marched_cycles_cost(cycle_count: int, accuracy: float) -> CostEstimate:
    """Estimated cost of `cycle_count` limit cycles by time integration to a relative accuracy."""
    accuracy_factor = max(1.0, ACCURACY_OF_MARCHED_CYCLE_SECONDS / accuracy) ** MARCHED_ACCURACY_EXPONENT
    return CostEstimate(cycle_count * MARCHED_CYCLE_SECONDS * accuracy_factor)
