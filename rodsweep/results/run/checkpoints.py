"""Checkpoints of unfinished work in the journal directory: solver states of chains, and results of work items
for variables that depend on all points.

Each checkpoint is a small file, replaced as a whole and recognised by fingerprint and checksum. A damaged
file, or a file of another run, is ignored: the chain starts again, the work item is solved again.
"""

import io
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar, Protocol

import numpy as np

from .journal import CHECKSUM_BYTES, delete_matching_files, with_checksum

CHECKPOINT_GLOB = "chain-*"
"""Pattern of the file names of checkpoints of chains, including files that a kill left unfinished. A chain is
a sequence of points, each solved from the result of the point before."""
ITEM_RESULT_GLOB = "unit-*"
"""Pattern of the file names of results of work items, including files that a kill left unfinished."""
CHECKPOINT_HEAD = b"rodsweep checkpoint 8\n"
"""First line of a checkpoint; the number grows when a state changes in meaning. Checkpoints with another
number are ignored."""
RESULT_HEAD = b"rodsweep unit 2\n"
"""First line of the file of an item's result; the number grows when items or results change in meaning."""
ArraysByName = dict[str, np.ndarray]
STATE_PREFIX = "state_"
"""Prefix of the names of a solver state's arrays in a checkpoint file."""


class ArrayConvertibleState(Protocol):
    """Solver state after a point of a chain, from which the next point of the chain starts; the state can be
    written as arrays."""

    def arrays(self) -> ArraysByName:
        """The complete solver state as arrays of any shape, (...,), by name."""


class ArrayStore:
    """Store of sets of named arrays in the journal directory of a run, with one file per set. A set is
    identified by a number. file_name_pattern: pattern of the names of the files."""

    file_name_pattern: ClassVar[str]

    def __init__(self, directory: Path, fingerprint: str, first_line: bytes):
        """directory: journal directory. fingerprint: digest of config and points. first_line: first line of
        the files, which states kind and version."""
        self.directory = directory
        self.header = first_line + fingerprint.encode() + b"\n"

    def put(self, number: int, arrays: ArraysByName) -> None:
        """Stores arrays by name under `number`; replaces earlier arrays of this number."""
        stream = io.BytesIO()
        # In memory first, as the checksum is needed before anything is written.
        np.savez(stream, **dict[str, Any](arrays))  # `savez` has keywords of other types, too
        content = self.header + stream.getvalue()
        path = self._path(number)
        self.directory.mkdir(parents=True, exist_ok=True)  # the directory may have been moved or deleted
        # Ranks of a killed run live on for a moment and must not write to the same file.
        copy = path.with_name(f"{path.name}-{os.getpid()}-{os.urandom(4).hex()}")
        copy.write_bytes(with_checksum(content))
        # Atomic, so that a reader finds the old or the new state, never a part.
        os.replace(copy, path)

    def get(self, number: int) -> ArraysByName | None:
        """Arrays stored under `number`, by name; None if there is no intact file of this run."""
        if not self._path(number).is_file():
            return None
        data = self._path(number).read_bytes()
        content = data[:-CHECKSUM_BYTES]
        if not content.startswith(self.header) or with_checksum(content) != data:
            return None
        # Without pickles a damaged or foreign file cannot run code.
        with np.load(io.BytesIO(content[len(self.header) :]), allow_pickle=False) as arrays:
            return dict(arrays)

    def _path(self, number: int) -> Path:
        return self.directory / self.file_name_pattern.replace("*", f"{number:09d}")


class Checkpoints(ArrayStore):
    """Store of the last solved point of each unfinished chain, and of the solver state after this point. A
    chain is a sequence of points, each solved from the result of the point before."""

    file_name_pattern = CHECKPOINT_GLOB

    def __init__(
        self, directory: Path, fingerprint: str, state_of: Callable[[ArraysByName], ArrayConvertibleState]
    ):
        """directory: journal directory. fingerprint: digest of config and points. state_of: makes a solver
        state from its arrays (the result of the state's method `arrays`)."""
        super().__init__(directory, fingerprint, CHECKPOINT_HEAD)
        self._state_of = state_of

    def write(self, chain: int, index: int, state: ArrayConvertibleState | None) -> None:
        """Stores the solver state after the point at the flat index `index` of the chain number `chain`; None
        for no state."""
        arrays = state.arrays() if state is not None else {}
        self.put(
            chain, {"index": np.array(index)} | {STATE_PREFIX + name: array for name, array in arrays.items()}
        )

    def read(self, chain: int) -> tuple[int, ArrayConvertibleState | None] | None:
        """(flat index, solver state) of the last checkpoint of the chain number `chain`; None if there is no
        intact checkpoint."""
        arrays = self.get(chain)
        if arrays is None:
            return None
        index = int(arrays.pop("index"))
        state_arrays = {name.removeprefix(STATE_PREFIX): array for name, array in arrays.items()}
        return index, self._state_of(state_arrays) if state_arrays else None

    def remove(self, chain: int) -> None:
        """Deletes the checkpoint of the finished chain number `chain`."""
        self._path(chain).unlink(missing_ok=True)


class ItemResults(ArrayStore):
    """Store of the results of finished work items, until the variables that depend on all points are
    computed."""

    file_name_pattern = ITEM_RESULT_GLOB

    def __init__(self, directory: Path, fingerprint: str):
        """directory: journal directory. fingerprint: digest of config and points."""
        super().__init__(directory, fingerprint, RESULT_HEAD)

    def write(self, item: int, arrays: ArraysByName) -> None:
        """Stores the result of the work item number `item`, as arrays by name."""
        self.put(item, arrays)

    def read(self) -> dict[int, ArraysByName]:
        """Results of all work items with an intact file, by number of the work item."""
        names = (path.name.removeprefix("unit-") for path in self.directory.glob(ITEM_RESULT_GLOB))
        results = {int(name): self.get(int(name)) for name in names if name.isdecimal()}
        return {item: arrays for item, arrays in results.items() if arrays is not None}

    def remove_all(self) -> None:
        """Deletes the results of all items."""
        delete_matching_files(self.directory, ITEM_RESULT_GLOB)
