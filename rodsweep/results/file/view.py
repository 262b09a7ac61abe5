"""A result file as it is, read only: what `show` and `plot` work on."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...errors import InputError
from ...model.parameters import NONLINEAR_PARAMETERS
from ..layouts import layout_of
from ..layouts.variables import MISSING, Layout
from ..run.journal import journal_directory, read_journals
from .seal import check

CHECKED_WHOLE = 10**9
"""Bytes up to which the numbers are checked too, not only HDF5's structures, before a file is shown."""
LONGEST_REASON = 150
"""Characters of what a library says."""
DAMAGES = (OSError, LookupError, ValueError, TypeError, RuntimeError, OverflowError, MemoryError)
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
        found = ((name, self.file.get(name)) for name in self.file)  # whatever another program put there
        return (name for name, data in found if isinstance(data, h5py.Dataset) and data.shape is not None)

    def __len__(self) -> int:
        return sum(1 for _ in self)


def damaged(path: Path, error: Exception) -> InputError:
    """The refusal of a file that is no result, or cannot be read."""
    return InputError(f"{path} is not a whole rodsweep result file ({reason_of(error)})")


def reason_of(error: Exception) -> str:
    """What a library says of a file, on one line."""
    text = getattr(error, "strerror", None) or str(error) or type(error).__name__
    text = "".join(c if c.isprintable() else " " for c in text)
    return text if len(text) <= LONGEST_REASON else text[: LONGEST_REASON - 3] + "..."


def refuse_misfit(file: h5py.File, layout: Layout) -> None:
    """One of DAMAGES unless every variable of the layout is there, with its type, its shape and its place."""
    names = ("point",) if "point" in file else layout.parameters
    shape = tuple(len(file[name]) for name in names)
    expected = {v.name: (shape + layout.inner(v), np.dtype(v.dtype)) for v in layout.variables}
    expected |= {name: ((extent,), file[name].dtype) for name, extent in layout.extents.items()}
    for name, (extents, kind) in expected.items():
        data = file[name]
        if not isinstance(data, h5py.Dataset) or data.shape != extents or data.dtype != kind:
            raise ValueError(f"its variable {name} does not fit its config")
        if data.id.get_offset() is None or data.chunks or not data.id.get_storage_size():
            raise ValueError(f"its variable {name} does not lie in one piece")


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
        return {name: self.variables[name] for name in NONLINEAR_PARAMETERS if name in self.variables}


def read_view(path: Path) -> View:
    """The file, which stays open; InputError if it is no result."""
    if not path.is_file():
        raise InputError(f"{path} is not a file" if path.exists() else f"{path} does not exist")
    try:
        check(path, values=path.stat().st_size <= CHECKED_WHOLE)
        file = h5py.File(path, "r")
        attributes = dict(file.attrs)
        config, fingerprint = json.loads(attributes["config_resolved"]), str(attributes["fingerprint"])
        layout = layout_of(config)
        refuse_misfit(file, layout)
        if str(attributes.setdefault("task", config["task"])) != config["task"]:
            raise ValueError("its task is not that of its config")
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
        for block in read_journals(directory, layout, fingerprint, done.size):
            indices = np.unique(block["index"])
            journalled += int(np.count_nonzero(~done[indices]))
            done[indices] = True
    return View(path, attributes, variables, layout.parameters, flags, journalled)
