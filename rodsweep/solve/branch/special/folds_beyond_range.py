"""Folds beyond the range of the rows of a diagram. Curves of folds through them may cross, beyond the range,
rows whose branches have no Hopf point anywhere; such a branch may enter the range."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ....arrays import Array
from .special_point import RowSpecialPoint, SpecialPoint, SpecialPointKind

FOLDS_ARRAY_NAME = "folds_beyond"
"""Name of the array of a row's folds beyond the range, (folds, 3): parameter along the row, period, tip y."""


@dataclass(frozen=True, slots=True)
class RowWorkItems:
    """Rows as work items numbered from `first_item_number`. row_parameter_name, row_parameter_values: name of
    the row parameter, and its value by index of the row."""

    progress_noun: ClassVar[str] = "rows"
    """Plural noun for the work items in the progress display."""
    item_label_prefix: ClassVar[str]
    """Text before the row parameter in the progress display."""

    first_item_number: int
    row_parameter_name: str
    row_parameter_values: Mapping[int, float]

    @property
    def end_item_number(self) -> int:
        """Number of rows plus `first_item_number`."""
        return self.first_item_number + len(self.row_parameter_values)

    def items_to_solve(self, results: Mapping[int, dict[str, Array]]) -> list[int]:
        """Numbers of the rows without a result. results: arrays, (...,) each, by name and number."""
        return [item for item in range(self.first_item_number, self.end_item_number) if item not in results]

    def row_index_of_item(self, item: int) -> int:
        """Index of the row of a work item."""
        return sorted(self.row_parameter_values)[item - self.first_item_number]

    def item_label(self, item: int) -> str:
        """Text for a row in the progress display."""
        value = self.row_parameter_values[self.row_index_of_item(item)]
        return f"{self.item_label_prefix} of {self.row_parameter_name} = {value:.5g}"


@dataclass(frozen=True, slots=True)
class FoldsBeyondRange(RowWorkItems):
    """Rows whose branches leave the range or enter it; the results are the folds of these branches beyond the
    range."""

    done_item_phrase: ClassVar[str] = "row with branches that leave the range"
    """Noun for one row and what was done with it, for the report at the end of a run."""
    item_label_prefix: ClassVar[str] = "folds beyond the range"
    """Text before the row parameter in the progress display."""

    def branch_starts_of_row(self, row: int) -> tuple[SpecialPoint, ...]:
        """No special points: the branches of the row with the index `row` are the branches of the first
        stage."""
        return ()

    def solve(
        self, item: int, known_points: Callable[[int], tuple[SpecialPoint, ...]], limits: tuple[float, float]
    ) -> dict[str, Array]:
        """Folds of the row of a work item beyond the range `limits` of the parameter along the rows, as the
        array with the name FOLDS_ARRAY_NAME, (folds, 3). known_points: function from the index of a row to
        its special points, within the range and beyond."""
        folds = [
            (point.parameter_value, point.period, point.tip_y_max)
            for point in known_points(self.row_index_of_item(item))
            if point.kind == SpecialPointKind.fold and not limits[0] <= point.parameter_value <= limits[1]
        ]
        # A row without folds gives shape (0, 3), which `np.array` alone cannot know.
        return {FOLDS_ARRAY_NAME: np.array(folds, dtype=float).reshape(-1, 3)}

    def special_points(self, results: Mapping[int, dict[str, Array]]) -> list[RowSpecialPoint]:
        """The folds of all rows. results: arrays with the name FOLDS_ARRAY_NAME, (folds, 3), of all work
        items, by number."""
        return [
            RowSpecialPoint(
                row_index=self.row_index_of_item(item),
                row_parameter_value=self.row_parameter_values[self.row_index_of_item(item)],
                kind=SpecialPointKind.fold,
                parameter_value=float(value),
                period=float(period),
                tip_y_max=float(height),
            )
            for item in range(self.first_item_number, self.end_item_number)
            for value, period, height in results[item].get(FOLDS_ARRAY_NAME, ())
        ]
