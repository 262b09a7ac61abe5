"""Validation of a result file: whether it is a complete rodsweep result, its header, and refusals."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ... import __version__
from ...config.values import printable
from ...errors import InputError
from ..layouts import layout_of
from ..layouts.variables import Layout
from .combination.config_comparison import fingerprint_of
from .content_digests import refuse_changed
from .points import points_of_open_file
from .seal import HDF5_SIGNATURE, OPEN_FOR_WRITING_CLAUSE, has_valid_structure_checksum

PROGRAM_NAME = "rodsweep"
"""Value of the attribute `program` of result files."""
FORMAT_NUMBER = 11
"""Value of the attribute `format` of result files. The format grows when a variable is added or changes in
meaning; files whose format number differs are refused. Format 5 was the first with sealed content; 6
introduced frequencies in Hz, counts from 1, the Hopf points between the points of a file of limit cycles, and
grids over an arm's quantities; in 9 `tip_theta_max` is the largest |theta|, not the largest theta."""
CONFIG_SUFFIXES = (".yaml", ".yml")
"""Suffixes of the names of config files."""
MAX_QUOTED_MESSAGE_LENGTH = 150
"""Maximum number of characters of a library's error message that a message of rodsweep quotes; longer
messages are cut."""
DAMAGE_EXCEPTIONS = (OSError, LookupError, ValueError, TypeError, RuntimeError, OverflowError, MemoryError)
"""Exceptions that h5py, or the use of the data it reads, raises for a damaged file."""


HDF5_LOCK_MESSAGE = "unable to lock file"
"""Part of the message with which HDF5 refuses a file that another process has open for writing."""


class InvalidResultFile(InputError):
    """Raised for a file that is not a rodsweep result, is damaged, or was changed."""


@contextmanager
def damage_as_refusals(path: Path) -> Iterator[None]:
    """Context that turns DAMAGE_EXCEPTIONS, which a damaged file or a file of another kind raises, into
    `InvalidResultFile`. path: the file, for the message."""
    try:
        yield
    except DAMAGE_EXCEPTIONS as error:
        reason = OPEN_FOR_WRITING_CLAUSE if HDF5_LOCK_MESSAGE in str(error) else one_line_message(error)
        raise InvalidResultFile(f"{path} cannot be read as a result of rodsweep: {reason}") from None


def one_line_message(error: Exception) -> str:
    """Message of a library's exception about a file, on one line, cut to MAX_QUOTED_MESSAGE_LENGTH
    characters."""
    text = getattr(error, "strerror", None) or str(error) or type(error).__name__
    text = "".join(character if character.isprintable() else " " for character in text)
    return text if len(text) <= MAX_QUOTED_MESSAGE_LENGTH else text[: MAX_QUOTED_MESSAGE_LENGTH - 3] + "..."


@dataclass(frozen=True, slots=True)
class ResultHeader:
    """Description of a complete result file at `path`. attributes: attributes of the file. layout: its
    variables.

    config: the resolved config. fingerprint: digest of config and points. point_count: number of points.
    """

    path: Path
    attributes: dict[str, Any]
    config: dict[str, Any]
    fingerprint: str
    layout: Layout
    point_count: int


def open_checked(path: Path, checks_values: bool = True) -> tuple[h5py.File, ResultHeader]:
    """Returns (open file, header); every reader opens a result file by this function.

    checks_values: whether the numbers of large variables are also compared with the seal, which takes a
    second per GB. Otherwise only HDF5's structures and small variables are compared, unless another program
    has written the file. Raises InputError unless the file is a complete result with the content written by
    rodsweep.
    """
    refuse_absent(path)
    if path.suffix in CONFIG_SUFFIXES:
        raise InvalidResultFile(
            f"{path} is a config, not a result file; `rodsweep run` makes a result file from it"
        )
    with damage_as_refusals(path):
        # Before HDF5 opens the file, because damaged structures can make it crash or loop.
        is_framed = has_valid_structure_checksum(path)
        file = h5py.File(path, "r")
        try:
            # Without the checksum another program has rewritten the file, so the numbers are always compared.
            return file, header_of(path, file, check_content=checks_values or not is_framed)
        except BaseException:
            file.close()
            raise


