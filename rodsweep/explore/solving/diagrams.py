"""Stability diagram of a page: number of unstable modes of the straight rod over the load and a second
parameter."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from ...api.arm import Arm
from ...api.sweeping import sweep
from ...errors import InputError
from ...model.arm.quantities import GIVEN_QUANTITIES
from ...model.units import quantity_in_si
from ..page_state import MATERIAL_SECTION_BY_LAW, PageState, float_or_text
from .diagram_curves_and_unstable_counts import (
    DatasetOrArray,
    diagram_curves,
    flag_words,
    unstable_counts_between_crossings,
)

ROW_COUNT = 20
"""Number of values of the second parameter, for uniform rods of linear material."""
ROW_COUNT_OF_SLOW_DIAGRAMS = 8
"""Number of values of the second parameter for rods that are not uniform or not of linear material, for which
each value takes seconds, and for the search of folds and torus points of cycles."""
LOAD_VALUE_COUNT = 121
"""Number of load values. Additional values are cheap: the stability at all loads follows from the thresholds
at the same value of the second parameter."""
ARM_ROW_COUNT = 12
"""Number of values of the second quantity of the diagram, for arms."""
ARM_QUANTITY_MAX_TO_CURRENT_RATIO = 2.0
"""The values of an arm's second quantity extend from 1/ARM_QUANTITY_MAX_TO_CURRENT_RATIO to
ARM_QUANTITY_MAX_TO_CURRENT_RATIO times the current value; the ratio is small, so that all arms are
slender."""
CACHED_DIAGRAM_COUNT = 8
"""Number of solved diagrams that a solver process keeps, some 100 kB each. The search for folds and torus
points adds curves to the diagram that was drawn last."""
DIAGRAM_CYCLE_ACCURACY = 1e-4
"""Relative error of the cycles between special points; the diagram does not show these cycles. For the first
rod of the page and F up to 200, the default error of 1e-6 takes three times as long, and changes the curves
of folds and torus points by 2e-8 at most."""
EMPTY_CURVE_VARIABLES: dict[str, Any] = {
    "curves": (),
    "cycle_curves": (),
    **dict.fromkeys(("between_x", "between_y", "between_count", "crushing_load"), np.zeros(0)),
}
"""Variables of a diagram without curves and without known numbers of unstable modes between thresholds."""
UNKNOWN_UNSTABLE_COUNT = -1
"""Value of `unstable_count` at a point whose number of unstable modes is unknown."""
CRUSHED_UNSTABLE_COUNT = -2
"""Value of `unstable_count` at a point whose load crushes the rod."""
PARAMETER_MAX_TO_CURRENT_RATIO = 10.0
"""The values of a rod's second parameter extend from 1/PARAMETER_MAX_TO_CURRENT_RATIO to
PARAMETER_MAX_TO_CURRENT_RATIO times the current value."""
TAPER_RANGE = (0.4, 1.6)
"""(smallest, largest) taper of the diagram. Cones with a smaller taper take minutes."""


def diagram_answer(state: PageState) -> dict[str, Any]:
    """Stability diagram around the rod or arm of `state`, as arrays by name.

    x: load, (columns,): F in k3/L^2, or for arms the pressure in Pa. y: second parameter, (rows,), for arms
    in SI units. unstable_count: number of unstable modes, UNKNOWN_UNSTABLE_COUNT or CRUSHED_UNSTABLE_COUNT,
    (rows, columns). between_x, between_y, between_count: places between neighbouring crossings of a row, and
    numbers of unstable modes there, (places,). crushing_load: the crushing load (zero stretch) of a row,
    (rows,), or empty. curves: stability boundaries. cycle_curves: curves of folds and torus points of cycles.
    crossing_x, crossing_y, crossing_kind: thresholds on the rows, (crossings,), empty for uniform rods.
    """
    state.rod_or_arm()
    if state.tab == "arm":
        return _diagram_of_arms(state)
    is_uniform = has_uniform_linear_rods(state)
    return _diagram_of_uniform_rods(state) if is_uniform else _diagram_of_nonuniform_rods(state)


def diagram_answer_with_cycle_curves(state: PageState) -> dict[str, Any]:
    """The result of `diagram_answer` with curves of folds and torus points of cycles, which are searched at
    ROW_COUNT_OF_SLOW_DIAGRAMS values of the second parameter. A diagram that this process has already solved
    is not solved again.

    Raises InputError for arms, and for rods that are not uniform or not of linear material.
    """
    state.rod_or_arm()
    if not can_follow_cycle_curves(state):
        raise InputError(
            "folds and torus points of cycles are followed for uniform rods of linear material only, "
            "on the tab Rod"
        )
    gamma1 = state.parameters()["gamma1"]
    cycles = {"cycles": True, "cycle_accuracy": DIAGRAM_CYCLE_ACCURACY, "gamma1": gamma1}
    diagram = _diagram_of_uniform_rods(state, ROW_COUNT_OF_SLOW_DIAGRAMS, cycles)
    return _diagram_of_uniform_rods(state) | {"cycle_curves": diagram["cycle_curves"]}


def can_follow_cycle_curves(state: PageState) -> bool:
    """Whether `diagram_answer_with_cycle_curves` can follow folds and torus points of cycles for this
    state."""
    return state.tab == "rod" and has_uniform_linear_rods(state)


def has_uniform_linear_rods(state: PageState) -> bool:
    """Whether all rods of the diagram are uniform and of linear material."""
    return state.law == "linear" and state.second_parameter != "taper" and "taper" not in state.parameters()


def second_parameter_values(state: PageState, row_count: int = ROW_COUNT) -> np.ndarray:
    """Values of the second parameter, (row_count,): logarithmically spaced around the current value, or
    linearly over TAPER_RANGE for the taper. Raises InputError unless the current value is finite and
    positive."""
    if state.second_parameter == "taper":
        return np.linspace(*TAPER_RANGE, row_count)
    value = float_or_text(state.rod[state.second_parameter])
    if not (0 < value < np.inf):
        raise InputError(
            f"{state.second_parameter} = {value:g} has no diagram; a diagram needs a finite value above 0"
        )
    ratio = PARAMETER_MAX_TO_CURRENT_RATIO
    return np.geomspace(value / ratio, value * ratio, row_count)


def _fixed_parameters(state: PageState) -> dict[str, Any]:
    varied_or_unused = ("F", "gamma1", state.second_parameter)
    return {name: value for name, value in state.parameters().items() if name not in varied_or_unused}


def _diagram_of_uniform_rods(
    state: PageState, row_count: int = ROW_COUNT, cycles: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Diagram of uniform rods, with the variables of `diagram_answer`, from the task `phase_diagram`.
    row_count: number of values of the second parameter. cycles: further keywords of the sweep, which request
    folds and torus points of cycles."""
    rows = tuple(second_parameter_values(state, row_count).tolist())
    keywords = {**_fixed_parameters(state), **(cycles or {})}
    return _cached_uniform_rod_diagram(
        state.second_parameter, rows, state.largest_force(), tuple(keywords.items())
    )


