"""Shards of a run put together, or files whose grids make up a larger one: all their points in one file.

Streamed a block of points at a time, so that memory does not grow with the files; the new file
appears whole, by a rename.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py

from ....config.document.reading import config_of
from ....errors import InputError
from ....sweep.points.ranges import total
from ...run.journal import JOURNALS, journal_directory
from ..creation import Plan, add_variables, create_file
from ..exchange import Exchange, disk_refusals
from ..points import missing_ranges, parameters_of, points_to_add, write_points
from ..provenance import KERNELS, kernels_sentence, merged_history, now
from ..validation import Header, read_header
from .joining import Joint, Planner, joint_of


@dataclass(frozen=True, slots=True)
class Merged:
    """What came of a merge: points in the file, those still missing, whether nothing else is, and by what."""

    points: int
    missing: int
    finished: bool
    kernels: str
    """What is to be said of the BLAS kernels that computed the points, where they are several; else empty."""


def merge(output: Path, paths: Sequence[Path], planner: Planner) -> Merged:
    """Writes `output` from all points of the result files `paths`, parts of one grid or list, or several.

    An existing `output` is the first of them. Of a point given twice the first stays; where the files are of
    different grids, both must be the same. InputError if a file is no result, was made for something else or
    has points in its journal, or if the grids make up no larger one; EnvironmentIncomplete where the disk
    refuses.
    """
    sources = _opened(paths)
    with disk_refusals(output):
        exchange = Exchange(output)
    try:
        with disk_refusals(output, lambda: "; the shards are untouched"):
            if output.exists():  # it may have appeared while another run had the lock
                sources = _opened([output, *(path for path in paths if not os.path.samefile(output, path))])
            if all(_is_continued(sources[0], source) for source in sources):
                return _merge(exchange, sources, planner)
            return _join(exchange, joint_of(sources, planner))
    finally:
        exchange.close()


def _merge(exchange: Exchange, sources: Sequence[Header], planner: Planner) -> Merged:
    """Exchanges the file for the first source with the points that the others add."""
    first = sources[0]
    plan = planner(config_of(first.config), parameters_of(first.path, first.layout))
    with exchange.replacing(first.path) as copy:
        gave = [first]
        for source in sources[1:]:
            if write_points(copy, points_to_add(copy, source.path, first.layout), first.layout):
                gave.append(source)
        return _finished(copy, plan, gave)


def _join(exchange: Exchange, joint: Joint) -> Merged:
    """Exchanges the file for one with the points of all files."""
    with exchange.replacing(None) as copy:
        create_file(copy, joint.plan)
        gave = joint.write(copy)
        return _finished(copy, joint.plan, gave or joint.sources[:1])


def _finished(copy: Path, plan: Plan, gave: Sequence[Header]) -> Merged:
    """Notes in the merged file by whom its points were computed; a whole one gets what they all give."""
    left = missing_ranges(copy)
    finished = not left and not plan.layout.needs_all_points
    history = merged_history([source.attributes for source in gave])
    with h5py.File(copy, "r+") as file:
        if finished and "finished" not in file.attrs:
            add_variables(file, plan.afterwards(file))
            file.attrs["finished"] = now()
        file.attrs.update(history)
        points = file["status"].size
    return Merged(points - total(left), total(left), finished, kernels_sentence(history[KERNELS]))


def _opened(paths: Sequence[Path]) -> list[Header]:
    """The files, each with all of its points in it; else InputError."""
    files = []
    for path in paths:
        files.append(read_header(path))
        if any(journal_directory(path).glob(JOURNALS)):
            raise InputError(
                f"{path} has points in its journal that are not in it yet: run its command again first"
            )
    return files


def _is_continued(first: Header, other: Header) -> bool:
    """Whether two files were made for the same; InputError if yet their variables are not the same."""
    if first.fingerprint != other.fingerprint:
        return False
    if (first.layout.record, first.points) != (other.layout.record, other.points):
        raise InputError(f"{other.path} was written by another version of rodsweep than {first.path}")
    return True
