"""Settings for the continuation of branches beyond the range."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class BeyondRangeSettings:
    """Settings for the continuation of branches beyond the range."""

    relative_extent: float = 0.5
    """Branches are followed up to (1 + this number) times the largest coordinate of the range and down to its
    smallest coordinate divided by (1 + this number); along F down to 0, because there is no cycle without
    force."""
    max_cycles: int = 200
    """Maximum number of cycles on all branches beyond one end of the range."""
    work_ratio: float = 1.0
    """Limit of the work beyond one end of the range, divided by the work on the branches within the range."""
    min_work_limit: float = 100.0
    """Smallest limit of the work beyond one end of the range, in `WORK_UNIT`: some seconds, ten times the
    work on a usual branch. A range without a Hopf point has no branches of its own."""
    min_asymmetric_work_limit: float = 400.0
    """Smallest limit of the work on the branches of asymmetric cycles beyond one end of the range, in
    `WORK_UNIT`: their cycles are solved over the whole period, more accurately beside a fold."""


BEYOND_RANGE_SETTINGS = BeyondRangeSettings()
