"""Sentences of `rodsweep show` on the range in which branches of cycles are followed, on the limits beyond
this range up to which they are followed, and on the cycles that may be missed."""

import numpy as np

from ...arrays import list_of
from ..branch_curves import followed_parameter, followed_range
from ..crushing import uncrushed_ranges
from .number_texts import value_range_text
from .selection import PointSelection
from .thresholds import proved_rod_count_text

MISSED_CYCLES_TEXT = (
    "cycles are missed if their branch comes from farther away, moves away from the range stable or with "
    "several multipliers outside the unit circle and comes back, begins at a symmetry breaking on such a "
    "branch, or is connected to no Hopf point"
)
"""Clause that states which cycles within the range are not found."""


def followed_beyond_range_text(points: PointSelection, parameter_name: str, prefix: str) -> str:
    """Clauses on the limits, beyond the range, up to which branches that may enter the range are followed,
    and on the cycles that are missed. parameter_name: parameter along which branches are followed. prefix:
    the limits are the variables `prefix` + "from" and `prefix` + "to"."""
    limits = [points.values(f"{prefix}{end}") for end in ("from", "to")]
    if not all(np.isfinite(values).any() for values in limits):
        return MISSED_CYCLES_TEXT
    low_text, high_text = map(value_range_text, limits)
    return (
        f"branches that may enter the range are followed down to {parameter_name} = {low_text} and up to "
        f"{high_text}; {MISSED_CYCLES_TEXT}"
    )


def searched_range_line(points: PointSelection) -> str:
    """Line on the range in which branches are followed, on the completeness of the list of Hopf points from
    which they start, and on the limits beyond the range; "no branch is followed" if the force crushes all
    rods in the whole range."""
    view = points.view
    parameter = followed_parameter(view)
    start, end = followed_range(view)
    ranges = uncrushed_ranges(view, list_of(np.flatnonzero(points.mask.ravel())))
    if all(last <= first for first, last in ranges):
        return "no branch is followed"
    note = "" if set(ranges) <= {(start, end)} else ", where the force does not crush the rod"
    return (
        f"followed in {parameter} from {start:g} to {end:g}{note}; the list of Hopf points "
        f"{proved_rod_count_text(points, 'rod')}; "
        f"{followed_beyond_range_text(points, parameter, 'followed_')}"
    )
