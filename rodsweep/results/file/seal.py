"""Seal of a result file in two parts: digests of the content, and a checksum of the HDF5 structures.

The attribute `seal` has a digest of every variable and attribute (`rodsweep.results.file.content_digests`),
and shows a change by any program. A checksum of HDF5's structures lies behind HDF5's own end of the file,
invisible to other programs. A flipped bit in the structures can make HDF5 loop for ever or crash; the
checksum is therefore compared before HDF5 reads the file. A program that changes the file by HDF5 removes the
checksum."""

import fcntl
import json
import os
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import h5py

from .content_digests import SEAL_ATTRIBUTE, digests_of

CHECKSUM_HEAD = b"\nrodsweep seal 2 "
"""First bytes of the checksum of HDF5's structures, which follows HDF5's own end of the file."""
FORMER_CHECKSUM_HEAD = b"\nrodsweep seal 1 "
"""First bytes of the checksum in files of format 4 and before, which are refused for their format."""
HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""First bytes of every HDF5 file."""
HDF5_END_OFFSET_BY_VERSION = {0: 40, 1: 44, 2: 28, 3: 28}
"""Offset of the eight bytes with HDF5's end of the file, by version of HDF5's superblock."""
MAX_CHECKSUM_TEXT_BYTES = 100_000
"""Maximum size, in bytes, of the checksum's text at the end of a file: the checksum, and the byte ranges that
it does not cover."""
BYTES_PER_READ = 1 << 20
"""Number of bytes per read of a file, which bounds the memory."""
MAX_CHECKSUMMED_VARIABLE_BYTES = 1 << 16
"""Size of a variable, in bytes, up to which the checksum of HDF5's structures includes its numbers."""
OffsetAndSize = tuple[int, int]
"""Byte range of a file: (offset, size), in bytes."""


OPEN_FOR_WRITING_CLAUSE = "another process has it open for writing; close it there and try again"
"""Clause about a file on which HDF5 holds its lock for writing."""


class ChecksumMismatch(ValueError):
    """A file differs from its seal; the message is a clause."""


def seal(path: Path) -> None:
    """Adds digests and a checksum to a closed file that rodsweep has just written; replaces earlier digests
    and checksums."""
    with h5py.File(path, "r+") as file:
        file.attrs[SEAL_ATTRIBUTE] = json.dumps(digests_of(file))
    with h5py.File(path, "r") as file:
        ranges = _large_variable_ranges(file)
    with path.open("r+b") as stream:
        end = _hdf5_end(stream)
        # A former checksum lies behind HDF5's own end of the file.
        stream.truncate(end)
        checksum = {
            "end": end,
            "pieces": ranges,
            "frame": _checksum(stream, _complementary_ranges(ranges, end)),
        }
        stream.seek(end)
        stream.write(CHECKSUM_HEAD + json.dumps(checksum).encode() + b"\n")


def has_valid_structure_checksum(path: Path) -> bool:
    """True if the HDF5 structures of the file match its checksum, False if the file has no checksum.

    Another program that writes the file removes the checksum. Raises ChecksumMismatch for a wrong or
    unreadable checksum or a file that is too short, and OSError. Takes a millisecond.
    """
    with path.open("rb") as stream:
        end = _hdf5_end(stream)
        size = os.fstat(stream.fileno()).st_size
        if size < end:
            raise ChecksumMismatch(f"it ends after {size} of {end} bytes; copy the complete file again")
        stream.seek(end)
        data = stream.read(MAX_CHECKSUM_TEXT_BYTES)
        if not data or data.startswith(FORMER_CHECKSUM_HEAD):
            return False
        if not data.startswith(CHECKSUM_HEAD) or not data.endswith(b"\n"):
            raise ChecksumMismatch("its checksum cannot be read")
        try:
            stored_checksums = json.loads(data[len(CHECKSUM_HEAD) :])
            ranges = [(int(start), int(length)) for start, length in stored_checksums["pieces"]]
            # Before the checksum, because a writer that closes the file meanwhile does no damage.
            is_locked = _is_locked_for_writing(stream)
            is_valid = stored_checksums["end"] == end and stored_checksums["frame"] == _checksum(
                stream, _complementary_ranges(ranges, end)
            )
        except (LookupError, TypeError, ValueError, OverflowError, RecursionError, OSError):
            raise ChecksumMismatch("its checksum cannot be read") from None
    if not is_valid and is_locked:
        raise ChecksumMismatch(OPEN_FOR_WRITING_CLAUSE)
    if not is_valid:
        raise ChecksumMismatch(
            "its content differs from its checksum; restore a copy of the file, or compute it again with "
            "--fresh"
        )
    return True


def _is_locked_for_writing(stream: BinaryIO) -> bool:
    """Whether HDF5 holds its lock for writing on the open file, in any process. HDF5 writes a mark into such
    a file, so that its checksum does not match."""
    try:
        fcntl.flock(stream, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    fcntl.flock(stream, fcntl.LOCK_UN)
    return False


def _hdf5_end(stream: BinaryIO) -> int:
    """Offset of HDF5's own end of the file, in bytes, from the superblock."""
    stream.seek(0)
    header = stream.read(64)
    if (
        not header.startswith(HDF5_SIGNATURE)
        or len(header) < 64
        or header[8] not in HDF5_END_OFFSET_BY_VERSION
    ):
        raise ChecksumMismatch("it is not HDF5")
    offset = HDF5_END_OFFSET_BY_VERSION[header[8]]
    return int.from_bytes(header[offset : offset + 8], "little")


def _large_variable_ranges(file: h5py.File) -> list[OffsetAndSize]:
    """Byte ranges of the numbers of contiguous variables larger than MAX_CHECKSUMMED_VARIABLE_BYTES, in
    order."""
    variables = [dataset for dataset in map(file.get, file) if isinstance(dataset, h5py.Dataset)]
    ranges = {(dataset.id.get_offset(), dataset.id.get_storage_size()) for dataset in variables}
    return sorted(
        (start, size) for start, size in ranges if start is not None and size > MAX_CHECKSUMMED_VARIABLE_BYTES
    )


def _complementary_ranges(ranges: list[OffsetAndSize], end: int) -> Iterator[OffsetAndSize]:
    """Yields the byte ranges from 0 to `end` that the sorted byte ranges `ranges` leave out."""
    position = 0
    # An empty piece at the end closes the last gap.
    for start, size in [*ranges, (end, 0)]:
        if not 0 <= position <= start <= end:
            raise ChecksumMismatch("its checksum cannot be read")
        yield position, start - position
        position = start + size


def _checksum(stream: BinaryIO, ranges: Iterator[OffsetAndSize]) -> int:
    """CRC-32 of the bytes of a file in `ranges`, taken in order without the gaps between the ranges."""
    checksum = 0
    for start, size in ranges:
        stream.seek(start)
        remaining = size
        while remaining and (block := stream.read(min(remaining, BYTES_PER_READ))):
            checksum = zlib.crc32(block, checksum)
            remaining -= len(block)
    return checksum
