"""Results as tables with one row for each item, for `rodsweep export` and for DataFrames in Python."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...model.parameters import PARAMETERS
from ...results.file.view import View
from ..branch_curves import followed_parameter
from .branches import merged_columns, merged_rows
from .columns import Column
from .contents import BRANCHES, GRID, POINTS, Contents, chosen, contents_of, refuse_unknown
from .rows import Rows, item_rows, line_columns, list_columns, point_columns, si_columns


@dataclass(frozen=True, slots=True)
class Table:
    """A table: its name, columns of equal length, and the number of points without a row."""

    name: str
    columns: tuple[Column, ...]
    empty_points: int
    others: tuple[str, ...]
    """Names of the other tables of the result."""

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.columns[0].values)


@dataclass(frozen=True)
class Tables:
    """All tables of a result, each made on request."""

    view: View

    def __post_init__(self) -> None:
        """Turns a grid over an arm's quantities into the list of its points."""
        object.__setattr__(self, "view", self.view.listed)

    @cached_property
    def contents(self) -> Contents:
        """Names and variables of the tables of the result."""
        return contents_of(self.view)

    def table(self, name: str | None = None, columns: Sequence[str] = ()) -> Table:
        """A table, by name or by its columns; by default the first table of the task.

        columns: names of the columns, in order; by default all, but of the points of a list only parameters,
        quantities and status. Raises InputError for an unknown name.
        """
        name = chosen(self.view, self.contents, name, tuple(columns))
        points, found = self._rows(name)
        beside = [] if points is None else list(point_columns(self.view, self.contents.of_points, points))
        if name == GRID:  # its first column is a parameter, which takes its place among the other parameters
            before = list(PARAMETERS)[: list(PARAMETERS).index(found[0].name)]
            beside.insert(sum(column.name in before for column in beside), found.pop(0))
        by_name = {column.name: column for column in (*beside, *found)}
        refuse_unknown(self.view.path, tuple(columns), tuple(by_name), name)
        if not columns:
            hidden = {v.name for v in self.contents.of_points if v.name != "status"}
            columns = [each for each in by_name if name == POINTS or each not in hidden]
        empty = 0 if points is None else self.view.variables["status"].size - len(np.unique(points))
        others = tuple(other for other in self.contents.tables if other != name)
        return Table(name, tuple(by_name[each] for each in columns), empty, others)

    def items(self, name: str) -> tuple[Column, ...]:
        """Columns of a list, without the columns of points."""
        return tuple(self._rows(name)[1])

    def _rows(self, name: str) -> tuple[NDArray[np.int64] | None, list[Column]]:
        """(point of every row of a table, or None for rows without points; columns of the items)."""
        if name == POINTS:
            return np.arange(self.view.variables["status"].size), []
        if name == BRANCHES:
            return self._branches()
        rows, columns = self._list(name)
        return None if name in self.contents.joint else rows[0], columns

    def _list(self, name: str) -> tuple[Rows, list[Column]]:
        """(rows of a list, its columns, in SI units as well)."""
        joint = name in self.contents.joint
        variables = self.contents.lists[name]
        rows = item_rows(self.view, variables, joint)
        columns = list(list_columns(self.view, variables, rows, joint))
        columns += line_columns(self.view, rows) if name == GRID else ()
        points = None if joint else rows[0]
        return rows, [*columns, *si_columns(self.view, variables, columns, points)]

    def _branches(self) -> tuple[NDArray[np.int64], list[Column]]:
        """(point of every row, columns) of the cycles of branches with special points between them."""
        cycles, of_cycles = self._list("cycles")
        special, of_special = self._list("special_points")
        points, of_cycle, at_special = merged_rows(self.view, cycles, special)
        along = followed_parameter(self.view)
        return points, merged_columns(of_cycles, of_special, of_cycle, at_special, along)
