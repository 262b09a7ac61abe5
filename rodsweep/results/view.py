"""A result file as it is, read only: what `show` and `plot` work on."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..errors import InputError
from .journal import journal_directory, read_journals
from .layouts import layout_of
from .schema import MISSING, NONLINEAR_NAMES


@dataclass(frozen=True, slots=True)
class View:
    """A file's attributes and its variables as NumPy arrays."""

    path: Path
    attributes: dict[str, Any]
    variables: dict[str, np.ndarray]
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


def read_view(path: Path, names: tuple[str, ...] = ()) -> View:
    """The whole file, or the named variables beside the axes; InputError if it is no result."""
    if not path.exists():
        raise InputError(f"{path} does not exist")
    try:
        with h5py.File(path, "r") as file:
            attributes = dict(file.attrs)
            layout = layout_of(json.loads(attributes["config_resolved"]))
            wanted = [n for n in file if not names or n in names or n in NONLINEAR_NAMES or n == "point"]
            variables = {name: file[name][...] for name in wanted}
            status = file["status"].attrs
            words = str(status["flag_meanings"]).split()
            flags = dict(zip((int(v) for v in status["flag_values"]), words, strict=True))
    except (OSError, KeyError, ValueError, TypeError, RuntimeError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(f"{path} is not a whole rodsweep result file ({reason})") from None
    waiting: set[int] = set()
    directory = journal_directory(path)
    if directory.is_dir():
        for block in read_journals(directory, layout, str(attributes["fingerprint"])):
            waiting.update(block["index"].tolist())
    done = variables.get("status", np.array([MISSING])).ravel()
    journalled = sum(1 for i in waiting if i >= done.size or done[i] == MISSING)
    return View(path, attributes, variables, layout.parameters, flags, journalled)
