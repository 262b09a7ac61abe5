"""Points of a result file that a mask selects, with their numbers, ranges and places as text."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from ...results.file.view import ResultView
from ...wording import count_of_total
from ..plane_curves import PlaneParameters
from .number_texts import axis_values_text, value_range_text
from .variable_errors import absolute_errors, known_values_mask

VARIABLE_RANGE_PLACEHOLDER_PATTERN = re.compile(r"\{(first )?(\w+)\}")
"""Pattern for the place of a range in a sentence: the name of a variable in braces, like {period}. Of a
variable with a list at each point, {first growth_rate} stands for the first items of the lists."""


@dataclass(frozen=True, slots=True)
class PointSelection:
    """Points of a result file. mask: mask of the selected points, of the shape of the points."""

    view: ResultView
    """Result file with all its points, selected or not."""
    mask: np.ndarray

    @property
    def variables(self) -> Mapping[str, np.ndarray]:
        """Variables of the file at all points, by name."""
        return self.view.variables

    @property
    def count(self) -> int:
        """Number of selected points."""
        return int(self.mask.sum())

    def where(self, condition: np.ndarray) -> Self:
        """The selected points at which the mask `condition` is true."""
        return replace(self, mask=self.mask & condition)

    def with_status(self, *statuses: str) -> Self:
        """The selected points whose status has one of the names `statuses`."""
        return self.where(self.view.has_status(*statuses))

    def parts_by_word(self, masks: Mapping[str, np.ndarray]) -> dict[str, "PointSelection"]:
        """For each word, the selected points at which its mask in `masks` is true; words without such points
        are left out. Masks have the shape of the points."""
        parts = {word: self.where(mask) for word, mask in masks.items()}
        return {word: part for word, part in parts.items() if part.count}

    def values(self, name: str) -> np.ndarray:
        """Values of a variable at the selected points, (points, ...)."""
        return self.variables[name][self.mask]

    def absolute_errors(self, name: str) -> np.ndarray:
        """Absolute errors of a variable at the selected points, (points, ...)."""
        return absolute_errors(self.variables, name)[self.mask]

    def count_of_total_text(self, total: "PointSelection", noun: str = "point") -> str:
        """Number of selected points out of those in `total`, such as "2 of 4 points"."""
        return count_of_total(self.count, total.count, noun)

    def range_text(self, name: str) -> str:
        """Range of a variable as text, rounded according to the errors; unknown values are left out."""
        known = known_values_mask(self.variables, name)[self.mask]
        return value_range_text(self.values(name)[known], self.absolute_errors(name)[known])

    def sentence_with_ranges(self, template: str) -> str:
        """`template` with the ranges of the variables named in braces: "period: {period} tau2" becomes
        "period: 0.1 to 0.2 tau2"."""

        def text(place: re.Match[str]) -> str:
            first, name = place.groups()
            return (
                value_range_text(self.values(name)[:, 0], self.absolute_errors(name)[:, 0])
                if first
                else self.range_text(name)
            )

        return VARIABLE_RANGE_PLACEHOLDER_PATTERN.sub(text, template)

    def parameter_ranges_text(self) -> str:
        """Ranges of the varied parameters as text; empty if no parameter varies in the file."""
        columns = varied_parameters_at_points(self.view)
        chosen = self.mask.ravel()
        return ", ".join(f"{name} = {axis_values_text(column[chosen])}" for name, column in columns.items())


@dataclass(frozen=True, slots=True)
class DiagramRows(PointSelection):
    """Rows of a phase diagram. parameters: parameter along the rows, and parameter that is constant on a
    row."""

    parameters: PlaneParameters

    def item_mask(self, condition: np.ndarray) -> np.ndarray:
        """Mask of the list items on the selected rows for which the mask `condition` is true; both (..., n),
        n: list items of a row."""
        return condition & self.mask[..., np.newaxis]

    def rows_with_items(self, items: np.ndarray) -> Self:
        """The rows with at least one item in the mask `items`, (..., n), a result of `item_mask`."""
        return self.where(np.any(items, axis=-1))

    @property
    def row_parameter_values_text(self) -> str:
        """Values of the parameter that is constant on a row, as text: "k1 = 100 to 200"."""
        row = self.parameters.row_parameter
        return f"{row} = {axis_values_text(self.view.point_columns[row][self.mask.ravel()])}"

    def row_count_and_ranges_text(
        self, items: np.ndarray, position: str, error: str | None = None, bound: str = ""
    ) -> str:
        """Number of rows with items, and ranges of both parameters of the items: "2 of 4 rows, F = 10 to 20,
        k1 = 100 to 200".

        items: mask of the n list items of each row, (..., n). position, error: names of the variables with
        the items' positions along the rows and their absolute errors. bound: words before the number of rows.
        """
        with_items = self.rows_with_items(items)
        positions = np.broadcast_to(self.variables[position], items.shape)[items]
        errors = None if error is None else self.variables[error][items]
        positions_text = f"{self.parameters.line_parameter} = {value_range_text(positions, errors)}"
        count_text = with_items.count_of_total_text(self, "row")
        return f"{bound}{count_text}, {positions_text}, {with_items.row_parameter_values_text}"


def varied_parameters_at_points(view: ResultView) -> dict[str, np.ndarray]:
    """Parameters that differ between points of a file, by name: values at all points, (points,)."""
    return {name: column for name, column in view.point_columns.items() if len(np.unique(column)) > 1}


def counts_and_ranges_text(
    parts: Mapping[str, PointSelection],
    region: Callable[[PointSelection], str] = PointSelection.parameter_ranges_text,
) -> str:
    """Number and region of the points of each part: "stable at 2 (F = 1 to 2), unstable at 1 (F = 3)"."""
    return ", ".join(f"{word} at {part.count}{in_brackets(region(part))}" for word, part in parts.items())


def counts_by_word_text(codes: np.ndarray, words: Mapping[int, str]) -> str:
    """Number of items with each code that occurs: "3 supercritical, 1 subcritical"; empty if none occurs.
    codes: codes of the items, of any shape. words: words by code."""
    counts = {word: int((codes == code).sum()) for code, word in words.items()}
    return ", ".join(f"{count} {word}" for word, count in counts.items() if count)


def percents_by_word_text(codes: np.ndarray, words: Mapping[int, str]) -> str:
    """Percentage of the items with each code that occurs: "75.0 % monotone, 25.0 % flutter". codes: codes of
    the items, of any shape. words: words by code."""
    counts = {word: int((codes == code).sum()) for code, word in words.items()}
    return ", ".join(f"{100 * count / codes.size:.1f} % {word}" for word, count in counts.items() if count)


def in_brackets(text: str) -> str:
    """`text` in brackets, preceded by a space; an empty text if `text` is empty."""
    return f" ({text})" if text else ""
