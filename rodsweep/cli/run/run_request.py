"""Request for a run: part of the points, overrides of the config, and options of `rodsweep run`."""

from dataclasses import dataclass

from ...sweep.points.ranges import Shard


@dataclass(frozen=True, slots=True, kw_only=True)
class RunRequest:
    """Request for a run, as given by the options of `rodsweep run`; defaults of the command are set in
    `rodsweep.cli.command_line`."""

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
    """Whether the command prints problems only, and no progress."""
