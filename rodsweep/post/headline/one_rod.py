"""The result of one rod: its numbers and lists as text, for the first lines that are printed about it."""

from collections.abc import Mapping

import numpy as np

from ...results.file.view import View
from ...results.layouts import layout_of
from ...results.layouts.arm import si_variables_of
from ..tables import Tables
from ..tables.columns import Column
from ..tables.contents import POINTS
from .digits import Digits

EVENTS = ("onset", "hopf", "restabilization")
"""Kinds of thresholds whose first force is a number of the rod."""
CROSSINGS = "crossings"


class OneRod:
    """Numbers and lists of a file of one rod. For an arm every name means the variable in SI units."""

    def __init__(self, view: View):
        self.view = view
        self.tables = Tables(view)
        self.si = _si_names(view)
        own = [column for column in self.tables.table(POINTS).columns if not column.given]
        self.lists: dict[str, Digits] = {
            name: Digits(self.tables.items(name), self.si) for name in self.tables.contents.tables[1:]
        }
        self.points = Digits(own, self.si, self._threshold_errors())

    def _threshold_errors(self) -> Mapping[str, np.ndarray]:
        """Absolute errors of the first forces of each kind, from the list of crossings; each (1,)."""
        if CROSSINGS not in self.lists or "crossing_error" not in self.lists[CROSSINGS].columns:
            return {}
        columns = self.lists[CROSSINGS].columns
        at = next((columns[name] for name in ("crossing_F", "crossing_at") if name in columns), None)
        found = {}
        for event in EVENTS:
            force = self.view.variables.get(f"F_{event}")
            if at is not None and force is not None:
                same = at.values == force.ravel()[0]
                error = columns["crossing_error"].values[same]
                found[f"F_{event}"] = error[:1] if error.size else np.array([np.nan])
        return found

    def preferred(self, digits: Digits, name: str) -> str:
        """Name of the SI variable of a variable of an arm, else the variable itself."""
        return self.si.get(name, name) if self.si.get(name) in digits.columns else name

    def column(self, name: str) -> Column | None:
        """A number of the rod, None if the task has no such number, or the rod none."""
        column = self.points.columns.get(self.preferred(self.points, name))
        return None if column is None or column.absent[0] else column

    def text(self, name: str) -> str:
        """A number of the rod for a sentence, with its unit; empty for a missing number."""
        column = self.column(name)
        return "" if column is None else self.points.short(column.name)

    def count(self, name: str) -> int | None:
        """A count of the rod, None if not known."""
        column = self.points.columns.get(name)
        return None if column is None or column.absent[0] else int(column.values[0])

    def words(self, table: str, name: str) -> list[str]:
        """Words of a list."""
        return self.lists[table].columns[name].text()


def _si_names(view: View) -> dict[str, str]:
    """Names of the SI variables of an arm's result by the dimensionless variable; empty for a rod."""
    if view.config["parameters"].get("arm") is None:
        return {}
    layout = layout_of(view.config)
    return {name: variable.name for name, variable in si_variables_of(layout, view.config).items()}
