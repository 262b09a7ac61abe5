"""Options of the command `run`."""

from dataclasses import dataclass

from ...sweep.points.ranges import Shard


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """Options of the command `rodsweep run`, as given on the command line."""

    overrides: tuple[str, ...] = ()
    """Texts KEY=VALUE that override keys of the config."""
    fresh: bool = False
    """Whether an existing file is replaced."""
    extend: bool = False
    """Whether an existing file of a smaller config is extended."""
    shard: Shard
    strict: bool = False
    """Whether the run ends at the first exception that is a bug."""
    quiet: bool = False
    """Whether to print problems only, without progress."""
