"""How far the numbers of one arm differ over the drags of its range."""

from collections.abc import Mapping

import numpy as np

from ....results.file.view import View
from .arm import given_columns


def drag_lines(view: View, numbers: Mapping[str, np.ndarray]) -> list[str]:
    """How far numbers at the points of a file, each (points,), by name, differ over the drags of an arm."""
    arms = arms_of_drags(view)
    if arms is None:
        return []
    drags, several = len(np.unique(given_columns(view)["drag"])), len(np.unique(arms)) > 1
    told = []
    for name, values in numbers.items():
        spread = _largest_spread(values, arms)
        if np.isfinite(spread):
            told.append(f"{name} by {'up to ' * several}{_factor(spread)}")
    return [f"over {drags} drags of its range one arm varies: {', '.join(told)}"] if told else []


def arms_of_drags(view: View) -> np.ndarray | None:
    """A number for each point, (points,), equal where only the drag differs; None where it does not."""
    columns = given_columns(view)
    if columns.pop("drag", None) is None:
        return None
    count = view.variables["status"].size
    table = np.stack([np.zeros(count), *(np.nan_to_num(column) for column in columns.values())], axis=-1)
    return np.unique(table, axis=0, return_inverse=True)[1].ravel()


def _largest_spread(values: np.ndarray, arms: np.ndarray) -> float:
    """Largest over least value of an arm, the most of all arms; nan where no arm has two values."""
    spreads = [np.nan]
    for arm in np.unique(arms):
        there = values[(arms == arm) & np.isfinite(values)]
        if len(there) > 1 and there.min() > 0:
            spreads.append(float(there.max() / there.min()))
    return float(np.nanmax(spreads)) if len(spreads) > 1 else np.nan


def _factor(spread: float) -> str:
    """A ratio in percent, or as a factor."""
    return f"{100 * (spread - 1):.2g} %" if spread < 2 else f"a factor of {spread:.3g}"
