"""Seal of a result file in two parts: digests of the content, and a checksum of the HDF5 structures.

The attribute `seal` has a digest of every variable and attribute (`rodsweep.results.file.content`), and shows
a change by any program. A checksum of HDF5's structures lies behind HDF5's own end of the file, invisible to
other programs. A flipped bit in the structures can make HDF5 loop for ever or crash; the checksum is
therefore compared before HDF5 reads the file. A program that changes the file by HDF5 removes the checksum.
"""

import json
import os
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import h5py

from .content import SEAL_ATTRIBUTE, digests_of

FRAME_HEAD = b"\nrodsweep seal 2 "
"""First bytes of the checksum, behind HDF5's end of the file."""
FORMER_HEAD = b"\nrodsweep seal 1 "
"""First bytes of the checksum in files of format 4 and before, refused by their format."""
HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""First bytes of every HDF5 file."""
END_AT = {0: 40, 1: 44, 2: 28, 3: 28}
"""Offset, by version of the superblock, of the eight bytes with HDF5's end of the file."""
LONGEST_FRAME = 100_000
"""Largest size, in bytes, of the checksum with the places of the numbers left out."""
BYTES_A_READ = 1 << 20
"""Bytes read at once, to bound the memory."""
LARGEST_INCLUDED = 1 << 16
"""Largest size, in bytes, of a variable, such as an axis, whose numbers the checksum includes."""
Piece = tuple[int, int]
"""(offset, size) in bytes."""


class BrokenSeal(ValueError):
    """Difference of a file from its seal; the message is a clause."""


def seal(path: Path) -> None:
    """Adds new seals to a closed file that rodsweep has just written."""
    with h5py.File(path, "r+") as file:
        file.attrs[SEAL_ATTRIBUTE] = json.dumps(digests_of(file))
    with h5py.File(path, "r") as file:
        pieces = _large_pieces(file)
    with path.open("r+b") as stream:
        end = _end(stream)
        stream.truncate(end)
        frame = {"end": end, "pieces": pieces, "frame": _checksum(stream, _between(pieces, end))}
        stream.seek(end)
        stream.write(FRAME_HEAD + json.dumps(frame).encode() + b"\n")


def check_frame(path: Path) -> bool:
    """Whether HDF5's structures agree with the checksum; False without checksum, after another program.

    Raises BrokenSeal at a difference, or OSError. Takes a millisecond.
    """
    with path.open("rb") as stream:
        end = _end(stream)
        size = os.fstat(stream.fileno()).st_size
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
        raise BrokenSeal("its content differs from its checksum")
    return True


def _end(stream: BinaryIO) -> int:
    """HDF5's end of the file, from the superblock."""
    stream.seek(0)
    head = stream.read(64)
    if not head.startswith(HDF5_SIGNATURE) or len(head) < 64 or head[8] not in END_AT:
        raise BrokenSeal("it is not HDF5")
    at = END_AT[head[8]]
    return int.from_bytes(head[at : at + 8], "little")


def _large_pieces(file: h5py.File) -> list[Piece]:
    """(offset, size) of the numbers of every large contiguous variable, in order."""
    variables = [data for data in map(file.get, file) if isinstance(data, h5py.Dataset)]
    places = {(data.id.get_offset(), data.id.get_storage_size()) for data in variables}
    return sorted((start, size) for start, size in places if start is not None and size > LARGEST_INCLUDED)


def _between(pieces: list[Piece], end: int) -> Iterator[Piece]:
    """Yields the pieces before, between and behind the given pieces."""
    at = 0
    for start, size in [*pieces, (end, 0)]:
        if not 0 <= at <= start <= end:
            raise BrokenSeal("its checksum cannot be read")
        yield at, start - at
        at = start + size


def _checksum(stream: BinaryIO, pieces: Iterator[Piece]) -> int:
    """CRC-32 of pieces of a file, in sequence."""
    checksum = 0
    for start, size in pieces:
        stream.seek(start)
        left = size
        while left and (block := stream.read(min(left, BYTES_A_READ))):
            checksum = zlib.crc32(block, checksum)
            left -= len(block)
    return checksum
