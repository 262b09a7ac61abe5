"""Files named in a config: the content becomes keys of the config before validation."""

import csv
from pathlib import Path
from typing import Any

from ...model.parameters import OPTIONAL_PARAMETERS
from ..material import with_profile_read

LONGEST_HEADER = 10_000
"""Largest number of characters of a header. A longer first line is no header; the reader of points refuses
the file."""


def with_files_read(tree: Any, directory: Path) -> Any:
    """A config's tree, with the columns of the profile's file, and with the names of columns of the list of
    points if omitted.

    directory: folder of relative file names. Raises InputError for a profile that is no table of numbers.
    """
    return _with_columns(with_profile_read(tree, directory), directory)


def _with_columns(tree: Any, directory: Path) -> Any:
    """The tree with `parameters.columns`, if the file of points has columns beside those of every list."""
    parameters = tree.get("parameters") if isinstance(tree, dict) else None
    if not isinstance(parameters, dict) or not isinstance(parameters.get("points"), str):
        return tree
    if parameters.get("columns") is not None:
        return tree
    header = _header(directory / parameters["points"])
    columns = [name for name in OPTIONAL_PARAMETERS if name in header]
    return tree | {"parameters": parameters | {"columns": columns}} if columns else tree


def _header(path: Path) -> list[str]:
    """Names in the first line of a CSV file; empty without a header. The reader of points refuses a file
    without a header."""
    try:
        if not path.is_file():
            return []
        with path.open(newline="", encoding="utf-8-sig") as file:
            line = file.readline(LONGEST_HEADER)
        return [cell.strip() for cell in next(csv.reader([line]), [])]
    except (OSError, ValueError, csv.Error):
        return []
