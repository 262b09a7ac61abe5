"""What a task says of one rod: variables by name, their units, and a table for terminals and notebooks."""

import json
from collections.abc import Iterator
from html import escape
from typing import Any

import numpy as np
import xarray as xr

from ..results.layouts import layout_of

DIGITS = 8
"""Significant digits that are shown; the values have all of theirs."""
UNTOLD = ("status", "seconds")
"""Variables without a row: the status is in the heading, the time is of no rod but of a machine."""
MOST_SHOWN = 4
"""Values of a list that are shown."""

Row = tuple[str, str, str, str]
"""(name, value, unit, meaning)."""


class Answer:
    """The variables of a task for one rod, each an attribute: a number, or an array along its dimensions.

    `data` is the same as an xarray.Dataset, with units, meanings and the config; `whole` has the rod's
    parameters as dimensions of length 1, as the file of a sweep has.
    """

    def __init__(self, rod: str, whole: xr.Dataset, message: str):
        self.rod, self.whole, self.message = rod, whole, message
        self.config: dict[str, Any] = json.loads(whole.attrs["config_resolved"])
        """The config that gives this answer, with all defaults."""
        points = ("point",) if "point" in whole.dims else layout_of(self.config).parameters
        self.data = whole.isel(dict.fromkeys(points, 0))

    @property
    def status(self) -> str:
        """How the solve ended, by the status's name."""
        return _words(self.data["status"])[0]

    @property
    def sentence(self) -> str:
        """What the status means."""
        lines = str(self.data.attrs["status_sentences"]).splitlines()
        return dict(line.split(": ", 1) for line in lines).get(self.status, "")

    @property
    def units(self) -> dict[str, str]:
        """The unit of every variable, by name."""
        return {str(name): array.attrs["units"] for name, array in self.data.data_vars.items()}

    def __getattr__(self, name: str) -> Any:
        data: xr.Dataset | None = self.__dict__.get("data")
        if data is None or name not in data.variables:
            raise AttributeError(f"this answer has no {name!r}")
        array = data[name].values
        return array if array.ndim else array.item()

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *map(str, self.data.variables)})

    def __repr__(self) -> str:
        rows = list(self._rows())
        a, b, c = (max(len(row[column]) for row in rows) for column in range(3))
        lines = (
            f"{name:{a}}  {value:{b}}  {unit:{c}}  {meaning}".rstrip() for name, value, unit, meaning in rows
        )
        return "\n".join((self._heading(), self._told(), "", *lines))

    def _repr_html_(self) -> str:
        cells = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in self._rows())
        body = "".join(f"<tr>{row}</tr>" for row in cells)
        head = "".join(f"<th>{name}</th>" for name in ("variable", "value", "unit", "meaning"))
        said = f"<p><b>{escape(self._heading())}</b><br>{escape(self._told())}</p>"
        return f"{said}<table><tr>{head}</tr>{body}</table>"

    def _heading(self) -> str:
        return f"{self.rod}, {self.data.attrs['task']}: {self.status}"

    def _told(self) -> str:
        """What the status means, and what the solver adds."""
        return "; ".join(filter(None, (self.sentence, self.message)))

    def _rows(self) -> Iterator[Row]:
        # Where the answer is another than the one hoped for, as a rod at rest, most numbers do not exist.
        other = int(self.data["status"]) != 0
        for name, array in self.data.data_vars.items():
            absent = other and array.dtype.kind == "f" and not array.notnull().any()
            if name not in UNTOLD and not absent:
                units = str(array.attrs["units"])
                yield str(name), _shown(array), "" if units == "1" else units, str(array.attrs["long_name"])


def _shown(array: xr.DataArray) -> str:
    """The first values of a variable, without the fill at its end; of one with more dimensions its shape."""
    if array.ndim > 1:
        return " x ".join(f"{extent} {name}" for name, extent in array.sizes.items())
    flat = np.atleast_1d(array.values)
    words = _words(array) if "flag_values" in array.attrs else [f"{value:.{DIGITS}g}" for value in flat]
    filled = np.isnan(flat) if flat.dtype.kind == "f" else flat == (0 if "flag_values" in array.attrs else -1)
    last = int(np.flatnonzero(~filled)[-1]) + 1 if array.ndim and not filled.all() else 1
    return ", ".join(words[: min(last, MOST_SHOWN)]) + (", ..." if last > MOST_SHOWN else "")


def _words(array: xr.DataArray) -> list[str]:
    """The meanings of a variable whose values are words."""
    names = str(array.attrs["flag_meanings"]).split()
    meanings = dict(zip(map(int, np.atleast_1d(array.attrs["flag_values"])), names, strict=True))
    return [meanings[int(value)] for value in np.atleast_1d(array.values)]
