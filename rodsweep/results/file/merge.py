"""Shards of a run put together: the points of several result files of one config, in one file.

Streamed a block of points at a time, so that memory does not grow with the files; the new file
appears whole, by a rename.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py

from ...errors import InputError
from ...sweep.ranges import total
from ..run.journal import JOURNALS, journal_directory
from .exchange import Exchange, disk_refusals
from .points import missing_ranges, points_to_add, write_points
from .provenance import KERNELS, kernels_sentence, merged_history, now
from .validation import Header, change_between, read_header


@dataclass(frozen=True, slots=True)
class Merged:
    """What came of a merge: points in the file, those still missing, whether nothing else is, and by what."""

    points: int
    missing: int
    finished: bool
    kernels: str
    """What is to be said of the BLAS kernels that computed the points, where they are several; else empty."""


def merge(output: Path, paths: Sequence[Path]) -> Merged:
    """Writes `output` from all points of the result files `paths`; of a point given twice the first stays.

    An existing `output` of the same config is the first of them. InputError if a file is no result, answers
    another config or has points in its journal; EnvironmentLacks where the disk refuses.
    """
    sources = _opened(paths)
    with disk_refusals(output):
        exchange = Exchange(output)
    try:
        with disk_refusals(output, "; the shards are untouched"):
            if output.exists():  # it may have appeared while another run had the lock
                sources = _opened([output, *(path for path in paths if not os.path.samefile(output, path))])
            return _merge(exchange, sources)
    finally:
        exchange.close()


def _merge(exchange: Exchange, sources: Sequence[Header]) -> Merged:
    """Exchanges the file for the first source with the points that the others add."""
    first = sources[0]
    with exchange.replacing(first.path) as copy:
        gave = [first]
        for source in sources[1:]:
            if write_points(copy, points_to_add(copy, source.path, first.layout), first.layout):
                gave.append(source)
        missing = total(missing_ranges(copy))
        finished = not missing and not first.layout.needs_all_points
        history = merged_history([source.attributes for source in gave])
        with h5py.File(copy, "r+") as file:
            file.attrs.update(history | ({"finished": now()} if finished else {}))
    return Merged(first.points - missing, missing, finished, kernels_sentence(history[KERNELS]))


def _opened(paths: Sequence[Path]) -> list[Header]:
    """The files, all of one config, each with all of its points in it; else InputError."""
    files = [read_header(path) for path in paths]
    for file in files:
        if any(journal_directory(file.path).glob(JOURNALS)):
            raise InputError(
                f"{file.path} has points in its journal that are not in it yet: run its command again first"
            )
    first, *others = files
    for other in others:
        if first.fingerprint != other.fingerprint:
            change = change_between(first.config, other.config)
            raise InputError(f"{other.path} was made from another config than {first.path} ({change})")
        if (first.layout.record, first.points) != (other.layout.record, other.points):
            raise InputError(f"{other.path} was written by another version of rodsweep than {first.path}")
    return files
