"""State with which the page opens for a result file or a config, and the diagram stored in a result file."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..api.dataset import open_result
from ..config.base_config import Config
from ..config.document.reading import config_from_resolved, read_config
from ..config.task.branch import BranchConfig
from ..errors import InputError
from ..results import RESULT_SUFFIXES
from .answers_from_file import AnswersFromFile
from .page_state import (
    DEFAULT_ARM,
    DEFAULT_ROD,
    LARGEST_FORCE_KEY_BY_TASK,
    MATERIAL_SECTION_BY_LAW,
    PAGE_F_MAX,
    SECOND_PARAMETERS,
    PageState,
)
from .slider_scales import SLIDER_SCALES
from .solving.diagram_curves_and_unstable_counts import DatasetOrArray
from .solving.diagrams import (
    diagram_from_arm_thresholds,
    diagram_from_rod_grid,
    diagram_from_rod_thresholds,
)
from .solving.requests import crushing_force

KEYS_OUTSIDE_ARM_TAB = ("density_difference", "fluid_density", "law", "section")
"""Keys of an arm that are ignored or have a control outside the tab of the arm."""
RELATIVE_PRESSURE_KEY = "pressure_over_flutter"
"""Key of an arm's pressure relative to flutter. The control of the pressure shows such a pressure as a text
like "0.5 of flutter"."""


def state_and_answers_from_file(path: Path) -> tuple[PageState, AnswersFromFile | None]:
    """Returns (state, stored). state: state with which the page opens for a result file or a config. stored:
    answers of a result file; None for a config.

    Raises InputError for any other file, and for an arm that the page cannot show.
    """
    if path.suffix not in RESULT_SUFFIXES:
        return state_from_config(read_config(path)[0], path), None
    data = open_result(path)
    try:
        state = state_from_config(config_from_resolved(json.loads(data.attrs["config_resolved"])), path)
    except ValueError as error:
        raise InputError(f"{path}: {error}") from None
    return state, AnswersFromFile(path, data, state, stored_diagram(data, state))


def state_from_config(config: Config, path: Path, F_max: str = PAGE_F_MAX) -> PageState:
    """State of the page for a config.

    Each parameter has the middle value of its axis; F has the middle of the values that do not crush a rod of
    linear material. The parameter with the most values, except the load, is the second parameter of the
    diagram. path: file of the config, for error messages. F_max: largest force if the config has none. Raises
    InputError for a list of points, and for an arm that the page cannot show.
    """
    F_max = _largest_force(config, F_max)
    if config.parameters.arm is not None:
        return replace(_state_from_arm_config(config, path), F_max=F_max)
    material = _law_key(config, path)
    axes = {name: axis.array() for name, axis in config.parameters.axes.items()}
    if not axes:
        raise InputError(
            f"{path}: a list of points has no diagram; open the result of a grid, or give axes instead of "
            "parameters.points"
        )
    if isinstance(config, BranchConfig) and config.branch.along != "F":
        ends = (config.branch.start, config.branch.stop)
        axes[config.branch.along] = np.array([sum(ends) / 2])
    rod = DEFAULT_ROD | {name: _middle_value_text(axes[name]) for name in DEFAULT_ROD if name in axes}
    second = _second_parameter("rod", axes)
    state = PageState(rod=rod, law=material, across=second, F_max=F_max)
    F = axes.get("F", np.zeros(1))
    if len(F) > 1:
        if material == "linear":
            F_possible = F[
                crushing_force(
                    {parameter_name: float(rod[parameter_name]) for parameter_name in ("k1", "taper")}
                )
                > F
            ]
            state = state.with_values(F=_middle_value_text(F_possible if len(F_possible) else F))
        if F.max() > 0:
            state = replace(state, F_max=f"{F.max():g}")
    return state


def _largest_force(config: Config, default: str) -> str:
    """Largest force of a search for thresholds, or of branches along F, as text; `default` for other
    tasks."""
    key = LARGEST_FORCE_KEY_BY_TASK.get(config.task)
    options: Any = getattr(config, config.task, None)
    if key is not None and getattr(options, "along", "F") == "F":
        return _fifteen_digit_text(getattr(options, key))
    return default


def _state_from_arm_config(config: Config, path: Path) -> PageState:
    if other_axes := list(config.parameters.given_axes):
        raise InputError(
            f"{path}: the page cannot show an arm with {other_axes[0]} of its own; "
            f"it calculates {other_axes[0]} from the arm's {', '.join(DEFAULT_ARM)}"
        )
    section: Any = config.parameters.arm
    quantities = {name: getattr(section, name) for name in type(section).model_fields}
    quantities = {name: value for name, value in quantities.items() if value is not None}
    shares = quantities.pop(RELATIVE_PRESSURE_KEY, None)
    omitted = [name for name in quantities if name not in (*DEFAULT_ARM, *KEYS_OUTSIDE_ARM_TAB)]
    if omitted:
        reason = f"the page cannot show an arm with {omitted[0]}"
        raise InputError(f"{path}: {reason}; its controls are {', '.join(DEFAULT_ARM)}")
    texts = dict(DEFAULT_ARM)
    axes = {name: quantities[name].array() for name in DEFAULT_ARM if name in quantities}
    for name, values in axes.items():
        scale = SLIDER_SCALES["arm"][name]
        value = scale.factor_from_si * float(values[len(values) // 2])
        texts[name] = scale.text(value) if len(values) > 1 else f"{_fifteen_digit_text(value)} {scale.unit}"
    if shares is not None:
        texts["pressure"] = f"{_middle_value_text(shares.array())} of flutter"
    return PageState(tab="arm", arm=texts, law=_law_key(config, path), across=_second_parameter("arm", axes))


def _second_parameter(tab: str, axes: Mapping[str, np.ndarray]) -> str:
    """Of the possible second parameters of the diagram on the tab `tab`, the parameter with the most values
    in `axes`; "" if none of these parameters has several values. axes: values, (n,), by name."""
    candidates = [name for name in SECOND_PARAMETERS[tab] if name in axes and len(axes[name]) > 1]
    return max(candidates, key=lambda name: len(axes[name]), default="")


def _law_key(config: Config, path: Path) -> str:
    """Constitutive law of a config, as a key of `MATERIAL_SECTION_BY_LAW`; "linear" for a law that the page
    does not offer. Raises InputError if the arm has a profile."""
    rod_material = config.rod_material
    if rod_material.profile is not None:
        raise InputError(f"{path}: the page cannot show an arm with a profile, only uniform arms and cones")
    law_values = {"law": rod_material.law, "section": rod_material.section}
    return next((key for key, value in MATERIAL_SECTION_BY_LAW.items() if value == law_values), "linear")


def _middle_value_text(values: np.ndarray) -> str:
    """Middle of the values, (n,), as text with six digits; with 15 digits if there is a single value."""
    return f"{values[len(values) // 2]:.6g}" if len(values) > 1 else _fifteen_digit_text(values[0])


def _fifteen_digit_text(value: float) -> str:
    """A number with 15 digits; further digits would show rounding errors of the conversion of units."""
    return f"{value:.15g}"


def stored_diagram(data: DatasetOrArray, state: PageState) -> dict[str, Any] | None:
    """Diagram of a result file over the load and the second parameter of `state`, at the middle values of all
    other parameters; None if the file contains no such diagram."""
    second_name = state.second_parameter
    dims = set(data["status"].dims)
    if second_name not in dims or data.sizes[second_name] < 2:
        return None
    other_names = [
        name for name in state.visible_texts if name in dims and name not in (state.load_name, second_name)
    ]
    data = data.isel({name: data.sizes[name] // 2 for name in other_names})
    row_values = data[second_name].values
    if state.tab == "arm":
        scale = SLIDER_SCALES["arm"]["pressure"]
        pressure = (scale.value(state.arm["pressure"]) or 0.0) / scale.factor_from_si
        return (
            diagram_from_arm_thresholds(data, row_values, pressure) if "crossing_pressure" in data else None
        )
    if "crossing_F" in data:
        return diagram_from_rod_thresholds(data, row_values, "crossing_F", float(data["F_end"].max()))
    if "unstable_count" in data and data.sizes.get("F", 1) > 1:
        return diagram_from_rod_grid(data, second_name)
    return None
