"""What a run has done so far: its file, and the points in its journals that are not in the file yet.

Only read here, so that a run that goes on is not disturbed, and needs no lock.
"""

import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import h5py
import numpy as np

from ...errors import EnvironmentIncomplete, InputError
from ...sweep.points.ranges import total
from ..layouts.variables import MISSING
from ..run.journal import journal_directory, read_journals
from .exchange import Exchange, disk_refusals, identity
from .points import missing_ranges, write_points
from .provenance import now
from .validation import Header, is_ours, read_header, reading

FOLDS_MET = 20
"""How often a file is read again because a run folded its journals in meanwhile: folds are seconds apart."""
SNAPSHOT = "snapshot"
"""The attribute with the time of a snapshot, which marks a file as one."""

Found = TypeVar("Found")


def unfolded(path: Path, read: Callable[[], Found]) -> Found:
    """What `read` makes of a file and its journals: again, where a run folds these in meanwhile.

    A fold exchanges the file before it drops the journals: where the file is the same, none was dropped.
    EnvironmentIncomplete where the file never stays as it is.
    """
    for _ in range(FOLDS_MET):
        runs, before = journal_directory(path).is_dir(), identity(path)
        found = read()
        if not runs or identity(path) == before:
            return found
    raise EnvironmentIncomplete(f"{path} is exchanged again and again, so that it cannot be read; try again")


def journalled_points(header: Header, status: np.ndarray) -> np.ndarray:
    """Records, (n,), of the points that are in a file's journals and, by `status`, (points,), not in it."""
    found = np.empty(0, header.layout.record)
    directory = journal_directory(header.path)
    if not directory.is_dir():
        return found
    missing = status == MISSING
    blocks = read_journals(directory, header.layout, header.fingerprint, len(status))
    found = np.concatenate([found, *(block[missing[block["index"]]] for block in blocks)])
    _, last = np.unique(found["index"][::-1], return_index=True)  # of a point twice, the last stays
    return found[::-1][last]


def put_in(values: np.ndarray, name: str, records: np.ndarray) -> None:
    """Puts what records, (n,), have of a variable into its values, of the points' shape and its own."""
    inner = records[name].shape[1:]
    values.reshape(-1, *inner)[records["index"]] = records[name]


def take_snapshot(path: Path, output: Path) -> tuple[int, int]:
    """Writes what is done of a run so far into a file of its own; returns (points that it has, all points).

    InputError if `path` is no result, or `output` is a file that is no snapshot; EnvironmentIncomplete where
    the disk refuses.
    """
    read_header(path)
    if output.exists():
        if os.path.samefile(path, output):
            raise InputError(f"{output} is the file itself; name another with -o")
        if not _is_snapshot(output):
            raise InputError(f"{output} exists and is no snapshot; name another file with -o")
    with disk_refusals(output):
        exchange = Exchange(output)
    try:
        return unfolded(path, lambda: _copied(path, exchange))
    finally:
        exchange.close()


def _copied(path: Path, exchange: Exchange) -> tuple[int, int]:
    """Exchanges the file for a copy of the one at `path` with its journals folded in."""
    header = read_header(path)
    with disk_refusals(exchange.path), exchange.replacing(path) as copy:
        blocks = read_journals(journal_directory(path), header.layout, header.fingerprint, header.points)
        write_points(copy, blocks, header.layout)
        with h5py.File(copy, "r+") as file:
            file.attrs[SNAPSHOT] = now()
        missing = total(missing_ranges(copy))
    return header.points - missing, header.points


def _is_snapshot(path: Path) -> bool:
    """Whether a file is a snapshot that no run has continued since."""
    if not is_ours(path):
        return False
    with reading(path), h5py.File(path, "r") as file:
        return bool(file.attrs.get(SNAPSHOT))
