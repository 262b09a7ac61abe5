"""A result as CSV: a line a point, a column a parameter, and a column a number that the point has.

Words stand where the file has words stored as numbers. What has one more dimension of at most MOST_COLUMNS
values becomes numbered columns, name_1, name_2, ...; what is larger is left out and named.
"""

import csv
import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..config.arm import AXIS_OF
from ..errors import InputError
from ..results.file.view import View
from ..results.layouts import layout_of
from ..results.layouts.arm import QUANTITY_UNITS
from ..results.layouts.variables import DIMENSIONS, Layout, Variable

MOST_COLUMNS = 100
"""Columns that one variable may take: as many modes and harmonics as a config may ask for."""
LINES_AT_ONCE = 4096
"""Points that are in memory as text."""


@dataclass(frozen=True, slots=True)
class Exported:
    """What was written, and the variables that a line has no room for."""

    points: int
    columns: int
    left_out: tuple[str, ...]

    @property
    def sentence(self) -> str:
        """What the user reads."""
        text = f"{self.points} points in {self.columns} columns"
        if self.left_out:
            text += f"; left out, because a point has more than {MOST_COLUMNS} values or a table of each: "
            text += ", ".join(self.left_out)
        return text


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its heading, its unit, and the values of all points, shape (points,)."""

    name: str
    unit: str
    values: np.ndarray
    words: dict[int, str]
    """What the values mean, where they are words."""

    def text(self, lines: slice) -> list[str]:
        """The values of some points as CSV has them: the shortest text that reads back the same."""
        values = self.values[lines]
        if self.words:
            return [self.words.get(int(value), str(value)) for value in values]
        return values.astype(str).tolist()


def export(view: View, output: Path, units: bool, replace: bool) -> Exported:
    """Writes a result as CSV; with `units` in the headings; InputError for a file that is there already."""
    if output.is_dir() or not output.name or output.suffix in {".h5", ".yaml", ".yml"}:
        raise InputError(f"--output {output} is no name for a CSV file")
    if output.exists() and not replace:
        raise InputError(f"{output} is there already; --replace writes over it, -o names another file")
    view, layout = view.listed, layout_of(json.loads(view.attributes["config_resolved"]))
    kept = [variable for variable in layout.variables if _fits(layout, variable)]
    left_out = tuple(variable.name for variable in layout.variables if variable not in kept)
    columns = list(_columns(view, layout, kept))
    points = view.variables["status"].size
    partial = output.with_name(f".{output.name}.partial")
    try:
        with partial.open("w", newline="", encoding="utf-8") as stream:
            lines = csv.writer(stream, lineterminator="\n")
            lines.writerow(f"{c.name} [{c.unit}]" if units and c.unit != "1" else c.name for c in columns)
            for start in range(0, points, LINES_AT_ONCE):
                texts = (c.text(slice(start, start + LINES_AT_ONCE)) for c in columns)
                lines.writerows(zip(*texts, strict=True))
        os.replace(partial, output)
    finally:
        partial.unlink(missing_ok=True)
    return Exported(points, len(columns), left_out)


def _fits(layout: Layout, variable: Variable) -> bool:
    """Whether a line has room for a variable."""
    inner = layout.inner(variable)
    return not inner or (len(inner) == 1 and inner[0] <= MOST_COLUMNS)


def _at_points(view: View) -> dict[str, np.ndarray]:
    """The quantities of an arm at every point, each (points,); those along a row of a diagram left out."""
    count, found = view.variables["status"].size, {}
    for name, values in view.quantities.items():
        along = AXIS_OF.get(name, "")
        if values.size == 1 or not view.is_grid:
            found[name] = np.broadcast_to(values, count)
        elif along in view.parameters:
            found[name] = values[np.searchsorted(view.axes[along], view.point_columns[along])]
    return found


def _columns(view: View, layout: Layout, variables: list[Variable]) -> Iterator[Column]:
    """The parameters, the status, and then what was measured."""
    for name, values in view.point_columns.items():
        yield Column(name, DIMENSIONS[name][0], values, {})
    for name, values in _at_points(view).items():
        yield Column(name, QUANTITY_UNITS[name], values, {})
    for variable in sorted(variables, key=lambda v: v.name != "status"):
        words = view.flags if variable.name == "status" else dict(variable.flags)
        inner = layout.inner(variable)
        table = view.variables[variable.name].reshape(-1, *inner)
        if not inner:
            yield Column(variable.name, variable.units, table, words)
        for i in range(inner[0] if inner else 0):
            yield Column(f"{variable.name}_{i + 1}", variable.units, table[:, i], words)
