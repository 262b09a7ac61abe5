"""The points of a sweep, by index and never all at once: a grid, of axes or of an arm, or a list."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...config.arm.axes import SLENDER, moved_by
from ...model.parameters import PARAMETERS
from ...model.rod import Rod

NEUTRAL = {name: parameter.neutral for name, parameter in PARAMETERS.items()}
"""Values of parameters that are no column, with which a rod is one if it is with any."""


@dataclass(frozen=True, slots=True)
class Points:
    """Values of some parameters: a grid's axes (row-major order, the last fastest) or equal columns.

    Columns are of the points of a list, or of a grid over the quantities of an arm.
    """

    names: tuple[str, ...]
    """The parameter of each column."""
    columns: tuple[Array, ...]
    is_grid: bool
    """Whether the columns are the axes of a grid."""
    over: dict[str, Array] = field(default_factory=dict)
    """The axes of a grid over an arm's quantities, in SI."""
    units: dict[str, Array] = field(default_factory=dict)
    """The units that the arm makes at every point of such a grid, (points,)."""
    covered: NDArray[np.int8] | None = None
    """Whether a rod covers each point of an arm, as `rodsweep.config.arm.axes` numbers it, (points,)."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of a result variable: one dimension per axis, or (point,)."""
        return tuple(map(len, self.axes.values())) or (len(self.columns[0]),)

    @property
    def axes(self) -> dict[str, Array]:
        """The axes of a grid of either kind by name; none of a list."""
        return self.by_name if self.is_grid else self.over

    @property
    def moved(self) -> tuple[str, ...]:
        """The one parameter that each axis moves; empty where it moves several or none."""
        return self.names if self.is_grid else tuple(map(moved_by, self.over))

    @property
    def identity(self) -> list[Array]:
        """What tells these points from all others of a config: values of axes and columns, each (n,)."""
        return [*self.over.values(), *self.columns]

    @property
    def of_rods(self) -> dict[str, Array]:
        """The columns by their parameters, without points that no rod covers."""
        if self.covered is None:
            return self.by_name
        return self.values_of(np.flatnonzero(self.covered == SLENDER))

    def has_rod(self, index: int) -> bool:
        """Whether a rod covers a point."""
        return self.covered is None or self.covered[index] == SLENDER

    @property
    def by_name(self) -> dict[str, Array]:
        """The columns by their parameters."""
        return dict(zip(self.names, self.columns, strict=True))

    @property
    def count(self) -> int:
        return math.prod(self.shape)

    def values(self, index: int) -> dict[str, float]:
        """The parameters at a flat index, by name."""
        values = {}
        for name, column in zip(reversed(self.names), reversed(self.columns), strict=True):
            place = index
            if self.is_grid:  # NumPy's unravel_index takes three times as long
                index, place = divmod(index, len(column))
            values[name] = float(column[place])
        return {name: values[name] for name in self.names}

    def values_of(self, indices: NDArray[np.int64]) -> dict[str, Array]:
        """The parameters at flat indices, (n,), by name, each (n,)."""
        places = np.unravel_index(indices, self.shape) if self.is_grid else [indices] * len(self.names)
        return {
            name: column[place] for name, column, place in zip(self.names, self.columns, places, strict=True)
        }

    def rod(self, index: int, **beside: float) -> Rod:
        """The rod at a flat index, with other parameters beside the columns'; else they are NEUTRAL.

        Raises Crushed.
        """
        parameters: dict[str, Any] = {**NEUTRAL, **self.values(index), **beside}
        return Rod(**parameters)
