"""`rs.Answer`, the result of a task for one rod: variables as attributes, lists as pandas DataFrames."""

from dataclasses import dataclass
from enum import StrEnum
from functools import cache, cached_property
from math import prod
from typing import Any, cast

import numpy as np
import xarray as xr

from ...config.document.call_argument_errors import refusing_wrong_arguments
from ...post.headline.one_rod import SingleRodResult
from ...post.headline.sentences import HEADLINES
from ...post.tables.column import Column, column_of
from ...post.tables.table_names import POINTS_TABLE
from ...post.tables.tables import Tables
from ...results.layouts import layout_of
from ..task_results import Result
from .data_frames import data_frame_of, series_of
from .printing import PrintedAnswerContents, brief_html, brief_text, heading_lines, whole_html, whole_text

EIGENVALUE_VARIABLES = ("growth_rate", "frequency")
"""Variables with the real and the imaginary part of an eigenvalue."""
UNPRINTED_VARIABLES = ("status", "seconds")
"""Variables that a printed answer omits: the heading has the status, and the time depends on the machine."""
SI_UNITS_OF_ARM_VARIABLES = ("Pa", "N", "Hz", "s", "1/s", "m", "J", "W")
"""SI units of the variables of an arm. Variables with other units are in dimensionless units of the rod."""
FOUND_COUNT_VARIABLES = {
    "crossings": "crossing_count",
    "special_points": "special_count",
    "cycles": "point_count",
}
"""For each list, by name: the variable with the number of items found, including items that are not stored.
"""
LISTS_PRINTED_IN_FULL = ("modes", "crossings", "special_points", "harmonics", "multipliers")
"""Names of the lists that `Answer.table` prints in full. Of all other lists `Answer.table` prints only the
number of rows."""


@dataclass(frozen=True, slots=True, repr=False)
class FullListing:
    """All numbers of an answer, and the lists in LISTS_PRINTED_IN_FULL. text: the table for a
    terminal. html: the table for a notebook."""

    text: str
    html: str

    def __repr__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        return self.html


