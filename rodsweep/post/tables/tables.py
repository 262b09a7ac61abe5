"""Results as tables with one row per item, for `rodsweep export` and for pandas DataFrames."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...model.arm.quantities import LOAD_NAMES
from ...model.parameters import PARAMETERS
from ...results.file.view import ResultView
from ..branch_curves import followed_parameter
from . import table_names
from .column import Column
from .rows_and_columns import (
    ItemIndices,
    indices_of_items,
    list_columns,
    point_columns,
    si_columns,
    varying_quantity_columns,
)


@dataclass(frozen=True, slots=True)
class Table:
    """Table of results. name: name of the table. columns: columns of equal length. point_count_without_rows:
    number of points without a row."""

    name: str
    columns: tuple[Column, ...]
    point_count_without_rows: int
    other_tables: tuple[str, ...]
    """Names of the other tables of the same result."""

    @property
    def row_count(self) -> int:
        """Number of rows."""
        return len(self.columns[0].values)


@dataclass(frozen=True)
class Tables:
    """All tables of the result `view`; a table is made when it is requested."""

    view: ResultView

    def __post_init__(self) -> None:
        """Replaces a `view` whose grid has an arm's quantities as axes by a view of the list of its
        points."""
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
        points, listed = self._point_indices_and_columns(name)
        variables = self.contents.point_variables
        columns_beside = [] if points is None else list(point_columns(self.view, variables, points))
        if name == table_names.GRID_TABLE:
            # Move the first column, a parameter, to its place among the other parameters.
            earlier = list(PARAMETERS)[: list(PARAMETERS).index(listed[0].name)]
            columns_beside.insert(sum(column.name in earlier for column in columns_beside), listed.pop(0))
        by_name = {column.name: column for column in (*columns_beside, *listed)}
        table_names.refuse_unknown_columns(self.view.path, tuple(columns), tuple(by_name), name)
        if not columns:
            hidden = {variable.name for variable in variables if variable.name != "status"}
            columns = [
                column_name
                for column_name in by_name
                if name == table_names.POINTS_TABLE or column_name not in hidden
            ]
        empty = 0 if points is None else self.view.variables["status"].size - len(np.unique(points))
        other_names = tuple(choice for choice in self.contents.table_names if choice != name)
        return Table(name, tuple(by_name[column_name] for column_name in columns), empty, other_names)

    def list_columns(self, name: str) -> tuple[Column, ...]:
        """Columns of the list `name`, without the columns of the points."""
        return tuple(self._point_indices_and_columns(name)[1])

    def _point_indices_and_columns(self, name: str) -> tuple[NDArray[np.int64] | None, list[Column]]:
        """Returns (point_indices, columns) for the table `name`. point_indices: index of the point of each
        row, (rows,); None if the rows belong to no point. columns: columns of the items."""
        if name == table_names.POINTS_TABLE:
            return np.arange(self.view.variables["status"].size), []
        if name == table_names.BRANCHES_TABLE:
            return self._branches_table_columns()
        rows, columns = self._item_indices_and_columns(name)
        return None if name in self.contents.sweep_wide_lists else rows[0], columns

    def _item_indices_and_columns(self, name: str) -> tuple[ItemIndices, list[Column]]:
        """Returns (rows, columns) of the list `name`. rows: indices of the items. columns: columns, including
        columns in SI units."""
        is_sweep_wide = name in self.contents.sweep_wide_lists
        variables = self.contents.variables_by_list[name]
        rows = indices_of_items(self.view, variables, is_sweep_wide)
        columns = list(list_columns(self.view, variables, rows, is_sweep_wide))
        columns += varying_quantity_columns(self.view, rows) if name == table_names.GRID_TABLE else ()
        points = None if is_sweep_wide else rows[0]
        return rows, [*columns, *si_columns(self.view, variables, columns, points)]

    def _branches_table_columns(self) -> tuple[NDArray[np.int64], list[Column]]:
        """Returns (point_indices, columns) of the table `branches`: cycles and special points in the order of
        the branches, with the kind of special point. point_indices: index of the point of the file for each
        row, (rows,)."""
        cycles, cycle_columns = self._item_indices_and_columns("cycles")
        special_points, special_columns = self._item_indices_and_columns("special_points")
        by_name = {column.name: column for column in special_columns}
        parameter = followed_parameter(self.view)
        order = _order_along_branches(self.view, cycles, special_points)
        columns = [
            column.extended_by_rows(by_name.get(_special_point_variable(column.name, parameter)), len(order))
            for column in cycle_columns
        ]
        kinds = by_name["special_kind"]
        no_kinds = kinds.with_rows(slice(0, 0)).extended_by_rows(None, len(cycles[0]))
        columns.append(no_kinds.extended_by_rows(kinds, len(order)))
        points = np.concatenate([cycles[0], special_points[0]])
        return points[order], [column.with_rows(order) for column in columns]


def _order_along_branches(
    view: ResultView, cycles: ItemIndices, special_points: ItemIndices
) -> NDArray[np.int64]:
    """Indices, (cycles + special points,), that sort a list of all cycles, then all special points, along the
    branches: a special point follows the cycle that precedes it on the branch."""
    branches = [
        view.flattened_by_point("branch")[cycles],
        view.flattened_by_point("special_branch")[special_points],
    ]
    positions = [cycles[1] + 1, view.flattened_by_point("special_point")[special_points]]
    points, numbers = (np.concatenate(pair) for pair in zip(cycles, special_points, strict=True))
    is_special_point = np.repeat([0, 1], [len(cycles[0]), len(special_points[0])])
    return np.lexsort(
        (numbers, is_special_point, np.concatenate(positions), np.concatenate(branches), points)
    )


def _special_point_variable(cycle_variable: str, parameter_name: str) -> str:
    """Name of the variable of special points that corresponds to the variable `cycle_variable` of cycles."""
    if cycle_variable == f"branch_{parameter_name}":
        return "special_at"
    if parameter_name == "F" and cycle_variable in {f"branch_{load}" for load in LOAD_NAMES}:
        return "special_at_si"
    return f"special_{cycle_variable}"
