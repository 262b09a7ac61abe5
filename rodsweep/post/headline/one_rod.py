"""Numbers and lists in the result of one rod as text, rounded according to their errors."""

from collections.abc import Mapping, Sequence

import numpy as np

from ...arrays import Array
from ...results.file.view import ResultView
from ...results.layouts import layout_of
from ...results.layouts.si_variables import si_variables_of
from ..summary.number_texts import error_text, number_and_error_texts, rounded_text
from ..summary.variable_errors import ABSOLUTE_ERROR_NAMES, RELATIVE_ERROR_NAME_BY_VARIABLE, absolute_errors
from ..tables.column import Column
from ..tables.table_names import POINTS_TABLE
from ..tables.tables import Tables

BOOLEAN_WORDS = ("no", "yes")
"""Words for the boolean values 0 and 1."""
VARIABLES_WITHOUT_ERROR = ("F_end",)
"""Variables without an error, because their values come from an option of the config."""


class ColumnTexts:
    """Columns of a table as text, rounded according to the errors.

    columns: columns of equal length, (rows,). si: name of the SI variable, by dimensionless variable.
    other_errors: absolute errors, (rows,), of variables whose error is in another table, by name.
    """

    def __init__(
        self,
        columns: Sequence[Column],
        si: Mapping[str, str],
        other_errors: Mapping[str, Array] | None = None,
    ):
        self.columns = {column.name: column for column in columns}
        self._values = {name: self._numbers(column) for name, column in self.columns.items()}
        self._base = {si_name: name for name, si_name in si.items()}
        self._other_errors = other_errors or {}

    @staticmethod
    def _numbers(column: Column) -> Array:
        return np.where(column.missing_mask, np.nan, column.values.astype(float))

    def absolute_errors(self, name: str) -> Array:
        """Absolute error of the variable `name`, (rows,); NaN where the error is unknown."""
        error_text = self._base.get(name)
        if error_text in self.columns:
            with np.errstate(divide="ignore", invalid="ignore"):
                return self.absolute_errors(error_text) * np.abs(
                    self._values[name] / self._values[error_text]
                )
        if name in VARIABLES_WITHOUT_ERROR:
            return np.zeros_like(self._values[name])
        if name in self._other_errors:
            return self._other_errors[name]
        errors = absolute_errors(self._values, name)
        has_error = any(
            table.get(name, "") in self.columns
            for table in (RELATIVE_ERROR_NAME_BY_VARIABLE, ABSOLUTE_ERROR_NAMES)
        )
        return errors if has_error else np.where(errors > 0, errors, np.nan)

    def value_and_error_texts(self, name: str) -> list[tuple[str, str]]:
        """Pairs (value, absolute error) of the variable `name` as text, one per row. An unknown error is an
        empty text."""
        column = self.columns[name]
        if column.is_boolean:
            return [(BOOLEAN_WORDS[int(value)], "") for value in column.values]
        if column.flag_meanings or column.values.dtype.kind != "f":
            return [(text, "") for text in column.csv_texts()]
        if column.is_estimate:
            stated_error = self._values[name] + self._rounding_errors_of_printed_values(name)
            texts = (error_text(float(value)) if value else "0" for value in stated_error)
            return [
                ("" if no_text else text, "")
                for text, no_text in zip(texts, column.missing_mask, strict=True)
            ]
        rows = zip(self._values[name], self.absolute_errors(name), column.missing_mask, strict=True)
        return [
            ("", "") if no_text else number_and_error_texts(float(x), float(error))
            for x, error, no_text in rows
        ]

    def _rounding_errors_of_printed_values(self, error: str) -> Array:
        """Rounding errors, (rows,), of the printed values to which the error variable `error` belongs;
        relative if `error` is relative. If `error` belongs to several variables, the largest rounding error.
        """
        largest_rounding = np.zeros_like(self._values[error])
        for table, relative in ((ABSOLUTE_ERROR_NAMES, False), (RELATIVE_ERROR_NAME_BY_VARIABLE, True)):
            for name in (
                name_with_error
                for name_with_error, own_error in table.items()
                if own_error == error and name_with_error in self.columns
            ):
                values = self._values[name]
                printed_values = np.array([float(text) if text else np.nan for text in self.texts(name)])
                with np.errstate(divide="ignore", invalid="ignore"):
                    rounding = np.abs(printed_values - values) / (np.abs(values) if relative else 1.0)
                largest_rounding = np.fmax(largest_rounding, np.where(np.isfinite(rounding), rounding, 0.0))
        return largest_rounding

    def texts(self, name: str) -> list[str]:
        """Values of the variable `name` as text, one per row."""
        return [text for text, _ in self.value_and_error_texts(name)]

    def short_text(self, name: str, row: int = 0) -> str:
        """Value of the variable `name` in the given row as text: at most six digits, with the unit."""
        column = self.columns[name]
        value = float(self._values[name][row])
        error = float(np.nan_to_num(self.absolute_errors(name)[row]))
        return f"{rounded_text(value, error)} {'' if column.unit == '1' else column.unit}".rstrip()


