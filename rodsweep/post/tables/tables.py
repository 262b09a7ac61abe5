"""Results as tables with one row per item, for `rodsweep export` and for pandas DataFrames."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...model.arm.quantities import LOADS
from ...model.parameters import PARAMETERS
from ...results.file.view import View
from ..branch_curves import followed_parameter
from . import table_names
from .column import Column
from .rows_and_columns import Rows, item_rows, line_columns, list_columns, point_columns, si_columns


@dataclass(frozen=True, slots=True)
class Table:
    """Table of results. name: name of the table. columns: columns of equal length. empty_points: number of
    points without a row.
    """

    name: str
    columns: tuple[Column, ...]
    empty_points: int
    other_tables: tuple[str, ...]
    """Names of the other tables of the same result."""

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.columns[0].values)


@dataclass(frozen=True)
class Tables:
    """All tables of the result `view`; a table is made when it is requested."""

    view: View

    def __post_init__(self) -> None:
        """Replaces a grid over an arm's quantities by the list of its points."""
        object.__setattr__(self, "view", self.view.as_list)

    @cached_property
    def contents(self) -> table_names.TableContents:
        """Names of the tables of the result, and the variables in each table."""
        return table_names.table_contents_of(self.view)

    def table(self, name: str | None = None, columns: Sequence[str] = ()) -> Table:
        """The table with the given name or columns; by default the default table of the task.

        columns: names in the order of the output; by default all columns, but for a list only the parameters,
        quantities and status of the points and the columns of the list. Raises InputError for an unknown
        name.
        """
        name = table_names.chosen_table(self.view, self.contents, name, tuple(columns))
        points, found = self._rows(name)
        beside = (
            [] if points is None else list(point_columns(self.view, self.contents.point_variables, points))
        )
        if (
            name == table_names.GRID
        ):  # move the first column, a parameter, to its place among the other parameters
            before = list(PARAMETERS)[: list(PARAMETERS).index(found[0].name)]
            beside.insert(sum(column.name in before for column in beside), found.pop(0))
        by_name = {column.name: column for column in (*beside, *found)}
        table_names.refuse_unknown_columns(self.view.path, tuple(columns), tuple(by_name), name)
        if not columns:
            hidden = {v.name for v in self.contents.point_variables if v.name != "status"}
            columns = [each for each in by_name if name == table_names.POINTS or each not in hidden]
        empty = 0 if points is None else self.view.variables["status"].size - len(np.unique(points))
        others = tuple(other for other in self.contents.tables if other != name)
        return Table(name, tuple(by_name[each] for each in columns), empty, others)

    def list_columns(self, name: str) -> tuple[Column, ...]:
        """Columns of the list `name`, without the columns of the points."""
        return tuple(self._rows(name)[1])

    def _rows(self, name: str) -> tuple[NDArray[np.int64] | None, list[Column]]:
        """Returns (point_indices, columns) for the table `name`. point_indices: index of the point of each
        row, (rows,); None if the rows belong to no point. columns: columns of the items.
        """
        if name == table_names.POINTS:
            return np.arange(self.view.variables["status"].size), []
        if name == table_names.BRANCHES:
            return self._branches()
        rows, columns = self._list(name)
        return None if name in self.contents.sweep_wide_lists else rows[0], columns

    def _list(self, name: str) -> tuple[Rows, list[Column]]:
        """Returns (rows, columns) of the list `name`. rows: indices of the items. columns: columns, including
        columns in SI units.
        """
        is_sweep_wide = name in self.contents.sweep_wide_lists
        variables = self.contents.lists[name]
        rows = item_rows(self.view, variables, is_sweep_wide)
        columns = list(list_columns(self.view, variables, rows, is_sweep_wide))
        columns += line_columns(self.view, rows) if name == table_names.GRID else ()
        points = None if is_sweep_wide else rows[0]
        return rows, [*columns, *si_columns(self.view, variables, columns, points)]

    def _branches(self) -> tuple[NDArray[np.int64], list[Column]]:
        """Returns (point_indices, columns) of the table `branches`: cycles, with special points between the
        cycles. point_indices: index of the point of each row, (rows,).
        """
        cycles, of_cycles = self._list("cycles")
        special, of_special = self._list("special_points")
        points, of_cycle, at_special = merged_rows(self.view, cycles, special)
        along = followed_parameter(self.view)
        return points, merged_columns(of_cycles, of_special, of_cycle, at_special, along)


def merged_rows(view: View, cycles: Rows, special: Rows) -> tuple[NDArray, NDArray, NDArray]:
    """Returns (points, of_cycle, of_special), (rows,) each, for the rows of the table `branches` in order.

    points: index of the point. of_cycle, of_special: row in `cycles` and in `special`; -1 if the row is not a
    cycle, or not a special point. A special point follows the cycle that precedes it on the branch.
    """
    shape = view.variables["status"].size
    branch = np.concatenate(
        [
            _values_at_items(view, "branch", shape, cycles),
            _values_at_items(view, "special_branch", shape, special),
        ]
    )
    place = np.concatenate([cycles[1] + 1, _values_at_items(view, "special_point", shape, special)])
    point = np.concatenate([cycles[0], special[0]])
    kind = np.repeat([0, 1], [len(cycles[0]), len(special[0])])
    order = np.lexsort((np.concatenate([cycles[1], special[1]]), kind, place, branch, point))
    row = np.concatenate([np.arange(len(cycles[0])), np.arange(len(special[0]))])
    of_cycle = np.where(kind == 0, row, -1)
    of_special = np.where(kind == 1, row, -1)
    return point[order], of_cycle[order], of_special[order]


def merged_columns(
    cycles: list[Column], special: list[Column], of_cycle: NDArray, of_special: NDArray, along: str
) -> list[Column]:
    """Columns of the table `branches`: the columns of cycles, with values at special points in the rows of
    special points, and the kind of special point.

    of_cycle, of_special: as from `merged_rows`, (rows,). along: followed parameter.
    """
    named = {column.name: column for column in special}
    merged = []
    for column in cycles:
        values = column.rows(of_cycle)
        counterpart = named.get(_special_variable_name(column.name, along))
        if counterpart is not None:
            others = counterpart.rows(of_special)
            both = np.where(values.absent, others.values, values.values)
            values = replace(values, values=both, absent=values.absent & others.absent)
        merged.append(values)
    return [*merged, named["special_kind"].rows(of_special)]


def _special_variable_name(name: str, along: str) -> str:
    """Name of the variable of special points that corresponds to the variable `name` of cycles. along:
    followed parameter.
    """
    if name == f"branch_{along}":
        return "special_at"
    if along == "F" and name in {f"branch_{load}" for load in LOADS}:
        return "special_at_si"
    return f"special_{name}"


def _values_at_items(view: View, name: str, count: int, rows: Rows) -> NDArray:
    """Values of the variable `name` at the items of a list, (rows,). count: number of points. rows: indices
    of the items.
    """
    return view.variables[name].reshape(count, -1)[rows]
