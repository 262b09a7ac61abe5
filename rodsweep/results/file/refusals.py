"""Refusals at the start of a run: too little disk space, or another file at the path of the result file."""

import shutil
from pathlib import Path

from ...errors import EnvironmentIncomplete, InputError
from ..run.journal import journals_with_fingerprint
from .combination.config_comparison import config_change_text
from .combination.extension import extension_of
from .creation import FilePlan
from .points import points_of_file
from .validation import InvalidResultFile, ResultHeader, is_rodsweep_or_damaged_file, read_header

DISK_SPACE_OVER_FILE_SIZE = 3
"""Disk space that a run needs (for the file, the journals and a new copy of the file), divided by the size of
the file."""
EXTRA_SPACE_BYTES = 300_000
"""Disk space that a run needs for attributes, coordinates and checkpoints, in bytes, in addition to
DISK_SPACE_OVER_FILE_SIZE times the values of the points."""


def require_disk_space(path: Path, plan: FilePlan) -> None:
    """Raises EnvironmentIncomplete unless the disk has space for the file of a plan, journals and a copy."""
    needed_bytes = (
        DISK_SPACE_OVER_FILE_SIZE * plan.points.count * (plan.layout.bytes_per_point + 12) + EXTRA_SPACE_BYTES
    )
    free = shutil.disk_usage(path.parent).free
    if free < needed_bytes:
        raise EnvironmentIncomplete(
            f"{path} needs {needed_bytes / 1e6:.3g} MB of disk space, but {free / 1e6:.3g} MB are free; "
            "make room"
        )


def header_of_existing_file(path: Path, plan: FilePlan, journals: Path) -> ResultHeader:
    """Header of the existing file at `path`, the path for the result file of `plan`. Raises InputError unless
    the existing file is a complete result. journals: journal directory of `path`.
    """
    if not path.is_file():
        raise InputError(f"{path} is not a file; choose another file with -o")
    try:
        return read_header(path)
    except InvalidResultFile as error:
        remedies_clause = _remedies_clause(plan, journals)
        if not is_rodsweep_or_damaged_file(path) and not journals_with_fingerprint(
            journals, plan.fingerprint
        ):
            remedies_clause = "choose another file with -o, or move this file away"
        raise InputError(f"{error}; the file is left unchanged: {remedies_clause}") from None


def require_same_config(header: ResultHeader, plan: FilePlan, journals: Path) -> None:
    """Raises InputError for an existing file, described by `header`, whose config differs from the config of
    the plan. journals: journal directory of this file."""
    change = config_change_text(header.config, plan.config)
    remedies_clause = _remedies_clause(plan, journals)
    try:
        extension_of(header, points_of_file(header.path, header.layout), plan)
        remedies_clause += "; --extend computes only the missing points"
    except InputError:  # the plan lacks points or results of the file
        pass
    raise InputError(f"{header.path} was made from another config ({change}); {remedies_clause}")


def _remedies_clause(plan: FilePlan, journals: Path) -> str:
    """Clause that tells the user what to do with a file that is in the way of the result file of `plan`.
    journals: journal directory of this file."""
    if journals_with_fingerprint(journals, plan.fingerprint):
        return f"move this file away, and the same command will use the points in {journals}"
    return "choose another file with -o, or replace it with --fresh"
