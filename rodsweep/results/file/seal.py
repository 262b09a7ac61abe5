"""The seal of a result file, in two parts: of its content, and of its bytes.

The attribute `seal` has a digest of every variable and attribute (`rodsweep.results.file.content`), by which
a change is noticed whichever program made it. Behind HDF5's own end, where other programs do not see it, lies
a checksum of HDF5's structures: a flipped bit in those is an endless loop or a crash of HDF5, so they are
compared before HDF5 reads the file. A program that changes the file by HDF5 takes this checksum off.
"""

import json
import os
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import h5py

from .content import SEAL, digests_of

FRAME_HEAD = b"\nrodsweep seal 2 "
FORMER_HEAD = b"\nrodsweep seal 1 "
"""Of files of format 4 and before, which are refused by their format."""
HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
END_AT = {0: 40, 1: 44, 2: 28, 3: 28}
"""Where the superblock of each version has the end of the file, in eight bytes."""
LONGEST_FRAME = 100_000
"""Bytes of the checksum with the places of the numbers that it leaves out."""
BYTES_A_READ = 1 << 20
SMALL = 1 << 16
"""Bytes of a variable up to which the frame has its numbers too: axes, and what is read at every look."""

Piece = tuple[int, int]


class BrokenSeal(ValueError):
    """Why a file is not as it was written, as the rest of a sentence."""


def seal(path: Path) -> None:
    """Puts new seals on a closed file that rodsweep has just written."""
    with h5py.File(path, "r+") as file:
        file.attrs[SEAL] = json.dumps(digests_of(file))
    with h5py.File(path, "r") as file:
        pieces = _large_pieces(file)
    with path.open("r+b") as stream:
        end = _end(stream)
        stream.truncate(end)
        frame = {"end": end, "pieces": pieces, "frame": _checksum(stream, _between(pieces, end))}
        stream.seek(end)
        stream.write(FRAME_HEAD + json.dumps(frame).encode() + b"\n")


def check_frame(path: Path) -> bool:
    """Whether HDF5's structures are as they were sealed; False where another program took the checksum off.

    BrokenSeal where they are not, or OSError. Takes a millisecond.
    """
    with path.open("rb") as stream:
        end, size = _end(stream), os.fstat(stream.fileno()).st_size
        if size < end:
            raise BrokenSeal(f"it ends after {size} of {end} bytes")
        stream.seek(end)
        data = stream.read(LONGEST_FRAME)
        if not data or data.startswith(FORMER_HEAD):
            return False
        if not data.startswith(FRAME_HEAD) or not data.endswith(b"\n"):
            raise BrokenSeal("its checksum cannot be read")
        try:
            given = json.loads(data[len(FRAME_HEAD) :])
            pieces = [(int(start), int(length)) for start, length in given["pieces"]]
            whole = given["end"] == end and given["frame"] == _checksum(stream, _between(pieces, end))
        except (LookupError, TypeError, ValueError, OverflowError, RecursionError, OSError):
            raise BrokenSeal("its checksum cannot be read") from None
    if not whole:
        raise BrokenSeal("its content does not fit its checksum")
    return True


def _end(stream: BinaryIO) -> int:
    """Where HDF5 says that the file ends."""
    stream.seek(0)
    head = stream.read(64)
    if not head.startswith(HDF5_SIGNATURE) or len(head) < 64 or head[8] not in END_AT:
        raise BrokenSeal("it is not HDF5")
    at = END_AT[head[8]]
    return int.from_bytes(head[at : at + 8], "little")


def _large_pieces(file: h5py.File) -> list[Piece]:
    """(start, bytes) of the numbers of every variable that lies in one large piece, in order."""
    variables = [data for data in map(file.get, file) if isinstance(data, h5py.Dataset)]
    places = {(data.id.get_offset(), data.id.get_storage_size()) for data in variables}
    return sorted((start, size) for start, size in places if start is not None and size > SMALL)


def _between(pieces: list[Piece], end: int) -> Iterator[Piece]:
    """What lies before, between and behind the pieces."""
    at = 0
    for start, size in [*pieces, (end, 0)]:
        if not 0 <= at <= start <= end:
            raise BrokenSeal("its checksum cannot be read")
        yield at, start - at
        at = start + size


def _checksum(stream: BinaryIO, pieces: Iterator[Piece]) -> int:
    """The CRC-32 of pieces of a file, one after another."""
    checksum = 0
    for start, size in pieces:
        stream.seek(start)
        left = size
        while left and (block := stream.read(min(left, BYTES_A_READ))):
            checksum = zlib.crc32(block, checksum)
            left -= len(block)
    return checksum
