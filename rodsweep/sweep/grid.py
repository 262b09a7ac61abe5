"""The points of a sweep, by index and never all at once: a grid of axes or an explicit list."""

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..config.schema import Parameters, as_number
from ..errors import InputError
from ..model.rod import ALLOWED, PARAMETERS, Rod, admissible


@dataclass(frozen=True, slots=True)
class Points:
    """Values of F, k1, k2, gamma3: a grid's axes (row-major order, gamma3 fastest) or equal columns."""

    columns: tuple[NDArray[np.float64], ...]
    is_grid: bool

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a result variable: (F, k1, k2, gamma3) or (point,)."""
        return tuple(len(c) for c in self.columns) if self.is_grid else (len(self.columns[0]),)

    @property
    def count(self) -> int:
        return math.prod(self.shape)

    def rod(self, index: int) -> Rod:
        """The rod at a flat index."""
        if not self.is_grid:
            return Rod(*(float(c[index]) for c in self.columns))
        places = np.unravel_index(index, self.shape)
        return Rod(*(float(c[i]) for c, i in zip(self.columns, places, strict=True)))


def grid_size(parameters: Parameters) -> int:
    """Number of points of a grid, known before its axes are made; 0 for a list."""
    if parameters.points is not None:
        return 0
    return math.prod(getattr(parameters, name).size for name in PARAMETERS)


def points_of(parameters: Parameters, directory: Path) -> Points:
    """The points that the config asks for; InputError for any value that the model does not allow."""
    if parameters.points is not None:
        return Points(_read_csv(directory / parameters.points), is_grid=False)
    axes = [getattr(parameters, name) for name in PARAMETERS]
    points = Points(tuple(axis.array() for axis in axes), is_grid=True)
    for name, column in zip(PARAMETERS, points.columns, strict=True):
        bad = [value for value in column.tolist() if not admissible(name, value)]
        if bad:
            raise InputError(f"parameters.{name} = {bad[0]:g} is not allowed; it must be {ALLOWED[name]}")
    F, k1 = points.columns[0], points.columns[1]
    if F.max() >= k1.min():
        raise InputError(
            f"parameters.F reaches {F.max():.15g} and parameters.k1 starts at {k1.min():.15g}; F must stay "
            "below every k1, because the rod is crushed at F = k1"
        )
    return points


def _read_csv(path: Path) -> tuple[NDArray[np.float64], ...]:
    """The columns F, k1, k2, gamma3 of a CSV file with that header, in any order."""
    if path.exists() and not path.is_file():
        raise InputError(f"parameters.points: {path} is not a file")
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = csv.reader(file)
            header = [cell.strip() for cell in next(rows, [])]
            if sorted(header) != sorted(PARAMETERS):
                raise InputError(
                    f"{path}: the header is {','.join(header)[:100]!r}; it must name {', '.join(PARAMETERS)}"
                )
            values = [_row(row, header, f"{path}, line {rows.line_num}") for row in rows if row]
    except OSError as error:
        raise InputError(f"parameters.points: {path} cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"parameters.points: {path} is not CSV text ({error})") from error
    if not values:
        raise InputError(f"{path}: there is no point after the header")
    table = np.array(values)
    return tuple(table[:, header.index(name)] for name in PARAMETERS)


def _row(row: list[str], header: list[str], where: str) -> list[float]:
    if len(row) != len(header):
        raise InputError(f"{where}: {len(row)} values, where the header names {len(header)}")
    numbers = []
    for cell, name in zip(row, header, strict=True):
        try:
            if "_" in cell or not cell.isascii():
                raise ValueError
            numbers.append(as_number(float(cell)))
        except ValueError:
            raise InputError(f"{where}: {name} = {cell.strip()[:40]!r} is not a number") from None
    try:
        Rod(**dict(zip(header, numbers, strict=True)))
    except ValueError as error:
        raise InputError(f"{where}: {error}") from None
    return numbers
