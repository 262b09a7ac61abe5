"""CSV files of profiles along an arm: the file named by `material.profile` of a config, read into columns."""

import csv
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..model.material.profile import FACTOR_NAMES
from .material import MAX_PROFILE_ROWS
from .values import cell_number, short_repr

MAX_PROFILE_CHARACTERS = 1_000_000
"""Maximum number of characters in the CSV file of a profile; longer files are refused."""


def with_profile_read(tree: Any, directory: Path) -> Any:
    """The parsed config `tree` with the file name in `material.profile` replaced by the columns of the file.

    directory: folder of a relative file name. Raises InputError if the file is not a table of numbers.
    """
    if not isinstance(tree, dict) or not isinstance(tree.get("material"), dict):
        return tree
    name = tree["material"].get("profile")
    if not isinstance(name, str):
        return tree
    if not name.strip():
        raise InputError("material.profile is empty; it should be the name of a CSV file")
    return tree | {"material": tree["material"] | {"profile": read_profile(directory / name)}}


def read_profile(path: Path) -> dict[str, list[float]]:
    """Columns of the CSV file of a profile, by name in the header; InputError for an invalid file."""
    where = f"material.profile: {path}"
    try:
        if not path.is_file():
            raise InputError(f"{where} {'is not a file' if path.exists() else 'does not exist'}")
        with path.open(newline="", encoding="utf-8-sig") as file:
            text = file.read(MAX_PROFILE_CHARACTERS + 1)
        rows = [[cell.strip() for cell in row] for row in csv.reader(text.splitlines()) if row]
    except OSError as error:
        raise InputError(f"{where} cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{where} is not CSV text ({error})") from error
    if len(text) > MAX_PROFILE_CHARACTERS or len(rows) > MAX_PROFILE_ROWS + 1:
        raise InputError(f"{where} has more than {MAX_PROFILE_ROWS} rows")
    header = rows[0] if rows else []
    if "u" not in header or not set(header) <= {"u", *FACTOR_NAMES} or len(set(header)) < len(header):
        raise InputError(f"{where}: the header must name u and any of {', '.join(FACTOR_NAMES)}, each once")
    columns: dict[str, list[float]] = {name: [] for name in header}
    for number, row in enumerate(rows[1:], 1):
        row_name = f"{where}: row {number}"
        if len(row) != len(header):
            raise InputError(f"{row_name} has {len(row)} values, but the header names {len(header)}")
        for name, cell in zip(header, row, strict=True):
            try:
                columns[name].append(cell_number(cell))
            except ValueError:
                raise InputError(f"{row_name}: {name} = {short_repr(cell)} is not a number") from None
    return columns
