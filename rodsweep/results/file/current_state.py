"""Current state of a run: the result file together with points that are still in its journals.

File and journals are only read: a run in progress is not disturbed, and no lock is needed.
"""

import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import h5py
import numpy as np

from ...errors import EnvironmentIncomplete, InputError
from ...sweep.points.ranges import index_count
from ..layouts.variables import MISSING_STATUS
from ..run.journal import journal_directory, read_failure_reasons, read_journals
from .points import missing_ranges, write_records
from .provenance import updated_reasons_attribute, utc_time
from .replacement import FileReplacement, disk_errors_as_refusals, file_identity
from .validation import ResultHeader, damage_as_refusals, is_rodsweep_or_damaged_file, read_header

MAX_REREADS = 20
"""Maximum number of attempts to read a file that is replaced meanwhile. A run replaces its file at most every
few seconds; more replacements indicate a fault."""
SNAPSHOT_ATTRIBUTE = "snapshot"
"""Name of the attribute with the time at which a snapshot was written; only snapshots have this attribute."""
ReadResult = TypeVar("ReadResult")


def read_file_and_journals(path: Path, read_result: Callable[[], ReadResult]) -> ReadResult:
    """Result of the function `read_result`, which reads the file `path` and its journals. The function is
    called again if the file was replaced meanwhile.

    A run that moves journalled points into the file replaces the file before the journals are deleted. If the
    file is unchanged after the reading, no journal was deleted meanwhile. Raises EnvironmentIncomplete if the
    file keeps changing.
    """
    for _ in range(MAX_REREADS):
        # Without journals one read is consistent, because files are replaced as a whole.
        has_journals = journal_directory(path).is_dir()
        identity = file_identity(path)
        result = read_result()
        if not has_journals or file_identity(path) == identity:
            return result
    raise EnvironmentIncomplete(f"{path} cannot be read, because a run keeps replacing it; try again")


def records_only_in_journals(header: ResultHeader, status: np.ndarray) -> np.ndarray:
    """Records, (n,), of the points in the journals that are missing in the file of `header`. status: statuses
    in the file, (points,).
    """
    records = np.empty(0, header.layout.record_dtype)
    directory = journal_directory(header.path)
    if not directory.is_dir():
        return records
    is_missing = status == MISSING_STATUS
    blocks = read_journals(directory, header.layout, header.fingerprint, len(status))
    records = np.concatenate([records, *(block[is_missing[block["index"]]] for block in blocks)])
    _, last_indices = np.unique(records["index"][::-1], return_index=True)  # the last record of a point wins
    return records[::-1][last_indices]


def failure_reasons_with_journals(header: ResultHeader) -> dict[str, str]:
    """Dict with the attribute FAILURE_REASONS_ATTRIBUTE, including failed points in the journals; empty if no
    point failed."""
    directory = journal_directory(header.path)
    lines = read_failure_reasons(directory, header.layout, header.fingerprint) if directory.is_dir() else ()
    return updated_reasons_attribute(lines, header.attributes)


def insert_records(values: np.ndarray, name: str, records: np.ndarray) -> None:
    """Copies the variable `name` of `records`, (n,), into `values`, the array of this variable at all points,
    which is changed in place. The field `index` of a record is the flat index of its point."""
    values.reshape(-1, *records[name].shape[1:])[records["index"]] = records[name]


def write_snapshot(path: Path, output: Path) -> tuple[int, int]:
    """Writes the points computed so far into a separate file; returns (points computed, all points).

    Raises InputError if `path` is not a result, or if `output` exists and is not a snapshot. Raises
    EnvironmentIncomplete if the disk fails.
    """
    read_header(path)
    if output.exists():
        if os.path.samefile(path, output):
            raise InputError(f"{output} is the file itself; name another file with -o")
        if not _is_snapshot(output):
            raise InputError(f"{output} exists and is not a snapshot; name another file with -o")
    with disk_errors_as_refusals(output):
        replacement = FileReplacement(output)
    try:
        return read_file_and_journals(path, lambda: _write_new_snapshot(path, replacement))
    finally:
        replacement.close()


def _write_new_snapshot(path: Path, replacement: FileReplacement) -> tuple[int, int]:
    """Replaces the snapshot (`replacement`) by a copy of the file at `path` with the points of its journals.
    Returns (number of computed points, number of all points)."""
    header = read_header(path)
    with disk_errors_as_refusals(replacement.path), replacement.writing_new_file(path) as copy:
        blocks = read_journals(journal_directory(path), header.layout, header.fingerprint, header.point_count)
        write_records(copy, blocks, header.layout)
        with h5py.File(copy, "r+") as file:
            file.attrs.update(failure_reasons_with_journals(header) | {SNAPSHOT_ATTRIBUTE: utc_time()})
        missing_count = index_count(missing_ranges(copy))
    return header.point_count - missing_count, header.point_count


def _is_snapshot(path: Path) -> bool:
    """Whether a file is a snapshot. A run that continues a snapshot turns the snapshot into an ordinary
    result file."""
    if not is_rodsweep_or_damaged_file(path):
        return False
    with damage_as_refusals(path), h5py.File(path, "r") as file:
        return bool(file.attrs.get(SNAPSHOT_ATTRIBUTE))
