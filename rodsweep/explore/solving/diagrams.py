"""Stability diagram of a page: number of unstable modes of the straight rod over the load and a second
parameter."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from ...api.arm import Arm
from ...api.sweeping import sweep
from ...errors import InputError
from ...model.arm.quantities import QUANTITIES
from ...model.units import quantity_in_si
from ..state import MATERIAL_SECTION_BY_LAW, PageState, float_or_text
from .curves_and_counts import Dataset, diagram_curves, flag_words, region_counts

ROW_COUNT = 20
"""Number of values of the second parameter, for uniform rods of linear material."""
SLOW_ROW_COUNT = 8
"""Number of values of the second parameter for rods that are not uniform or not of linear material, for which
each value takes seconds, and for the search of folds and torus points of cycles."""
LOAD_COUNT = 121
"""Number of load values. Additional values are cheap: the stability at all loads of a row follows from the
thresholds on this row."""
ARM_ROW_COUNT = 12
"""Number of values of the second quantity of the diagram, for arms."""
ARM_MAX_OVER_CURRENT = 2.0
"""The values of an arm's second quantity extend from 1/ARM_MAX_OVER_CURRENT to ARM_MAX_OVER_CURRENT times the
current value; the ratio is small, so that all arms are slender."""
CACHED_DIAGRAM_COUNT = 8
"""Number of solved diagrams that a solver process keeps, some 100 kB each: the search of folds and torus
points adds to the diagram that is drawn."""
DIAGRAM_CYCLE_ACCURACY = 1e-4
"""Relative error of the cycles between special points; the diagram does not show these cycles. For the first
rod of the page and F up to 200, the default error of 1e-6 takes three times as long, and changes the curves
of folds and torus points by 2e-8 at most."""
NO_CURVES: dict[str, Any] = {
    "curves": (),
    "cycle_curves": (),
    **dict.fromkeys(("between_x", "between_y", "between_count", "crushing_load"), np.zeros(0)),
}
"""Variables of a diagram without curves and without known crossings of its rows."""
UNKNOWN_CODE = -1
"""Value of `unstable_count` at a point whose number of unstable modes is unknown."""
CRUSHED_CODE = -2
"""Value of `unstable_count` at a point whose load crushes the rod."""
PARAMETER_MAX_OVER_CURRENT = 10.0
"""The values of a rod's second parameter extend from 1/PARAMETER_MAX_OVER_CURRENT to
PARAMETER_MAX_OVER_CURRENT times the current value."""
TAPER_RANGE = (0.4, 1.6)
"""(smallest, largest) taper of the diagram. Cones with a smaller taper take minutes."""


def diagram_answer(state: PageState) -> dict[str, Any]:
    """Stability diagram around the rod or arm of `state`, as arrays by name.

    x: load, (columns,). y: second parameter, (rows,). unstable_count: number of unstable modes, UNKNOWN_CODE
    or CRUSHED_CODE, (rows, columns). between_x, between_y, between_count: places between neighbouring
    crossings of a row, and numbers of unstable modes there, (places,). crushing_load: the crushing load (zero
    stretch) of a row, (rows,), or empty. curves: stability boundaries. cycle_curves: curves of folds and
    torus points of cycles. crossing_x, crossing_y, crossing_kind: thresholds on the rows, (crossings,), empty
    for uniform rods.
    """
    state.subject()
    if state.tab == "arm":
        return _diagram_of_arms(state)
    return _diagram_of_rods(state) if has_uniform_linear_rods(state) else _diagram_from_thresholds(state)


def cycle_diagram_answer(state: PageState) -> dict[str, Any]:
    """The result of `diagram_answer` with curves of folds and torus points of cycles, which are searched on
    SLOW_ROW_COUNT rows. A diagram that this process has already solved is not solved again.

    Raises InputError for rods that are not uniform or not of linear material.
    """
    state.subject()
    if not can_follow_cycle_curves(state):
        raise InputError(
            "folds and torus points of cycles are followed for uniform rods of linear material only, "
            "on the tab Rod"
        )
    cycles = {
        "cycles": True,
        "cycle_accuracy": DIAGRAM_CYCLE_ACCURACY,
        "gamma1": state.parameters()["gamma1"],
    }
    diagram = _diagram_of_rods(state, SLOW_ROW_COUNT, cycles)
    return _diagram_of_rods(state) | {"cycle_curves": diagram["cycle_curves"]}


def can_follow_cycle_curves(state: PageState) -> bool:
    """Whether `cycle_diagram_answer` can follow folds and torus points of cycles for this state."""
    return state.tab == "rod" and has_uniform_linear_rods(state)


def has_uniform_linear_rods(state: PageState) -> bool:
    """Whether all rods of the diagram are uniform and of linear material."""
    return state.law == "linear" and state.second != "taper" and "taper" not in state.parameters()


def second_parameter_values(state: PageState, row_count: int = ROW_COUNT) -> np.ndarray:
    """Values of the second parameter, (rows,): logarithmically spaced around the current value, or linearly
    over TAPER_RANGE for the taper. Raises InputError unless the current value is finite and positive."""
    if state.second == "taper":
        return np.linspace(*TAPER_RANGE, row_count)
    value = float_or_text(state.rod[state.second])
    if not (0 < value < np.inf):
        raise InputError(f"{state.second} = {value:g} has no diagram; a diagram needs a finite value above 0")
    return np.geomspace(value / PARAMETER_MAX_OVER_CURRENT, value * PARAMETER_MAX_OVER_CURRENT, row_count)


def _fixed_parameters(state: PageState) -> dict[str, Any]:
    return {
        name: value for name, value in state.parameters().items() if name not in ("F", "gamma1", state.second)
    }


def _diagram_of_rods(
    state: PageState, row_count: int = ROW_COUNT, cycles: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Diagram of uniform rods, with the variables of `diagram_answer`, from the task `phase_diagram`. cycles:
    further keywords of the sweep, which request folds and torus points of cycles."""
    rows = tuple(second_parameter_values(state, row_count).tolist())
    keywords = {**_fixed_parameters(state), **(cycles or {})}
    return _cached_rod_diagram(state.second, rows, state.largest_force(), tuple(keywords.items()))