@lru_cache(maxsize=CACHED_DIAGRAM_COUNT)
def _cached_uniform_rod_diagram(
    second_parameter: str, row_values: tuple[float, ...], F_max: float, keywords: tuple[tuple[str, Any], ...]
) -> dict[str, Any]:
    """Diagram of uniform rods, F from 0 to `F_max`, with a row for each of the `row_values` of the parameter
    `second_parameter`; cached, so callers must not change it. keywords: further keywords of the sweep."""
    axes: dict[str, Any] = {"F": np.linspace(0, F_max, LOAD_VALUE_COUNT), second_parameter: list(row_values)}
    data = sweep("phase_diagram", progress=False, **axes, **dict(keywords))
    data = data.squeeze([name for name in ("k1", "k2", "gamma3") if name != second_parameter])
    return diagram_from_rod_grid(data, second_parameter)


def diagram_from_rod_grid(data: DatasetOrArray, second_parameter: str) -> dict[str, Any]:
    """Diagram, with the variables of `diagram_answer`, from a result of the task `phase_diagram` or
    `spectrum` over F and the parameter `second_parameter`."""
    counts = data["unstable_count"].transpose(second_parameter, "F").values
    if "class" in data:
        is_crushed = flag_words(data["class"].transpose(second_parameter, "F")) == "crushed"
        counts = np.where(is_crushed, CRUSHED_UNSTABLE_COUNT, counts)
    axes = {"x": data["F"].values, "y": data[second_parameter].values}
    diagram = axes | {"unstable_count": counts} | EMPTY_CURVE_VARIABLES
    if "crossing_at" in data:
        diagram |= unstable_counts_between_crossings(data, second_parameter)
    for prefix in ("curve", "cycle_curve"):
        if f"{prefix}_F" in data and f"{prefix}_{second_parameter}" in data:
            diagram[f"{prefix}s"] = diagram_curves(data, prefix, second_parameter)
    return diagram | {"crossing_x": np.zeros(0), "crossing_y": np.zeros(0), "crossing_kind": []}


