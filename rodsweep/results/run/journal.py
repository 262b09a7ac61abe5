"""Journals: append-only files next to the result file, one per rank, to which finished points go at once.

The records of a point, or of a group of points, are written by a single call. A kill at any instant
therefore loses only the points in progress. Every record has a checksum, which reveals an incomplete record.
Reasons why points failed are written by the same call, as text in records with a negative index.
"""

import os
import shutil
import zlib
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np

from ..layouts.variables import Layout

JOURNAL_GLOB = "rank-*"
"""Pattern of the file names of journals."""
JOURNAL_HEAD = b"rodsweep journal 1\n"
"""First line of a journal. The second line is the fingerprint of config and points."""
BYTES_PER_READ = 1 << 18
"""Number of bytes per read of a journal, which bounds the memory."""
TEXT_CONTINUES, TEXT_ENDS = -2, -1
"""Values of the index field in records of text: for the last record of a line TEXT_ENDS, for earlier records
of the line TEXT_CONTINUES."""
CHECKSUM_BYTES = 4
"""Length of the checksum after a record, in bytes."""
POINT_INDEX_BYTES = 8
"""Length of the index, the first field of a record, in bytes."""
MAX_HEAD_BYTES = 200
"""Maximum length of each of the first two lines of a journal, in bytes."""


def journal_directory(file: Path) -> Path:
    """Path of the directory with the journals of the result file `file`."""
    return file.parent / f"{file.name}.journal"


class Journal:
    """Journal of one rank, open for appending."""

    def __init__(self, directory: Path, rank: int, layout: Layout, fingerprint: str):
        self.record = np.zeros((), layout.record_dtype)
        """Record of a point, of the layout's NumPy type, reused for every point."""
        self.variable_names = tuple(variable.name for variable in layout.variables)
        self.directory = directory
        # A killed run may live on for a moment, so a restarted one must not write to its files.
        self.name = f"rank-{rank:06d}-{os.getpid()}"
        self._create()
        self._write(_journal_header(fingerprint))
        self.header_size = len(_journal_header(fingerprint))
        """Length of the header of the file, in bytes."""

    def append(self, index: int, values: dict, reasons: Sequence[str] = ()) -> None:
        """Writes the record of the finished point at a flat index; values: every variable by name.

        reasons: lines that say why points failed, for `read_failure_reasons`.
        """
        # One assignment, because assigning single fields takes three times as long.
        self.record[()] = (index, *(values[name] for name in self.variable_names))
        # One call for all, so that a kill mostly leaves whole records behind.
        self._write(b"".join(map(with_checksum, (*self._text_records(reasons), self.record.tobytes()))))

    def append_all(
        self, index: np.ndarray, values: dict[str, np.ndarray], reasons: Sequence[str] = ()
    ) -> None:
        """Writes the records of finished points: flat indices `index`, (n,), and `values` of all variables by
        name, (n, ...). reasons: as for `append`."""
        records: np.ndarray = np.zeros(len(index), self.record.dtype)
        records["index"] = index
        for name in self.variable_names:
            records[name] = values[name]
        data = records.tobytes()
        size = records.itemsize
        chunks = (data[offset : offset + size] for offset in range(0, len(data), size))
        self._write(b"".join(map(with_checksum, (*self._text_records(reasons), *chunks))))

    def _text_records(self, lines: Sequence[str]) -> Iterator[bytes]:
        """Yields records that hold lines of text instead of the values of a point."""
        chunk_bytes = self.record.itemsize - POINT_INDEX_BYTES
        for line in lines:
            # Text has the length of other records, so that readers need no table of positions.
            text = line.encode()
            chunks = [text[offset : offset + chunk_bytes] for offset in range(0, len(text), chunk_bytes)]
            for number, chunk in enumerate(chunks, 1):
                index = TEXT_ENDS if number == len(chunks) else TEXT_CONTINUES
                index_bytes = index.to_bytes(POINT_INDEX_BYTES, "little", signed=True)
                yield index_bytes + chunk.ljust(chunk_bytes, b"\0")

    def close(self) -> None:
        """Syncs the journal to disk and closes the file; deletes the file if the journal has no points.

        If the file was moved or deleted, the journal is written again first.
        """
        empty = os.fstat(self.handle).st_size == self.header_size
        # A user may have moved or deleted the directory during the run; the open file still has all points.
        if not empty and not self._is_in_place():
            self._copy_to_new_journal()
        # Only here: a synchronous write for each point would take longer than many solves.
        os.fsync(self.handle)
        os.close(self.handle)
        if empty:
            self.path.unlink(missing_ok=True)

    def _is_in_place(self) -> bool:
        """Whether the open file is still at the path of the journal."""
        try:
            return os.path.samestat(os.stat(self.path), os.fstat(self.handle))
        except OSError:
            return False

    def _create(self) -> None:
        """Creates the file of the journal, under a new name."""
        self.directory.mkdir(parents=True, exist_ok=True)
        self.path = self.directory / f"{self.name}-{os.urandom(4).hex()}"
        self.handle = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_APPEND, 0o644)

    def _copy_to_new_journal(self) -> None:
        """Copies the open journal, which may have lost its name, to a new file in the journal directory."""
        old_handle = self.handle
        position = 0
        self._create()
        while block := os.pread(old_handle, BYTES_PER_READ, position):
            self._write(block)
            position += len(block)
        os.close(old_handle)

    def _write(self, data: bytes) -> None:
        """Writes all bytes of `data`; a single system call may write fewer."""
        while data:
            data = data[os.write(self.handle, data) :]


