"""Finished points on disk at once: one append-only file per rank beside the result file.

The records of what is solved together, a point or a stretch of them, are written by a single call when it
is done, so that killing a rank, or all of them, at any instant loses only the points in flight. Every record
carries a checksum; a torn tail is recognised and dropped.
"""

import os
import shutil
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from ..layouts.variables import Layout

JOURNALS = "rank-*"
JOURNAL_HEAD = b"rodsweep journal 1\n"
BYTES_A_BLOCK = 1 << 18
LONGEST_HEAD = 200
"""Bytes of a journal's first two lines: what it is, and the fingerprint of the points in it."""


def journal_directory(file: Path) -> Path:
    """Where the journals of a result file are kept until their points are in the file."""
    return file.parent / f"{file.name}.journal"


class Journal:
    """The journal of one rank, open for appending."""

    def __init__(self, directory: Path, rank: int, layout: Layout, fingerprint: str):
        self.page = np.zeros((), layout.record)
        self.names = tuple(variable.name for variable in layout.variables)
        self.directory, self.name = directory, f"rank-{rank:06d}-{os.getpid()}"
        self._create()
        self._write(_head(fingerprint))
        self.head = len(_head(fingerprint))

    def append(self, index: int, values: dict) -> None:
        """Writes the record of a finished point, of which `values` has every variable."""
        # One assignment, for that of single fields takes three times as long.
        self.page[()] = (index, *(values[name] for name in self.names))
        data = self.page.tobytes()
        self._write(data + zlib.crc32(data).to_bytes(4, "little"))

    def append_all(self, index: np.ndarray, values: dict[str, np.ndarray]) -> None:
        """Writes the records of finished points: index, (n,), and of every variable `values`, (n, ...)."""
        records = np.zeros(len(index), self.page.dtype)
        records["index"] = index
        for name in self.names:
            records[name] = values[name]
        data, size = records.tobytes(), records.itemsize
        parts = (data[at : at + size] for at in range(0, len(data), size))
        self._write(b"".join(part + zlib.crc32(part).to_bytes(4, "little") for part in parts))

    def close(self) -> None:
        """Puts everything on the disk proper; also where the journal was moved or deleted meanwhile.

        A journal without points goes.
        """
        empty = os.fstat(self.handle).st_size == self.head
        if not empty and not self._is_in_place():
            self._write_anew()
        os.fsync(self.handle)
        os.close(self.handle)
        if empty:
            self.path.unlink(missing_ok=True)

    def _is_in_place(self) -> bool:
        """Whether the file of the journal's name is the one that is written."""
        try:
            return os.path.samestat(os.stat(self.path), os.fstat(self.handle))
        except OSError:
            return False

    def _create(self) -> None:
        """Makes the file, under a name that no other has had."""
        self.directory.mkdir(parents=True, exist_ok=True)
        self.path = self.directory / f"{self.name}-{os.urandom(4).hex()}"
        self.handle = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_APPEND, 0o644)

    def _write_anew(self) -> None:
        """Writes the whole journal where it was; what was written can still be read without a name."""
        former, at = self.handle, 0
        self._create()
        while block := os.pread(former, BYTES_A_BLOCK, at):
            self._write(block)
            at += len(block)
        os.close(former)

    def _write(self, data: bytes) -> None:
        while data:
            data = data[os.write(self.handle, data) :]


def drop_files(directory: Path, pattern: str) -> None:
    """Removes the files of a directory whose names fit."""
    for path in directory.glob(pattern):
        if not path.is_dir():
            path.unlink()


def journals_of(directory: Path, fingerprint: str) -> list[Path]:
    """The journals in a directory that have points of this fingerprint."""
    return [path for path in sorted(directory.glob(JOURNALS)) if _points_of(path) == _head(fingerprint)]


def other_journals(directory: Path, fingerprint: str) -> list[Path]:
    """The journals in a directory that have points of other fingerprints, or whose head is damaged."""
    known = (b"", _head(fingerprint))
    return [path for path in sorted(directory.glob(JOURNALS)) if _points_of(path) not in known]


def set_aside(directory: Path, paths: Iterable[Path]) -> Path:
    """Moves files out of a directory of journals into a new one beside it, and returns that."""
    number = 1
    while os.path.lexists(kept := directory.with_name(f"{directory.name}-{number}")):
        number += 1
    kept.mkdir()
    for path in paths:
        shutil.move(path, kept / path.name)
    return kept


def kept_sentence(directory: Path, fingerprint: str) -> str:
    """How a refusal goes on where points of this fingerprint are in the journals; else empty."""
    return f"; what is done is kept in {directory}" if journals_of(directory, fingerprint) else ""


def _head(fingerprint: str) -> bytes:
    """The first lines of a journal."""
    return JOURNAL_HEAD + fingerprint.encode() + b"\n"


def _points_of(path: Path) -> bytes:
    """The head of a journal that has points; empty for any other file."""
    if not path.is_file():
        return b""
    with path.open("rb") as file:
        head = b"".join(file.readline(LONGEST_HEAD) for _ in range(2))
        return head if file.read(1) else b""


def read_journals(
    directory: Path, layout: Layout, fingerprint: str, points: int = 2**62
) -> Iterator[np.ndarray]:
    """The whole records of a run's points in all of its journals in a directory, (records,) at a time."""
    size = layout.record.itemsize
    for path in journals_of(directory, fingerprint):
        with path.open("rb") as file:
            file.seek(len(_head(fingerprint)))
            while block := file.read(max(1, BYTES_A_BLOCK // (size + 4)) * (size + 4)):
                raw = np.frombuffer(block, np.uint8)
                raw = raw[: len(raw) // (size + 4) * (size + 4)].reshape(-1, size + 4)
                sums = np.ascontiguousarray(raw[:, size:]).view("<u4").ravel()
                whole = np.array([zlib.crc32(row[:size].data) for row in raw], dtype=np.uint32) == sums
                records = np.ascontiguousarray(raw[whole, :size]).view(layout.record).ravel()
                yield records[(records["index"] >= 0) & (records["index"] < points)]