class Answer:
    """Result of a task for one rod: the variables of the task, and its lists.

    Every variable is an attribute. A variable of the rod is a number, a text, True or False; an unknown count
    is None. A variable of a list is an array with one entry per item. A list, such as `modes`, `crossings` or
    `cycles`, is a pandas DataFrame with one row per item, numbered from 1.

    `data` is the xarray.Dataset of the rod, with lists of a fixed length, as in the result file. `whole` also
    has the rod's parameters as dimensions of length 1, as in the file of a sweep.
    """

    def __init__(self, rod: str, result: Result, message: str):
        self.rod = rod
        self.message = message
        self._result = result

    @property
    def whole(self) -> xr.Dataset:
        """The Dataset with the rod's parameters as dimensions of length 1."""
        return self._result.dataset

    @cached_property
    def data(self) -> xr.Dataset:
        """The Dataset of the rod, without dimensions of length 1 for the rod's parameters."""
        points = ("point",) if "point" in self.whole.dims else layout_of(self.config).parameters
        return self.whole.isel(dict.fromkeys(points, 0))

    @cached_property
    def config(self) -> dict[str, Any]:
        """The config of this answer, as nested dicts of keys and values with all defaults."""
        return self._tables.view.config

    @cached_property
    def _tables(self) -> Tables:
        return Tables(self._result.view)

    @property
    def status(self) -> StrEnum:
        """Name of the status of the solve, a member of the enumeration of all statuses of the task."""
        view = self._tables.view
        statuses = _status_enumeration(view.task, tuple(view.status_flags.values()))
        return statuses(view.status_flags[int(view.variables["status"].item())])

    @property
    def sentence(self) -> str:
        """Meaning of the status, in one sentence; "" if the file has no sentence for the status."""
        lines = str(self.data.attrs["status_sentences"]).splitlines()
        return dict(line.split(": ", 1) for line in lines).get(self.status, "")

    @property
    def units(self) -> dict[str, str]:
        """The unit of every variable, by name."""
        return {str(name): array.attrs["units"] for name, array in self.data.data_vars.items()}

    @property
    def meanings(self) -> dict[str, str]:
        """Description of every variable, by name."""
        return {str(name): array.attrs["long_name"] for name, array in self.data.data_vars.items()}

    @property
    def lists(self) -> tuple[str, ...]:
        """Names of the lists. Every list is an attribute of the answer."""
        return self._tables.contents.table_names[1:]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        tables = self._tables
        if name in self.lists:
            columns = tables.list_columns(name)
            return data_frame_of(
                columns, columns[0].name if len(tables.contents.dimensions_of_list(name)) == 1 else None
            )
        for variable in tables.contents.point_variables:
            if variable.name == name:
                return _value_of_single_row(column_of(variable, np.ravel(tables.view.variables[name])))
        for list_name, variables in tables.contents.variables_by_list.items():
            if name in (*(v.name for v in variables), *tables.contents.dimensions_of_list(list_name)):
                return self._list_values(list_name, name)
        if name == "eigenvalues" and EIGENVALUE_VARIABLES[0] in tables.view.variables:
            return self.growth_rate + 1j * self.frequency
        if name in self.data.variables:  # a coordinate, or a number of the whole file
            values = self.data[name].values
            return values if values.ndim else values.item()
        raise AttributeError(f"this answer has no {name!r}; it has {', '.join(self._attribute_names())}")

    def _list_values(self, table: str, name: str) -> np.ndarray:
        """Values of the variable or coordinate `name` of the list with the name `table`, one entry per item
        of the list."""
        dimensions = self._tables.contents.dimensions_of_list(table)
        (column,) = (column for column in self._tables.list_columns(table) if column.name == name)
        if name in dimensions[1:]:
            return np.asarray(self.data[name].values)
        is_count = column.values.dtype.kind in "iu" and not column.flag_meanings
        values = np.asarray(series_of(column))
        if is_count and column.missing_mask.any():
            values = np.where(column.missing_mask, np.nan, column.values)
        inner_sizes = [self.data.sizes[dimension] for dimension in dimensions[1:]]
        return values[:: prod(inner_sizes)] if name == dimensions[0] else values.reshape(-1, *inner_sizes)

    def _attribute_names(self) -> list[str]:
        """Names of all variables and lists, for messages and completion."""
        names = ["eigenvalues"] if EIGENVALUE_VARIABLES[0] in self.data else []
        return [*map(str, self.data.data_vars), *self.lists, *names]

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *map(str, self.data.variables), *self._attribute_names()})

    @refusing_wrong_arguments("answer.table()")
    def table(self) -> "FullListing":
        """All numbers with units and meanings, and the short lists, as a text in a terminal and as a table in
        a notebook. Of long lists, such as `cycles`, only the number of rows is shown.

        `rs.table(answer, NAME)` returns the list NAME, with the parameters of the rod, as a DataFrame.
        """
        printed_answer = self._printed_answer()
        return FullListing(whole_text(printed_answer), whole_html(printed_answer))

    def __repr__(self) -> str:
        return brief_text(self._printed_answer())

    def _repr_html_(self) -> str:
        return brief_html(self._printed_answer())

    def _printed_answer(self) -> PrintedAnswerContents:
        tables = self._tables
        rod = SingleRodResult(tables.view)
        is_special = int(self.data["status"]) != 0  # a special outcome, such as a rod at rest
        columns = [c for c in tables.table(POINTS_TABLE).columns if c.name not in UNPRINTED_VARIABLES]
        columns = sorted((c for c in columns if not c.is_input), key=_is_dimensionless)
        lists = {}
        for name in self.lists:
            number, *value_columns = tables.list_columns(name)
            lists[name] = (number, *sorted(value_columns, key=_is_dimensionless))
        row_counts = {name: len(number.values) for name, (number, *_) in lists.items()}
        unlisted = {name for name in lists if name not in LISTS_PRINTED_IN_FULL}
        hidden = unlisted | {name for name, rows in row_counts.items() if is_special and not rows}
        totals = {
            name: int(self.data[name_of_total])
            for name, name_of_total in FOUND_COUNT_VARIABLES.items()
            if name_of_total in self.data
        }
        totals |= {"modes": self.data.sizes["mode"]} if "mode" in self.data.sizes else {}
        return PrintedAnswerContents(
            result=rod,
            heading=heading_lines(rod, self.rod, self.status, self.sentence, self.message),
            headline=HEADLINES[str(self.data.attrs["task"])],
            single_value_columns=tuple(column for column in columns if not column.missing_mask[0]),
            names_without_value=() if is_special else tuple(c.name for c in columns if c.missing_mask[0]),
            found_counts=totals,
            lists={name: own_columns for name, own_columns in lists.items() if name not in hidden},
            row_counts={
                name_of_total: rows
                for name_of_total, rows in row_counts.items()
                if name_of_total in unlisted and rows
            },
        )


@cache
def _status_enumeration(task: str, names: tuple[str, ...]) -> type[StrEnum]:
    """Enumeration of `names`, the names of all statuses of the task `task`."""
    new_enum: Any = StrEnum  # Any: mypy knows no StrEnum whose members come from data
    enum = new_enum("Status", {word: word for word in names})
    enum.__name__ = "".join(part.title() for part in task.split("_")) + "Status"
    return cast(type[StrEnum], enum)


def _is_dimensionless(column: Column) -> bool:
    """Whether a column is in dimensionless units of the rod. Columns in SI units are printed first."""
    return column.unit not in SI_UNITS_OF_ARM_VARIABLES


def _value_of_single_row(column: Column) -> float | int | bool | str | None:
    """The value of a column with one row. None stands for a missing text or count, NaN for a missing real
    number."""
    if column.missing_mask[0] and column.values.dtype.kind != "f":
        return None
    value = series_of(column)[0]
    return value if value is None or isinstance(value, str) else value.item()