def delete_matching_files(directory: Path, pattern: str) -> None:
    """Deletes the files in a directory whose names match `pattern`."""
    for path in directory.glob(pattern):
        if not path.is_dir():
            path.unlink()


def journals_with_fingerprint(directory: Path, fingerprint: str) -> list[Path]:
    """Paths of the journals in a directory that have points and this fingerprint."""
    header = _journal_header(fingerprint)
    paths = sorted(directory.glob(JOURNAL_GLOB))
    return [path for path in paths if _header_of_journal_with_points(path) == header]


def journals_without_fingerprint(directory: Path, fingerprint: str) -> list[Path]:
    """Paths of the journals in a directory that have points and another fingerprint or a damaged head."""
    headers = (b"", _journal_header(fingerprint))
    paths = sorted(directory.glob(JOURNAL_GLOB))
    return [path for path in paths if _header_of_journal_with_points(path) not in headers]


def move_journals_aside(directory: Path, paths: Iterable[Path]) -> Path:
    """Moves the files `paths` from the journal directory into a new directory next to the journal directory;
    returns the new directory."""
    number = 1
    while os.path.lexists(new_directory := directory.with_name(f"{directory.name}-{number}")):
        number += 1
    new_directory.mkdir()
    for path in paths:
        shutil.move(path, new_directory / path.name)
    return new_directory


def kept_points_clause(directory: Path, fingerprint: str) -> str:
    """Clause that names the directory of journals with finished points; empty if no such journal exists."""
    has_points = journals_with_fingerprint(directory, fingerprint)
    return f"; finished points are kept in {directory}" if has_points else ""


def _journal_header(fingerprint: str) -> bytes:
    """First two lines of a journal with this fingerprint."""
    return JOURNAL_HEAD + fingerprint.encode() + b"\n"


def _header_of_journal_with_points(path: Path) -> bytes:
    """First two lines of a journal that has points; empty for any other file."""
    if not path.is_file():
        return b""
    with path.open("rb") as file:
        header = b"".join(file.readline(MAX_HEAD_BYTES) for _ in range(2))
        return header if file.read(1) else b""


def with_checksum(record: bytes) -> bytes:
    """The bytes of a record followed by their checksum."""
    return record + zlib.crc32(record).to_bytes(CHECKSUM_BYTES, "little")


def read_journals(
    directory: Path, layout: Layout, fingerprint: str, point_count: int = 2**62
) -> Iterator[np.ndarray]:
    """Yields intact records, (records,), of points from all journals with this fingerprint in a directory.

    point_count: number of points of the sweep; records with a larger index are left out.
    """
    for path in journals_with_fingerprint(directory, fingerprint):
        for rows in _record_rows(path, layout, fingerprint):
            intact = np.ascontiguousarray(rows[_has_valid_checksum(rows), :-CHECKSUM_BYTES])
            records = intact.view(layout.record_dtype).ravel()
            yield records[(records["index"] >= 0) & (records["index"] < point_count)]


def read_failure_reasons(directory: Path, layout: Layout, fingerprint: str) -> list[str]:
    """Lines with the reasons why points failed, from all journals with this fingerprint in a directory."""
    return [
        line
        for path in journals_with_fingerprint(directory, fingerprint)
        for line in _complete_text_lines(_record_rows(path, layout, fingerprint))
    ]


def _complete_text_lines(blocks: Iterable[np.ndarray]) -> Iterator[str]:
    """Yields the lines of text in a journal, without text between a damaged record, which may be part of it,
    and the next intact point or end of a line. blocks: rows of bytes of `_record_rows`, (records, bytes)."""
    line = b""
    is_intact = True
    for rows in blocks:
        fields = [("index", "<i8"), ("text", f"S{rows.shape[1] - POINT_INDEX_BYTES - CHECKSUM_BYTES}")]
        records = np.ascontiguousarray(rows[:, :-CHECKSUM_BYTES]).view(fields).ravel().tolist()
        for (index, text), is_valid in zip(records, _has_valid_checksum(rows), strict=True):
            line += text
            if is_valid and index == TEXT_CONTINUES:
                continue
            if is_valid and index == TEXT_ENDS and is_intact:
                yield line.decode()
            line = b""
            is_intact = is_valid


def _record_rows(path: Path, layout: Layout, fingerprint: str) -> Iterator[np.ndarray]:
    """Yields blocks of whole records of a journal with checksums, (records, bytes), one in each row."""
    size = layout.record_dtype.itemsize + CHECKSUM_BYTES
    with path.open("rb") as file:
        file.seek(len(_journal_header(fingerprint)))
        while block := file.read(max(1, BYTES_PER_READ // size) * size):
            byte_array = np.frombuffer(block, np.uint8)
            # The last record may be cut off by a kill.
            yield byte_array[: len(byte_array) // size * size].reshape(-1, size)


def _has_valid_checksum(rows: np.ndarray) -> np.ndarray:
    """Whether the checksum at the end of each record is correct, (records,). rows: records as bytes,
    (records, bytes)."""
    sums = np.ascontiguousarray(rows[:, -CHECKSUM_BYTES:]).view("<u4").ravel()
    checksums = np.array([zlib.crc32(row[:-CHECKSUM_BYTES].data) for row in rows], dtype=np.uint32)
    return np.asarray(checksums == sums)
