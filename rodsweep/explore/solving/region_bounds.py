"""Known numbers of unstable modes between the crossings of the rows of a phase diagram, and the load that
crushes the rods; with the curves they determine the areas of the diagram of a page.
"""

import json
from typing import Any

import numpy as np

from ...config.document.reading import config_from_resolved

Dataset = Any
"""An xarray.Dataset, or one of its arrays."""


def region_bounds(data: Dataset, second: str) -> dict[str, Any]:
    """Variables between_x, between_y, between_count and crushing_load of `diagram_answer`, from a result of
    the task `phase_diagram` over F and the parameter `second`. Raises ValueError for a config that this
    version of rodsweep does not accept.
    """
    y = data[second].values
    at, after = (
        data[name].transpose(second, "crossing").values for name in ("crossing_at", "unstable_after")
    )
    build = config_from_resolved(json.loads(data.attrs["config_resolved"])).build
    share = build.relative_crushing_forces(data["taper"].values if "taper" in data else np.ones(()))
    crushing = np.broadcast_to(data["k1"].values * share, y.shape)
    return {"crushing_load": crushing, **_points_between_crossings(y, at, after)}


def _points_between_crossings(y: np.ndarray, at: np.ndarray, after: np.ndarray) -> dict[str, Any]:
    """Points midway between neighbouring crossings of a row, with the known number of unstable modes there:
    between_x, between_y, between_count, (points,) each. y: second parameter, (rows,). at: loads at the
    crossings, in increasing order, NaN in unused entries, (rows, crossings). after: numbers of unstable modes
    beyond the crossings, (rows, crossings).
    """
    rows, places = np.nonzero(np.isfinite(at[:, 1:]) & (after[:, :-1] >= 0))
    return {
        "between_x": (at[rows, places] + at[rows, places + 1]) / 2,
        "between_y": y[rows],
        "between_count": after[rows, places],
    }
