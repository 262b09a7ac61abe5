"""Loads of a phase diagram of an arm above which the arm is compressed beyond the limit of the model."""

import numpy as np

from ....model.arm.neglected import COMPRESSION_LIMIT
from ....model.arm.quantities import SCALE_NAME, UNITS
from ....results.file.view import View
from ...crushing import build_of_rods
from .arm import range_in_unit
from .extreme_loads import ANSWER_DIGITS


def compression_lines(view: View, rods: np.ndarray) -> list[str]:
    """Line with the range of loads above which the rows of a phase diagram are compressed beyond the limit,
    in a list; empty for other tasks, and if all loads of the rows are smaller. rods: mask of rows, (...,).

    The validity of a row is that at its first Hopf point, and a row has larger loads. Rubber has no limit of
    compression, because its law includes large compression. Raises InputError if this version of rodsweep
    does not accept the config of the file.
    """
    if "F" in view.parameters or "F" not in view.variables or not rods.any():
        return []  # no rows along F
    columns = view.point_columns
    tapers = columns.get("taper", np.ones_like(columns["k1"]))
    largest = COMPRESSION_LIMIT * columns["k1"] * build_of_rods(view).relative_crushing_forces(tapers)
    forces = largest.reshape(rods.shape)[rods]
    if not forces.min() < view.variables["F"].max():
        return []
    kind = view.load_kind
    loads = forces * np.broadcast_to(view.variables[SCALE_NAME[kind]], rods.shape)[rods]
    text = range_in_unit(view, loads[np.isfinite(loads)], UNITS[kind][0], 0.0, ANSWER_DIGITS)
    return [f"above {text} compression exceeds its limit, and the model does not apply"]
