"""Options of the command `run`."""

from dataclasses import dataclass

from ...sweep.points.ranges import Shard


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """Options of the command `rodsweep run`, as given on the command line."""

    overrides: tuple[str, ...] = ()
    """Texts KEY=VALUE of the options --set, which override keys of the config."""
    fresh: bool = False
    """Whether an existing result file is replaced."""
    extend: bool = False
    """Whether an existing result file with fewer points is extended to the config."""
    shard: Shard
    """Part of the points that the run solves."""
    strict: bool = False
    """Whether the run ends at the first exception that is a bug."""
    quiet: bool = False
    """Whether to print problems only, without progress."""
