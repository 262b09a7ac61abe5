"""Shards of a run put together: the points of several result files of one config, in one file.

Streamed a block of points at a time, so that memory does not grow with the files; the new file
appears whole, by a rename.
"""

import json
import os
import shutil
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import h5py
import numpy as np

from ...errors import EnvironmentLacks, InputError
from ..layouts import layout_of
from ..layouts.variables import MISSING, Layout
from ..run.journal import journal_directory
from ..run.lock import Lock
from .kernels import KERNELS, kernels_of, told, united
from .provenance import LONGEST_ATTRIBUTE, MOST_RANKS_TOLD, now
from .replacing import replace_whole
from .seal import check
from .store import difference
from .view import DAMAGES, damaged, refuse_misfit

BLOCK = 1 << 16
"""Points taken together."""


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
    """A result file as merging sees it: every variable in one piece of the file."""

    path: Path
    attributes: dict[str, Any]
    layout: Layout
    pieces: dict[str, tuple[int, np.dtype, int]]
    """Offset, type of a value, and values a point, of every variable."""
    points: int


def merge(output: Path, paths: Sequence[Path]) -> Merged:
    """Writes `output` from all points of the result files `paths`; of a point given twice the first stays.

    An existing `output` of the same config is the first of them. InputError if a file is no result, answers
    another config or has points in its journal; EnvironmentLacks where the disk refuses.
    """
    sources = _opened(paths)
    directory = journal_directory(output)
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
        lock = Lock(directory, output)
    except OSError as error:
        raise EnvironmentLacks(f"{output} cannot be written: {error.strerror or error}") from error
    copy = directory / "next.h5"
    try:
        if output.exists():  # it may have appeared while another run had the lock
            sources = _opened([output, *(path for path in paths if not os.path.samefile(output, path))])
        copy.unlink(missing_ok=True)  # it may be a link
        shutil.copyfile(sources[0].path, copy)
        with copy.open("r+b") as target:
            gave = [sources[0]] + [s for s in sources[1:] if _take_over(target, sources[0], s)]
        missing = _missing(copy, sources[0])
        finished = not missing and not sources[0].layout.needs_all_points
        with h5py.File(copy, "r+") as file:
            history = _history(gave)
            file.attrs.update(history)
            if finished:
                file.attrs["finished"] = now()
        replace_whole(copy, output)
    except (OSError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or str(error).splitlines()[0]
        raise EnvironmentLacks(f"{output} cannot be written: {reason}; the shards are untouched") from error
    finally:
        with suppress(OSError):
            copy.unlink()
        lock.release()
    return Merged(sources[0].points - missing, missing, finished, told(history[KERNELS]))


def _opened(paths: Sequence[Path]) -> list[Source]:
    """Sources of one and the same config; InputError if they are not."""
    sources = [open_source(path) for path in paths]
    for source in sources[1:]:
        _refuse_others(sources[0], source)
    return sources


def open_source(path: Path) -> Source:
    """What is needed to read a result file's points; InputError if it is none, or is not folded."""
    if not path.is_file():
        raise InputError(f"{path} is not a file" if path.exists() else f"{path} does not exist")
    try:
        check(path, values=True)
        with h5py.File(path, "r") as file:
            attributes = dict(file.attrs)
            layout = layout_of(json.loads(attributes["config_resolved"]))
            refuse_misfit(file, layout)
            points = file["status"].size
            pieces = {}
            for variable in layout.variables:
                data = file[variable.name]
                pieces[variable.name] = (data.id.get_offset(), data.dtype, data.size // max(points, 1))
            attributes["fingerprint"]  # KeyError where there is none
    except DAMAGES as error:
        raise damaged(path, error) from None
    if any(journal_directory(path).glob("rank-*")):
        raise InputError(
            f"{path} has points in its journal that are not in it yet: run its command again first"
        )
    return Source(path, attributes, layout, pieces, points)


def _refuse_others(first: Source, other: Source) -> None:
    """InputError unless two files answer the same config on the same points, with the same variables."""
    if first.attributes["fingerprint"] != other.attributes["fingerprint"]:
        configs = (json.loads(s.attributes["config_resolved"]) for s in (first, other))
        change = difference(*configs) or "the points listed in parameters.points differ"
        raise InputError(f"{other.path} was made from another config than {first.path} ({change})")
    shapes = [{name: piece[1:] for name, piece in source.pieces.items()} for source in (first, other)]
    if shapes[0] != shapes[1]:
        raise InputError(f"{other.path} was written by another version of rodsweep than {first.path}")


def _history(sources: Sequence[Source]) -> dict[str, Any]:
    """Attributes that say by whom the points of these sources were computed."""
    kernels = united(*(kernels_of(source.attributes) for source in sources))[:LONGEST_ATTRIBUTE]
    have = [s.attributes for s in sources if "ranks" in s.attributes]
    if not have:
        return {"shard": "", KERNELS: kernels}
    hosts = {host for a in have for host in str(a.get("hosts", "")).split()}
    history = {
        "shard": "",
        KERNELS: kernels,
        "stopped": "",
        "ranks": sum(int(a["ranks"]) for a in have),
        "hosts": " ".join(sorted(hosts))[:LONGEST_ATTRIBUTE],
        "started": min(str(a["started"]) for a in have),
    }
    for name in ("rank_points", "rank_busy_seconds", "rank_idle_seconds"):
        values = [np.atleast_1d(a[name]) for a in have if name in a]
        history |= {name: np.concatenate(values)[:MOST_RANKS_TOLD]} if values else {}
    return history


def _values(stream: BinaryIO, source: Source, name: str, start: int, stop: int) -> np.ndarray:
    """The values of a variable at the points from start to stop, shape (points, values a point)."""
    offset, kind, each = source.pieces[name]
    stream.seek(offset + start * each * kind.itemsize)
    return np.fromfile(stream, kind, (stop - start) * each).reshape(stop - start, each)


def _blocks(points: int) -> Iterator[tuple[int, int]]:
    for start in range(0, points, BLOCK):
        yield start, min(start + BLOCK, points)


def _take_over(target: BinaryIO, first: Source, source: Source) -> bool:
    """Writes into `target`, which is laid out like `first`, the points of `source` that it misses, if any."""
    any_wanted = False
    with source.path.open("rb") as stream:
        for start, stop in _blocks(first.points):
            theirs = _values(stream, source, "status", start, stop)[:, 0] != MISSING
            wanted = theirs & (_values(target, first, "status", start, stop)[:, 0] == MISSING)
            if not wanted.any():
                continue
            any_wanted = True
            for name, (offset, kind, each) in first.pieces.items():
                values = _values(target, first, name, start, stop)
                values[wanted] = _values(stream, source, name, start, stop)[wanted]
                target.seek(offset + start * each * kind.itemsize)
                target.write(values.data)
    return any_wanted


def _missing(path: Path, laid_out: Source) -> int:
    with path.open("rb") as stream:
        return sum(
            int((_values(stream, laid_out, "status", *block) == MISSING).sum())
            for block in _blocks(laid_out.points)
        )
