"""File names on the command line: targets of symbolic links, default names, and endings."""

import errno
import os
from pathlib import Path
from typing import Any

import click

from ..errors import InputError
from ..results import RESULT_SUFFIXES


class FileNameType(click.Path):
    """Type of arguments and options that name a file. An empty text, such as the value of an unset variable
    of the shell, is refused; `Path` would read it as the working directory."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Path of the text `value`. Raises InputError for an empty text."""
        if value == "" and param is not None:
            name = param.human_readable_name if isinstance(param, click.Argument) else param.opts[-1]
            raise InputError(f"{name.strip('.[]')} is empty; give the name of a file")
        return super().convert(value, param, ctx)


FILE_TYPE = FileNameType(path_type=Path)
"""Type of arguments and options that name a file."""
OUTPUT_OPTION_NAMES = ("-o", "--output")
"""Names of the option for the file that a command writes."""


def result_file_path(path: Path) -> Path:
    """Path of a result file, symbolic links resolved; InputError for a directory or a wrong ending."""
    allowed_endings = ", ".join(RESULT_SUFFIXES)
    if path.is_dir() or not path.name:
        raise InputError(f"{path} is a directory; name a file for results, which ends in {allowed_endings}")
    if path.suffix not in RESULT_SUFFIXES:
        raise InputError(
            f"{path} is not a name for results, which are HDF5: it must end in {allowed_endings}"
        )
    return link_target(path)


def with_suffix_replaced(file: Path, suffix: str) -> Path:
    """Path of `file` with its suffix replaced by `suffix`; InputError for a directory."""
    if file.is_dir():
        raise InputError(f"{file} is a directory; name a file")
    return file.with_name(file.stem + suffix)


def link_target(path: Path) -> Path:
    """Target of a symbolic link; a path that is not a link is returned unchanged.

    The journal of a result is in the folder of the target. Raises InputError for a link that leads to itself.
    """
    if not path.is_symlink():
        return path
    try:
        path.stat()
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise InputError(f"{path} is a link that leads to itself; name a file") from None
    return Path(os.path.realpath(path))
