"""A result file as it is, read only: what `show` and `plot` work on."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..errors import InputError
from .journal import journal_directory, read_journals
from .layouts import layout_of
from .schema import MISSING, NONLINEAR_NAMES

DAMAGES = (OSError, KeyError, ValueError, TypeError, RuntimeError, OverflowError, MemoryError)
"""What h5py raises, and what reading goes on to raise, where a file is damaged."""


class Variables(Mapping[str, np.ndarray]):
    """The variables of an open file as NumPy arrays, each read when it is first asked for."""

    def __init__(self, path: Path, file: h5py.File):
        self.path, self.file = path, file
        self.read: dict[str, np.ndarray] = {}

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self.read:
            try:
                self.read[name] = self.file[name][...]
            except DAMAGES as error:
                raise damaged(self.path, error) from None
        return self.read[name]

    def __contains__(self, name: object) -> bool:
        try:
            return name in self.file
        except DAMAGES as error:
            raise damaged(self.path, error) from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.file)

    def __len__(self) -> int:
        return len(self.file)


def damaged(path: Path, error: Exception) -> InputError:
    """The refusal of a file that is no result, or cannot be read."""
    reason = str(error).splitlines()[0] if str(error) else type(error).__name__
    return InputError(f"{path} is not a whole rodsweep result file ({reason})")


@dataclass(frozen=True, slots=True)
class View:
    """A file's attributes and its variables as NumPy arrays."""

    path: Path
    attributes: dict[str, Any]
    variables: Mapping[str, np.ndarray]
    parameters: tuple[str, ...]
    """What makes a point: the dimensions of a grid, or what is given along `point`."""
    flags: dict[int, str]
    journalled: int
    """Finished points that wait in the journal for the next run."""

    @property
    def task(self) -> str:
        """The task whose results these are."""
        return str(self.attributes["task"])

    @property
    def is_grid(self) -> bool:
        return "point" not in self.variables

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """The parameters that the file knows: axes of a grid, or columns of a point list."""
        return {name: self.variables[name] for name in NONLINEAR_NAMES if name in self.variables}


def read_view(path: Path) -> View:
    """The file, which stays open; InputError if it is no result."""
    if not path.exists():
        raise InputError(f"{path} does not exist")
    try:
        file = h5py.File(path, "r")
        attributes = dict(file.attrs)
        layout = layout_of(json.loads(attributes["config_resolved"]))
        status = file["status"]
        words = str(status.attrs["flag_meanings"]).split()
        flags = dict(zip((int(v) for v in status.attrs["flag_values"]), words, strict=True))
        variables = Variables(path, file)
        done = variables["status"].ravel() != MISSING
    except DAMAGES as error:
        raise damaged(path, error) from None
    journalled = 0
    directory = journal_directory(path)
    if directory.is_dir():
        for block in read_journals(directory, layout, str(attributes["fingerprint"])):
            indices = np.unique(block["index"])
            journalled += int(np.count_nonzero(~done[indices]))
            done[indices] = True
    return View(path, attributes, variables, layout.parameters, flags, journalled)
