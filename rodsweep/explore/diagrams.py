"""The diagram of a page: what a rod or an arm does over its load and a second parameter."""

from typing import Any

import numpy as np
import xarray as xr

from ..api.arm import Arm
from ..api.sweeping import sweep
from ..errors import InputError
from ..model.arm.quantities import QUANTITIES
from ..model.units import in_si
from .state import LAWS, PageState, number

ROWS = 20
"""Values of the second parameter; curves of boundaries are traced between them."""
SLOW_ROWS = 8
"""Values of the second parameter of rods whose thresholds take seconds each: those that are not uniform."""
COLUMNS = 121
"""Values of the load. They cost little: a row is solved from its crossings."""
SPAN = 10.0
"""Ratio of the largest value of the second parameter to the present one, and of that to the smallest."""
TAPERS = (0.4, 1.6)
"""Range of the taper, below which cones take minutes."""


def diagram(state: PageState) -> dict[str, Any]:
    """Classes over a grid, or crossings of each row, whichever the rod has.

    x, y: (columns,), (rows,) of load and second parameter. unstable_count: (rows, columns), -1 where it is not
    known. curve_x, curve_y, curve_number, curve_kind: (curve points,). crossing_x, crossing_y, crossing_kind:
    (crossings,).
    """
    state.subject()
    if state.tab == "arm":
        return _of_arm(state)
    return _of_phases(state) if uniform(state) else _of_thresholds(state)


def uniform(state: PageState) -> bool:
    """Whether the task phase_diagram solves these rods."""
    return state.law == "linear" and state.second != "taper" and "taper" not in state.parameters()


def span(state: PageState) -> np.ndarray:
    """Values of the second parameter, (rows,), around that of the point."""
    rows = ROWS if uniform(state) else SLOW_ROWS
    if state.second == "taper":
        return np.linspace(*TAPERS, rows)
    value = number(state.rod[state.second])
    if not (0 < value < np.inf):
        raise InputError(f"{state.second} = {value:g} is not in the middle of a finite range above 0")
    return np.geomspace(value / SPAN, value * SPAN, rows)


def _fixed(state: PageState) -> dict[str, Any]:
    return {n: v for n, v in state.parameters().items() if n not in ("F", "gamma1", state.second)}


def _of_phases(state: PageState) -> dict[str, Any]:
    F, second = np.linspace(0, state.largest_force(), COLUMNS), span(state)
    data = sweep("phase_diagram", F=F, **{state.second: second}, **_fixed(state))
    data = data.squeeze([n for n in ("k1", "k2", "gamma3") if n != state.second])
    counts = data["unstable_count"].transpose(state.second, "F").values
    crushed = data["class"].transpose(state.second, "F").values == _code(data["class"], "crushed")
    return {
        "x": F,
        "y": second,
        "unstable_count": np.where(crushed, -2, counts),
        "curve_x": data["curve_F"].values,
        "curve_y": data[f"curve_{state.second}"].values,
        "curve_number": data["curve_number"].values,
        "curve_kind": words_of(data["curve_kind"]),
        **_no_crossings(),
    }


def _of_thresholds(state: PageState) -> dict[str, Any]:
    material = {"material": LAWS[state.law]} if LAWS[state.law] else {}
    values = {**_fixed(state), state.second: span(state)}
    data = sweep("thresholds", **values, **material, F_max=state.largest_force())
    data = data.squeeze([n for n in ("k1", "k2", "gamma3", "taper") if n in data.dims and n != state.second])
    return _crossings(data, span(state), "crossing_F", state.largest_force(), 1.0)


def _of_arm(state: PageState) -> dict[str, Any]:
    given = {name: text for name, text in state.arm.items() if name != "pressure"} | LAWS[state.law]
    quantity = QUANTITIES[state.second]
    middle = in_si(state.second, state.arm[state.second], quantity.unit, quantity.example)
    values = np.geomspace(middle / 2, middle * 2, ROWS // 2)
    subject = state.subject()
    assert isinstance(subject, Arm)
    data = sweep("thresholds", arm=given | {state.second: list(map(float, values))}, F_max=state.largest_force())
    data = data.squeeze([n for n in data.dims if data.sizes[n] == 1])
    largest = 2 * max(subject.si.pressure or 0.0, float(data["pressure_hopf"].min()))
    return _crossings(data, values, "crossing_pressure", largest, 1.0)


def _crossings(data: xr.Dataset, values: np.ndarray, name: str, largest: float, unit: float) -> dict[str, Any]:
    """Crossings of each row, and counts of unstable modes between them."""
    at = data[name].values * unit
    kind, after = words_of(data["crossing_kind"]), data["unstable_after"].values
    x = np.linspace(0, largest, COLUMNS)
    counts = np.zeros((len(values), COLUMNS), dtype=int)
    for row in range(len(values)):
        for place, count in zip(at[row], after[row], strict=True):
            if np.isfinite(place):
                counts[row, x > place] = count
    known = np.isfinite(at) & (at <= largest)
    rows = np.broadcast_to(values[:, None], at.shape)
    empty = np.zeros(0)
    return {
        "x": x, "y": values, "unstable_count": counts,
        "curve_x": empty, "curve_y": empty, "curve_number": empty, "curve_kind": [],
        "crossing_x": at[known], "crossing_y": rows[known], "crossing_kind": list(np.array(kind)[known]),
    }  # fmt: skip


def _no_crossings() -> dict[str, Any]:
    return {"crossing_x": np.zeros(0), "crossing_y": np.zeros(0), "crossing_kind": []}


def _code(array: xr.DataArray, word: str) -> int:
    """Number that stands for a word."""
    words = str(array.attrs["flag_meanings"]).split()
    return int(np.atleast_1d(array.attrs["flag_values"])[words.index(word)])


def words_of(array: xr.DataArray) -> Any:
    """The words of an array of flags, in its shape."""
    words = str(array.attrs["flag_meanings"]).split()
    by_code = dict(zip(map(int, np.atleast_1d(array.attrs["flag_values"])), words, strict=True))
    return np.vectorize(lambda code: by_code.get(int(code), "none"), otypes=[object])(array.values)
