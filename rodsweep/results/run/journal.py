"""Finished points on disk at once: one append-only file per rank beside the result file.

The records of what is solved together, a point or a stretch of them, are written by a single call when it
is done, so that killing a rank, or all of them, at any instant loses only the points in flight. Every record
carries a checksum; a torn tail is recognised and dropped.
"""

import os
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ..layouts.variables import Layout

JOURNALS = "rank-*"
JOURNAL_HEAD = b"rodsweep journal 1\n"
BYTES_A_BLOCK = 1 << 18


def journal_directory(file: Path) -> Path:
    """Where the journals of a result file are kept until their points are in the file."""
    return file.with_name(file.name + ".journal")


class Journal:
    """The journal of one rank, open for appending."""

    def __init__(self, directory: Path, rank: int, layout: Layout, fingerprint: str):
        self.page = np.zeros((), layout.record)
        self.names = tuple(variable.name for variable in layout.variables)
        name = f"rank-{rank:06d}-{os.getpid()}-{os.urandom(4).hex()}"
        self.handle = os.open(directory / name, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND, 0o644)
        self._write(JOURNAL_HEAD + fingerprint.encode() + b"\n")

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
        """Puts everything on the disk proper."""
        os.fsync(self.handle)
        os.close(self.handle)

    def _write(self, data: bytes) -> None:
        while data:
            data = data[os.write(self.handle, data) :]


def drop_files(directory: Path, pattern: str) -> None:
    """Removes the files of a directory whose names fit."""
    for path in directory.glob(pattern):
        if not path.is_dir():
            path.unlink()


def read_journals(
    directory: Path, layout: Layout, fingerprint: str, points: int = 2**62
) -> Iterator[np.ndarray]:
    """The whole records of a run's points in all of its journals in a directory, (records,) at a time."""
    size = layout.record.itemsize
    header = JOURNAL_HEAD + fingerprint.encode() + b"\n"
    for path in sorted(directory.glob(JOURNALS)):
        if not path.is_file():
            continue
        with path.open("rb") as file:
            if file.read(len(header)) != header:
                continue
            while block := file.read(max(1, BYTES_A_BLOCK // (size + 4)) * (size + 4)):
                raw = np.frombuffer(block, np.uint8)
                raw = raw[: len(raw) // (size + 4) * (size + 4)].reshape(-1, size + 4)
                sums = np.ascontiguousarray(raw[:, size:]).view("<u4").ravel()
                whole = np.array([zlib.crc32(row[:size].data) for row in raw], dtype=np.uint32) == sums
                records = np.ascontiguousarray(raw[whole, :size]).view(layout.record).ravel()
                yield records[(records["index"] >= 0) & (records["index"] < points)]
