"""Loads of arms in words: flutter as a force at the tip, the arms with extreme flutter loads, the effect of
drag, and the loads that compress an arm beyond the limit of the model."""

from collections.abc import Mapping

import numpy as np

from ....model.arm.neglected import COMPRESSION_LIMIT, DOUBTFUL_RATIO
from ....model.arm.quantities import LOAD_SCALE_NAME_BY_LOAD, UNITS_AND_EXAMPLES
from ....results.file.view import ResultView
from ....wording import two_significant_digits
from ...crushing import crushing_forces
from ..selection import PointSelection
from .arm_texts import arm_quantity_ranges_text, range_text_in_printing_unit, varied_arm_quantities

MAX_ANSWER_DIGITS = 3
"""Largest number of significant digits in an answer; a number with a large error has fewer digits."""
VERDICTS_BY_COMPRESSION = {
    DOUBTFUL_RATIO: f"is more than {DOUBTFUL_RATIO:g} times its limit, and the model is doubtful",
    1.0: "exceeds its limit, and the model does not apply",
}
"""Verdicts on the model, by ratio of compression to its limit; a verdict holds above its ratio."""


def flutter_force_line(arms: PointSelection) -> list[str]:
    """Line with the range of the flutter forces at the tip, and the arms with the extreme forces; empty if
    the load is a force or if no arm flutters.

    Of two arms with tips of different size, the larger flutter pressure may be the smaller force.
    """
    forces = (arms.variables["F_hopf"] * arms.variables[LOAD_SCALE_NAME_BY_LOAD["force"]])[arms.mask]
    if arms.view.load_kind == "force" or not np.isfinite(forces).any():
        return []
    extremes_text = extreme_arms_text(arms, forces, "smallest")
    text = range_text_in_printing_unit(arms.view, forces, "N", 0.0, MAX_ANSWER_DIGITS)
    return [f"flutter as a force at the tip: {text}{f', {extremes_text}' if extremes_text else ''}"]


def extreme_arms_text(arms: PointSelection, loads: np.ndarray, smallest: str) -> str:
    """The arms with the smallest and with the largest of the loads, (n,), as text; empty for fewer than two
    finite loads or if both arms have the same text. smallest: phrase before the first arm."""
    if np.isfinite(loads).sum() < 2:
        return ""
    indices = np.flatnonzero(arms.mask)
    ends = (indices[np.nanargmin(loads)], indices[np.nanargmax(loads)])
    first_text, last_text = (
        arm_quantity_ranges_text(PointSelection(arms.view, np.arange(arms.mask.size) == end)) for end in ends
    )
    return "" if first_text == last_text else f"{smallest} at {first_text}; largest at {last_text}"


def drag_variation_lines(arms: PointSelection, names: Mapping[str, str]) -> list[str]:
    """Line on how much variables vary between the drags of one arm; an empty list if the drag does not vary.
    names: variables by printed name."""
    arm_indices = arm_index_apart_from_drag(arms.view)
    if arm_indices is None:
        return []
    up_to = "up to " if len(np.unique(arm_indices)) > 1 else ""
    variations = []
    for word, name in names.items():
        values = np.where(arms.mask, arms.variables[name], np.nan).ravel()
        ratio = _largest_ratio_within_arm(values, arm_indices)
        if np.isfinite(ratio):
            factor_text = (
                f"{two_significant_digits(100 * (ratio - 1))} %" if ratio < 2 else f"a factor of {ratio:.3g}"
            )
            variations.append(f"{word} by {up_to}{factor_text}")
    drag_count = len(np.unique(varied_arm_quantities(arms.view)["drag"]))
    text = f"the results of an arm vary over the {drag_count} drags of its range: {', '.join(variations)}"
    return [text] if variations else []


def arm_index_apart_from_drag(view: ResultView) -> np.ndarray | None:
    """Index of the arm at each point, (points,): equal for points that differ only in drag. None if drag does
    not vary."""
    columns = varied_arm_quantities(view)
    if columns.pop("drag", None) is None:
        return None
    point_count = view.variables["status"].size
    table = np.stack([np.zeros(point_count), *map(np.nan_to_num, columns.values())], axis=-1)
    return np.unique(table, axis=0, return_inverse=True)[1].ravel()


def _largest_ratio_within_arm(values: np.ndarray, arm_indices: np.ndarray) -> float:
    """Maximum, over all arms, of the largest value of an arm divided by the smallest; NaN if no arm has two
    or more values that are all positive. arm_indices: index of the arm at each point, as from
    `arm_index_apart_from_drag`."""
    ratios = []
    for index in np.unique(arm_indices):
        arm_values = values[(arm_indices == index) & np.isfinite(values)]
        if len(arm_values) > 1 and arm_values.min() > 0:
            ratios.append(float(arm_values.max() / arm_values.min()))
    return max(ratios, default=np.nan)


def compression_lines(rows: PointSelection) -> list[str]:
    """Lines about compression in the rows of a phase diagram (a row: all loads F of one arm): one line with
    the loads above which compression makes the model doubtful, one with the loads above which compression
    exceeds the limit of the model. A line is left out if no load of the rows is so large. Empty for files
    without rows along F.

    The validity that the file stores for a row belongs to the first Hopf point, but a row also contains
    larger loads. Rubber has no limit of compression, because its law includes large compression. Raises
    InputError if this version of rodsweep does not accept the config of the file.
    """
    view = rows.view
    if "F" in view.parameters or "F" not in view.variables or not rows.count:
        return []  # no rows along F
    limits = COMPRESSION_LIMIT * crushing_forces(view)[rows.mask.ravel()]
    kind = view.load_kind
    scale = np.broadcast_to(view.variables[LOAD_SCALE_NAME_BY_LOAD[kind]], rows.mask.shape)[rows.mask]
    lines = []
    for max_fraction, verdict in VERDICTS_BY_COMPRESSION.items():
        if max_fraction * limits.min() < view.variables["F"].max():
            loads = max_fraction * limits * scale
            text = range_text_in_printing_unit(
                view, loads[np.isfinite(loads)], UNITS_AND_EXAMPLES[kind][0], 0.0, MAX_ANSWER_DIGITS
            )
            lines.append(f"above {text} compression {verdict}")
    return lines
