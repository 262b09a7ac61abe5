"""The points of a sweep, by index and never all at once: a grid, of axes or of an arm, or a list."""

import csv
import math
from array import array
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..config.arm import ArmGrid, ArmSection
from ..config.arm_axes import CRUSHED, MOST_POINTS, SLENDER, moved_by
from ..config.axes import words
from ..config.schema import Config
from ..config.values import as_number, overflows, short
from ..errors import InputError
from ..model.arm import CRUSHED_FROM, SlenderArm
from ..model.parameters import CRUSHING, PARAMETERS, Range
from ..model.rod import Rod

LONGEST_LINE = 10_000
"""Characters of a line of a CSV file."""
NEUTRAL = {name: parameter.neutral for name, parameter in PARAMETERS.items()}
"""Values of parameters that are no column, with which a rod is one if it is with any."""


@dataclass(frozen=True, slots=True)
class Points:
    """Values of some parameters: a grid's axes (row-major order, the last fastest) or equal columns.

    Columns are of the points of a list, or of a grid over the quantities of an arm.
    """

    names: tuple[str, ...]
    """The parameter of each column."""
    columns: tuple[Array, ...]
    is_grid: bool
    """Whether the columns are the axes of a grid."""
    over: dict[str, Array] = field(default_factory=dict)
    """The axes of a grid over an arm's quantities, in SI."""
    units: dict[str, Array] = field(default_factory=dict)
    """The units that the arm makes at every point of such a grid, (points,)."""
    covered: NDArray[np.int8] | None = None
    """Whether a rod covers each point of an arm, as `rodsweep.config.arm_axes` numbers it, (points,)."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a result variable: one dimension per axis, or (point,)."""
        return tuple(map(len, self.axes.values())) or (len(self.columns[0]),)

    @property
    def axes(self) -> dict[str, Array]:
        """The axes of a grid of either kind by name; none of a list."""
        return self.by_name if self.is_grid else self.over

    @property
    def moved(self) -> tuple[str, ...]:
        """The one parameter that each axis moves; empty where it moves several or none."""
        return self.names if self.is_grid else tuple(map(moved_by, self.over))

    @property
    def identity(self) -> list[Array]:
        """What tells these points from all others of a config: values of axes and columns, each (n,)."""
        return [*self.over.values(), *self.columns]

    @property
    def of_rods(self) -> dict[str, Array]:
        """The columns by their parameters, without points that no rod covers."""
        if self.covered is None:
            return self.by_name
        return self.values_of(np.flatnonzero(self.covered == SLENDER))

    def has_rod(self, index: int) -> bool:
        """Whether a rod covers a point."""
        return self.covered is None or self.covered[index] == SLENDER

    @property
    def by_name(self) -> dict[str, Array]:
        """The columns by their parameters."""
        return dict(zip(self.names, self.columns, strict=True))

    @property
    def count(self) -> int:
        return math.prod(self.shape)

    def values(self, index: int) -> dict[str, float]:
        """The parameters at a flat index, by name."""
        values = {}
        for name, column in zip(reversed(self.names), reversed(self.columns), strict=True):
            place = index
            if self.is_grid:  # NumPy's unravel_index takes three times as long
                index, place = divmod(index, len(column))
            values[name] = float(column[place])
        return {name: values[name] for name in self.names}

    def values_of(self, indices: NDArray[np.int64]) -> dict[str, Array]:
        """The parameters at flat indices, (n,), by name, each (n,)."""
        places = np.unravel_index(indices, self.shape) if self.is_grid else [indices] * len(self.names)
        return {
            name: column[place] for name, column, place in zip(self.names, self.columns, places, strict=True)
        }

    def rod(self, index: int, **beside: float) -> Rod:
        """The rod at a flat index, with other parameters beside the columns'; else they are NEUTRAL.

        Raises Crushed.
        """
        return Rod(**{**NEUTRAL, **self.values(index), **beside})


def grid_size(config: Config) -> int:
    """Number of points of a grid of parameters, known before its axes are made; 0 for others."""
    if config.parameters.is_list or config.parameters.over:
        return 0
    return math.prod(config.parameters.axes[name].size for name in config.names)


def points_of(config: Config, directory: Path) -> Points:
    """The points that the config asks for; InputError for any value that the model does not allow."""
    parameters = config.parameters
    for name, value in parameters.numbers.items():
        refuse_outside(PARAMETERS[name].allowed, name, (value,))
    if parameters.points is not None:
        columns = _read_csv(directory / parameters.points, config.names)
        return Points(config.names, columns, is_grid=False)
    axes = {name: axis.array() for name, axis in parameters.axes.items()}
    if parameters.arm is not None and parameters.over:
        return _own_grid(parameters.arm, axes, config.names)
    named = {name: axes[name] for name in config.names}
    covered = None if parameters.arm is None else _partly_crushed(named)
    refuse_axes(axes, config.into_crushed or covered is not None)
    return Points(config.names, tuple(named.values()), is_grid=True, covered=covered)


