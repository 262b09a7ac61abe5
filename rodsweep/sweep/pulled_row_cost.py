"""Estimated time of rows of a phase diagram along F that begin at a pull, F < 0."""

from collections.abc import Sequence

import numpy as np

from ..arrays import Array
from ..model.dispersion import sampled_arm
from ..model.rod import Rod
from .search_cost import SOFT_SEARCH_MS_PER_F2_OVER_K2

MAX_SAMPLED_ROWS = 20
"""Largest number of rows whose boxes are computed for an estimate; each takes up to 20 ms."""
COVERING_MS_PER_BOX = 0.11
"""Time to search one uniform rod under pulls, divided by the number of boxes from which the covering starts,
in ms: 0.07 to 0.15 for twelve rods with 98 to 2900 boxes."""
EXTRA_MS_BEYOND_SHEAR_STIFFNESS = 100.0
"""Further time to search one rod from a pull beyond its shear stiffness, in ms: 110 for six, k2 = 100."""
ARM_MS_PER_LARGEST_PULL = 0.6
"""Time to search an arm that is not uniform under pulls, divided by the largest pull in k3/L^2, in ms: 0.5 to
0.7 for a cone under pulls of 100 and 1000."""
MAX_UNRESOLVED_SEARCH_SECONDS = 30.0
"""Largest time of a search that no mesh resolves, in s: 0.07 to 30 s were measured for six arms and rods."""
UNDERESTIMATED_ROWS_TEXT = "rows that begin at a pull beyond the shear stiffness"
"""Kind of rows whose time is not estimated reliably: of fourteen rods under pulls F < -k2 nu some took ten
times as long as a rod under half or twice the pull."""


def pulled_rows_seconds(rods: Sequence[Rod], F_values: Array, row_count: int) -> tuple[float, str]:
    """Returns (time in s to search all rows below F = 0, underestimated rows). underestimated rows: kind of
    rows whose time may be many times as long; empty if there are none. rods: rods of evenly spaced rows, with
    any F. F_values: increasing forces along a row, (n,). row_count: number of rows."""
    pulls = F_values[F_values < 0]
    if not pulls.size or not rods:
        return 0.0, ""
    # The diagram itself begins a row at the first pull with a bound on its eigenvalues.
    starts = [_largest_searchable_pull(rod, pulls) for rod in rods]
    seconds_of_rows = [_row_seconds(rod, start) for rod, start in zip(rods, starts, strict=True)]
    # Beyond the shear stiffness g = nu + F c2 is negative somewhere along the arm.
    arms = (sampled_arm(rod.with_values(F=start)) for rod, start in zip(rods, starts, strict=True))
    is_beyond_shear_stiffness = any(float(np.min(arm.local.g)) < 0 for arm in arms)
    return row_count * float(
        np.mean(seconds_of_rows)
    ), UNDERESTIMATED_ROWS_TEXT if is_beyond_shear_stiffness else ""


def _largest_searchable_pull(rod: Rod, pulls: Array) -> float:
    """First of the increasing `pulls` from which a row can be searched; 0 if there is none. For arms that are
    not uniform, whose searchable pulls are not known in advance, the first pull."""
    if not rod.is_uniform_and_linear:
        return float(pulls[0])
    low = 0
    high = len(pulls)
    while low < high:  # the search itself bisects too
        middle = (low + high) // 2
        if _boxes_from_pull_to_zero(rod, float(pulls[middle])) is None:
            low = middle + 1
        else:
            high = middle
    return float(pulls[low]) if low < len(pulls) else 0.0


def _row_seconds(rod: Rod, start_pull: float) -> float:
    """Time to search one row from the pull `start_pull` to F = 0, in s."""
    if not rod.is_uniform_and_linear:
        # No search lasts longer, because it gives up on rods that no mesh resolves.
        return min(1e-3 * ARM_MS_PER_LARGEST_PULL * -start_pull, MAX_UNRESOLVED_SEARCH_SECONDS)
    boxes = _boxes_from_pull_to_zero(rod, start_pull)
    covering_ms = COVERING_MS_PER_BOX * (0 if boxes is None else len(boxes))
    drive = start_pull * rod.with_values(F=start_pull).g
    exchanges_ms = (
        EXTRA_MS_BEYOND_SHEAR_STIFFNESS + SOFT_SEARCH_MS_PER_F2_OVER_K2 * drive if drive > 0 else 0.0
    )
    return 1e-3 * covering_ms + min(1e-3 * exchanges_ms, MAX_UNRESOLVED_SEARCH_SECONDS)


def _boxes_from_pull_to_zero(rod: Rod, pull: float) -> Array | None:
    """Boxes of the covering from `pull` to F = 0; None if no a-priori bound applies."""
    # Imported for rows under pulls only: these modules load the compiler.
    from ..determinant.certificate.first_crossing_boxes import first_crossing_boxes
    from ..determinant.parameter_path import ParameterPath

    return first_crossing_boxes(ParameterPath(rod.with_values(F=pull), "F"), pull, 0.0) if pull < 0 else None
