"""Points of a sweep by flat index: a grid of parameters, a grid over an arm's quantities, or a list.

Rods are made on demand: a grid takes the memory of the axes only.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...config.arm.axes import SLENDER, parameter_of_axis
from ...model.material.build import STANDARD, Build
from ...model.parameters import PARAMETERS
from ...model.rod import Rod

NEUTRAL = {name: parameter.neutral for name, parameter in PARAMETERS.items()}
"""Values of parameters without a column. A rod that is invalid with neutral values is invalid with any
values."""


@dataclass(frozen=True, slots=True)
class Points:
    """Values of parameters: axes of a grid (row-major, the last axis fastest), or columns of equal length.

    Columns describe the points of a list, or of a grid over the quantities of an arm.
    """

    names: tuple[str, ...]
    """The parameter of each column."""
    columns: tuple[Array, ...]
    """Values of each parameter: along its axis, or at every point, (points,)."""
    is_grid: bool
    """Whether the columns are the axes of a grid."""
    over: dict[str, Array] = field(default_factory=dict)
    """Axes of a grid over an arm's quantities, in SI units."""
    units: dict[str, Array] = field(default_factory=dict)
    """Units of time, force and pressure that the arm defines, by name, at every point of a grid over
    quantities, (points,)."""
    build: Build = STANDARD
    """Law and profile of all rods."""
    builds: tuple[Build, ...] = ()
    """Law and profile of each arm of a grid over quantities, in the order of the points; every arm has
    equally many points. Empty if all rods have the same `build`."""
    coverage: NDArray[np.int8] | None = None
    """Code of each point of an arm, (points,): SLENDER if the rod model applies, else a code of
    `rodsweep.config.arm.axes` for the reason. None for other points."""
    failures: dict[int, str] = field(default_factory=dict)
    """Reason of a failed search for the flutter force of a relative load, by flat index of the point."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a result variable: one dimension per axis, or (point,)."""
        return tuple(map(len, self.axes.values())) or (len(self.columns[0]),)

    @property
    def axes(self) -> dict[str, Array]:
        """Axes by name, of a grid of parameters or of a grid over quantities; empty for a list."""
        return self.by_name if self.is_grid else self.over

    @property
    def moved(self) -> tuple[str, ...]:
        """The parameter that varies along each axis; empty for several parameters or no parameter."""
        return self.names if self.is_grid else tuple(map(parameter_of_axis, self.over))

    @property
    def identity(self) -> list[Array]:
        """All axes and columns by name, each (n,); two sweeps with equal identity have the same points."""
        return [*self.over.values(), *self.columns]

    @property
    def of_rods(self) -> dict[str, Array]:
        """Values of each parameter at the points that have a rod, (rods,), by name."""
        if self.coverage is None:
            return self.by_name
        return self.values_of(np.flatnonzero(self.coverage == SLENDER))

    def has_rod(self, index: int) -> bool:
        """Whether the point at a flat index has a rod."""
        return self.coverage is None or self.coverage[index] == SLENDER

    @property
    def by_name(self) -> dict[str, Array]:
        """Axes or columns, each (n,), by name of the parameter."""
        return dict(zip(self.names, self.columns, strict=True))

    @property
    def count(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    def values(self, index: int) -> dict[str, float]:
        """Value of each parameter at the point with flat index `index`, by name."""
        values = {}
        for name, column in zip(reversed(self.names), reversed(self.columns), strict=True):
            place = index
            if self.is_grid:  # NumPy's unravel_index takes three times as long
                index, place = divmod(index, len(column))
            values[name] = float(column[place])
        return {name: values[name] for name in self.names}

    def values_of(self, indices: NDArray[np.int64]) -> dict[str, Array]:
        """Values of each parameter at the points with the flat indices `indices`, both (n,), by name."""
        places = np.unravel_index(indices, self.shape) if self.is_grid else [indices] * len(self.names)
        each = zip(self.names, self.columns, places, strict=True)
        return {name: column[place] for name, column, place in each}

    def rod(self, index: int, **beside: float) -> Rod:
        """Rod at a flat index; parameters without a column have the value in `beside`, or else in NEUTRAL.

        Raises Crushed for a force that crushes the rod."""
        parameters: dict[str, Any] = {**NEUTRAL, **self.values(index), **beside}
        return Rod(**parameters, build=self.build_of(index))

    @property
    def builds_of_rods(self) -> tuple[list[Build], NDArray[np.int64]]:
        """(distinct laws and profiles, index of the build of each rod of `of_rods`, (rods,))."""
        different = list(dict.fromkeys(self.builds)) or [self.build]
        of_arms = np.array([different.index(build) for build in self.builds] or [0])
        numbers = of_arms[np.arange(self.count) * len(of_arms) // self.count]
        return different, numbers if self.coverage is None else numbers[self.coverage == SLENDER]

    def build_of(self, index: int) -> Build:
        """Law and profile of the rod at a flat index."""
        return self.builds[index * len(self.builds) // self.count] if self.builds else self.build


@dataclass(frozen=True, slots=True)
class ParameterLine:
    """Points of a sweep that differ only in the parameter `name`, in the order of the sweep."""

    name: str
    """The parameter that varies."""
    parameters: dict[str, float]
    """Values of the fixed parameters, by name."""
    x: Array
    """Values of the varying parameter, shape (n,)."""
    at: np.ndarray
    """Flat indices of the points, shape (n,)."""


def lines_over(columns: Mapping[str, Array], name: str) -> Iterator[ParameterLine]:
    """Splits points into lines along the parameter `name`, ordered by first point; skips infinite values.

    columns: every parameter at every point, (points,).
    """
    x = columns[name]
    others = [other for other in columns if other != name]
    table = np.stack([columns[other] for other in others], axis=-1)
    _, first, line = np.unique(table, axis=0, return_index=True, return_inverse=True)
    by_line = np.argsort(line.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(line.ravel()))
    for number in np.argsort(first):
        at = by_line[ends[number - 1] if number else 0 : ends[number]]
        at = at[np.isfinite(x[at])]
        fixed = dict(zip(others, table[first[number]].tolist(), strict=True))
        yield ParameterLine(name, fixed, x[at], at)