FIRST_THRESHOLD_KINDS = ("onset", "hopf", "restabilization")
"""Kinds of thresholds for which the first force is stored as a separate variable."""
CROSSINGS_TABLE = "crossings"
"""Name of the table of crossings."""


class SingleRodResult:
    """Numbers and lists in the result of one rod. For an arm, variables in SI units are printed where they
    exist."""

    def __init__(self, view: ResultView):
        self.view = view
        self.tables = Tables(view)
        # Name of the SI variable of an arm, by dimensionless variable.
        has_arm = view.config["parameters"].get("arm") is not None
        si_variables = si_variables_of(layout_of(view.config), view.config) if has_arm else {}
        self.si_names = {name: variable.name for name, variable in si_variables.items()}
        answer_columns = [column for column in self.tables.table(POINTS_TABLE).columns if not column.is_input]
        self.list_texts: dict[str, ColumnTexts] = {
            name: ColumnTexts(self.tables.list_columns(name), self.si_names)
            for name in self.tables.contents.table_names[1:]
        }
        self.point_texts = ColumnTexts(answer_columns, self.si_names, self._threshold_errors())

    def _threshold_errors(self) -> Mapping[str, np.ndarray]:
        """Absolute errors, (1,) each, of the first threshold force of each kind, read from the list of
        crossings. Empty if the result has no list of crossings."""
        if (
            CROSSINGS_TABLE not in self.list_texts
            or "crossing_error" not in self.list_texts[CROSSINGS_TABLE].columns
        ):
            return {}
        columns = self.list_texts[CROSSINGS_TABLE].columns
        positions = next((columns[name] for name in ("crossing_F", "crossing_at") if name in columns), None)
        errors = {}
        for event in FIRST_THRESHOLD_KINDS:
            force = self.view.variables.get(f"F_{event}")
            if positions is not None and force is not None:
                error = columns["crossing_error"].values[positions.values == force.ravel()[0]]
                errors[f"F_{event}"] = error[:1] if error.size else np.array([np.nan])
        return errors

    def si_name_or_name(self, digits: ColumnTexts, name: str) -> str:
        """Name of the variable that is printed for the variable `name`: the corresponding SI variable if
        `digits` has such a column, else `name`."""
        return self.si_names.get(name, name) if self.si_names.get(name) in digits.columns else name

    def column(self, name: str) -> Column | None:
        """The variable `name` of the rod as a column of one row; None if the variable or its value is
        missing."""
        column = self.point_texts.columns.get(self.si_name_or_name(self.point_texts, name))
        return None if column is None or column.missing_mask[0] else column

    def text(self, name: str) -> str:
        """The variable `name` of the rod as text with its unit; empty for a missing value."""
        column = self.column(name)
        return "" if column is None else self.point_texts.short_text(column.name)

    def integer_value(self, name: str) -> int | None:
        """The integer variable `name` of the rod; None if its value is missing."""
        column = self.point_texts.columns.get(name)
        return None if column is None or column.missing_mask[0] else int(column.values[0])

    def column_words(self, table: str, name: str) -> list[str]:
        """Words in the column `name` of the table `table`, one for each row."""
        return self.list_texts[table].columns[name].csv_texts()
