"""Results as tables with one row an item: what `rodsweep export` writes, and Python's DataFrames."""

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
    """A table: its name, its columns with equal numbers of rows, and how many points have no row in it."""

    name: str
    columns: tuple[Column, ...]
    empty_points: int
    others: tuple[str, ...]
    """Names of the other tables of the result."""

    @property
    def rows(self) -> int:
        return len(self.columns[0].values)


@dataclass(frozen=True)
class Tables:
    """All tables of a result; each is made when it is asked for."""

    view: View

    def __post_init__(self) -> None:
        """A grid over an arm's quantities is a list of its points, as any table."""
        object.__setattr__(self, "view", self.view.listed)

    @cached_property
    def contents(self) -> Contents:
        """Names and variables of the result's tables."""
        return contents_of(self.view)

    def table(self, name: str | None = None, columns: Sequence[str] = ()) -> Table:
        """A table by its name, the one that has the columns, or the first of the task.

        columns: names of those that are wanted, in their order; by default all, and of the points of a list
        only parameters, quantities and status. InputError for a name that there is not.
        """
        name = chosen(self.view, self.contents, name, tuple(columns))
        points, found = self._rows(name)
        beside = [] if points is None else list(point_columns(self.view, self.contents.of_points, points))
        if name == GRID:  # whose first column is a parameter: in the order of parameters, as everywhere
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
        """The columns of a list without those of its points."""
        return tuple(self._rows(name)[1])

    def _rows(self, name: str) -> tuple[NDArray[np.int64] | None, list[Column]]:
        """(the point of every row of a table, None where rows have none; the columns of its items)."""
        if name == POINTS:
            return np.arange(self.view.variables["status"].size), []
        if name == BRANCHES:
            return self._branches()
        rows, columns = self._list(name)
        return None if name in self.contents.joint else rows[0], columns

    def _list(self, name: str) -> tuple[Rows, list[Column]]:
        joint, variables = name in self.contents.joint, self.contents.lists[name]
        rows = item_rows(self.view, variables, joint)
        columns = list(list_columns(self.view, variables, rows, joint))
        columns += line_columns(self.view, rows) if name == GRID else ()
        points = None if joint else rows[0]
        return rows, [*columns, *si_columns(self.view, variables, columns, points)]

    def _branches(self) -> tuple[NDArray[np.int64], list[Column]]:
        """The cycles of branches with the special points between them."""
        (cycles, of_cycles), (special, of_special) = self._list("cycles"), self._list("special_points")
        points, of_cycle, at_special = merged_rows(self.view, cycles, special)
        along = followed_parameter(self.view)
        return points, merged_columns(of_cycles, of_special, of_cycle, at_special, along)
