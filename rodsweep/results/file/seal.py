"""The seal of a result file: checksums of all its bytes, written after HDF5's own end.

HDF5 believes what it reads: a flipped bit gives another number and, in its own structures, an endless loop
or a crash. So a file is sealed before it takes its name, and is opened only where the seal fits. HDF5 and
netCDF do not see the seal; a program that changes the file by them takes it off, which is then no fault.
"""

import json
import os
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import h5py

SEAL_HEAD = b"\nrodsweep seal 1 "
HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
END_AT = {0: 40, 1: 44, 2: 28, 3: 28}
"""Where the superblock of each version has the end of the file, in eight bytes."""
LONGEST_SEAL = 100_000
"""Bytes of a seal."""
BYTES_A_READ = 1 << 20

Piece = tuple[int, int]


class BrokenSeal(ValueError):
    """Why a file is not as it was written, as the rest of a sentence."""


def seal(path: Path) -> None:
    """Puts a new seal on a closed file."""
    with path.open("r+b") as stream:
        end = _end(stream)
        stream.truncate(end)
    pieces = _values(path)
    with path.open("r+b") as stream:
        sums = {"frame": _checksum(stream, _between(pieces, end)), "values": _checksum(stream, pieces)}
        stream.seek(end)
        stream.write(SEAL_HEAD + json.dumps({"end": end, "pieces": pieces} | sums).encode() + b"\n")


def check_seal(path: Path, values: bool) -> None:
    """BrokenSeal unless the file, with the numbers in it if `values`, is as it was sealed; or OSError.

    The numbers take a second for each GB, the rest a millisecond.
    """
    with path.open("rb") as stream:
        end, size = _end(stream), os.fstat(stream.fileno()).st_size
        if size < end:
            raise BrokenSeal(f"it ends after {size} of {end} bytes")
        if size == end:
            return
        stream.seek(end)
        data = stream.read(LONGEST_SEAL)
        if not data.startswith(SEAL_HEAD) or not data.endswith(b"\n"):
            raise BrokenSeal("its checksum cannot be read")
        try:
            given = json.loads(data[len(SEAL_HEAD) :])
        except (ValueError, RecursionError):
            raise BrokenSeal("its checksum cannot be read") from None
        try:
            pieces = [(int(start), int(length)) for start, length in given["pieces"]]
            whole = given["end"] == end and given["frame"] == _checksum(stream, _between(pieces, end))
            whole = whole and not (values and given["values"] != _checksum(stream, pieces))
        except (KeyError, TypeError, ValueError, OverflowError, OSError):
            whole = False
    if not whole:
        raise BrokenSeal("its content does not fit its checksum")


def _end(stream: BinaryIO) -> int:
    """Where HDF5 says that the file ends."""
    head = stream.read(64)
    if not head.startswith(HDF5_SIGNATURE) or len(head) < 64 or head[8] not in END_AT:
        raise BrokenSeal("it is not HDF5")
    at = END_AT[head[8]]
    return int.from_bytes(head[at : at + 8], "little")


def _values(path: Path) -> list[Piece]:
    """(start, bytes) of all numbers that lie in one piece each, in order."""
    with h5py.File(path, "r") as file:
        variables = [data for data in map(file.get, file) if isinstance(data, h5py.Dataset)]
        places = {(data.id.get_offset(), data.id.get_storage_size()) for data in variables}
    return sorted((start, size) for start, size in places if start is not None and size)


def _between(pieces: list[Piece], end: int) -> Iterator[Piece]:
    """What lies before, between and behind the pieces."""
    at = 0
    for start, size in [*pieces, (end, 0)]:
        if not 0 <= at <= start <= end:
            raise BrokenSeal("its checksum cannot be read")
        yield at, start - at
        at = start + size


def _checksum(stream: BinaryIO, pieces: Iterator[Piece] | list[Piece]) -> int:
    """The CRC-32 of pieces of a file, one after another."""
    checksum = 0
    for start, size in pieces:
        stream.seek(start)
        left = size
        while left and (block := stream.read(min(left, BYTES_A_READ))):
            checksum = zlib.crc32(block, checksum)
            left -= len(block)
    return checksum
