"""What the file of each task holds: its variables, and `layout_of`, which finds them from a config."""

import json
from collections.abc import Callable, Mapping
from typing import Any

from . import branch, criticality, limit_cycle, modes, phase_diagram, spectrum, thresholds
from .arm import with_si
from .variables import Increase, Layout, Variable

MODULES = {
    "spectrum": spectrum,
    "thresholds": thresholds,
    "phase_diagram": phase_diagram,
    "modes": modes,
    "limit_cycle": limit_cycle,
    "criticality": criticality,
    "branch": branch,
}
LAYOUTS: dict[str, Callable[[dict[str, Any]], Layout]] = {
    task: module.layout for task, module in MODULES.items()
}
INCREASES: dict[str, dict[str, Increase]] = {task: module.INCREASES for task, module in MODULES.items()}
"""The options of every task that ask for more of a point; another value of any other makes another file."""

BESIDE_POINTS: dict[str, Callable[[dict[str, Any], bool], tuple[Variable, ...]]] = {
    "spectrum": spectrum.beside_points,
    "modes": lambda config, is_grid: spectrum.FORCE_CHANGES,
    "phase_diagram": phase_diagram.beside_points,
    "limit_cycle": lambda config, is_grid: limit_cycle.HOPF_POINTS,
}
"""What tasks store that all points share or together give, from (resolved config, whether a grid)."""


def layout_of(config: dict[str, Any]) -> Layout:
    """The layout that the resolved config of any task asks for."""
    task = config["task"]
    if task not in LAYOUTS:
        raise KeyError(f"unknown task {task}")
    return with_si(LAYOUTS[task](config), config)


def beside_points(config: dict[str, Any], is_grid: bool) -> tuple[Variable, ...]:
    """What the file of a resolved config may hold beside its points; `extra` has all dimensions."""
    found = BESIDE_POINTS.get(config["task"])
    return found(config, is_grid) if found else ()


def lacks_curves(attributes: Mapping[str, Any]) -> bool:
    """Whether the file with these attributes still lacks the curves that all its points together give."""
    if "finished" in attributes or "config_resolved" not in attributes:
        return False
    return layout_of(json.loads(attributes["config_resolved"])).needs_all_points
