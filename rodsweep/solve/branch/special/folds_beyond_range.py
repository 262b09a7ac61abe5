"""Folds of cycles on the rows of a phase diagram, at parameter values beyond the range of the diagram. Curves
of folds through these points may cross rows whose branches start at no Hopf point; such a branch may enter
the range."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ....arrays import Array
from .special_point import RowSpecialPoint, SpecialPoint, SpecialPointKind

FOLDS_ARRAY_NAME = "folds_beyond"
"""Name of the array of the folds of a row beyond the range, (folds, 3): value of the parameter that varies
along the row, period in tau2, largest tip y in L."""


@dataclass(frozen=True, slots=True)
class RowWorkItems:
    """Rows of a phase diagram as work items, numbered from `first_item_number` in the order of the row index.
    row_parameter_name, row_parameter_values: name of the parameter that differs between rows, and its values
    by index of the row."""

    progress_noun: ClassVar[str] = "rows"
    """Plural noun for the work items in the progress display."""
    item_label_prefix: ClassVar[str]
    """Text before the row parameter in the progress display."""

    first_item_number: int
    row_parameter_name: str
    row_parameter_values: Mapping[int, float]

    @property
    def end_item_number(self) -> int:
        """First item number after these rows: `first_item_number` plus the number of rows."""
        return self.first_item_number + len(self.row_parameter_values)

    def items_to_solve(self, results: Mapping[int, dict[str, Array]]) -> list[int]:
        """Item numbers of the rows that have no entry in `results`. results: arrays of each solved row,
        (...,) each, by item number and name."""
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
    """Work items that find the folds beyond the range of the diagram, on rows with a branch of cycles that
    leaves or enters the range."""

    done_item_phrase: ClassVar[str] = "row with branches that leave the range"
    """Singular noun phrase for a finished work item, for the report at the end of a run."""
    item_label_prefix: ClassVar[str] = "folds beyond the range"
    """Text before the row parameter in the progress display."""

    def branch_starts_of_row(self, row: int) -> tuple[SpecialPoint, ...]:
        """Returns (): no branches are followed in addition to the known branches of the row with index
        `row`."""
        return ()

    def solve(
        self, item: int, known_points: Callable[[int], tuple[SpecialPoint, ...]], limits: tuple[float, float]
    ) -> dict[str, Array]:
        """The folds of one row outside the range `limits` of the parameter along the row, as the array with
        the name FOLDS_ARRAY_NAME, (folds, 3). item: item number of the row. known_points: function from the
        index of a row to all special points of the row, within the range and beyond."""
        folds = [
            (point.parameter_value, point.period, point.tip_y_max)
            for point in known_points(self.row_index_of_item(item))
            if point.kind == SpecialPointKind.fold and not limits[0] <= point.parameter_value <= limits[1]
        ]
        # A row without folds gives shape (0, 3), which `np.array` alone cannot know.
        return {FOLDS_ARRAY_NAME: np.array(folds, dtype=float).reshape(-1, 3)}

    def special_points(self, results: Mapping[int, dict[str, Array]]) -> list[RowSpecialPoint]:
        """The folds of all rows. results: for each item number, the arrays of the row by name, of which
        FOLDS_ARRAY_NAME, (folds, 3), is used."""
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
