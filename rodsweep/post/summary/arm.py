"""What `rodsweep show` says of an arm: the numbers of every task that are told in SI units."""

import json

import numpy as np

from ...results.file.view import View
from ...results.layouts import LAYOUTS
from ...results.layouts.arm import twins_of
from .ranges import span


def arm_lines(view: View, done: np.ndarray) -> list[str]:
    """The ranges of what is stored in SI units, over the points that are `done`, a mask of their shape."""
    if not view.quantities:
        return []
    config = json.loads(view.attributes["config_resolved"])
    lines = []
    for variable in twins_of(LAYOUTS[view.task](config), config):
        values = view.variables[variable.name][done]
        if not variable.extra and np.isfinite(values).any():
            lines.append(f"{variable.name} = {span(values)} {variable.units}")
    return [f"in SI units: {'; '.join(lines)}"] if lines else []
