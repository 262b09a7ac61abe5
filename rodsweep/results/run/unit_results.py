"""Results of units that all points together make up: a small file each beside the journals.

A file is written whole, and recognised by its fingerprint and its checksum. A file that is torn, or another
run's, counts as none: its unit is then solved again.
"""

import io
import os
import zlib
from pathlib import Path

import numpy as np

from .journal import drop_files

UNIT_RESULTS = "unit-*"
"""All results of a directory, also those that a kill left half written."""
RESULT_HEAD = b"rodsweep unit 1\n"
"""Its number grows when a unit or its result means something else than before."""
CHECKSUM_BYTES = 4
Arrays = dict[str, np.ndarray]


class UnitResults:
    """The results of a run's units in its journal directory."""

    def __init__(self, directory: Path, fingerprint: str):
        self.directory = directory
        self.header = RESULT_HEAD + fingerprint.encode() + b"\n"

    def write(self, unit: int, arrays: Arrays) -> None:
        """Keeps the result of a unit."""
        stream = io.BytesIO()
        np.savez(stream, **arrays)
        content = self.header + stream.getvalue()
        path = self.directory / f"unit-{unit:09d}"
        # Ranks of a run that was killed live on for a moment and must not share our file.
        copy = path.with_name(f"{path.name}-{os.getpid()}-{os.urandom(4).hex()}")
        copy.write_bytes(content + _checksum(content))
        os.replace(copy, path)

    def read(self) -> dict[int, Arrays]:
        """The results of all units that are there whole, by unit."""
        found = {}
        for path in self.directory.glob(UNIT_RESULTS):
            number = path.name.removeprefix("unit-")
            if not (number.isdecimal() and path.is_file()):
                continue
            data = path.read_bytes()
            content, checksum = data[:-CHECKSUM_BYTES], data[-CHECKSUM_BYTES:]
            if content.startswith(self.header) and _checksum(content) == checksum:
                with np.load(io.BytesIO(content[len(self.header) :]), allow_pickle=False) as arrays:
                    found[int(number)] = dict(arrays)
        return found

    def drop(self) -> None:
        """Removes all results."""
        drop_files(self.directory, UNIT_RESULTS)


def _checksum(content: bytes) -> bytes:
    return zlib.crc32(content).to_bytes(CHECKSUM_BYTES, "little")
