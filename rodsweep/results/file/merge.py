"""Shards of a run put together: the points of several result files of one config, in one file.

Streamed a block of points at a time, so that memory does not grow with the files; the new file
appears whole, by a rename.
"""

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py

from ...errors import InputError
from ...sweep.ranges import total
from ..layouts import layout_of
from ..layouts.variables import Layout
from ..run.journal import journal_directory
from .exchange import Exchange, disk_refusals
from .points import missing_ranges, points_to_add, write_points
from .provenance import KERNELS, kernels_sentence, merged_history, now
from .seal import check
from .validation import change_between, need_file, reading, refuse_misfit


@dataclass(frozen=True, slots=True)
class Merged:
    """What came of a merge: points in the file, those still missing, whether nothing else is, and by what."""

    points: int
    missing: int
    finished: bool
    kernels: str
    """What is to be said of the BLAS kernels that computed the points, where they are several; else empty."""


@dataclass(frozen=True, slots=True)
class Source:
    """A result file that is merged."""

    path: Path
    attributes: dict[str, Any]
    config: dict[str, Any]
    layout: Layout
    points: int


def merge(output: Path, paths: Sequence[Path], needs_more: Callable[[dict[str, Any]], bool]) -> Merged:
    """Writes `output` from all points of the result files `paths`; of a point given twice the first stays.

    An existing `output` of the same config is the first of them. needs_more: whether a resolved config asks
    for what only all points together give. InputError if a file is no result, answers another config or has
    points in its journal; EnvironmentLacks where the disk refuses.
    """
    sources = _opened(paths)
    with disk_refusals(output):
        exchange = Exchange(output)
    try:
        with disk_refusals(output, "; the shards are untouched"):
            if output.exists():  # it may have appeared while another run had the lock
                sources = _opened([output, *(path for path in paths if not os.path.samefile(output, path))])
            return _merge(exchange, sources, needs_more)
    finally:
        exchange.close()


def _merge(
    exchange: Exchange, sources: Sequence[Source], needs_more: Callable[[dict[str, Any]], bool]
) -> Merged:
    """Exchanges the file for the first source with the points that the others add."""
    first = sources[0]
    with exchange.replacing(first.path) as copy:
        gave = [first]
        for source in sources[1:]:
            if write_points(copy, points_to_add(copy, source.path, first.layout), first.layout):
                gave.append(source)
        missing = total(missing_ranges(copy))
        finished = not missing and not needs_more(first.config)
        history = merged_history([source.attributes for source in gave])
        with h5py.File(copy, "r+") as file:
            file.attrs.update(history | ({"finished": now()} if finished else {}))
    return Merged(first.points - missing, missing, finished, kernels_sentence(history[KERNELS]))


def _opened(paths: Sequence[Path]) -> list[Source]:
    """Sources of one and the same config; InputError if they are not."""
    sources = [_open_source(path) for path in paths]
    for source in sources[1:]:
        _refuse_others(sources[0], source)
    return sources


def _open_source(path: Path) -> Source:
    """What is needed to read a result file's points; InputError if it is none, or is not folded."""
    need_file(path)
    with reading(path):
        check(path, values=True)
        with h5py.File(path, "r") as file:
            attributes = dict(file.attrs)
            config = json.loads(attributes["config_resolved"])
            layout = layout_of(config)
            refuse_misfit(file, layout)
            points = file["status"].size
            attributes["fingerprint"]  # KeyError where there is none
    if any(journal_directory(path).glob("rank-*")):
        raise InputError(
            f"{path} has points in its journal that are not in it yet: run its command again first"
        )
    return Source(path, attributes, config, layout, points)


def _refuse_others(first: Source, other: Source) -> None:
    """InputError unless two files answer the same config on the same points, with the same variables."""
    if first.attributes["fingerprint"] != other.attributes["fingerprint"]:
        change = change_between(first.config, other.config)
        raise InputError(f"{other.path} was made from another config than {first.path} ({change})")
    if (first.layout.record, first.points) != (other.layout.record, other.points):
        raise InputError(f"{other.path} was written by another version of rodsweep than {first.path}")