def _diagram_of_nonuniform_rods(state: PageState) -> dict[str, Any]:
    """Diagram of rods that are not uniform or not of linear material, with the variables of `diagram_answer`,
    from the task `thresholds`."""
    row_values = second_parameter_values(state, ROW_COUNT_OF_SLOW_DIAGRAMS)
    keywords: dict[str, Any] = _fixed_parameters(state) | {state.second_parameter: row_values}
    keywords |= {"material": MATERIAL_SECTION_BY_LAW[state.law]} if MATERIAL_SECTION_BY_LAW[state.law] else {}
    data = sweep("thresholds", **keywords, F_max=state.largest_force(), progress=False)
    fixed_names = {"k1", "k2", "gamma3", "taper"} - {state.second_parameter}
    data = data.squeeze([name for name in data.dims if name in fixed_names])
    return diagram_from_rod_thresholds(data, row_values, "crossing_F", state.largest_force())


def _diagram_of_arms(state: PageState) -> dict[str, Any]:
    """Diagram of arms, with the variables of `diagram_answer`, from the task `thresholds` for values around
    the second quantity of `state`."""
    quantities = {name: text for name, text in state.arm.items() if name != "pressure"}
    quantity = GIVEN_QUANTITIES[state.second_parameter]
    typed_value = quantity_in_si(
        state.second_parameter, state.arm[state.second_parameter], quantity.unit, quantity.example
    )
    ratio = ARM_QUANTITY_MAX_TO_CURRENT_RATIO
    row_values = np.geomspace(typed_value / ratio, typed_value * ratio, ARM_ROW_COUNT)
    arm = state.rod_or_arm()
    assert isinstance(arm, Arm)
    arms = (
        quantities
        | MATERIAL_SECTION_BY_LAW[state.law]
        | {state.second_parameter: list(map(float, row_values))}
    )
    data = sweep("thresholds", arm=arms, F_max=state.largest_force(), progress=False)
    data = data.squeeze([dimension for dimension in data.dims if data.sizes[dimension] == 1])
    return diagram_from_arm_thresholds(data, row_values, arm.si.pressure)


def diagram_from_arm_thresholds(
    data: DatasetOrArray, row_values: np.ndarray, pressure: float
) -> dict[str, Any]:
    """Diagram, with the variables of `diagram_answer`, from a result of the task `thresholds` for arms.
    row_values: values of the second quantity, (rows,).

    The load extends to twice the larger of `pressure`, in Pa, and the smallest flutter pressure. If there is
    neither a pressure nor flutter, the load extends to the largest searched pressure.
    """
    flutter = data["pressure_hopf"].values
    known_loads = flutter[np.isfinite(flutter)]
    largest_load = 2 * max(pressure or 0.0, known_loads.min() if len(known_loads) else 0.0)
    largest_load = largest_load or float(data["pressure_end"].max())
    return diagram_from_rod_thresholds(data, row_values, "crossing_pressure", largest_load)


def diagram_from_rod_thresholds(
    data: DatasetOrArray, row_values: np.ndarray, name: str, largest: float
) -> dict[str, Any]:
    """Diagram, with the variables of `diagram_answer`, from a result of the task `thresholds` over a second
    parameter. Beyond the largest load that was searched at a value of the second parameter, the number of
    unstable modes is UNKNOWN_UNSTABLE_COUNT.

    row_values: second parameter, (rows,). name: name of the variable with the loads at the thresholds.
    largest: largest load of the diagram.
    """
    loads = data[name].values
    counts_after = data["unstable_after"].values
    kind = flag_words(data["crossing_kind"])
    loads_of_grid = np.linspace(0, largest, LOAD_VALUE_COUNT)
    counts = np.zeros((len(row_values), LOAD_VALUE_COUNT), dtype=int)
    ends = data[name.replace("crossing_", "") + "_end"].values
    for row in range(len(row_values)):
        for load, count in zip(loads[row], counts_after[row], strict=True):
            if np.isfinite(load):
                counts[row, loads_of_grid > load] = count
        counts[row, ~(loads_of_grid <= ends[row])] = UNKNOWN_UNSTABLE_COUNT
    listed = np.isfinite(loads) & (loads <= largest)
    rows = np.broadcast_to(row_values[:, None], loads.shape)
    crossings = {"crossing_x": loads[listed], "crossing_y": rows[listed], "crossing_kind": list(kind[listed])}
    return {"x": loads_of_grid, "y": row_values, "unstable_count": counts} | EMPTY_CURVE_VARIABLES | crossings
