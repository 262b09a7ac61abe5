"""What a run keeps beside its journals of work that is not done: states of chains, results of units.

A small file each, replaced whole, recognised by its fingerprint and its checksum. A file that is torn, or
another run's, counts as none: the chain then starts again, the unit is solved again.
"""

import io
import os
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar, Protocol

import numpy as np

from .journal import drop_files

CHECKPOINTS, UNIT_RESULTS = "chain-*", "unit-*"
"""All checkpoints, or results of units, of a directory, also those that a kill left half written."""
CHECKPOINT_HEAD, RESULT_HEAD = b"rodsweep checkpoint 5\n", b"rodsweep unit 1\n"
"""The number grows when a state, a unit or its result means something else: older ones then are none."""
CHECKSUM_BYTES = 4
Arrays = dict[str, np.ndarray]
STATE = "state_"
"""Prefix of the names of a state's arrays."""


class HasArrays(Protocol):
    """A state of a chain."""

    def arrays(self) -> Arrays:
        """All of it as named arrays, of any shapes."""


class KeptArrays:
    """Numbered sets of arrays of one kind in a run's journal directory."""

    pattern: ClassVar[str]

    def __init__(self, directory: Path, fingerprint: str, head: bytes):
        self.directory = directory
        self.header = head + fingerprint.encode() + b"\n"

    def put(self, number: int, arrays: Arrays) -> None:
        """Keeps arrays instead of those that were kept under the number."""
        stream = io.BytesIO()
        np.savez(stream, **arrays)
        content = self.header + stream.getvalue()
        path = self._path(number)
        self.directory.mkdir(parents=True, exist_ok=True)  # it may have been moved or deleted meanwhile
        # Ranks of a run that was killed live on for a moment and must not share our file.
        copy = path.with_name(f"{path.name}-{os.getpid()}-{os.urandom(4).hex()}")
        copy.write_bytes(content + _checksum(content))
        os.replace(copy, path)

    def get(self, number: int) -> Arrays | None:
        """The arrays under a number; None where there is no whole file of this run."""
        if not self._path(number).is_file():
            return None
        data = self._path(number).read_bytes()
        content, checksum = data[:-CHECKSUM_BYTES], data[-CHECKSUM_BYTES:]
        if not content.startswith(self.header) or _checksum(content) != checksum:
            return None
        with np.load(io.BytesIO(content[len(self.header) :]), allow_pickle=False) as arrays:
            return dict(arrays)

    def _path(self, number: int) -> Path:
        return self.directory / self.pattern.replace("*", f"{number:09d}")


class Checkpoints(KeptArrays):
    """Where each unfinished chain of points stands: the state from which its next point starts."""

    pattern = CHECKPOINTS

    def __init__(self, directory: Path, fingerprint: str, state_of: Callable[[Arrays], HasArrays]):
        """state_of: a state from the arrays, of any shapes, that its `arrays` gave."""
        super().__init__(directory, fingerprint, CHECKPOINT_HEAD)
        self._state_of = state_of

    def write(self, chain: int, index: int, state: HasArrays | None) -> None:
        """Keeps the state from which the neighbour of point `index` starts, or that there is none."""
        parts = state.arrays() if state is not None else {}
        self.put(chain, {"index": np.array(index)} | {STATE + name: part for name, part in parts.items()})

    def read(self, chain: int) -> tuple[int, HasArrays | None] | None:
        """(index, state) as written last, None where there is no whole checkpoint of this run."""
        arrays = self.get(chain)
        if arrays is None:
            return None
        index = int(arrays.pop("index"))
        parts = {name.removeprefix(STATE): part for name, part in arrays.items()}
        return index, self._state_of(parts) if parts else None

    def remove(self, chain: int) -> None:
        """Forgets a chain that is done."""
        self._path(chain).unlink(missing_ok=True)


class UnitResults(KeptArrays):
    """The results of a run's units, which all points together make up."""

    pattern = UNIT_RESULTS

    def __init__(self, directory: Path, fingerprint: str):
        super().__init__(directory, fingerprint, RESULT_HEAD)

    def write(self, unit: int, arrays: Arrays) -> None:
        """Keeps the result of a unit."""
        self.put(unit, arrays)

    def read(self) -> dict[int, Arrays]:
        """The results of all units that are there whole, by unit."""
        names = (path.name.removeprefix("unit-") for path in self.directory.glob(UNIT_RESULTS))
        found = {int(name): self.get(int(name)) for name in names if name.isdecimal()}
        return {unit: arrays for unit, arrays in found.items() if arrays is not None}

    def drop(self) -> None:
        """Removes all results."""
        drop_files(self.directory, UNIT_RESULTS)


def _checksum(content: bytes) -> bytes:
    return zlib.crc32(content).to_bytes(CHECKSUM_BYTES, "little")
