"""Variation of the results about an arm over the drags of its range."""

from collections.abc import Mapping

import numpy as np

from ....results.file.view import ResultView
from ....wording import two_digits
from .arm import varied_columns


def drag_lines(view: ResultView, numbers: Mapping[str, np.ndarray]) -> list[str]:
    """Line on the variation of each of the `numbers` over the drags of an arm; an empty list if drag does not
    vary. numbers: values at all points, (points,), by name."""
    arms = arm_index_of_points(view)
    if arms is None:
        return []
    drags = len(np.unique(varied_columns(view)["drag"]))
    has_several_arms = len(np.unique(arms)) > 1
    variations = []
    for name, values in numbers.items():
        ratio = _largest_spread(values, arms)
        if np.isfinite(ratio):
            factor_text = f"{two_digits(100 * (ratio - 1))} %" if ratio < 2 else f"a factor of {ratio:.3g}"
            variations.append(f"{name} by {'up to ' * has_several_arms}{factor_text}")
    if not variations:
        return []
    return [f"the results of an arm vary over the {drags} drags of its range: {', '.join(variations)}"]


def arm_index_of_points(view: ResultView) -> np.ndarray | None:
    """Index of the arm at each point, (points,): equal for points that differ only in drag. None if drag does
    not vary."""
    columns = varied_columns(view)
    if columns.pop("drag", None) is None:
        return None
    point_count = view.variables["status"].size
    table = np.stack(
        [np.zeros(point_count), *(np.nan_to_num(column) for column in columns.values())], axis=-1
    )
    return np.unique(table, axis=0, return_inverse=True)[1].ravel()


def _largest_spread(values: np.ndarray, arms: np.ndarray) -> float:
    """Maximum, over all arms, of the largest value of an arm divided by the smallest; NaN if no arm has two
    positive values. arms: index of the arm at each point, as from `arm_index_of_points`."""
    ratios = [np.nan]
    for arm in np.unique(arms):
        arm_values = values[(arms == arm) & np.isfinite(values)]
        if len(arm_values) > 1 and arm_values.min() > 0:
            ratios.append(float(arm_values.max() / arm_values.min()))
    return float(np.nanmax(ratios)) if len(ratios) > 1 else np.nan