@lru_cache(maxsize=CACHED_DIAGRAM_COUNT)
def _cached_rod_diagram(
    second_parameter: str, row_values: tuple[float, ...], F_max: float, keywords: tuple[tuple[str, Any], ...]
) -> dict[str, Any]:
    """Diagram up to the load `F_max` on the values `row_values` of the parameter `second_parameter`;
    callers must not change it."""
    axes: dict[str, Any] = {"F": np.linspace(0, F_max, LOAD_COUNT), second_parameter: list(row_values)}
    data = sweep("phase_diagram", progress=False, **axes, **dict(keywords))
    data = data.squeeze([name for name in ("k1", "k2", "gamma3") if name != second_parameter])
    return diagram_from_phase_result(data, second_parameter)


def diagram_from_phase_result(data: Dataset, second_parameter: str) -> dict[str, Any]:
    """Diagram, with the variables of `diagram_answer`, from a result of the task `phase_diagram` or
    `spectrum` over F and the parameter `second_parameter`."""
    counts = data["unstable_count"].transpose(second_parameter, "F").values
    if "class" in data:
        is_crushed = flag_words(data["class"].transpose(second_parameter, "F")) == "crushed"
        counts = np.where(is_crushed, CRUSHED_CODE, counts)
    axes = {"x": data["F"].values, "y": data[second_parameter].values}
    diagram = axes | {"unstable_count": counts} | NO_CURVES
    if "crossing_at" in data:
        diagram |= region_counts(data, second_parameter)
    for prefix in ("curve", "cycle_curve"):
        if f"{prefix}_F" in data and f"{prefix}_{second_parameter}" in data:
            diagram[f"{prefix}s"] = diagram_curves(data, prefix, second_parameter)
    return diagram | {"crossing_x": np.zeros(0), "crossing_y": np.zeros(0), "crossing_kind": []}


