"""Why a run may not take a file for its own, or not begin it, and what the user may do about that."""

import shutil
from pathlib import Path

from ...errors import EnvironmentIncomplete, InputError
from ..run.journal import journals_of
from .combination.extension import extension_of
from .combination.identity import change_between
from .creation import Plan
from .points import parameters_of
from .validation import Header, NotWhole, read_header

SPACE_FACTOR, SPACE_FIXED = 3, 300_000
"""Room that a run needs: the file, the journals and the copy in units of the file, and bytes besides."""


def require_room(path: Path, plan: Plan) -> None:
    """EnvironmentIncomplete unless the file, its journals and the copy that replaces it have room."""
    size = SPACE_FACTOR * plan.points.count * (plan.layout.bytes_per_point + 12) + SPACE_FIXED
    free = shutil.disk_usage(path.parent).free
    if free < size:
        raise EnvironmentIncomplete(
            f"{path} needs {size / 1e6:.3g} MB on its disk while it is computed, and "
            f"{free / 1e6:.3g} MB are free"
        )


def header_in_the_way(path: Path, plan: Plan, journals: Path) -> Header:
    """The header of an existing file where a plan's is to be; InputError unless it is a whole result."""
    if not path.is_file():
        raise InputError(f"{path} is not a file; choose another with -o")
    try:
        return read_header(path)
    except NotWhole as error:
        raise InputError(f"{error}; it is left as it is: {_ways_out(plan, journals)}") from None


def refuse_other(header: Header, plan: Plan, journals: Path) -> None:
    """Refuses a file that was made for something else than the plan."""
    change = change_between(header.config, plan.config)
    ways = _ways_out(plan, journals)
    try:
        extension_of(header, parameters_of(header.path, header.layout), plan)
        ways += "; --extend computes what it lacks"
    except InputError:  # its config is not contained in ours
        pass
    raise InputError(f"{header.path} was made from another config ({change}); {ways}")


def _ways_out(plan: Plan, journals: Path) -> str:
    """What may be done about a file that stands in the way of a run."""
    if journals_of(journals, plan.fingerprint):
        return f"move it away, and the same command takes the points that wait in {journals}"
    return "choose another file with -o, or replace it with --fresh"
