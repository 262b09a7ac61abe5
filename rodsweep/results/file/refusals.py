"""Refusals at the start of a run: no room, or another file in the way; and the user's options."""

import shutil
from pathlib import Path

from ...errors import EnvironmentIncomplete, InputError
from ..run.journal import journals_of
from .combination.extension import extension_of
from .combination.identity import change_between
from .creation import Plan
from .points import parameters_of
from .validation import IncompleteFile, ResultHeader, read_header

SPACE_FACTOR = 3
"""Disk space needed by a run, in units of the file size: the file, the journals, and the replacing copy."""
SPACE_FIXED = 300_000
"""Additional disk space needed by a run, in bytes: attributes, coordinates and checkpoints."""


def require_room(path: Path, plan: Plan) -> None:
    """Raises EnvironmentIncomplete unless the disk has room for the file, the journals and the copy."""
    size = SPACE_FACTOR * plan.points.count * (plan.layout.bytes_per_point + 12) + SPACE_FIXED
    free = shutil.disk_usage(path.parent).free
    if free < size:
        raise EnvironmentIncomplete(
            f"{path} needs {size / 1e6:.3g} MB of disk space during the run, and {free / 1e6:.3g} MB are free"
        )


def header_in_the_way(path: Path, plan: Plan, journals: Path) -> ResultHeader:
    """Header of an existing file at the path of a plan; raises InputError unless it is a complete result."""
    if not path.is_file():
        raise InputError(f"{path} is not a file; choose another with -o")
    try:
        return read_header(path)
    except IncompleteFile as error:
        raise InputError(f"{error}; the file is left unchanged: {_ways_out(plan, journals)}") from None


def refuse_other(header: ResultHeader, plan: Plan, journals: Path) -> None:
    """Raises InputError for an existing file whose config differs from the config of the plan."""
    change = change_between(header.config, plan.config)
    ways = _ways_out(plan, journals)
    try:
        extension_of(header, parameters_of(header.path, header.layout), plan)
        ways += "; --extend computes only the missing points"
    except InputError:  # the plan lacks points or results of the file
        pass
    raise InputError(f"{header.path} was made from another config ({change}); {ways}")


def _ways_out(plan: Plan, journals: Path) -> str:
    """Phrase with the options of a user whose run finds another file at its path."""
    if journals_of(journals, plan.fingerprint):
        return f"move it away, and the same command will use the points in {journals}"
    return "choose another file with -o, or replace it with --fresh"