def _diagram_from_thresholds(state: PageState) -> dict[str, Any]:
    """Diagram of rods that are not uniform or not of linear material, with the variables of `diagram_answer`,
    from the task `thresholds`."""
    row_values = second_parameter_values(state, SLOW_ROW_COUNT)
    keywords: dict[str, Any] = _fixed_parameters(state) | {state.second: row_values}
    keywords |= {"material": MATERIAL_SECTION_BY_LAW[state.law]} if MATERIAL_SECTION_BY_LAW[state.law] else {}
    data = sweep("thresholds", **keywords, F_max=state.largest_force(), progress=False)
    data = data.squeeze(
        [name for name in ("k1", "k2", "gamma3", "taper") if name in data.dims and name != state.second]
    )
    return diagram_from_row_result(data, row_values, "crossing_F", state.largest_force())


def _diagram_of_arms(state: PageState) -> dict[str, Any]:
    """Diagram of arms, with the variables of `diagram_answer`, from the task `thresholds` for values around
    the second quantity of `state`."""
    quantities = {name: text for name, text in state.arm.items() if name != "pressure"}
    quantity = QUANTITIES[state.second]
    typed_value = quantity_in_si(state.second, state.arm[state.second], quantity.unit, quantity.example)
    row_values = np.geomspace(
        typed_value / ARM_MAX_OVER_CURRENT, typed_value * ARM_MAX_OVER_CURRENT, ARM_ROW_COUNT
    )
    arm = state.subject()
    assert isinstance(arm, Arm)
    arms = quantities | MATERIAL_SECTION_BY_LAW[state.law] | {state.second: list(map(float, row_values))}
    data = sweep("thresholds", arm=arms, F_max=state.largest_force(), progress=False)
    data = data.squeeze([dimension for dimension in data.dims if data.sizes[dimension] == 1])
    return diagram_from_arm_result(data, row_values, arm.si.pressure)


def diagram_from_arm_result(data: Dataset, row_values: np.ndarray, pressure: float) -> dict[str, Any]:
    """Diagram, with the variables of `diagram_answer`, from a result of the task `thresholds` for arms.
    row_values: values of the second quantity, (rows,).

    The load extends to twice the larger of `pressure`, in Pa, and the smallest flutter pressure. If there is
    neither a pressure nor flutter, the load extends to the largest searched pressure.
    """
    flutter = data["pressure_hopf"].values
    known_loads = flutter[np.isfinite(flutter)]
    largest_load = 2 * max(pressure or 0.0, known_loads.min() if len(known_loads) else 0.0)
    largest_load = largest_load or float(data["pressure_end"].max())
    return diagram_from_row_result(data, row_values, "crossing_pressure", largest_load)


def diagram_from_row_result(
    data: Dataset, row_values: np.ndarray, name: str, largest: float
) -> dict[str, Any]:
    """Diagram, with the variables of `diagram_answer`, from a result of the task `thresholds` over a second
    parameter. Beyond the end of a row's search, and on rows without a search, the count is UNKNOWN_CODE.

    row_values: second parameter, (rows,). name: name of the variable with the loads at the thresholds.
    largest: largest load of the diagram.
    """
    loads = data[name].values
    counts_after = data["unstable_after"].values
    kind = flag_words(data["crossing_kind"])
    loads_of_grid = np.linspace(0, largest, LOAD_COUNT)
    counts = np.zeros((len(row_values), LOAD_COUNT), dtype=int)
    ends = data[name.replace("crossing_", "") + "_end"].values
    for row in range(len(row_values)):
        for load, count in zip(loads[row], counts_after[row], strict=True):
            if np.isfinite(load):
                counts[row, loads_of_grid > load] = count
        counts[row, ~(loads_of_grid <= ends[row])] = UNKNOWN_CODE
    listed = np.isfinite(loads) & (loads <= largest)
    rows = np.broadcast_to(row_values[:, None], loads.shape)
    crossings = {"crossing_x": loads[listed], "crossing_y": rows[listed], "crossing_kind": list(kind[listed])}
    return {"x": loads_of_grid, "y": row_values, "unstable_count": counts} | NO_CURVES | crossings