def _partly_crushed(axes: dict[str, Array]) -> NDArray[np.int8] | None:
    """Which points of an arm's grid of parameters its load crushes, (points,); None where all or none are."""
    count = math.prod(map(len, axes.values()))
    if not set(CRUSHING) <= axes.keys() or axes["F"].max() < axes["k1"].min() or count > MOST_POINTS:
        return None
    F, k1 = (axes[name].reshape([-1 if each == name else 1 for each in axes]) for name in CRUSHING)
    shape = tuple(map(len, axes.values()))
    crushed = np.broadcast_to(CRUSHED_FROM * k1 <= F, shape).ravel()
    return None if crushed.all() else np.where(crushed, CRUSHED, SLENDER).astype(np.int8)


def _own_grid(arm: ArmSection, beside: dict[str, Array], names: tuple[str, ...]) -> Points:
    """The grid over an arm's quantities and the parameters beside it, each (n,)."""
    for name, column in beside.items():
        refuse_outside(PARAMETERS[name].allowed, name, column)
    try:
        grid: ArmGrid = arm.own_grid(beside, _first_flutter)
    except ValueError as error:
        raise InputError(str(error)) from None
    columns = tuple(grid.parameters[name] for name in names)
    return Points(names, columns, False, grid.axes, grid.units, grid.covered)


def _first_flutter(arm: SlenderArm) -> float:
    """The F at which an arm flutters first in any plane, inf where it does not; imports its solver."""
    from ..verdict.relative import first_flutter

    return first_flutter(arm)


def refuse_outside(
    allowed: Range, name: str, values: Iterable[float], where: str = "", why: str = ""
) -> None:
    """InputError for the first value of a parameter that is not allowed; `where` it is not, and `why`."""
    bad = allowed.first_outside(values)
    if bad is not None:
        raise InputError(
            f"parameters.{name} = {bad:g} is not allowed{where}; it must be {allowed.phrase}{why}"
        )


def refuse_axes(axes: dict[str, Array], into_crushed: bool = False) -> None:
    """InputError for a value of an axis, each (n,), that is not allowed, and for rods that are crushed.

    into_crushed: whether some may be, though not all.
    """
    for name, column in axes.items():
        refuse_outside(PARAMETERS[name].allowed, name, column)
    if set(CRUSHING) <= axes.keys():
        _refuse_crushed(axes["F"], axes["k1"], into_crushed)


def _refuse_crushed(F: Array, k1: Array, some: bool) -> None:
    """InputError where a grid has crushed rods; where `some` may be, only if it has no other."""
    if some and F.min() >= k1.max():
        raise InputError(
            f"parameters.F starts at {F.min():.15g} and parameters.k1 ends at {k1.max():.15g}; the rod is "
            "crushed where F >= k1, which is everywhere here"
        )
    if not some and F.max() >= k1.min():
        raise InputError(
            f"parameters.F reaches {F.max():.15g} and parameters.k1 starts at {k1.min():.15g}; F must stay "
            "below every k1, because the rod is crushed at F = k1"
        )


def _read_csv(path: Path, names: tuple[str, ...]) -> tuple[Array, ...]:
    """The columns `names` of a CSV file with that header, in any order."""
    try:
        if path.exists() and not path.is_file():  # to open a pipe would be to wait for its other end
            raise InputError(f"parameters.points: {path} is not a file")
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = csv.reader(_lines(file, path))
            header = [cell.strip() for cell in next(rows, [])]
            if sorted(header) != sorted(names):
                raise InputError(f"{path}: {_header_told(header)}; it must name {words(names, 'and')}")
            columns = [array("d") for _ in header]  # a list of numbers would take eight times the memory
            for row in filter(None, rows):
                numbers = _row(row, header, f"{path}, line {rows.line_num}")
                for column, number in zip(columns, numbers, strict=True):
                    column.append(number)
    except MemoryError:
        raise InputError(f"{path} is too large to be read") from None
    except OSError as error:
        raise InputError(f"parameters.points: {path} cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"parameters.points: {path} is not CSV text ({error})") from error
    if not columns[0]:
        raise InputError(f"{path}: there is no point after the header")
    return tuple(np.array(columns[header.index(name)]) for name in names)


def _header_told(header: list[str]) -> str:
    """What is wrong with a header: quoted only where it is one, for any file may be given for a list."""
    if set(header) & set(PARAMETERS) and all(cell.isidentifier() for cell in header):
        return f"the header is {short(','.join(header))}"
    return "the first line names no parameter"


def _lines(file: TextIO, path: Path) -> Iterator[str]:
    """The lines of a text; InputError at one that has no end in sight."""
    while line := file.readline(LONGEST_LINE):
        if len(line) == LONGEST_LINE:
            raise InputError(f"{path}: a line has {LONGEST_LINE} characters or more, which no point needs")
        yield line


def _row(row: list[str], header: list[str], where: str) -> list[float]:
    if len(row) != len(header):
        raise InputError(f"{where}: {len(row)} values, where the header names {len(header)}")
    numbers = []
    for cell, name in zip(row, header, strict=True):
        try:
            if "_" in cell or not cell.isascii() or overflows(cell):
                raise ValueError
            numbers.append(as_number(float(cell)))
        except ValueError:
            raise InputError(f"{where}: {name} = {cell.strip()[:40]!r} is not a number") from None
    try:
        Rod(**{**NEUTRAL, **dict(zip(header, numbers, strict=True))})
    except ValueError as error:
        raise InputError(f"{where}: {error}") from None
    return numbers
