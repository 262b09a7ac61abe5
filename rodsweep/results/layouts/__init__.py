"""Layouts: the variables in the file of each task, and `layout_of`, which finds the layout of a config."""

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from . import branch, criticality, limit_cycle, modes, phase_diagram, spectrum, thresholds
from .rod_properties import optional_parameters_in
from .si_variables import with_si_variables
from .variables import Layout, ReuseRule, Variable

LAYOUT_MODULES = {
    "spectrum": spectrum,
    "thresholds": thresholds,
    "phase_diagram": phase_diagram,
    "modes": modes,
    "limit_cycle": limit_cycle,
    "criticality": criticality,
    "branch": branch,
}
LAYOUT_MAKERS: dict[str, Callable[[dict[str, Any]], Layout]]
LAYOUT_MAKERS = {task: module.layout for task, module in LAYOUT_MODULES.items()}
"""Function from a resolved config to the layout of the file, by task."""
REUSE_RULES_BY_TASK: dict[str, dict[str, ReuseRule]]
REUSE_RULES_BY_TASK = {
    task: module.REUSE_RULES_OF_INCREASED_OPTIONS for task, module in LAYOUT_MODULES.items()
}
"""Rules, by task and option, for the options whose larger values request more data of a point. A file cannot
be extended if any other option changes."""
SWEEP_WIDE_VARIABLE_MAKERS: dict[str, Callable[[dict[str, Any], bool], tuple[Variable, ...]]] = {
    "spectrum": spectrum.sweep_wide_variables,
    "modes": lambda config, is_grid: spectrum.FORCE_THRESHOLD_VARIABLES,
    "phase_diagram": phase_diagram.sweep_wide_variables,
    "limit_cycle": limit_cycle.sweep_wide_variables,
}
"""Function from (resolved config, whether the points are a grid) to the variables that belong to all points
together, by task."""


def layout_of(config: dict[str, Any]) -> Layout:
    """Layout of the result file for a resolved config of any task; raises KeyError for an unknown task."""
    task = config["task"]
    if task not in LAYOUT_MAKERS:
        raise KeyError(f"unknown task {task}")
    layout = LAYOUT_MAKERS[task](config)
    parameters = (*layout.parameters, *optional_parameters_in(config))
    return with_si_variables(replace(layout, parameters=parameters), config)


def sweep_wide_variables(config: dict[str, Any], is_grid: bool) -> tuple[Variable, ...]:
    """Variables of a file that belong to all points together, for a resolved config; empty for most tasks.

    is_grid: whether the points are a grid. The field `extra_dimensions` of these variables names all their
    dimensions.
    """
    make_variables = SWEEP_WIDE_VARIABLE_MAKERS.get(config["task"])
    return make_variables(config, is_grid) if make_variables else ()


def lacks_sweep_wide_variables(attributes: Mapping[str, Any]) -> bool:
    """Whether a file with these attributes still lacks the variables that depend on all points, such as the
    curves of a phase diagram."""
    if "finished" in attributes or "config_resolved" not in attributes:
        return False
    return layout_of(json.loads(attributes["config_resolved"])).has_sweep_wide_variables
