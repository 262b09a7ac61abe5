"""Loads of arms in words: flutter as a force at the tip, the arms with extreme flutter loads, and the loads
that compress an arm beyond the limit of the model."""

import numpy as np

from ....model.arm.neglected import COMPRESSION_LIMIT, DOUBTFUL_RATIO
from ....model.arm.quantities import SCALE_NAMES, UNITS
from ....results.file.view import ResultView
from ...crushing import material_of_rods
from ..selection import Selection
from .arm import range_in_unit, region_of_arms

ANSWER_DIGITS = 3
"""Largest number of significant digits in an answer; a number with a large error has fewer digits."""
VERDICTS_BY_COMPRESSION = {
    DOUBTFUL_RATIO: f"is more than {DOUBTFUL_RATIO:g} times its limit, and the model is doubtful",
    1.0: "exceeds its limit, and the model does not apply",
}
"""Verdict on the model, by the compression above which the verdict holds, as a fraction of its limit."""


def flutter_force_line(view: ResultView, rods: np.ndarray) -> list[str]:
    """Line with the range of the flutter forces at the tip, and with their extreme arms; empty if the load is
    a force, and if no arm flutters. rods: mask of the points with a result, (...,).

    Of two arms with tips of different size, the larger flutter pressure may be the smaller force.
    """
    forces = (view.variables["F_hopf"] * view.variables[SCALE_NAMES["force"]])[rods]
    if view.load_kind == "force" or not np.isfinite(forces).any():
        return []
    extremes_text = extreme_arms_text(view, rods, forces, "smallest")
    text = range_in_unit(view, forces, "N", 0.0, ANSWER_DIGITS)
    return [f"flutter as a force at the tip: {text}{f', {extremes_text}' if extremes_text else ''}"]


def extreme_arms_text(view: ResultView, rods: np.ndarray, loads: np.ndarray, smallest: str) -> str:
    """The arms with the smallest and with the largest load as text; empty for fewer than two loads. loads:
    loads of the points in the mask `rods`, (n,)."""
    if np.isfinite(loads).sum() < 2:
        return ""
    indices = np.flatnonzero(rods)
    ends = [indices[argument(loads)] for argument in (np.nanargmin, np.nanargmax)]
    first_text, last_text = (region_of_arms(Selection(view, np.arange(rods.size) == end)) for end in ends)
    return "" if first_text == last_text else f"{smallest} at {first_text}; largest at {last_text}"


def compression_lines(view: ResultView, rods: np.ndarray) -> list[str]:
    """Lines with the ranges of loads above which compression makes the model doubtful on the rows of a phase
    diagram, and above which it exceeds the limit; empty for other tasks, and if all loads of the rows are
    smaller. rods: mask of rows, (...,).

    The validity of a row is that at its first Hopf point, and a row has larger loads. Rubber has no limit of
    compression, because its law includes large compression. Raises InputError if this version of rodsweep
    does not accept the config of the file.
    """
    if "F" in view.parameters or "F" not in view.variables or not rods.any():
        return []  # no rows along F
    columns = view.point_columns
    tapers = columns.get("taper", np.ones_like(columns["k1"]))
    largest = COMPRESSION_LIMIT * columns["k1"] * material_of_rods(view).relative_crushing_forces(tapers)
    limits = largest.reshape(rods.shape)[rods]
    kind = view.load_kind
    scale = np.broadcast_to(view.variables[SCALE_NAMES[kind]], rods.shape)[rods]
    lines = []
    for max_fraction, verdict in VERDICTS_BY_COMPRESSION.items():
        if max_fraction * limits.min() < view.variables["F"].max():
            loads = max_fraction * limits * scale
            text = range_in_unit(view, loads[np.isfinite(loads)], UNITS[kind][0], 0.0, ANSWER_DIGITS)
            lines.append(f"above {text} compression {verdict}")
    return lines
