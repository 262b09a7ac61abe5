"""Points of a sweep by flat index: a grid of parameters, a grid over an arm's quantities, or a list.

Rods are created on demand, so a grid needs memory only for its axes.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...config.arm.axes import parameter_of_axis
from ...config.arm.status import SLENDER
from ...model.material.rod_material import DEFAULT_MATERIAL, RodMaterial
from ...model.parameters import PARAMETERS
from ...model.rod import Rod

NEUTRAL_VALUES = {name: parameter.neutral_value for name, parameter in PARAMETERS.items()}
"""Value of each parameter, by name, if it has no column, such as F = 0, k1 = inf or taper = 1. Parameter
values that are invalid in combination with these values are invalid in every combination."""


@dataclass(frozen=True, slots=True)
class Points:
    """Points of a sweep: a grid of parameters (row-major, the last axis fastest), or columns of equal length.
    Columns describe a list of points, or a grid over the quantities of an arm."""

    names: tuple[str, ...]
    """Name of the parameter in each element of `columns`."""
    columns: tuple[Array, ...]
    """Values of each parameter: along its axis, (n,), or at every point, (points,)."""
    is_grid: bool
    """Whether the points are a grid of parameters, whose axes are `columns`."""
    arm_axes: dict[str, Array] = field(default_factory=dict)
    """Axes of a grid over an arm's quantities by name, in SI units, (n,) each; else empty."""
    arm_units: dict[str, Array] = field(default_factory=dict)
    """The arm's units of time, force and pressure at every point of a grid over its quantities, (points,)."""
    material: RodMaterial = DEFAULT_MATERIAL
    """Constitutive law and profile of all rods, unless `arm_materials` is given."""
    arm_materials: tuple[RodMaterial, ...] = ()
    """Constitutive law and profile of each arm of a grid over an arm's quantities, in the order of the
    points. Every arm has the same number of consecutive points. Empty if all points have `material`."""
    validity_codes: NDArray[np.int8] | None = None
    """Status code of each point of an arm, (points,), from `rodsweep.config.arm.status`: SLENDER if the rod
    model applies, else the code of the reason why it does not apply. None if every point has a rod."""
    flutter_search_failures: dict[int, str] = field(default_factory=dict)
    """Reason why the search for flutter failed at a point with a relative load, by flat index."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array of all points: one dimension per axis of a grid, or (points,) for a list."""
        return tuple(map(len, self.axes.values())) or (len(self.columns[0]),)

    @property
    def axes(self) -> dict[str, Array]:
        """Axes of the grid by name, (n,) each: parameters or an arm's quantities; empty for a list."""
        return self.columns_by_name if self.is_grid else self.arm_axes

    @property
    def varied_parameter_by_axis(self) -> tuple[str, ...]:
        """Name of the only parameter that varies along each axis; "" for an axis along which several
        parameters or no parameters vary."""
        return self.names if self.is_grid else tuple(map(parameter_of_axis, self.arm_axes))

    @property
    def identifying_arrays(self) -> list[Array]:
        """The arrays in `arm_axes` and `columns`, (n,) each. Two sweeps have the same points if all these
        arrays are equal."""
        return [*self.arm_axes.values(), *self.columns]

    @property
    def parameter_values_of_rods(self) -> dict[str, Array]:
        """Values of each parameter by name: those in `columns`; if some points have no rod because the rod
        model does not apply, only the values at the other points, (rods,) each."""
        if self.validity_codes is None:
            return self.columns_by_name
        return self.parameter_values_of_points(np.flatnonzero(self.validity_codes == SLENDER))

    def is_in_model(self, index: int) -> bool:
        """Whether the point at a flat index has a rod."""
        return self.validity_codes is None or self.validity_codes[index] == SLENDER

    @property
    def columns_by_name(self) -> dict[str, Array]:
        """The arrays in `columns`, by name of the parameter, (n,) each."""
        return dict(zip(self.names, self.columns, strict=True))

    @property
    def count(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    def parameter_values_of_point(self, index: int) -> dict[str, float]:
        """Parameter values of the point at a flat index, by name."""
        values = {}
        for name, column in zip(reversed(self.names), reversed(self.columns), strict=True):
            index_on_axis = index
            if self.is_grid:  # NumPy's unravel_index takes three times as long
                index, index_on_axis = divmod(index, len(column))
            values[name] = float(column[index_on_axis])
        return {name: values[name] for name in self.names}

    def parameter_text(self, index: int) -> str:
        """Text with the parameters of the point at a flat index: `F = 40, k1 = 200`."""
        return ", ".join(
            f"{name} = {value:.15g}" for name, value in self.parameter_values_of_point(index).items()
        )

    def parameter_values_of_points(self, indices: NDArray[np.int64]) -> dict[str, Array]:
        """Parameter values, (n,) each, of the points at flat indices, (n,), by name."""
        indices_by_axis = (
            np.unravel_index(indices, self.shape) if self.is_grid else [indices] * len(self.names)
        )
        columns_and_indices = zip(self.names, self.columns, indices_by_axis, strict=True)
        return {name: column[index_on_axis] for name, column, index_on_axis in columns_and_indices}

    def rod(self, index: int, **replaced_values: float) -> Rod:
        """Rod of the point at a flat index. replaced_values: values that replace the values of the point. A
        parameter with neither value has the value in NEUTRAL_VALUES. Raises Crushed."""
        parameters: dict[str, Any] = {
            **NEUTRAL_VALUES,
            **self.parameter_values_of_point(index),
            **replaced_values,
        }
        return Rod(**parameters, material=self.material_of(index))

    @property
    def distinct_materials_and_indices(self) -> tuple[list[RodMaterial], NDArray[np.int64]]:
        """Returns (distinct materials, index of the material of each point of
        `parameter_values_of_rods`, (rods,))."""
        distinct_materials = list(dict.fromkeys(self.arm_materials)) or [self.material]
        material_of_arm = np.array(
            [distinct_materials.index(material) for material in self.arm_materials] or [0]
        )
        material_indices = material_of_arm[np.arange(self.count) * len(material_of_arm) // self.count]
        return (
            distinct_materials,
            material_indices
            if self.validity_codes is None
            else material_indices[self.validity_codes == SLENDER],
        )

    def material_of(self, index: int) -> RodMaterial:
        """Constitutive law and profile of the rod of the point at a flat index."""
        return (
            self.arm_materials[index * len(self.arm_materials) // self.count]
            if self.arm_materials
            else self.material
        )


@dataclass(frozen=True, slots=True)
class ParameterLine:
    """Points of a sweep that differ in one parameter only, in the order of the sweep."""

    name: str
    """Name of the parameter that varies."""
    other_parameters: dict[str, float]
    """Values of all other parameters, by name."""
    values: Array
    """Values of the parameter that varies, (n,)."""
    indices: np.ndarray
    """Flat indices of the points in the sweep, (n,)."""


def lines_along(columns: Mapping[str, Array], parameter_name: str) -> Iterator[ParameterLine]:
    """Yields the lines of points that differ in the parameter `parameter_name` only, in the order of their
    first points. Points at which this parameter is inf or NaN are left out. columns: each parameter at every
    point, (points,)."""
    x = columns[parameter_name]
    other_names = [other for other in columns if other != parameter_name]
    other_values = np.stack([columns[other] for other in other_names], axis=-1)
    _, first_rows, line_numbers = np.unique(other_values, axis=0, return_index=True, return_inverse=True)
    sorted_points = np.argsort(line_numbers.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(line_numbers.ravel()))
    for line_number in np.argsort(first_rows):
        line_points = sorted_points[ends[line_number - 1] if line_number else 0 : ends[line_number]]
        line_points = line_points[np.isfinite(x[line_points])]
        values_of_line = dict(zip(other_names, other_values[first_rows[line_number]].tolist(), strict=True))
        yield ParameterLine(parameter_name, values_of_line, x[line_points], line_points)
