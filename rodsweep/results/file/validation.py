"""Whether a file is a whole rodsweep result, and which config it answers; what is said where it is not."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ... import __version__
from ...errors import InputError
from ..layouts import layout_of
from ..layouts.variables import Layout
from .identity import fingerprint_of
from .seal import HDF5_SIGNATURE, check_seal

PROGRAM = "rodsweep"
"""The attribute `program` of our files."""
FORMAT = 4
"""The attribute `format` of our files: grows when a variable is added or changes its meaning. What was
written before there was one has none, which counts as 0."""
LONGEST_REASON = 150
"""Characters of what a library says."""
DAMAGES = (OSError, LookupError, ValueError, TypeError, RuntimeError, OverflowError, MemoryError)
"""What h5py raises, and what reading goes on to raise, where a file is damaged."""


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """What is raised in here because the file is no result, or is damaged, becomes InputError."""
    try:
        yield
    except DAMAGES as error:
        raise InputError(f"{path} is not a whole rodsweep result file ({reason_of(error)})") from None


def reason_of(error: Exception) -> str:
    """What a library says of a file, on one line."""
    text = getattr(error, "strerror", None) or str(error) or type(error).__name__
    text = "".join(c if c.isprintable() else " " for c in text)
    return text if len(text) <= LONGEST_REASON else text[: LONGEST_REASON - 3] + "..."


@dataclass(frozen=True, slots=True)
class Header:
    """What a whole result file says of itself; `config` is the resolved one, `points` their number."""

    path: Path
    attributes: dict[str, Any]
    config: dict[str, Any]
    fingerprint: str
    layout: Layout
    points: int
    asked: str
    """The fingerprint as this version makes it: what the file was made for. `fingerprint` is what its journal
    has, which an earlier version may have made otherwise."""


def read_header(path: Path) -> Header:
    """InputError unless the file is a whole result, its numbers included."""
    refuse_absent(path)
    with reading(path):
        check_seal(path, values=True)
        with h5py.File(path, "r") as file:
            return header_of(path, file)


def refuse_absent(path: Path) -> None:
    """InputError unless there is a file of that name."""
    if not path.is_file():
        raise InputError(f"{path} is not a file" if path.exists() else f"{path} does not exist")


def header_of(path: Path, file: h5py.File, shown: bool = False) -> Header:
    """The header of an open file; one of DAMAGES unless its variables are those of its config.

    shown: whether the file is only shown, and need not have variables that came with a later format.
    InputError where another version of rodsweep wrote the file in a format that this one does not read.
    """
    attributes = dict(file.attrs)
    found = int(attributes.get("format", 0))
    refuse_newer(path, attributes)
    config = json.loads(attributes["config_resolved"])
    try:
        layout = layout_of(config)
        if shown:
            layout = layout.known_in(found)
        refuse_misfit(file, layout)
        asked = fingerprint_of(config, [file[name][...] for name in layout.parameters])
    except (LookupError, ValueError, TypeError) as error:
        if found == FORMAT or "rodsweep_version" not in attributes:
            raise
        if not shown and _is_shown(file, config, found):
            raise InputError(
                f"{path} was written by an earlier rodsweep ({_writer(attributes)}), with less in it "
                f"({reason_of(error)}): it is shown and drawn, and neither continued nor merged; compute it "
                "again, with --fresh or into another file"
            ) from None
        raise InputError(
            f"{path} was written by an earlier rodsweep ({_writer(attributes)}) and is read by that only "
            f"({reason_of(error)}); compute it again, with --fresh or into another file"
        ) from None
    points = file["status"].size
    return Header(path, attributes, config, str(attributes["fingerprint"]), layout, points, asked)


def _is_shown(file: h5py.File, config: dict[str, Any], found: int) -> bool:
    """Whether a file of an earlier format, with its resolved config, has what files of that format have."""
    try:
        refuse_misfit(file, layout_of(config).known_in(found))
    except (LookupError, ValueError, TypeError):
        return False
    return True


def refuse_newer(path: Path, attributes: Mapping[str, Any]) -> None:
    """InputError for a file whose format is newer than this program knows."""
    found = int(attributes.get("format", 0))
    if found > FORMAT:
        raise InputError(
            f"{path} has format {found}, written by rodsweep {_writer(attributes)}; this one ({__version__}) "
            f"reads formats up to {FORMAT}: update it"
        )


def _writer(attributes: Mapping[str, Any]) -> str:
    """The version that wrote a file, and its commit."""
    commit = str(attributes.get("git_commit", "unknown"))[:12]
    return f"{attributes.get('rodsweep_version', 'unknown')}, commit {commit}"


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


def is_ours(path: Path) -> bool:
    """Whether a file is a rodsweep result, or HDF5 that is too damaged to say whose it is."""
    if not path.is_file():
        return False
    with path.open("rb") as stream:
        if stream.read(8) != HDF5_SIGNATURE:
            return False
    try:
        check_seal(path, values=False)
        with h5py.File(path, "r") as file:
            return bool(file.attrs.get("program") == PROGRAM)
    except DAMAGES:
        return True
