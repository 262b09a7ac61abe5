"""Hopf points of the straight rod on the lines of points of a file, for figures and for `show`. A line: rods
that differ in one parameter.

The Hopf points depend only on the config and are stored before any point is solved. Hence the file has the
Hopf points of all its lines after a run, an extension or a merge.
"""

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from ...model.material.rod_material import DEFAULT_MATERIAL, RodMaterial
from ...model.parameters import TRANSVERSE_PARAMETER_NAMES
from ...model.rod import Rod
from ...results.layouts.limit_cycle import hopf_point_variables
from ...results.layouts.variables import FilledVariable
from ...sweep.points.points import Points

if TYPE_CHECKING:
    from ...solve.changes.threshold_kinds import Threshold
    from ...solve.changes.thresholds_along_path import ThresholdSearchResult


@dataclass(frozen=True, slots=True)
class HopfSearchLine:
    """Rods that differ in one parameter, which varies from `start` to `stop`; other parameters are fixed."""

    varied_parameter: str
    """The parameter that varies."""
    fixed_parameters: dict[str, float]
    """The fixed parameters of the straight rod."""
    start: float
    stop: float
    material: RodMaterial = DEFAULT_MATERIAL
    """Constitutive law and profile of all rods on the line."""

    def hopf_points(self) -> "ThresholdSearchResult | None":
        """Hopf points on the line. The search leaves out crushed rods on lines along F and along k1; None if
        all rods on such a line are crushed, or if the search fails."""
        from ...determinant.arm.determinant import forget_arm_determinants
        from ...determinant.parameter_path import ParameterPath
        from ...solve.changes.search_range import CRUSHING_END_SETTINGS
        from ...solve.changes.thresholds_along_path import find_imaginary_axis_crossings
        from ...solve.point_outcome import FAILURE_EXCEPTIONS

        forget_arm_determinants()
        fixed = self.fixed_parameters
        ratio = self.material.crushing_force_over_k1(fixed.get("taper", 1.0))
        margin = 1 - CRUSHING_END_SETTINGS.relative_crushing_margin
        start_value = self.start
        end_value = self.stop
        if self.varied_parameter == "F":
            end_value = min(end_value, ratio * fixed["k1"] * margin)
        if self.varied_parameter == "k1":
            start_value = max(start_value, fixed["F"] / (ratio * margin))
        if not start_value < end_value:
            return None
        start_values: dict[str, Any] = fixed | {self.varied_parameter: start_value}
        try:
            path = ParameterPath(Rod(**start_values, material=self.material), self.varied_parameter)
            return find_imaginary_axis_crossings(path, start_value, end_value)
        except (
            *FAILURE_EXCEPTIONS,
            ValueError,
        ):  # ValueError: the search needs a rod outside the model's range
            return None


def hopf_search_lines_of_points(points: Points) -> list[HopfSearchLine]:
    """Lines, without repetition, on which the points of a file lie: along each parameter, the rods that
    differ only in this parameter. Rods that differ only in gamma1 share a line."""
    names = [name for name in TRANSVERSE_PARAMETER_NAMES if name in points.parameter_values_of_rods]
    return [line for name in names for line in _hopf_search_lines_along(points, name, names)]


def _hopf_search_lines_along(points: Points, name: str, names: Sequence[str]) -> Iterator[HopfSearchLine]:
    """Yields the lines along the parameter `name`, if at least two of its values are finite. Lines along F
    begin at 0 or a pull, because the Hopf point may lie below the smallest force of the points. Arms with
    equal parameters and different profiles have no line, because a file cannot distinguish such arms."""
    columns = {parameter_name: points.parameter_values_of_rods[parameter_name] for parameter_name in names}
    other_names = [parameter_name for parameter_name in names if parameter_name != name]
    if points.is_grid:
        rods = np.array(
            list(product(*(np.unique(columns[parameter_name]) for parameter_name in other_names)))
        )
        range_ends = [_finite_range(columns[name])] * len(rods)
        materials = [points.material] * len(rods)
    else:
        distinct_materials, numbers = points.distinct_materials_and_indices
        table = np.stack([numbers, *(columns[parameter_name] for parameter_name in other_names)], axis=-1)
        lines, line = np.unique(table, axis=0, return_inverse=True)
        order = np.argsort(line.ravel(), kind="stable")
        line_starts = np.cumsum(np.bincount(line.ravel()))[:-1]
        range_ends = [_finite_range(values) for values in np.split(columns[name][order], line_starts)]
        rods = lines[:, 1:]
        materials = [distinct_materials[int(number)] for number in lines[:, 0]]
    rod_counts = Counter(map(tuple, rods.tolist()))
    for rod, (start, end), material in zip(map(tuple, rods.tolist()), range_ends, materials, strict=True):
        if start < end and rod_counts[rod] == 1:
            search_start = min(start, 0.0) if name == "F" else start
            yield HopfSearchLine(name, dict(zip(other_names, rod, strict=True)), search_start, end, material)


def _finite_range(values: np.ndarray) -> tuple[float, float]:
    """(smallest, largest) of the finite values in `values`, (n,); (0, 0) if no value is finite."""
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)


def filled_hopf_point_variables(
    names: Collection[str], lines: Sequence[HopfSearchLine], results: "Sequence[ThresholdSearchResult | None]"
) -> tuple[FilledVariable, ...]:
    """Hopf points of all lines, one line after another, as variables of a file. names: parameters of the
    points. results: result of `HopfSearchLine.hopf_points` of each line."""
    solved = [(line, result) for line, result in zip(lines, results, strict=True) if result is not None]
    rows = [_hopf_point_values(line, crossing) for line, result in solved for crossing in result.thresholds]
    proved = sum(result.is_proved_to_the_end for _, result in solved)
    counts = {"hopf_lines": len(lines), "hopf_lines_proved": proved}
    return tuple(
        (
            variable,
            np.array(
                counts[variable.name] if variable.name in counts else [row[variable.name] for row in rows],
                variable.dtype,
            ),
        )
        for variable in hopf_point_variables(names)
    )


def _hopf_point_values(line: HopfSearchLine, crossing: "Threshold") -> dict[str, Any]:
    """Variables of the file for one Hopf point on a line."""
    rod = line.fixed_parameters | {line.varied_parameter: crossing.value}
    return {f"hopf_{name}": rod[name] for name in TRANSVERSE_PARAMETER_NAMES if name in rod} | {
        "hopf_along": TRANSVERSE_PARAMETER_NAMES.index(line.varied_parameter),
        "hopf_kind": int(crossing.kind),
        "hopf_error": crossing.error / abs(crossing.value),
        "hopf_frequency": crossing.frequency,
        "hopf_frequency_error": crossing.frequency_error,
        "hopf_unstable_after": crossing.unstable_after,
    }
