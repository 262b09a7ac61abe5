"""Journals: finished points on disk at once, in an append-only file per rank beside the result file.

The records of a point, or of a stretch of points solved at once, are written by a single call. A kill at any
instant therefore loses only the points in progress. Every record carries a checksum, which reveals a torn
tail.
"""

import os
import shutil
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from ..layouts.variables import Layout

JOURNALS = "rank-*"
"""Pattern of the names of journals."""
JOURNAL_HEAD = b"rodsweep journal 1\n"
"""First line of a journal; the second line is its fingerprint."""
BYTES_A_BLOCK = 1 << 18
"""Bytes read at once, to bound the memory."""
LONGEST_HEAD = 200
"""Largest length of each of the two first lines of a journal, in bytes."""


def journal_directory(file: Path) -> Path:
    """Directory of the journals of a result file."""
    return file.parent / f"{file.name}.journal"


class Journal:
    """Journal of one rank, open for appending."""

    def __init__(self, directory: Path, rank: int, layout: Layout, fingerprint: str):
        self.page = np.zeros((), layout.record)
        self.names = tuple(variable.name for variable in layout.variables)
        self.directory = directory
        self.name = f"rank-{rank:06d}-{os.getpid()}"
        self._create()
        self._write(_head(fingerprint))
        self.head = len(_head(fingerprint))

    def append(self, index: int, values: dict) -> None:
        """Writes the record of a finished point; `values` has every variable."""
        # One assignment, because assigning single fields takes three times as long.
        self.page[()] = (index, *(values[name] for name in self.names))
        data = self.page.tobytes()
        self._write(data + zlib.crc32(data).to_bytes(4, "little"))

    def append_all(self, index: np.ndarray, values: dict[str, np.ndarray]) -> None:
        """Writes the records of finished points: index, (n,), and every variable in `values`, (n, ...)."""
        records = np.zeros(len(index), self.page.dtype)
        records["index"] = index
        for name in self.names:
            records[name] = values[name]
        data = records.tobytes()
        size = records.itemsize
        parts = (data[at : at + size] for at in range(0, len(data), size))
        self._write(b"".join(part + zlib.crc32(part).to_bytes(4, "little") for part in parts))

    def close(self) -> None:
        """Syncs the journal to disk, written again if it was moved; deletes it if it has no points."""
        empty = os.fstat(self.handle).st_size == self.head
        if not empty and not self._is_in_place():
            self._write_anew()
        os.fsync(self.handle)
        os.close(self.handle)
        if empty:
            self.path.unlink(missing_ok=True)

    def _is_in_place(self) -> bool:
        """Whether the path of the journal still is the file that is open."""
        try:
            return os.path.samestat(os.stat(self.path), os.fstat(self.handle))
        except OSError:
            return False

    def _create(self) -> None:
        """Creates the file, under a new name."""
        self.directory.mkdir(parents=True, exist_ok=True)
        self.path = self.directory / f"{self.name}-{os.urandom(4).hex()}"
        self.handle = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_APPEND, 0o644)

    def _write_anew(self) -> None:
        """Writes the whole journal again at its place; an open file can be read even without a name."""
        former = self.handle
        at = 0
        self._create()
        while block := os.pread(former, BYTES_A_BLOCK, at):
            self._write(block)
            at += len(block)
        os.close(former)

    def _write(self, data: bytes) -> None:
        """Writes all bytes; a single call of the system may write only a part."""
        while data:
            data = data[os.write(self.handle, data) :]


def drop_files(directory: Path, pattern: str) -> None:
    """Deletes the files of a directory whose names match."""
    for path in directory.glob(pattern):
        if not path.is_dir():
            path.unlink()


def journals_of(directory: Path, fingerprint: str) -> list[Path]:
    """Journals in a directory with points of the given fingerprint."""
    return [path for path in sorted(directory.glob(JOURNALS)) if _points_of(path) == _head(fingerprint)]


def other_journals(directory: Path, fingerprint: str) -> list[Path]:
    """Journals in a directory with points of other fingerprints, or with a damaged head."""
    known = (b"", _head(fingerprint))
    return [path for path in sorted(directory.glob(JOURNALS)) if _points_of(path) not in known]


def set_aside(directory: Path, paths: Iterable[Path]) -> Path:
    """Moves files from a journal directory into a new directory, which is returned."""
    number = 1
    while os.path.lexists(kept := directory.with_name(f"{directory.name}-{number}")):
        number += 1
    kept.mkdir()
    for path in paths:
        shutil.move(path, kept / path.name)
    return kept


def kept_sentence(directory: Path, fingerprint: str) -> str:
    """Clause of a refusal: the journals with points of the given fingerprint; empty without points."""
    return f"; what is done is kept in {directory}" if journals_of(directory, fingerprint) else ""


def _head(fingerprint: str) -> bytes:
    """First two lines of a journal."""
    return JOURNAL_HEAD + fingerprint.encode() + b"\n"


def _points_of(path: Path) -> bytes:
    """Head of a journal with points; empty for any other file."""
    if not path.is_file():
        return b""
    with path.open("rb") as file:
        head = b"".join(file.readline(LONGEST_HEAD) for _ in range(2))
        return head if file.read(1) else b""


def read_journals(
    directory: Path, layout: Layout, fingerprint: str, points: int = 2**62
) -> Iterator[np.ndarray]:
    """Yields intact records, (records,), of a run's points from all of its journals in a directory."""
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
