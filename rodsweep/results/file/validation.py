"""Whether a file is a whole rodsweep result, and which config it answers; what is said where it is not."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...errors import InputError
from ..layouts import layout_of
from ..layouts.variables import Layout
from .seal import HDF5_SIGNATURE, check_seal

PROGRAM = "rodsweep"
"""The attribute `program` of our files."""
LONGEST_VALUE = 80
"""Characters of a config's value in a sentence."""
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


def header_of(path: Path, file: h5py.File) -> Header:
    """The header of an open file; one of DAMAGES unless its variables are those of its config."""
    attributes = dict(file.attrs)
    config = json.loads(attributes["config_resolved"])
    layout = layout_of(config)
    refuse_misfit(file, layout)
    return Header(path, attributes, config, str(attributes["fingerprint"]), layout, file["status"].size)


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


def what_is_asked(config: dict[str, Any]) -> dict[str, Any]:
    """A resolved config without its title, which changes no number."""
    return config | {"title": ""} if "title" in config else config


def change_between(theirs: dict[str, Any], ours: dict[str, Any]) -> str:
    """How two resolved configs differ that do not ask for the same points, in words."""
    return (
        config_difference(what_is_asked(theirs), what_is_asked(ours))
        or "the points listed in parameters.points differ"
    )


def config_difference(theirs: Any, ours: Any, key: str = "") -> str:
    """The first key in which two resolved configs differ, with both values; empty if none does."""
    if isinstance(theirs, dict) and isinstance(ours, dict):
        for name in [*ours, *(n for n in theirs if n not in ours)]:
            found = config_difference(theirs.get(name), ours.get(name), f"{key}.{name}" if key else name)
            if found:
                return found
        return ""
    if theirs == ours:
        return ""
    texts = json.dumps(theirs), json.dumps(ours)
    if isinstance(theirs, list) and isinstance(ours, list) and max(map(len, texts)) > LONGEST_VALUE:
        return f"{key} has {_list_difference(theirs, ours)}"
    return f"{key} is {texts[0][:LONGEST_VALUE]} in the file and {texts[1][:LONGEST_VALUE]} in the config"


def _list_difference(theirs: list[Any], ours: list[Any]) -> str:
    """How two lists differ that are too long to be shown: their lengths, and the first value that differs."""
    sizes = f"{len(theirs)} values in the file and {len(ours)} in the config"
    pairs = enumerate(zip_longest(theirs, ours), 1)
    number, values = next((i, pair) for i, pair in pairs if pair[0] != pair[1])
    first, second = ("missing" if v is None else json.dumps(v)[:LONGEST_VALUE] for v in values)
    return f"{sizes}; value {number} is {first} in the file and {second} in the config"