def read_header(path: Path) -> ResultHeader:
    """Header of a result file; raises InputError unless file and numbers are complete and unchanged."""
    file, header = open_checked(path)
    file.close()
    return header


def refuse_absent(path: Path) -> None:
    """Raises InputError if there is no file at `path`."""
    if not path.is_file():
        raise InputError(f"{path} is not a file" if path.exists() else f"{path} does not exist")


def header_of(path: Path, file: h5py.File, check_content: bool = True) -> ResultHeader:
    """Header of an open file; raises one of DAMAGE_EXCEPTIONS unless the file is a rodsweep result.

    check_content: whether the content is compared with the seal. Raises InputError for a format that this
    version does not read.
    """
    attributes = {name: escape_control_characters(value) for name, value in file.attrs.items()}
    if attributes.get("program") != PROGRAM_NAME:
        raise ValueError("the file was not written by rodsweep")
    _refuse_other_format(path, attributes)
    if check_content:
        refuse_changed(file)
    config = json.loads(attributes["config_resolved"])
    attributes.setdefault("task", config["task"])
    layout = layout_of(config)
    # Readers compute offsets from the layout, so a wrong shape would give wrong numbers without an error.
    require_variables_of_layout(file, layout)
    fingerprint = fingerprint_of(config, points_of_open_file(file, layout).identifying_arrays)
    return ResultHeader(path, attributes, config, fingerprint, layout, file["status"].size)


def escape_control_characters(value: Any) -> Any:
    """Value of an attribute, bytes decoded as UTF-8; control characters of a text are escaped, because a
    terminal would obey them."""
    if isinstance(value, bytes):
        value = value.decode(errors="replace")
    return printable(value) if isinstance(value, str) else value


def _refuse_other_format(path: Path, attributes: Mapping[str, Any]) -> None:
    """Raises InputError for a file whose format differs from FORMAT_NUMBER."""
    format_number = int(np.atleast_1d(attributes.get("format", 0))[0])  # netCDF stores a list of one number
    version, commit = (str(attributes.get(name, "unknown")) for name in ("rodsweep_version", "git_commit"))
    writer = f"{version}, commit {commit[:12]}"
    if format_number > FORMAT_NUMBER:
        raise InputError(
            f"{path} has format {format_number}, written by rodsweep {writer}; rodsweep {__version__} "
            f"reads format {FORMAT_NUMBER}: update rodsweep"
        )
    if format_number < FORMAT_NUMBER:
        raise InputError(
            f"{path} was written by an earlier rodsweep ({writer}) in format {format_number}, and this "
            f"rodsweep reads format {FORMAT_NUMBER}: read the file with that version, or compute it again, "
            "with --fresh or into another file"
        )


def require_variables_of_layout(file: h5py.File, layout: Layout) -> None:
    """Raises one of DAMAGE_EXCEPTIONS unless the file has the variables of a layout.

    Every variable must be contiguous and have the type and shape of the layout.
    """
    shape = tuple(len(file[name]) for name in layout.dimensions(is_list="point" in file))
    expected = {
        variable.name: (shape + layout.point_shape(variable), np.dtype(variable.dtype))
        for variable in layout.variables
    }
    expected |= {name: ((length,), file[name].dtype) for name, length in layout.extents.items()}
    for name, (extents, kind) in expected.items():
        dataset = file[name]
        if not isinstance(dataset, h5py.Dataset) or dataset.shape != extents or dataset.dtype != kind:
            raise ValueError(f"its variable {name} does not have the type and shape of its config")
        # Points are read without HDF5 at computed offsets, which only contiguous data have.
        if dataset.id.get_offset() is None or dataset.chunks or not dataset.id.get_storage_size():
            raise ValueError(
                f"its variable {name} is chunked, compressed or without data, as after a rewrite by another "
                "program"
            )


def is_rodsweep_or_damaged_file(path: Path) -> bool:
    """Whether a file is a rodsweep result, or an HDF5 file that is too damaged to be identified."""
    if not path.is_file():
        return False
    with path.open("rb") as stream:
        if stream.read(8) != HDF5_SIGNATURE:
            return False
    try:
        has_valid_structure_checksum(path)
        with h5py.File(path, "r") as file:
            return bool(file.attrs.get("program") == PROGRAM_NAME)
    except DAMAGE_EXCEPTIONS:
        return True
