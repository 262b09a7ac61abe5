"""Known numbers of unstable modes between the crossings of the rows of a phase diagram, and the crushing load
(zero stretch); with the curves they determine the areas of the diagram of a page."""

import json
from typing import Any

import numpy as np

from ...config.document.reading import config_from_resolved

Dataset = Any
"""An xarray.Dataset, or one of its arrays."""


def region_counts(data: Dataset, row_parameter: str) -> dict[str, Any]:
    """Variables between_x, between_y, between_count and crushing_load of `diagram_answer`, from a result of
    the task `phase_diagram` over F and the parameter `row_parameter`. Raises ValueError for a config that
    this version of rodsweep does not accept."""
    row_values = data[row_parameter].values
    positions, unstable_counts = (
        data[name].transpose(row_parameter, "crossing").values for name in ("crossing_at", "unstable_after")
    )
    material = config_from_resolved(json.loads(data.attrs["config_resolved"])).rod_material
    crushing_forces = material.relative_crushing_forces(
        data["taper"].values if "taper" in data else np.ones(())
    )
    crushing = np.broadcast_to(data["k1"].values * crushing_forces, row_values.shape)
    return {"crushing_load": crushing, **_points_between_crossings(row_values, positions, unstable_counts)}


def _points_between_crossings(
    y: np.ndarray, positions: np.ndarray, unstable_counts: np.ndarray
) -> dict[str, Any]:
    """Points midway between neighbouring crossings of a row, with the known number of unstable modes there:
    between_x, between_y, between_count, (points,) each. y: second parameter, (rows,). positions: loads at the
    crossings, in increasing order, NaN in unused entries, (rows, crossings). unstable_counts: numbers of
    unstable modes beyond the crossings, (rows, crossings)."""
    rows, crossing_indices = np.nonzero(np.isfinite(positions[:, 1:]) & (unstable_counts[:, :-1] >= 0))
    return {
        "between_x": (positions[rows, crossing_indices] + positions[rows, crossing_indices + 1]) / 2,
        "between_y": y[rows],
        "between_count": unstable_counts[rows, crossing_indices],
    }
