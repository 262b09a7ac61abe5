"""Rows of a phase diagram, and the place of items on rows as text."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from ..plane_curves import PlaneParameters
from .number_texts import axis_values_text, span_text
from .selection import Selection


@dataclass(frozen=True, slots=True)
class DiagramRows(Selection):
    """Rows of a phase diagram. parameters: parameter along the rows, and parameter that is constant on a
    row."""

    parameters: PlaneParameters

    def items(self, condition: np.ndarray) -> np.ndarray:
        """Mask of the items on the rows, (..., n), for which the mask `condition`, (..., n), is true."""
        return condition & self.mask[..., np.newaxis]

    def with_items(self, items: np.ndarray) -> Self:
        """The rows on which the mask `items`, (..., n), is true for an item."""
        return self.where(items.any(axis=-1))

    @property
    def row_values_text(self) -> str:
        """Values of the parameter that is constant on a row, as text: "k1 = 100 to 200"."""
        row = self.parameters.row
        return f"{row} = {axis_values_text(self.view.point_columns[row][self.mask.ravel()])}"

    def place_text(self, items: np.ndarray, position: str, error: str | None = None, bound: str = "") -> str:
        """Number of rows with items, and ranges of both parameters of the items: "2 of 4 rows, F = 10 to 20,
        k1 = 100 to 200".

        items: mask, (..., n). position, error: variables with positions along the rows, and their absolute
        errors. bound: words before the number of rows.
        """
        with_items = self.with_items(items)
        positions = np.broadcast_to(self.variables[position], items.shape)[items]
        errors = None if error is None else self.variables[error][items]
        positions_text = f"{self.parameters.line} = {span_text(positions, errors)}"
        return f"{bound}{with_items.of_total(self, 'row')}, {positions_text}, {with_items.row_values_text}"
