"""Where each unfinished chain of points stands: the state from which its next point starts.

A small file per chain beside the journals, replaced whole, recognised by its fingerprint and its
checksum. A file that is torn, or another run's, counts as none: the chain then starts again.
"""

import io
import os
import zlib
from pathlib import Path

import numpy as np

from ...arrays import Array

CHECKPOINTS = "chain-*"
"""All checkpoints of a directory, also those that a kill left half written."""
CHECKPOINT_HEAD = b"rodsweep checkpoint 3\n"
"""Its number grows when a state holds other numbers than before: older checkpoints then count as none."""
INDEX_BYTES, CHECKSUM_BYTES = 8, 4


class Checkpoints:
    """The checkpoints of a run's chains in its journal directory."""

    def __init__(self, directory: Path, fingerprint: str):
        self.directory = directory
        self.header = CHECKPOINT_HEAD + fingerprint.encode() + b"\n"

    def write(self, chain: int, index: int, state: Array | None) -> None:
        """Keeps what the neighbour of point `index` starts from, an array of any shape or None."""
        stream = io.BytesIO()
        if state is not None:
            np.save(stream, state, allow_pickle=False)
        content = self.header + index.to_bytes(INDEX_BYTES, "little") + stream.getvalue()
        path = self._path(chain)
        self.directory.mkdir(parents=True, exist_ok=True)  # it may have been moved or deleted meanwhile
        # Ranks of a run that was killed live on for a moment and must not share our file.
        copy = path.with_name(f"{path.name}-{os.getpid()}-{os.urandom(4).hex()}")
        copy.write_bytes(content + _checksum(content))
        os.replace(copy, path)

    def read(self, chain: int) -> tuple[int, Array | None] | None:
        """(index, state) as written last, None where there is no whole checkpoint of this run."""
        if not self._path(chain).is_file():
            return None
        data = self._path(chain).read_bytes()
        content, checksum = data[:-CHECKSUM_BYTES], data[-CHECKSUM_BYTES:]
        start = len(self.header)
        whole = len(content) >= start + INDEX_BYTES and _checksum(content) == checksum
        if not whole or not content.startswith(self.header):
            return None
        index, state = content[start : start + INDEX_BYTES], content[start + INDEX_BYTES :]
        loaded = np.load(io.BytesIO(state), allow_pickle=False) if state else None
        return int.from_bytes(index, "little"), loaded

    def remove(self, chain: int) -> None:
        """Forgets a chain that is done."""
        self._path(chain).unlink(missing_ok=True)

    def _path(self, chain: int) -> Path:
        return self.directory / f"chain-{chain:09d}"


def _checksum(content: bytes) -> bytes:
    return zlib.crc32(content).to_bytes(CHECKSUM_BYTES, "little")
