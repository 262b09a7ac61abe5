"""Stability curves of a phase diagram, for the diagram on the page, and the known numbers of unstable modes
between neighbouring thresholds at equal second parameter."""

import json
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from ...config.document.reading import config_from_resolved

DatasetOrArray = Any
"""An xarray.Dataset, or one of its arrays."""


class DiagramCurve(NamedTuple):
    """Curve in the plane of a diagram. x: loads, (points,). y: second parameter, (points,). kind: kind of the
    points of the curve."""

    x: Array
    y: Array
    kind: str


def diagram_curves(data: DatasetOrArray, prefix: str, second_parameter: str) -> list[DiagramCurve]:
    """Curves of a result of the task `phase_diagram` over F and the parameter `second_parameter`. prefix:
    start of the names of the variables of the curves, "curve" or "cycle_curve"."""
    numbers = data[f"{prefix}_number"].values
    x, y = (data[f"{prefix}_{name}"].values for name in ("F", second_parameter))
    kinds = flag_words(data[f"{prefix}_kind"])
    lines = [np.flatnonzero(numbers == number) for number in np.unique(numbers)]
    return [DiagramCurve(x[line], y[line], str(kinds[line[0]])) for line in lines]


def unstable_counts_between_crossings(data: DatasetOrArray, row_parameter: str) -> dict[str, Any]:
    """Variables between_x, between_y, between_count and crushing_load of `diagram_answer`, from a result of
    the task `phase_diagram` over F and the parameter `row_parameter`. Raises ValueError for a config that
    this version of rodsweep does not accept."""
    row_values = data[row_parameter].values
    positions, unstable_counts = (
        data[name].transpose(row_parameter, "crossing").values for name in ("crossing_at", "unstable_after")
    )
    material = config_from_resolved(json.loads(data.attrs["config_resolved"])).rod_material
    crushing_forces = material.crushing_forces_over_k1(
        data["taper"].values if "taper" in data else np.ones(())
    )
    # Counts are known between neighbouring crossings of a row, so take the points midway.
    rows, crossings = np.nonzero(np.isfinite(positions[:, 1:]) & (unstable_counts[:, :-1] >= 0))
    return {
        "crushing_load": np.broadcast_to(data["k1"].values * crushing_forces, row_values.shape),
        "between_x": (positions[rows, crossings] + positions[rows, crossings + 1]) / 2,
        "between_y": row_values[rows],
        "between_count": unstable_counts[rows, crossings],
    }


def flag_words(array: DatasetOrArray) -> Any:
    """Array of the words for an array of integer flags, with the same shape. Flags and words are listed in
    the attributes of the array; an unlisted flag has the word "none"."""
    names = str(array.attrs["flag_meanings"]).split()
    by_code = dict(zip(map(int, np.atleast_1d(array.attrs["flag_values"])), names, strict=True))
    return np.vectorize(lambda code: by_code.get(int(code), "none"), otypes=[object])(array.values)
