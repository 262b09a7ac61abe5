"""Lists of points from CSV files, whose header names the parameters in any order."""

import csv
from array import array
from collections.abc import Iterator
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from ...arrays import Array
from ...config.values import cell_number
from ...errors import InputError, short_repr
from ...model.material.rod_material import DEFAULT_MATERIAL, RodMaterial
from ...model.parameters import PARAMETERS
from ...model.rod import Rod
from ...wording import counted, enumeration
from .points import NEUTRAL_VALUES

MAX_LINE_LENGTH = 10_000
"""A CSV file with a line of this many characters or more is refused; a long line could fill the memory."""


def read_points(
    path: Path, names: tuple[str, ...], material: RodMaterial = DEFAULT_MATERIAL
) -> tuple[Array, ...]:
    """Columns, (points,) each, of a CSV file that lists points, in the order of the parameters `names`. The
    header has the same names in any order. material: constitutive law and profile of the rods. Raises
    InputError for an unreadable file, a wrong header, a file without points, or parameter values outside the
    model."""
    try:
        if path.exists() and not path.is_file():  # opening a pipe would wait for its other end
            raise InputError(f"parameters.points: {path} is not a file")
        # Spreadsheet programs write a byte-order mark, which utf-8-sig removes.
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = csv.reader(_lines(file, path))
            header = [cell.strip() for cell in next(rows, [])]
            if sorted(header) != sorted(names):
                raise InputError(
                    f"{path}: {_wrong_header_fault(header)}; it must name {enumeration(names, 'and')}"
                )
            columns = [array("d") for _ in header]  # a Python list would take eight times the memory
            # Empty lines, as at the end of many files, are no points.
            for row in filter(None, rows):
                numbers = _row_numbers(row, header, f"{path}, line {rows.line_num}", material)
                for column, number in zip(columns, numbers, strict=True):
                    column.append(number)
    except MemoryError:
        raise InputError(f"{path} is too large to be read; divide the list of points") from None
    except OSError as error:
        raise InputError(f"parameters.points: {path} cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"parameters.points: {path} is not CSV text ({error})") from error
    if not columns[0]:
        raise InputError(f"{path}: there is no point after the header; write one point in each line below it")
    return tuple(np.array(columns[header.index(name)]) for name in names)


def _wrong_header_fault(header: list[str]) -> str:
    """Fault of a wrong header as a phrase. A header without parameter names is not quoted."""
    if "" in header and set(header) & set(PARAMETERS):
        return f"the header {short_repr(','.join(header))} has an empty name"
    if set(header) & set(PARAMETERS) and all(cell.isidentifier() for cell in header):
        return f"the header is {short_repr(','.join(header))}"
    for separator, word in {";": "semicolons", "\t": "tabs"}.items():
        if len(header) == 1 and set(header[0].split(separator)) & set(PARAMETERS):
            return f"the columns are separated by {word}; separate them by commas"
    if {cell.partition("[")[0].strip() for cell in header} & (set(PARAMETERS) - set(header)):
        return "a name in the header is followed by a unit; leave the units out"
    return "the first line names no parameter"


def _lines(file: TextIO, path: Path) -> Iterator[str]:
    """Yields the lines of a text file; raises InputError for a line of MAX_LINE_LENGTH characters or more."""
    # A file without line breaks must not be read into memory as one line.
    while line := file.readline(MAX_LINE_LENGTH):
        if len(line) == MAX_LINE_LENGTH:
            raise InputError(
                f"{path}: a line has {MAX_LINE_LENGTH} characters or more; write one point in each line"
            )
        yield line


def _row_numbers(row: list[str], header: list[str], row_text: str, material: RodMaterial) -> list[float]:
    """Numbers in a row of the file; InputError for a cell that is not a number, or for values outside the
    model. header: names of the columns. row_text: file and line, for the message."""
    if len(row) != len(header):
        raise InputError(
            f"{row_text} has {counted(len(row), 'value')}, but the header names {len(header)}; give a "
            "value for each name of the header"
        )
    numbers = []
    for cell, name in zip(row, header, strict=True):
        try:
            numbers.append(cell_number(cell))
        except ValueError:
            raise InputError(f"{row_text}: {name} = {cell.strip()[:40]!r} is not a number") from None
    parameters: dict[str, Any] = {**NEUTRAL_VALUES, **dict(zip(header, numbers, strict=True))}
    try:
        # The rod itself checks combinations such as F below k1, so that no rule is written twice.
        rod = Rod(**parameters, material=material)
        material.refuse_extreme_load(rod.F, rod.k1, rod.taper)
    except ValueError as error:
        raise InputError(f"{row_text}: {error}") from None
    return numbers
