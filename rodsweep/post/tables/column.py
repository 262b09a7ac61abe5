"""Columns of a table: numbers or words with unit and meaning, and a mask of missing values.

A list in a result file has a fixed length, with fill values for unused items. A column has no fill values.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...arrays import list_of
from ...results.layouts.variables import SECONDS_VARIABLE, UNKNOWN_COUNT_LONG_NAME_SUFFIX, Variable

UNUSED_ITEM_WORDS = ("none", "missing")
"""Words of a flag variable that mark unused items of a list."""
BOOLEAN_TEXTS = {0: "false", 1: "true"}
"""Text in CSV for the boolean values 0 and 1."""
ESTIMATE_DIGITS = 3
"""Number of significant digits of estimates: errors and computing times."""
MAX_RELATIVE_COORDINATE_ROUNDING = 4 * np.finfo(float).eps
"""Largest relative rounding error of a coordinate that was converted between units or computed from a
range."""


@dataclass(frozen=True, slots=True)
class Column:
    """Column of a table, with its name, unit and meaning. values: (rows,). missing_mask: mask of missing
    values, (rows,)."""

    name: str
    unit: str
    meaning: str
    values: NDArray
    missing_mask: NDArray[np.bool_]
    flag_meanings: Mapping[int, str] = field(default_factory=dict)
    """Words by integer value; empty for a column of numbers."""
    is_input: bool = False
    """Whether the values are input, such as parameters, and not results."""
    is_boolean: bool = False
    """Whether the values are 1 for true and 0 for false."""

    @property
    def printed_unit(self) -> str:
        """Unit of the column; empty for a dimensionless number."""
        return "" if self.unit == "1" else self.unit

    @property
    def heading_with_unit(self) -> str:
        """Heading of the column with its unit, as in "F_onset [k3/L^2]"; without unit for a dimensionless
        number."""
        return f"{self.name} [{self.unit}]" if self.printed_unit else self.name

    @property
    def is_estimate(self) -> bool:
        """Whether the values are estimates: errors, or computing times."""
        return "error" in self.name or self.name == SECONDS_VARIABLE.name

    def with_rows(self, indices: NDArray[np.int64] | slice) -> "Column":
        """Column with the rows `indices`: indices, in the order of the new column, or a slice."""
        return replace(self, values=self.values[indices], missing_mask=self.missing_mask[indices])

    def extended_by_rows(self, other: "Column | None", length: int) -> "Column":
        """Column of `length` rows: the rows of this column, then those of `other`, or missing values if
        `other` is None."""
        added = length - len(self.values)
        values = np.zeros(added, self.values.dtype) if other is None else other.values
        absent = np.ones(added, bool) if other is None else other.missing_mask
        return replace(
            self,
            values=np.concatenate([self.values, values]),
            missing_mask=np.concatenate([self.missing_mask, absent]),
        )

    def csv_texts(self) -> list[str]:
        """Values as text for CSV: words, or the shortest decimal number from which the value can be
        recovered."""
        if self.is_boolean:
            texts = [BOOLEAN_TEXTS[int(value)] for value in self.values]
        elif self.flag_meanings:
            texts = [self.flag_meanings.get(int(v), "") for v in np.nan_to_num(self.values)]
        elif self.values.dtype.kind == "f":
            texts = self._number_texts()
        else:
            texts = list_of(self.values.astype(str))
        return ["" if is_absent else text for text, is_absent in zip(texts, self.missing_mask, strict=True)]

    def _number_texts(self) -> list[str]:
        """Real numbers as text: estimates with ESTIMATE_DIGITS digits, coordinates without rounding error,
        other numbers with all digits."""
        if self.is_estimate:
            return [f"{value:.{ESTIMATE_DIGITS}g}" for value in self.values]
        values = self.values + self.values.dtype.type(0)  # -0.0 + 0 is 0.0, which needs no sign
        texts = [text.removesuffix(".0") for text in list_of(values.astype(str))]
        if not self.is_input:
            return texts
        return [
            _text_without_rounding_error(value, text) for value, text in zip(self.values, texts, strict=True)
        ]


def column_of(variable: Variable, values: NDArray, flag_meanings: Mapping[int, str] | None = None) -> Column:
    """Column of a variable. values: (rows,). flag_meanings: words by value; if given, they replace the words
    of the variable's flags."""
    meanings = dict(variable.flags) if flag_meanings is None else flag_meanings
    meaning = variable.long_name.removesuffix(UNKNOWN_COUNT_LONG_NAME_SUFFIX)
    is_absent = missing_values_mask(variable, values)
    boolean = variable.is_boolean
    return Column(variable.name, variable.units, meaning, values, is_absent, meanings, is_boolean=boolean)


def coordinate_column(name: str, unit: str, meaning: str, values: NDArray) -> Column:
    """Column of a parameter or another coordinate, with its name, unit and meaning. values: (rows,); NaN, a
    missing value, stands for an arm outside the rod model."""
    return Column(name, unit, meaning, values, np.isnan(values.astype(float)), is_input=True)


def _text_without_rounding_error(value: float, text: str) -> str:
    """Text of a coordinate, without rounding error if this text is less than half as long: 2500 for
    2500.0000000000005. A number typed with 17 digits keeps all of them. text: the value with all digits."""
    if not np.isfinite(value):
        return text
    rounded = f"{value:.15g}"
    is_close = abs(float(rounded) - value) <= MAX_RELATIVE_COORDINATE_ROUNDING * abs(value)
    return rounded if is_close and 2 * len(rounded) < len(text) else text


def missing_values_mask(variable: Variable, values: NDArray) -> NDArray[np.bool_]:
    """Mask of missing values of a variable, of the shape of `values`. A missing value is NaN, the fill value
    -1, or a flag with a word in UNUSED_ITEM_WORDS."""
    if values.dtype.kind == "f":
        return np.isnan(values)
    if variable.flags:
        return np.isin(values, [value for value, word in variable.flags if word in UNUSED_ITEM_WORDS])
    return values == variable.fill_value if variable.fill_value == -1 else np.zeros(values.shape, bool)


def marks_missing_items(variable: Variable) -> bool:
    """Whether the fill value of the variable marks a missing item, because no valid value equals the fill
    value."""
    return variable.dtype.startswith("<f") or bool(variable.flags) or variable.fill_value == -1
